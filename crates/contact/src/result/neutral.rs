//! Whether a body that slides wherever it is pressed has a place.
//!
//! A shim between two plates of equal coefficient is pushed by the one as much as it is held by the other, wherever it
//! is. Neutral is a motion of such bodies along which no normal blocks them and that is along the slip at every pressed
//! point: friction does not change until the slip somewhere is used up. Where that is soon, as in the middle of what is
//! squeezed and slides apart, the motion is told from others all the same.

use super::points::ContactState;
use super::recovered::Recovered;
use crate::discrete::Extents;
use crate::model::{Model, slide};
use crate::report::Warning;
use crate::tolerances::{NEUTRAL, NEUTRAL_WAY};
use crate::vec3::{dot, norm};
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use signorini_fem_mesh::vec3::cross;
use signorini_tfeti::FreeMotion;

const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// A neutral motion at the end of a step.
pub(super) fn neutral_motion(model: &Model, extents: &Extents, recovered: &Recovered, step: usize) -> Option<Warning> {
    let all = model.loose_motions().ok()?;
    if all.is_empty() {
        return None;
    }
    let pressed = || {
        let points = model.points.iter().zip(&recovered.points);
        points.filter(|(_, state)| state.normal_force < 0.0)
    };
    let (mut held, mut slides) = (vec![false; extents.bodies()], vec![false; extents.bodies()]);
    for (point, state) in pressed() {
        let into = if state.state == ContactState::Slip { &mut slides } else { &mut held };
        let nodes = point.contact.sides.nodes();
        nodes.for_each(|(node, _)| into[extents.body(node as usize)] = true);
    }
    let subdomains = model.discrete.decomposition.subdomains();
    let bodies_of = |motion: &FreeMotion| {
        let nodes = motion.bodies.iter().map(|part| subdomains[part.subdomain].nodes[0]);
        nodes.map(|node| extents.body(node as usize)).collect::<Vec<_>>()
    };
    let mut free = vec![false; extents.bodies()];
    let motions: Vec<&FreeMotion> = all
        .iter()
        .filter(|motion| {
            let bodies = bodies_of(motion);
            let is_free = bodies.iter().all(|b| !held[*b]) && bodies.iter().any(|b| slides[*b]);
            bodies.iter().for_each(|b| free[*b] |= is_free);
            is_free
        })
        .collect();
    if motions.is_empty() {
        return None;
    }
    let touching = pressed().filter(|(point, _)| {
        let mut nodes = point.contact.sides.nodes();
        nodes.any(|(node, _)| free[extents.body(node as usize)])
    });
    let ways = touching.map(|(point, state)| {
        let way = |motion: &&FreeMotion| {
            let along = |node: u32, d: &[f64; 3]| dot(&model.moved_by(motion, node), d);
            AXES.map(|axis| point.contact.sides.way(&axis, along))
        };
        (state, motions.iter().map(way).collect::<Vec<_>>())
    });
    let ways: Vec<_> = ways.collect();
    let count = motions.len();
    let mut blocked = DMatrix::<f64>::zeros(count, count);
    for (state, ways) in &ways {
        let across = cross(state.normal, state.difference);
        let length = norm(&across);
        // no friction, no slip to be along
        let across = if state.slip_bound > 0.0 { across.map(|c| c / length) } else { [0.0; 3] };
        for direction in [state.normal, across] {
            let parts = DVector::from_iterator(count, ways.iter().map(|way| dot(way, &direction)));
            blocked.ger(state.area, &parts, &parts, 1.0);
        }
    }
    let eigen = SymmetricEigen::new(blocked);
    let (at, least) = eigen.eigenvalues.argmin();
    if least > NEUTRAL * eigen.eigenvalues.max() {
        return None;
    }
    let factors = eigen.eigenvectors.column(at);
    // how far it goes either way until the slip somewhere is used up
    let rubbing = ways.iter().filter(|(state, _)| state.slip_bound > 0.0);
    let alongs = rubbing.map(|(state, ways)| {
        let slip = norm(&state.difference);
        let along = ways.iter().zip(factors.iter());
        let along: f64 = along.map(|(way, factor)| factor * dot(way, &state.difference)).sum();
        (slip, along / slip)
    });
    let alongs: Vec<(f64, f64)> = alongs.collect();
    let most = alongs.iter().map(|(_, along)| along.abs()).fold(0.0, f64::max);
    let (mut reach, mut longest) = ([f64::INFINITY; 2], 0.0_f64);
    for (slip, along) in alongs.into_iter().filter(|(_, along)| along.abs() >= 0.1 * most) {
        let way = slip * most / along.abs();
        let side = &mut reach[usize::from(along > 0.0)];
        *side = side.min(way);
        longest = longest.max(way);
    }
    let slide = slide(model, &motions, factors.as_slice());
    let range = reach[0] + reach[1];
    (range.is_finite() && range >= NEUTRAL_WAY * longest).then(|| Warning::NeutralPlace {
        step,
        body: slide.body as usize,
        node: slide.node,
        mode: slide.to_string(),
        range,
    })
}
