//! Steps in time and the difference formula (2.9).

use crate::error::ContactError;
use crate::tolerances::{ROUNDING, UNEQUAL};
use signorini_fem_mesh::History;

/// The difference formula (2.9): `du/dt` at the end of step `i+1` is about
/// `(alpha u[i+1] + beta u[i] + gamma u[i-1]) / dt`.
///
/// With `alpha = 3/2, beta = -2, gamma = 1/2` (the paper's choice) a node that *sticks* obeys
/// `u[i+1] = 4/3 u[i] - 1/3 u[i-1]`: after slipping by `s` per step it still moves by `s/3, s/9, ...`, in all `s/2`.
/// The friction loss of a cycle then has a first-order error. Backward Euler (`1, -1, 0`) has no such
/// artefact and is exact at the steps for piecewise linear slip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DifferenceFormula([f64; 3]);

impl DifferenceFormula {
    /// The paper's `3/2, -2, 1/2`.
    pub const PAPER: Self = Self([1.5, -2.0, 0.5]);
    /// `1, -1, 0`.
    pub const BACKWARD_EULER: Self = Self([1.0, -1.0, 0.0]);

    /// Any consistent formula.
    ///
    /// # Errors
    /// [`ContactError::Formula`] unless `alpha > 0`, `alpha + beta + gamma = 0` (a body at rest has rate 0),
    /// `-beta - 2 gamma = 1` (uniform motion has its rate) and `gamma >= -1/2` (what sticks stays).
    pub fn new(alpha: f64, beta: f64, gamma: f64) -> Result<Self, ContactError> {
        let rule = if !(alpha.is_finite() && beta.is_finite() && gamma.is_finite() && alpha > 0.0) {
            "alpha must be positive and all three finite"
        } else if (alpha + beta + gamma).abs() > ROUNDING * alpha {
            "the sum must be 0"
        } else if (-beta - 2.0 * gamma - 1.0).abs() > ROUNDING {
            "-beta - 2 gamma must be 1"
        } else if gamma < -0.5 {
            "gamma must be at least -1/2: with less what sticks moves, and ever faster"
        } else {
            return Ok(Self([alpha, beta, gamma]));
        };
        Err(ContactError::Formula {
            alpha,
            beta,
            gamma,
            rule,
        })
    }

    /// The weights `alpha`, `beta`, `gamma` of the new displacement, the last one and the one before.
    pub fn weights(&self) -> [f64; 3] {
        self.0
    }

    /// Whether only one old displacement is needed.
    pub(crate) fn is_one_step(&self) -> bool {
        self.0[2] == 0.0
    }

    /// The formula for a step that is `ratio` times as long as the one before, for a rate in units of the new step: the
    /// new difference quotient, and that of the last step, weighted so that a rate that grows evenly is met as well as
    /// with equal steps. From [`PAPER`](Self::PAPER) follows the formula of second order with variable steps, stable
    /// for ratios up to `1 + sqrt(2)` (Grigorieff 1983).
    pub(crate) fn at_ratio(self, ratio: f64) -> Self {
        if ratio == 1.0 || self.is_one_step() {
            return self;
        }
        let weight = self.0[2] * 2.0 * ratio / (1.0 + ratio);
        Self([1.0 + weight, -(1.0 + weight + weight * ratio), weight * ratio])
    }

    /// `z` of section 3: the displacement at which the difference vanishes, `-(beta u[i] + gamma u[i-1]) / alpha`.
    pub fn offset(&self, last: f64, before: f64) -> f64 {
        let [alpha, beta, gamma] = self.0;
        -(beta * last + gamma * before) / alpha
    }
}

impl Default for DifferenceFormula {
    /// Backward Euler.
    fn default() -> Self {
        Self::BACKWARD_EULER
    }
}

/// The times of a scene: one static state, or steps with a history of friction.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[must_use]
pub enum Analysis {
    /// One state of equilibrium at one time; friction acts against the displacement from the rest position.
    Static {
        /// Time at which load histories are evaluated, in s.
        time: f64,
    },
    /// A sequence of states; friction acts against the difference (2.9). The body is at rest before time 0.
    Quasistatic {
        /// The times in s, strictly increasing, the first above 0.
        times: Vec<f64>,
        /// The difference formula.
        formula: DifferenceFormula,
    },
}

/// What is solved at once: a step, or a part of one that was halved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Increment {
    /// The step, from 0.
    pub(crate) index: usize,
    /// Time at which it begins, s; `None` where the body is at rest before.
    pub(crate) start: Option<f64>,
    /// Time to which it leads, s.
    pub(crate) end: f64,
    /// Its length, s; `None` in a static scene.
    pub(crate) length: Option<f64>,
    /// A step's length over that of the step before; 1 for the first one.
    pub(crate) ratio: f64,
    /// The difference formula; `None` in a static scene.
    pub(crate) formula: Option<DifferenceFormula>,
}

impl Increment {
    /// The part of a step between two fractions of it, `ratio` times as long as what was solved before.
    pub(crate) fn part(self, [from, to]: [f64; 2], ratio: f64) -> Self {
        let Some(length) = self.length else {
            return self;
        };
        // the ends of a step are exact
        let at = |fraction: f64| match fraction {
            1.0 => self.end,
            _ => self.end - length + fraction * length,
        };
        Self {
            start: if from == 0.0 { self.start } else { Some(at(from)) },
            end: at(to),
            length: Some((to - from) * length),
            formula: self.formula.map(|formula| formula.at_ratio(ratio)),
            ..self
        }
    }
}

/// Most equal steps.
const MOST: usize = 100_000_000;

impl Analysis {
    /// One state at time 1.
    pub fn statics() -> Self {
        Self::Static { time: 1.0 }
    }

    /// `steps` equal steps up to `end` seconds, by backward Euler. [`with_formula`](Self::with_formula) selects another
    /// formula, such as the paper's ([`PAPER`](DifferenceFormula::PAPER)). That one uses two earlier displacements:
    /// points that slid creep on while loads are constant, and its first step has one and a half times the slip rate.
    pub fn quasistatic(end: f64, steps: usize) -> Self {
        // none, which is refused when the scene is used
        let steps = if steps > MOST { 0 } else { steps };
        let times = (1..=steps).map(|i| end * i as f64 / steps as f64).collect();
        Self::Quasistatic {
            times,
            formula: DifferenceFormula::default(),
        }
    }

    /// The same with another difference formula (static scenes have none).
    pub fn with_formula(mut self, new: DifferenceFormula) -> Self {
        if let Self::Quasistatic { formula, .. } = &mut self {
            *formula = new;
        }
        self
    }

    /// The times of all steps, s.
    pub(crate) fn times(&self) -> &[f64] {
        match self {
            Self::Static { time } => std::slice::from_ref(time),
            Self::Quasistatic { times, .. } => times,
        }
    }

    /// The largest size of a history at the steps, and its time.
    pub(crate) fn largest_factor(&self, history: &History) -> (f64, f64) {
        let times = self.times().iter();
        times.fold((0.0, 0.0), |worst: (f64, f64), &time| {
            let value = history.value(time).abs();
            if value > worst.0 { (value, time) } else { worst }
        })
    }

    /// Number of steps.
    pub fn steps(&self) -> usize {
        self.times().len()
    }

    /// Time to which a step leads, counted from 0, s.
    pub fn time(&self, step: usize) -> Option<f64> {
        self.times().get(step).copied()
    }

    /// A whole step; `None` after the last.
    pub(crate) fn increment(&self, step: usize) -> Option<Increment> {
        let end = self.time(step)?;
        let start = step.checked_sub(1).and_then(|before| self.time(before));
        let before = step.checked_sub(2).and_then(|before| self.time(before));
        let formula = self.formula();
        let length = end - start.unwrap_or(0.0);
        let ratio = start.map_or(1.0, |start| length / (start - before.unwrap_or(0.0)));
        Some(Increment {
            index: step,
            start,
            end,
            length: formula.map(|_| length),
            // of equal steps, rounding apart
            ratio: if (ratio - 1.0).abs() > UNEQUAL { ratio } else { 1.0 },
            formula,
        })
    }

    /// The difference formula; `None` for a static scene.
    pub fn formula(&self) -> Option<DifferenceFormula> {
        match self {
            Self::Static { .. } => None,
            Self::Quasistatic { formula, .. } => Some(*formula),
        }
    }

    pub(crate) fn validate(&self) -> Result<(), ContactError> {
        let (times, formula) = match self {
            Self::Static { time } if time.is_finite() => return Ok(()),
            Self::Static { time } => {
                return Err(ContactError::Time { step: 0, time: *time });
            }
            Self::Quasistatic { times, formula } => (times, formula),
        };
        let Some(&first) = times.first() else {
            return Err(ContactError::NoSteps);
        };
        let mut before = 0.0;
        for (step, &time) in times.iter().enumerate() {
            if !(time.is_finite() && time > before) {
                return Err(ContactError::Time { step, time });
            }
            before = time;
        }
        if formula.is_one_step() {
            return Ok(());
        }
        for (step, pair) in times.windows(2).enumerate() {
            let length = pair[1] - pair[0];
            if (length - first).abs() > UNEQUAL * first.max(length) {
                return Err(ContactError::UnequalSteps {
                    step: step + 1,
                    length,
                    first,
                });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_two_formulas_are_consistent() {
        for f in [DifferenceFormula::PAPER, DifferenceFormula::BACKWARD_EULER] {
            assert_eq!(DifferenceFormula::new(f.0[0], f.0[1], f.0[2]).unwrap(), f);
        }
        assert!(DifferenceFormula::new(1.0, -1.0, 0.5).is_err());
        assert!(DifferenceFormula::new(-1.0, 1.0, 0.0).is_err());
        assert!(DifferenceFormula::new(2.0, -2.0, 0.0).is_err());
    }

    /// Uniform motion has its rate, with any steps; with the paper's weights also the end of a rate that grows evenly.
    #[test]
    fn unequal_steps_have_weights_of_their_own() {
        let f = DifferenceFormula::PAPER;
        assert_eq!(f.at_ratio(1.0), f);
        assert_eq!(
            DifferenceFormula::BACKWARD_EULER.at_ratio(0.5),
            DifferenceFormula::BACKWARD_EULER
        );
        for ratio in [0.5, 2.0, 0.125] {
            let [alpha, beta, gamma] = f.at_ratio(ratio).weights();
            // a new step of length 1 up to time 0, before it one of 1 / ratio
            let rate = |u: fn(f64) -> f64| alpha * u(0.0) + beta * u(-1.0) + gamma * u(-1.0 - 1.0 / ratio);
            assert!(rate(|_| 1.0).abs() < 1e-14);
            assert!((rate(|t| t) - 1.0).abs() < 1e-14);
            assert!(rate(|t| t * t).abs() < 1e-13, "{ratio}");
        }
    }

    #[test]
    fn parts_of_a_step_end_where_it_ends() {
        let whole = Analysis::quasistatic(0.5, 5).increment(1).expect("a step");
        assert_eq!((whole.start, whole.end), (Some(0.1), 0.2));
        assert_eq!(whole.part([0.0, 1.0], 1.0), whole);
        let last = whole.part([0.75, 1.0], 1.0);
        assert_eq!((last.end, last.length), (0.2, whole.length.map(|h| h / 4.0)));
        assert!(last.start.is_some_and(|t| (t - 0.175).abs() < 1e-15));
        assert_eq!(Analysis::quasistatic(1.0, 2).increment(0).expect("a step").start, None);
    }

    #[test]
    fn a_sticking_node_still_moves_half_a_step_with_the_three_step_formula() {
        let f = DifferenceFormula::PAPER;
        let (mut last, mut before) = (1.0, 0.0);
        for _ in 0..60 {
            let next = f.offset(last, before);
            before = last;
            last = next;
        }
        assert!((last - 1.5).abs() < 1e-12);
        assert_eq!(DifferenceFormula::BACKWARD_EULER.offset(1.0, 0.0), 1.0);
    }

    #[test]
    fn wrong_times_are_refused() {
        let q = |times: Vec<f64>| Analysis::Quasistatic {
            times,
            formula: DifferenceFormula::PAPER,
        };
        assert!(matches!(q(vec![]).validate(), Err(ContactError::NoSteps)));
        assert!(matches!(
            q(vec![0.0]).validate(),
            Err(ContactError::Time { step: 0, .. })
        ));
        assert!(matches!(
            q(vec![1.0, 1.0]).validate(),
            Err(ContactError::Time { step: 1, .. })
        ));
        assert!(matches!(
            q(vec![1.0, 3.0]).validate(),
            Err(ContactError::UnequalSteps { step: 1, .. })
        ));
        assert!(
            q(vec![1.0, 3.0])
                .with_formula(DifferenceFormula::BACKWARD_EULER)
                .validate()
                .is_ok()
        );
        assert!(Analysis::Static { time: f64::NAN }.validate().is_err());
    }
}
