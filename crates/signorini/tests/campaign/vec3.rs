//! Arithmetic of vectors in space.

pub(crate) type Vec3 = [f64; 3];

pub(crate) fn add(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(crate) fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn scale(s: f64, a: Vec3) -> Vec3 {
    a.map(|v| s * v)
}

pub(crate) fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

pub(crate) fn norm(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}

/// Length one.
pub(crate) fn unit(a: Vec3) -> Vec3 {
    scale(1.0 / norm(a), a)
}

/// Without its part along a unit vector.
pub(crate) fn across(a: Vec3, unit: Vec3) -> Vec3 {
    sub(a, scale(dot(a, unit), unit))
}

/// The vector of a node in a table with three numbers a node.
pub(crate) fn at(table: &[f64], node: u32) -> Vec3 {
    let k = 3 * node as usize;
    [table[k], table[k + 1], table[k + 2]]
}
