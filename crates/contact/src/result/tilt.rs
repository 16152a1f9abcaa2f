//! Whether normal forces hold what only the tilt of facets lets them hold.
//!
//! The facets of a body for a round surface are tilted against it by up to half their length over its radius, and the
//! normals of its nodes with them. Along a motion that the round surface leaves free they hold all the same, by forces
//! that the mesh alone decides. Such motions are those across which normals differ from those of the facets around
//! them more than they block.

use super::neutral::pressed_points;
use super::points::ContactState;
use super::recovered::Recovered;
use crate::model::{Model, loose_motions_of, slide};
use crate::report::Warning;
use crate::scene::{Contact, ContactNormal};
use crate::step::StepProblem;
use crate::tolerances::{HELD_BY_TILT, ROUNDING, TILT_MATTERS};
use nalgebra::{DMatrix, DVector, Matrix3, SymmetricEigen, Vector3};
use signorini_fem_mesh::{Surface, TetMesh};
use signorini_qp::vector;

/// Of the nodes of each contact surface the mean square of what the normals of the facets around it have more than its
/// own; empty where supports hold all bodies, or obstacles give the normals.
pub(super) fn spreads(model: &Model) -> Vec<Vec<Matrix3<f64>>> {
    let is_free = model.loose_motions().is_ok_and(|motions| !motions.is_empty());
    let surfaces = model.discrete.surfaces.iter().zip(&model.scene.contacts);
    let spread = |(surface, contact): (&Surface, &Contact)| match contact.normal() {
        ContactNormal::Body if is_free => spread(&model.scene.mesh, surface),
        _ => Vec::new(),
    };
    surfaces.map(spread).collect()
}

fn spread(mesh: &TetMesh, surface: &Surface) -> Vec<Matrix3<f64>> {
    let mut sums = vec![(0.0, Matrix3::zeros()); surface.nodes().len()];
    for (t, corners) in surface.triangles().iter().enumerate() {
        for (k, node) in corners.iter().map(|n| *n as usize).enumerate() {
            let (area, normal) = surface.corner(mesh, t, k);
            let normal = Vector3::from(normal).try_normalize(0.0).unwrap_or_default();
            let more = normal - Vector3::from(surface.frames()[node].normal);
            sums[node].0 += area;
            sums[node].1 += area * more * more.transpose();
        }
    }
    sums.into_iter()
        .map(|(area, sum)| sum / f64::max(area, f64::MIN_POSITIVE))
        .collect()
}

/// The body of which this is most so, at the end of a step.
pub(super) fn held_by_tilt(
    model: &Model,
    spreads: &[Vec<Matrix3<f64>>],
    problem: &StepProblem,
    recovered: &Recovered,
    step: usize,
) -> Option<Warning> {
    if spreads.iter().all(Vec::is_empty) {
        return None;
    }
    let all = model.loose_motions().ok()?;
    let mut worst: Option<(f64, Warning)> = None;
    for (body, pressed) in pressed_points(model, recovered).into_iter().enumerate() {
        let motions = loose_motions_of(model, body, all);
        let blurred = pressed.into_iter().map(|(point, state)| {
            let own = model.discrete.surfaces[state.surface].local(state.node);
            let blur = own.and_then(|local| spreads[state.surface].get(local));
            (point, state, blur.copied().unwrap_or_default())
        });
        let blurred: Vec<_> = blurred.collect();
        if motions.is_empty() || blurred.iter().all(|(.., blur)| blur.trace() <= ROUNDING) {
            continue;
        }
        let count = motions.len();
        let spent = blurred.iter().all(|(_, state, _)| state.state == ContactState::Slip);
        // what normals block of the motions, less what facets blur, and what normal forces do along them
        let (mut blocked, mut work) = (DMatrix::zeros(count, count), DVector::zeros(count));
        for (point, state, blur) in blurred {
            let ways: Vec<Vector3<f64>> = model.ways(point, &motions).into_iter().map(Vector3::from).collect();
            let normal = Vector3::from(state.normal);
            for i in 0..count {
                work[i] += state.normal_force * normal.dot(&ways[i]);
                for j in 0..count {
                    let block = normal.dot(&ways[i]) * normal.dot(&ways[j]);
                    blocked[(i, j)] += state.area * (block - ways[i].dot(&(blur * ways[j])));
                }
            }
        }
        let load = DVector::from_iterator(count, motions.iter().map(|m| vector::dot(&m.amplitudes, &problem.rhs)));
        // what of the loads is along motions that are blurred more than blocked
        let eigen = SymmetricEigen::new(blocked);
        let mut pushed = DVector::zeros(count);
        for (value, motion) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
            if *value < 0.0 {
                pushed += motion * motion.dot(&load);
            }
        }
        let share = pushed.dot(&work) / pushed.dot(&load);
        // normal forces that do much more than the loads are held by friction
        let matters = pushed.norm() >= TILT_MATTERS * load.norm();
        // where all friction is spent the rest alone decides
        let least = if spent { TILT_MATTERS } else { HELD_BY_TILT };
        if matters && (least..1.0 + HELD_BY_TILT).contains(&share) && worst.as_ref().is_none_or(|w| share > w.0) {
            // `G lambda = e = -Rᵀ f`
            pushed.neg_mut();
            let slide = slide(model, &motions, pushed.as_slice());
            let warning = Warning::HeldByTilt {
                step,
                body: slide.body as usize,
                node: slide.node,
                mode: slide.to_string(),
                share,
            };
            worst = Some((share, warning));
        }
    }
    worst.map(|w| w.1)
}
