//! Sums over the contact points at the end of a step.

use super::points::ContactState;
use super::recovered::Recovered;
use crate::error::ContactError;
use crate::model::Model;
use crate::step::{StepProblem, entry_or_zero};

/// Sums over all contact points at the end of a step. Between bodies, forces act on the body named first
/// ([`Contact::between`](crate::Contact::between)).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct ContactSummary {
    /// Points with a normal force.
    pub active: usize,
    /// Active points that stick.
    pub stick: usize,
    /// Active points that slide.
    pub slip: usize,
    /// Sum of the normal pressing forces, N.
    pub normal_force: f64,
    /// Sum of all contact forces on the body as a vector, N.
    pub resultant: [f64; 3],
    /// Sum of the friction forces on the body, N, in space.
    pub friction_force: [f64; 3],
    /// Euclidean norm of the nodal normal forces, N.
    pub normal_norm: f64,
    /// Euclidean norm of the nodal friction forces, N.
    pub friction_norm: f64,
    /// Largest [slip rate](crate::PointState::slip_rate) of active points, m/s.
    pub max_slip_rate: f64,
    /// Largest penetration, m.
    pub max_penetration: f64,
    /// Work done against friction by the displacement increments of this step (relative to the obstacle), J. With the
    /// paper's formula it can be slightly negative at points that stick after sliding, see
    /// [`DifferenceFormula`](crate::DifferenceFormula). To first order in the length of the step: n equal steps of one
    /// that grows in proportion have (n + 1) / n of its work.
    pub friction_work: f64,
    /// Friction force times the tangential difference of (2.9), J; never negative beyond the certificate. Equal to
    /// `friction_work` for backward Euler.
    pub dissipation: f64,
    /// Work done by moving obstacles on the body in this step, J, to first order in its length: contact forces at its
    /// end times the displacement of the obstacle, and normal forces times the change of a [gap that moves with
    /// it](crate::Contact::with_motion) or [has a history](crate::Contact::with_gap_history).
    pub obstacle_work: f64,
}

/// Sums over the points; `before` are the tangential displacements at the step before.
pub(crate) fn summarise(
    model: &Model,
    problem: &StepProblem,
    recovered: &Recovered,
    lambda: &[f64],
    before: &[f64],
) -> Result<ContactSummary, ContactError> {
    let mut s = ContactSummary::default();
    let start = model.tangential_rows().start;
    for (point, touch) in recovered.points.iter().zip(model.points.iter()) {
        let active = point.state != ContactState::Open;
        s.active += usize::from(active);
        s.slip += usize::from(point.state == ContactState::Slip);
        s.normal_force -= point.normal_force;
        s.normal_norm += point.normal_force.powi(2);
        let force = point.force();
        let sign = touch.contact.sides.sign();
        for c in 0..3 {
            s.friction_force[c] += sign * point.friction_force[c];
            s.resultant[c] += sign * force[c];
            s.friction_norm += point.friction_force[c].powi(2);
            s.dissipation -= point.friction_force[c] * point.difference[c];
        }
        if active {
            s.max_slip_rate = s.max_slip_rate.max(point.slip_rate);
        }
        s.max_penetration = s.max_penetration.max(-point.gap);
        for along in touch.along() {
            let old = entry_or_zero(before, along.row - start);
            let new = problem.relative(touch, along, recovered.rows[along.row]);
            s.friction_work -= along.scale * lambda[along.row] * (new - old);
        }
        if let (Some(now), Some(old)) = (
            problem.obstacles[0].get(touch.surface()),
            problem.obstacles[1].get(touch.surface()),
        ) {
            let [now, old] = [now, old].map(|pose| pose.drag(&touch.contact.centre));
            for c in 0..3 {
                s.obstacle_work += force[c] * (now[c] - old[c]);
            }
            if active {
                let gap = |ago| problem.gap(&model.scene, touch, ago);
                s.obstacle_work += point.normal_force * (gap(0)? - gap(1)?);
            }
        }
    }
    s.stick = s.active - s.slip;
    s.normal_norm = s.normal_norm.sqrt();
    s.friction_norm = s.friction_norm.sqrt();
    Ok(s)
}
