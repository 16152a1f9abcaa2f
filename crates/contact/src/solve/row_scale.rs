//! How far the natural map of the active sets moves along each row.

use crate::model::Model;
use crate::tolerances::{SHARED_ROWS, STIFF_GRADED, STIFF_MEANS, STIFF_ROWS};
use signorini_fem_mesh::decomposition::is_strongly_graded;

/// The stiffness of each contact row, N/m in row units, bounded by that of its bodies as a whole, in series with its own
/// compliance; zero behind the contact rows, of so many `rows` in all.
pub(super) fn row_scale(model: &Model, rows: usize) -> Vec<f64> {
    let contact = model.contact_rows().end;
    let mut scale = vec![0.0; rows];
    model.tfeti.row_stiffness(0..contact, &mut scale[..contact]);
    // a row of length l moves l times as far and takes l times the force: of `b K bᵀ` its step needs the part l⁻⁴
    for point in model.points.iter().filter(|point| point.stretch[1] != 1.0) {
        if let Some((row, 2, _)) = point.tangential_rows() {
            scale[row + 1] /= point.stretch[1].powi(4);
        }
    }
    let mut compliance = vec![0.0; contact];
    model.tfeti.row_compliance(0..contact, &mut compliance);
    let flat = || scale.iter().zip(&compliance).any(|(k, c)| k * c > STIFF_ROWS);
    let stiff = match model.scene.mesh.order() {
        2 => STIFF_MEANS,
        _ if flat() && is_strongly_graded(&model.scene.mesh) => STIFF_GRADED,
        _ => STIFF_ROWS,
    };
    for (scale, compliance) in scale.iter_mut().zip(compliance) {
        *scale = scale.min(stiff / compliance);
    }
    let gluing = model.tfeti.gluing();
    for (scale, own) in scale.iter_mut().zip(gluing.contact_compliance()) {
        *scale /= 1.0 + own * *scale;
    }
    let shared = |row: usize| gluing.node(row).is_some_and(|n| gluing.is_dependent(n));
    for (_, scale) in scale.iter_mut().enumerate().take(contact).filter(|s| shared(s.0)) {
        *scale *= SHARED_ROWS;
    }
    scale
}
