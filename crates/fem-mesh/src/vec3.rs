//! Arithmetic of `[f64; 3]`: the few operations that the crates need.

pub type Vec3 = [f64; 3];

pub fn add(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub fn scale(s: f64, a: Vec3) -> Vec3 {
    [s * a[0], s * a[1], s * a[2]]
}

pub fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// The displacement of a rigid motion, of a point and its rotation, at an arm from it.
pub fn moved([displacement, rotation]: [Vec3; 2], arm: Vec3) -> Vec3 {
    add(displacement, cross(rotation, arm))
}

pub fn norm(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}

/// Of length one; not finite if it has no length.
pub fn unit(a: Vec3) -> Vec3 {
    scale(1.0 / norm(a), a)
}

pub fn is_finite(a: Vec3) -> bool {
    a.iter().all(|x| x.is_finite())
}

/// The first two of these vectors whose scalar product is not that of unit vectors at right angles, within an error,
/// and the product.
pub fn skewed(axes: [Vec3; 3], within: f64) -> Option<(usize, usize, f64)> {
    let pairs = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
    let mut products = pairs.into_iter().map(|(i, j)| (i, j, dot(axes[i], axes[j])));
    products.find(|(i, j, product)| {
        let off = (product - if i == j { 1.0 } else { 0.0 }).abs();
        off.is_nan() || off > within
    })
}

/// The sum of the components of `v` times these vectors.
pub fn combine(vectors: &[Vec3; 3], v: Vec3) -> Vec3 {
    let parts = vectors.iter().zip(v).map(|(vector, part)| scale(part, *vector));
    parts.fold([0.0; 3], add)
}

/// Signed volume of a tetrahedron, positive if the nodes 1, 2, 3 turn counter-clockwise seen from
/// outside, opposite to node 0.
pub fn tet_volume(p: &[Vec3; 4]) -> f64 {
    dot(sub(p[1], p[0]), cross(sub(p[2], p[0]), sub(p[3], p[0]))) / 6.0
}

/// Half the cross product of two edges: the normal of a triangle times its area.
pub fn area_vector(p: &[Vec3; 3]) -> Vec3 {
    scale(0.5, cross(sub(p[1], p[0]), sub(p[2], p[0])))
}

/// Three points far from one another, by their places, and how far the third is from the line through the others, over
/// their distance. `None` without points; not a number if all are one.
pub fn far_apart(points: &[Vec3]) -> Option<([usize; 3], f64)> {
    let farthest = |from: &dyn Fn(Vec3) -> f64| {
        let all = points.iter().enumerate().map(|(k, p)| (k, from(*p)));
        all.reduce(|best, next| if next.1 > best.1 { next } else { best })
    };
    let from = |origin: Vec3| {
        farthest(&|p| {
            let arm = sub(p, origin);
            dot(arm, arm)
        })
    };
    let first = from(*points.first()?)?.0;
    let (second, square) = from(points[first])?;
    let axis = sub(points[second], points[first]);
    let (third, off) = farthest(&|p| norm(cross(axis, sub(p, points[first]))))?;
    Some(([first, second, third], off / square))
}

/// Mean of the points.
pub fn centroid<const N: usize>(p: &[Vec3; N]) -> Vec3 {
    let sum = p.iter().fold([0.0; 3], |s, &x| add(s, x));
    scale(1.0 / N as f64, sum)
}
