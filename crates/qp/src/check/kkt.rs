//! An independent check of the optimality conditions.
//!
//! `x` solves `min 1/2 x·Ax - b·x` over `x` in the set with `C x = e` if and only if there is `mu` with
//!
//! - `x` in the set and `C x = e`,
//! - `r = A x - b + Cᵀ mu` in minus the normal cone: `x = P(x - r / s)` for any `s > 0`.
//!
//! The loops here are written out again on purpose: nothing is shared with the solvers but the traits of
//! the operators and the data of the set.

use crate::error::{QpError, expect_finite, expect_lengths};
use crate::problem::{ConstrainedCost, DenseEquality, Equality, ProductSet, QuadraticCost, Segment, SymmetricOperator};
use crate::settings::expect_setting;
use crate::tolerances::{KKT_ON_BOUND, KKT_ON_CIRCLE};

/// Distances from optimality, absolute and relative.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Kkt {
    /// Euclidean distance of `x` from the set.
    pub infeasibility: f64,
    /// `|C x - e|`.
    pub equality: f64,
    /// Distance of `-r` from the normal cone of the set at `x`, with
    /// components nearer to a bound than 1e-10 `|x|` counted as on it.
    pub dual: f64,
    /// `s |x - P(x - r / s)|` with `s` the norm: continuous in `x`, no decision about activity.
    pub stationarity: f64,
    /// Size of the wrong-signed multipliers: how far components on a bound are pushed inward.
    pub sign: f64,
    /// First component of the block with the largest part of `stationarity`.
    pub worst: usize,
    /// `|x|`, for relative figures of the primal distances.
    pub x_norm: f64,
    /// `|b|`, for relative figures of the dual distances.
    pub b_norm: f64,
    /// What primal distances are compared with: the largest of `|x|`, `|P(x)|` and `|e|`.
    pub primal_size: f64,
    /// What dual distances are compared with: `|b|`; for `b = 0` the larger of `|A x|` and `|Cᵀ mu|`, and if these
    /// vanish as well `s |x - P(x)|`.
    pub dual_size: f64,
}

impl Kkt {
    /// The largest of the relative figures: infeasibility and equality over [`primal_size`](Self::primal_size),
    /// stationarity over [`dual_size`](Self::dual_size), all without units. A distance of zero counts as zero. Not a
    /// number if one of them is none.
    #[must_use]
    pub fn relative(&self) -> f64 {
        let over = |v: f64, size: f64| if v == 0.0 { 0.0 } else { v / size };
        // `f64::max` would hide what is not a number
        let worse = |a: f64, b: f64| if b.is_nan() || b > a { b } else { a };
        [
            over(self.equality, self.primal_size),
            over(self.stationarity, self.dual_size),
        ]
        .into_iter()
        .fold(over(self.infeasibility, self.primal_size), worse)
    }
}

/// Measures how far `x` is from optimality; one product with `A`. The norm of the cost turns gradients into steps.
/// Allocates.
///
/// # Errors
/// [`QpError::Length`] for lengths that do not fit, [`QpError::Input`] for what is not finite, [`QpError::Setting`]
/// for a norm that is not positive.
pub fn check<A: SymmetricOperator>(cost: &QuadraticCost<'_, A>, set: &ProductSet, x: &[f64]) -> Result<Kkt, QpError> {
    measure(cost, None::<(&DenseEquality, _, _)>, set, x)
}

/// The same with an equality and its `multiplier`.
///
/// # Errors
/// As [`check`].
pub fn check_with<A: SymmetricOperator, C: Equality>(
    cost: &ConstrainedCost<'_, A, C>,
    set: &ProductSet,
    x: &[f64],
    multiplier: &[f64],
) -> Result<Kkt, QpError> {
    measure(&cost.cost, Some((cost.c, cost.e, multiplier)), set, x)
}

fn measure<A: SymmetricOperator, C: Equality>(
    &QuadraticCost { a, b, norm }: &QuadraticCost<'_, A>,
    equality: Option<(&C, &[f64], &[f64])>,
    set: &ProductSet,
    x: &[f64],
) -> Result<Kkt, QpError> {
    let n = a.dim();
    expect_lengths([
        ("the right side b", b.len(), n),
        ("the point x", x.len(), n),
        ("the set", set.segments().iter().map(Segment::len).sum(), n),
    ])?;
    expect_finite("the right side b", b)?;
    expect_finite("the point x", x)?;
    expect_setting("norm", norm, "(0, inf)")?;
    let mut r = vec![0.0; n];
    a.apply(x, &mut r, &mut a.scratch());
    let (b_norm, mut other_terms) = (root_of_squares(b), root_of_squares(&r));
    let mut e_norm = 0.0;
    for i in 0..n {
        r[i] -= b[i];
    }
    let mut equality_residual = 0.0;
    if let Some((c, e, multiplier)) = equality {
        expect_lengths([
            ("the right side e", e.len(), c.rows()),
            ("the multiplier", multiplier.len(), c.rows()),
            ("the equality matrix", c.dim(), n),
        ])?;
        expect_finite("the right side e", e)?;
        expect_finite("the multiplier", multiplier)?;
        let (mut cx, mut t) = (vec![0.0; c.rows()], vec![0.0; n]);
        let mut scratch = c.scratch();
        c.apply(x, &mut cx, &mut scratch);
        c.apply_transpose(multiplier, &mut t, &mut scratch);
        for (v, w) in cx.iter().zip(e) {
            equality_residual += (v - w) * (v - w);
        }
        for i in 0..n {
            r[i] += t[i];
        }
        other_terms = other_terms.max(root_of_squares(&t));
        e_norm = root_of_squares(e);
    }
    let x_norm = root_of_squares(x);
    let mut sums = Sums {
        scale: norm,
        near: KKT_ON_BOUND * x_norm,
        largest: -1.0,
        ..Sums::default()
    };
    let mut at = 0;
    for segment in set.segments() {
        match segment {
            Segment::Free(len) => {
                (at..at + len).for_each(|i| sums.free(i, x[i], r[i]));
            }
            Segment::Bounds { lower, upper } => {
                for (i, (&lo, &hi)) in (at..).zip(lower.iter().zip(upper)) {
                    sums.interval(i, x[i], r[i], (lo, hi));
                }
            }
            Segment::Discs { radii } => {
                for (i, &radius) in (at..).step_by(2).zip(radii) {
                    sums.disc(i, [x[i], x[i + 1]], [r[i], r[i + 1]], radius);
                }
            }
        }
        at += segment.len();
    }
    let infeasibility = sums.outside.sqrt();
    let dual_size = if b_norm > 0.0 {
        b_norm
    } else if other_terms > 0.0 {
        other_terms
    } else {
        norm * infeasibility
    };
    Ok(Kkt {
        infeasibility,
        equality: equality_residual.sqrt(),
        dual: sums.dual.sqrt(),
        stationarity: sums.natural.sqrt(),
        sign: sums.sign.sqrt(),
        worst: sums.worst,
        x_norm,
        b_norm,
        primal_size: x_norm.max(sums.inside.sqrt()).max(e_norm),
        dual_size,
    })
}

#[derive(Default)]
struct Sums {
    scale: f64,
    /// Distance from a bound that counts as none.
    near: f64,
    outside: f64,
    natural: f64,
    dual: f64,
    sign: f64,
    /// Squares of the projection of `x`.
    inside: f64,
    largest: f64,
    worst: usize,
}

impl Sums {
    fn free(&mut self, at: usize, x: f64, r: f64) {
        self.inside += x * x;
        self.add(at, 0.0, r * r, r * r, 0.0);
    }

    fn interval(&mut self, at: usize, x: f64, r: f64, (lo, hi): (f64, f64)) {
        let outside = (lo - x).max(x - hi).max(0.0);
        // `f64::max` would hide what is not a number
        let clamp = |v: f64| match v {
            v if v < lo => lo,
            v if v > hi => hi,
            v => v,
        };
        self.inside += clamp(x).powi(2);
        let natural = self.scale * (x - clamp(x - r / self.scale));
        let (low, high) = (x - lo <= self.near, hi - x <= self.near);
        let wrong = match (low, high) {
            (true, true) => 0.0,
            (true, false) if r > 0.0 => 0.0,
            (false, true) if r < 0.0 => 0.0,
            _ => r,
        };
        let sign = if low || high { wrong } else { 0.0 };
        self.add(at, outside * outside, natural * natural, wrong * wrong, sign * sign);
    }

    fn disc(&mut self, at: usize, [x0, x1]: [f64; 2], [r0, r1]: [f64; 2], radius: f64) {
        let scale = self.scale;
        let length = (x0 * x0 + x1 * x1).sqrt();
        let outside = (length - radius).max(0.0);
        self.inside += length.min(radius).powi(2);
        let (y0, y1) = (x0 - r0 / scale, x1 - r1 / scale);
        let reach = (y0 * y0 + y1 * y1).sqrt();
        let shrink = if reach > radius { radius / reach } else { 1.0 };
        let (d0, d1) = (scale * (x0 - shrink * y0), scale * (x1 - shrink * y1));
        let (mut dual, mut sign) = (r0 * r0 + r1 * r1, 0.0);
        if radius == 0.0 {
            dual = 0.0;
        } else if length >= radius * (1.0 - KKT_ON_CIRCLE) {
            let normal = (r0 * x0 + r1 * x1) / length;
            let along = (r1 * x0 - r0 * x1) / length;
            sign = normal.max(0.0).powi(2);
            dual = along * along + sign;
        }
        self.add(at, outside * outside, d0 * d0 + d1 * d1, dual, sign);
    }

    fn add(&mut self, at: usize, outside: f64, natural: f64, dual: f64, sign: f64) {
        self.outside += outside;
        self.natural += natural;
        self.dual += dual;
        self.sign += sign;
        if natural > self.largest {
            (self.largest, self.worst) = (natural, at);
        }
    }
}

fn root_of_squares(v: &[f64]) -> f64 {
    let mut sum = 0.0;
    for x in v {
        sum += x * x;
    }
    sum.sqrt()
}
