//! Products of free components, bounded components and discs.
//!
//! Another kind of block is another [`Segment`], its arm in [`walk`] and [`for_constrained`], and its formulas in
//! [`block`](super::block).

use std::mem::Discriminant;
use std::ops::Range;

use crate::error::SetError;
use crate::vector;

use super::block::{Disc, Interval, Shape};
use super::set::{Block, BlockState, ConvexSet, GradientNorms};

/// A run of blocks of one kind.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Segment {
    /// That many unconstrained components.
    Free(usize),
    /// `lower <= x <= upper`, component by component; infinite bounds are allowed, equal bounds fix the
    /// component.
    Bounds {
        /// Lower bounds, `-inf` for none.
        lower: Vec<f64>,
        /// Upper bounds, `+inf` for none.
        upper: Vec<f64>,
    },
    /// Discs `|(x[2i], x[2i+1])| <= radii[i]`: two interleaved components a disc. Radius 0 fixes the pair
    /// at the origin, `+inf` frees it.
    Discs {
        /// Radii, one for each pair of components.
        radii: Vec<f64>,
    },
}

impl Segment {
    /// Components with lower bounds only.
    #[must_use]
    pub fn lower(lower: Vec<f64>) -> Self {
        let upper = vec![f64::INFINITY; lower.len()];
        Self::Bounds { lower, upper }
    }

    /// Components with upper bounds only.
    #[must_use]
    pub fn upper(upper: Vec<f64>) -> Self {
        let lower = vec![f64::NEG_INFINITY; upper.len()];
        Self::Bounds { lower, upper }
    }

    /// Components with both bounds.
    #[must_use]
    pub fn bounds(lower: Vec<f64>, upper: Vec<f64>) -> Self {
        Self::Bounds { lower, upper }
    }

    /// Discs with the given radii.
    #[must_use]
    pub fn discs(radii: Vec<f64>) -> Self {
        Self::Discs { radii }
    }

    /// Number of components.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Free(n) => *n,
            Self::Bounds { lower, .. } => lower.len(),
            Self::Discs { radii } => 2 * radii.len(),
        }
    }

    /// Whether the segment has no component.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn validate(&self, segment: usize) -> Result<(), SetError> {
        match self {
            Self::Free(_) => Ok(()),
            Self::Bounds { lower, upper } => {
                if lower.len() != upper.len() {
                    return Err(SetError::Lengths {
                        segment,
                        lower: lower.len(),
                        upper: upper.len(),
                    });
                }
                for (entry, (&lo, &hi)) in lower.iter().zip(upper).enumerate() {
                    let in_order = lo <= hi && lo < f64::INFINITY && hi > f64::NEG_INFINITY;
                    if !in_order {
                        return Err(SetError::Bounds {
                            segment,
                            entry,
                            lower: lo,
                            upper: hi,
                        });
                    }
                }
                Ok(())
            }
            Self::Discs { radii } => match radii.iter().position(|r| r.is_nan() || *r < 0.0) {
                Some(entry) => Err(SetError::Radius {
                    segment,
                    entry,
                    radius: radii[entry],
                }),
                None => Ok(()),
            },
        }
    }
}

/// An ordered product of [`Segment`]s.
///
/// ```
/// use signorini_qp::{ConvexSet, ProductSet, Segment};
/// use signorini_qp::problem::BlockState;
///
/// // one component below 0, one disc of radius 2, three free components
/// let set = ProductSet::new(vec![Segment::upper(vec![0.0]), Segment::discs(vec![2.0]), Segment::Free(3)])?;
/// let mut x = vec![1.0, 3.0, 4.0, 7.0, 8.0, 9.0];
/// assert!((set.violation(&x) - 10.0_f64.sqrt()).abs() < 1e-14);
/// set.project(&mut x);
/// assert_eq!(x[0], 0.0);
/// assert!((x[1] - 1.2).abs() < 1e-14 && (x[2] - 1.6).abs() < 1e-14);
/// let mut states = Vec::new();
/// set.for_each_block(&x, &mut |block| states.push(block.state));
/// assert_eq!(states, [BlockState::AtUpper, BlockState::Boundary, BlockState::Free]);
/// # Ok::<(), signorini_qp::SetError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ProductSet {
    segments: Vec<Segment>,
    offsets: Vec<usize>,
}

impl ProductSet {
    /// A product of the given segments in this order; empty segments are allowed.
    ///
    /// # Errors
    /// [`SetError`] when bounds are out of order or of different lengths, or a radius is negative or NaN.
    pub fn new(segments: Vec<Segment>) -> Result<Self, SetError> {
        let mut offsets = Vec::with_capacity(segments.len() + 1);
        let mut end = 0;
        offsets.push(0);
        for (i, s) in segments.iter().enumerate() {
            s.validate(i)?;
            end = usize::checked_add(end, s.len()).ok_or(SetError::TooLong { segment: i })?;
            offsets.push(end);
        }
        Ok(Self { segments, offsets })
    }

    /// The whole space of `n` components.
    #[must_use]
    pub fn free(n: usize) -> Self {
        Self {
            segments: vec![Segment::Free(n)],
            offsets: vec![0, n],
        }
    }

    /// The segments in order.
    #[must_use]
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// Radii of a segment of discs, to be changed in place (slip bounds). Solvers validate the set again
    /// before they use it.
    ///
    /// # Errors
    /// [`SetError::Kind`] if there is no such segment or it has no discs.
    pub fn radii_mut(&mut self, segment: usize) -> Result<&mut [f64], SetError> {
        match self.segments.get_mut(segment) {
            Some(Segment::Discs { radii }) => Ok(radii),
            _ => Err(SetError::Kind {
                segment,
                wanted: "discs",
            }),
        }
    }

    /// Lower and upper bounds of a segment, to be changed in place.
    ///
    /// # Errors
    /// [`SetError::Kind`] if there is no such segment or it has no bounds.
    pub fn bounds_mut(&mut self, segment: usize) -> Result<(&mut [f64], &mut [f64]), SetError> {
        match self.segments.get_mut(segment) {
            Some(Segment::Bounds { lower, upper }) => Ok((lower, upper)),
            _ => Err(SetError::Kind {
                segment,
                wanted: "bounds",
            }),
        }
    }

    /// Components up to the last constrained one.
    pub(crate) fn constrained(&self) -> usize {
        let constrained =
            |(segment, range): (&Segment, Range<usize>)| (!matches!(segment, Segment::Free(_))).then_some(range.end);
        self.parts().filter_map(constrained).last().unwrap_or(0)
    }

    /// Kind and length of each segment.
    pub(crate) fn shape(&self) -> impl Iterator<Item = (Discriminant<Segment>, usize)> {
        self.segments.iter().map(|s| (std::mem::discriminant(s), s.len()))
    }

    fn parts(&self) -> impl Iterator<Item = (&Segment, Range<usize>)> {
        self.segments.iter().zip(self.offsets.windows(2).map(|w| w[0]..w[1]))
    }
}

/// For every segment of a set: `free` on the range of its components if they are unconstrained, else `body` on the
/// shape of each block and its first component.
macro_rules! walk {
    ($set:expr, $range:ident => $free:expr, ($shape:ident, $at:ident) => $body:expr) => {
        for (segment, $range) in $set.parts() {
            match segment {
                Segment::Free(_) => $free,
                Segment::Bounds { lower, upper } => {
                    for (i, (&lower, &upper)) in lower.iter().zip(upper).enumerate() {
                        let ($shape, $at) = (Interval { lower, upper }, $range.start + i);
                        $body
                    }
                }
                Segment::Discs { radii } => {
                    for (i, &radius) in radii.iter().enumerate() {
                        let ($shape, $at) = (Disc { radius }, $range.start + 2 * i);
                        $body
                    }
                }
            }
        }
    };
}

#[inline]
fn get<const N: usize>(x: &[f64], at: usize) -> [f64; N] {
    std::array::from_fn(|k| x[at + k])
}

#[inline]
fn put<const N: usize>(x: &mut [f64], at: usize, v: [f64; N]) {
    x[at..at + N].copy_from_slice(&v);
}

#[inline]
fn dot<const N: usize>(a: [f64; N], b: [f64; N]) -> f64 {
    (1..N).fold(a[0] * b[0], |sum, k| sum + a[k] * b[k])
}

impl ConvexSet for ProductSet {
    fn dim(&self) -> usize {
        self.offsets.last().copied().unwrap_or(0)
    }

    fn validate(&self) -> Result<(), SetError> {
        let mut segments = self.segments.iter().enumerate();
        segments.try_for_each(|(i, s)| s.validate(i))
    }

    fn project(&self, x: &mut [f64]) {
        walk!(self, _range => {}, (shape, at) => put(x, at, shape.project(get(x, at))));
    }

    fn violation(&self, x: &[f64]) -> f64 {
        let mut sum = 0.0;
        walk!(self, _range => {}, (shape, at) => {
            let d = shape.distance(get(x, at));
            sum += d * d;
        });
        sum.sqrt()
    }

    fn feasible_step(&self, x: &[f64], p: &[f64]) -> f64 {
        let mut t = f64::INFINITY;
        walk!(self, _range => {}, (shape, at) => t = t.min(shape.step(get(x, at), get(p, at))));
        t
    }

    fn advance(&self, x: &mut [f64], p: &[f64], t: f64) {
        walk!(
            self,
            range => vector::axpy(-t, &p[range.clone()], &mut x[range]),
            (shape, at) => put(x, at, shape.advance(get(x, at), get(p, at), t))
        );
    }

    fn split(&self, x: &[f64], g: &[f64], step: f64, free: &mut [f64]) -> GradientNorms {
        let mut n = GradientNorms::default();
        walk!(
            self,
            range => {
                let g = &g[range.clone()];
                vector::copy(g, &mut free[range]);
                let gg = vector::dot(g, g);
                n.free += gg;
                n.reduced_free_dot += gg;
                n.reduced_free += gg;
            },
            (shape, at) => {
                let parts = shape.parts(get(x, at), get(g, at), step);
                let (v, w) = (parts.projected, parts.reduced);
                if parts.state.is_free() {
                    put(free, at, v);
                    n.free += dot(v, v);
                    n.reduced_free_dot += dot(v, w);
                    n.reduced_free += dot(w, w);
                } else {
                    put(free, at, v.map(|_| 0.0));
                    n.chopped += dot(v, v);
                    n.reduced_chopped += dot(w, w);
                }
            }
        );
        n
    }

    fn chopped(&self, x: &[f64], g: &[f64], out: &mut [f64]) {
        walk!(
            self,
            range => vector::fill(0.0, &mut out[range]),
            (shape, at) => {
                let parts = shape.parts(get(x, at), get(g, at), 1.0);
                let active = !parts.state.is_free();
                put(out, at, parts.projected.map(|v| if active { v } else { 0.0 }));
            }
        );
    }

    fn for_each_block(&self, x: &[f64], visit: &mut dyn FnMut(Block)) {
        walk!(
            self,
            range => if !range.is_empty() {
                visit(Block { start: range.start, len: range.len(), state: BlockState::Free });
            },
            (shape, at) => {
                let x = get(x, at);
                visit(Block { start: at, len: x.len(), state: shape.state(x) });
            }
        );
    }
}

/// A constrained block of a set: its first component `i`, its number `k` among the blocks of its kind, and its data.
pub(crate) enum Constrained {
    Bound { i: usize, k: usize, lower: f64, upper: f64 },
    Disc { i: usize, k: usize, radius: f64 },
}

/// Hands every constrained block in order to `f`.
pub(crate) fn for_constrained(set: &ProductSet, mut f: impl FnMut(Constrained)) {
    let (mut bounds, mut discs) = (0, 0);
    for (segment, range) in set.parts() {
        match segment {
            Segment::Free(_) => {}
            Segment::Bounds { lower, upper } => {
                for (i, (&lower, &upper)) in range.zip(lower.iter().zip(upper)) {
                    let k = bounds;
                    f(Constrained::Bound { i, k, lower, upper });
                    bounds += 1;
                }
            }
            Segment::Discs { radii } => {
                for (i, &radius) in range.step_by(2).zip(radii) {
                    let k = discs;
                    f(Constrained::Disc { i, k, radius });
                    discs += 1;
                }
            }
        }
    }
}

/// Calls `f(i, k, lower, upper)` for every bounded component.
pub(crate) fn for_bounds(set: &ProductSet, mut f: impl FnMut(usize, usize, f64, f64)) {
    for_constrained(set, |block| {
        if let Constrained::Bound { i, k, lower, upper } = block {
            f(i, k, lower, upper);
        }
    });
}

/// Calls `f(i, k, radius)` for every disc.
pub(crate) fn for_discs(set: &ProductSet, mut f: impl FnMut(usize, usize, f64)) {
    for_constrained(set, |block| {
        if let Constrained::Disc { i, k, radius } = block {
            f(i, k, radius);
        }
    });
}
