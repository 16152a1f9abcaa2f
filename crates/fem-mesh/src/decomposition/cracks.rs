//! Parts on both sides of a crack.
//!
//! Centres of parts do not see a crack. A part that has both of its faces hangs together around the tip, perhaps by a few
//! tetrahedra: nothing else is as soft as this neck, and solvers take many times the steps. So it becomes a part a side.

use std::collections::{HashMap, VecDeque};

use super::parts::split_by;
use crate::mesh::{TetMesh, face_nodes};
use crate::tables::{DisjointSets, Lists, distinct};
use crate::tolerances::NECK;
use crate::vec3::{area_vector, norm};

/// Splits parts by the faces of a crack if that is large against the neck around its tip: each tetrahedron goes with the
/// face to which the fewest steps lead.
pub(super) fn split_at_cracks(mesh: &TetMesh, parts: &mut [u32]) {
    let owner = |facet: u32| mesh.facet_owner(facet as usize);
    let faces = crack_faces(mesh);
    let mut split: Vec<(u32, [u32; 2])> = faces.iter().map(|f| (parts[owner(f[0])], *f)).collect();
    split.retain(|(part, [_, second])| parts[owner(*second)] == *part);
    if split.is_empty() {
        return;
    }
    split.sort_unstable();
    let sides = sides(mesh, &faces);
    let count = parts.iter().max().map_or(0, |&p| p as usize + 1);
    let members = Lists::by_key(count, parts);
    let mut next = count as u32;
    for faces in split.chunk_by(|a, b| a.0 == b.0) {
        let part = faces[0].0;
        let own = members.of(part as usize);
        let mut around = own.iter().flat_map(|tet| mesh.neighbours(*tet as usize)).flatten();
        if around.all(|tet| parts[tet] == part) {
            // a whole body: what joins it is its own
            continue;
        }
        let nearest = nearest_sides(mesh, own, &sides);
        let crack: f64 = faces
            .iter()
            .map(|(_, [face, _])| area(mesh.facet_points(*face as usize)))
            .sum();
        if crack < NECK * neck(mesh, &nearest) {
            continue;
        }
        let all = distinct(nearest.values().copied());
        for tet in own {
            // the first side keeps the number
            match nearest.get(tet).and_then(|side| all.binary_search(side).ok()) {
                None | Some(0) => {}
                Some(k) => parts[*tet as usize] = next + k as u32 - 1,
            }
        }
        next += all.len() as u32;
    }
    // one side may come to a part at several places
    let pieces = split_by(mesh, parts);
    parts.copy_from_slice(&pieces);
}

/// Pairs of tagged facets in one place.
fn crack_faces(mesh: &TetMesh) -> Vec<[u32; 2]> {
    let mut known: HashMap<[[u64; 3]; 3], u32> = HashMap::new();
    let mut out = Vec::new();
    for facet in 0..mesh.facets().len() as u32 {
        let mut places = mesh
            .facet_points(facet as usize)
            .map(|p| p.map(|x| (x + 0.0).to_bits()));
        places.sort_unstable();
        if let Some(other) = known.insert(places, facet) {
            out.push([other, facet]);
        }
    }
    out
}

/// The side of each node that is on one side of a crack only: its smallest node.
fn sides(mesh: &TetMesh, faces: &[[u32; 2]]) -> HashMap<u32, u32> {
    let nodes = |facet: u32| mesh.facets()[facet as usize].nodes;
    let mut sets = DisjointSets::new(mesh.points().len());
    let mut on_one: Vec<u32> = Vec::new();
    for pair in faces {
        let [first, second] = pair.map(nodes);
        for (own, other) in [(first, second), (second, first)] {
            let inner = own.into_iter().filter(|node| !other.contains(node));
            let from = on_one.len();
            on_one.extend(inner);
            on_one[from..]
                .windows(2)
                .for_each(|pair| sets.join(pair[0] as usize, pair[1] as usize));
        }
    }
    let side = |node: u32| (node, sets.first(node as usize) as u32);
    on_one.into_iter().map(side).collect()
}

/// For each tetrahedron of a part the side to which the fewest steps through faces lead.
fn nearest_sides(mesh: &TetMesh, part: &[u32], sides: &HashMap<u32, u32>) -> HashMap<u32, u32> {
    let side = |tet: &u32| {
        mesh.tets()[*tet as usize]
            .iter()
            .find_map(|node| sides.get(node))
            .copied()
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

/// The area of the faces between tetrahedra of different sides, m².
fn neck(mesh: &TetMesh, nearest: &HashMap<u32, u32>) -> f64 {
    let mut tets: Vec<(&u32, &u32)> = nearest.iter().collect();
    tets.sort_unstable();
    let mut sum = 0.0;
    for (&tet, side) in tets {
        for (face, other) in mesh.neighbours(tet as usize).into_iter().enumerate() {
            let other = other.and_then(|other| nearest.get(&(other as u32)));
            // each face once
            if other.is_some_and(|other| other < side) {
                sum += area(face_nodes(&mesh.tets()[tet as usize], face).map(|n| mesh.points()[n as usize]));
            }
        }
    }
    sum
}

fn area(corners: [[f64; 3]; 3]) -> f64 {
    norm(area_vector(&corners))
}
