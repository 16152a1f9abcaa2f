//! What chooses the tolerance of the next step by estimates of its error.

use crate::report::AccumulatedError;
use crate::tolerances::{CHANGED, CONTACT_LIMIT, CONTACT_LIMITS, EXACT_MESH, LOOSEST, MARGIN, TIGHTENING, TIGHTEST};

/// An estimate of the discretisation error.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Discretisation {
    /// Relative to the displacement, in the energy norm.
    pub(crate) relative: f64,
    /// The step it belongs to, and the energy that it is relative to.
    pub(crate) step: usize,
    pub(crate) scale: f64,
}

impl Discretisation {
    /// Whether it will do for another step.
    pub(crate) fn holds(&self, step: usize, scale: f64) -> bool {
        let range = self.scale / CHANGED..=self.scale * CHANGED;
        self.scale > 0.0 && range.contains(&scale) && step.abs_diff(self.step) < EVERY
    }

    /// The algebraic error that is this fraction of it.
    pub(crate) fn target(&self, fraction: f64) -> f64 {
        fraction * self.relative.max(EXACT_MESH)
    }
}

/// Largest relative violation of the contact conditions that goes with a target.
pub(crate) fn certificate_limit(target: f64) -> f64 {
    let [least, most] = CONTACT_LIMITS;
    (CONTACT_LIMIT * target).clamp(least, most)
}

/// Steps after which the discretisation error is estimated again.
const EVERY: usize = 8;

/// Chooses the tolerances of the solves, and remembers the errors of the steps so far.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Controller {
    tolerance: f64,
    /// Algebraic errors of the steps before.
    pub(crate) errors: AccumulatedError,
    /// Last estimate of the discretisation error.
    pub(crate) discretisation: Discretisation,
}

impl Default for Controller {
    fn default() -> Self {
        Self {
            tolerance: LOOSEST,
            errors: AccumulatedError::default(),
            discretisation: Discretisation::default(),
        }
    }
}

impl Controller {
    /// All that it holds, to be checked.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = f64> {
        let Discretisation { relative, scale, .. } = self.discretisation;
        [self.tolerance, relative, scale]
            .into_iter()
            .chain(self.errors.numbers())
    }

    /// Tolerance of the next solve.
    pub(crate) fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// After a solve that missed a target; `false` if nothing tighter can be asked for. Targets are pairs of what was
    /// found and what is wanted.
    pub(crate) fn tighten(&mut self, targets: [(f64, f64); 2]) -> bool {
        if self.tolerance <= TIGHTEST {
            return false;
        }
        let factor = slack(targets).clamp(TIGHTENING[0], TIGHTENING[1]);
        self.tolerance = (factor * self.tolerance).max(TIGHTEST);
        true
    }

    /// After a step that reached its targets in the first round: the next may be looser.
    pub(crate) fn relax(&mut self, targets: [(f64, f64); 2]) {
        let factor = slack(targets).clamp(1.0, 3.0);
        self.tolerance = (factor * self.tolerance).min(LOOSEST);
    }
}

/// What the tolerance may change by; below one where a target is missed. What is not a number asks for the most.
fn slack(targets: [(f64, f64); 2]) -> f64 {
    let factor = |(found, target): (f64, f64)| {
        let factor = MARGIN * target / found.max(f64::MIN_POSITIVE);
        if found.is_nan() { 0.0 } else { factor }
    };
    factor(targets[0]).min(factor(targets[1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_estimate_of_the_mesh_ages() {
        let none = Discretisation::default();
        assert!(!none.holds(0, 1.0) && !none.holds(0, 0.0));
        let known = Discretisation {
            relative: 0.1,
            step: 3,
            scale: 2.0,
        };
        assert!(known.holds(3, 2.0) && known.holds(10, 8.0) && known.holds(4, 0.5));
        assert!(!known.holds(11, 2.0) && !known.holds(4, 8.1) && !known.holds(4, 0.4));
        assert!(!known.holds(4, f64::NAN));
        // a mesh that is exact for its displacement
        assert_eq!(known.target(0.1), 0.1 * 0.1);
        assert_eq!(none.target(0.1), 1e-7);
    }

    #[test]
    fn the_certificate_that_goes_with_a_target() {
        assert_eq!(certificate_limit(0.3), 1e-2);
        assert_eq!(certificate_limit(1e-5), 5e-5);
        assert_eq!(certificate_limit(1e-11), 1e-8);
        // what is not a number asks for the tightest step
        let mut c = Controller::default();
        assert!(c.tighten([(1e-9, 1.0), (f64::NAN, 1e-2)]));
        assert_eq!(c.tolerance(), 1e-3 * LOOSEST);
    }

    #[test]
    fn the_controller_tightens_by_what_is_missing_and_ends() {
        let mut c = Controller::default();
        let fine = (1e-9, 1.0);
        assert!(c.tighten([(1e-2, 1e-3), fine]));
        assert!((c.tolerance() - 0.05 * LOOSEST).abs() < 1e-15);
        let mut rounds = 0;
        while c.tighten([fine, (1.0, 1e-3)]) {
            rounds += 1;
        }
        assert!(rounds < 6 && c.tolerance() == TIGHTEST);
        c.relax([(0.0, 1.0), (0.4, 1.0)]);
        assert_eq!(c.tolerance(), 1.25 * TIGHTEST);
        c.tolerance = TIGHTEST;
        c.relax([(0.0, 1.0), fine]);
        assert_eq!(c.tolerance(), 3.0 * TIGHTEST);
    }
}
