//! The method of successive approximations, `x <- map(x)`, and what can be said of the contraction of the map.
//!
//! The ratio of successive changes tells whether the map is contractive; [`Contraction`] watches it. In contact with
//! Coulomb friction the map takes the normal forces that define the slip bounds to those of the problem with these
//! bounds, (3.17) of the paper; it is contractive for small coefficients only.

use crate::tolerances::{MAP_PATIENCE, NO_CONTRACTION, PROGRESS, RATE_WINDOW};
use crate::vector;

/// What the sequence of iterates tells about the map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub enum Verdict {
    /// The relative change is at most the tolerance.
    Converged,
    /// Changes shrink, more iterations are needed.
    Contracting,
    /// Changes do not shrink: the map is not contractive here, the fixed-point form has no limit from this start.
    NotContractive,
    /// Too few iterates to tell.
    Unknown,
}

/// A running estimate of the contraction rate: the geometric mean of the last ratios of changes.
#[derive(Debug, Clone, Default)]
pub struct Contraction {
    changes: Vec<f64>,
}

impl Contraction {
    /// Records the absolute change between two successive iterates.
    pub fn record(&mut self, change: f64) {
        self.changes.push(change);
    }

    /// Estimated rate; `None` before two changes are known or after an exact fixed point.
    #[must_use]
    pub fn rate(&self) -> Option<f64> {
        let n = self.changes.len();
        if n < 2 {
            return None;
        }
        let first = n.saturating_sub(RATE_WINDOW + 1);
        let (a, b) = (self.changes[first], self.changes[n - 1]);
        (a > 0.0 && b > 0.0).then(|| (b / a).powf(1.0 / (n - 1 - first) as f64))
    }

    /// Whether the last `patience` changes were no smaller than the ones before.
    #[must_use]
    fn stalls(&self, patience: usize) -> bool {
        let mut best = f64::INFINITY;
        let mut at = 0;
        for (k, &change) in self.changes.iter().enumerate() {
            if change < PROGRESS * best {
                best = change;
                at = k;
            }
        }
        self.changes.len() > at.saturating_add(patience)
    }
}

/// Result of [`successive_approximations`].
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[must_use = "it may not have converged: see `verdict`"]
pub struct FixedPointReport {
    /// How it ended.
    pub verdict: Verdict,
    /// Evaluations of the map.
    pub evaluations: usize,
    /// Last relative change.
    pub change: f64,
    /// Estimated contraction rate.
    pub rate: Option<f64>,
}

/// Iterates `x <- map(x)` until the change relative to `x`, or to `least` if that is larger, is at most `tolerance`
/// (0/0 counts as 0). `least` is the norm below which `x` is taken to vanish.
///
/// `map(x, change)` overwrites `x` and returns whether it evaluated with full accuracy; `change` is the last relative
/// change, 1 at first, and tells how accurate the evaluation needs to be. Only an evaluation with full accuracy can end
/// the iteration.
///
/// # Errors
/// Those of the map.
pub fn successive_approximations<E>(
    x: &mut [f64],
    tolerance: f64,
    least: f64,
    max_evaluations: usize,
    mut map: impl FnMut(&mut [f64], f64) -> Result<bool, E>,
) -> Result<FixedPointReport, E> {
    let mut contraction = Contraction::default();
    // differences of evaluations with full accuracy only: loose ones say nothing about the map
    let mut sharp = Contraction::default();
    let mut old = x.to_vec();
    let (mut change, mut asked) = (1.0, 1.0);
    let mut verdict = Verdict::Unknown;
    let mut evaluations = 0;
    while evaluations < max_evaluations {
        old.copy_from_slice(x);
        let exact = map(x, asked)?;
        evaluations += 1;
        let difference = vector::distance(x, &old);
        let size = vector::norm(x).max(least);
        contraction.record(difference);
        if exact {
            sharp.record(difference);
        } else {
            sharp = Contraction::default();
        }
        change = if difference == 0.0 { 0.0 } else { difference / size };
        asked = change;
        if change <= tolerance {
            if exact {
                verdict = Verdict::Converged;
                break;
            }
            // a loose evaluation cannot tell: the next one is exact
            asked = 0.0;
            continue;
        }
        let stalls = sharp.stalls(MAP_PATIENCE) || contraction.stalls(2 * MAP_PATIENCE);
        let grows = contraction.rate().is_none_or(|rate| rate >= NO_CONTRACTION);
        if stalls && grows || !size.is_finite() {
            verdict = Verdict::NotContractive;
            break;
        }
        verdict = if contraction.rate().is_some_and(|r| r < 1.0) {
            Verdict::Contracting
        } else {
            Verdict::Unknown
        };
    }
    Ok(FixedPointReport {
        verdict,
        evaluations,
        change,
        rate: contraction.rate(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// One node in contact, `lambda <- -u0/a + q lambda` with `q = mu b / a`.
    fn one_node(mu: f64) -> (f64, FixedPointReport) {
        let (a, b, u0) = (2.0, 1.0, 1.0);
        let mut x = [0.0];
        let report = successive_approximations(&mut x, 1e-12, 0.0, 2000, |x, _| {
            x[0] = -u0 / a + mu * b / a * x[0];
            Ok::<bool, ()>(true)
        })
        .unwrap();
        (x[0], report)
    }

    #[test]
    fn the_one_node_coulomb_map_converges_at_its_rate() {
        for (mu, q, limit) in [
            (0.2, 0.1, -0.555556),
            (0.5, 0.25, -0.666667),
            (1.0, 0.5, -1.0),
            (1.9, 0.95, -10.0),
        ] {
            let (x, report) = one_node(mu);
            assert_eq!(report.verdict, Verdict::Converged);
            assert_relative_eq!(x, limit, max_relative = 1e-6);
            assert_relative_eq!(report.rate.unwrap(), q, max_relative = 1e-3);
        }
    }

    #[test]
    fn a_map_that_is_not_contractive_is_named_so() {
        let (_, report) = one_node(2.1);
        assert_eq!(report.verdict, Verdict::NotContractive);
        assert_relative_eq!(report.rate.unwrap(), 1.05, max_relative = 1e-6);
        assert!(report.evaluations < 20, "{report:?}");
    }

    #[test]
    fn nothing_in_contact_is_a_fixed_point_at_once() {
        let mut x = [0.0; 3];
        let report = successive_approximations(&mut x, 1e-6, 0.0, 5, |_, _| Ok::<bool, ()>(true)).unwrap();
        assert_eq!((report.verdict, report.evaluations), (Verdict::Converged, 1));
    }
}
