//! The solver of a level: chooses by effect and method, owns all work memory.

use super::active_set::ActiveSetSolver;
use super::iterate::Iterate;
use super::linear::LinearSolver;
use super::scaling::scaled;
use super::smalse::SmalseSolver;
use crate::error::ContactError;
use crate::model::Model;
use crate::report::StepReport;
use crate::settings::{Method, Settings};
use crate::step::StepProblem;

/// The solvers that a scene can need; only what it needs exists.
#[derive(Debug)]
pub(crate) enum Solver {
    /// No contact: projected conjugate gradients.
    Linear(Box<LinearSolver>),
    /// The default.
    ActiveSet(Box<ActiveSetSolver>),
    /// The paper's methods.
    Paper(Box<SmalseSolver>),
}

impl Solver {
    pub(crate) fn new(model: &Model, settings: &Settings) -> Result<Self, ContactError> {
        if model.points.is_empty() {
            return Ok(Self::Linear(Box::new(LinearSolver::new(model, settings)?)));
        }
        Ok(match &settings.method {
            Method::ActiveSet(face) => {
                Self::ActiveSet(Box::new(ActiveSetSolver::new(model, settings, face)?))
            }
            Method::SuccessiveApproximations { .. } | Method::OneLoop { .. } => {
                Self::Paper(Box::new(SmalseSolver::new(model, settings)?))
            }
        })
    }

    /// Solves a level; every body in a unit of force of its own .
    pub(crate) fn solve(
        &mut self,
        model: &Model,
        level: &StepProblem,
        settings: &Settings,
        iterate: &mut Iterate,
    ) -> Result<StepReport, ContactError> {
        let Some((level, units)) = scaled(model, level, iterate) else {
            return self.solve_plain(model, level, settings, iterate);
        };
        let report = self.solve_plain(model, &level, settings, iterate);
        units.restore(iterate);
        report
    }

    fn solve_plain(
        &mut self,
        model: &Model,
        level: &StepProblem,
        settings: &Settings,
        iterate: &mut Iterate,
    ) -> Result<StepReport, ContactError> {
        match self {
            Self::Linear(solver) => solver.solve(model, level, settings, iterate),
            Self::ActiveSet(solver) => solver.solve(model, level, settings, iterate),
            Self::Paper(solver) => solver.solve(model, level, settings, iterate),
        }
    }
}
