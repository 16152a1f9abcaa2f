//! The geometry of quadratic tetrahedra and of their facets, with straight or curved edges, and its checks.

use rayon::prelude::*;

use crate::quadrature;
use crate::tables::distinct;
use crate::tolerances::{CURVED, MID_OFF, PLANE_FACET};
use crate::vec3::{Vec3, add, cross, norm, scale, sub, tet_volume, unit};

use super::cells::EDGES;
use super::error::MeshError;

/// Barycentric coordinates of the ten nodes.
pub(crate) const NODES: [[f64; 4]; 10] = {
    let mut out = [[0.0; 4]; 10];
    let mut k = 0;
    while k < 10 {
        if k < 4 {
            out[k][k] = 1.0;
        } else {
            out[k][EDGES[k - 4][0]] = 0.5;
            out[k][EDGES[k - 4][1]] = 0.5;
        }
        k += 1;
    }
    out
};

/// The same of a facet.
const FACET_EDGES: [[usize; 2]; 3] = [[0, 1], [1, 2], [2, 0]];

/// Quadratic shape functions at barycentric coordinates: those of the corners, then those of the mid-nodes.
pub(crate) fn shape(l: &[f64; 4]) -> [f64; 10] {
    let corner = |i: usize| l[i] * (2.0 * l[i] - 1.0);
    let mid = |k: usize| 4.0 * l[EDGES[k][0]] * l[EDGES[k][1]];
    std::array::from_fn(|k| if k < 4 { corner(k) } else { mid(k - 4) })
}

/// The same of a facet: corners, then the mid-nodes of the edges 01, 12, 20.
pub fn facet_shape(l: &[f64; 3]) -> [f64; 6] {
    let corner = |i: usize| l[i] * (2.0 * l[i] - 1.0);
    let mid = |k: usize| 4.0 * l[FACET_EDGES[k][0]] * l[FACET_EDGES[k][1]];
    std::array::from_fn(|k| if k < 3 { corner(k) } else { mid(k - 3) })
}

/// Derivatives of values at the nodes along each barycentric coordinate.
fn derivatives<const C: usize>(values: &[Vec3], edges: &[[usize; 2]], l: &[f64; C]) -> [Vec3; C] {
    let mut out: [Vec3; C] = std::array::from_fn(|i| scale(4.0 * l[i] - 1.0, values[i]));
    for (&[a, b], &value) in edges.iter().zip(&values[C..]) {
        out[a] = add(out[a], scale(4.0 * l[b], value));
        out[b] = add(out[b], scale(4.0 * l[a], value));
    }
    out
}

/// The straight tetrahedron that a quadratic one is like at a point: its edges from corner 0 are the derivatives of
/// the place there, so that it has the volume and the gradients of barycentric coordinates at this point.
pub(crate) fn tangents(points: &[Vec3; 10], l: &[f64; 4]) -> [Vec3; 4] {
    let along = derivatives(points, &EDGES, l);
    std::array::from_fn(|i| if i == 0 { [0.0; 3] } else { sub(along[i], along[0]) })
}

/// Place and area vector, twice the area per barycentric area, of a facet at a point.
pub(crate) fn curved_facet(points: &[Vec3; 6], l: &[f64; 3]) -> (Vec3, Vec3) {
    let along = derivatives(points, &FACET_EDGES, l);
    let [u, v] = [1, 2].map(|i| sub(along[i], along[0]));
    (quadrature::at(points, &facet_shape(l)), scale(0.5, cross(u, v)))
}

/// The areas that nodes of a facet have in a constant traction: integrals of their shape functions.
pub fn facet_shares(points: &[Vec3; 6]) -> [f64; 6] {
    facet_integrals(points, |area| [norm(area)]).map(|[share]| share)
}

/// The area vectors that nodes of a facet have in a constant pressure: the same integrals along the normal.
pub fn facet_area_shares(points: &[Vec3; 6]) -> [Vec3; 6] {
    facet_integrals(points, |area| area)
}

/// Integrals of the shape functions with a measure that an area vector has.
fn facet_integrals<const K: usize>(points: &[Vec3; 6], measure: impl Fn(Vec3) -> [f64; K]) -> [[f64; K]; 6] {
    let mut out = [[0.0; K]; 6];
    for (l, weight) in quadrature::triangle() {
        let measure = measure(curved_facet(points, &l).1);
        for (sums, shape) in out.iter_mut().zip(facet_shape(&l)) {
            sums.iter_mut()
                .zip(measure)
                .for_each(|(sum, measure)| *sum += weight * measure * shape);
        }
    }
    out
}

/// Unit normals of a facet at its corners and mid-nodes; `None` if it is plane.
pub fn facet_normals(points: &[Vec3; 6]) -> Option<[Vec3; 6]> {
    let middle = |a: usize, b: usize| std::array::from_fn(|i| if i == a || i == b { 0.5 } else { 0.0 });
    let corner = |a: usize| std::array::from_fn(|i| f64::from(u8::from(i == a)));
    let normals: [Vec3; 6] = std::array::from_fn(|k| {
        let l = if k < 3 { corner(k) } else { middle(FACET_EDGES[k - 3][0], FACET_EDGES[k - 3][1]) };
        unit(curved_facet(points, &l).1)
    });
    // not of a facet without a normal at a node
    let turned = normals[1..].iter().any(|n| norm(cross(*n, normals[0])) > PLANE_FACET);
    (turned && normals.iter().flatten().all(|c| c.is_finite())).then_some(normals)
}

pub(super) fn volume(points: &[Vec3; 10]) -> f64 {
    let rule = quadrature::tetrahedron();
    rule.iter()
        .map(|(l, weight)| weight * tet_volume(&tangents(points, l)))
        .sum()
}

/// Checks the mid-nodes: their numbers, their places on the edges, and that no tetrahedron is turned inside out.
pub(super) fn check(points: &[Vec3], tets: &[[u32; 4]], mids: &[[u32; 6]]) -> Result<(), MeshError> {
    if mids.is_empty() {
        return Ok(());
    }
    check_numbers(points.len(), tets, mids)?;
    let fault = tets
        .par_iter()
        .zip(mids)
        .enumerate()
        .find_map_first(|(tet, (corners, mids))| {
            let at = |n: u32| points[n as usize];
            for (&[a, b], &node) in EDGES.iter().zip(mids) {
                let edge = [corners[a], corners[b]];
                let [from, to] = edge.map(at);
                let distance = norm(sub(at(node), scale(0.5, add(from, to)))) / norm(sub(to, from));
                if distance > MID_OFF {
                    let limit = MID_OFF;
                    return Some(MeshError::MidNodeOff {
                        tet,
                        node,
                        edge,
                        distance,
                        limit,
                    });
                }
            }
            let all = std::array::from_fn(|k| at(if k < 4 { corners[k] } else { mids[k - 4] }));
            let least = least_volume(&all) / tet_volume(&corners.map(at));
            (least < CURVED).then_some(MeshError::CurvedInside {
                tet,
                nodes: *corners,
                least,
                limit: CURVED,
            })
        });
    fault.map_or(Ok(()), Err)
}

/// Least volume of the tangent tetrahedra at nodes, quarters of edges, where folds begin, and points of quadrature.
fn least_volume(points: &[Vec3; 10]) -> f64 {
    let inside = quadrature::tetrahedron().into_iter().map(|(l, _)| l);
    let quarters = EDGES.into_iter().flat_map(|[a, b]| {
        [[a, b], [b, a]].map(|[near, far]| {
            let mut l = [0.0; 4];
            (l[near], l[far]) = (0.75, 0.25);
            l
        })
    });
    let all = NODES
        .into_iter()
        .chain(quarters)
        .chain(inside)
        .chain(quadrature::FOUR_POINTS);
    all.map(|l| tet_volume(&tangents(points, &l)))
        .fold(f64::INFINITY, f64::min)
}

/// Every edge has one mid-node, and every mid-node one edge.
fn check_numbers(nodes: usize, tets: &[[u32; 4]], mids: &[[u32; 6]]) -> Result<(), MeshError> {
    let mut is_corner = vec![false; nodes];
    tets.iter().flatten().for_each(|&n| is_corner[n as usize] = true);
    let mut edges: Vec<([u32; 2], u32)> = Vec::with_capacity(6 * tets.len());
    for (tet, (corners, mids)) in tets.iter().zip(mids).enumerate() {
        for (&[a, b], &node) in EDGES.iter().zip(mids) {
            match is_corner.get(node as usize) {
                None => return Err(MeshError::NodeOutOfRange { tet, node, nodes }),
                Some(true) => return Err(MeshError::MidNodeCorner { tet, node }),
                Some(false) => {}
            }
            let [a, b] = [corners[a], corners[b]];
            edges.push(([a.min(b), a.max(b)], node));
        }
    }
    let mut edges = distinct(edges);
    if let Some(w) = edges.windows(2).find(|w| w[0].0 == w[1].0) {
        let (edge, first, second) = (w[0].0, w[0].1, w[1].1);
        return Err(MeshError::MidNodesOfEdge { edge, first, second });
    }
    edges.sort_unstable_by_key(|e| (e.1, e.0));
    if let Some(w) = edges.windows(2).find(|w| w[0].1 == w[1].1) {
        let (node, first, second) = (w[0].1, w[0].0, w[1].0);
        return Err(MeshError::MidNodeTwice { node, first, second });
    }
    Ok(())
}
