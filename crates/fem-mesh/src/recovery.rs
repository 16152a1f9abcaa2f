//! Estimate of the discretisation error from a recovered strain (Zienkiewicz and Zhu, 1992).
//!
//! The strain of linear tetrahedra is constant in each. A better one, linear in each and continuous
//! inside a region of equal material, is recovered at the nodes: a linear polynomial is fitted to
//! the strains at the centroids of the tetrahedra around a node (its patch) and evaluated there.
//! Where a patch is too small for a fit, at corners and edges, the patches of its neighbours join.
//! The difference between the recovered and the constant strain estimates the error,
//!
//! ```text
//! error energy of tetrahedron T = 1/2 integral over T of (e* - e_h) : c : (e* - e_h)
//! ```
//!
//! in units of energy. It is no bound. It is asymptotically exact where the recovered strain
//! converges faster than the constant one, as on smooth solutions; at re-entrant corners, at the
//! rim of a contact zone and between regions the index (estimated over true error norm) is off 1 by
//! some tens of per cent. The error of the contact forces, of the friction and of the time step is
//! not in it.

use std::collections::BTreeMap;

use nalgebra::{Matrix4, SMatrix};
use rayon::prelude::*;

use crate::fields::{FieldError, strains};
use crate::materials::Materials;
use crate::mesh::TetMesh;
use crate::quadrature;
use crate::vec3::{centroid, sub};

/// Patches with fewer tetrahedra are joined with those of the neighbours.
const SMALL_PATCH: usize = 8;

/// Smallest over largest pivot below which a fit is not trusted.
const PIVOT: f64 = 1e-6;

/// Estimated discretisation error, tetrahedron by tetrahedron.
#[derive(Debug, Clone, PartialEq)]
pub struct DiscretisationError {
    energies: Vec<f64>,
    total: f64,
    elastic: f64,
}

impl DiscretisationError {
    /// Error energy of each tetrahedron, half of error stress times error strain, J.
    #[must_use]
    pub fn energies(&self) -> &[f64] {
        &self.energies
    }

    /// Their sum, J.
    #[must_use]
    pub fn energy(&self) -> f64 {
        self.total
    }

    /// Elastic energy of the displacement, J.
    #[must_use]
    pub fn elastic_energy(&self) -> f64 {
        self.elastic
    }

    /// Error relative to the displacement, both in the energy norm; 0 for a body at rest.
    #[must_use]
    pub fn relative(&self) -> f64 {
        if self.elastic > 0.0 {
            (self.total / self.elastic).sqrt()
        } else {
            0.0
        }
    }

    /// The error stress of each tetrahedron in an energy norm, for pictures: the root of the error
    /// energy per volume times 2 E with E the bound of the material's tensor. Pa.
    ///
    /// # Errors
    /// [`FieldError`] if a region has no material.
    pub fn stress_errors(
        &self,
        mesh: &TetMesh,
        materials: &Materials,
    ) -> Result<Vec<f64>, FieldError> {
        let laws = materials.of_tets(mesh.regions())?;
        let value = |(tet, energy): (usize, &f64)| {
            (2.0 * laws[tet].bound() * energy / mesh.volume(tet)).sqrt()
        };
        Ok(self.energies.iter().enumerate().map(value).collect())
    }
}

/// Estimates the discretisation error of a displacement; see the [module](self) for what it is worth.
///
/// ```
/// use signorini_fem_mesh::{Brick, Hooke, Materials, discretisation_error};
///
/// let mesh = Brick::new([1.0; 3], [4; 3]).build()?;
/// let materials = Materials::uniform(Hooke::isotropic(1e3, 0.3)?);
/// // bending: the strain is linear, the tetrahedra see steps
/// let u: Vec<f64> = mesh.points().iter().flat_map(|p| [p[0] * p[2], 0.0, -0.5 * p[0] * p[0]]).collect();
/// let error = discretisation_error(&mesh, &materials, &u)?;
/// assert!(error.relative() > 0.05 && error.relative() < 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`FieldError`] if the displacement has the wrong length or is not finite, or a region has no
/// material.
pub fn discretisation_error(
    mesh: &TetMesh,
    materials: &Materials,
    u: &[f64],
) -> Result<DiscretisationError, FieldError> {
    let laws = materials.of_tets(mesh.regions())?;
    let strains = strains(mesh, u)?;
    let patches = Patches::new(mesh);
    let nodal = patches.recover(mesh, &strains);
    let energy = |tet: usize| {
        let corners: [[f64; 6]; 4] = std::array::from_fn(|a| {
            let key = (mesh.tets()[tet][a], mesh.regions()[tet]);
            let recovered = nodal[patches.place(key)];
            std::array::from_fn(|i| recovered[i] - strains[tet][i])
        });
        // integral of l_a l_b over a tetrahedron: V (1 + delta_ab) / 20
        let sum: [f64; 6] = std::array::from_fn(|i| corners.iter().map(|c| c[i]).sum());
        let squares: f64 = corners.iter().map(|c| laws[tet].energy_density(c)).sum();
        mesh.volume(tet) * (squares + laws[tet].energy_density(&sum)) / 20.0
    };
    let energies: Vec<f64> = (0..strains.len()).into_par_iter().map(energy).collect();
    let elastic = (0..strains.len())
        .map(|tet| mesh.volume(tet) * laws[tet].energy_density(&strains[tet]))
        .sum();
    Ok(DiscretisationError {
        total: energies.iter().sum(),
        energies,
        elastic,
    })
}

/// Energy of the difference between a displacement of the mesh and a given one, half of error
/// stress times error strain, by quadrature of degree 5. `exact_gradient(x)[i][j]` = d u_i / d x_j.
///
/// # Errors
/// As [`discretisation_error`].
pub fn energy_of_error(
    mesh: &TetMesh,
    materials: &Materials,
    u: &[f64],
    exact_gradient: impl Fn([f64; 3]) -> [[f64; 3]; 3] + Sync,
) -> Result<f64, FieldError> {
    let laws = materials.of_tets(mesh.regions())?;
    let strains = strains(mesh, u)?;
    let rule = quadrature::tetrahedron();
    let part = |tet: usize| {
        let points = mesh.tet_points(tet);
        let at = |l: &[f64; 4]| {
            let h = exact_gradient(quadrature::at(&points, l));
            let exact = [
                h[0][0],
                h[1][1],
                h[2][2],
                h[1][2] + h[2][1],
                h[0][2] + h[2][0],
                h[0][1] + h[1][0],
            ];
            laws[tet].energy_density(&std::array::from_fn(|i| exact[i] - strains[tet][i]))
        };
        let mean: f64 = rule.iter().map(|(l, weight)| weight * at(l)).sum();
        mesh.volume(tet) * mean
    };
    let parts: Vec<f64> = (0..strains.len()).into_par_iter().map(part).collect();
    Ok(parts.iter().sum())
}

/// The tetrahedra around each node, region by region.
struct Patches {
    /// (node, region) in ascending order.
    keys: Vec<(u32, u32)>,
    tets: Vec<Vec<u32>>,
}

impl Patches {
    fn new(mesh: &TetMesh) -> Self {
        let mut map: BTreeMap<(u32, u32), Vec<u32>> = BTreeMap::new();
        for (tet, nodes) in mesh.tets().iter().enumerate() {
            for &node in nodes {
                map.entry((node, mesh.regions()[tet]))
                    .or_default()
                    .push(tet as u32);
            }
        }
        let (keys, tets) = map.into_iter().unzip();
        Self { keys, tets }
    }

    /// Every corner of a tetrahedron has a key, so the search cannot fail.
    fn place(&self, key: (u32, u32)) -> usize {
        self.keys.binary_search(&key).unwrap_or(0)
    }

    fn recover(&self, mesh: &TetMesh, strains: &[[f64; 6]]) -> Vec<[f64; 6]> {
        let at = |k: usize| {
            let (node, region) = self.keys[k];
            let centre = mesh.points()[node as usize];
            let own = &self.tets[k];
            if own.len() >= SMALL_PATCH
                && let Some(value) = fit(mesh, strains, own, centre)
            {
                return value;
            }
            let mut wide: Vec<u32> = own
                .iter()
                .flat_map(|&tet| mesh.tets()[tet as usize])
                .flat_map(|n| &self.tets[self.place((n, region))])
                .copied()
                .collect();
            wide.sort_unstable();
            wide.dedup();
            fit(mesh, strains, &wide, centre).unwrap_or_else(|| mean(mesh, strains, own))
        };
        (0..self.keys.len()).into_par_iter().map(at).collect()
    }
}

fn mean(mesh: &TetMesh, strains: &[[f64; 6]], tets: &[u32]) -> [f64; 6] {
    let volume: f64 = tets.iter().map(|&t| mesh.volume(t as usize)).sum();
    std::array::from_fn(|i| {
        let part = |&t: &u32| mesh.volume(t as usize) * strains[t as usize][i];
        tets.iter().map(part).sum::<f64>() / volume
    })
}

/// Value at `centre` of the linear polynomials that fit the strains at the centroids best, weighted
/// by volume; `None` if the centroids do not determine them.
fn fit(mesh: &TetMesh, strains: &[[f64; 6]], tets: &[u32], centre: [f64; 3]) -> Option<[f64; 6]> {
    let offsets: Vec<[f64; 3]> = tets
        .iter()
        .map(|&t| sub(centroid(&mesh.tet_points(t as usize)), centre))
        .collect();
    let mut size = [0.0_f64; 3];
    for x in &offsets {
        (0..3).for_each(|d| size[d] = size[d].max(x[d].abs()));
    }
    if size.contains(&0.0) {
        return None;
    }
    let (mut normal, mut right) = (Matrix4::<f64>::zeros(), SMatrix::<f64, 4, 6>::zeros());
    for (x, &tet) in offsets.iter().zip(tets) {
        let weight = mesh.volume(tet as usize);
        let p = [1.0, x[0] / size[0], x[1] / size[1], x[2] / size[2]];
        for i in 0..4 {
            for j in 0..4 {
                normal[(i, j)] += weight * p[i] * p[j];
            }
            for j in 0..6 {
                right[(i, j)] += weight * p[i] * strains[tet as usize][j];
            }
        }
    }
    let factor = normal.cholesky()?;
    let pivots = factor.l_dirty().diagonal();
    if pivots.min().powi(2) < PIVOT * pivots.max().powi(2) {
        return None;
    }
    let solution = factor.solve(&right);
    Some(std::array::from_fn(|i| solution[(0, i)]))
}
