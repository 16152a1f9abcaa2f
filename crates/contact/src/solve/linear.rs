//! Scenes without contact: projected preconditioned conjugate gradients, no inequality anywhere.

use super::coarse::orthonormal_coarse;
use super::iterate::{Iterate, level_status};
use super::preconditioner::SelectedPreconditioner;
use crate::error::ContactError;
use crate::model::Model;
use crate::report::StepReport;
use crate::settings::Settings;
use crate::step::StepProblem;
use signorini_qp::{CgWorkspace, Tolerance, projected_cg};
use signorini_tfeti::{CoarseScratch, DualOperator, OrthonormalCoarse};

/// Estimated error of the multipliers, over the tolerance of a level, at which conjugate gradients stop: no condition but continuity
/// is left to them, and what copies differ by, over the largest displacement, is a thirtieth of that error and less. The certificate tells
/// where it is not.
const SLACK: f64 = 30.0;

pub(crate) struct LinearSolver {
    coarse: OrthonormalCoarse,
    coarse_scratch: CoarseScratch,
    preconditioner: SelectedPreconditioner,
    rhs: Vec<f64>,
    work: CgWorkspace<DualOperator, OrthonormalCoarse, SelectedPreconditioner>,
}

impl std::fmt::Debug for LinearSolver {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("LinearSolver").finish_non_exhaustive()
    }
}

impl LinearSolver {
    pub(crate) fn new(model: &Model, settings: &Settings) -> Result<Self, ContactError> {
        let factor = model.tfeti.coarse_factor();
        let coarse = orthonormal_coarse(model)?;
        let preconditioner = SelectedPreconditioner::new(model, settings.preconditioner)?;
        Ok(Self {
            coarse_scratch: factor.scratch(),
            rhs: vec![0.0; model.tfeti.coarse().rows()],
            work: CgWorkspace::new(model.tfeti.dual(), &coarse, &preconditioner),
            coarse,
            preconditioner,
        })
    }

    pub(crate) fn solve(
        &mut self,
        model: &Model,
        level: &StepProblem,
        settings: &Settings,
        iterate: &mut Iterate,
    ) -> Result<StepReport, ContactError> {
        self.coarse
            .rhs(&level.rhs, &mut self.rhs, &mut self.coarse_scratch);
        let outcome = projected_cg(
            model.tfeti.dual(),
            &level.linear,
            &self.coarse,
            &self.rhs,
            &self.preconditioner,
            Tolerance::Error {
                factor: settings.tolerance * SLACK,
                least: level.least()[0],
            },
            10_000,
            &mut iterate.lambda,
            &mut self.work,
        )?;
        let mut report = StepReport::new();
        report.status = level_status(outcome.status);
        report.iterations = outcome.iterations;
        report.counters.products = outcome.products;
        report.counters.preconditionings = outcome.preconditionings;
        iterate.known = false;
        iterate.alpha.resize(level.rhs.len(), 0.0);
        self.coarse.amplitudes(
            self.work.equality_multiplier(),
            &mut iterate.alpha,
            &mut self.coarse_scratch,
        );
        Ok(report)
    }
}
