//! Edges of straight facets as chords of the curve that they stand for.

use crate::tolerances::{BENT, FLAT_ARC, KINK, TOLD};
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
    let chords = Chords::new(mesh, surface, fitted(mesh, surface));
    let all = || surface.triangles().iter().flat_map(|t| edges(*t));
    let length = |edge: [u32; 2]| norm(along(mesh, surface, edge));
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
    /// Of its nodes.
    normals: Vec<[f64; 3]>,
    /// Nodes at a rim, whose normals are those of facets on one side of them.
    at_rim: Vec<bool>,
    /// Ends of edges that are bent.
    on_arc: Vec<bool>,
}

impl<'a> Chords<'a> {
    pub(super) fn new(mesh: &'a TetMesh, surface: &'a Surface, normals: Vec<[f64; 3]>) -> Self {
        let mut edges: Vec<[u32; 2]> = surface.triangles().iter().flat_map(|t| edges(*t)).collect();
        edges.sort_unstable();
        let count = surface.nodes().len();
        let mut out = Self {
            mesh,
            surface,
            normals,
            at_rim: vec![false; count],
            on_arc: vec![false; count],
        };
        for same in edges.chunk_by(|a, b| a == b) {
            let bent = are_bent(out.tilts(same[0]));
            for node in same[0].map(|n| n as usize) {
                out.at_rim[node] |= same.len() == 1;
                out.on_arc[node] |= bent;
            }
        }
        out
    }

    /// How far the normals of the ends of an edge tilt outward over its length, m.
    fn tilts(&self, edge: [u32; 2]) -> [f64; 2] {
        tilts(self.mesh, self.surface, &self.normals, edge)
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
        let sine = tilt / norm(along(self.mesh, self.surface, edge));
        let cosine = (1.0 - sine * sine).max(0.0).sqrt();
        let arc = 0.5 * tilt / (1.0 + cosine);
        let Some(mid) = mid else { return arc };
        let place = |local: u32| self.mesh.points()[self.surface.nodes()[local as usize] as usize];
        let chord = scale(0.5, add(place(edge[0]), place(edge[1])));
        let outward = edge.map(|end| self.normals[end as usize]);
        let way = sub(self.mesh.points()[mid as usize], chord);
        let off = 0.5 * dot(way, add(outward[0], outward[1]));
        if off * arc.signum() > 0.5 * arc.abs() { 0.0 } else { arc }
    }
}

/// From one end of an edge to the other, m.
fn along(mesh: &TetMesh, surface: &Surface, edge: [u32; 2]) -> [f64; 3] {
    let [from, to] = edge.map(|end| mesh.points()[surface.nodes()[end as usize] as usize]);
    sub(to, from)
}

/// How far normals at the ends of an edge tilt outward over its length, m.
fn tilts(mesh: &TetMesh, surface: &Surface, normals: &[[f64; 3]], edge: [u32; 2]) -> [f64; 2] {
    let along = along(mesh, surface, edge);
    let [a, b] = edge.map(|end| dot(along, normals[end as usize]));
    [-a, b]
}

/// Those of the frames of its nodes.
pub(super) fn normals(surface: &Surface) -> Vec<[f64; 3]> {
    surface.frames().iter().map(|frame| frame.normal).collect()
}

/// In a mesh of order 1 those of paraboloids through the two rings of nodes around them: means of uneven facets of a
/// cylinder are off by some hundredths, and arcs with them. What is behind a kink does not count. They are no normals
/// of contact, as their small slopes would hold what slides along a curve.
fn fitted(mesh: &TetMesh, surface: &Surface) -> Vec<[f64; 3]> {
    let normals = normals(surface);
    let tilts = |edge| tilts(mesh, surface, &normals, edge);
    let edges = distinct(surface.triangles().iter().flat_map(|t| edges(*t)));
    let count = surface.nodes().len();
    let turn = |edge: [u32; 2]| {
        let tilts = tilts(edge).map(f64::abs);
        tilts[0].max(tilts[1]) / norm(along(mesh, surface, edge))
    };
    let mut most = vec![0.0_f64; count];
    for (edge, n) in edges.iter().flat_map(|edge| edge.map(|n| (*edge, n as usize))) {
        most[n] = most[n].max(turn(edge));
    }
    let mut ring = vec![Vec::new(); count];
    for [a, b] in edges {
        let most = most[a as usize].max(most[b as usize]);
        if are_bent(tilts([a, b])) || turn([a, b]) <= KINK * most {
            ring[a as usize].push(b);
            ring[b as usize].push(a);
        }
    }
    let normal = |node: usize, frame: &SurfaceFrame| {
        let next = ring[node].iter().flat_map(|n| &ring[*n as usize]).chain(&ring[node]);
        let near = distinct(next.copied().filter(|n| *n as usize != node));
        let ways = || near.iter().map(|n| along(mesh, surface, [node as u32, *n]));
        let size = ways().map(|way| dot(way, way)).fold(0.0, f64::max).sqrt();
        let (mut matrix, mut right) = (SMatrix::<f64, 5, 5>::zeros(), SVector::<f64, 5>::zeros());
        for way in ways() {
            let [x, y, z] = [frame.tangents[0], frame.tangents[1], frame.normal].map(|axis| dot(way, axis) / size);
            let row = SVector::from([x, y, x * x, x * y, y * y]) / (x * x + y * y);
            matrix += row * row.transpose();
            right += row * (z / (x * x + y * y));
        }
        let roots = matrix.diagonal().map(f64::sqrt);
        matrix.component_div_assign(&(roots * roots.transpose()));
        // nodes in a row, or too few, tell nothing
        let factor = matrix.cholesky()?;
        let roots_left = factor.l_dirty().diagonal();
        roots_left.iter().all(|l| l * l > TOLD).then_some(())?;
        let slopes = factor.solve(&right.component_div(&roots)).component_div(&roots);
        let tilt = add(scale(slopes[0], frame.tangents[0]), scale(slopes[1], frame.tangents[1]));
        Some(unit(sub(frame.normal, tilt)))
    };
    let all = surface.frames().par_iter().enumerate();
    let bent = all.map(|(node, frame)| {
        normal(node, frame)
            .filter(|_| most[node] >= BENT)
            .unwrap_or(frame.normal)
    });
    bent.collect()
}

/// Whether an edge is the chord of an arc, which bends at both ends. One between flat sides bends at one end.
fn are_bent([a, b]: [f64; 2]) -> bool {
    a * b > 0.0 && a.abs().min(b.abs()) >= KINK * a.abs().max(b.abs())
}
