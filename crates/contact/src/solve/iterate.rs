//! What solvers take and give.

use crate::model::Model;
use crate::scene::Friction;
use crate::settings::Settings;
use crate::status::StepStatus;
use crate::step::StepProblem;
use signorini_qp::Status;

/// What is to be solved, and how.
#[derive(Clone, Copy)]
pub(crate) struct Task<'a> {
    pub(crate) model: &'a Model,
    pub(crate) problem: &'a StepProblem,
    pub(crate) settings: &'a Settings,
}

/// Iterate of a step in and out of a solver.
#[derive(Debug, Default, Clone)]
pub(crate) struct Iterate {
    /// Multipliers.
    pub(crate) lambda: Vec<f64>,
    /// `F lambda`, if known.
    pub(crate) f_lambda: Vec<f64>,
    /// Whether `f_lambda` is `F lambda`.
    pub(crate) known: bool,
    /// Contact rows for which `f_lambda` holds where `lambda` has others; empty if they agree.
    pub(crate) known_rows: Vec<f64>,
    /// Multiplier of the orthonormal coarse equality, for SMALSE.
    pub(crate) multiplier: Vec<f64>,
    /// Rigid amplitudes `alpha` of (5.27), set by the solver; empty until then.
    pub(crate) alpha: Vec<f64>,
    /// Products beyond those of easy solves, over all steps so far: where they are many, F is formed.
    pub(crate) effort: usize,
    /// Which attempt at the step its start is for.
    pub(crate) attempt: Attempt,
    /// Whether interior points have found a point in this attempt: once it may be given as the solution.
    pub(crate) offered: bool,
    /// The shortest step of conjugate gradients in the last solve with contact, in the end in this one; 0 if there was
    /// none.
    pub(crate) shortest_step: f64,
}

/// Attempts at a step, one after another as long as it is lost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Attempt {
    /// What stands, where nothing has changed: nothing is solved, and the certificate tells.
    Rest,
    /// With all contacts open.
    Apart,
    /// By active sets as long as they make progress: that nothing touches is looked at before more is done.
    Brief,
    /// By active sets alone: there is another start.
    First,
    /// From that start, or the only one, by active sets and then by the paper's method.
    #[default]
    Whole,
}

/// Status of a step from the status of a quadratic program.
pub(crate) fn step_status(status: Status) -> StepStatus {
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
