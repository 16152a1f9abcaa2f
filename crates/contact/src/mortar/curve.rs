//! The curves that straight facets stand for: how far the middles of their edges are within them.
//!
//! Nodes of a mesh are on the surface of the part, facets between them are not, by the sagitta `l² / 8 r` of an edge.
//! The curvature of a surface at a node is that of the quadric through its neighbours and theirs, by least squares.
//! With the height `w` of a neighbour over the tangent plane and its distance `d`, `2 w / d²` is the curvature along
//! the way to it, on cylinders and spheres exactly. What is found of one end of an edge only, as where a flat begins,
//! is none.

use crate::tolerances::{DOUBTFUL, FLAT_EDGE, RIM_TURN, SAME_NORMAL, SMALL_CURVATURE};
use crate::vec3::edge_cosine;
use nalgebra::{SMatrix, SVector, SymmetricEigen};
use rayon::prelude::*;
use signorini_fem_mesh::internal::Lists;
use signorini_fem_mesh::vec3::{add, area_vector, dot, norm, scale, sub, unit};
use signorini_fem_mesh::{SurfaceFrame, TetMesh};

/// Of each triangle how far the curve is outside the middles of its edges 01, 12, 20, m: where it is hollow negative,
/// zero where it is flat, at creases, which are given by a cosine, and where mid-nodes are on it.
pub(super) fn bulges(mesh: &TetMesh, corners: &[[u32; 3]], mids: &[Option<[u32; 3]>], crease: f64) -> Vec<[f64; 3]> {
    let mut nodes: Vec<u32> = corners.as_flattened().to_vec();
    nodes.sort_unstable();
    nodes.dedup();
    let around = Lists::by_key(mesh.points().len(), corners.as_flattened());
    let local = |node: u32| nodes.partition_point(|&n| n < node);
    let place = |node: u32| mesh.points()[node as usize];
    let facets = |node: u32| {
        around
            .of(node as usize)
            .iter()
            .map(|&place| &corners[place as usize / 3])
    };
    let normal = |node: u32| {
        let vectors = facets(node).map(|f| area_vector(&f.map(place)));
        unit(vectors.fold([0.0; 3], add))
    };
    let bend = |&node: &u32| Bend::new(mesh, node, &facets(node).collect::<Vec<_>>(), crease);
    let bends: Vec<Bend> = nodes.par_iter().map(bend).collect();
    let curvature = |(&node, bend): (&u32, &Bend)| {
        if *bend != Bend::Curved {
            return None;
        }
        let neighbours = facets(node).flatten().copied();
        let goes_on = |n: &u32| !matches!(bends[local(*n)], Bend::Crease);
        let mut near: Vec<u32> = neighbours.filter(goes_on).flat_map(facets).flatten().copied().collect();
        near.extend(facets(node).flatten());
        near.sort_unstable();
        near.dedup();
        let frame = SurfaceFrame::from_normal(normal(node))?;
        let others = near.iter().filter(|&&n| n != node);
        Curvature::new(frame, &others.map(|&n| sub(place(n), place(node))).collect::<Vec<_>>())
    };
    let curvatures: Vec<Option<Curvature>> = nodes.par_iter().zip(&bends).map(curvature).collect();
    let known = |k: usize, way: [f64; 3]| curvatures[k].as_ref().map_or(0.0, |c| c.along(way));
    let along = |node: u32, way: [f64; 3]| match bends[local(node)] {
        Bend::Open => {
            let others = facets(node).flatten().map(|&n| local(n));
            let others = others.filter(|&k| bends[k] != Bend::Open);
            others.map(|k| known(k, way)).reduce(smaller).unwrap_or(0.0)
        }
        _ => known(local(node), way),
    };
    // where facets hardly say how a surface bends no more than their normals say, which at rims is half
    let doubtful = |node: u32| curvatures[local(node)].as_ref().is_some_and(|c| c.is_doubtful);
    let bulge = |(triangle, mids): (&[u32; 3], &Option<[u32; 3]>)| {
        let edges = [0, 1, 2].map(|k| [triangle[k], triangle[(k + 1) % 3]]);
        let upward = unit(area_vector(&triangle.map(place)));
        let is_bent = |(&[a, b], &mid): (&[u32; 2], &u32)| {
            let off = sub(place(mid), scale(0.5, add(place(a), place(b))));
            dot(off, upward).abs() > FLAT_EDGE * norm(sub(place(b), place(a)))
        };
        if mids.is_some_and(|mids| edges.iter().zip(&mids).any(is_bent)) {
            return [0.0; 3];
        }
        edges.map(|ends| {
            let [from, to] = ends.map(place);
            let way = sub(to, from);
            let least = smaller(along(ends[0], way), along(ends[1], way));
            let length = norm(way);
            let half = (0.5 * length * least).abs().min(1.0);
            let arc = -0.25 * length * length * least / (1.0 + (1.0 - half * half).sqrt());
            let arc = match triangle.iter().any(|&n| doubtful(n)) {
                true => {
                    let turn = sub(normal(ends[1]), normal(ends[0]));
                    smaller(arc, RIM_TURN * 0.125 * dot(way, turn))
                }
                false => arc,
            };
            if arc.abs() > FLAT_EDGE * length { arc } else { 0.0 }
        })
    };
    corners.iter().zip(mids).map(bulge).collect()
}

/// The smaller of two curvatures; none if they are of either sign.
fn smaller(a: f64, b: f64) -> f64 {
    if a * b > 0.0 {
        a.signum() * a.abs().min(b.abs())
    } else {
        0.0
    }
}

/// What the facets around a node are.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Bend {
    Flat,
    /// In one plane at the edge of the surface, beyond which neighbours say what it is.
    Open,
    Curved,
    Crease,
}

impl Bend {
    fn new(mesh: &TetMesh, node: u32, facets: &[&[u32; 3]], crease: f64) -> Self {
        let least = least_cosine(mesh, facets);
        let mut others: Vec<u32> = facets
            .iter()
            .copied()
            .flatten()
            .copied()
            .filter(|&n| n != node)
            .collect();
        others.sort_unstable();
        let is_closed = others.chunk_by(|a, b| a == b).all(|same| same.len() > 1);
        match least {
            _ if least <= crease => Self::Crease,
            _ if least < SAME_NORMAL => Self::Curved,
            _ if is_closed => Self::Flat,
            _ => Self::Open,
        }
    }
}

/// Whether facets around a node are not in one plane, and none meets its neighbour at a crease, which is given by its
/// cosine.
pub(super) fn is_bent(mesh: &TetMesh, facets: &[&[u32; 3]], crease: f64) -> bool {
    let least = least_cosine(mesh, facets);
    least > crease && least < SAME_NORMAL
}

/// The smallest cosine between normals of neighbours.
fn least_cosine(mesh: &TetMesh, facets: &[&[u32; 3]]) -> f64 {
    let vector = |facet: &[u32; 3]| area_vector(&facet.map(|n| mesh.points()[n as usize]));
    let pairs =
        (facets.iter().enumerate()).flat_map(|(k, first)| facets[..k].iter().map(move |other| [*first, *other]));
    let cosines = pairs.filter_map(|pair| edge_cosine(pair, pair.map(vector)));
    cosines.fold(1.0, f64::min)
}

/// The curvatures of a surface at a node in the plane of its tangents, 1/m; of hollow ones positive.
struct Curvature {
    frame: SurfaceFrame,
    form: [f64; 3],
    /// Whether the nodes around hardly say what they are.
    is_doubtful: bool,
}

impl Curvature {
    /// From the ways to nodes around; `None` where these are in the same place.
    fn new(frame: SurfaceFrame, ways: &[[f64; 3]]) -> Option<Self> {
        let mean: f64 = ways.iter().map(|w| dot(*w, *w)).sum::<f64>() / ways.len() as f64;
        let size = mean.sqrt();
        let (mut matrix, mut right) = (SMatrix::<f64, 5, 5>::zeros(), SVector::<f64, 5>::zeros());
        for &way in ways {
            let [x, y] = frame.tangential_part(way);
            let (square, flat) = (dot(way, way), x * x + y * y);
            if flat <= 0.0 {
                continue;
            }
            let (along, more) = (size / square, 1.0 / flat);
            let row = SVector::from([
                x * along,
                y * along,
                0.5 * x * x * more,
                x * y * more,
                0.5 * y * y * more,
            ]);
            matrix += row * row.transpose();
            right += row * (frame.normal_part(way) / square);
        }
        let eigen = SymmetricEigen::new(matrix);
        let largest = eigen.eigenvalues.max();
        let mut found = SVector::<f64, 5>::zeros();
        for (axis, &value) in eigen.eigenvectors.column_iter().zip(&eigen.eigenvalues) {
            if value > SMALL_CURVATURE * largest {
                found += axis * (axis.dot(&right) / value);
            }
        }
        let form = [found[2], found[3], found[4]];
        form.iter().all(|f| f.is_finite()).then_some(Self {
            frame,
            form,
            is_doubtful: eigen.eigenvalues.min() <= DOUBTFUL * largest,
        })
    }

    /// That along a way.
    fn along(&self, way: [f64; 3]) -> f64 {
        let [x, y] = self.frame.tangential_part(way);
        let [a, b, c] = self.form;
        (a * x * x + 2.0 * b * x * y + c * y * y) / (x * x + y * y)
    }
}
