//! How a step ended.

use std::fmt;

/// How the solve of a step ended.
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
    /// the last iterate, which solves the Tresca problem of the last slip bounds.
    NotContractive,
    /// With the normal forces of this step friction does not hold a body: slip bounds and normal forces that agree
    /// leave no balance with the loads. The set-up judges only whether any normal forces could.
    NotHeld,
    /// The solver met its tolerance, and smaller ones, but the certificate is more than thirty times the tolerance
    /// (with an [`Accuracy`](crate::Accuracy) by estimates, above
    /// [`certificate_limit`](crate::report::AccuracyReport::certificate_limit)): mostly the problem is too badly
    /// conditioned for it. The parts of the certificate name the violated condition.
    NotCertified,
}

impl StepStatus {
    /// Whether the tolerance was reached.
    #[must_use]
    pub fn converged(self) -> bool {
        self == Self::Converged
    }

    /// What to do about it; empty for a step that converged.
    pub fn remedy(self) -> &'static str {
        match self {
            Self::Converged => "",
            Self::IterationLimit => "raise max_fallback_products or the limits of the method, or take smaller steps",
            Self::Stagnated => "take smaller steps; with Accuracy::Relative a looser target",
            Self::NotContractive => {
                "the Coulomb problem may have no solution here: take a smaller coefficient or smaller steps"
            }
            Self::NotHeld => "press the body more, take a larger coefficient, or hold it by a support",
            Self::NotCertified => {
                "take better shaped cells, Poisson's ratio further from 1/2, smaller steps, or Method::paper()"
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

/// A step that did not converge.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct StepFailure {
    /// The step, from 0.
    pub step: usize,
    /// Its time, s.
    pub time: f64,
    /// How it ended.
    pub status: StepStatus,
    /// The largest relative violation of its certificate.
    pub certificate: f64,
    /// The condition of the certificate that is violated so.
    pub condition: &'static str,
}

impl fmt::Display for StepFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            step,
            time,
            status,
            certificate,
            condition,
        } = self;
        write!(
            f,
            "step {step}, at {time} s, did not converge ({status}, certificate {certificate:.1e}, {condition}); {}",
            status.remedy()
        )
    }
}
