//! Sides of the elements of rigid bodies, as polygons and triangles.

use signorini_fem_mesh::internal::facet_shape;
use signorini_fem_mesh::vec3::{Vec3, add, norm, scale, sub};

use super::numbers::Sets;
use crate::error::{DeckError, Word};
use crate::model::{Kind, Side};
use crate::tolerances::{MOST_PARTS, MOST_SQUARES, SAGITTA};

/// A side of a rigid element: corners, counter-clockwise seen from outside, and of quadratic elements the nodes between
/// each and the next.
#[derive(Debug)]
pub(super) struct RigidFace {
    pub(super) corners: Vec<Vec3>,
    pub(super) mids: Vec<Vec3>,
    pub(super) body: u32,
}

impl RigidFace {
    /// A side of an element of a body, both by position.
    pub(super) fn new(sets: &Sets, (body, element): (u32, u32), side: Side, word: &Word) -> Result<Self, DeckError> {
        let element = &sets.model.elements[element as usize];
        let nodes = sets.nodes_of(element)?;
        let p: Vec<Vec3> = nodes.iter().map(|&n| sets.model.nodes[n as usize].point).collect();
        let mut mids = Vec::new();
        let mut corners = match (element.kind, side) {
            (Kind::Solid(shape), Side::Face(number)) => {
                let Some(face) = shape.faces().get(usize::from(number) - 1) else {
                    return Err(word.cannot(element.no_face(number)));
                };
                // faces are numbered counter-clockwise seen from inside
                let around: Vec<usize> = face.iter().rev().copied().collect();
                let mid = |i: usize| {
                    let ends = [around[i], around[(i + 1) % around.len()]];
                    let edge = shape.edges().iter().position(|e| e.iter().all(|k| ends.contains(k)));
                    p.get(shape.corners() + edge?).copied()
                };
                let all: Option<Vec<Vec3>> = (0..around.len()).map(mid).collect();
                mids = all.unwrap_or_default();
                around.into_iter().map(|k| p[k]).collect()
            }
            (Kind::Solid(_), _) => return Err(word.expected("faces S1 to S6 of solid elements")),
            (_, Side::Face(_) | Side::Outside | Side::Nodes) => {
                return Err(word.expected("SPOS or SNEG of rigid facets"));
            }
            (Kind::Line, _) => return Err(word.expected("facets: lines have no sides")),
            (Kind::Rigid | Kind::Flat, _) => p,
        };
        if side == (Side::Facet { positive: false }) {
            corners.reverse();
        }
        Ok(RigidFace { corners, mids, body })
    }

    /// An edge: its ends and the node between them.
    fn edge(&self, k: usize) -> [Vec3; 3] {
        let next = (k + 1) % self.corners.len();
        [self.corners[k], self.mids[k], self.corners[next]]
    }

    /// How far its edges are off straight lines, over their lengths.
    fn bow(&self) -> f64 {
        let edges = (0..self.mids.len()).map(|k| self.edge(k));
        let off = |[a, mid, b]: [Vec3; 3]| norm(sub(mid, scale(0.5, add(a, b)))) / norm(sub(b, a));
        edges.map(off).fold(0.0, f64::max)
    }

    /// Between neighbouring nodes with two `parts` an edge; with more between places on the curved face.
    fn triangles(&self, parts: usize) -> Vec<[Vec3; 3]> {
        let mids = &self.mids;
        if mids.is_empty() {
            // a quadrilateral whose last corner is there twice is a triangle
            return fan(&self.corners).filter(|t| t[1] != t[2]).collect();
        }
        if parts <= 2 {
            let before = |i: usize| mids[(i + mids.len() - 1) % mids.len()];
            let cut = (0..mids.len()).map(|i| [self.corners[i], mids[i], before(i)]);
            return cut.chain(fan(mids)).collect();
        }
        let is_triangle = self.corners.len() == 3;
        let mut out = Vec::new();
        for (i, j) in (0..parts).flat_map(|i| (0..parts).map(move |j| (i, j))) {
            let place = |k: usize, l: usize| self.place([i + k, j + l], parts);
            if !is_triangle || i + j < parts {
                out.push([place(0, 0), place(1, 0), place(0, 1)]);
            }
            if !is_triangle || i + j + 1 < parts {
                out.push([place(1, 0), place(1, 1), place(0, 1)]);
            }
        }
        out
    }

    /// A place by parts along the first edge and along the last. On an edge its bits are those of the neighbour's.
    fn place(&self, [i, j]: [usize; 2], parts: usize) -> Vec3 {
        let is_triangle = self.corners.len() == 3;
        let on_edge = match (i, j) {
            (i, 0) => Some((0, i)),
            (0, j) => Some((self.corners.len() - 1, parts - j)),
            (_, j) if is_triangle && i + j == parts => Some((1, j)),
            (i, j) if !is_triangle && i == parts => Some((1, j)),
            (i, j) if !is_triangle && j == parts => Some((2, parts - i)),
            _ => None,
        };
        if let Some((edge, k)) = on_edge {
            return on_edge_at(self.edge(edge), k, parts);
        }
        let [u, v] = [i, j].map(|k| k as f64 / parts as f64);
        let weights: Vec<f64> = if is_triangle {
            facet_shape(&[1.0 - u - v, u, v]).to_vec()
        } else {
            let [s, t] = [u, v].map(|u| 2.0 * u - 1.0);
            let corner = |[a, b]: [f64; 2]| 0.25 * (1.0 + a * s) * (1.0 + b * t) * (a * s + b * t - 1.0);
            let mid = |[s, t]: [f64; 2]| 0.5 * (1.0 - s * s) * (1.0 + t);
            let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(corner);
            [corners, [[s, -t], [t, s], [s, t], [t, -s]].map(mid)].concat()
        };
        let nodes = self.corners.iter().chain(&self.mids).zip(weights);
        nodes.fold([0.0; 3], |sum, (x, w)| add(sum, scale(w, *x)))
    }
}

/// A place of a quadratic edge; from the same end whoever asks.
fn on_edge_at([a, mid, b]: [Vec3; 3], k: usize, parts: usize) -> Vec3 {
    if a > b {
        return on_edge_at([b, mid, a], parts - k, parts);
    }
    match k {
        0 => a,
        k if k == parts => b,
        k if 2 * k == parts => mid,
        k => {
            let t = k as f64 / parts as f64;
            let ends = add(scale((1.0 - t) * (1.0 - 2.0 * t), a), scale(t * (2.0 * t - 1.0), b));
            add(ends, scale(4.0 * t * (1.0 - t), mid))
        }
    }
}

/// Triangles of the faces of a surface, curved ones cut into as many as leave [`SAGITTA`] of an edge, to a limit. All
/// edges into as many parts: neighbours share places.
pub(super) fn triangles(faces: &[RigidFace]) -> Vec<[Vec3; 3]> {
    let bow = faces.iter().map(RigidFace::bow).fold(0.0, f64::max);
    let most = (MOST_SQUARES / faces.len() as f64).sqrt().min(MOST_PARTS);
    let parts = (bow / SAGITTA).sqrt().ceil().min(most).max(2.0) as usize;
    faces.iter().flat_map(|face| face.triangles(parts)).collect()
}

/// Triangles between the first of some points and each two neighbours.
pub(super) fn fan(around: &[Vec3]) -> impl Iterator<Item = [Vec3; 3]> {
    (1..around.len() - 1).map(|i| [around[0], around[i], around[i + 1]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    /// Two quarters of a quadratic cylinder of radius 1, of a rectangle and of two triangles: the cuts of both meet,
    /// and are as near to it as its nodes say.
    #[test]
    fn curved_faces_are_followed_and_neighbours_meet() {
        let at = |quarter: f64, z: f64| {
            let angle = quarter * std::f64::consts::FRAC_PI_2;
            [angle.cos(), angle.sin(), z]
        };
        let face = |corners: &[[f64; 2]]| {
            let next = corners.iter().cycle().skip(1);
            let between = |(a, b): (&[f64; 2], &[f64; 2])| at(0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]));
            RigidFace {
                corners: corners.iter().map(|[q, z]| at(*q, *z)).collect(),
                mids: corners.iter().zip(next).map(between).collect(),
                body: 0,
            }
        };
        let faces = [
            face(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]),
            face(&[[2.0, 1.0], [1.0, 1.0], [1.0, 0.0]]),
            face(&[[1.0, 0.0], [2.0, 0.0], [2.0, 1.0]]),
        ];
        let cut = triangles(&faces);
        assert_eq!(cut.len(), 128 + 2 * 64);
        let mut edges: HashMap<[[u64; 3]; 2], usize> = HashMap::new();
        for t in &cut {
            for k in 0..3 {
                let mut ends = [t[k], t[(k + 1) % 3]].map(|x| x.map(f64::to_bits));
                ends.sort_unstable();
                *edges.entry(ends).or_default() += 1;
            }
            for [x, y, _] in t {
                // the quadratic edge itself is off by 0.0172
                assert!((x.hypot(*y) - 1.0).abs() < 0.018, "{x} {y}");
            }
        }
        // the rim: two straight edges and four curved ones of eight parts
        assert_eq!(edges.values().filter(|n| **n == 1).count(), 6 * 8);
        assert!(edges.values().all(|n| *n <= 2));
        // straight edges stay as they are
        let flat = RigidFace {
            corners: vec![[0.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]],
            mids: vec![[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
            body: 0,
        };
        assert_eq!(triangles(&[flat]).len(), 4);
    }
}
