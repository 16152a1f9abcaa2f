//! Errors of a displacement against a known one, by quadrature of degree 5.

use crate::element::{Piece, integral, strain_of};
use crate::material::Materials;
use crate::mesh::TetMesh;
use crate::vec3::{dot, sub};

use super::strain::{FieldError, nodal_vectors};

/// The L2 norm of u - exact over the mesh. With `u` zero it is the norm of `exact`.
///
/// # Errors
/// [`FieldError`] if the displacement has the wrong length or is not finite.
pub fn l2_error(mesh: &TetMesh, u: &[f64], exact: impl Fn([f64; 3]) -> [f64; 3] + Sync) -> Result<f64, FieldError> {
    let u = nodal_vectors(mesh, u)?;
    let exact = &exact;
    let square = integral(mesh, |tet| {
        let piece = Piece::new(mesh, tet, &u);
        move |l: &[f64; 4]| {
            let error = sub(piece.value(l), exact(piece.place(l)));
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
        let piece = Piece::new(mesh, tet, &u);
        move |l: &[f64; 4]| {
            let exact = exact(piece.place(l));
            let rows = piece.gradient(l).into_iter().zip(exact).map(|(g, e)| sub(g, e));
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
    let u = nodal_vectors(mesh, u)?;
    let exact = &exact_gradient;
    Ok(integral(mesh, |tet| {
        let (piece, law) = (Piece::new(mesh, tet, &u).with_law(laws[tet]), laws[tet]);
        move |l: &[f64; 4]| {
            let (exact, own) = (strain_of(&exact(piece.place(l))), piece.strain(l));
            law.energy_density(&std::array::from_fn(|i| exact[i] - own[i]))
        }
    }))
}
