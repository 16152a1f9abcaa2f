//! Directions about an axis.

use crate::tolerances::ON_AXIS;
use crate::vec3::{Vec3, cross, dot, norm, scale, sub};

/// Radial, tangential (right-handed) and axial unit vectors at `arm` from a point of the axis along the unit vector
/// `along`; `None` on the axis, up to rounding of lengths of this `size`.
pub fn cylindrical(arm: Vec3, along: Vec3, size: f64) -> Option<[Vec3; 3]> {
    let out = sub(arm, scale(dot(arm, along), along));
    let distance = norm(out);
    (distance > ON_AXIS * size).then(|| {
        let radial = scale(1.0 / distance, out);
        [radial, cross(along, radial), along]
    })
}
