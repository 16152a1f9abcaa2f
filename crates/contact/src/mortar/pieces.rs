//! Triangles of the other side in the plane of a facet, and what of them is inside it.

use crate::tolerances::{BENT_STEPS, COVERED};
use signorini_fem_mesh::internal::facet_shape;

pub(super) type Point = [f64; 2];

/// A triangle of the other side, laid into the plane of the facet: corners, counter-clockwise, and their node numbers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Laid {
    pub(super) corners: [Point; 3],
    pub(super) nodes: [u32; 3],
    /// Nodes on the edges 01, 12, 20 in a mesh of order 2.
    pub(super) mids: Option<[u32; 3]>,
    /// How far they are from the middles of the corners; `None` if they are there.
    pub(super) bend: Option<[Point; 3]>,
    /// How high its nodes are over the plane of the facet, m: corners, then mid-nodes.
    pub(super) heights: [f64; 6],
    /// How high the curve that it stands for is over its edges 01, 12, 20, m, towards the facet.
    pub(super) arcs: [f64; 3],
    /// Where a displacement is to be taken from its tetrahedron to the facet, the way there.
    pub(super) way: Option<Way>,
}

impl Laid {
    /// Nodes whose displacements count: its own, corners first, then those behind it.
    pub(super) fn all_nodes(&self) -> impl Iterator<Item = u32> {
        let behind = if self.mids.is_some() { 4 } else { 1 };
        let others = self
            .way
            .into_iter()
            .flat_map(move |way| way.nodes.into_iter().take(behind));
        let mids = self.mids.into_iter().flatten();
        self.nodes.into_iter().chain(mids).chain(others)
    }

    /// Barycentric coordinates of a point, and the shape functions of its own nodes there.
    pub(super) fn shape(&self, p: Point) -> ([f64; 3], [f64; 6]) {
        let l = place(&self.corners, self.bend.as_ref(), p);
        match self.mids {
            Some(_) => (l, facet_shape(&l)),
            None => (l, [l[0], l[1], l[2], 0.0, 0.0, 0.0]),
        }
    }

    /// How high it is over the plane of the facet where its nodes have these shape functions, m.
    pub(super) fn height(&self, shape: &[f64; 6]) -> f64 {
        shape.iter().zip(&self.heights).map(|(n, h)| n * h).sum()
    }
}

/// The way from a triangle that is not in the plane of the facet to the facet, and what a displacement changes on it:
/// as in the tetrahedron behind the triangle, linearly.
#[derive(Debug, Clone, Copy)]
pub(super) struct Way {
    /// The other nodes of the tetrahedron: the one opposite, in a mesh of order 2 the mid-nodes of its edges, too.
    pub(super) nodes: [u32; 4],
    /// At each corner the derivatives of the shape functions along the normal of the facet, 1/m: those of the nodes of
    /// the triangle, then of the others.
    pub(super) slopes: [[f64; 10]; 3],
}

impl Way {
    /// The shape functions of the triangle and of the other nodes of the tetrahedron at barycentric coordinates, where
    /// the way is so `far`, m.
    pub(super) fn shape(&self, l: &[f64; 3], plain: &[f64; 6], far: f64) -> [f64; 10] {
        let slope = |k: usize| (0..3).map(|c| l[c] * self.slopes[c][k]).sum::<f64>();
        std::array::from_fn(|k| plain.get(k).copied().unwrap_or(0.0) - far * slope(k))
    }
}

/// A facet in its plane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Flat {
    pub(super) corners: [Point; 3],
    /// Its nodes in a mesh of order 2, corners first.
    pub(super) nodes: Option<[u32; 6]>,
    /// As of [`Laid`].
    pub(super) bend: Option<[Point; 3]>,
    /// How high its mid-nodes are over the plane, m.
    pub(super) heights: [f64; 3],
}

/// What is left of a triangle inside a facet.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    pub(super) polygon: Vec<Point>,
    pub(super) area: f64,
    pub(super) laid: Laid,
    /// The smallest distance of the triangle over it, m; negative inside.
    pub(super) nearest: f64,
}

impl Piece {
    /// The part of a triangle inside a facet (corners counter-clockwise); `None` if they do not overlap.
    pub(super) fn new(facet: &[Point; 3], laid: Laid) -> Option<Self> {
        let mut polygon = laid.corners.to_vec();
        let whole = area(facet);
        for k in 0..3 {
            let [from, to] = [facet[k], facet[(k + 1) % 3]];
            polygon = cut(&polygon, |p| cross(sub(to, from), sub(p, from)));
            if polygon.len() < 3 {
                return None;
            }
        }
        let area = area(&polygon);
        let height = |p: &Point| {
            barycentric(&laid.corners, *p)
                .iter()
                .zip(&laid.heights)
                .map(|(l, h)| l * h)
                .sum()
        };
        let nearest = polygon.iter().map(height).fold(f64::INFINITY, f64::min);
        (area > COVERED * whole).then_some(Self {
            polygon,
            area,
            laid,
            nearest,
        })
    }

    /// Its point nearest to a point, with the square of the distance.
    pub(super) fn closest(&self, p: Point) -> (f64, Point) {
        let sides = || (0..self.polygon.len()).map(|k| [self.polygon[k], self.polygon[(k + 1) % self.polygon.len()]]);
        if sides().all(|[a, b]| cross(sub(b, a), sub(p, a)) >= 0.0) {
            return (0.0, p);
        }
        let on = |[a, b]: [Point; 2]| {
            let (along, way) = (sub(b, a), sub(p, a));
            let length = along[0] * along[0] + along[1] * along[1];
            let t = if length > 0.0 { (along[0] * way[0] + along[1] * way[1]) / length } else { 0.0 };
            let q = [0, 1].map(|c| a[c] + t.clamp(0.0, 1.0) * along[c]);
            let [x, y] = sub(p, q);
            (x * x + y * y, q)
        };
        let found = sides().map(on).min_by(|a, b| a.0.total_cmp(&b.0));
        found.unwrap_or((f64::INFINITY, p))
    }

    /// Mean of the points.
    pub(super) fn middle(&self) -> Point {
        let count = self.polygon.len() as f64;
        [0, 1].map(|c| self.polygon.iter().map(|p| p[c]).sum::<f64>() / count)
    }

    /// Calls `f` at the points of a rule for triangles, or without one of that of the middles of edges, which is exact
    /// for squares, with their weights, m².
    pub(super) fn integrate(&self, rule: Option<&[([f64; 3], f64)]>, mut f: impl FnMut(Point, f64)) {
        let first = self.polygon[0];
        for pair in self.polygon[1..].windows(2) {
            let triangle = [first, pair[0], pair[1]];
            let whole = area(&triangle);
            match rule {
                Some(rule) => rule.iter().for_each(|(l, weight)| {
                    let point = [0, 1].map(|c| (0..3).map(|k| l[k] * triangle[k][c]).sum());
                    f(point, weight * whole);
                }),
                None => (0..3).for_each(|k| f(mean(triangle[k], triangle[(k + 1) % 3]), whole / 3.0)),
            }
        }
    }
}

/// The part of a polygon where a linear function is not negative.
fn cut(polygon: &[Point], side: impl Fn(Point) -> f64) -> Vec<Point> {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A place in a triangle with bent edges is where its shape functions put it.
    #[test]
    fn places_in_bent_triangles_are_found() {
        let corners = [[0.0, 0.0], [1.0, 0.1], [0.2, 0.9]];
        let bend = [[0.02, -0.09], [0.07, 0.06], [0.0, 0.03]];
        let mid = |k: usize| {
            let middle = mean(corners[k], corners[(k + 1) % 3]);
            [0, 1].map(|c| middle[c] + bend[k][c])
        };
        let nodes = [corners[0], corners[1], corners[2], mid(0), mid(1), mid(2)];
        for p in [[0.3, 0.3], [0.01, 0.0], [0.95, 0.1], [0.25, 0.85], [0.5, 0.05]] {
            let shape = facet_shape(&place(&corners, Some(&bend), p));
            let found = [0, 1].map(|c| (0..6).map(|k| shape[k] * nodes[k][c]).sum::<f64>());
            assert!(sub(found, p).iter().all(|d| d.abs() < 1e-14), "{p:?}: {found:?}");
        }
    }
}
