//! Errors of a displacement against a known one.

use signorini_fem_mesh::fields::{FieldError, integrate};
use signorini_fem_mesh::{Materials, TetMesh};

type Gradient = [[f64; 3]; 3];

/// The L2 norm of u - exact.
pub(crate) fn l2_error(
    mesh: &TetMesh,
    u: &[f64],
    exact: impl Fn([f64; 3]) -> [f64; 3] + Sync,
) -> Result<f64, FieldError> {
    let square = |x, u: [f64; 3], _: Gradient| u.iter().zip(exact(x)).map(|(u, e)| (u - e).powi(2)).sum();
    Ok(integrate(mesh, u, square)?.sqrt())
}

/// The H1 seminorm of u - exact, from the gradient of the exact one.
pub(crate) fn h1_seminorm_error(
    mesh: &TetMesh,
    u: &[f64],
    exact: impl Fn([f64; 3]) -> Gradient + Sync,
) -> Result<f64, FieldError> {
    let square = |x, _: [f64; 3], h: Gradient| {
        let both = h.as_flattened().iter().zip(exact(x).into_iter().flatten());
        both.map(|(h, e)| (h - e).powi(2)).sum()
    };
    Ok(integrate(mesh, u, square)?.sqrt())
}

/// Energy of the difference from the exact displacement of this gradient, in a body of one material.
pub(crate) fn energy_of_error(
    mesh: &TetMesh,
    materials: &Materials,
    u: &[f64],
    exact: impl Fn([f64; 3]) -> Gradient + Sync,
) -> Result<f64, FieldError> {
    let law = materials.get(0)?;
    integrate(mesh, u, |x, _, h| {
        let e = exact(x);
        let d = |i: usize, j: usize| h[i][j] - e[i][j];
        let shear = |i: usize, j: usize| d(i, j) + d(j, i);
        law.energy_density(&[d(0, 0), d(1, 1), d(2, 2), shear(1, 2), shear(0, 2), shear(0, 1)])
    })
}
