//! Sums over the contact points at the end of a step.

use super::points::{ContactState, PointState};
use super::recovered::Recovered;
use crate::error::ContactError;
use crate::model::Model;
use crate::step::{StepProblem, entry_or_zero};
use signorini_fem_mesh::vec3::sub;

/// Sums over the contact points at the end of a step: of [all](crate::StepResult::summary) contacts, or of
/// [one](crate::StepResult::summary_of). Tied contacts have none. Between bodies, forces act on the body named first
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
    /// Sum of their [areas](crate::PointState::area), m².
    pub area: f64,
    /// Largest normal force over area of a point, Pa; on unequal triangles some per cent off the smooth
    /// [pressure](crate::StepResult::contact_pressure).
    pub max_pressure: f64,
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

/// Sums over all points, then, of several contacts, those of each; `before` are the tangential displacements at the
/// step before.
pub(crate) fn summarise(
    model: &Model,
    problem: &StepProblem,
    recovered: &Recovered,
    lambda: &[f64],
    before: &[f64],
) -> Result<Vec<ContactSummary>, ContactError> {
    let contacts = model.scene.contacts.len();
    let mut sums = vec![ContactSummary::default(); if contacts > 1 { 1 + contacts } else { 1 }];
    let start = model.tangential_rows().start;
    for (point, touch) in recovered.points.iter().zip(model.points.iter()) {
        let active = point.state != ContactState::Open;
        let moved = match [0, 1].map(|ago| problem.obstacles[ago].get(touch.surface())) {
            [Some(now), Some(old)] => {
                let [now, old] = [now, old].map(|pose| pose.drag(&touch.contact.centre));
                let gap = |ago| if active { problem.gap(&model.scene, touch, ago) } else { Ok(0.0) };
                Some((sub(now, old), gap(0)? - gap(1)?))
            }
            _ => None,
        };
        let (all, own) = sums.split_at_mut(1);
        // one after the other: each sum has the order of its points
        for s in all.iter_mut().chain(own.get_mut(point.surface)) {
            s.add(point, active, touch.contact.sides.sign(), moved);
            for along in touch.along() {
                let old = entry_or_zero(before, along.row - start);
                let new = problem.relative(touch, along, recovered.rows[along.row]);
                s.friction_work -= along.scale * lambda[along.row] * (new - old);
            }
        }
    }
    for s in &mut sums {
        s.stick = s.active - s.slip;
        s.normal_norm = s.normal_norm.sqrt();
        s.friction_norm = s.friction_norm.sqrt();
    }
    Ok(sums)
}

impl ContactSummary {
    /// Adds all of a point but the work of friction. `sign` is that of its forces in resultants; `moved` the way of its
    /// obstacle in this step and the change of its gap.
    fn add(&mut self, point: &PointState, active: bool, sign: f64, moved: Option<([f64; 3], f64)>) {
        self.active += usize::from(active);
        self.slip += usize::from(point.state == ContactState::Slip);
        self.normal_force -= point.normal_force;
        self.normal_norm += point.normal_force.powi(2);
        let force = point.force();
        for c in 0..3 {
            self.friction_force[c] += sign * point.friction_force[c];
            self.resultant[c] += sign * force[c];
            self.friction_norm += point.friction_force[c].powi(2);
            self.dissipation -= point.friction_force[c] * point.difference[c];
        }
        if active {
            self.area += point.area;
            self.max_slip_rate = self.max_slip_rate.max(point.slip_rate);
            if point.area > 0.0 {
                self.max_pressure = self.max_pressure.max(-point.normal_force / point.area);
            }
        }
        self.max_penetration = self.max_penetration.max(-point.gap);
        if let Some((way, gap)) = moved {
            for c in 0..3 {
                self.obstacle_work += force[c] * way[c];
            }
            if active {
                self.obstacle_work += point.normal_force * gap;
            }
        }
    }
}
