//! What the result of a step shows of what is hardly meant.
//!
//! Looked at when it is asked for, and only for the kinds that have not been met.

use super::narrow::{View, narrow_contact, views};
use super::neutral::neutral_motion;
use super::points::ContactState;
use super::recovered::Recovered;
use super::tilt::{held_by_tilt, spreads};
use crate::discrete::{Extents, beside, mean_place, of_contact, turned, turned_to};
use crate::model::Model;
use crate::report::Warning;
use crate::scene::ContactNormal;
use crate::step::StepProblem;
use crate::tolerances::{
    COARSE_MESH, EDGE_OVERLAP, LARGE_DISPLACEMENT, LARGE_STRAIN, LARGE_TURN, LONG_SLIP, REST, RIGID_STRAIN, TURN,
};
use crate::vec3::{dot, norm};
use nalgebra::{Matrix3, Vector3};
use signorini_fem_mesh::recovery::DiscretisationError;
use signorini_fem_mesh::vec3::centroid;
use signorini_fem_mesh::{Element, TetMesh, fields};
use std::cell::LazyCell;
use std::collections::HashMap;

/// Lengths of a mesh that results are compared with.
#[derive(Debug)]
pub(crate) struct Lengths {
    extents: Extents,
    /// Least height of a tetrahedron, m.
    thinnest: f64,
    /// Longest edge at each node of each contact surface, m.
    edges: Vec<Vec<f64>>,
    /// Centre of the nodes of each body, m, and the inverse of their moments of inertia about it.
    inertia: Vec<(Vector3<f64>, Matrix3<f64>)>,
    /// What facets make of normals at the nodes of each contact surface.
    spreads: Vec<Vec<Matrix3<f64>>>,
    /// What of the gaps around it each point of quadratic facets sees.
    views: Vec<View>,
}

impl Lengths {
    pub(crate) fn new(model: &Model) -> Self {
        let mesh = &model.scene.mesh;
        let steepest = |tet: usize| {
            let gradients = Element::new(&mesh.tet_points(tet)).gradients;
            gradients.iter().map(|g| norm(g)).fold(0.0, f64::max)
        };
        let steepest = (0..mesh.tets().len()).map(steepest).fold(0.0, f64::max);
        let edges = model.discrete.surfaces.iter().map(|surface| {
            let mut longest = vec![0.0_f64; surface.nodes().len()];
            for triangle in surface.triangles() {
                for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                    let ends = [triangle[a] as usize, triangle[b] as usize];
                    let [x, y] = ends.map(|n| mesh.points()[surface.nodes()[n] as usize]);
                    let edge = norm(&[0, 1, 2].map(|c| x[c] - y[c]));
                    ends.iter().for_each(|&n| longest[n] = longest[n].max(edge));
                }
            }
            longest
        });
        let extents = Extents::new(mesh, &model.discrete.decomposition);
        Self {
            inertia: inertia(mesh, &extents),
            extents,
            thinnest: 1.0 / steepest,
            edges: edges.collect(),
            spreads: spreads(model),
            views: views(model),
        }
    }
}

/// Centre and inverse inertia of the nodes of each body, all of one weight.
fn inertia(mesh: &TetMesh, extents: &Extents) -> Vec<(Vector3<f64>, Matrix3<f64>)> {
    let mut sums = vec![(0.0, Vector3::zeros()); extents.bodies()];
    let places = || (mesh.points().iter().enumerate()).map(|(node, x)| (extents.body(node), Vector3::from(*x)));
    for (body, x) in places() {
        sums[body].0 += 1.0;
        sums[body].1 += x;
    }
    let mut out: Vec<_> = sums.into_iter().map(|(n, sum)| (sum / n, Matrix3::zeros())).collect();
    for (body, x) in places() {
        let across = (x - out[body].0).cross_matrix();
        out[body].1 -= across * across;
    }
    out.iter_mut()
        .for_each(|(_, inertia)| *inertia = inertia.try_inverse().unwrap_or_else(Matrix3::zeros));
    out
}

/// What the result of a step is warned of, each kind at its worst place, without those that are `known`. A pass over
/// the nodes and the contact points; the tetrahedra are looked at only where displacements could make such strains.
pub(crate) fn warnings(
    model: &Model,
    lengths: &Lengths,
    problem: &StepProblem,
    recovered: &Recovered,
    known: &[Warning],
) -> Vec<Warning> {
    let step = problem.index;
    let mesh = &model.scene.mesh;
    let u = LazyCell::new(|| model.tfeti.nodal_mean(&recovered.torn));
    let mut out = Vec::new();
    macro_rules! look {
        ($kind:ident, $find:expr) => {
            if !known.iter().any(|w| matches!(w.plain(), Warning::$kind { .. })) {
                out.extend($find);
            }
        };
    }
    look!(LargeDisplacement, large_displacement(mesh, lengths, &u, step));
    look!(LargeRotation, large_rotation(mesh, lengths, &u, step));
    look!(LargeStrain, large_strain(mesh, lengths, &u, step));
    look!(LongSlip, long_slip(model, lengths, recovered, step));
    look!(EdgeOverlap, edge_overlap(model, recovered, &u, step));
    look!(TurnedNormal, turned_normal(model, recovered, &u, step));
    look!(
        NarrowContact,
        narrow_contact(model, &lengths.views, (recovered, &u), step)
    );
    look!(
        HeldByTilt,
        held_by_tilt(model, &lengths.spreads, problem, recovered, step)
    );
    look!(NeutralPlace, neutral_motion(model, &lengths.extents, recovered, step));
    out
}

/// A place and a figure there; the larger one, the first of equal ones.
fn worst<P>(values: impl Iterator<Item = (P, f64)>) -> Option<(P, f64)> {
    values
        .filter(|v| !v.1.is_nan())
        .reduce(|a, b| if b.1 > a.1 { b } else { a })
}

fn large_displacement(mesh: &TetMesh, lengths: &Lengths, u: &[f64], step: usize) -> Option<Warning> {
    let part = |(node, u): (usize, &[f64])| (node, norm(u) / lengths.extents.at(node as u32));
    let (node, part) = worst(u.chunks_exact(3).enumerate().map(part))?;
    (part > LARGE_DISPLACEMENT).then(|| Warning::LargeDisplacement {
        step,
        node: node as u32,
        place: mesh.points()[node],
        displacement: norm(&u[3 * node..3 * node + 3]),
        extent: lengths.extents.at(node as u32),
    })
}

/// The rotation of a body is that which fits the displacements of its nodes best.
fn large_rotation(mesh: &TetMesh, lengths: &Lengths, u: &[f64], step: usize) -> Option<Warning> {
    let mut moments = vec![Vector3::zeros(); lengths.inertia.len()];
    let nodes = || (mesh.points().iter().zip(u.chunks_exact(3))).enumerate();
    for (node, (x, u)) in nodes() {
        let body = lengths.extents.body(node);
        moments[body] += (Vector3::from(*x) - lengths.inertia[body].0).cross(&Vector3::from_column_slice(u));
    }
    let turns = moments.iter().zip(&lengths.inertia);
    let turns = turns.map(|(moment, (_, inverse))| (inverse * moment).norm());
    let (body, turn) = worst(turns.enumerate())?;
    if turn <= LARGE_TURN {
        return None;
    }
    let moved = nodes().filter(|(node, _)| lengths.extents.body(*node) == body);
    let (node, _) = worst(moved.map(|(node, (_, u))| (node, norm(u))))?;
    Some(Warning::LargeRotation {
        step,
        node: node as u32,
        place: mesh.points()[node],
        turn: turn.to_degrees(),
    })
}

/// No strain exceeds the sum over four nodes of displacement over height; of ten with gradients of up to 3 (corners)
/// and 8 (mid-nodes) over the height.
fn large_strain(mesh: &TetMesh, lengths: &Lengths, u: &[f64], step: usize) -> Option<Warning> {
    let largest = u.chunks_exact(3).map(norm).fold(0.0, f64::max);
    let gradients = if mesh.order() == 2 { 60.0 } else { 4.0 };
    if gradients * largest <= LARGE_STRAIN * lengths.thinnest {
        return None;
    }
    let strains = fields::strains(mesh, u).ok()?;
    let (tet, strain) = worst(strains.iter().map(size).enumerate())?;
    (strain > LARGE_STRAIN).then(|| Warning::LargeStrain {
        step,
        tet,
        place: centroid(&mesh.tet_points(tet)),
        strain,
    })
}

/// Root of the sum of the squares of all nine strains; shear is given twice as large.
fn size([xx, yy, zz, yz, xz, xy]: &[f64; 6]) -> f64 {
    let squares = xx * xx + yy * yy + zz * zz + 0.5 * (yz * yz + xz * xz + xy * xy);
    squares.sqrt()
}

/// Whether an obstacle's shape gives the normals of a contact.
fn is_shaped(model: &Model, contact: usize) -> bool {
    model.scene.contacts[contact].normal() == ContactNormal::Obstacle
}

/// Not where a shape gives the normals: a drum may turn under a shoe as far as it likes, and turned normals are told.
fn long_slip(model: &Model, lengths: &Lengths, recovered: &Recovered, step: usize) -> Option<Warning> {
    let touching = recovered.points.iter().filter(|p| p.state != ContactState::Open);
    let touching = touching.filter(|p| !is_shaped(model, p.surface));
    let ways = touching.filter_map(|p| {
        let edge = lengths.edges[p.surface][model.discrete.surfaces[p.surface].local(p.node)?];
        // a partner stays the same one, however many steps there are
        let slip = norm(if p.partner.is_some() { &p.tangential_displacement } else { &p.difference });
        Some(((p, slip, edge), slip / edge))
    });
    let ((point, slip, edge), part) = worst(ways)?;
    (part > LONG_SLIP).then(|| Warning::LongSlip {
        step,
        contact: point.surface,
        node: point.node,
        place: model.scene.mesh.points()[point.node as usize],
        slip,
        edge,
    })
}

/// Looked at where contacts have handed conditions on: from a point that has them on, gaps are as displacements make
/// them.
fn edge_overlap(model: &Model, recovered: &Recovered, u: &[f64], step: usize) -> Option<Warning> {
    let (scene, discrete) = (&model.scene, &model.discrete);
    if discrete.handed_on.is_empty() {
        return None;
    }
    let mut heirs = HashMap::new();
    for (point, state) in model.points.iter().zip(&recovered.points) {
        for (node, _) in point.contact.sides.own.nodes() {
            heirs.entry((point.surface(), *node)).or_insert((point, state));
        }
    }
    let along = |node: u32, direction: &[f64; 3]| dot(&u[3 * node as usize..][..3], direction);
    let overlaps = discrete.handed_on.iter().filter_map(|own| {
        let (point, state) = heirs.get(&(own.contact, own.sides.node()))?;
        let [way, heir] = [&own.sides, &point.contact.sides].map(|sides| sides.way(&own.normal, along));
        Some((own, way - heir - state.gap))
    });
    let (own, overlap) = worst(overlaps)?;
    let largest = u.chunks_exact(3).map(norm).fold(0.0, f64::max);
    (overlap > EDGE_OVERLAP * largest).then(|| Warning::EdgeOverlap {
        step,
        contact: own.contact,
        node: own.sides.node(),
        place: scene.mesh.points()[own.sides.node() as usize],
        overlap,
        largest,
    })
}

/// Looked at only where contacts have the normals of shapes: at nodes that touch, and at those without a point that are
/// inside the obstacle.
fn turned_normal(model: &Model, recovered: &Recovered, u: &[f64], step: usize) -> Option<Warning> {
    let (scene, discrete) = (&model.scene, &model.discrete);
    let pose = |contact: usize| discrete.poses[contact].get(step).copied().unwrap_or_default();
    let displaced = |node: u32| {
        let (at, first) = (scene.mesh.points()[node as usize], 3 * node as usize);
        [0, 1, 2].map(|c| at[c] + u[first + c])
    };
    let pairs = model.points.iter().zip(&recovered.points);
    let touching = pairs.filter(|(p, state)| is_shaped(model, p.surface()) && state.state != ContactState::Open);
    let turns = touching.map(|(p, _)| {
        let place = mean_place(&p.contact.sides.own, displaced);
        let turn = turned(scene, &p.contact, &pose(p.surface()), &place);
        ((p.surface(), p.node()), turn)
    });
    let shaped = (0..scene.contacts.len()).filter(|&k| is_shaped(model, k) && scene.acts(scene.contacts[k].span));
    let without = shaped.flat_map(|contact| {
        let own = &discrete.conditions[of_contact(&discrete.conditions, contact)];
        let nodes = beside(&discrete.surfaces[contact], own);
        nodes.map(move |(node, normal)| (contact, node, normal))
    });
    let reached = without.filter_map(|own @ (contact, node, _)| {
        let (pose, place) = (pose(contact), displaced(node));
        let depth = -scene.contacts[contact].shape.as_ref()?.distance(pose.origin(&place)).0;
        (depth > discrete.rounding).then(|| ((contact, node), turned_to(scene, own, &pose, &place)))
    });
    let ((contact, node), turn) = worst(turns.chain(reached))?;
    (turn > TURN).then(|| Warning::TurnedNormal {
        step,
        contact,
        node,
        place: scene.mesh.points()[node as usize],
        turn: turn.to_degrees(),
    })
}

/// Whether there is strain that is more than what the solver leaves of earlier steps or of a rigid motion. The
/// estimated error of the mesh is noise over noise elsewhere.
pub(crate) fn is_strained(model: &Model, lengths: &Lengths, problem: &StepProblem, recovered: &Recovered) -> bool {
    let u = model.tfeti.nodal_mean(&recovered.torn);
    let before = problem.peaks.iter().map(|p| p.displacement).fold(0.0, f64::max);
    let largest = u.chunks_exact(3).map(norm).fold(0.0, f64::max);
    let part = |(node, u): (usize, &[f64])| norm(u) / lengths.extents.at(node as u32);
    let part = u.chunks_exact(3).enumerate().map(part).fold(0.0, f64::max);
    let strained = |strains: Vec<[f64; 6]>| strains.iter().any(|e| size(e) > RIGID_STRAIN * part);
    largest > REST * before && fields::strains(&model.scene.mesh, &u).is_ok_and(strained)
}

/// What is to be said of the error of the mesh.
pub(crate) fn coarse_mesh(model: &Model, error: &DiscretisationError, step: usize) -> Option<Warning> {
    let relative = error.relative();
    let (tet, _) = worst(error.energies.iter().copied().enumerate())?;
    (relative > COARSE_MESH).then(|| Warning::CoarseMesh {
        step,
        error: relative,
        tet,
        place: centroid(&model.scene.mesh.tet_points(tet)),
    })
}
