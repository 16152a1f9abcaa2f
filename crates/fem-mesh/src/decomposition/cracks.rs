//! Parts on both sides of a crack.
//!
//! Centres of parts do not see a crack. A part that has both of its faces hangs together around the tip, perhaps by a
//! few tetrahedra: nothing else is as soft as this neck, and solvers take many times the steps. So it becomes a part a
//! side.

use std::collections::{BTreeMap, HashMap, VecDeque};

use crate::mesh::{TetMesh, face_each_other, face_nodes};
use crate::tables::{DisjointSets, Lists, count_of, distinct};
use crate::tolerances::{BEHIND, CRACK, NECK, SMALL_PIECE};
use crate::vec3::{Vec3, area_vector, centroid, dot, norm, scale, sub};

use super::parts::{renumbered, split_by};

/// Splits parts by the faces of cracks, if these are large against the neck around their tips: each tetrahedron goes
/// with the face to which the fewest steps lead. Small pieces join their neighbours. The parts are numbered anew, by
/// their first tetrahedra.
pub(super) fn split_at_cracks(mesh: &TetMesh, parts: &[u32]) -> Vec<u32> {
    let mut parts = renumbered(parts);
    let count = count_of(&parts);
    let of_facets: Vec<u32> = (0..mesh.facets().len()).map(|f| parts[mesh.facet_owner(f)]).collect();
    let facets = Lists::by_key(count, &of_facets);
    let mut members = None;
    let mut next = count as u32;
    for part in 0..count {
        let crack = Crack::new(mesh, facets.of(part));
        if crack.area == 0.0 {
            continue;
        }
        let own = members.get_or_insert_with(|| Lists::by_key(count, &parts)).of(part);
        let mut nearest = crack.nearest_sides(mesh, own);
        let neck = crack.join(&necks(mesh, own, &nearest), &mut nearest);
        if crack.area < NECK * neck {
            continue;
        }
        let sides = distinct(nearest.values().copied());
        for tet in own {
            // the first side keeps the number
            match nearest.get(tet).and_then(|side| sides.binary_search(side).ok()) {
                None | Some(0) => {}
                Some(k) => parts[*tet as usize] = next + k as u32 - 1,
            }
        }
        next += sides.len() as u32;
    }
    match members {
        Some(members) => renumbered(&join_small(mesh, &members, &parts)),
        None => parts,
    }
}

/// Makes parts of what hangs together, since a side may come to a part at several places, and gives what is small to
/// the neighbour that shares most faces with it; `members` are the parts before.
fn join_small(mesh: &TetMesh, members: &Lists<u32>, parts: &[u32]) -> Vec<u32> {
    let pieces = split_by(mesh, parts);
    let mut joined = pieces.clone();
    let tets = Lists::by_number(&pieces);
    let mut is_small = vec![false; tets.count()];
    for part in 0..members.count() {
        let most = SMALL_PIECE * members.of(part).len() as f64;
        for &tet in members.of(part) {
            let piece = pieces[tet as usize] as usize;
            is_small[piece] = tets.of(piece).len() as f64 <= most;
        }
    }
    for part in 0..members.count() {
        let own = members.of(part);
        let small = own.iter().map(|tet| pieces[*tet as usize]);
        for piece in distinct(small.filter(|piece| is_small[*piece as usize])) {
            let tets = tets.of(piece as usize);
            let around = tets.iter().flat_map(|tet| mesh.neighbours(*tet as usize)).flatten();
            let around = around.filter(|tet| !is_small[pieces[*tet] as usize]);
            // the other side of the crack last
            let neighbour = |tet: usize| (own.binary_search(&(tet as u32)).is_ok(), pieces[tet]);
            let mut others: Vec<(bool, u32)> = around.map(neighbour).collect();
            others.sort_unstable();
            let runs = others.chunk_by(|a, b| a == b);
            if let Some(most) = runs.max_by_key(|run| (!run[0].0, run.len(), std::cmp::Reverse(run[0].1))) {
                tets.iter().for_each(|tet| joined[*tet as usize] = most[0].1);
            }
        }
    }
    joined
}

/// An axis at right angles to no plane that meshes have many facets in.
const OBLIQUE: Vec3 = [1.0, 0.618, 0.382];

/// Facets of a part that face each other.
struct Crack {
    /// Of one of its faces, m².
    area: f64,
    /// The side of each node that is on one only: its smallest node.
    sides: HashMap<u32, u32>,
    /// Sides that face each other.
    apart: Vec<[u32; 2]>,
}

impl Crack {
    fn new(mesh: &TetMesh, facets: &[u32]) -> Self {
        let all: Vec<Place> = facets.iter().map(|facet| Place::new(mesh, *facet)).collect();
        // along an oblique axis: facets of one plane are spread out
        let along = |k: usize| dot(all[k].centre, OBLIQUE);
        let mut order: Vec<usize> = (0..all.len()).collect();
        order.sort_by(|a, b| along(*a).total_cmp(&along(*b)));
        let mut pairs = Vec::new();
        for (k, &a) in order.iter().enumerate() {
            let reach = CRACK * norm(OBLIQUE) * all[a].size;
            let near = order[k + 1..].iter().take_while(|b| along(**b) - along(a) <= reach);
            pairs.extend(near.filter(|b| all[a].faces(&all[**b])).map(|b| [a, *b]));
        }
        let faces = distinct(pairs.iter().flatten().copied());
        // a node of facets that face each other is at the tip
        let mut normals: HashMap<u32, Vec<Vec3>> = HashMap::new();
        for &k in &faces {
            for node in all[k].nodes {
                normals.entry(node).or_default().push(all[k].normal);
            }
        }
        let is_tip = |node: u32| face_each_other(&normals[&node], &normals[&node]);
        let inner = |k: usize| all[k].nodes.into_iter().filter(|node| !is_tip(*node));
        let nodes = distinct(faces.iter().flat_map(|k| inner(*k)));
        let local = |node: u32| nodes.partition_point(|n| *n < node);
        let mut sets = DisjointSets::new(nodes.len());
        for &k in &faces {
            sets.join_all(inner(k).map(local));
        }
        let mut side = |node: u32| nodes[sets.first(local(node))];
        let mut apart = Vec::new();
        for pair in &pairs {
            if let [Some(a), Some(b)] = pair.map(|k| inner(k).next()) {
                apart.push([side(a), side(b)]);
            }
        }
        Self {
            area: faces.iter().map(|k| 0.5 * all[*k].area).sum(),
            sides: nodes.iter().map(|node| (*node, side(*node))).collect(),
            apart: distinct(apart),
        }
    }

    /// Joins sides that do not face each other, as both skins of a layer between two cracks, those with most faces in
    /// common first. Returns the area of the faces between sides that are left, m².
    fn join(&self, necks: &BTreeMap<[u32; 2], f64>, nearest: &mut HashMap<u32, u32>) -> f64 {
        let all = distinct(self.sides.values().copied());
        let local = |side: u32| all.partition_point(|s| *s < side);
        let mut sets = DisjointSets::new(all.len());
        let mut order: Vec<([u32; 2], f64)> = necks.iter().map(|(pair, area)| (*pair, *area)).collect();
        order.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        // where cracks cross a side may face itself: none is joined then
        let crosses = self.apart.iter().any(|[a, b]| a == b);
        for (pair, _) in order.iter().filter(|_| !crosses) {
            let [a, b] = pair.map(|side| sets.first(local(side)));
            let mut apart = self.apart.iter().map(|pair| pair.map(|side| sets.first(local(side))));
            if !apart.any(|pair| pair == [a, b] || pair == [b, a]) {
                sets.join(a, b);
            }
        }
        let joined: Vec<u32> = (0..all.len()).map(|side| all[sets.first(side)]).collect();
        nearest.values_mut().for_each(|side| *side = joined[local(*side)]);
        let is_left = |pair: &[u32; 2]| joined[local(pair[0])] != joined[local(pair[1])];
        let left = order.iter().filter(|(pair, _)| is_left(pair));
        left.map(|(_, area)| area).sum()
    }

    /// For each tetrahedron of the part the side to which the fewest steps through faces lead.
    fn nearest_sides(&self, mesh: &TetMesh, part: &[u32]) -> HashMap<u32, u32> {
        let side = |tet: &u32| {
            let mut corners = mesh.tets()[*tet as usize].iter();
            corners.find_map(|node| self.sides.get(node)).copied()
        };
        let mut nearest: HashMap<u32, u32> = part.iter().filter_map(|tet| Some((*tet, side(tet)?))).collect();
        let mut queue: VecDeque<u32> = part.iter().copied().filter(|tet| nearest.contains_key(tet)).collect();
        while let Some(tet) = queue.pop_front() {
            let here = nearest[&tet];
            for other in mesh.neighbours(tet as usize).into_iter().flatten() {
                let other = other as u32;
                if part.binary_search(&other).is_ok() && !nearest.contains_key(&other) {
                    nearest.insert(other, here);
                    queue.push_back(other);
                }
            }
        }
        nearest
    }
}

/// Where a facet is.
struct Place {
    nodes: [u32; 3],
    centre: Vec3,
    /// Out of the body.
    normal: Vec3,
    area: f64,
    size: f64,
}

impl Place {
    fn new(mesh: &TetMesh, facet: u32) -> Self {
        let points = mesh.facet_points(facet as usize);
        let vector = area_vector(&points);
        let area = norm(vector);
        Self {
            nodes: mesh.facets()[facet as usize].nodes,
            centre: centroid(&points),
            normal: scale(1.0 / area, vector),
            area,
            size: area.sqrt(),
        }
    }

    /// Whether another facet looks at it across next to nothing, with no body between.
    fn faces(&self, other: &Self) -> bool {
        let way = sub(other.centre, self.centre);
        let size = self.size.min(other.size);
        let gap = dot(way, self.normal);
        let is_near = norm(way) <= CRACK * size && gap >= -BEHIND * size;
        is_near && face_each_other(&[self.normal], &[other.normal])
    }
}

/// The area of the faces between tetrahedra of each two sides, m².
fn necks(mesh: &TetMesh, part: &[u32], nearest: &HashMap<u32, u32>) -> BTreeMap<[u32; 2], f64> {
    let mut areas = BTreeMap::new();
    for tet in part {
        for (face, other) in mesh.neighbours(*tet as usize).into_iter().enumerate() {
            let other = other.and_then(|other| nearest.get(&(other as u32)));
            // each face once
            if let (Some(&own), Some(&other)) = (nearest.get(tet), other)
                && other < own
            {
                let corners = face_nodes(&mesh.tets()[*tet as usize], face).map(|n| mesh.points()[n as usize]);
                *areas.entry([other, own]).or_insert(0.0) += norm(area_vector(&corners));
            }
        }
    }
    areas
}
