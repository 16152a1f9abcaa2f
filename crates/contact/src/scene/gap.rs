//! How far a contact surface is from what it may touch.

use super::friction::PlaceField;

/// The distance between the contact surface and the obstacle, measured along the outward normal.
#[derive(Debug, Clone)]
pub(crate) enum Gap {
    /// No gap: the surfaces touch.
    None,
    /// The same distance at every node, m.
    Constant(f64),
    /// Distance at a point, m; negative values mean that the body starts inside the obstacle.
    Field(PlaceField),
    /// The distance between two bodies along the normal, from their coordinates.
    Measured,
    /// The distance to an [`Obstacle`](crate::Obstacle) along the normal, from its shape.
    Obstacle,
}
