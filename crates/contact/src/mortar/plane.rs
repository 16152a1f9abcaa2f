//! Points, polygons and triangles in the plane of a facet.

use crate::tolerances::{BENT_STEPS, NO_EXTENT};

pub(super) type Point = [f64; 2];

/// The range of no value, and of those in two ranges.
pub(super) const NOWHERE: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

pub(super) fn widened(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// The part of a polygon where a linear function is not negative.
pub(super) fn cut(polygon: &[Point], side: impl Fn(Point) -> f64) -> Vec<Point> {
    let mut out = Vec::with_capacity(polygon.len() + 1);
    for (k, &p) in polygon.iter().enumerate() {
        let q = polygon[(k + 1) % polygon.len()];
        let [a, b] = [side(p), side(q)];
        if a >= 0.0 {
            out.push(p);
        }
        if (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0) {
            let t = a / (a - b);
            out.push([0, 1].map(|c| p[c] + t * (q[c] - p[c])));
        }
    }
    out
}

/// Shape functions of a triangle at a point.
pub(super) fn barycentric(corners: &[Point; 3], p: Point) -> [f64; 3] {
    let [a, b, c] = *corners;
    let whole = cross(sub(b, a), sub(c, a));
    let [second, third] = [cross(sub(p, a), sub(c, a)), cross(sub(b, a), sub(p, a))].map(|v| v / whole);
    [1.0 - second - third, second, third]
}

/// Barycentric coordinates of a point in a triangle with bent edges 01, 12, 20: Newton's method for `x(l) = p`, `x` the
/// quadratic interpolation of corners and mid-nodes.
pub(super) fn place(corners: &[Point; 3], bend: Option<&[Point; 3]>, p: Point) -> [f64; 3] {
    let mut l = barycentric(corners, p);
    let (Some([e, f, g]), [a, b, c]) = (bend, *corners) else {
        return l;
    };
    let sum = |terms: [(f64, Point); 3]| [0, 1].map(|k| 4.0 * terms.iter().map(|(t, x)| t * x[k]).sum::<f64>());
    let plus = |a: Point, b: Point| [a[0] + b[0], a[1] + b[1]];
    for _ in 0..BENT_STEPS {
        let bent = sum([(l[0] * l[1], *e), (l[1] * l[2], *f), (l[2] * l[0], *g)]);
        let off = [0, 1].map(|k| p[k] - bent[k] - (0..3).map(|i| l[i] * corners[i][k]).sum::<f64>());
        // derivatives along the second and the third coordinate
        let u = plus(sub(b, a), sum([(l[0] - l[1], *e), (l[2], *f), (-l[2], *g)]));
        let v = plus(sub(c, a), sum([(-l[1], *e), (l[1], *f), (l[0] - l[2], *g)]));
        let det = cross(u, v);
        let [s, t] = [cross(off, v) / det, cross(u, off) / det];
        if !(s.is_finite() && t.is_finite()) {
            break;
        }
        l = [l[0] - s - t, l[1] + s, l[2] + t];
    }
    l
}

/// Inverse of a symmetric matrix `[xx, xy, yy]` of second moments, without directions in which there is no extent.
pub(super) fn pseudo_inverse([xx, xy, yy]: [f64; 3]) -> [f64; 3] {
    let (mean, half) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
    let (large, small) = (mean + half, (xx * yy - xy * xy) / (mean + half));
    if small > NO_EXTENT * large {
        let det = large * small;
        return [yy / det, -xy / det, xx / det];
    }
    // the direction of the larger one: a column of the matrix minus the smaller one
    let [x, y] = if xx > yy { [xx, xy] } else { [xy, yy] };
    let scale = large * (x * x + y * y);
    [x * x / scale, x * y / scale, y * y / scale]
}

/// Area of a polygon, counter-clockwise positive.
pub(super) fn area(polygon: &[Point]) -> f64 {
    let first = polygon[0];
    let pairs = polygon[1..].windows(2);
    pairs.map(|p| 0.5 * cross(sub(p[0], first), sub(p[1], first))).sum()
}

pub(super) fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

pub(super) fn mean(a: Point, b: Point) -> Point {
    [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]
}

pub(super) fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}
