//! When the solve of a step ends; docs/theory.md, section 10, tells how `Relative` and `Balanced` decide.

use crate::error::ContactError;

/// When the solve of a step ends.
///
/// Estimates are relative to the energy of the whole body; in addition the contact conditions hold to [five times the
/// target](crate::report::AccuracyReport::certificate_limit). Use `Tolerance` for forces that contribute little to the
/// energy, such as a light touch after a large rigid motion, or friction whose effect is far below the elastic
/// displacement.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
#[must_use]
pub enum Accuracy {
    /// At the tolerance of the settings. No error is estimated.
    #[default]
    Tolerance,
    /// When the algebraic error is `fraction` of the discretisation error, both estimated in the energy norm and
    /// including errors inherited from earlier steps. The setting `tolerance` is not used.
    Balanced {
        /// In (0, 1]; 0.1 adds half a per cent to the total error.
        fraction: f64,
    },
    /// When the estimated relative algebraic error in the energy norm, including errors inherited from earlier steps,
    /// is at most this; in [1e-11, 0.5]. The setting `tolerance` is not used.
    Relative(f64),
}

impl Accuracy {
    /// Balanced with fraction 0.1.
    pub fn balanced() -> Self {
        Self::Balanced { fraction: 0.1 }
    }

    pub(crate) fn validate(self) -> Result<(), ContactError> {
        match self {
            Self::Tolerance => Ok(()),
            Self::Balanced { fraction: f } => {
                ContactError::check(f > 0.0 && f <= 1.0, "accuracy.fraction", f, "(0, 1]")
            }
            Self::Relative(x) => {
                let good = (1e-11..=0.5).contains(&x);
                ContactError::check(good, "accuracy.relative", x, "[1e-11, 0.5]")
            }
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
