//! The signed distance to a triangulated surface.
//!
//! The sign is that of the mean normal at the nearest place: of a facet its own, of an edge that of its two facets, of
//! a corner that of its facets weighted by angle (Bærentzen and Aanæs, 2005).

use crate::error::ContactError;
use crate::tolerances::RAY;
use rstar::{AABB, PointDistance, RTree, RTreeObject};
use signorini_fem_mesh::vec3::{add, cross, dot, is_finite, norm, scale, sub};
use std::collections::HashMap;

/// A triangulated surface in a tree.
pub(super) struct Facets {
    tree: RTree<Facet>,
}

/// A triangle with its normals.
struct Facet {
    corners: [[f64; 3]; 3],
    normal: [f64; 3],
    /// Mean normals at the corners, and at the edges from each corner to the next.
    corner_normals: [[f64; 3]; 3],
    edge_normals: [[f64; 3]; 3],
}

impl RTreeObject for Facet {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        AABB::from_points(&self.corners)
    }
}

impl PointDistance for Facet {
    fn distance_2(&self, point: &[f64; 3]) -> f64 {
        let way = sub(*point, self.nearest(*point).0);
        dot(way, way)
    }
}

impl Facets {
    pub(super) fn new(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Result<Self, ContactError> {
        let wrong = |facet, reason| ContactError::ObstacleFacet { facet, reason };
        if triangles.is_empty() {
            return Err(wrong(0, "does not exist: there are no triangles"));
        }
        let mut facets = Vec::with_capacity(triangles.len());
        let mut at_node = vec![[0.0; 3]; points.len()];
        let mut at_edge: HashMap<[u32; 2], [f64; 3]> = HashMap::new();
        for (k, triangle) in triangles.iter().enumerate() {
            if triangle.iter().any(|&n| n as usize >= points.len()) {
                return Err(wrong(k, "names a node that does not exist"));
            }
            let corners = triangle.map(|n| points[n as usize]);
            if !corners.iter().all(|c| is_finite(*c)) {
                return Err(wrong(k, "has a corner that is not finite"));
            }
            let area = cross(sub(corners[1], corners[0]), sub(corners[2], corners[0]));
            let normal = scale(1.0 / norm(area), area);
            if !is_finite(normal) {
                return Err(wrong(k, "has no area"));
            }
            for c in 0..3 {
                let [a, b, d] = [0, 1, 2].map(|i| corners[(c + i) % 3]);
                let [u, v] = [sub(b, a), sub(d, a)];
                let angle = norm(cross(u, v)).atan2(dot(u, v));
                let sum = &mut at_node[triangle[c] as usize];
                *sum = add(*sum, scale(angle, normal));
                let sum = at_edge.entry(edge(triangle, c)).or_default();
                *sum = add(*sum, normal);
            }
            facets.push((corners, normal));
        }
        let facet = |((corners, normal), triangle): (_, &[u32; 3])| Facet {
            corners,
            normal,
            corner_normals: triangle.map(|n| at_node[n as usize]),
            edge_normals: [0, 1, 2].map(|c| at_edge[&edge(triangle, c)]),
        };
        let facets = facets.into_iter().zip(triangles).map(facet).collect();
        Ok(Self {
            tree: RTree::bulk_load(facets),
        })
    }

    /// Signed distance of a place, m, and its gradient.
    pub(super) fn distance(&self, place: [f64; 3]) -> (f64, [f64; 3]) {
        let Some(facet) = is_finite(place).then(|| self.tree.nearest_neighbor(&place)).flatten() else {
            return (f64::NAN, [f64::NAN; 3]);
        };
        let (nearest, mean) = facet.nearest(place);
        let way = sub(place, nearest);
        if mean == facet.normal {
            return (dot(way, mean), mean);
        }
        let length = norm(way);
        let sign = if dot(way, mean) < 0.0 { -1.0 } else { 1.0 };
        // on an edge or a corner there is no direction of its own
        let size = norm(sub(facet.corners[1], facet.corners[0]));
        let gradient = if length > RAY * size {
            scale(sign / length, way)
        } else {
            scale(1.0 / norm(mean), mean)
        };
        (sign * length, gradient)
    }
}

/// The edge from a corner of a triangle to the next, as any of its triangles names it.
fn edge(triangle: &[u32; 3], corner: usize) -> [u32; 2] {
    let [a, b] = [triangle[corner], triangle[(corner + 1) % 3]];
    [a.min(b), a.max(b)]
}

impl Facet {
    /// The nearest place of the facet, and the mean normal there (Ericson, Real-Time Collision Detection, 5.1.5).
    fn nearest(&self, point: [f64; 3]) -> ([f64; 3], [f64; 3]) {
        let [a, b, c] = self.corners;
        let (ab, ac) = (sub(b, a), sub(c, a));
        let [(d1, d2), (d3, d4), (d5, d6)] = self.corners.map(|from| {
            let way = sub(point, from);
            (dot(ab, way), dot(ac, way))
        });
        if d1 <= 0.0 && d2 <= 0.0 {
            return (a, self.corner_normals[0]);
        }
        if d3 >= 0.0 && d4 <= d3 {
            return (b, self.corner_normals[1]);
        }
        let vc = d1 * d4 - d3 * d2;
        if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
            return (add(a, scale(d1 / (d1 - d3), ab)), self.edge_normals[0]);
        }
        if d6 >= 0.0 && d5 <= d6 {
            return (c, self.corner_normals[2]);
        }
        let vb = d5 * d2 - d1 * d6;
        if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
            return (add(a, scale(d2 / (d2 - d6), ac)), self.edge_normals[2]);
        }
        let va = d3 * d6 - d5 * d4;
        if va <= 0.0 && d4 >= d3 && d5 >= d6 {
            let t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
            return (add(b, scale(t, sub(c, b))), self.edge_normals[1]);
        }
        let sum = va + vb + vc;
        let inside = add(scale(vb / sum, ab), scale(vc / sum, ac));
        (add(a, inside), self.normal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cube [0, 2]^3, all faces of two triangles.
    fn cube() -> Facets {
        let points: Vec<[f64; 3]> = (0..8)
            .map(|k| [k & 1, k >> 1 & 1, k >> 2].map(|c| 2.0 * f64::from(c)))
            .collect();
        let quads = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        let triangles: Vec<[u32; 3]> = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        Facets::new(&points, &triangles).expect("cube")
    }

    #[test]
    fn the_distance_to_a_cube_is_known_everywhere() {
        let cube = cube();
        let mut worst = 0.0_f64;
        for k in 0..4000_u32 {
            // a lattice that meets faces, edges and corners from all sides, and its inside
            let [i, j, l] = [k % 16, k / 16 % 16, k / 256].map(|i| 0.37 * f64::from(i) - 1.7);
            let x = [i, j, l];
            let out = x.map(|c| (c - 1.0).abs() - 1.0);
            let far = norm(out.map(|c| c.max(0.0)));
            let exact = far + out.iter().fold(f64::NEG_INFINITY, |m, c| m.max(*c)).min(0.0);
            let (distance, gradient) = cube.distance(x);
            worst = worst.max((distance - exact).abs());
            assert!((norm(gradient) - 1.0).abs() < 1e-12);
            // a step along the gradient changes the distance by its length
            let (next, _) = cube.distance(add(x, scale(1e-6, gradient)));
            assert!((next - distance - 1e-6).abs() < 1e-9, "{x:?}: {distance} {next}");
        }
        assert!(worst < 1e-12, "{worst:e}");
    }

    #[test]
    fn on_a_corner_the_gradient_is_the_mean_normal() {
        let (distance, gradient) = cube().distance([2.0; 3]);
        assert_eq!(distance, 0.0);
        assert!(
            gradient.iter().all(|c| (c - 3f64.sqrt().recip()).abs() < 1e-12),
            "{gradient:?}"
        );
    }
}
