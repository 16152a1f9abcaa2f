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
    /// Estimated discretisation error relative to the displacement, in the energy norm, if it was asked for.
    pub discretisation: Option<f64>,
    /// The level at which it was estimated: this one or one of the last seven.
    pub estimated_at: Option<usize>,
    /// The relative algebraic error that was asked for.
    pub target: f64,
    /// The share of it that this level may have alone.
    pub share: f64,
    /// Whether the level kept its share.
    pub reached: bool,
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
    /// The level it belongs to, and its elastic energy.
    pub(crate) level: usize,
    pub(crate) elastic: f64,
}

impl Discretisation {
    /// Whether it will do for another level.
    pub(crate) fn holds(&self, level: usize, elastic: f64) -> bool {
        let range = self.elastic / CHANGED..=self.elastic * CHANGED;
        self.elastic > 0.0 && range.contains(&elastic) && level.abs_diff(self.level) < EVERY
    }
}

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
            relative, elastic, ..
        } = self.discretisation;
        [self.tolerance, relative, elastic]
            .into_iter()
            .chain(self.errors.numbers())
    }

    /// Tolerance of the next solve.
    pub(crate) fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// After a solve that missed the target; `false` if nothing tighter can be asked for.
    pub(crate) fn tighten(&mut self, found: f64, target: f64) -> bool {
        if self.tolerance <= TIGHTEST {
            return false;
        }
        let factor = (MARGIN * target / found).clamp(1e-3, 0.3);
        self.tolerance = (factor * self.tolerance).max(TIGHTEST);
        true
    }

    /// After a level that reached its target in the first round: the next may be looser.
    pub(crate) fn relax(&mut self, found: f64, target: f64) {
        let factor = (MARGIN * target / found.max(f64::MIN_POSITIVE)).clamp(1.0, 3.0);
        self.tolerance = (factor * self.tolerance).min(LOOSEST);
    }
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
            elastic: 2.0,
        };
        assert!(known.holds(3, 2.0) && known.holds(10, 8.0) && known.holds(4, 0.5));
        assert!(!known.holds(11, 2.0) && !known.holds(4, 8.1) && !known.holds(4, 0.4));
        assert!(!known.holds(4, f64::NAN));
    }

    #[test]
    fn the_controller_tightens_by_what_is_missing_and_ends() {
        let mut c = Controller::default();
        assert!(c.tighten(1e-2, 1e-3));
        assert!((c.tolerance() - 0.05 * LOOSEST).abs() < 1e-15);
        let mut rounds = 0;
        while c.tighten(1.0, 1e-3) {
            rounds += 1;
        }
        assert!(rounds < 6 && c.tolerance() == TIGHTEST);
        c.relax(0.0, 1.0);
        assert_eq!(c.tolerance(), 3.0 * TIGHTEST);
    }
}
