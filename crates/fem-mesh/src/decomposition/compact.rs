//! Parts made compact: ragged, elongated and scattered ones become round cells of similar size.
//!
//! The method is that of Lloyd for centroidal Voronoi cells: S. Lloyd, *Least squares quantization in PCM*, IEEE
//! Trans. Inform. Theory 28, 1982; Q. Du, V. Faber, M. Gunzburger, *Centroidal Voronoi tessellations*, SIAM Review
//! 41, 1999.

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::mesh::TetMesh;
use crate::tables::{Lists, count_of, distinct};
use crate::tolerances::{MOST_SWEEPS, SWEEP_MOVES};
use crate::vec3::{self, Vec3};

use super::cracks::split_at_cracks;
use super::parts::{expect_parts, split_by};
use super::subdomains::DecompositionError;

/// Makes parts compact, those of a graph partitioner for instance: solvers on subdomains take the fewer steps the
/// rounder the subdomains and the smoother the interfaces between them are. A partitioner keeps the number of cut
/// faces small, not the shape.
///
/// Each tetrahedron goes to the part whose centre is nearest, out of its own part and those that touch it, centres
/// are computed anew, and so on until next to nothing moves. A centre is the mean over tetrahedra, not over volume,
/// so that parts keep similar numbers of them in graded meshes. What a part does not reach through faces goes to the
/// neighbour that shares most with it. At last parts that have both faces of a crack (tagged facets that face each
/// other across next to nothing) are split between them, unless the crack is small against what joins them.
///
/// `groups` are labels, one for each tetrahedron, of what a part must not mix: materials. Bodies are never mixed. The
/// result is accepted by [`Decomposition::from_parts`](crate::Decomposition::from_parts): all parts are connected, and
/// numbered without gaps in the order of their first tetrahedra. There may be fewer than before, and more where a part
/// lay in several groups or bodies. Boxes of equal cells stay as they are.
///
/// # Errors
/// [`DecompositionError::PartCount`] if there is not one number, or not one label, for each tetrahedron.
pub fn compact_parts(mesh: &TetMesh, groups: &[u32], parts: &[u32]) -> Result<Vec<u32>, DecompositionError> {
    expect_parts(mesh, groups)?;
    expect_parts(mesh, parts)?;
    let centres: Vec<Vec3> = (0..parts.len())
        .map(|tet| vec3::centroid(&mesh.tet_points(tet)))
        .collect();
    let compact = compact(mesh, &split_by(mesh, groups), &centres, parts);
    Ok(split_at_cracks(mesh, &compact))
}

/// As [`compact_parts`], with groups that hang together, numbers with gaps, and parts on both sides of a crack.
pub(crate) fn compact(mesh: &TetMesh, groups: &[u32], centres: &[Vec3], parts: &[u32]) -> Vec<u32> {
    let tets = parts.len();
    let corners = Lists::by_key(mesh.points().len(), mesh.tets().as_flattened());
    let mut parts = within_groups(groups, parts);
    for _ in 0..MOST_SWEEPS {
        let next = sweep(&corners, groups, centres, &parts);
        let moved = next.iter().zip(&parts).filter(|(a, b)| a != b).count();
        parts = next;
        if moved as f64 <= SWEEP_MOVES * tets as f64 {
            break;
        }
    }
    join_pieces(mesh, groups, &mut parts);
    parts
}

/// One number for each part of a group, without gaps.
fn within_groups(groups: &[u32], parts: &[u32]) -> Vec<u32> {
    let all = || groups.iter().zip(parts);
    let pairs = distinct(all());
    all().map(|pair| pairs.partition_point(|p| *p < pair) as u32).collect()
}

/// The nearest of the own part and those of the same group that touch it, for every tetrahedron; `corners` are those
/// at each node.
fn sweep(corners: &Lists<u32>, groups: &[u32], centres: &[Vec3], parts: &[u32]) -> Vec<u32> {
    let count = count_of(parts);
    let mut sums = vec![([0.0; 3], 0.0); count];
    let mut group = vec![0; count];
    for (tet, (&part, &centre)) in parts.iter().zip(centres).enumerate() {
        let (sum, number) = &mut sums[part as usize];
        *sum = vec3::add(*sum, centre);
        *number += 1.0;
        group[part as usize] = groups[tet];
    }
    let means: Vec<Vec3> = sums
        .iter()
        .map(|(sum, number)| vec3::scale(1.0 / f64::max(*number, 1.0), *sum))
        .collect();
    let touching = touching(corners, parts, &group);
    let distance = |part: u32, centre: Vec3| {
        let off = vec3::sub(means[part as usize], centre);
        vec3::dot(off, off)
    };
    (0..parts.len())
        .into_par_iter()
        .map(|tet| {
            let (own, centre) = (parts[tet], centres[tet]);
            let start = (distance(own, centre), own);
            let others = touching[own as usize].iter();
            let nearer = |best: (f64, u32), &part: &u32| {
                let found = distance(part, centre);
                if found < best.0 { (found, part) } else { best }
            };
            others.fold(start, nearer).1
        })
        .collect()
}

/// The parts of the same group that share a node with each part, ascending.
fn touching(corners: &Lists<u32>, parts: &[u32], group: &[u32]) -> Vec<Vec<u32>> {
    let mut out = vec![Vec::new(); group.len()];
    let mut here: Vec<u32> = Vec::new();
    for around in corners.iter() {
        here.clear();
        here.extend(around.iter().map(|&corner| parts[corner as usize / 4]));
        here.sort_unstable();
        here.dedup();
        for &a in &here {
            let same = |b: &&u32| **b != a && group[a as usize] == group[**b as usize];
            out[a as usize].extend(here.iter().filter(same));
        }
    }
    out.into_iter().map(distinct).collect()
}

/// Gives all but the largest piece of each part to the neighbours that share most faces with them.
pub(crate) fn join_pieces(mesh: &TetMesh, groups: &[u32], parts: &mut [u32]) {
    let pieces = split_by(mesh, parts);
    let tets = Lists::by_number(&pieces);
    let mut largest: BTreeMap<u32, usize> = BTreeMap::new();
    for (piece, own) in tets.iter().enumerate() {
        let known = largest.entry(parts[own[0] as usize]).or_insert(piece);
        if own.len() > tets.of(*known).len() {
            *known = piece;
        }
    }
    let mut loose = vec![true; tets.count()];
    largest.into_values().for_each(|piece| loose[piece] = false);
    // each round joins at least the pieces next to what is fixed already: a body is connected
    let mut waiting: Vec<usize> = (0..tets.count()).filter(|&piece| loose[piece]).collect();
    while !waiting.is_empty() {
        let found: Vec<Option<u32>> = waiting
            .iter()
            .map(|&piece| {
                let own = tets.of(piece);
                let around = own.iter().flat_map(|&tet| mesh.neighbours(tet as usize));
                let same = |tet: &usize| groups[*tet] == groups[own[0] as usize];
                let mut fixed: Vec<u32> = around
                    .flatten()
                    .filter(same)
                    .filter(|&tet| !loose[pieces[tet] as usize])
                    .map(|tet| parts[tet])
                    .collect();
                fixed.sort_unstable();
                let runs = fixed.chunk_by(|a, b| a == b);
                runs.max_by_key(|run| (run.len(), std::cmp::Reverse(run[0])))
                    .map(|run| run[0])
            })
            .collect();
        let before = waiting.len();
        for (&piece, part) in waiting.iter().zip(&found) {
            if let Some(part) = part {
                tets.of(piece).iter().for_each(|&tet| parts[tet as usize] = *part);
                loose[piece] = false;
            }
        }
        waiting.retain(|&piece| loose[piece]);
        if waiting.len() == before {
            return;
        }
    }
}
