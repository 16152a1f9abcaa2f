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

use crate::error::ContactError;

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
}
