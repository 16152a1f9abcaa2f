//! What a run did.

use super::counters::Counters;
use super::step::StepReport;
use super::warning::Warning;
use crate::error::ContactError;
use crate::names::Names;
use crate::status::StepFailure;

/// The report of [`Simulation::run`](crate::Simulation::run). Steps that do not converge are no error of a run; to
/// require convergence, call [`require_converged`](Self::require_converged).
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
#[must_use = "steps may not have converged: see `failures`, or ask `require_converged`"]
pub struct RunReport {
    /// Steps solved.
    pub steps: usize,
    /// Whether the observer stopped it before the last step.
    pub stopped: bool,
    /// Steps that did not converge, in order.
    pub failures: Vec<StepFailure>,
    /// The first step before this run that did not converge and on whose displacement its steps depend, see
    /// [`State::unconverged_history`](crate::State::unconverged_history).
    pub unconverged_history: Option<usize>,
    /// Cost of the run.
    pub counters: Counters,
    /// The largest certificate of all its steps.
    pub largest_certificate: f64,
    /// Estimated error of the mesh at the last step, relative in the energy norm
    /// ([`DiscretisationError::relative`](signorini_fem_mesh::recovery::DiscretisationError::relative)). `None` if
    /// no step was solved, or if bodies are at rest or move rigidly.
    pub mesh_error: Option<f64>,
    pub(crate) warnings: Vec<Warning>,
    pub(crate) names: Names,
}

impl RunReport {
    /// Takes a step into account.
    pub(crate) fn enter(&mut self, report: &StepReport, failure: Option<StepFailure>, certificate: f64) {
        self.steps += 1;
        self.counters += report.counters;
        if certificate.is_nan() || certificate > self.largest_certificate {
            self.largest_certificate = certificate;
        }
        self.failures.extend(failure);
    }

    /// Warnings about scene and results, each kind once, where it first occurred.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// Whether all steps converged, and the earlier ones on whose displacement they depend.
    #[must_use]
    pub fn converged(&self) -> bool {
        self.failures.is_empty() && self.unconverged_history.is_none()
    }

    /// An error unless [all steps converged](Self::converged).
    ///
    /// # Errors
    /// [`ContactError::UnconvergedHistory`] and [`ContactError::NotConverged`]: step, status and remedy of the first
    /// one.
    pub fn require_converged(&self) -> Result<(), ContactError> {
        let required =
            require(None, self.unconverged_history).and_then(|()| require(self.failures.first().copied(), None));
        required.map_err(|error| self.names.tell(error))
    }
}

/// An error for a step that failed, or an earlier one on whose displacement it depends.
pub(crate) fn require(failure: Option<StepFailure>, history: Option<usize>) -> Result<(), ContactError> {
    match (failure, history) {
        (Some(failure), _) => Err(ContactError::NotConverged(Box::new(failure))),
        (None, Some(step)) => Err(ContactError::UnconvergedHistory { step }),
        (None, None) => Ok(()),
    }
}
