//! Reports of a level: how it ended, what it cost.

use crate::accuracy::AccuracyReport;
use crate::error::ContactError;
use crate::fixed_point::FixedPointReport;
use signorini_qp::Steps;
use std::fmt;

/// How the solve of a level ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum StepStatus {
    /// The solver reached the tolerance, and the certificate is at most thirty times that (usually a tenth).
    Converged,
    /// A limit of iterations or products was reached first; the result is the last iterate.
    IterationLimit,
    /// No further progress above the tolerance.
    Stagnated,
    /// The Coulomb map is not contractive here: successive approximations have no limit from this start. The result is
    /// the last iterate, which solves the given-friction problem of the last slip bounds.
    NotContractive,
    /// With the normal forces of this level friction does not hold a body: slip bounds and normal forces that agree
    /// leave no balance with the loads. The set-up judges only whether any normal forces could.
    NotHeld,
    /// The solver met its tolerance, and smaller ones, but the certificate is more than thirty times the tolerance (with an
    /// [`Accuracy`](crate::Accuracy) by estimates, above [`certificate_limit`](crate::accuracy::AccuracyReport::certificate_limit)): mostly the
    /// problem is too badly conditioned for it. The parts of the certificate name the violated condition.
    NotCertified,
}

impl StepStatus {
    /// Whether the tolerance was reached.
    #[must_use]
    pub fn converged(self) -> bool {
        self == Self::Converged
    }

    /// What to do about it; empty for a level that converged.
    #[must_use]
    pub fn remedy(self) -> &'static str {
        match self {
            Self::Converged => "",
            Self::IterationLimit => {
                "raise max_fallback_products or the limits of the method, or take smaller steps"
            }
            Self::Stagnated => "take smaller steps; with Accuracy::Relative a looser target",
            Self::NotContractive => {
                "the Coulomb problem may have no solution here: take a smaller coefficient or smaller steps"
            }
            Self::NotHeld => {
                "press the body more, take a larger coefficient, or hold it by a support"
            }
            Self::NotCertified => {
                "the parts of the certificate name the violated condition: take better shaped cells, Poisson's ratio \
                 further from 1/2, smaller steps, or Method::paper()"
            }
        }
    }
}

impl fmt::Display for StepStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Converged => "converged",
            Self::IterationLimit => "iteration limit",
            Self::Stagnated => "stagnated",
            Self::NotContractive => "not contractive",
            Self::NotHeld => "not held by friction",
            Self::NotCertified => "not certified",
        })
    }
}

/// What one level cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct Counters {
    /// Products with F, recoveries included.
    pub products: usize,
    /// Products with F spent on estimating norms, counted apart.
    pub setup_products: usize,
    /// Applications of the preconditioner.
    pub preconditionings: usize,
    /// Applications of projectors by SMALSE.
    pub projections: usize,
    /// Factorisations of the coarse problem.
    pub coarse_factorisations: usize,
    /// Quadratic programs (given-friction problems) solved by SMALSE.
    pub quadratic_programs: usize,
    /// Faces of the face method.
    pub faces: usize,
    /// Times the slip bounds were rewritten.
    pub slip_bound_updates: usize,
    /// Times slip rates were computed.
    pub rate_updates: usize,
    /// Entries into an inequality solver.
    pub inequality_solves: usize,
}

impl std::ops::AddAssign for Counters {
    fn add_assign(&mut self, o: Self) {
        self.products += o.products;
        self.setup_products += o.setup_products;
        self.preconditionings += o.preconditionings;
        self.projections += o.projections;
        self.coarse_factorisations += o.coarse_factorisations;
        self.quadratic_programs += o.quadratic_programs;
        self.faces += o.faces;
        self.slip_bound_updates += o.slip_bound_updates;
        self.rate_updates += o.rate_updates;
        self.inequality_solves += o.inequality_solves;
    }
}

/// Report of one level's solve.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct StepReport {
    /// How it ended.
    pub status: StepStatus,
    /// Outer iterations under the method's own name: auxiliary problems of the fixed-point loop, outer steps of the
    /// one inexact loop, faces of the face method.
    pub iterations: usize,
    /// What it cost.
    pub counters: Counters,
    /// Steps of KPRGP by kind, if it ran.
    pub steps: Steps,
    /// The fixed-point loop, if there was one.
    pub fixed_point: Option<FixedPointReport>,
    /// Whether the face method gave up and SMALSE finished the level.
    pub fallback: bool,
    /// Products with F that SMALSE took for that, contained in the counters.
    pub fallback_products: usize,
    /// The solver's own estimate of the relative error of the multipliers, where it has one.
    pub estimated_error: Option<f64>,
    /// Estimates of the level's errors; only with an [`Accuracy`](crate::Accuracy) that needs them.
    pub accuracy: Option<AccuracyReport>,
    /// The first earlier level that did not converge and on whose displacement this one depends, from 0: its slip is part of
    /// the history of friction, which no certificate of this level can judge. Always `None` in scenes without history (no
    /// friction, or static). The status of this level does not depend on it.
    pub unconverged_history: Option<usize>,
}

impl StepReport {
    pub(crate) fn new() -> Self {
        Self {
            status: StepStatus::IterationLimit,
            iterations: 0,
            counters: Counters::default(),
            steps: Steps::default(),
            fixed_point: None,
            fallback: false,
            fallback_products: 0,
            estimated_error: None,
            accuracy: None,
            unconverged_history: None,
        }
    }

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

    /// Takes over the outcome of a further solve of the same level, with the cost of both.
    pub(crate) fn resumed(self, mut next: Self) -> Self {
        next.counters += self.counters;
        next.iterations += self.iterations;
        next.steps += self.steps;
        next.fallback |= self.fallback;
        next.fallback_products += self.fallback_products;
        next
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
