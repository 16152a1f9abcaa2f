//! The other side of each node of a surface.

use super::search::{Triangle, covers, in_order};
use crate::tolerances::{COVERED, NO_WEIGHT, SAME_NORMAL};
use rayon::prelude::*;
use signorini_fem_mesh::vec3::{add, dot, norm, scale};
use signorini_fem_mesh::{Surface, SurfaceFrame, TetMesh};
use std::collections::BTreeMap;

/// What a node of the first side sees of the other one.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MortarNode {
    /// Nodes of its own side with weights that sum to one, the node itself first; in a mesh of order 1 nothing else.
    pub(crate) own: Vec<(u32, f64)>,
    /// Nodes of the other side with weights that sum to one, the largest first; of a tied one that is apart also nodes
    /// behind it.
    pub(crate) partner: Vec<(u32, f64)>,
    /// Mean distance between tied sides along the normal, m, as far as the nodes of the partner do not have it.
    pub(crate) way: f64,
    /// Integral of the dual shape function of the node over what is covered: `D_jj`, m².
    pub(crate) area: f64,
    /// Normal of the covered facets, out of the first side, and tangents: of curved ones the mean that displacements of its
    /// side have.
    pub(crate) frame: SurfaceFrame,
}

/// For each node of a surface what it sees of the other one; `None` where that is nothing, and at nodes on both sides, as
/// the tip of a crack: their shape functions are shared out to the other corners of each facet.
///
/// Where sides that are `tied` are apart, as facets of curved sides are, displacements of the other side go on to the
/// first one as in the tetrahedra behind it: linear ones, rotations among them, are the same on both sides, and what
/// passes from one to the other has no moment.
///
/// A node of a curved side whose facets meet at less than `crease` degrees has the normal of all of them, covered or
/// not: where the other side ends it is as in the middle.
pub(crate) fn mortar_nodes(
    mesh: &TetMesh,
    surface: &Surface,
    other: &Surface,
    tied: bool,
    crease: f64,
) -> Vec<Option<MortarNode>> {
    let triangles = in_order(mesh, surface);
    let covers = covers(mesh, &triangles, other, tied);
    let mut around: Vec<Vec<(u32, u8)>> = vec![Vec::new(); surface.nodes().len()];
    for (k, triangle) in triangles.iter().enumerate() {
        for (corner, &node) in triangle.nodes.iter().enumerate() {
            if let Some(local) = surface.local(node) {
                around[local].push((k as u32, corner as u8));
            }
        }
    }
    let curved = triangles.par_iter().zip(&covers);
    let curved: Vec<_> = curved
        .map(|(triangle, cover)| cover.as_ref().and_then(|_| triangle.normals(mesh)))
        .collect();
    // tied sides need no normal, and means of displacements have their own
    let bends = !tied && mesh.order() == 1;
    let crease = crease.to_radians().cos();
    let of = |facets: &[(u32, u8)]| -> Vec<&Triangle> { facets.iter().map(|f| &triangles[f.0 as usize]).collect() };
    let is_tip = |node: u32| other.local(node).is_some();
    let node = |(local, facets): (usize, &Vec<(u32, u8)>)| {
        let own = surface.nodes()[local];
        if is_tip(own) {
            return None;
        }
        let (mut area, mut way, mut normal) = (0.0, 0.0, [0.0; 3]);
        let mut weights: BTreeMap<u32, f64> = BTreeMap::new();
        let mut side: BTreeMap<u32, f64> = BTreeMap::new();
        for &(facet, corner) in facets {
            let Some((cover, direction)) = &covers[facet as usize] else {
                continue;
            };
            let corners = triangles[facet as usize].nodes;
            let tips: Vec<usize> = (0..3).filter(|&c| is_tip(corners[c])).collect();
            let share = |of: &[f64; 3]| {
                let shared: f64 = tips.iter().map(|&c| of[c]).sum();
                of[corner as usize] + shared / (3 - tips.len()) as f64
            };
            area += share(&cover.areas);
            way += share(&cover.ways);
            match &curved[facet as usize] {
                None => normal = add(normal, scale(cover.area, *direction)),
                // the mean that displacements have; three times, as plane facets count whole
                Some(normals) => {
                    for ((_, weight), n) in cover.own.iter().zip(normals) {
                        normal = add(normal, scale(3.0 * share(weight), *n));
                    }
                }
            }
            for (node, weight) in &cover.weights {
                *weights.entry(*node).or_insert(0.0) += share(weight);
            }
            for (node, weight) in &cover.own {
                *side.entry(*node).or_insert(0.0) += share(weight);
            }
            if cover.own.is_empty() {
                // dual shape functions see their own corner only
                for (c, node) in [corner as usize].iter().chain(&tips).map(|&c| (c, corners[c])) {
                    let mut alone = [0.0; 3];
                    alone[c] = cover.areas[c];
                    *side.entry(node).or_insert(0.0) += share(&alone);
                }
            }
        }
        // what is on both sides does not move against itself
        for (node, weight) in &mut side {
            if let Some(other) = weights.remove(node) {
                *weight -= other;
                area -= other;
            }
        }
        if area <= COVERED * surface.areas()[local] {
            return None;
        }
        let most = weights.values().fold(0.0, |m: f64, w| m.max(w.abs()));
        let mean = |mut weights: BTreeMap<u32, f64>| {
            weights.retain(|_, w| w.abs() > NO_WEIGHT * most);
            let sum: f64 = weights.values().sum();
            weights
                .into_iter()
                .map(|(node, w)| (node, w / sum))
                .collect::<Vec<(u32, f64)>>()
        };
        let (mut side, mut partner) = (mean(side), mean(weights));
        side.sort_by_key(|n| (n.0 != own, n.0));
        if side.first().is_none_or(|n| n.0 != own) {
            return None;
        }
        partner.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()).then(a.0.cmp(&b.0)));
        Some(MortarNode {
            own: side,
            partner,
            way: way / area,
            area,
            frame: match bends && is_bent(mesh, &of(facets), crease) {
                true => surface.frames()[local],
                false => SurfaceFrame::from_normal(normal)?,
            },
        })
    };
    around.par_iter().enumerate().map(node).collect()
}

/// Whether facets around a node are not in one plane, and none meets its neighbour at a crease, which is given by its
/// cosine.
fn is_bent(mesh: &TetMesh, facets: &[&Triangle], crease: f64) -> bool {
    let least = facets.iter().enumerate().flat_map(|(k, first)| {
        let neighbours = facets[..k].iter().filter(move |other| first.meets(other));
        neighbours.map(move |other| {
            let [v, w] = [first, other].map(|t| t.vector(mesh));
            dot(v, w) / (norm(v) * norm(w))
        })
    });
    let least = least.fold(1.0, f64::min);
    least > crease && least < SAME_NORMAL
}
