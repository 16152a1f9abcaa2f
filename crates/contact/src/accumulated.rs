//! Algebraic errors that add up over the levels.
//!
//! With friction in a quasistatic analysis a level inherits errors: its tangential positions of rest come from the traces of
//! the levels before. Let them be off by `dz`. The multipliers solve a minimisation over a convex set in the metric of `F`, and
//! `dz` enters its linear term; projections do not magnify distances, so that
//!
//! ```text
//! |u(z + dz) - u(z)|_K = |lambda(z + dz) - lambda(z)|_F <= |dz|_(1/F)
//! ```
//!
//! for given slip bounds. The right side is the energy of the smallest displacement with the tangential trace `dz`: no more than
//! that of the old error itself, as far as this keeps the contact nodes on the obstacle. So the error of a level is about its own
//! [gap](crate::algebraic) and what the levels before carried in, and two figures follow from the gaps alone:
//!
//! - the **sum** of the roots of all gaps: what is reached if no error ever cancels or is forgotten,
//! - the **root of the sum of the gaps**: what is likely, if the errors of the levels point in unrelated directions.
//!
//! Not in them: slip bounds and slip rates that follow the wrong forces (Coulomb friction magnifies by `1 / (1 - q)`, see
//! [`algebraic`](crate::algebraic)), and weights of the difference formula above one (`4/3, -1/3` for the three-step formula).
//! On the benchmark with a coefficient that falls with the slip rate the sum was once 0.67 of the true error;
//! `docs/reports/accuracy-and-time.md` has the measurements.

use crate::algebraic::{AlgebraicError, relative};
use crate::frame::StepResult;

/// Algebraic error with what earlier levels have left in it; see the [module](self).
///
/// ```
/// use signorini_contact::{
///     AccumulatedError, Analysis, Contact, Friction, Load, Scene, Settings, Simulation, Support,
/// };
/// use signorini_fem_mesh::{brick, Brick, History, Hooke, Materials};
///
/// let mesh = Brick::new([2.0, 1.0, 1.0], [4, 2, 2]).build()?;
/// let scene = Scene::new(mesh, Materials::uniform(Hooke::isotropic(1e9, 0.3)?))
///     .with_support(Support::fixed(brick::X_MIN))
///     .with_load(Load::pressure(brick::Z_MAX, 1e6).with_history(History::ramp(1.0, 1.0)?))
///     .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.3)))
///     .with_analysis(Analysis::quasistatic(1.0, 4));
/// let mut simulation = Simulation::new(scene, Settings::default())?;
/// let mut error = AccumulatedError::default();
/// while !simulation.is_finished() {
///     error.add(&simulation.step()?);
///     assert!(error.likely() <= error.at_most() && error.at_most() < 1e-4);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct AccumulatedError {
    /// Sum of the roots of the gaps, square root of J.
    sum: f64,
    /// Sum of the gaps, J.
    energy: f64,
    /// What the last level is compared with, J: its elastic energy, or more [at rest](crate::algebraic#at-rest).
    scale: f64,
}

impl AccumulatedError {
    /// Takes the next level: every level must be added, in order. Where levels stand alone (no friction, or a static scene)
    /// only the last one counts.
    pub fn add(&mut self, frame: &StepResult<'_>) {
        *self = self.with(&frame.algebraic_error(), frame.model.plan.effects.history);
    }

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

    /// What the last level may have of a total error `target` (relative, likely) if all levels are to have the same share of
    /// what is left; `left` levels of `levels` are to be solved, this one with them.
    pub(crate) fn share(
        &self,
        own: &AlgebraicError,
        target: f64,
        left: usize,
        levels: usize,
    ) -> f64 {
        if own.scale <= 0.0 {
            return target;
        }
        let all = target.powi(2);
        let rest = (all - self.energy / own.scale) / left.max(1) as f64;
        // where the load has fallen the old error may be more than is wanted: no accuracy of this level helps
        rest.max(LEAST * all / levels.max(1) as f64).sqrt()
    }

    /// Likely error relative to the last displacement, both in the energy norm. 0 and infinity as in
    /// [`AlgebraicError::relative`].
    #[must_use]
    pub fn likely(&self) -> f64 {
        relative(self.energy, self.scale)
    }

    /// What the last level is compared with, J.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// Energy of the difference that the likely errors of two runs can make together, J.
    pub(crate) fn likely_difference(&self, other: &Self) -> f64 {
        (self.energy.sqrt() + other.energy.sqrt()).powi(2)
    }

    /// The same if the errors of all levels point in the same direction.
    #[must_use]
    pub fn at_most(&self) -> f64 {
        relative(self.sum * self.sum, self.scale)
    }
}

/// Smallest share of a level in the square of the error, relative to an equal share.
const LEAST: f64 = 0.25;

#[cfg(test)]
mod tests {
    use super::*;

    fn level(energy: f64) -> AlgebraicError {
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
            error = error.with(&level(1.0), true);
        }
        assert!((error.likely() - 0.2).abs() < 1e-15 && (error.at_most() - 0.4).abs() < 1e-15);
        let alone = error.with(&level(1.0), false);
        assert!((alone.at_most() - 0.1).abs() < 1e-15);
        // equal shares from the start, all that is left at the end, a floor when nothing is left
        let none = AccumulatedError::default();
        assert!((none.share(&level(1.0), 0.1, 4, 4) - 0.05).abs() < 1e-15);
        assert!((error.share(&level(1.0), 0.5, 1, 5) - 0.21_f64.sqrt()).abs() < 1e-15);
        assert!((error.share(&level(1.0), 0.1, 1, 4) - 0.025).abs() < 1e-15);
        assert_eq!(none.share(&AlgebraicError::default(), 0.1, 1, 1), 0.1);
        assert_eq!(none.likely(), 0.0);
    }
}
