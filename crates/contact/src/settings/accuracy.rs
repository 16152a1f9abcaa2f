//! When the solve of a step ends; docs/theory.md, section 10, tells how `Relative` and `Balanced` decide.

use crate::error::ContactError;

/// When the solve of a step ends.
///
/// Estimates are those of the energy of the whole body, beside a
/// [bound](crate::report::AccuracyReport::certificate_limit) of five times the target on the contact conditions: forces
/// that carry little of it (a light touch after a long rigid motion, friction of a drag far below the elastic
/// displacement) need `Tolerance`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
#[must_use]
pub enum Accuracy {
    /// At the tolerance of the settings. No error is estimated.
    #[default]
    Tolerance,
    /// Where the algebraic error is `fraction` of the discretisation error, both estimated, in the energy norm, with
    /// what earlier steps have left in it. The setting `tolerance` is not used.
    Balanced {
        /// In (0, 1]; 0.1 adds half a per cent to the total error.
        fraction: f64,
    },
    /// Where the estimated algebraic error, with what earlier steps have left in it, is at most this, relative, in the
    /// energy norm; in [1e-11, 0.5]. The setting `tolerance` is not used.
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
