//! The other side of each node of a surface.

use super::search::{Bends, Normals, Seen, covers, in_order};
use crate::tolerances::{COVERED, NO_WEIGHT, SAME_NORMAL, SLIVER, TO_CREASE};
use crate::vec3::edge_cosine;
use rayon::prelude::*;
use signorini_fem_mesh::internal::Lists;
use signorini_fem_mesh::vec3::{add, area_vector, scale, sub};
use signorini_fem_mesh::{Surface, SurfaceFrame, TetMesh};
use signorini_qp::vector;
use std::collections::{BTreeMap, HashSet};

/// What a node of the first side sees of the other one.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MortarNode {
    /// Nodes of its own side with weights that sum to one, the node itself first if it has a weight: between tips in a
    /// mesh of order 2 it has none. In a mesh of order 1 nothing else, unless the cover ends beside it.
    pub(crate) own: Vec<(u32, f64)>,
    /// Nodes of the other side with weights that sum to one, the largest first; of a tied one that is apart also nodes
    /// behind it.
    pub(crate) partner: Vec<(u32, f64)>,
    /// Mean distance between tied sides along the normal, m, as far as the nodes of the partner do not have it.
    pub(crate) way: f64,
    /// The smallest distance of facets of both sides around it, as if they were flat, m; negative inside.
    pub(crate) nearest: f64,
    /// Its distance from the curve that facets of the other side stand for, m, where these are bent.
    pub(crate) curve: Option<f64>,
    /// Integral of the dual shape function of the node over what is covered: `D_jj`, m².
    pub(crate) area: f64,
    /// Normal of the covered facets, out of the first side, and tangents: of curved ones the mean that displacements of
    /// its side have.
    pub(crate) frame: SurfaceFrame,
    /// Whether it has no condition, because another contact has one, and other nodes have its shape function.
    pub(crate) is_handed_on: bool,
}

impl MortarNode {
    /// Mean distance of the sides along a normal, m; places are measured from one near them.
    pub(crate) fn gap(&self, mesh: &TetMesh, from: [f64; 3], normal: &[f64; 3]) -> f64 {
        let along = |&(node, weight): &(u32, f64)| {
            let way = sub(mesh.points()[node as usize], from);
            weight * vector::dot(&way, normal)
        };
        let [partner, own] = [&self.partner, &self.own].map(|side| side.iter().map(along).sum::<f64>());
        partner - own + self.way
    }
}

/// Of the nodes of a surface that other contacts `cross` those without a condition of this one, as at crosspoints of
/// mortar methods: with conditions of both, rows along a surface nearly depend on one another, and active sets run in
/// circles. The corners that have their shape functions instead must have facets of their own, else forces in a narrow
/// strip would have no moment.
fn handed_on(surface: &Surface, other: &Surface, crossing: &HashSet<u32>) -> HashSet<u32> {
    let nodes = |triangle: &[u32; 3]| triangle.map(|local| surface.nodes()[local as usize]);
    let mut out: HashSet<u32> = surface
        .nodes()
        .iter()
        .copied()
        .filter(|n| crossing.contains(n))
        .collect();
    if out.is_empty() {
        return out;
    }
    let is_without = |node: &u32| crossing.contains(node) || other.local(*node).is_some();
    let facets = || surface.triangles().iter().map(nodes);
    let own: HashSet<u32> = facets().filter(|f| !f.iter().any(is_without)).flatten().collect();
    for facet in facets() {
        let mut others = facet.iter().filter(|node| !is_without(node)).peekable();
        if others.peek().is_none() || others.any(|node| !own.contains(node)) {
            facet.iter().for_each(|node| _ = out.remove(node));
        }
    }
    out
}

/// For each node of a surface what it sees of the other one; `None` where that is nothing, and at nodes on both sides,
/// as the tip of a crack: their shape functions are shared out to the other corners of each facet. So are, as far as
/// [they may be](handed_on), those of the nodes that `crossing` tells from what all see, and those of [slivers].
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
    (tied, crease): (bool, f64),
    bends: Bends<'_>,
    crossing: impl Fn(&[Option<MortarNode>]) -> HashSet<u32>,
) -> Vec<Option<MortarNode>> {
    let triangles = in_order(mesh, surface);
    let corners: Vec<[u32; 3]> = triangles.iter().map(|triangle| triangle.nodes).collect();
    let around = Lists::by_key(mesh.points().len(), corners.as_flattened());
    let crease = crease.to_radians().cos() + TO_CREASE;
    let is_bent = |node: u32| {
        let facets: Vec<&[u32; 3]> = around
            .of(node as usize)
            .iter()
            .map(|k| &corners[*k as usize / 3])
            .collect();
        is_bent(mesh, &facets, crease)
    };
    // tied sides need no normal, and means of displacements have their own
    let may_part = !tied;
    let bent: HashSet<u32> = surface
        .nodes()
        .par_iter()
        .copied()
        .filter(|n| may_part && is_bent(*n))
        .collect();
    // around a curve a place has another normal than its node
    let is_flat = |node: u32| may_part && !bent.contains(&node);
    let within = |nodes: [u32; 3]| nodes.into_iter().all(is_flat);
    let covers = covers(mesh, &triangles, other, (tied, &within), bends);
    let node = |(local, &own): (usize, &u32), shared: &HashSet<u32>| {
        let is_tip = |node: u32| other.local(node).is_some() || shared.contains(&node);
        if is_tip(own) {
            return None;
        }
        let places = || around.of(own as usize).iter().map(|&place| place as usize);
        let mut sums = Sums::default();
        for (facet, corner) in places().map(|place| (place / 3, place % 3)) {
            if let Some(seen) = &covers[facet] {
                let tips = (0..3).filter(|&c| is_tip(corners[facet][c])).collect();
                sums.add(&Share { corner, tips }, &corners[facet], seen);
            }
        }
        sums.cancel();
        if sums.area <= COVERED * surface.areas()[local] {
            return None;
        }
        let frame = if mesh.order() == 1 && bent.contains(&own) {
            surface.frames()[local]
        } else {
            SurfaceFrame::from_normal(sums.normal)?
        };
        sums.node(own, frame)
    };
    let nodes = || surface.nodes().par_iter().enumerate();
    let slivers = slivers(surface, (&corners, &around), &covers, is_flat);
    let mut out: Vec<Option<MortarNode>> = nodes().map(|own| node(own, &slivers)).collect();
    let mut shared = handed_on(surface, other, &crossing(&out));
    if shared.is_empty() {
        return out;
    }
    shared.extend(slivers);
    let again: Vec<_> = nodes().map(|own| node(own, &shared)).collect();
    for ((own, seen), again) in surface.nodes().iter().zip(&mut out).zip(again) {
        match seen {
            Some(seen) if shared.contains(own) => seen.is_handed_on = true,
            _ => *seen = again,
        }
    }
    out
}

/// Nodes of which hardly anything is covered, beside others in each of their facets.
fn slivers(
    surface: &Surface,
    (corners, around): (&[[u32; 3]], &Lists<u32>),
    covers: &[Option<Seen>],
    may_be: impl Fn(u32) -> bool,
) -> HashSet<u32> {
    let covered = |node: u32| -> f64 {
        let places = around.of(node as usize).iter().map(|place| *place as usize);
        let areas = places.filter_map(|place| Some(covers[place / 3].as_ref()?.cover.areas[place % 3]));
        areas.sum()
    };
    let hardly = surface.nodes().iter().zip(surface.areas());
    let hardly = hardly.filter(|(node, area)| may_be(**node) && covered(**node) <= SLIVER * *area);
    let found: HashSet<u32> = hardly.map(|(node, _)| *node).collect();
    let facets = corners.iter().zip(covers).filter(|facet| facet.1.is_some());
    let alone = facets.filter(|(nodes, _)| nodes.iter().all(|node| found.contains(node)));
    let alone: HashSet<u32> = alone.flat_map(|(nodes, _)| *nodes).collect();
    &found - &alone
}

/// The share of a corner of a facet in what the corners have: its own, and a part of what the tips hand on.
struct Share {
    corner: usize,
    tips: Vec<usize>,
}

impl Share {
    fn of(&self, values: &[f64; 3]) -> f64 {
        let shared: f64 = self.tips.iter().map(|&c| values[c]).sum();
        values[self.corner] + shared / (3 - self.tips.len()) as f64
    }
}

/// The shares of a node in the covers of its facets.
#[derive(Default)]
struct Sums {
    area: f64,
    way: f64,
    nearest: Option<f64>,
    /// Areas of covers times distances from the curve there, and these areas.
    curve: [f64; 2],
    normal: [f64; 3],
    own: BTreeMap<u32, f64>,
    partner: BTreeMap<u32, f64>,
}

impl Sums {
    fn add(&mut self, share: &Share, corners: &[u32; 3], Seen { cover, normals, curve }: &Seen) {
        self.area += share.of(&cover.areas);
        self.way += share.of(&cover.ways);
        self.nearest = Some(self.nearest.map_or(cover.nearest, |known| known.min(cover.nearest)));
        if let Some(curve) = curve {
            self.curve = [
                self.curve[0] + cover.area * curve[share.corner],
                self.curve[1] + cover.area,
            ];
        }
        match normals {
            Normals::Plane(normal) => self.normal = add(self.normal, scale(cover.area, *normal)),
            // the mean that displacements have; three times, as plane facets count whole
            Normals::Curved(normals) => {
                for ((_, weight), normal) in cover.own.iter().zip(normals) {
                    self.normal = add(self.normal, scale(3.0 * share.of(weight), *normal));
                }
            }
        }
        for (node, weight) in &cover.weights {
            *self.partner.entry(*node).or_insert(0.0) += share.of(weight);
        }
        for (node, weight) in &cover.own {
            *self.own.entry(*node).or_insert(0.0) += share.of(weight);
        }
        if cover.own.is_empty() {
            // dual shape functions see their own corner only
            for &c in [share.corner].iter().chain(&share.tips) {
                let mut alone = [0.0; 3];
                alone[c] = cover.areas[c];
                *self.own.entry(corners[c]).or_insert(0.0) += share.of(&alone);
            }
        }
    }

    /// What is on both sides does not move against itself.
    fn cancel(&mut self) {
        for (node, weight) in &mut self.own {
            if let Some(other) = self.partner.remove(node) {
                *weight -= other;
                self.area -= other;
            }
        }
    }

    /// The means of both sides at a node.
    fn node(self, node: u32, frame: SurfaceFrame) -> Option<MortarNode> {
        let most = self.partner.values().fold(0.0, |m: f64, w| m.max(w.abs()));
        let mean = |mut weights: BTreeMap<u32, f64>| -> Vec<(u32, f64)> {
            weights.retain(|_, w| w.abs() > NO_WEIGHT * most);
            let sum: f64 = weights.values().sum();
            weights.into_iter().map(|(node, w)| (node, w / sum)).collect()
        };
        let (mut own, mut partner) = (mean(self.own), mean(self.partner));
        own.sort_by_key(|n| (n.0 != node, n.0));
        partner.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()).then(a.0.cmp(&b.0)));
        Some(MortarNode {
            own,
            partner,
            way: self.way / self.area,
            nearest: self.nearest?,
            curve: (self.curve[1] > 0.0).then(|| self.curve[0] / self.curve[1]),
            area: self.area,
            frame,
            is_handed_on: false,
        })
    }
}

/// Whether facets around a node are not in one plane, and none meets its neighbour at a crease, which is given by its
/// cosine.
fn is_bent(mesh: &TetMesh, facets: &[&[u32; 3]], crease: f64) -> bool {
    let vector = |facet: &[u32; 3]| area_vector(&facet.map(|n| mesh.points()[n as usize]));
    let pairs =
        (facets.iter().enumerate()).flat_map(|(k, first)| facets[..k].iter().map(move |other| [*first, *other]));
    let cosines = pairs.filter_map(|pair| edge_cosine(pair, pair.map(vector)));
    let least = cosines.fold(1.0, f64::min);
    least > crease && least < SAME_NORMAL
}
