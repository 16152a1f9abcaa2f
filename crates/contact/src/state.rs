//! The state between time levels: one value, with feature `checkpoint` also as bytes.

use crate::accuracy::Controller;
use crate::error::ContactError;

/// What one level hands to the next.
///
/// A simulation that starts from a stored state continues bit by bit like one that was never interrupted.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct State {
    /// Levels solved.
    level: usize,
    /// Multipliers of the last level and the one before.
    lambda: [Vec<f64>; 2],
    /// `F lambda` of the same.
    f_lambda: [Vec<f64>; 2],
    /// Multiplier of the coarse equality, for the methods that carry one.
    multiplier: [Vec<f64>; 2],
    /// Tangential displacements of the last level and the one before, m, one a tangential row.
    trace: [Vec<f64>; 2],
    /// Slip rate at each touch point, m/s; only if the coefficient depends on it.
    rate: Vec<f64>,
    /// Points that slid at the last level.
    sliding: Vec<bool>,
    /// With screening: points whose rows were in the dual problem at the last level.
    active: Vec<bool>,
    /// With screening: gaps of all points at the last level and the one before, m.
    gaps: [Vec<f64>; 2],
    /// What chooses the tolerance of the next level by estimates of the error.
    controller: Controller,
    /// Largest sizes of each body at the levels so far.
    peaks: Vec<Peak>,
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

/// Part of the earlier sizes that a vanishing quantity is measured against.
pub(crate) const REST: f64 = 1e-3;

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

/// Marks the format of stored states.
#[cfg(feature = "checkpoint")]
const MAGIC: u32 = 0x5349_4707;

/// FNV-1a of 64 bits: any one changed byte changes it.
#[cfg(feature = "checkpoint")]
fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

impl State {
    /// Levels solved so far.
    #[must_use]
    pub fn level(&self) -> usize {
        self.level
    }

    /// Bytes held.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let pairs = [
            &self.lambda,
            &self.f_lambda,
            &self.multiplier,
            &self.trace,
            &self.gaps,
        ];
        let numbers: usize = pairs
            .iter()
            .flat_map(|p| p.iter())
            .map(Vec::len)
            .sum::<usize>()
            + self.rate.len();
        8 * numbers + self.sliding.len() + self.active.len()
    }

    /// Writes the state as bytes (feature `checkpoint`): a number for the format (4 bytes) and a checksum of the rest (8 bytes,
    /// FNV-1a), both little-endian, then the state in the encoding of postcard.
    ///
    /// # Errors
    /// [`ContactError::Checkpoint`] if the encoder fails.
    #[cfg(feature = "checkpoint")]
    pub fn to_bytes(&self) -> Result<Vec<u8>, ContactError> {
        let payload = postcard::to_stdvec(self).map_err(|e| ContactError::Checkpoint {
            reason: format!("the state cannot be encoded ({e})"),
        })?;
        let mut bytes = MAGIC.to_le_bytes().to_vec();
        bytes.extend(checksum(&payload).to_le_bytes());
        bytes.extend(payload);
        Ok(bytes)
    }

    /// Reads what [`to_bytes`](Self::to_bytes) wrote (feature `checkpoint`). The checksum finds damage by chance; it is no
    /// protection against bytes made on purpose.
    ///
    /// # Errors
    /// [`ContactError::Checkpoint`] if the bytes are of another format, cut, changed, or followed by others.
    #[cfg(feature = "checkpoint")]
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ContactError> {
        let error = |reason: String| ContactError::Checkpoint { reason };
        let damaged = |how: &str| {
            error(format!(
                "the bytes are damaged ({how}); use an earlier checkpoint or start anew"
            ))
        };
        let (magic, rest) = bytes.split_first_chunk().ok_or_else(|| damaged("cut"))?;
        if u32::from_le_bytes(*magic) != MAGIC {
            return Err(error(
                "another format or version; read it with the version that wrote it, or start anew"
                    .to_owned(),
            ));
        }
        let (sum, payload) = rest.split_first_chunk().ok_or_else(|| damaged("cut"))?;
        if u64::from_le_bytes(*sum) != checksum(payload) {
            return Err(damaged("their checksum differs"));
        }
        let (state, rest) =
            postcard::take_from_bytes(payload).map_err(|e| damaged(&e.to_string()))?;
        if rest.is_empty() {
            Ok(state)
        } else {
            Err(damaged("more follows the state"))
        }
    }

    /// The same state as the start of another sequence of levels, without what extrapolation needs: the distance
    /// between levels is another one there.
    pub(crate) fn rebased(&self, level: usize) -> Self {
        let mut state = self.clone();
        state.level = level;
        for pair in [
            &mut state.lambda,
            &mut state.f_lambda,
            &mut state.multiplier,
            &mut state.gaps,
        ] {
            pair[1] = Vec::new();
        }
        state
    }

    /// With screening, which points were in the dual problem at the last level; empty without.
    pub(crate) fn active(&self) -> &[bool] {
        &self.active
    }

    /// Notes which points were in the dual problem at the last level. Products of the level before belong to other rows
    /// if others were.
    pub(crate) fn set_active(&mut self, active: &[bool]) {
        if self.active != active {
            self.f_lambda[1] = Vec::new();
            self.multiplier[1] = Vec::new();
            self.active = active.to_vec();
        }
    }

    /// Forgets what holds for one set of rows only: `F lambda` and the multiplier of the coarse equality.
    pub(crate) fn forget_products(&mut self) {
        self.f_lambda = Default::default();
        self.multiplier = Default::default();
    }

    /// The state on a part of the rows, tangential rows and points.
    pub(crate) fn part(
        &self,
        rows: impl Fn(&[f64]) -> Vec<f64>,
        tangential: &[usize],
        points: &[usize],
    ) -> Self {
        let pair = |v: &[Vec<f64>; 2]| [rows(&v[0]), rows(&v[1])];
        Self {
            level: self.level,
            lambda: pair(&self.lambda),
            f_lambda: pair(&self.f_lambda),
            multiplier: self.multiplier.clone(),
            trace: [
                pick(&self.trace[0], tangential),
                pick(&self.trace[1], tangential),
            ],
            rate: pick(&self.rate, points),
            sliding: pick(&self.sliding, points),
            active: Vec::new(),
            gaps: Default::default(),
            controller: self.controller,
            peaks: self.peaks.clone(),
        }
    }

    /// With screening: gaps of all points at the last level and the one before; empty where they are not known.
    pub(crate) fn gaps(&self) -> &[Vec<f64>; 2] {
        &self.gaps
    }

    /// Notes the gaps of the last level.
    pub(crate) fn push_gaps(&mut self, gaps: Vec<f64>) {
        self.gaps.swap(0, 1);
        self.gaps[0] = gaps;
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

    /// Multipliers and their products, to be checked.
    pub(crate) fn products_mut(&mut self) -> impl Iterator<Item = (&Vec<f64>, &mut Vec<f64>)> {
        self.lambda.iter().zip(&mut self.f_lambda)
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
        let good = self
            .lambda
            .iter()
            .chain(&self.f_lambda)
            .all(|v| fit(v, rows))
            && self.multiplier.iter().all(|v| fit(v, coarse))
            && self.trace.iter().all(|v| fit(v, tangential))
            && fit(&self.rate, points)
            && (self.sliding.is_empty() || self.sliding.len() == points)
            && self.gaps.iter().all(|v| fit(v, points))
            && (self.active.is_empty() || self.active.len() == points);
        let numbers = [
            &self.lambda,
            &self.f_lambda,
            &self.multiplier,
            &self.trace,
            &self.gaps,
        ];
        let finite = numbers
            .iter()
            .flat_map(|p| p.iter())
            .chain([&self.rate])
            .flatten()
            .all(|v| v.is_finite());
        if !good {
            return Err(ContactError::Checkpoint {
                reason: "it belongs to another scene: sizes differ".to_owned(),
            });
        }
        if !finite {
            return Err(ContactError::Checkpoint {
                reason: "it contains NaN or infinity".to_owned(),
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

fn pick<T: Copy>(all: &[T], places: &[usize]) -> Vec<T> {
    if all.is_empty() {
        return Vec::new();
    }
    places.iter().map(|&k| all[k]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state() -> State {
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

    #[cfg(feature = "checkpoint")]
    #[test]
    fn bytes_round_trip_and_damage_is_noticed() {
        let state = state();
        let bytes = state.to_bytes().unwrap();
        assert_eq!(State::from_bytes(&bytes).unwrap(), state);
        assert!(matches!(
            State::from_bytes(&bytes[..bytes.len() - 1]),
            Err(ContactError::Checkpoint { .. })
        ));
        assert!(State::from_bytes(&[0; 40]).is_err());
        for at in 0..8 * bytes.len() {
            let mut damaged = bytes.clone();
            damaged[at / 8] ^= 1 << (at % 8);
            assert!(State::from_bytes(&damaged).is_err(), "bit {at}");
        }
        // bytes behind it, first as they are, then with the checksum that belongs to them
        let mut longer = bytes.clone();
        longer.push(0);
        let text = |bytes: &[u8]| State::from_bytes(bytes).unwrap_err().to_string();
        assert!(text(&longer).contains("checksum"));
        let sum = checksum(&longer[12..]);
        longer[4..12].copy_from_slice(&sum.to_le_bytes());
        assert!(text(&longer).contains("more follows"));
    }

    #[cfg(feature = "checkpoint")]
    #[test]
    fn the_checksum_is_fnv_1a() {
        // published values
        assert_eq!(checksum(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(checksum(b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(checksum(b"foobar"), 0x8594_4171_f739_67e8);
    }

    #[test]
    fn sizes_and_numbers_are_checked() {
        let mut state = state();
        assert!(state.fits(2, 6, 1, 1).is_ok());
        assert!(state.fits(3, 6, 1, 1).is_err());
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
