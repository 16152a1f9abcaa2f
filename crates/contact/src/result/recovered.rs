//! What follows from the multipliers of a step.

use super::certificate::Certificate;
use super::certify::certify;
use super::points::{PointState, point_states};
use super::sizes::{Measured, Sizes, sizes};
use crate::error::ContactError;
use crate::model::Model;
use crate::step::StepProblem;
use signorini_qp::vector;
use signorini_tfeti::internal::of_length;

/// Displacement, states of points, and how well all conditions hold.
#[derive(Debug, Clone, Default)]
pub(crate) struct Recovered {
    /// Displacement of every subdomain, one after another, m.
    pub(crate) torn: Vec<f64>,
    /// `B u` of it, and what springs and contact give way, in row units.
    pub(crate) rows: Vec<f64>,
    /// What they give way of it; empty where nothing does.
    pub(crate) gives_way: Vec<f64>,
    /// `K u - f - Bᵀ lambda`, torn, N; of several processes that of the subdomains of this one.
    pub(crate) residual: Vec<f64>,
    /// Sizes of the bodies.
    pub(crate) sizes: Vec<Sizes>,
    pub(crate) certificate: Certificate,
    pub(crate) points: Vec<PointState>,
    /// Multipliers of the last rows: those behind contact and gluing.
    last_multipliers: Vec<f64>,
}

impl Recovered {
    /// From multipliers and rigid amplitudes, found to the tolerance of the settings, in the memory of an `old` one;
    /// one product with F.
    pub(crate) fn new(
        (model, problem): (&Model, &StepProblem),
        tolerance: f64,
        [lambda, alpha]: [&[f64]; 2],
        old: Self,
    ) -> Result<Self, ContactError> {
        let tfeti = &model.tfeti;
        let force = problem.forces_here(old.residual, model);
        let [torn, residual] = tfeti.recover([old.torn, force], lambda, alpha)?;
        let mut rows = of_length(old.rows, tfeti.dual_dim());
        tfeti.rows_times(&torn, &mut rows);
        let mut gives_way = Vec::new();
        if tfeti.gluing().is_compliant() {
            gives_way.resize(rows.len(), 0.0);
            tfeti.gluing().add_compliance(lambda, &mut gives_way);
            vector::axpy(1.0, &gives_way, &mut rows);
        }
        let measured = Measured {
            model,
            problem,
            tolerance,
            lambda,
            rows: &rows,
            u: &torn,
            residual: &residual,
        };
        let sizes = sizes(&measured);
        Ok(Self {
            certificate: certify(&measured, &sizes),
            points: point_states(model, problem, lambda, (&rows, &gives_way)),
            last_multipliers: lambda[tfeti.gluing().ranges().interface.end..].to_vec(),
            sizes,
            torn,
            rows,
            gives_way,
            residual,
        })
    }

    /// The multiplier of a row of ties, equations, couplings or supports.
    pub(super) fn multiplier(&self, row: usize) -> f64 {
        self.last_multipliers[row + self.last_multipliers.len() - self.rows.len()]
    }
}
