//! Scenes without contact: projected preconditioned conjugate gradients, no inequality anywhere.

use super::coarse::OrthonormalRows;
use super::iterate::{Iterate, Task, step_status};
use super::preconditioner::SelectedPreconditioner;
use crate::error::ContactError;
use crate::model::Model;
use crate::report::StepReport;
use crate::settings::Settings;
use crate::tolerances::LINEAR_SLACK;
use signorini_qp::{CgWorkspace, Tolerance, projected_cg};
use signorini_tfeti::{DualOperator, OrthonormalCoarse};

/// Most products of a step.
const MOST_PRODUCTS: usize = 10_000;

pub(crate) struct LinearSolver {
    rows: OrthonormalRows,
    preconditioner: SelectedPreconditioner,
    work: CgWorkspace<DualOperator, OrthonormalCoarse, SelectedPreconditioner>,
}

impl LinearSolver {
    pub(crate) fn new(model: &Model, settings: &Settings) -> Result<Self, ContactError> {
        let rows = OrthonormalRows::new(model)?;
        let preconditioner = SelectedPreconditioner::new(model, settings.preconditioner, None)?;
        let work = CgWorkspace::new(model.tfeti.dual(), &rows.coarse, &preconditioner);
        Ok(Self {
            rows,
            preconditioner,
            work,
        })
    }

    pub(crate) fn solve(&mut self, task: Task<'_>, iterate: &mut Iterate) -> Result<StepReport, ContactError> {
        self.rows.set_rhs(&task.problem.rhs);
        let tolerance = Tolerance::Error {
            factor: task.settings.tolerance * LINEAR_SLACK,
            least: task.problem.least(task.settings.tolerance)[0],
        };
        let outcome = projected_cg(
            task.model.tfeti.dual(),
            &task.problem.linear,
            &self.rows.coarse,
            &self.rows.rhs,
            &self.preconditioner,
            tolerance,
            MOST_PRODUCTS,
            &mut iterate.lambda,
            &mut self.work,
        )?;
        iterate.known = false;
        self.rows
            .amplitudes(self.work.equality_multiplier(), &mut iterate.alpha);
        let mut report = StepReport::new();
        report.status = step_status(outcome.status);
        report.iterations = outcome.iterations;
        report.counters.products = outcome.products;
        report.counters.preconditionings = outcome.preconditionings;
        Ok(report)
    }
}
