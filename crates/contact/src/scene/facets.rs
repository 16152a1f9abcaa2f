//! The signed distance to a triangulated surface.
//!
//! The sign is that of the mean normal at the nearest place: of a facet its own, of an edge that of its two facets, of
//! a corner that of its facets weighted by angle (Bærentzen and Aanæs, 2005). Beyond the rim of an open surface there
//! is no inside.

use super::seen::Seen;
use crate::error::ContactError;
use crate::tolerances::{LARGEST, RIM, SAME_NORMAL, SHARP};
use rstar::{AABB, PointDistance, RTree, RTreeObject};
use signorini_fem_mesh::internal::ascending;
use signorini_fem_mesh::vec3::{add, area_vector, cross, dot, is_finite, norm, scale, sub, unit};
use std::collections::{HashMap, HashSet};

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
    /// What these corners and edges are.
    corner_ends: [At; 3],
    edge_ends: [At; 3],
}

/// The nearest place of a facet.
struct Nearest {
    place: [f64; 3],
    /// Mean normal there.
    mean: [f64; 3],
    at: At,
}

#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum At {
    /// Between its edges.
    Middle,
    /// On an edge or corner with facets all around.
    Edge,
    /// On a sharp one.
    Sharp,
    /// Where the surface ends.
    Rim,
}

impl RTreeObject for Facet {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        AABB::from_points(&self.corners)
    }
}

impl PointDistance for Facet {
    fn distance_2(&self, point: &[f64; 3]) -> f64 {
        let way = sub(*point, self.nearest(*point).place);
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
        let mut at_edge: HashMap<[u32; 2], Edge> = HashMap::new();
        let (same, mut turns) = (first_at_place(points), HashSet::new());
        for (k, triangle) in triangles.iter().enumerate() {
            if triangle.iter().any(|&n| n as usize >= points.len()) {
                return Err(wrong(k, "names a node that does not exist"));
            }
            let triangle = &triangle.map(|n| same[n as usize]);
            let corners = triangle.map(|n| points[n as usize]);
            if !corners.iter().all(|c| is_finite(*c)) {
                return Err(wrong(k, "has a corner that is not finite"));
            }
            if corners.as_flattened().iter().any(|x| x.abs() > LARGEST) {
                return Err(wrong(k, "has a corner beyond 1e70; take other units"));
            }
            let normal = unit(area_vector(&corners));
            if !is_finite(normal) {
                return Err(wrong(k, "has no area"));
            }
            let [a, b, c] = *triangle;
            if turns.contains(&cyclic([a, c, b])) {
                return Err(wrong(k, "lies on another one and turns the other way round"));
            }
            if !turns.insert(cyclic(*triangle)) {
                continue;
            }
            for c in 0..3 {
                let [a, b, d] = [0, 1, 2].map(|i| corners[(c + i) % 3]);
                let [u, v] = [sub(b, a), sub(d, a)];
                let angle = norm(cross(u, v)).atan2(dot(u, v));
                let sum = &mut at_node[triangle[c] as usize];
                *sum = add(*sum, scale(angle, normal));
                let own = at_edge.entry(edge(triangle, c)).or_default();
                own.normal = add(own.normal, normal);
                own.facets.push((k, triangle[c] < triangle[(c + 1) % 3]));
            }
            facets.push((corners, normal, *triangle));
        }
        let turned = at_edge.values().filter_map(Edge::turned).min();
        if let Some(facet) = turned {
            return Err(wrong(facet, "turns the other way round than its neighbour"));
        }
        let mut node_ends = vec![At::Edge; points.len()];
        for (nodes, own) in &at_edge {
            for end in nodes.map(|n| n as usize) {
                if own.end() > node_ends[end] {
                    node_ends[end] = own.end();
                }
            }
        }
        let facet = |(corners, normal, triangle): (_, _, [u32; 3])| {
            let edges = [0, 1, 2].map(|c| &at_edge[&edge(&triangle, c)]);
            Facet {
                corners,
                normal,
                corner_normals: triangle.map(|n| at_node[n as usize]),
                edge_normals: edges.map(|own| own.normal),
                corner_ends: triangle.map(|n| node_ends[n as usize]),
                edge_ends: edges.map(Edge::end),
            }
        };
        let facets = facets.into_iter().map(facet).collect();
        Ok(Self {
            tree: RTree::bulk_load(facets),
        })
    }

    /// Signed distance of a place, m, and its gradient; turned inside out with a `side` of -1 instead of 1. On an edge
    /// or a corner, where there are many, the gradient is the mean normal, or the one that is most opposite to a
    /// direction; so it is beyond a sharp edge or the rim, if a direction is told.
    pub(super) fn distance(&self, place: [f64; 3], side: f64, against: Option<[f64; 3]>) -> Seen {
        let Some(facet) = is_finite(place).then(|| self.tree.nearest_neighbor(&place)).flatten() else {
            return Seen::new(f64::NAN, [f64::NAN; 3]);
        };
        let Nearest {
            place: nearest,
            mean,
            at,
        } = facet.nearest(place);
        let way = sub(place, nearest);
        let size = norm(sub(facet.corners[1], facet.corners[0]));
        let normal = scale(side, facet.normal);
        let beside = norm(sub(way, scale(dot(way, normal), normal)));
        if at == At::Middle || at == At::Rim && beside <= RIM * size {
            return Seen::new(dot(way, normal), normal);
        }
        let length = norm(way);
        let inside = at != At::Rim && side * dot(way, mean) < 0.0;
        let sign = if inside { -1.0 } else { 1.0 };
        let out = scale(sign / length, way);
        let opposite = |also: Option<[f64; 3]>| {
            let around = |direction| self.opposite((nearest, RIM * size), side, (direction, also));
            against.and_then(around)
        };
        if length <= RIM * size && at != At::Rim {
            let gradient = opposite(None).unwrap_or(scale(side / norm(mean), mean));
            return Seen::new(sign * length, gradient);
        }
        let is_end = at >= At::Sharp && !inside;
        match is_end.then(|| opposite(Some(out))).flatten() {
            None => Seen::new(sign * length, out),
            Some(gradient) => Seen {
                level: dot(way, gradient).min(length),
                ends: true,
                ..Seen::new(length, gradient)
            },
        }
    }

    /// Of all combinations of the normals around a place, and of another vector, with factors that are not negative,
    /// the unit vector that is most opposite to a direction.
    fn opposite(
        &self,
        (place, within): ([f64; 3], f64),
        side: f64,
        (direction, also): ([f64; 3], Option<[f64; 3]>),
    ) -> Option<[f64; 3]> {
        let around = AABB::from_corners(place.map(|c| c - within), place.map(|c| c + within));
        let touched = self.tree.locate_in_envelope_intersecting(&around);
        let touched = touched.filter(|f| norm(sub(place, f.nearest(place).place)) <= within);
        let mut normals: Vec<[f64; 3]> = Vec::from_iter(also);
        for normal in touched.map(|f| scale(side, f.normal)) {
            if normals.iter().all(|n| dot(*n, normal) <= SAME_NORMAL) {
                normals.push(normal);
            }
        }
        let wanted = scale(-1.0, direction);
        let mut best: Option<([f64; 3], f64)> = None;
        let mut consider = |vector: [f64; 3]| {
            let unit = unit(vector);
            let cosine = dot(unit, wanted);
            if cosine.is_finite() && best.is_none_or(|b| cosine > b.1) {
                best = Some((unit, cosine));
            }
        };
        for (i, a) in normals.iter().enumerate() {
            consider(*a);
            for (j, b) in normals[..i].iter().enumerate() {
                // what is nearest in their plane lies between them
                let [c, p, q] = [dot(*a, *b), dot(*a, wanted), dot(*b, wanted)];
                if p > c * q && q > c * p {
                    consider(add(scale(p - c * q, *a), scale(q - c * p, *b)));
                }
                for d in &normals[..j] {
                    let spanned = dot(*a, cross(*b, *d));
                    let parts = [cross(*b, *d), cross(*d, *a), cross(*a, *b)];
                    if parts.iter().all(|part| dot(*part, wanted) * spanned > 0.0) {
                        consider(wanted);
                    }
                }
            }
        }
        best.map(|b| b.0)
    }
}

/// What meets at an edge.
#[derive(Default)]
struct Edge {
    /// Sum of the normals.
    normal: [f64; 3],
    /// Facets, and whether their corners pass it towards the larger number.
    facets: Vec<(usize, bool)>,
}

impl Edge {
    fn end(&self) -> At {
        // twice the cosine, and two
        let both = dot(self.normal, self.normal);
        match self.facets.len() {
            1 => At::Rim,
            2 if both < 2.0 * (1.0 + SHARP) => At::Sharp,
            _ => At::Edge,
        }
    }

    /// The later one of two facets that pass it in one direction.
    fn turned(&self) -> Option<usize> {
        match self.facets[..] {
            [(_, a), (later, b)] if a == b => Some(later),
            _ => None,
        }
    }
}

/// The corners of a triangle, the smallest number first.
fn cyclic([a, b, c]: [u32; 3]) -> [u32; 3] {
    match a.min(b).min(c) {
        least if least == a => [a, b, c],
        least if least == b => [b, c, a],
        _ => [c, a, b],
    }
}

/// For each place the number of the first that is equal: files of surfaces often give each triangle corners of its own.
fn first_at_place(points: &[[f64; 3]]) -> Vec<u32> {
    let mut known = HashMap::new();
    // one zero
    let bits = |x: &[f64; 3]| x.map(|c| (c + 0.0).to_bits());
    let numbered = (0..).zip(points);
    numbered.map(|(k, x)| *known.entry(bits(x)).or_insert(k)).collect()
}

/// The edge from a corner of a triangle to the next, as any of its triangles names it.
fn edge(triangle: &[u32; 3], corner: usize) -> [u32; 2] {
    ascending([triangle[corner], triangle[(corner + 1) % 3]])
}

impl Facet {
    /// The nearest place of the facet, and the mean normal there (Ericson, Real-Time Collision Detection, 5.1.5).
    fn nearest(&self, point: [f64; 3]) -> Nearest {
        let [a, b, c] = self.corners;
        let corner = |k: usize| Nearest {
            place: self.corners[k],
            mean: self.corner_normals[k],
            at: self.corner_ends[k],
        };
        let edge = |k: usize, place| Nearest {
            place,
            mean: self.edge_normals[k],
            at: self.edge_ends[k],
        };
        let (ab, ac) = (sub(b, a), sub(c, a));
        let [(d1, d2), (d3, d4), (d5, d6)] = self.corners.map(|from| {
            let way = sub(point, from);
            (dot(ab, way), dot(ac, way))
        });
        if d1 <= 0.0 && d2 <= 0.0 {
            return corner(0);
        }
        if d3 >= 0.0 && d4 <= d3 {
            return corner(1);
        }
        let vc = d1 * d4 - d3 * d2;
        if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
            return edge(0, add(a, scale(d1 / (d1 - d3), ab)));
        }
        if d6 >= 0.0 && d5 <= d6 {
            return corner(2);
        }
        let vb = d5 * d2 - d1 * d6;
        if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
            return edge(2, add(a, scale(d2 / (d2 - d6), ac)));
        }
        let va = d3 * d6 - d5 * d4;
        if va <= 0.0 && d4 >= d3 && d5 >= d6 {
            let t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
            return edge(1, add(b, scale(t, sub(c, b))));
        }
        let sum = va + vb + vc;
        let inside = add(scale(vb / sum, ab), scale(vc / sum, ac));
        Nearest {
            place: add(a, inside),
            mean: self.normal,
            at: At::Middle,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cube [0, 2]^3, all faces of two triangles.
    fn cube() -> Facets {
        let (points, triangles) = cube_triangles();
        Facets::new(&points, &triangles).expect("cube")
    }

    fn cube_triangles() -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
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
        let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        (points, triangles.collect())
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
            let Seen { distance, gradient, .. } = cube.distance(x, 1.0, None);
            worst = worst.max((distance - exact).abs());
            assert!((norm(gradient) - 1.0).abs() < 1e-12);
            // a step along the gradient changes the distance by its length
            let next = cube.distance(add(x, scale(1e-6, gradient)), 1.0, None).distance;
            assert!((next - distance - 1e-6).abs() < 1e-9, "{x:?}: {distance} {next}");
        }
        assert!(worst < 1e-12, "{worst:e}");
    }

    #[test]
    fn on_a_corner_the_gradient_is_the_mean_normal() {
        let Seen { distance, gradient, .. } = cube().distance([2.0; 3], 1.0, None);
        assert_eq!(distance, 0.0);
        assert!(
            gradient.iter().all(|c| (c - 3f64.sqrt().recip()).abs() < 1e-12),
            "{gradient:?}"
        );
    }

    #[test]
    fn on_edges_and_corners_the_gradient_may_be_chosen() {
        let cube = cube();
        for (place, wanted, found) in [
            // flush with a face, over the edge, beyond what the faces span, and in their plane
            ([2.0, 1.0, 2.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]),
            ([2.0, 1.0, 2.0], [1.0, 0.0, 2.0], [1.0, 0.0, 2.0]),
            ([2.0, 1.0, 2.0], [-1.0, 0.0, 2.0], [0.0, 0.0, 1.0]),
            ([2.0, 1.0, 2.0], [1.0, 1.0, 2.0], [1.0, 0.0, 2.0]),
            ([2.0, 2.0, 2.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]),
            ([2.0, 2.0, 2.0], [1.0, 2.0, 3.0], [1.0, 2.0, 3.0]),
            ([2.0, 2.0, 2.0], [1.0, -2.0, 3.0], [1.0, 0.0, 3.0]),
        ] {
            let Seen { distance, gradient, .. } = cube.distance(place, 1.0, Some(scale(-1.0, unit(wanted))));
            assert_eq!(distance, 0.0);
            assert!(norm(sub(gradient, unit(found))) < 1e-14, "{wanted:?}: {gradient:?}");
        }
    }

    /// A triangle file gives each triangle corners of its own.
    #[test]
    fn corners_at_one_place_are_one() {
        let (points, triangles) = cube_triangles();
        let corners: Vec<[f64; 3]> = triangles.iter().flatten().map(|&n| points[n as usize]).collect();
        let own: Vec<[u32; 3]> = (0..12).map(|k| [0, 1, 2].map(|c| 3 * k + c)).collect();
        let (whole, apart) = (cube(), Facets::new(&corners, &own).expect("cube"));
        for k in 0..1000_u32 {
            let x = [k % 10, k / 10 % 10, k / 100].map(|i| 0.43 * f64::from(i) - 1.1);
            let [a, b] = [&whole, &apart].map(|cube| cube.distance(x, 1.0, None));
            assert!(
                (a.distance - b.distance).abs() < 1e-14 && norm(sub(a.gradient, b.gradient)) < 1e-12,
                "{x:?}: {a:?} {b:?}"
            );
        }
    }

    /// The surface does not go on beyond its rim, where all places are outside of either side.
    #[test]
    fn an_open_surface_ends_at_its_rim() {
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let plate = Facets::new(&points, &[[0, 1, 2], [0, 2, 3]]).expect("plate");
        for side in [1.0, -1.0] {
            for height in [0.3, 1e-17, 0.0, -1e-17, -0.2] {
                for (x, y) in [(1.5, 0.4), (0.3, -0.5), (1.3, 1.4), (-0.4, 0.0)] {
                    let beside: [f64; 2] = [x, y].map(|c: f64| (c - 0.5).abs() - 0.5);
                    let far = norm([beside[0].max(0.0), beside[1].max(0.0), height]);
                    let Seen { distance, gradient, .. } = plate.distance([x, y, height], side, None);
                    assert!((distance - far).abs() < 1e-15, "{x} {y} {height}: {distance}");
                    assert!((gradient[2] - height / far).abs() < 1e-15);
                    // from above it goes on as a plane, on which nothing is met
                    let seen = plate.distance([x, y, height], side, Some([0.0, 0.0, -side]));
                    assert_eq!((seen.distance, seen.ends), (distance, true));
                    assert!((seen.gradient[2] - side).abs() < 1e-15 && seen.level == side * height);
                }
                // over it, and over the rim itself
                for (x, y) in [(0.3, 0.4), (0.5, 0.5), (1.0, 0.4), (0.0, 1.0)] {
                    let found = plate.distance([x, y, height], side, None);
                    assert_eq!((found.distance, found.gradient[2]), (side * height, side));
                }
            }
        }
    }

    /// Beyond what products of four lengths hold there is no nearest place.
    #[test]
    fn corners_too_far_away_are_refused() {
        let (points, triangles) = cube_triangles();
        let of = |size: f64| {
            let corners: Vec<_> = points.iter().map(|p| scale(size / 2.0, *p)).collect();
            Facets::new(&corners, &triangles)
        };
        for size in [1e77, 1e200, f64::INFINITY] {
            let found = of(size).err();
            assert!(
                matches!(found, Some(ContactError::ObstacleFacet { facet: 0, .. })),
                "{size}: {found:?}"
            );
        }
        let far = of(LARGEST)
            .expect("a cube")
            .distance([2.0 * LARGEST, 0.4 * LARGEST, 0.3 * LARGEST], 1.0, None);
        assert!((far.distance / LARGEST - 1.0).abs() < 1e-12, "{far:?}");
    }

    #[test]
    fn facets_that_turn_unlike_their_neighbours_are_refused() {
        let (points, mut triangles) = cube_triangles();
        // a sheet with two sides; the same facet twice is one
        let two = Facets::new(&points, &[[0, 1, 2], [1, 0, 2]]).err();
        assert!(
            matches!(two, Some(ContactError::ObstacleFacet { facet: 1, .. })),
            "{two:?}"
        );
        let twice = Facets::new(&points, &[[0, 1, 2], [2, 0, 1]]).expect("a sheet");
        assert_eq!(twice.distance([3.0, 0.0, 0.0], 1.0, None).distance, 1.0);
        triangles[4].swap(0, 1);
        let found = Facets::new(&points, &triangles).err();
        assert!(
            matches!(found, Some(ContactError::ObstacleFacet { facet: 4 | 5, .. })),
            "{found:?}"
        );
    }
}
