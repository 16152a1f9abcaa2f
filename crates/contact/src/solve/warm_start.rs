//! Start vectors of a step.

use crate::model::{DISCS, Model, Tangential};
use signorini_qp::{ProductSet, Segment};

/// Puts the friction forces of points that slid at the last level back on their circles: extrapolation leaves them a
/// little inside, where they would be taken for sticking.
pub(crate) fn restore_sliding(
    model: &Model,
    set: &ProductSet,
    sliding: &[bool],
    lambda: &mut [f64],
) {
    let Some(Segment::Discs { radii }) = set.segments().get(DISCS) else {
        return;
    };
    let start = model.tfeti.gluing().ranges().discs.start;
    for (point, _) in model.points.iter().zip(sliding).filter(|(_, s)| **s) {
        if let Tangential::Plane { row, .. } = point.tangential {
            let radius = radii[(row - start) / 2];
            let length = lambda[row].hypot(lambda[row + 1]);
            if length > 0.0 {
                lambda[row] *= radius / length;
                lambda[row + 1] *= radius / length;
            }
        }
    }
}
