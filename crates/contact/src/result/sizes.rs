//! What violations are measured against: sizes of each body at the end of a step.

use crate::model::Model;
use crate::state::Peak;
use crate::step::{StepProblem, force_rounding};
use crate::tolerances::{LEAST_TOLERANCE, REST, SMALL_FORCE};
use signorini_qp::vector;
use signorini_tfeti::internal::RIGID;

/// Multipliers of a step and what is recovered from them.
pub(super) struct Measured<'a> {
    pub(super) model: &'a Model,
    pub(super) problem: &'a StepProblem,
    /// Of the settings.
    pub(super) tolerance: f64,
    pub(super) lambda: &'a [f64],
    /// `B u`, and what springs and contact give way, in row units.
    pub(super) rows: &'a [f64],
    /// Torn displacement.
    pub(super) u: &'a [f64],
    /// `K u - f - Bᵀ lambda`, N; of several processes that of the subdomains of this one.
    pub(super) residual: &'a [f64],
}

/// What the violations of one body are measured against.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Sizes {
    /// Displacement, m.
    pub(super) displacement: f64,
    /// Contact force at a node, N.
    pub(super) contact_force: f64,
    /// Norm of the loads and of the contact forces, then of all multipliers, too, N.
    pub(super) forces: f64,
    /// Norm of the multipliers, N.
    multipliers: f64,
    /// Norm of the residual of the equilibrium, N.
    pub(super) residual: f64,
    /// Norm of the displacements times the stiffness of their nodes, N.
    stiff: f64,
}

impl Sizes {
    /// What later steps of the body remember.
    pub(crate) fn peak(&self) -> Peak {
        Peak {
            multipliers: self.multipliers,
            force: self.contact_force,
            displacement: self.displacement,
        }
    }
}

/// Sizes of every body.
pub(super) fn sizes(m: &Measured<'_>) -> Vec<Sizes> {
    let (model, lambda) = (m.model, m.lambda);
    let bodies = &model.bodies;
    let mut out = vec![Sizes::default(); bodies.count().max(1)];
    // where nothing moves, what its load would do to a single node is the scale
    let copies = model.tfeti.all_copy_stiffness();
    let of_subdomains = model.tfeti.of_subdomains(|subdomain| {
        let range = model.tfeti.torn_range(subdomain);
        let (u, residual) = (&m.u[range.clone()], &m.residual[range.clone()]);
        let force = m.problem.forces_on(model, subdomain);
        let (mut displacement, mut stiff) = (vector::max_abs(u), 0.0);
        let nodes = force.chunks_exact(3).zip(u.chunks_exact(3));
        for ((f, u), copy) in nodes.zip(range.start / 3..) {
            let stiffness = copies.weight(copy);
            // a rigid copy by the others of its node
            let (elastic, counts) = if subdomain < model.discrete.couplings.first {
                (stiffness, stiffness)
            } else {
                (stiffness / RIGID, 0.0)
            };
            displacement = displacement.max(vector::max_abs(f) / elastic);
            stiff += counts * counts * vector::dot(u, u);
        }
        let [residual, force] = [residual, &force].map(|v| vector::dot(v, v));
        [displacement, stiff, residual, force]
    });
    for (subdomain, [displacement, stiff, residual, force]) in of_subdomains.into_iter().enumerate() {
        let own = &mut out[bodies.of_subdomain(subdomain)];
        own.displacement = own.displacement.max(displacement);
        own.stiff += stiff;
        own.residual += residual;
        own.forces += force;
    }
    for point in model.points.iter() {
        let mut sum = (point.scale * lambda[point.row]).powi(2);
        if let Some((row, count, scale)) = point.tangential_rows() {
            let rows = lambda[row..row + count].iter();
            sum += rows.map(|v| (scale * v).powi(2)).sum::<f64>();
        }
        let own = &mut out[bodies.of_row(point.row)];
        own.contact_force = own.contact_force.max(sum.sqrt());
        own.forces += sum;
    }
    // gluing forces and reactions: what displacements alone cause has no loads
    let contact = model.contact_rows().end;
    let mut inner = vec![0.0; out.len()];
    bodies.add_squares(lambda, contact..lambda.len(), &mut inner);
    let mut all = inner.clone();
    bodies.add_squares(lambda, 0..contact, &mut all);
    for (body, own) in out.iter_mut().enumerate() {
        let peak = m.problem.peaks.get(body).copied().unwrap_or_default();
        own.multipliers = all[body].sqrt();
        own.residual = own.residual.sqrt();
        own.displacement = own.displacement.max(REST * peak.displacement);
        // likewise where no force acts, or next to none on the contact surface
        // and where displacements leave nothing of a force but rounding errors
        let rounding = force_rounding(m.tolerance.max(LEAST_TOLERANCE)) * own.stiff.sqrt();
        let outer = own.forces.sqrt().max(REST * peak.multipliers).max(rounding);
        own.contact_force = own
            .contact_force
            .max(REST * peak.force)
            .max(rounding)
            .max(SMALL_FORCE * outer);
        own.forces = outer.hypot(inner[body].sqrt());
    }
    out
}
