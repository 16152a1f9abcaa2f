//! What solvers take and give.

use crate::model::Model;
use crate::scene::Friction;
use crate::status::StepStatus;
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

/// Status of a level from the status of a quadratic program.
pub(crate) fn level_status(status: Status) -> StepStatus {
    match status {
        Status::Converged => StepStatus::Converged,
        Status::Infeasible => StepStatus::NotHeld,
        Status::Stagnated | Status::Stopped => StepStatus::Stagnated,
        _ => StepStatus::IterationLimit,
    }
}

/// Whether slip bounds follow the normal forces.
pub(crate) fn is_coulomb(model: &Model) -> bool {
    model.any_law(|law| matches!(law, Friction::Coulomb(_)))
}
