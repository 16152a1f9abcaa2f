//! The state between time levels: one value, with feature `checkpoint` also as bytes.

use super::fingerprint::{Fingerprint, seal};
use super::tolerance::Controller;
use crate::error::ContactError;

/// What one level hands to the next.
///
/// A simulation that starts from a stored state continues bit by bit like one that was never interrupted.
#[derive(Clone, PartialEq, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct State {
    /// Levels solved.
    pub(super) level: usize,
    /// Multipliers of the last level and the one before.
    pub(super) lambda: [Vec<f64>; 2],
    /// `F lambda` of the same.
    pub(super) f_lambda: [Vec<f64>; 2],
    /// Multiplier of the coarse equality, for the methods that carry one.
    pub(super) multiplier: [Vec<f64>; 2],
    /// Tangential displacements of the last level and the one before, m, one a tangential row.
    pub(super) trace: [Vec<f64>; 2],
    /// Slip rate at each touch point, m/s; only if the coefficient depends on it.
    pub(super) rate: Vec<f64>,
    /// Points that slid at the last level.
    pub(super) sliding: Vec<bool>,
    /// What chooses the tolerance of the next level by estimates of the error.
    pub(super) controller: Controller,
    /// Largest sizes of each body at the levels so far.
    pub(super) peaks: Vec<Peak>,
    /// With history: the first level that did not converge.
    pub(super) unconverged: Option<usize>,
    /// What its numbers refer to; `None` if that is not to be compared.
    pub(super) origin: Option<Fingerprint>,
    /// Of each product what it was made from and came to be, see [`seal`].
    pub(super) seals: [u64; 2],
}

/// Largest sizes of a body at earlier levels: what a level where forces and displacements vanish is measured against.
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
    fn or(self, other: Self) -> Self {
        Self {
            multipliers: self.multipliers.max(other.multipliers),
            force: self.force.max(other.force),
            displacement: self.displacement.max(other.displacement),
        }
    }
}

impl State {
    /// Levels solved so far.
    #[must_use]
    pub fn step(&self) -> usize {
        self.level
    }

    /// Bytes held.
    #[must_use]
    pub fn memory(&self) -> usize {
        let pairs = [&self.lambda, &self.f_lambda, &self.multiplier, &self.trace];
        let numbers: usize = pairs
            .iter()
            .flat_map(|p| p.iter())
            .map(Vec::len)
            .sum::<usize>()
            + self.rate.len();
        8 * numbers + self.sliding.len()
    }

    /// The same state as the start of another sequence of levels, without what extrapolation needs: the distance
    /// between levels is another one there.
    pub(crate) fn rebased(&self, level: usize) -> Self {
        let mut state = self.clone();
        state.level = level;
        state.origin = None;
        // a level here ends where its last part does there
        let parts = level.checked_div(self.level).unwrap_or(1);
        state.unconverged = self.unconverged.map(|k| (k + 1) * parts - 1);
        for pair in [
            &mut state.lambda,
            &mut state.f_lambda,
            &mut state.multiplier,
        ] {
            pair[1] = Vec::new();
        }
        state
    }

    /// The same state for a scene that is another one on purpose: [`Simulation::resume`](crate::Simulation::resume) then compares
    /// sizes only. Multipliers are start values there; tangential displacements and slip rates are taken for those of the
    /// points with the same numbers.
    #[must_use]
    pub fn without_origin(mut self) -> Self {
        self.origin = None;
        self
    }

    /// What its numbers refer to.
    pub(crate) fn origin(&self) -> Option<Fingerprint> {
        self.origin
    }

    /// Notes what its numbers refer to.
    pub(crate) fn set_origin(&mut self, origin: Fingerprint) {
        self.origin = Some(origin);
    }

    /// Notes that the product of the last level is one with this F.
    pub(crate) fn seal(&mut self, operator: u64) {
        self.seals[0] = seal(operator, &self.lambda[0], &self.f_lambda[0]);
    }

    /// Hands multipliers and their products to `renew` where they are not those that were stored with this F.
    pub(crate) fn renew_products(
        &mut self,
        operator: u64,
        mut renew: impl FnMut(&[f64], &mut Vec<f64>),
    ) {
        for k in 0..2 {
            let (lambda, f_lambda) = (&self.lambda[k], &mut self.f_lambda[k]);
            if !f_lambda.is_empty() && self.seals[k] != seal(operator, lambda, f_lambda) {
                renew(lambda, f_lambda);
                self.seals[k] = seal(operator, lambda, f_lambda);
            }
        }
    }

    /// Notes the time of the level that is being taken over.
    pub(crate) fn pass(&mut self, time: f64) {
        if let Some(origin) = &mut self.origin {
            origin.pass(time);
        }
    }

    /// The first level that did not converge and on whose displacement later levels depend, from 0. `None` where all
    /// converged, and in scenes without history (no friction, or static), whose levels stand alone.
    #[must_use]
    pub fn unconverged_history(&self) -> Option<usize> {
        self.unconverged
    }

    /// Notes that the level that comes next did not converge, although later ones depend on it.
    pub(crate) fn note_unconverged(&mut self) {
        self.unconverged = self.unconverged.or(Some(self.level));
    }

    /// What chooses tolerances by estimates.
    pub(crate) fn controller(&self) -> Controller {
        self.controller
    }

    /// Notes it.
    pub(crate) fn set_controller(&mut self, controller: Controller) {
        self.controller = controller;
    }

    pub(crate) fn lambda(&self) -> &[Vec<f64>; 2] {
        &self.lambda
    }

    pub(crate) fn f_lambda(&self) -> &[Vec<f64>; 2] {
        &self.f_lambda
    }

    pub(crate) fn multiplier(&self) -> &[Vec<f64>; 2] {
        &self.multiplier
    }

    /// Last and older trace of a tangential row; zero before the start.
    pub(crate) fn traces(&self, k: usize) -> (f64, f64) {
        let get = |v: &Vec<f64>| v.get(k).copied().unwrap_or(0.0);
        (get(&self.trace[0]), get(&self.trace[1]))
    }

    pub(crate) fn rates(&self) -> &[f64] {
        &self.rate
    }

    pub(crate) fn sliding(&self) -> &[bool] {
        &self.sliding
    }

    /// Takes over the result of a level. Vectors that the scene does not need are empty.
    pub(crate) fn advance(
        &mut self,
        keep_before: bool,
        lambda: Vec<f64>,
        f_lambda: Vec<f64>,
        multiplier: Vec<f64>,
        trace: Vec<f64>,
        rate: Vec<f64>,
        sliding: Vec<bool>,
    ) {
        let push = |pair: &mut [Vec<f64>; 2], new: Vec<f64>| {
            pair.swap(0, 1);
            pair[0] = new;
            if !keep_before {
                pair[1] = Vec::new();
            }
        };
        push(&mut self.lambda, lambda);
        push(&mut self.f_lambda, f_lambda);
        push(&mut self.multiplier, multiplier);
        self.seals.swap(0, 1);
        // old tangential displacements are part of the model, not of the extrapolation
        self.trace.swap(0, 1);
        self.trace[0] = trace;
        self.rate = rate;
        self.sliding = sliding;
        self.level += 1;
    }

    /// Largest sizes of each body at the levels so far; empty before the first.
    pub(crate) fn peaks(&self) -> &[Peak] {
        &self.peaks
    }

    /// Takes the sizes of a level into account, one a body.
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
        let fit = |v: &Vec<f64>, n: usize| v.is_empty() || v.len() == n;
        let pairs = |v: &[Vec<f64>; 2], n: usize| v.iter().all(|v| fit(v, n));
        let flags = self.sliding.is_empty() || self.sliding.len() == points;
        // what is most telling first
        let parts = [
            ("number of contact points", fit(&self.rate, points) && flags),
            (
                "number of directions with friction (a coefficient that is zero everywhere is no friction)",
                pairs(&self.trace, tangential),
            ),
            (
                "number of rows (gluing, supports, contact)",
                pairs(&self.lambda, rows) && pairs(&self.f_lambda, rows),
            ),
            (
                "number of rigid motions of subdomains",
                pairs(&self.multiplier, coarse),
            ),
        ];
        let numbers = [&self.lambda, &self.f_lambda, &self.multiplier, &self.trace];
        let finite = numbers
            .iter()
            .flat_map(|p| p.iter())
            .chain([&self.rate])
            .flatten()
            .all(|v| v.is_finite());
        if let Some((part, _)) = parts.iter().find(|(_, good)| !good) {
            return Err(ContactError::Checkpoint {
                reason: format!(
                    "it belongs to another scene, with another {part}; continue with the scene that it was stored with"
                ),
            });
        }
        if !finite {
            return Err(ContactError::Checkpoint {
                reason: "it contains NaN or infinity; use an earlier checkpoint or start anew"
                    .to_owned(),
            });
        }
        if self.unconverged.is_some_and(|k| k >= self.level) {
            return Err(ContactError::Checkpoint {
                reason: "it says that a level did not converge that it has not solved; use an earlier checkpoint or \
                         start anew"
                    .to_owned(),
            });
        }
        let peaks = self.peaks.iter();
        let sizes = peaks.flat_map(|p| [p.multipliers, p.force, p.displacement]);
        let mut sizes = sizes.chain(self.controller.numbers());
        if !sizes.all(|v| v.is_finite() && v >= 0.0) {
            return Err(ContactError::Checkpoint {
                reason: "an error, a tolerance or a size of earlier levels in it is negative, NaN or infinite; use an \
                         earlier checkpoint or start anew"
                    .to_owned(),
            });
        }
        Ok(())
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) fn state() -> State {
        let mut state = State::default();
        state.advance(
            true,
            vec![1.0 / 3.0, -2.0],
            vec![0.1, 0.2],
            vec![],
            vec![1e-300],
            vec![],
            vec![true],
        );
        state
    }

    #[test]
    fn the_first_level_that_did_not_converge_is_kept() {
        let mut state = state();
        assert_eq!(state.unconverged_history(), None);
        state.note_unconverged();
        for _ in 0..2 {
            let empty = || (vec![], vec![], vec![], vec![], vec![]);
            let (a, b, c, d, e) = empty();
            state.advance(true, a, b, c, d, e, vec![]);
            state.note_unconverged();
        }
        assert_eq!((state.step(), state.unconverged_history()), (3, Some(1)));
        // level 1 in whole steps ends where level 3 in half steps does
        assert_eq!(state.rebased(6).unconverged_history(), Some(3));
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
        assert!(format!("{state:?}").starts_with("State { level: 1, bytes: "));
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
        }
        let mut other = state.clone();
        other.note_unconverged();
        assert!(other.fits(2, 6, 1, 1).is_err(), "a level to come");
        state.advance(
            true,
            vec![f64::NAN, 0.0],
            vec![0.0; 2],
            vec![],
            vec![0.0],
            vec![],
            vec![false],
        );
        assert!(state.fits(2, 6, 1, 1).is_err());
    }
}
