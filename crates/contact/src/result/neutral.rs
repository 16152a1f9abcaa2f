//! Whether a body that slides wherever it is pressed has a place.
//!
//! A shim between two plates of equal coefficient is pushed by the one as much as it is held by the other, wherever it
//! is. Neutral is a motion of such bodies along which no normal blocks them and that is along the slip at every pressed
//! point: friction does not change until the slip somewhere is used up. Where that is soon, as in the middle of what is
//! squeezed and slides apart, the motion is told from others all the same.

use super::points::{ContactState, PointState};
use super::recovered::Recovered;
use crate::discrete::Extents;
use crate::model::{ConstrainedPoint, Model, slide};
use crate::report::Warning;
use crate::tolerances::{NEUTRAL, NEUTRAL_WAY};
use crate::vec3::{dot, norm};
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use signorini_fem_mesh::vec3::cross;
use signorini_tfeti::{BodyMotion, FreeMotion};

/// A neutral motion at the end of a step: of each body, and those joined to it, by themselves.
pub(super) fn neutral_motion(model: &Model, extents: &Extents, recovered: &Recovered, step: usize) -> Option<Warning> {
    let all = model.loose_motions().ok()?;
    if all.is_empty() {
        return None;
    }
    let pressed = pressed_points(model, recovered);
    let motions = of_sliding_bodies(model, extents, pressed.iter().flatten(), all);
    let mut of_bodies = vec![Vec::new(); pressed.len()];
    for motion in motions {
        let body = motion.bodies.first().map_or(0, |own| model.bodies.of_body(own.body));
        of_bodies[body].push(motion);
    }
    let mut bodies = pressed
        .iter()
        .zip(&of_bodies)
        .filter(|(_, motions)| !motions.is_empty());
    bodies.find_map(|(pressed, motions)| of_motions(model, pressed, motions, step))
}

/// The points that are pressed, by [bodies](Model::bodies).
pub(super) fn pressed_points<'a>(model: &'a Model, recovered: &'a Recovered) -> Vec<Vec<Pressed<'a>>> {
    let mut out = vec![Vec::new(); model.bodies.count().max(1)];
    let points = model.points.iter().zip(&recovered.points);
    for (point, state) in points.filter(|(_, state)| state.normal_force < 0.0) {
        out[model.bodies.of_row(point.row)].push((point, state));
    }
    out
}

fn of_motions(model: &Model, pressed: &[Pressed<'_>], motions: &[&FreeMotion], step: usize) -> Option<Warning> {
    let ways = pressed
        .iter()
        .map(|(point, state)| (*state, model.ways(point, motions)));
    let moved = ways.filter(|(_, ways)| ways.iter().any(|way| *way != [0.0; 3]));
    let moved: Vec<Moved<'_>> = moved.collect();
    let eigen = SymmetricEigen::new(blocked(&moved, motions.len()));
    let (at, least) = eigen.eigenvalues.argmin();
    let factors = eigen.eigenvectors.column(at);
    let (range, longest) = range(&moved, factors.as_slice());
    let neutral = least <= NEUTRAL * eigen.eigenvalues.max() && range.is_finite() && range >= NEUTRAL_WAY * longest;
    neutral.then(|| {
        let slide = slide(model, motions, factors.as_slice());
        Warning::NeutralPlace {
            step,
            body: slide.body as usize,
            node: slide.node,
            mode: slide.to_string(),
            range,
        }
    })
}

/// A point, and its state.
pub(super) type Pressed<'a> = (&'a ConstrainedPoint, &'a PointState);

/// The state of a point, and how each motion moves its sides relative to each other.
type Moved<'a> = (&'a PointState, Vec<[f64; 3]>);

/// The motions of bodies that have friction, and slide wherever they have it.
fn of_sliding_bodies<'a>(
    model: &Model,
    extents: &Extents,
    pressed: impl Iterator<Item = &'a Pressed<'a>>,
    all: &'a [FreeMotion],
) -> Vec<&'a FreeMotion> {
    let [mut sticks, mut slides] = [(); 2].map(|()| vec![false; extents.bodies()]);
    for (point, state) in pressed.filter(|(_, state)| state.slip_bound > 0.0) {
        let slips = state.state == ContactState::Slip && norm(&state.difference) > 0.0;
        for (node, _) in point.contact.sides.nodes() {
            let body = extents.body(node as usize);
            sticks[body] |= !slips;
            slides[body] |= slips;
        }
    }
    let subdomains = model.discrete.decomposition.subdomains();
    let body = |part: &BodyMotion| extents.body(subdomains[part.subdomain].nodes[0] as usize);
    let is_free = |motion: &&FreeMotion| {
        let mut bodies = motion.bodies.iter().map(body);
        bodies.clone().all(|b| !sticks[b]) && bodies.any(|b| slides[b])
    };
    all.iter().filter(is_free).collect()
}

/// What normals, and the directions across the slip, block of motions.
fn blocked(moved: &[Moved<'_>], count: usize) -> DMatrix<f64> {
    let mut blocked = DMatrix::zeros(count, count);
    for (state, ways) in moved {
        let across = cross(state.normal, state.difference);
        let length = norm(&across);
        // without friction there is no slip to be along
        let slips = state.slip_bound > 0.0 && length > 0.0;
        let across = if slips { across.map(|c| c / length) } else { [0.0; 3] };
        for direction in [state.normal, across] {
            let parts = DVector::from_iterator(count, ways.iter().map(|way| dot(way, &direction)));
            blocked.ger(state.area, &parts, &parts, 1.0);
        }
    }
    blocked
}

/// How far a sum of motions goes, forth and back in all, until the slip of a point that it moves is used up; and the
/// longest slip of these.
fn range(moved: &[Moved<'_>], factors: &[f64]) -> (f64, f64) {
    let rubbing = moved.iter().filter(|(state, _)| state.slip_bound > 0.0);
    let alongs = rubbing.map(|(state, ways)| {
        let slip = norm(&state.difference);
        let along = ways.iter().zip(factors);
        let along: f64 = along.map(|(way, factor)| factor * dot(way, &state.difference)).sum();
        (slip, along / slip)
    });
    let alongs: Vec<(f64, f64)> = alongs.collect();
    let most = alongs.iter().map(|(_, along)| along.abs()).fold(0.0, f64::max);
    let (mut reach, mut longest) = ([f64::INFINITY; 2], 0.0_f64);
    for (slip, along) in alongs.into_iter().filter(|(_, along)| along.abs() > NEUTRAL * most) {
        let side = &mut reach[usize::from(along > 0.0)];
        *side = side.min(slip * most / along.abs());
        longest = longest.max(slip);
    }
    (reach[0] + reach[1], longest)
}
