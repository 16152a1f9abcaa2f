//! What a place sees of an obstacle.

use crate::tolerances::ENDED;

/// Distance and direction of an obstacle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Seen {
    /// Signed distance, m.
    pub(crate) distance: f64,
    pub(crate) gradient: [f64; 3],
    /// Where a side has ended before the place, the signed distance to its continuation across the gradient, m;
    /// elsewhere the distance.
    pub(crate) level: f64,
    /// Whether a side has ended before the place, with the gradient that is most opposite to a direction.
    pub(crate) ends: bool,
}

impl Seen {
    pub(super) fn new(distance: f64, gradient: [f64; 3]) -> Self {
        Self {
            distance,
            gradient,
            level: distance,
            ends: false,
        }
    }

    /// Whether nothing of the obstacle is met along the gradient.
    pub(crate) fn has_ended(&self) -> bool {
        self.ends && self.level < ENDED * self.distance
    }
}
