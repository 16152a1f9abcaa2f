//! How accurately a level is to be solved, and how accurate it is.
//!
//! | [`Accuracy`] | a level ends when | extra work a level |
//! |---|---|---|
//! | `Tolerance` (default) | the solver's relative tolerance is reached | none |
//! | `Relative(x)` | the estimated algebraic error keeps it on the way to `x` in the energy norm | one duality gap a round |
//! | `Balanced { fraction }` | it is at most `fraction` of the estimated discretisation error | the same, and now and then a recovery of strains |
//!
//! The two that look at the result solve loosely, estimate, tighten the solver's tolerance by what is missing, and
//! resume from the present iterate. The tolerance that was enough starts the next level. Everything is counted.
//!
//! **The certificate is asked, too.** An error in the energy norm is a mean: a few points may miss their slip bound, their direction or the
//! obstacle by much and weigh little in it. A level is accepted only if the largest relative violation of the contact conditions (gap, sign,
//! complementarity, cone, direction) in the [`Certificate`] is at most five times the target as well, and 1e-2 in any case (not below
//! 1e-8, [`AccuracyReport::certificate_limit`]). Equilibrium and continuity are in the estimate itself. This costs nothing where it
//! holds; where it does not, the tolerance is tightened by what is missing, and a level that cannot reach it ends as
//! [`NotCertified`](crate::StepStatus::NotCertified). In 600 levels of random
//! scenes the face method left at most twice a target of 1e-4 and a tenth of one of 1e-2; successive approximations left seven times a target of
//! 1e-4 at points that are pressed weakly beside a strong pull.
//!
//! **No scale, no mesh.** Errors of a body at rest are relative to [`AlgebraicError::scale`](crate::AlgebraicError::scale). A discretisation error below 1e-6 (a
//! body strained evenly) counts as 1e-6, so that `Balanced` does not ask for less than rounding allows.
//!
//! The relative discretisation error belongs to the mesh and to where the body bends, and changes slowly. It is estimated again
//! once the elastic energy has changed by a factor of four, and at every eighth level
//! ([`AccuracyReport::estimated_at`]).
//!
//! Where levels inherit errors ([`accumulated`](crate::accumulated)) the target is meant for the error with all that earlier
//! levels have left in it: each level gets an equal share of the squared error that is left, `target / sqrt(L)` with `L` levels of
//! equal size. Where the load falls again, old errors can be more than the target whatever this level does; the report says so
//! ([`AccuracyReport::accumulated`]), and the level gets half an equal share.

use crate::accumulated::AccumulatedError;
use crate::algebraic::AlgebraicError;
use crate::certificate::{Certificate, Violation, worst};
use crate::error::ContactError;

/// Tolerance of the first solve of the first level. A looser one saves little and may end before slip bounds have settled.
pub(crate) const LOOSEST: f64 = 1e-3;
/// The smallest tolerance a solver is asked for.
const TIGHTEST: f64 = 1e-12;
/// Solves of one level.
pub(crate) const ROUNDS: usize = 8;
/// What is missing is exceeded by this factor, so that one more round is usually enough.
const MARGIN: f64 = 0.5;

/// When the solve of a level ends.
///
/// Estimates are those of the energy of the whole body, beside a loose bound on the contact conditions: forces that carry little of
/// it (a light touch after a long rigid motion, friction of a drag far below the elastic displacement) need `Tolerance`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum Accuracy {
    /// At the tolerance of the settings. No error is estimated.
    #[default]
    Tolerance,
    /// Where the algebraic error is `fraction` of the discretisation error, both estimated, in the energy norm, with what
    /// earlier levels have left in it.
    /// The setting `tolerance` is not used.
    Balanced {
        /// In (0, 1]; 0.1 adds half a per cent to the total error.
        fraction: f64,
    },
    /// Where the estimated algebraic error, with what earlier levels have left in it, is at most this, relative, in the energy
    /// norm; in [1e-11, 0.5].
    /// The setting `tolerance` is not used.
    Relative(f64),
}

impl Accuracy {
    /// Balanced with fraction 0.1.
    #[must_use]
    pub fn balanced() -> Self {
        Self::Balanced { fraction: 0.1 }
    }

    pub(crate) fn validate(self) -> Result<(), ContactError> {
        let (name, value, range, good) = match self {
            Self::Tolerance => return Ok(()),
            Self::Balanced { fraction: f } => {
                ("accuracy.fraction", f, "(0, 1]", f > 0.0 && f <= 1.0)
            }
            Self::Relative(x) => (
                "accuracy.relative",
                x,
                "[1e-11, 0.5]",
                (1e-11..=0.5).contains(&x),
            ),
        };
        if good {
            Ok(())
        } else {
            Err(ContactError::Setting { name, value, range })
        }
    }
}

/// What the estimates of a level say.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct AccuracyReport {
    /// Estimated algebraic error of this level alone.
    pub algebraic: AlgebraicError,
    /// The same with what earlier levels have left in it. A run that is resumed from a state without such estimates starts at 0.
    pub accumulated: AccumulatedError,
    /// Estimated discretisation error relative to the displacement (or to the [scale](AlgebraicError::scale) of a body at rest), in
    /// the energy norm, if it was asked for.
    pub discretisation: Option<f64>,
    /// The level at which it was estimated: this one or one of the last seven.
    pub estimated_at: Option<usize>,
    /// The relative algebraic error that was asked for.
    pub target: f64,
    /// The share of it that this level may have alone.
    pub share: f64,
    /// Whether the level kept its share.
    pub reached: bool,
    /// The largest relative violation of the contact conditions in the certificate that is accepted.
    pub certificate_limit: f64,
    /// Whether the level kept it.
    pub certified: bool,
    /// Solves of the level, each warm from the one before.
    pub rounds: usize,
    /// Tolerance of the last of them.
    pub tolerance: f64,
}

/// An estimate of the discretisation error.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Discretisation {
    /// Relative to the displacement, in the energy norm.
    pub(crate) relative: f64,
    /// The level it belongs to, and the energy that it is relative to.
    pub(crate) level: usize,
    pub(crate) scale: f64,
}

impl Discretisation {
    /// Whether it will do for another level.
    pub(crate) fn holds(&self, level: usize, scale: f64) -> bool {
        let range = self.scale / CHANGED..=self.scale * CHANGED;
        self.scale > 0.0 && range.contains(&scale) && level.abs_diff(self.level) < EVERY
    }

    /// The algebraic error that is this fraction of it.
    pub(crate) fn target(&self, fraction: f64) -> f64 {
        fraction * self.relative.max(EXACT_MESH)
    }
}

/// A smaller discretisation error counts as this.
const EXACT_MESH: f64 = 1e-6;

/// Largest relative violation of the contact conditions; not a number if one is none.
pub(crate) fn contact_violation(certificate: &Certificate) -> f64 {
    let c = certificate;
    let parts = [c.gap, c.sign, c.complementarity, c.cone, c.direction];
    worst(parts.iter().map(Violation::relative))
}

/// Largest relative violation of the contact conditions that goes with a target.
pub(crate) fn certificate_limit(target: f64) -> f64 {
    (CERTIFIED * target).clamp(FINEST, LOOSE)
}

/// Violation of the certificate over the target, and the range of what is asked for.
const CERTIFIED: f64 = 5.0;
const FINEST: f64 = 1e-8;
const LOOSE: f64 = 1e-2;

/// Levels after which the discretisation error is estimated again, and the factor in the elastic energy.
const EVERY: usize = 8;
const CHANGED: f64 = 4.0;

/// Chooses the tolerances of the solves, and remembers the errors of the levels so far.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Controller {
    tolerance: f64,
    /// Algebraic errors of the levels before.
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
        let Discretisation {
            relative, scale, ..
        } = self.discretisation;
        [self.tolerance, relative, scale]
            .into_iter()
            .chain(self.errors.numbers())
    }

    /// Tolerance of the next solve.
    pub(crate) fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// After a solve that missed a target; `false` if nothing tighter can be asked for. Targets are pairs of what was found and
    /// what is wanted.
    pub(crate) fn tighten(&mut self, targets: [(f64, f64); 2]) -> bool {
        if self.tolerance <= TIGHTEST {
            return false;
        }
        let factor = slack(targets).clamp(1e-3, 0.3);
        self.tolerance = (factor * self.tolerance).max(TIGHTEST);
        true
    }

    /// After a level that reached its targets in the first round: the next may be looser.
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
    fn ranges_are_checked() {
        assert!(Accuracy::balanced().validate().is_ok());
        for bad in [
            Accuracy::Balanced { fraction: 0.0 },
            Accuracy::Balanced { fraction: f64::NAN },
            Accuracy::Relative(0.0),
            Accuracy::Relative(1.0),
        ] {
            assert!(matches!(bad.validate(), Err(ContactError::Setting { .. })));
        }
    }

    #[test]
    fn an_estimate_of_the_mesh_ages() {
        let none = Discretisation::default();
        assert!(!none.holds(0, 1.0) && !none.holds(0, 0.0));
        let known = Discretisation {
            relative: 0.1,
            level: 3,
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
        let mut certificate = Certificate::default();
        certificate.cone.value = 1.0;
        certificate.cone.reference = 4.0;
        certificate.equilibrium.value = 1.0;
        assert_eq!(contact_violation(&certificate), 0.25);
        certificate.gap.value = f64::NAN;
        assert!(contact_violation(&certificate).is_nan());
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
