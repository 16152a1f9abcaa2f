//! Errors of a displacement against a known one, by quadrature of degree 5.

use crate::element::quadrature::{self, integral};
use crate::element::{Element, strain_of};
use crate::material::Materials;
use crate::mesh::TetMesh;
use crate::vec3::{dot, sub};

use super::strain::{FieldError, nodal_vectors, strains};

/// The L2 norm of u - exact over the mesh. With `u` zero it is the norm of `exact`.
///
/// # Errors
/// [`FieldError`] if the displacement has the wrong length or is not finite.
pub fn l2_error(mesh: &TetMesh, u: &[f64], exact: impl Fn([f64; 3]) -> [f64; 3] + Sync) -> Result<f64, FieldError> {
    let u = nodal_vectors(mesh, u)?;
    let exact = &exact;
    let square = integral(mesh, |tet| {
        let points = mesh.tet_points(tet);
        let nodal = mesh.tets()[tet].map(|n| u[n as usize]);
        move |l: &[f64; 4]| {
            let error = sub(quadrature::at(&nodal, l), exact(quadrature::at(&points, l)));
            dot(error, error)
        }
    });
    Ok(square.sqrt())
}

/// The H1 seminorm of u - exact over the mesh, from `exact_gradient(x)[i][j]` = d u_i / d x_j.
/// With `u` zero it is the seminorm of the exact displacement.
///
/// # Errors
/// [`FieldError`] if the displacement has the wrong length or is not finite.
pub fn h1_seminorm_error(
    mesh: &TetMesh,
    u: &[f64],
    exact_gradient: impl Fn([f64; 3]) -> [[f64; 3]; 3] + Sync,
) -> Result<f64, FieldError> {
    let u = nodal_vectors(mesh, u)?;
    let exact = &exact_gradient;
    let square = integral(mesh, |tet| {
        let points = mesh.tet_points(tet);
        let nodal = mesh.tets()[tet].map(|n| u[n as usize]);
        let gradient = Element::new(&points).displacement_gradient(&nodal);
        move |l: &[f64; 4]| {
            let exact = exact(quadrature::at(&points, l));
            let rows = gradient.iter().zip(&exact).map(|(&g, &e)| sub(g, e));
            rows.map(|row| dot(row, row)).sum()
        }
    });
    Ok(square.sqrt())
}

/// Energy of the difference between a displacement of the mesh and a given one, half of error stress times error
/// strain, by quadrature of degree 5. `exact_gradient(x)[i][j]` = d u_i / d x_j.
///
/// # Errors
/// [`FieldError`] if the displacement has the wrong length or is not finite, or a region has no material.
pub fn energy_of_error(
    mesh: &TetMesh,
    materials: &Materials,
    u: &[f64],
    exact_gradient: impl Fn([f64; 3]) -> [[f64; 3]; 3] + Sync,
) -> Result<f64, FieldError> {
    let laws = materials.of_tets(mesh.regions())?;
    let strains = strains(mesh, u)?;
    let exact = &exact_gradient;
    Ok(integral(mesh, |tet| {
        let (points, law, own) = (mesh.tet_points(tet), laws[tet], strains[tet]);
        move |l: &[f64; 4]| {
            let exact = strain_of(&exact(quadrature::at(&points, l)));
            law.energy_density(&std::array::from_fn(|i| exact[i] - own[i]))
        }
    }))
}
