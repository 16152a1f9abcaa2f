//! The state between time steps: one value, with feature `checkpoint` also as bytes.

use super::fingerprint::{Fingerprint, seal};
use super::tolerance::Controller;
use crate::error::ContactError;
use crate::scene::Stage;
use crate::tolerances::MOST_HALVINGS;

/// What one step passes to the next.
///
/// A simulation that resumes from a stored state gives the same bits as an uninterrupted one.
#[derive(Clone, PartialEq, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
#[must_use]
pub struct State {
    /// Steps solved.
    pub(crate) step: usize,
    /// Multipliers of the last step and the one before.
    pub(crate) lambda: [Vec<f64>; 2],
    /// `F lambda` of the same.
    pub(crate) f_lambda: [Vec<f64>; 2],
    /// Multiplier of the coarse equality, for the methods that carry one.
    pub(crate) multiplier: [Vec<f64>; 2],
    /// Tangential displacements of the last step and the one before, without elastic slip, m, one a tangential row; at
    /// points that ties reach with the ties fulfilled exactly.
    pub(crate) trace: [Vec<f64>; 2],
    /// Slip rate at each contact point, m/s; only if the coefficient depends on it.
    pub(crate) rate: Vec<f64>,
    /// Points that slid at the last step.
    pub(crate) sliding: Vec<bool>,
    /// What chooses the tolerance of the next step by estimates of the error.
    pub(crate) controller: Controller,
    /// Largest sizes of each body at the steps so far.
    pub(crate) peaks: Vec<Peak>,
    /// With history: the first step that did not converge.
    pub(crate) unconverged: Option<usize>,
    /// What tells the loads of the last step from others; 0 if none acted.
    pub(crate) loads: u64,
    /// How often a step was halved to get the last increment.
    pub(crate) halved: u32,
    /// Products beyond those of easy solves.
    pub(crate) effort: usize,
    /// The shortest step of conjugate gradients in the last solve; 0 if there was none.
    pub(crate) shortest_step: f64,
    /// Motions of couplings at the last step, along their axes.
    pub(crate) motions: Vec<[f64; 6]>,
    /// Displacements of all nodes at the last step, m; empty where neither supports nor contacts start or end later, and
    /// nothing slides or supports hold all bodies.
    pub(crate) displacement: Vec<f64>,
    /// The stage whose rows and points its numbers belong to.
    pub(crate) stage: Stage,
    /// What its numbers refer to; `None` if that is not to be compared.
    pub(crate) origin: Option<Fingerprint>,
    /// Of each product what it was made from and came to be, see [`seal`].
    pub(crate) seals: [u64; 2],
}

/// Largest sizes of a body at earlier steps: what a step where forces and displacements vanish is measured against.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Peak {
    /// Norm of the multipliers, N.
    pub(crate) multipliers: f64,
    /// Contact force at a node, N.
    pub(crate) force: f64,
    /// Displacement, m.
    pub(crate) displacement: f64,
}

impl Peak {
    /// The larger of both, one by one.
    pub(super) fn or(self, other: Self) -> Self {
        Self {
            multipliers: self.multipliers.max(other.multipliers),
            force: self.force.max(other.force),
            displacement: self.displacement.max(other.displacement),
        }
    }
}

/// Why a state is refused that is damaged so.
pub(crate) const NOT_FINITE: &str = "it contains NaN or infinity; use an earlier checkpoint or start anew";

impl State {
    /// Steps solved so far.
    pub fn step(&self) -> usize {
        self.step
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        8 * self.numbers().map(Vec::len).sum::<usize>() + self.sliding.len()
    }

    /// The same state for a different scene: [`Simulation::resume`](crate::Simulation::resume) then compares sizes
    /// only. Multipliers serve as start values; tangential displacements and slip rates are assigned to the points with
    /// the same numbers.
    pub fn without_origin(mut self) -> Self {
        (self.origin, self.effort, self.shortest_step) = (None, 0, 0.0);
        self
    }

    /// Hands multipliers and their products to `renew` where they are not those that were stored with this F.
    pub(crate) fn renew_products(&mut self, operator: u64, mut renew: impl FnMut(&[f64], &mut Vec<f64>)) {
        for k in 0..2 {
            let (lambda, f_lambda) = (&self.lambda[k], &mut self.f_lambda[k]);
            if !f_lambda.is_empty() && self.seals[k] != seal(operator, lambda, f_lambda) {
                renew(lambda, f_lambda);
                self.seals[k] = seal(operator, lambda, f_lambda);
            }
        }
    }

    /// The first step, from 0, that did not converge and on whose displacement later steps depend. `None` if all
    /// converged, and in scenes without history (no friction, nothing that starts or is locked later, or static), whose
    /// steps are independent.
    pub fn unconverged_history(&self) -> Option<usize> {
        self.unconverged
    }

    /// Notes that the step that comes next did not converge, although later ones depend on it.
    pub(crate) fn note_unconverged(&mut self) {
        self.unconverged = self.unconverged.or(Some(self.step));
    }

    /// Last and older trace of a tangential row; zero before the start.
    pub(crate) fn traces(&self, k: usize) -> (f64, f64) {
        let get = |v: &Vec<f64>| v.get(k).copied().unwrap_or(0.0);
        (get(&self.trace[0]), get(&self.trace[1]))
    }

    /// Takes over the multipliers of a step, their products with this F, and the multiplier of the coarse equality.
    /// Returns the multipliers and products that are not needed any more, for their memory.
    pub(crate) fn push(
        &mut self,
        keep_before: bool,
        operator: u64,
        [lambda, f_lambda, multiplier]: [Vec<f64>; 3],
    ) -> [Vec<f64>; 2] {
        let push = |pair: &mut [Vec<f64>; 2], new: Vec<f64>| {
            pair.swap(0, 1);
            let old = std::mem::replace(&mut pair[0], new);
            if keep_before { old } else { std::mem::take(&mut pair[1]) }
        };
        let old = [push(&mut self.lambda, lambda), push(&mut self.f_lambda, f_lambda)];
        push(&mut self.multiplier, multiplier);
        self.seals = [seal(operator, &self.lambda[0], &self.f_lambda[0]), self.seals[0]];
        old
    }

    /// Takes over tangential displacements. The old ones are part of the model, not of the extrapolation.
    pub(crate) fn push_trace(&mut self, new: Vec<f64>) {
        self.trace.swap(0, 1);
        self.trace[0] = new;
    }

    /// Counts the step that ends at this time.
    pub(crate) fn pass(&mut self, time: f64) {
        self.step += 1;
        if let Some(origin) = &mut self.origin {
            origin.pass(time);
        }
    }

    /// Takes the sizes of a step into account, one a body.
    pub(crate) fn raise(&mut self, sizes: &[Peak]) {
        self.peaks.resize(sizes.len(), Peak::default());
        for (peak, size) in self.peaks.iter_mut().zip(sizes) {
            *peak = peak.or(*size);
        }
    }

    /// Checks that the state fits a model of these sizes.
    pub(crate) fn fits(
        &self,
        rows: usize,
        coarse: usize,
        tangential: usize,
        points: usize,
    ) -> Result<(), ContactError> {
        let refuse = |reason: String| Err(ContactError::Checkpoint { reason });
        let fit = |length: usize, n: usize| length == 0 || length == n;
        let pairs = |v: &[Vec<f64>; 2], n: usize| v.iter().all(|v| fit(v.len(), n));
        // what is most telling first
        let parts = [
            (
                "contact points",
                fit(self.rate.len(), points) && fit(self.sliding.len(), points),
            ),
            (
                "directions with friction (a coefficient that is zero everywhere is no friction)",
                pairs(&self.trace, tangential),
            ),
            (
                "rows (gluing, supports, contact)",
                pairs(&self.lambda, rows) && pairs(&self.f_lambda, rows),
            ),
            ("rigid motions of subdomains", pairs(&self.multiplier, coarse)),
        ];
        if let Some((part, _)) = parts.iter().find(|(_, good)| !good) {
            return refuse(format!(
                "it belongs to another scene, with another number of {part}; continue with the scene that it was stored with"
            ));
        }
        let sizes = self.peaks.iter().flat_map(|p| [p.multipliers, p.force, p.displacement]);
        let mut sizes = sizes.chain(self.controller.numbers()).chain([self.shortest_step]);
        let damage = if self.halved > MOST_HALVINGS {
            "it says that a step was halved more often than it can be"
        } else if !self.is_finite() {
            return refuse(NOT_FINITE.to_owned());
        } else if self.stage.first > self.step {
            "it says that it belongs to steps that it has not reached"
        } else if self.unconverged.is_some_and(|k| k >= self.step) {
            "it says that a step did not converge that it has not solved"
        } else if !sizes.all(|v| v.is_finite() && v >= 0.0) {
            "an error, a tolerance or a size of earlier steps in it is negative, NaN or infinite"
        } else {
            return Ok(());
        };
        refuse(format!("{damage}; use an earlier checkpoint or start anew"))
    }

    /// Whether all that is stored at nodes, rows and couplings are numbers.
    pub(crate) fn is_finite(&self) -> bool {
        self.numbers().flatten().chain(self.moved()).all(|v| v.is_finite())
    }

    /// What it says of couplings, and of nodes that supports hold where they were left.
    fn moved(&self) -> impl Iterator<Item = &f64> {
        let locked = self.stage.locked.iter().flatten().flatten();
        let left = self.stage.left.iter().flatten().flatten();
        self.motions.iter().flatten().chain(locked).chain(left)
    }

    /// All vectors of numbers.
    fn numbers(&self) -> impl Iterator<Item = &Vec<f64>> {
        let pairs = [&self.lambda, &self.f_lambda, &self.multiplier, &self.trace];
        pairs.into_iter().flatten().chain([&self.rate, &self.displacement])
    }
}

/// How far it is and how large; not its numbers.
impl std::fmt::Debug for State {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("State")
            .field("step", &self.step)
            .field("memory", &self.memory())
            .field("unconverged_history", &self.unconverged)
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) fn state() -> State {
        let mut state = State::default();
        state.push(true, 0, [vec![1.0 / 3.0, -2.0], vec![0.1, 0.2], Vec::new()]);
        state.push_trace(vec![1e-300]);
        state.sliding = vec![true];
        state.pass(0.0);
        state
    }

    #[test]
    fn the_first_step_that_did_not_converge_is_kept() {
        let mut state = state();
        assert_eq!(state.unconverged_history(), None);
        state.note_unconverged();
        for _ in 0..2 {
            state.pass(0.0);
            state.note_unconverged();
        }
        assert_eq!((state.step(), state.unconverged_history()), (3, Some(1)));
    }

    #[test]
    fn sizes_and_numbers_are_checked() {
        let mut state = state();
        assert!(state.fits(2, 6, 1, 1).is_ok());
        for (sizes, part) in [
            ([3, 6, 1, 1], "rows"),
            ([2, 6, 2, 1], "directions with friction"),
            ([2, 6, 1, 2], "contact points"),
        ] {
            let [rows, coarse, tangential, points] = sizes;
            let error = state.fits(rows, coarse, tangential, points).unwrap_err();
            assert!(error.to_string().contains(part), "{error}");
        }
        assert!(format!("{state:?}").starts_with("State { step: 1, memory: "));
        for bad in [-1.0, f64::NAN, f64::INFINITY] {
            let mut other = state.clone();
            other.peaks = vec![Peak {
                displacement: bad,
                ..Peak::default()
            }];
            assert!(other.fits(2, 6, 1, 1).is_err(), "peak {bad}");
            let mut other = state.clone();
            other.controller.discretisation.relative = bad;
            assert!(other.fits(2, 6, 1, 1).is_err(), "controller {bad}");
            let mut other = state.clone();
            other.shortest_step = bad;
            assert!(other.fits(2, 6, 1, 1).is_err(), "shortest step {bad}");
        }
        let mut other = state.clone();
        other.halved = 21;
        assert!(other.fits(2, 6, 1, 1).is_err(), "halved");
        let mut other = state.clone();
        other.note_unconverged();
        assert!(other.fits(2, 6, 1, 1).is_err(), "a level to come");
        state.push(true, 0, [vec![f64::NAN, 0.0], vec![0.0; 2], Vec::new()]);
        assert!(state.fits(2, 6, 1, 1).is_err());
    }
}
