//! How a rigid coupling has moved.

/// The motion of a [coupling](crate::Coupling).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct CouplingMotion {
    /// Displacement of its reference point, m.
    pub displacement: [f64; 3],
    /// Rotation about x, y, z, radians.
    pub rotation: [f64; 3],
}
