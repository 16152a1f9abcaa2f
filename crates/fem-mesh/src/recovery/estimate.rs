//! The estimate: the energy of the difference between the recovered and the constant strain.
//!
//! ```text
//! error energy of tetrahedron T = 1/2 integral over T of (e* - e_h) : c : (e* - e_h)
//! ```

use rayon::prelude::*;

use crate::fields::{FieldError, expect_entries, nodal_vectors, strains};
use crate::material::{Hooke, Materials};
use crate::mesh::TetMesh;

use super::patches::StrainRecovery;
use super::quadratic::energies;

/// Estimated discretisation error, tetrahedron by tetrahedron.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct DiscretisationError {
    /// Error energy of each tetrahedron, half of error stress times error strain, J.
    pub energies: Vec<f64>,
    /// Their sum, J.
    pub energy: f64,
    /// Elastic energy of the displacement, J; with eigenstrains the energy of the whole strain, if that is larger.
    pub elastic_energy: f64,
}

impl DiscretisationError {
    /// Error relative to the displacement, both in the energy norm; 0 without elastic energy. Of a body that is at
    /// rest but for rounding it is noise over noise, about one: compare `energy` with a scale of your
    /// own.
    pub fn relative(&self) -> f64 {
        if self.elastic_energy > 0.0 { (self.energy / self.elastic_energy).sqrt() } else { 0.0 }
    }

    /// The error stress of each tetrahedron in an energy norm, for pictures: the root of the error
    /// energy per volume times 2 E with E the bound of the material's tensor. Pa.
    ///
    /// # Errors
    /// [`FieldError::Length`] if the mesh has another number of tetrahedra, [`FieldError`] if a region
    /// has no material.
    pub fn stress_errors(&self, mesh: &TetMesh, materials: &Materials) -> Result<Vec<f64>, FieldError> {
        expect_entries("table of tetrahedra", self.energies.len(), mesh.tets().len())?;
        let laws = materials.of_tets(mesh.regions())?;
        let value = |(tet, energy): (usize, &f64)| (2.0 * laws[tet].bound() * energy / mesh.volume(tet)).sqrt();
        Ok(self.energies.iter().enumerate().map(value).collect())
    }
}

impl StrainRecovery {
    /// Estimates the discretisation error of a displacement of the mesh for which this was made.
    ///
    /// # Errors
    /// As [`discretisation_error`](super::discretisation_error); [`FieldError::Length`] also for a mesh with another
    /// number of tetrahedra or nodes. Another mesh with as many is not noticed, and the estimate is meaningless then.
    pub fn error(&self, mesh: &TetMesh, materials: &Materials, u: &[f64]) -> Result<DiscretisationError, FieldError> {
        expect_entries("table of tetrahedra", self.corners.len(), mesh.tets().len())?;
        expect_entries("table of nodes", self.nodes, mesh.points().len())?;
        let laws = materials.of_tets(mesh.regions())?;
        let both = match mesh.order() {
            1 => self.linear(mesh, materials, &laws, &strains(mesh, u)?),
            _ => energies(
                mesh,
                materials,
                &laws,
                &nodal_vectors(mesh, u)?,
                (&self.fits, &self.corners),
            ),
        };
        Ok(DiscretisationError {
            energy: both.iter().map(|e| e[0]).sum(),
            elastic_energy: both.iter().map(|e| e[1]).sum(),
            energies: both.iter().map(|e| e[0]).collect(),
        })
    }

    /// Error energy and elastic energy of each tetrahedron in a mesh of order 1.
    fn linear(&self, mesh: &TetMesh, materials: &Materials, laws: &[&Hooke], strains: &[[f64; 6]]) -> Vec<[f64; 2]> {
        let at = |k: usize| {
            let mut sum = [0.0; 6];
            for &(tet, weight) in &self.patches[k] {
                let strain = &strains[tet as usize];
                (0..6).for_each(|i| sum[i] += weight * strain[i]);
            }
            sum
        };
        let nodal: Vec<[f64; 6]> = (0..self.patches.len()).into_par_iter().map(at).collect();
        let of_tet = |tet: usize| {
            let corners = self.corners[tet].map(|k| {
                let recovered = &nodal[k as usize];
                std::array::from_fn(|i| recovered[i] - strains[tet][i])
            });
            // integral of l_a l_b over a tetrahedron: V (1 + delta_ab) / 20
            let sum: [f64; 6] = std::array::from_fn(|i| corners.iter().map(|c| c[i]).sum());
            let squares: f64 = corners.iter().map(|c| laws[tet].energy_density(c)).sum();
            let volume = mesh.volume(tet);
            let error = volume * (squares + laws[tet].energy_density(&sum)) / 20.0;
            let place = (mesh.regions()[tet], &mesh.tets()[tet]);
            [
                error,
                volume * materials.larger_energy(laws[tet], place, &[0.25; 4], &strains[tet]),
            ]
        };
        (0..strains.len()).into_par_iter().map(of_tet).collect()
    }
}

/// Estimates the discretisation error of a displacement; see the [module](super) for what it is worth.
///
/// ```
/// use signorini_fem_mesh::{Brick, Hooke, Materials};
/// use signorini_fem_mesh::recovery::discretisation_error;
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
    StrainRecovery::new(mesh).error(mesh, materials, u)
}
