//! Estimated errors of a step, and of all steps so far.

use crate::tolerances::LEAST_SHARE;

/// Estimated algebraic error of a step, by the duality gap.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct AlgebraicError {
    /// The duality gap: bounds half the squared energy norm of the error of the torn displacement, J. Not less than
    /// what lies between the mean of its copies and the displacement whose energy is in the gap.
    pub energy: f64,
    /// Part of it that comes from the distance of the torn displacement to a continuous admissible one, J.
    pub distance: f64,
    /// Elastic energy of the torn displacement, J.
    pub elastic: f64,
    /// What the error is compared with, J: the elastic energy, and for a body at rest a little more.
    pub scale: f64,
}

impl AlgebraicError {
    /// Error relative to the displacement, both in the energy norm: `sqrt(energy / scale)`. 0 where nothing is wrong,
    /// infinite where something is and there is no scale: no load, no displacement, no step before.
    pub fn relative(&self) -> f64 {
        relative(self.energy, self.scale)
    }
}

/// Root of a ratio of energies; 0 for no energy, whatever the scale.
pub(crate) fn relative(energy: f64, scale: f64) -> f64 {
    if energy == 0.0 { 0.0 } else { (energy / scale).sqrt() }
}

/// What the estimates of a step say.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct AccuracyReport {
    /// Estimated algebraic error of this step alone.
    pub algebraic: AlgebraicError,
    /// The same with what earlier steps have left in it. A run that is resumed from a state without such estimates
    /// starts at 0.
    pub accumulated: AccumulatedError,
    /// Estimated discretisation error relative to the displacement (or to the [scale](AlgebraicError::scale) of a body
    /// at rest), in the energy norm, if it was asked for.
    pub discretisation: Option<f64>,
    /// The step at which it was estimated: this one or one of the last seven.
    pub estimated_at: Option<usize>,
    /// The relative algebraic error that was asked for.
    pub target: f64,
    /// The share of it that this step may have alone.
    pub share: f64,
    /// Whether the step kept its share.
    pub reached: bool,
    /// The largest relative violation of the contact conditions in the certificate that is accepted.
    pub certificate_limit: f64,
    /// Whether the step kept it.
    pub certified: bool,
    /// Solves of the step, each warm from the one before.
    pub rounds: usize,
    /// Tolerance of the last of them.
    pub tolerance: f64,
}

/// Algebraic error with what earlier steps have left in it: the sum of the roots of all gaps, and the root of their
/// sum.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(any(feature = "checkpoint", feature = "serde"), derive(serde::Serialize))]
#[cfg_attr(feature = "checkpoint", derive(serde::Deserialize))]
pub struct AccumulatedError {
    /// Sum of the roots of the gaps, square root of J.
    sum: f64,
    /// Sum of the gaps, J.
    energy: f64,
    /// What the last step is compared with, J: its elastic energy, or more at rest.
    scale: f64,
}

impl AccumulatedError {
    pub(crate) fn with(&self, own: &AlgebraicError, history: bool) -> Self {
        let before = if history { *self } else { Self::default() };
        Self {
            sum: before.sum + own.energy.sqrt(),
            energy: before.energy + own.energy,
            scale: own.scale,
        }
    }

    /// All that it holds, to be checked.
    pub(crate) fn numbers(&self) -> [f64; 3] {
        [self.sum, self.energy, self.scale]
    }

    /// What the last step may have of a total error `target` (relative, likely) if all steps are to have the same share
    /// of what is left; `left` steps of `steps` are to be solved, this one with them.
    pub(crate) fn share(&self, own: &AlgebraicError, target: f64, left: usize, steps: usize) -> f64 {
        if own.scale <= 0.0 {
            return target;
        }
        let all = target.powi(2);
        let rest = (all - self.energy / own.scale) / left.max(1) as f64;
        // where the load has fallen the old error may be more than is wanted: no accuracy of this step helps
        rest.max(LEAST_SHARE * all / steps.max(1) as f64).sqrt()
    }

    /// Likely error relative to the last displacement, both in the energy norm. 0 and infinity as in
    /// [`AlgebraicError::relative`].
    pub fn likely(&self) -> f64 {
        relative(self.energy, self.scale)
    }

    /// What the last step is compared with, J.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// Energy of the difference that the likely errors of two runs can make together, J.
    pub(crate) fn likely_difference(&self, other: &Self) -> f64 {
        (self.energy.sqrt() + other.energy.sqrt()).powi(2)
    }

    /// The same if the errors of all steps point in the same direction.
    pub fn at_most(&self) -> f64 {
        relative(self.sum * self.sum, self.scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(energy: f64) -> AlgebraicError {
        AlgebraicError {
            energy,
            distance: 0.0,
            elastic: 100.0,
            scale: 100.0,
        }
    }

    #[test]
    fn sums_and_shares() {
        let mut error = AccumulatedError::default();
        for _ in 0..4 {
            error = error.with(&step(1.0), true);
        }
        assert!((error.likely() - 0.2).abs() < 1e-15 && (error.at_most() - 0.4).abs() < 1e-15);
        let alone = error.with(&step(1.0), false);
        assert!((alone.at_most() - 0.1).abs() < 1e-15);
        // equal shares from the start, all that is left at the end, a floor when nothing is left
        let none = AccumulatedError::default();
        assert!((none.share(&step(1.0), 0.1, 4, 4) - 0.05).abs() < 1e-15);
        assert!((error.share(&step(1.0), 0.5, 1, 5) - 0.21_f64.sqrt()).abs() < 1e-15);
        assert!((error.share(&step(1.0), 0.1, 1, 4) - 0.025).abs() < 1e-15);
        assert_eq!(none.share(&AlgebraicError::default(), 0.1, 1, 1), 0.1);
        assert_eq!(none.likely(), 0.0);
    }
}
