//! Integrals of a displacement, for errors against a known one.

use crate::element::{Piece, integral};
use crate::mesh::TetMesh;

use super::strain::{FieldError, nodal_vectors};

/// Integral over the mesh of `of(point, displacement, gradient)` by quadrature of degree 5, `gradient[i][j]` =
/// d u_i / d x_j. If `of` is the square of an error, it is the square of the norm of that error.
///
/// # Errors
/// [`FieldError`] if the displacement has the wrong length or is not finite.
pub fn integrate(
    mesh: &TetMesh,
    u: &[f64],
    of: impl Fn([f64; 3], [f64; 3], [[f64; 3]; 3]) -> f64 + Sync,
) -> Result<f64, FieldError> {
    let u = nodal_vectors(mesh, u)?;
    let of = &of;
    Ok(integral(mesh, |tet| {
        let piece = Piece::new(mesh, tet, &u);
        move |l: &[f64; 4]| of(piece.place(l), piece.value(l), piece.gradient(l))
    }))
}
