//! The solver of a step: chooses by effect and method, owns all work memory.

use super::active_set::ActiveSetSolver;
use super::iterate::{Iterate, Task};
use super::scaling::scaled;
use super::smalse::SmalseSolver;
use crate::error::ContactError;
use crate::model::Model;
use crate::report::StepReport;
use crate::settings::{Method, Settings};
use signorini_qp::ActiveSetSettings;

/// The solvers that a scene can need; only what it needs exists.
pub(crate) enum Solver {
    /// The default, and whatever is chosen where there is no contact.
    ActiveSet(Box<ActiveSetSolver>),
    /// The paper's methods.
    Smalse(Box<SmalseSolver>),
}

/// Its name: work memory says nothing.
impl std::fmt::Debug for Solver {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::ActiveSet(_) => "ActiveSet",
            Self::Smalse(_) => "Smalse",
        })
    }
}

impl Solver {
    pub(crate) fn new(model: &Model, settings: &Settings) -> Result<Self, ContactError> {
        let active_set = match &settings.method {
            Method::ActiveSet(own) => Some(own.clone()),
            _ => model.points.is_empty().then(ActiveSetSettings::default),
        };
        Ok(match active_set {
            Some(own) => Self::ActiveSet(Box::new(ActiveSetSolver::new(model, settings, own)?)),
            None => Self::Smalse(Box::new(SmalseSolver::new(model, settings)?)),
        })
    }

    /// Without contact, has the loads [balanced](Model::balance_loads) by the rows that hold the bodies.
    pub(crate) fn balance_loads(&mut self, model: &mut Model) {
        if let Self::ActiveSet(solver) = self
            && model.points.is_empty()
        {
            solver.balance_loads(model);
        }
    }

    /// Solves a step; every body in a unit of force of its own.
    pub(crate) fn solve(&mut self, task: Task<'_>, iterate: &mut Iterate) -> Result<StepReport, ContactError> {
        let Some((problem, units)) = scaled(task.model, task.problem, iterate) else {
            return self.solve_plain(task, iterate);
        };
        let report = self.solve_plain(
            Task {
                problem: &problem,
                ..task
            },
            iterate,
        );
        units.restore(iterate);
        report
    }

    fn solve_plain(&mut self, task: Task<'_>, iterate: &mut Iterate) -> Result<StepReport, ContactError> {
        match self {
            Self::ActiveSet(solver) => solver.solve(task, iterate),
            Self::Smalse(solver) => solver.solve(usize::MAX, task, iterate),
        }
    }
}
