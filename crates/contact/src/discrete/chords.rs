//! Edges of straight facets as chords of the curve that they stand for.

use crate::tolerances::{BENT, FLAT_ARC, KINK};
use nalgebra::{SMatrix, SVector};
use rayon::prelude::*;
use signorini_fem_mesh::internal::{ascending, distinct};
use signorini_fem_mesh::vec3::{add, dot, norm, scale, sub, unit};
use signorini_fem_mesh::{Surface, SurfaceFrame, TetMesh};
use std::collections::HashMap;

/// The heights of the arcs over the edges of a surface in a mesh of order 1, by their mesh nodes, ascending: of those
/// that have one, m. Edges that turn by much may be those of a prism, so that theirs are not a number; those at kinks
/// between flat sides are flat.
pub(super) fn arcs(mesh: &TetMesh, surface: &Surface) -> HashMap<[u32; 2], f64> {
    let chords = Chords::new(mesh, surface);
    let all = || surface.triangles().iter().flat_map(|t| edges(*t));
    let length = |edge: [u32; 2]| norm(sub(chords.place(edge[1]), chords.place(edge[0])));
    // a kink turns towards a flat side as much as anywhere
    let (mut most, mut flat) = (
        vec![0.0_f64; surface.nodes().len()],
        vec![0.0_f64; surface.nodes().len()],
    );
    for edge in all() {
        let (tilts, length) = (chords.tilts(edge), length(edge));
        for (node, other, tilt) in [(edge[0], edge[1], tilts[0]), (edge[1], edge[0], tilts[1])] {
            let turn = tilt.abs() / length;
            most[node as usize] = most[node as usize].max(turn);
            if !are_bent(tilts) && !chords.at_rim[other as usize] {
                flat[node as usize] = flat[node as usize].max(turn);
            }
        }
    }
    let is_kink = |node: u32| flat[node as usize] > KINK * most[node as usize];
    let arc = |edge: [u32; 2]| {
        let (height, length) = (chords.arc(edge, None), length(edge));
        let is_bent = height.abs() >= BENT * length && !edge.into_iter().any(is_kink);
        let known = if height.abs() < FLAT_ARC * length { height } else { f64::NAN };
        is_bent.then(|| (edge.map(|n| surface.nodes()[n as usize]), known))
    };
    all().filter_map(arc).collect()
}

/// The edges 01, 12, 20 with their ends ascending.
pub(super) fn edges([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]].map(ascending)
}

/// The edges of a surface as chords of arcs.
pub(super) struct Chords<'a> {
    mesh: &'a TetMesh,
    surface: &'a Surface,
    /// Of its nodes, in a mesh of order 1 better ones than the mean of facets.
    normals: Vec<[f64; 3]>,
    /// Nodes at a rim, whose normals are those of facets on one side of them.
    at_rim: Vec<bool>,
    /// Ends of edges that are bent.
    on_arc: Vec<bool>,
}

impl<'a> Chords<'a> {
    pub(super) fn new(mesh: &'a TetMesh, surface: &'a Surface) -> Self {
        let mut edges: Vec<[u32; 2]> = surface.triangles().iter().flat_map(|t| edges(*t)).collect();
        edges.sort_unstable();
        let count = surface.nodes().len();
        let mut out = Self {
            mesh,
            surface,
            normals: surface.frames().iter().map(|frame| frame.normal).collect(),
            at_rim: vec![false; count],
            on_arc: vec![false; count],
        };
        if mesh.order() == 1 {
            let mut distinct = edges.clone();
            distinct.dedup();
            out.normals = out.fitted(&distinct);
        }
        for same in edges.chunk_by(|a, b| a == b) {
            let bent = are_bent(out.tilts(same[0]));
            for node in same[0].map(|n| n as usize) {
                out.at_rim[node] |= same.len() == 1;
                out.on_arc[node] |= bent;
            }
        }
        out
    }

    /// The normals of paraboloids through the nodes that are next to those on the two rings around them: means of uneven
    /// facets of cylinders have errors, which falsify arcs. What is behind a kink does not count.
    fn fitted(&self, edges: &[[u32; 2]]) -> Vec<[f64; 3]> {
        let turn = |edge: [u32; 2]| {
            let length = norm(sub(self.place(edge[1]), self.place(edge[0])));
            self.tilts(edge).map(f64::abs).into_iter().fold(0.0, f64::max) / length
        };
        let mut most = vec![0.0_f64; self.normals.len()];
        for (edge, n) in edges.iter().flat_map(|edge| edge.map(|n| (*edge, n as usize))) {
            most[n] = most[n].max(turn(edge));
        }
        let mut ring = vec![Vec::new(); self.normals.len()];
        for &[a, b] in edges {
            if are_bent(self.tilts([a, b])) || turn([a, b]) <= KINK * most[a as usize].max(most[b as usize]) {
                ring[a as usize].push(b);
                ring[b as usize].push(a);
            }
        }
        let fitted = |(node, frame): (usize, &SurfaceFrame)| {
            let next = ring[node].iter().flat_map(|n| &ring[*n as usize]).chain(&ring[node]);
            let near = distinct(next.copied().filter(|n| *n as usize != node));
            let ways = || near.iter().map(|n| sub(self.place(*n), self.place(node as u32)));
            let size = ways().map(|way| dot(way, way)).fold(0.0, f64::max).sqrt();
            let (mut matrix, mut right) = (SMatrix::<f64, 5, 5>::zeros(), SVector::<f64, 5>::zeros());
            for way in ways() {
                let [x, y, z] = [frame.tangents[0], frame.tangents[1], frame.normal].map(|axis| dot(way, axis) / size);
                let row = SVector::from([x, y, x * x, x * y, y * y]) / (x * x + y * y);
                matrix += row * row.transpose();
                right += row * (z / (x * x + y * y));
            }
            match matrix.cholesky().filter(|_| most[node] >= BENT) {
                Some(factor) => {
                    let slopes = factor.solve(&right);
                    let tilt = add(scale(slopes[0], frame.tangents[0]), scale(slopes[1], frame.tangents[1]));
                    unit(sub(frame.normal, tilt))
                }
                // too few nodes around it
                None => frame.normal,
            }
        };
        self.surface.frames().par_iter().enumerate().map(fitted).collect()
    }

    fn place(&self, node: u32) -> [f64; 3] {
        self.mesh.points()[self.surface.nodes()[node as usize] as usize]
    }

    fn normal(&self, node: u32) -> [f64; 3] {
        self.normals[node as usize]
    }

    /// How far the normals of the ends of an edge tilt outward over its length, m.
    fn tilts(&self, [a, b]: [u32; 2]) -> [f64; 2] {
        let along = sub(self.place(b), self.place(a));
        [-dot(along, self.normal(a)), dot(along, self.normal(b))]
    }

    /// Height of the arc over an edge, m, positive if it is convex; none over edges with a mid-node on the arc.
    pub(super) fn arc(&self, edge: [u32; 2], mid: Option<u32>) -> f64 {
        let tilts = self.tilts(edge);
        let [a, b] = edge.map(|n| n as usize);
        let ends = |from: usize, to: usize| self.at_rim[from] && !self.at_rim[to] && self.on_arc[to];
        let tilt = match (are_bent(tilts), ends(a, b), ends(b, a)) {
            (true, ..) => 0.5 * (tilts[0] + tilts[1]),
            (false, true, _) => tilts[1],
            (false, _, true) => tilts[0],
            (false, false, false) => 0.0,
        };
        // of a circle
        let length = norm(sub(self.place(edge[1]), self.place(edge[0])));
        let cosine = (1.0 - (tilt / length).powi(2)).max(0.0).sqrt();
        let arc = 0.5 * tilt / (1.0 + cosine);
        let Some(mid) = mid else { return arc };
        let chord = scale(0.5, add(self.place(edge[0]), self.place(edge[1])));
        let outward = add(self.normal(edge[0]), self.normal(edge[1]));
        let off = 0.5 * dot(sub(self.mesh.points()[mid as usize], chord), outward);
        if off * arc.signum() > 0.5 * arc.abs() { 0.0 } else { arc }
    }
}

/// Whether an edge is the chord of an arc, which bends at both ends. One between flat sides bends at one end.
fn are_bent([a, b]: [f64; 2]) -> bool {
    a * b > 0.0 && a.abs().min(b.abs()) >= KINK * a.abs().max(b.abs())
}
