//! Products of free components, bounded components and discs.

use crate::block::{
    Parts, bound_advance, bound_parts, bound_state, bound_step, clamp, disc_advance, disc_parts,
    disc_project, disc_state, disc_step,
};
use crate::error::SetError;
use crate::set::{Block, BlockKind, BlockState, ConvexSet, GradientNorms};
use crate::vector;

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
/// use signorini_qp::{BlockState, ConvexSet, ProductSet, Segment};
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

    /// Components of a segment.
    #[must_use]
    pub fn range(&self, segment: usize) -> Option<std::ops::Range<usize>> {
        Some(*self.offsets.get(segment)?..*self.offsets.get(segment + 1)?)
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

    fn parts(&self) -> impl Iterator<Item = (&Segment, std::ops::Range<usize>)> {
        self.segments
            .iter()
            .zip(self.offsets.windows(2).map(|w| w[0]..w[1]))
    }
}

#[inline]
fn pair(x: &[f64], i: usize) -> [f64; 2] {
    [x[2 * i], x[2 * i + 1]]
}

#[inline]
fn put(x: &mut [f64], i: usize, v: [f64; 2]) {
    x[2 * i] = v[0];
    x[2 * i + 1] = v[1];
}

impl ConvexSet for ProductSet {
    fn dim(&self) -> usize {
        self.offsets.last().copied().unwrap_or(0)
    }

    fn validate(&self) -> Result<(), SetError> {
        self.segments
            .iter()
            .enumerate()
            .try_for_each(|(i, s)| s.validate(i))
    }

    fn project(&self, x: &mut [f64]) {
        for (segment, range) in self.parts() {
            let x = &mut x[range];
            match segment {
                Segment::Free(_) => {}
                Segment::Bounds { lower, upper } => {
                    for ((xi, &lo), &hi) in x.iter_mut().zip(lower).zip(upper) {
                        *xi = clamp(*xi, lo, hi);
                    }
                }
                Segment::Discs { radii } => {
                    for (i, &r) in radii.iter().enumerate() {
                        put(x, i, disc_project(pair(x, i), r));
                    }
                }
            }
        }
    }

    fn violation(&self, x: &[f64]) -> f64 {
        let mut sum = 0.0;
        for (segment, range) in self.parts() {
            let x = &x[range];
            match segment {
                Segment::Free(_) => {}
                Segment::Bounds { lower, upper } => {
                    for ((&xi, &lo), &hi) in x.iter().zip(lower).zip(upper) {
                        let d = xi - clamp(xi, lo, hi);
                        sum += d * d;
                    }
                }
                Segment::Discs { radii } => {
                    for (i, &r) in radii.iter().enumerate() {
                        let d = (x[2 * i].hypot(x[2 * i + 1]) - r.max(0.0)).max(0.0);
                        sum += d * d;
                    }
                }
            }
        }
        sum.sqrt()
    }

    fn feasible_step(&self, x: &[f64], p: &[f64]) -> f64 {
        let mut t = f64::INFINITY;
        for (segment, range) in self.parts() {
            let (x, p) = (&x[range.clone()], &p[range]);
            match segment {
                Segment::Free(_) => {}
                Segment::Bounds { lower, upper } => {
                    for i in 0..lower.len() {
                        t = t.min(bound_step(x[i], p[i], lower[i], upper[i]));
                    }
                }
                Segment::Discs { radii } => {
                    for (i, &r) in radii.iter().enumerate() {
                        t = t.min(disc_step(pair(x, i), pair(p, i), r));
                    }
                }
            }
        }
        t
    }

    fn advance(&self, x: &mut [f64], p: &[f64], t: f64) {
        for (segment, range) in self.parts() {
            let (x, p) = (&mut x[range.clone()], &p[range]);
            match segment {
                Segment::Free(_) => vector::axpy(-t, p, x),
                Segment::Bounds { lower, upper } => {
                    for i in 0..lower.len() {
                        x[i] = bound_advance(x[i], p[i], lower[i], upper[i], t);
                    }
                }
                Segment::Discs { radii } => {
                    for (i, &r) in radii.iter().enumerate() {
                        put(x, i, disc_advance(pair(x, i), pair(p, i), r, t));
                    }
                }
            }
        }
    }

    fn split(&self, x: &[f64], g: &[f64], step: f64, free: &mut [f64]) -> GradientNorms {
        let mut n = GradientNorms::default();
        for (segment, range) in self.parts() {
            let (x, g, free) = (&x[range.clone()], &g[range.clone()], &mut free[range]);
            match segment {
                Segment::Free(_) => {
                    vector::copy(g, free);
                    let gg = vector::dot(g, g);
                    n.free += gg;
                    n.reduced_free_dot += gg;
                    n.reduced_free += gg;
                }
                Segment::Bounds { lower, upper } => {
                    for i in 0..lower.len() {
                        let Parts {
                            state,
                            projected,
                            reduced,
                        } = bound_parts(x[i], g[i], lower[i], upper[i], step);
                        if state.is_free() {
                            free[i] = projected;
                            n.free += projected * projected;
                            n.reduced_free_dot += projected * reduced;
                            n.reduced_free += reduced * reduced;
                        } else {
                            free[i] = 0.0;
                            n.chopped += projected * projected;
                            n.reduced_chopped += reduced * reduced;
                        }
                    }
                }
                Segment::Discs { radii } => {
                    for (i, &r) in radii.iter().enumerate() {
                        let Parts {
                            state,
                            projected: v,
                            reduced: w,
                        } = disc_parts(pair(x, i), pair(g, i), r, step);
                        if state.is_free() {
                            put(free, i, v);
                            n.free += v[0] * v[0] + v[1] * v[1];
                            n.reduced_free_dot += v[0] * w[0] + v[1] * w[1];
                            n.reduced_free += w[0] * w[0] + w[1] * w[1];
                        } else {
                            put(free, i, [0.0; 2]);
                            n.chopped += v[0] * v[0] + v[1] * v[1];
                            n.reduced_chopped += w[0] * w[0] + w[1] * w[1];
                        }
                    }
                }
            }
        }
        n
    }

    fn chopped(&self, x: &[f64], g: &[f64], out: &mut [f64]) {
        self.tangential(x, g, out, false);
    }

    fn projected_gradient(&self, x: &[f64], g: &[f64], out: &mut [f64]) {
        self.tangential(x, g, out, true);
    }

    fn for_each_block(&self, x: &[f64], visit: &mut dyn FnMut(Block)) {
        for (segment, range) in self.parts() {
            let (start, x) = (range.start, &x[range]);
            match segment {
                Segment::Free(0) => {}
                Segment::Free(len) => {
                    visit(Block {
                        start,
                        len: *len,
                        kind: BlockKind::Free,
                        state: BlockState::Free,
                    });
                }
                Segment::Bounds { lower, upper } => {
                    for (i, (&lo, &hi)) in lower.iter().zip(upper).enumerate() {
                        let kind = BlockKind::Bounds {
                            lower: lo,
                            upper: hi,
                        };
                        visit(Block {
                            start: start + i,
                            len: 1,
                            kind,
                            state: bound_state(x[i], lo, hi),
                        });
                    }
                }
                Segment::Discs { radii } => {
                    for (i, &r) in radii.iter().enumerate() {
                        let kind = BlockKind::Disc { radius: r };
                        let state = disc_state(pair(x, i), r);
                        visit(Block {
                            start: start + 2 * i,
                            len: 2,
                            kind,
                            state,
                        });
                    }
                }
            }
        }
    }
}

impl ProductSet {
    /// The projected gradient, on free blocks only if asked for.
    fn tangential(&self, x: &[f64], g: &[f64], out: &mut [f64], free_too: bool) {
        for (segment, range) in self.parts() {
            let (x, g, out) = (&x[range.clone()], &g[range.clone()], &mut out[range]);
            match segment {
                Segment::Free(_) if free_too => vector::copy(g, out),
                Segment::Free(_) => vector::fill(0.0, out),
                Segment::Bounds { lower, upper } => {
                    for i in 0..lower.len() {
                        let v = bound_parts(x[i], g[i], lower[i], upper[i], 1.0);
                        out[i] = if free_too || !v.state.is_free() {
                            v.projected
                        } else {
                            0.0
                        };
                    }
                }
                Segment::Discs { radii } => {
                    for (i, &r) in radii.iter().enumerate() {
                        let v = disc_parts(pair(x, i), pair(g, i), r, 1.0);
                        put(
                            out,
                            i,
                            if free_too || !v.state.is_free() {
                                v.projected
                            } else {
                                [0.0; 2]
                            },
                        );
                    }
                }
            }
        }
    }
}
