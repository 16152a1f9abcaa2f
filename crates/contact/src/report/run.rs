//! What a run did, and steps that failed.

use super::counters::Counters;
use super::step::StepReport;
use crate::error::ContactError;
use crate::status::StepStatus;

impl StepReport {
    /// An error unless this level and its history converged.
    pub(crate) fn require(
        &self,
        level: usize,
        time: f64,
        certificate: f64,
    ) -> Result<(), ContactError> {
        StepFailure::of(self, level, time, certificate).map_or(Ok(()), |f| Err(f.error()))?;
        inherited(self.unconverged_history)
    }
}

fn inherited(level: Option<usize>) -> Result<(), ContactError> {
    level.map_or(Ok(()), |level| {
        Err(ContactError::UnconvergedHistory { level })
    })
}

/// A level that did not converge.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct StepFailure {
    /// The level, from 0.
    pub level: usize,
    /// Its time, s.
    pub time: f64,
    /// How it ended.
    pub status: StepStatus,
    /// The largest relative violation of its certificate.
    pub certificate: f64,
}

impl StepFailure {
    /// `None` for a level that converged.
    pub(crate) fn of(
        report: &StepReport,
        level: usize,
        time: f64,
        certificate: f64,
    ) -> Option<Self> {
        (!report.status.converged()).then_some(Self {
            level,
            time,
            status: report.status,
            certificate,
        })
    }

    /// As an error.
    #[must_use]
    pub fn error(&self) -> ContactError {
        ContactError::NotConverged {
            level: self.level,
            time: self.time,
            status: self.status,
            certificate: self.certificate,
        }
    }
}

/// What [`Simulation::run`](crate::Simulation::run) did. Not converging is no error of a run: who needs every level to converge asks
/// [`require_converged`](Self::require_converged).
///
/// ```
/// use signorini_contact::{ContactError, Scene, Settings, Silent, Simulation};
///
/// fn strict(scene: Scene) -> Result<Simulation, ContactError> {
///     let mut simulation = Simulation::new(scene, Settings::default())?;
///     simulation.run(&mut Silent)?.require_converged()?;
///     Ok(simulation)
/// }
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
#[must_use = "levels may not have converged: see `first_failure`, or ask `require_converged`"]
pub struct RunReport {
    /// Levels solved.
    pub levels: usize,
    /// Levels that did not converge, in order.
    pub failures: Vec<StepFailure>,
    /// The first level before this run that did not converge and on whose displacement its levels depend, see
    /// [`State::unconverged_history`](crate::State::unconverged_history).
    pub unconverged_history: Option<usize>,
    /// What the run cost.
    pub counters: Counters,
    /// The largest certificate of all its levels.
    pub largest_certificate: f64,
}

impl RunReport {
    /// Takes a level into account.
    pub(crate) fn enter(&mut self, report: &StepReport, level: usize, time: f64, certificate: f64) {
        self.levels += 1;
        self.counters += report.counters;
        if certificate.is_nan() || certificate > self.largest_certificate {
            self.largest_certificate = certificate;
        }
        self.failures
            .extend(StepFailure::of(report, level, time, certificate));
    }

    /// Whether all levels converged, and those before on whose displacement they depend.
    #[must_use]
    pub fn converged(&self) -> bool {
        self.failures.is_empty() && self.unconverged_history.is_none()
    }

    /// The first level of this run that did not converge.
    #[must_use]
    pub fn first_failure(&self) -> Option<&StepFailure> {
        self.failures.first()
    }

    /// For those who want every level to converge: an error unless [all did](Self::converged).
    ///
    /// # Errors
    /// [`ContactError::UnconvergedHistory`] and [`ContactError::NotConverged`]: level, status and remedy of the first one.
    pub fn require_converged(&self) -> Result<(), ContactError> {
        inherited(self.unconverged_history)?;
        match self.first_failure() {
            Some(failure) => Err(failure.error()),
            None => Ok(()),
        }
    }
}
