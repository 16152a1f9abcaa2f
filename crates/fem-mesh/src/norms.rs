//! Errors of a displacement against a known one, by quadrature of degree 5.

use rayon::prelude::*;

use crate::element::Element;
use crate::fields::{FieldError, nodal_vectors};
use crate::mesh::TetMesh;
use crate::quadrature;
use crate::vec3::{dot, sub};

/// The L2 norm of u - exact over the mesh. With `u` zero it is the norm of `exact`.
///
/// # Errors
/// [`FieldError`] if the displacement has the wrong length or is not finite.
pub fn l2_error(
    mesh: &TetMesh,
    u: &[f64],
    exact: impl Fn([f64; 3]) -> [f64; 3] + Sync,
) -> Result<f64, FieldError> {
    let u = nodal_vectors(mesh, u)?;
    let rule = quadrature::tetrahedron();
    Ok(root_of_integral(mesh, |tet| {
        let points = mesh.tet_points(tet);
        let nodal = mesh.tets()[tet].map(|n| u[n as usize]);
        let square = |l: &[f64; 4]| {
            let error = sub(quadrature::at(&nodal, l), exact(quadrature::at(&points, l)));
            dot(error, error)
        };
        rule.iter().map(|(l, weight)| weight * square(l)).sum()
    }))
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
    let rule = quadrature::tetrahedron();
    Ok(root_of_integral(mesh, |tet| {
        let points = mesh.tet_points(tet);
        let nodal = mesh.tets()[tet].map(|n| u[n as usize]);
        let gradient = Element::new(&points).displacement_gradient(&nodal);
        let square = |l: &[f64; 4]| -> f64 {
            let exact = exact_gradient(quadrature::at(&points, l));
            let rows = gradient.iter().zip(&exact).map(|(&g, &e)| sub(g, e));
            rows.map(|row| dot(row, row)).sum()
        };
        rule.iter().map(|(l, weight)| weight * square(l)).sum()
    }))
}

/// Integrates a function of which the mean over each tetrahedron is given. The sum runs in the
/// order of the tetrahedra, whatever the threads do.
fn root_of_integral(mesh: &TetMesh, mean: impl Fn(usize) -> f64 + Sync) -> f64 {
    let part = |tet: usize| mesh.volume(tet) * mean(tet);
    let parts: Vec<f64> = (0..mesh.tets().len()).into_par_iter().map(part).collect();
    parts.iter().sum::<f64>().sqrt()
}
