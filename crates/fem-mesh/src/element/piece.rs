//! A displacement in one tetrahedron of a mesh of either order, and integrals over a mesh.

use rayon::prelude::*;

use crate::material::Hooke;
use crate::mesh::{TetMesh, shape, tangents};
use crate::quadrature::{self, FOUR_POINTS};
use crate::vec3::{Vec3, tet_volume};

use super::p1::{Element, displacement_gradient, strain_of};
use super::p2;

/// A displacement in a tetrahedron, as a function of barycentric coordinates.
#[expect(clippy::large_enum_variant, reason = "short-lived, and no allocation a tetrahedron")]
pub(crate) enum Piece {
    Linear {
        points: [Vec3; 4],
        values: [Vec3; 4],
        /// The same everywhere.
        gradient: [[f64; 3]; 3],
    },
    Quadratic {
        points: [Vec3; 10],
        values: [Vec3; 10],
        /// The mean of the volume strain, where it counts for itself.
        volume_strain: Option<f64>,
    },
}

/// Gradients of the shape functions of a tetrahedron of a mesh at barycentric coordinates, 1/m: those of its corners,
/// then those of its mid-nodes.
pub fn shape_gradients(mesh: &TetMesh, tet: usize, l: &[f64; 4]) -> Vec<Vec3> {
    match mesh.order() {
        1 => Element::new(&mesh.tet_points(tet)).gradients.to_vec(),
        _ => p2::gradients(&mesh.quadratic_points(tet), l).1.to_vec(),
    }
}

impl Piece {
    /// Of the displacement `u` of the nodes of a mesh.
    pub(crate) fn new(mesh: &TetMesh, tet: usize, u: &[Vec3]) -> Self {
        let corners = mesh.tets()[tet].map(|n| u[n as usize]);
        let Some(mids) = mesh.mids().get(tet) else {
            let points = mesh.tet_points(tet);
            let gradient = displacement_gradient(&Element::new(&points).gradients, &corners);
            return Self::Linear {
                points,
                values: corners,
                gradient,
            };
        };
        Self::Quadratic {
            points: mesh.quadratic_points(tet),
            volume_strain: None,
            values: std::array::from_fn(|k| if k < 4 { corners[k] } else { u[mids[k - 4] as usize] }),
        }
    }

    /// The same with the strains that the stiffness of a quadratic element of this law is made of.
    pub(crate) fn with_law(mut self, law: &Hooke) -> Self {
        if let Self::Quadratic {
            points,
            values,
            volume_strain,
        } = &mut self
            && law.is_nearly_incompressible()
        {
            let (mut sum, mut total) = (0.0, 0.0);
            for l in FOUR_POINTS {
                let (volume, gradients) = p2::gradients(points, &l);
                let gradient = displacement_gradient(&gradients, values);
                sum += volume * (gradient[0][0] + gradient[1][1] + gradient[2][2]);
                total += volume;
            }
            *volume_strain = Some(sum / total);
        }
        self
    }

    pub(crate) fn place(&self, l: &[f64; 4]) -> Vec3 {
        match self {
            Self::Linear { points, .. } => quadrature::at(points, l),
            Self::Quadratic { points, .. } => quadrature::at(points, &shape(l)),
        }
    }

    pub(crate) fn value(&self, l: &[f64; 4]) -> Vec3 {
        match self {
            Self::Linear { values, .. } => quadrature::at(values, l),
            Self::Quadratic { values, .. } => quadrature::at(values, &shape(l)),
        }
    }

    /// `h[i][j]` = d u_i / d x_j.
    pub(crate) fn gradient(&self, l: &[f64; 4]) -> [[f64; 3]; 3] {
        match self {
            Self::Linear { gradient, .. } => *gradient,
            Self::Quadratic { points, values, .. } => displacement_gradient(&p2::gradients(points, l).1, values),
        }
    }

    pub(crate) fn strain(&self, l: &[f64; 4]) -> [f64; 6] {
        let mut strain = strain_of(&self.gradient(l));
        if let Self::Quadratic {
            volume_strain: Some(mean),
            ..
        } = self
        {
            let more = (mean - strain[0] - strain[1] - strain[2]) / 3.0;
            strain[..3].iter_mut().for_each(|e| *e += more);
        }
        strain
    }
}

/// Integrates over a mesh the function that `of_tet` makes of each tetrahedron, at barycentric coordinates. The sum
/// runs in the order of the tetrahedra, whatever the threads do.
pub(crate) fn integral<F: Fn(&[f64; 4]) -> f64>(mesh: &TetMesh, of_tet: impl Fn(usize) -> F + Sync) -> f64 {
    let rule = quadrature::tetrahedron();
    let part = |tet: usize| {
        let value = of_tet(tet);
        if mesh.order() == 2 {
            return over_quadratic(mesh, tet, &rule, value);
        }
        let mean: f64 = rule.iter().map(|(l, weight)| weight * value(l)).sum();
        mesh.volume(tet) * mean
    };
    let parts: Vec<f64> = (0..mesh.tets().len()).into_par_iter().map(part).collect();
    parts.iter().sum()
}

/// Integral of a function of barycentric coordinates over a quadratic tetrahedron.
pub(crate) fn over_quadratic(
    mesh: &TetMesh,
    tet: usize,
    rule: &[([f64; 4], f64)],
    value: impl Fn(&[f64; 4]) -> f64,
) -> f64 {
    let points = mesh.quadratic_points(tet);
    let volume = |l: &[f64; 4]| tet_volume(&tangents(&points, l));
    rule.iter().map(|(l, weight)| weight * volume(l) * value(l)).sum()
}
