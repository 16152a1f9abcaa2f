//! The recovered strain in a mesh of order 2: quadratic in each tetrahedron, continuous inside a region.
//!
//! A quadratic polynomial is fitted to the strains at four points of each tetrahedron around a corner (its patch). At
//! corners it is evaluated, at mid-nodes the mean of the two at the ends.

use nalgebra::{Cholesky, Const, Matrix3, SMatrix, SVector, Vector3};
use rayon::prelude::*;

use crate::element::{Piece, over_quadratic};
use crate::material::{Hooke, Materials};
use crate::mesh::{EDGES, TetMesh, shape};
use crate::quadrature::{self, FOUR_POINTS};
use crate::tolerances::FIT_PIVOT;
use crate::vec3::{Vec3, sub};

/// Terms of a quadratic polynomial: 1, x, y, z, then the products.
const TERMS: usize = 10;

/// Values of the terms, or coefficients of them.
type Terms = SVector<f64, TERMS>;

/// The fit of a patch.
#[derive(Debug, Clone)]
pub(super) struct Fit {
    /// Tetrahedra, ascending.
    tets: Vec<u32>,
    centre: Vec3,
    /// To coordinates in which the points have unit moments: however flat cells are, a fit is trusted as if they were
    /// not.
    axes: Matrix3<f64>,
    /// Terms in use: fewer where the points do not determine all.
    terms: usize,
    factor: Cholesky<f64, Const<TERMS>>,
}

impl Fit {
    /// Fits to the patch of a corner; `None` if its points do not determine a quadratic polynomial.
    pub(super) fn quadratic(mesh: &TetMesh, tets: &[u32], centre: Vec3) -> Option<Self> {
        Self::with_terms(mesh, tets, centre, TERMS)
    }

    /// The best there is: quadratic, linear, or the mean.
    pub(super) fn best(mesh: &TetMesh, tets: &[u32], centre: Vec3) -> Self {
        let found = [TERMS, 4]
            .into_iter()
            .find_map(|terms| Self::with_terms(mesh, tets, centre, terms));
        found.unwrap_or_else(|| Self {
            tets: tets.to_vec(),
            centre,
            axes: Matrix3::identity(),
            terms: 1,
            factor: Cholesky::pack_dirty(SMatrix::identity() * (tets.len() as f64 * 4.0).sqrt()),
        })
    }

    fn with_terms(mesh: &TetMesh, tets: &[u32], centre: Vec3, terms: usize) -> Option<Self> {
        let places: Vec<Vec3> = tets.iter().flat_map(|&tet| samples(mesh, tet as usize)).collect();
        let arms = places.iter().map(|p| Vector3::from(sub(*p, centre)));
        let moments = arms.map(|x| x * x.transpose()).sum::<Matrix3<f64>>() / places.len() as f64;
        let axes = moments.cholesky()?.l().try_inverse()?;
        let mut out = Self {
            tets: tets.to_vec(),
            centre,
            axes,
            terms,
            factor: Cholesky::pack_dirty(SMatrix::identity()),
        };
        let mut normal = SMatrix::<f64, TERMS, TERMS>::zeros();
        for place in &places {
            let p = out.polynomial(*place);
            normal.ger(1.0, &p, &p, 1.0);
        }
        (terms..TERMS).for_each(|k| normal[(k, k)] = places.len() as f64);
        out.factor = normal.cholesky()?;
        let pivots = out.factor.l_dirty().diagonal();
        (pivots.min().powi(2) > FIT_PIVOT * pivots.max().powi(2)).then_some(out)
    }

    fn polynomial(&self, place: Vec3) -> Terms {
        let [x, y, z] = (self.axes * Vector3::from(sub(place, self.centre))).into();
        let all = Terms::from([1.0, x, y, z, x * x, y * y, z * z, y * z, x * z, x * y]);
        Terms::from_fn(|k, _| if k < self.terms { all[k] } else { 0.0 })
    }

    /// The polynomials of the six strains; `strains` has four of each tetrahedron.
    fn coefficients(&self, mesh: &TetMesh, strains: &[[[f64; 6]; 4]]) -> SMatrix<f64, TERMS, 6> {
        let mut right = SMatrix::<f64, TERMS, 6>::zeros();
        for &tet in &self.tets {
            for (place, strain) in samples(mesh, tet as usize).into_iter().zip(&strains[tet as usize]) {
                right.ger(1.0, &self.polynomial(place), &SVector::from(*strain), 1.0);
            }
        }
        self.factor.solve(&right)
    }

    fn at(&self, coefficients: &SMatrix<f64, TERMS, 6>, place: Vec3) -> [f64; 6] {
        coefficients.tr_mul(&self.polynomial(place)).into()
    }
}

/// Where strains are taken in a tetrahedron.
fn samples(mesh: &TetMesh, tet: usize) -> [Vec3; 4] {
    let points = mesh.quadratic_points(tet);
    FOUR_POINTS.map(|l| quadrature::at(&points, &shape(&l)))
}

/// Error energy and elastic energy of each tetrahedron. `corners` are the fits of its corners.
pub(super) fn energies(
    mesh: &TetMesh,
    materials: &Materials,
    laws: &[&Hooke],
    u: &[Vec3],
    (fits, corners): (&[Fit], &[[u32; 4]]),
) -> Vec<[f64; 2]> {
    let pieces: Vec<Piece> = (0..mesh.tets().len())
        .map(|tet| Piece::new(mesh, tet, u).with_law(laws[tet]))
        .collect();
    let strains: Vec<[[f64; 6]; 4]> = pieces.par_iter().map(|p| FOUR_POINTS.map(|l| p.strain(&l))).collect();
    let polynomials: Vec<_> = fits.par_iter().map(|fit| fit.coefficients(mesh, &strains)).collect();
    let (rule, four) = (quadrature::tetrahedron(), FOUR_POINTS.map(|l| (l, 0.25)));
    let of_tet = |tet: usize| {
        let points = mesh.quadratic_points(tet);
        let at = |corner: usize, node: usize| {
            let patch = corners[tet][corner] as usize;
            fits[patch].at(&polynomials[patch], points[node])
        };
        let nodal: [[f64; 6]; 10] = std::array::from_fn(|k| match k {
            0..4 => at(k, k),
            _ => {
                let [a, b] = EDGES[k - 4].map(|corner| at(corner, k));
                std::array::from_fn(|i| 0.5 * (a[i] + b[i]))
            }
        });
        let error = |l: &[f64; 4]| {
            let (shape, own) = (shape(l), pieces[tet].strain(l));
            let recovered = |i: usize| (0..10).map(|k| shape[k] * nodal[k][i]).sum::<f64>();
            laws[tet].energy_density(&std::array::from_fn(|i| recovered(i) - own[i]))
        };
        let place = (mesh.regions()[tet], &mesh.tets()[tet]);
        let elastic = |l: &[f64; 4]| materials.larger_energy(laws[tet], place, l, &pieces[tet].strain(l));
        [
            over_quadratic(mesh, tet, &rule, error),
            over_quadratic(mesh, tet, &four, elastic),
        ]
    };
    (0..pieces.len()).into_par_iter().map(of_tet).collect()
}
