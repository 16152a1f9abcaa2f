//! Rigid motions that no row stops.

use crate::error::ContactError;
use crate::model::{Model, freed};
use crate::status::FreeCoupling;
use signorini_qp::vector;
use signorini_tfeti::{BodyMotion, FreeMotion};

/// The error that some rigid motions are stopped by nothing.
pub(super) fn not_determined(model: &Model, motions: &[FreeMotion]) -> ContactError {
    let words: Vec<String> = motions.iter().map(ToString::to_string).collect();
    let body = motions.first().and_then(|m| m.bodies.first());
    ContactError::NotDetermined {
        body: body.map_or(0, |b| b.body),
        node: body.map_or(0, |b| model.discrete.decomposition.subdomains()[b.subdomain].nodes[0]),
        count: motions.len(),
        motions: words.join("; "),
        in_contact: !model.points.is_empty(),
        coupling: motions.iter().find_map(|motion| left_free(model, motion)).map(Box::new),
    }
}

/// The coupling that leaves a motion free.
fn left_free(model: &Model, motion: &FreeMotion) -> Option<FreeCoupling> {
    let size = |b: &BodyMotion| vector::norm(&b.translation).hypot(vector::norm(&b.rotation));
    let bodies = motion.bodies.iter().map(|b| (size(b), b.radius));
    freed(model, &[motion], &[1.0], bodies.max_by(|a, b| a.0.total_cmp(&b.0))?)
}
