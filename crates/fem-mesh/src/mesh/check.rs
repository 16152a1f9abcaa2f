//! The checks that a table of nodes and tetrahedra must pass before it becomes a mesh.

use std::collections::HashMap;

use rayon::prelude::*;

use crate::tables::DisjointSets;
use crate::tolerances::{COINCIDENT, FLAT_TET, LAST_DIGIT};
use crate::vec3::{self, Vec3};

use super::error::MeshError;

/// 32-bit tables also number faces (four each tetrahedron) and unknowns (three each node).
const LIMIT: usize = (u32::MAX / 4) as usize;

pub(super) fn sizes(nodes: usize, tets: usize) -> Result<(), MeshError> {
    for (what, count) in [("nodes", nodes), ("tetrahedra", tets)] {
        if count == 0 {
            return Err(MeshError::Empty { what });
        }
        numbered(what, count)?;
    }
    Ok(())
}

/// Whether so many can be numbered.
pub(crate) fn numbered(what: &'static str, count: usize) -> Result<(), MeshError> {
    let limit = LIMIT;
    if count > limit {
        return Err(MeshError::TooLarge { what, count, limit });
    }
    Ok(())
}

pub(super) fn coordinates(points: &[Vec3]) -> Result<(), MeshError> {
    match points.iter().position(|&p| !vec3::is_finite(p)) {
        Some(node) => Err(MeshError::NotFinite {
            node,
            point: points[node],
        }),
        None => Ok(()),
    }
}

pub(super) fn connectivity(nodes: usize, tets: &[[u32; 4]]) -> Result<(), MeshError> {
    for (tet, t) in tets.iter().enumerate() {
        for (i, &node) in t.iter().enumerate() {
            if node as usize >= nodes {
                return Err(MeshError::NodeOutOfRange { tet, node, nodes });
            }
            if t[..i].contains(&node) {
                return Err(MeshError::RepeatedNode { tet, node });
            }
        }
    }
    Ok(())
}

/// Six times the signed volume over the cube of the longest edge: 0.71 for a regular tetrahedron,
/// near zero for a sliver, NaN if all nodes coincide.
pub(super) fn flatness(p: &[Vec3; 4]) -> f64 {
    let mut longest: f64 = 0.0;
    for i in 0..4 {
        for j in 0..i {
            longest = longest.max(vec3::norm(vec3::sub(p[i], p[j])));
        }
    }
    6.0 * vec3::tet_volume(p) / (longest * longest * longest)
}

pub(super) fn shapes(points: &[Vec3], tets: &[[u32; 4]]) -> Result<(), MeshError> {
    let fault = tets.par_iter().enumerate().find_map_first(|(tet, &nodes)| {
        let p = nodes.map(|n| points[n as usize]);
        let flatness = flatness(&p);
        if flatness > FLAT_TET {
            None
        } else if flatness < -FLAT_TET {
            let volume = vec3::tet_volume(&p);
            Some(MeshError::InvertedTet { tet, nodes, volume })
        } else {
            Some(MeshError::DegenerateTet { tet, nodes, flatness })
        }
    });
    fault.map_or(Ok(()), Err)
}

pub(super) fn no_dangling(nodes: usize, tets: &[[u32; 4]], mids: &[[u32; 6]]) -> Result<(), MeshError> {
    let mut used = vec![false; nodes];
    for &node in tets.iter().flatten().chain(mids.iter().flatten()) {
        used[node as usize] = true;
    }
    match used.iter().position(|&u| !u) {
        Some(node) => {
            let count = used.iter().filter(|&&u| !u).count();
            Err(MeshError::DanglingNode { node, count })
        }
        None => Ok(()),
    }
}

/// Coinciding nodes of the same body are a cut that nobody meant, unless `keep` drops them; those of different bodies
/// are allowed, since bodies in contact may have matching nodes. Here tetrahedra with a common node belong to the same
/// body.
pub(super) fn no_coincident(
    points: &[Vec3],
    tets: &[[u32; 4]],
    mids: &[[u32; 6]],
    keep: impl FnOnce(&mut Vec<(usize, usize)>),
) -> Result<(), MeshError> {
    let mut pairs = Vec::new();
    close_pairs(points, 0.0, |pair| pairs.push(pair));
    if pairs.is_empty() {
        return Ok(());
    }
    keep(&mut pairs);
    let mut bodies = DisjointSets::new(points.len());
    for tet in tets {
        tet[1..]
            .iter()
            .for_each(|&node| bodies.join(tet[0] as usize, node as usize));
    }
    for (tet, mids) in tets.iter().zip(mids) {
        mids.iter()
            .for_each(|&node| bodies.join(tet[0] as usize, node as usize));
    }
    match pairs.into_iter().find(|&(a, b)| bodies.first(a) == bodies.first(b)) {
        Some((first, second)) => Err(MeshError::CoincidentNodes {
            first,
            second,
            distance: vec3::norm(vec3::sub(points[first], points[second])),
        }),
        None => Ok(()),
    }
}

/// Tells pairs of nodes that are no farther apart than `distance`, or that coincide, through a hash of grid cells: the
/// smaller number first. With a large distance these are too many for a list.
pub(super) fn close_pairs(points: &[Vec3], distance: f64, mut tell: impl FnMut((usize, usize))) {
    let (low, high) = extent(points.iter().copied());
    let farthest = low.iter().chain(&high).fold(0.0_f64, |far, x| far.max(x.abs()));
    let same = (COINCIDENT * vec3::norm(vec3::sub(high, low))).max(LAST_DIGIT * farthest);
    let tolerance = distance.max(same);
    let cell = 4.0 * tolerance;
    if cell <= 0.0 || !cell.is_finite() {
        return;
    }
    let key = |p: Vec3| [0, 1, 2].map(|i| ((p[i] - low[i]) / cell).floor() as i64);
    // The last node of each cell, and for each node the one before it in its cell.
    let mut last: HashMap<[i64; 3], usize> = HashMap::with_capacity(points.len());
    let mut before = vec![usize::MAX; points.len()];
    for (node, &p) in points.iter().enumerate() {
        let from = key(p.map(|x| x - tolerance));
        let to = key(p.map(|x| x + tolerance));
        for i in from[0]..=to[0] {
            for j in from[1]..=to[1] {
                for k in from[2]..=to[2] {
                    let mut other = last.get(&[i, j, k]).copied().unwrap_or(usize::MAX);
                    while other != usize::MAX {
                        if vec3::norm(vec3::sub(points[other], p)) <= tolerance {
                            tell((other, node));
                        }
                        other = before[other];
                    }
                }
            }
        }
        if let Some(previous) = last.insert(key(p), node) {
            before[node] = previous;
        }
    }
}

/// Smallest box around some points.
pub(crate) fn extent(points: impl IntoIterator<Item = Vec3>) -> (Vec3, Vec3) {
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    for p in points {
        for i in 0..3 {
            low[i] = low[i].min(p[i]);
            high[i] = high[i].max(p[i]);
        }
    }
    (low, high)
}
