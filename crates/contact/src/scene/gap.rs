//! How far a contact surface is from what it may touch.

use super::friction::PlaceField;
use std::fmt;

/// The distance between the contact surface and the obstacle, measured along the outward normal.
#[derive(Clone)]
#[non_exhaustive]
pub enum Gap {
    /// The surfaces touch: the offset vector stays zero.
    None,
    /// The same distance at every node, m.
    Constant(f64),
    /// Distance at a point, m; negative values mean that the body starts inside the obstacle.
    Field(PlaceField),
    /// The distance between the nodes of two bodies, along the normal: what coordinates say.
    Measured,
    /// The distance to an [`Obstacle`](crate::Obstacle) along the normal: what its shape says.
    Obstacle,
}

impl fmt::Debug for Gap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => f.write_str("None"),
            Self::Constant(value) => f.debug_tuple("Constant").field(value).finish(),
            Self::Field(_) => f.write_str("Field(..)"),
            Self::Measured => f.write_str("Measured"),
            Self::Obstacle => f.write_str("Obstacle"),
        }
    }
}
