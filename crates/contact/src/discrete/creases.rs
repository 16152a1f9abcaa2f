//! Sides of a surface that meet at creases.

use crate::tolerances::TO_CREASE;
use crate::vec3::edge_cosine;
use signorini_fem_mesh::vec3;
use signorini_fem_mesh::{Surface, SurfaceFrame, TetMesh};
use std::collections::HashMap;

/// A side of a surface at a node: all of it, or that on one side of a crease.
#[derive(Debug, Clone)]
pub(crate) struct SurfaceSide {
    pub(crate) frame: SurfaceFrame,
    pub(crate) area: f64,
    /// Triangles around the node, as far as they are needed.
    pub(crate) triangles: Vec<u32>,
}

/// The sides that meet at each node of a crease; keys are places in the surface.
pub(crate) fn creases(mesh: &TetMesh, surface: &Surface, crease: f64) -> HashMap<u32, Vec<SurfaceSide>> {
    let mut out = HashMap::new();
    if crease >= 180.0 {
        return out;
    }
    let limit = crease.to_radians().cos() + TO_CREASE;
    let vectors: Vec<[f64; 3]> = surface
        .triangles()
        .iter()
        .map(|t| area_vector(mesh, surface, t))
        .collect();
    let around = surface.around();
    for node in 0..around.count() {
        let sides = sides(surface, &vectors, around.of(node), limit);
        if sides.len() < 2 {
            continue;
        }
        let side = |triangles: Vec<u32>| {
            let mut sum = [0.0; 3];
            let mut area = 0.0;
            for &t in &triangles {
                let (own, normal) = corner_of(mesh, surface, t as usize, node);
                area += own;
                (0..3).for_each(|c| sum[c] += normal[c]);
            }
            SurfaceFrame::from_normal(sum).map(|frame| SurfaceSide { frame, area, triangles })
        };
        out.insert(node as u32, sides.into_iter().filter_map(side).collect());
    }
    out
}

fn corner_of(mesh: &TetMesh, surface: &Surface, triangle: usize, node: usize) -> (f64, [f64; 3]) {
    let corners = surface.triangles()[triangle];
    let corner = corners.iter().position(|&n| n as usize == node).unwrap_or(0);
    surface.corner(mesh, triangle, corner)
}

/// Triangles around a node, grouped: those that share an edge and are not separated by a crease are of one side.
fn sides(surface: &Surface, vectors: &[[f64; 3]], triangles: &[u32], limit: f64) -> Vec<Vec<u32>> {
    let smooth = |a: u32, b: u32| {
        let nodes = [a, b].map(|t| &surface.triangles()[t as usize]);
        edge_cosine(nodes, [a, b].map(|t| vectors[t as usize])).is_some_and(|cosine| cosine > limit)
    };
    let mut left: Vec<u32> = triangles.to_vec();
    let mut out = Vec::new();
    while let Some(&first) = left.first() {
        let mut side = vec![first];
        left.remove(0);
        let mut next = 0;
        while next < side.len() {
            let from = side[next];
            let (joined, rest) = left.iter().partition(|&&t| smooth(from, t));
            left = rest;
            side.extend::<Vec<u32>>(joined);
            next += 1;
        }
        out.push(side);
    }
    out
}

/// Outward vector of a triangle, of the length of its area.
pub(crate) fn area_vector(mesh: &TetMesh, surface: &Surface, triangle: &[u32; 3]) -> [f64; 3] {
    vec3::area_vector(&triangle.map(|n| mesh.points()[surface.nodes()[n as usize] as usize]))
}
