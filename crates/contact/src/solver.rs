//! The solver of a level: chooses by effect and method, owns all work memory.

use crate::error::ContactError;
use crate::face_solver::ActiveSetSolver;
use crate::law::Friction;
use crate::level::StepProblem;
use crate::linear_solver::LinearSolver;
use crate::model::Model;
use crate::paper_solver::SmalseSolver;
use crate::report::{StepReport, StepStatus};
use crate::settings::{Method, Settings};
use signorini_qp::Status;

/// Iterate of a level in and out of a solver.
#[derive(Debug, Default)]
pub(crate) struct Iterate {
    /// Multipliers.
    pub(crate) lambda: Vec<f64>,
    /// `F lambda`, if known.
    pub(crate) f_lambda: Vec<f64>,
    /// Whether `f_lambda` is `F lambda`.
    pub(crate) known: bool,
    /// Multiplier of the orthonormal coarse equality, for SMALSE.
    pub(crate) multiplier: Vec<f64>,
    /// Rigid amplitudes `alpha` of (5.27), set by the solver.
    pub(crate) alpha: Vec<f64>,
}

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

    /// Solves a level; every body in a unit of force of its own (see [`Bodies`](crate::bodies::Bodies)).
    pub(crate) fn solve(
        &mut self,
        model: &Model,
        level: &StepProblem,
        settings: &Settings,
        iterate: &mut Iterate,
    ) -> Result<StepReport, ContactError> {
        let Some((level, units)) = model.bodies.scaled(model, level, iterate) else {
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

/// Status of a level from the status of a quadratic program.
pub(crate) fn level_status(status: Status) -> StepStatus {
    match status {
        Status::Converged => StepStatus::Converged,
        Status::Infeasible => StepStatus::NotHeld,
        Status::Stagnated => StepStatus::Stagnated,
        _ => StepStatus::IterationLimit,
    }
}

/// Whether slip bounds follow the normal forces.
pub(crate) fn is_coulomb(model: &Model) -> bool {
    model.any_law(|law| matches!(law, Friction::Coulomb(_)))
}
