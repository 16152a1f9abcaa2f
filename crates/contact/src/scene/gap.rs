//! How far a contact surface is from what it may touch.

use super::friction::PlaceField;

/// The distance between the contact surface and the obstacle, measured along the outward normal.
#[derive(Debug, Clone)]
pub(crate) enum Gap {
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
