//! How a step was solved.

use super::counters::Counters;
use super::errors::AccuracyReport;
use crate::status::{Slide, StepStatus};
use signorini_qp::{FixedPointReport, Steps};

/// Report of one step's solve.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct StepReport {
    /// How it ended.
    pub status: StepStatus,
    /// Outer iterations under the method's own name: auxiliary problems of the fixed-point loop, outer steps of the
    /// one inexact loop, active sets of the active-set method; steps of conjugate gradients without contact.
    pub iterations: usize,
    /// Its cost.
    pub counters: Counters,
    /// Steps of KPRGP by kind, if it ran.
    pub steps: Steps,
    /// The fixed-point loop, if there was one.
    pub fixed_point: Option<FixedPointReport>,
    /// Whether the active-set method failed and SMALSE finished the step.
    pub fallback: bool,
    /// Products with F that SMALSE took for that, included in the counters.
    pub fallback_products: usize,
    /// Which body slides away, if friction [does not hold](StepStatus::NotHeld) it; where no balance was found what
    /// may, if nothing is violated more than equilibrium.
    pub slide: Option<Slide>,
    /// Estimates of the step's errors; only with an [`Accuracy`](crate::Accuracy) that needs them.
    pub accuracy: Option<AccuracyReport>,
    /// The first earlier step, from 0, that did not converge and on whose displacement this one depends: its slip is
    /// part of the history, which the certificate of this step cannot judge. `None` in scenes without history (see
    /// [`State::unconverged_history`](crate::State::unconverged_history)). The status of this step does not depend on
    /// it.
    pub unconverged_history: Option<usize>,
}

impl StepReport {
    /// Takes over the outcome of a further solve of the same step, with the cost of both.
    pub(crate) fn resumed(self, mut next: Self) -> Self {
        next.counters += self.counters;
        next.iterations += self.iterations;
        next.steps += self.steps;
        next.fallback |= self.fallback;
        next.fallback_products += self.fallback_products;
        next
    }
}
