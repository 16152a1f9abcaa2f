//! Orthonormal coarse rows.

use crate::error::ContactError;
use crate::model::Model;
use signorini_tfeti::OrthonormalCoarse;

/// The orthonormal coarse rows that the linear solver and the paper's methods need.
///
/// # Errors
/// [`ContactError::NotDetermined`] if no row stops some rigid motion. The check of equilibrium has found before that the loads do not
/// push along it.
pub(crate) fn orthonormal_coarse(model: &Model) -> Result<OrthonormalCoarse, ContactError> {
    let factor = model.tfeti.coarse_factor();
    factor.orthonormal().ok_or_else(|| {
        let motions = factor.free_motions();
        let words: Vec<String> = motions.iter().map(ToString::to_string).collect();
        let body = motions
            .first()
            .and_then(|m| m.bodies.first())
            .map_or(0, |b| b.body);
        ContactError::NotDetermined {
            body,
            count: motions.len(),
            motions: words.join("; "),
        }
    })
}
