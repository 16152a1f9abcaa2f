//! Strain without stress as nodal forces.

use rayon::prelude::*;

use crate::decomposition::{Decomposition, Subdomain};
use crate::element::{Element, QuadraticElement};
use crate::material::{Eigenstrain, Materials};
use crate::mesh::TetMesh;

use super::assemble::{accumulate, expect_decomposition, missing_region};
use super::density::LoadError;

/// Turns an eigenstrain into nodal forces of the subdomains, as [`assemble_load`](crate::assemble_load) does with
/// loads: the work of the stress that would suppress it, on the strains of the elements. They are in balance on each
/// tetrahedron.
///
/// # Errors
/// [`LoadError`] if a number is not finite, the region is unknown or has no material, there is not a factor for each
/// node, or the decomposition belongs to another mesh.
pub fn assemble_eigenstrain(
    mesh: &TetMesh,
    decomposition: &Decomposition,
    materials: &Materials,
    strain: &Eigenstrain,
) -> Result<Vec<Vec<f64>>, LoadError> {
    expect_decomposition(mesh, decomposition)?;
    check(mesh, strain)?;
    let laws = materials.of_tets(mesh.regions())?;
    let of_subdomain = |subdomain: &Subdomain| {
        let mut vector = vec![0.0; subdomain.dofs()];
        let stress = |tet: usize, l: &[f64; 4]| {
            let strain = strain.at(laws[tet], (mesh.regions()[tet], &mesh.tets()[tet]), l);
            laws[tet].stress(&strain)
        };
        let elements = || subdomain.elements.iter().map(|&tet| tet as usize);
        match mesh.order() {
            1 => {
                for (tet, nodes) in elements().zip(&subdomain.tets) {
                    let element = Element::new(&mesh.tet_points(tet));
                    accumulate(&mut vector, nodes, element.forces(&stress(tet, &[0.25; 4])));
                }
            }
            _ => {
                for (tet, nodes) in elements().zip(subdomain.quadratic_tets()) {
                    let element = QuadraticElement::new(&mesh.quadratic_points(tet), laws[tet]);
                    accumulate(&mut vector, &nodes, element.forces(|l| stress(tet, l)));
                }
            }
        }
        vector
    };
    Ok(decomposition.subdomains().par_iter().map(of_subdomain).collect())
}

fn check(mesh: &TetMesh, eigenstrain: &Eigenstrain) -> Result<(), LoadError> {
    let Eigenstrain {
        strain,
        region,
        factors,
    } = eigenstrain;
    if !strain.iter().all(|e| e.is_finite()) {
        return Err(LoadError::Eigenstrain { strain: *strain });
    }
    if let Some((region, known)) = missing_region(mesh, *region) {
        return Err(LoadError::StrainRegion { region, known });
    }
    let Some(factors) = factors else {
        return Ok(());
    };
    let (given, nodes) = (factors.len(), mesh.points().len());
    if given != nodes {
        return Err(LoadError::StrainFactors { given, nodes });
    }
    match factors.iter().position(|f| !f.is_finite()) {
        Some(node) => {
            let value = factors[node];
            Err(LoadError::StrainFactor { node, value })
        }
        None => Ok(()),
    }
}
