//! Checkers of the laws that the solvers rely on, for implementations of the traits in other crates.
//!
//! Each takes a number of samples drawn from a fixed sequence and reports the first violated law.

use thiserror::Error;

use crate::problem::{ConvexSet, Equality, SymmetricOperator};
use crate::tolerances::{LAW, LAW_ON_CIRCLE};
use crate::vector;

/// A law that an implementation violates.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("violated: {law}, by {error:e} in sample {sample}")]
#[non_exhaustive]
pub struct LawViolation {
    /// The law in words.
    pub law: &'static str,
    /// Size of the violation, relative to the data.
    pub error: f64,
    /// Number of the sample.
    pub sample: usize,
}

/// The first of the laws, each with its error and what is allowed, that does not hold.
fn hold<const N: usize>(sample: usize, laws: [(&'static str, f64, f64); N]) -> Result<(), LawViolation> {
    let broken = |(_, error, allowed): &(_, f64, f64)| error.is_nan() || error > allowed;
    match laws.into_iter().find(broken) {
        Some((law, error, _)) => Err(LawViolation { law, error, sample }),
        None => Ok(()),
    }
}

/// A fixed sequence of numbers in [-1, 1].
struct Sequence(u64);

impl Sequence {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
    fn vector(&mut self, n: usize, scale: f64) -> Vec<f64> {
        (0..n).map(|_| scale * self.next()).collect()
    }
}

/// A vector that has to be overwritten.
fn unwritten(n: usize) -> Vec<f64> {
    vec![f64::NAN; n]
}

fn failed(condition: bool) -> f64 {
    f64::from(u8::from(condition))
}

/// Checks that an operator is symmetric, linear, not negative along the samples, and reproducible.
///
/// # Errors
/// The first law that is violated beyond `tolerance` (relative; 1e-12 suits a well-scaled operator).
pub fn check_operator_laws<A: SymmetricOperator>(a: &A, samples: usize, tolerance: f64) -> Result<(), LawViolation> {
    let n = a.dim();
    let mut s = a.scratch();
    let mut random = Sequence(1);
    for k in 0..samples {
        let (x, y) = (random.vector(n, 1.0), random.vector(n, 1.0));
        let (mut ax, mut ay, mut az) = (unwritten(n), unwritten(n), unwritten(n));
        a.apply(&x, &mut ax, &mut s);
        a.apply(&y, &mut ay, &mut s);
        let size = vector::norm(&x) * vector::norm(&ay) + vector::norm(&y) * vector::norm(&ax);
        let size = size.max(f64::MIN_POSITIVE);
        let asymmetry = (vector::dot(&x, &ay) - vector::dot(&y, &ax)).abs() / size;
        let mut z = x.clone();
        vector::axpy(-0.7, &y, &mut z);
        a.apply(&z, &mut az, &mut s);
        vector::axpy(-1.0, &ax, &mut az);
        vector::axpy(0.7, &ay, &mut az);
        let scale = (vector::norm(&ax) + vector::norm(&ay)).max(f64::MIN_POSITIVE);
        let curved = vector::norm(&az) / scale;
        let negative = -vector::dot(&x, &ax) / size;
        a.apply(&x, &mut az, &mut a.scratch());
        let differs = az.iter().zip(&ax).any(|(u, v)| u.to_bits() != v.to_bits());
        hold(
            k,
            [
                ("the operator is symmetric", asymmetry, tolerance),
                ("the operator is positive semidefinite", negative, tolerance),
                ("the operator is linear", curved, tolerance),
                ("a repeated product has the same bits", failed(differs), 0.0),
            ],
        )?;
    }
    Ok(())
}

/// Checks that the rows are orthonormal and that the two products are adjoint.
///
/// # Errors
/// The first law that is violated beyond `tolerance` (relative).
pub fn check_equality_laws<C: Equality>(c: &C, samples: usize, tolerance: f64) -> Result<(), LawViolation> {
    let (n, m) = (c.dim(), c.rows());
    let mut s = c.scratch();
    let mut random = Sequence(2);
    for k in 0..samples {
        let (x, y) = (random.vector(n, 1.0), random.vector(m, 1.0));
        let (mut cx, mut ty, mut cty) = (unwritten(m), unwritten(n), unwritten(m));
        c.apply(&x, &mut cx, &mut s);
        c.apply_transpose(&y, &mut ty, &mut s);
        c.apply(&ty, &mut cty, &mut s);
        let size = (vector::norm(&x) * vector::norm(&y)).max(f64::MIN_POSITIVE);
        let gap = (vector::dot(&cx, &y) - vector::dot(&x, &ty)).abs() / size;
        let off = vector::distance(&cty, &y) / vector::norm(&y).max(f64::MIN_POSITIVE);
        let adjoint = "the product and the transposed product are adjoint";
        let orthonormal = "the rows are orthonormal, C C' = I";
        hold(k, [(adjoint, gap, tolerance), (orthonormal, off, tolerance)])?;
    }
    Ok(())
}

/// Checks projection, gradient split and feasible step of a set. `scale` is the size of typical points.
///
/// # Errors
/// The first law that is violated beyond rounding.
pub fn check_set_laws<S: ConvexSet + ?Sized>(set: &S, scale: f64, samples: usize) -> Result<(), LawViolation> {
    let n = set.dim();
    let mut random = Sequence(3);
    for k in 0..samples {
        let wide = if k % 2 == 0 { scale } else { 10.0 * scale };
        let (u, w) = (random.vector(n, wide), random.vector(n, wide));
        let sample = Sample {
            k,
            size: (vector::norm(&u) + vector::norm(&w)).max(f64::MIN_POSITIVE),
            x: projected(set, &u),
            y: projected(set, &w),
        };
        check_projection(set, &sample, &u, &w)?;
        let g = random.vector(n, scale);
        let step = 0.5 + 0.4 * random.next();
        let free = check_split(set, &sample, &g, step)?;
        check_feasible_step(set, &sample, &g, step, &free)?;
    }
    Ok(())
}

/// Two points of a set.
struct Sample {
    k: usize,
    /// Length of the vectors that they are projections of.
    size: f64,
    x: Vec<f64>,
    y: Vec<f64>,
}

fn projected<S: ConvexSet + ?Sized>(set: &S, x: &[f64]) -> Vec<f64> {
    let mut p = x.to_vec();
    set.project(&mut p);
    p
}

/// `sample` holds the projections of `u` and `w`.
fn check_projection<S: ConvexSet + ?Sized>(set: &S, sample: &Sample, u: &[f64], w: &[f64]) -> Result<(), LawViolation> {
    let Sample { k, size, x, y } = sample;
    let again = vector::distance(&projected(set, x), x) / size;
    let moved = (vector::distance(u, x) - set.violation(u)).abs() / size;
    let stretch = (vector::distance(x, y) - vector::distance(u, w)) / size;
    let cone: f64 = (0..x.len()).map(|i| (u[i] - x[i]) * (y[i] - x[i])).sum();
    hold(
        *k,
        [
            ("projecting twice changes nothing", again, 0.0),
            ("a projected point is in the set", set.violation(x) / size, 1e-15),
            ("the violation is the distance to the projection", moved, LAW),
            ("the projection does not expand", stretch, LAW),
            ("the projection is the nearest point", cone / size / size, LAW),
        ],
    )
}

/// Returns the free gradient.
fn check_split<S: ConvexSet + ?Sized>(
    set: &S,
    sample: &Sample,
    g: &[f64],
    step: f64,
) -> Result<Vec<f64>, LawViolation> {
    let Sample { k, size, x, y } = sample;
    let n = x.len();
    let (mut free, mut chopped) = (unwritten(n), unwritten(n));
    let norms = set.split(x, g, step, &mut free);
    set.chopped(x, g, &mut chopped);
    let gg = vector::dot(g, g).max(f64::MIN_POSITIVE);
    let shared = (0..n).map(|i| (free[i] * chopped[i]).abs()).sum();
    let norms_off =
        (norms.free - vector::dot(&free, &free)).abs() + (norms.chopped - vector::dot(&chopped, &chopped)).abs();
    // Moreau: g = projected gradient + normal part, orthogonal; the normal part is in minus the normal cone
    let tangent: Vec<f64> = free.iter().zip(&chopped).map(|(a, b)| a + b).collect();
    let normal: Vec<f64> = g.iter().zip(&tangent).map(|(a, b)| a - b).collect();
    let oblique = vector::dot(&normal, &tangent).abs() / gg;
    let outward: f64 = (0..n).map(|i| -normal[i] * (y[i] - x[i])).sum();
    let target: Vec<f64> = (0..n).map(|i| x[i] - step * g[i]).collect();
    let reduced = vector::distance(x, &projected(set, &target)) / step;
    let reduced_off = (norms.reduced() - reduced).abs() / gg.sqrt();
    let longer = (norms.reduced() - norms.projected()) / gg.sqrt();
    let bent = norms.reduced_free - norms.reduced_free_dot;
    hold(
        *k,
        [
            ("free and chopped gradient share no component", shared, 0.0),
            ("the norms belong to the parts", norms_off / gg, LAW),
            ("tangent and normal part are orthogonal", oblique, LAW),
            (
                "the normal part is in the normal cone",
                outward / gg.sqrt() / size,
                LAW_ON_CIRCLE,
            ),
            ("the reduced gradient is (x - P(x - a g)) / a", reduced_off, 1e-8),
            ("the reduced gradient is not longer", longer, LAW_ON_CIRCLE),
            ("reduced and free gradient agree in direction", bent, 1e-12 * gg),
        ],
    )?;
    Ok(free)
}

/// The feasible step along the free gradient is reachable and not extendable.
fn check_feasible_step<S: ConvexSet + ?Sized>(
    set: &S,
    sample: &Sample,
    g: &[f64],
    step: f64,
    free: &[f64],
) -> Result<(), LawViolation> {
    let Sample { k, size, x, .. } = sample;
    let t = set.feasible_step(x, free);
    if !(t.is_finite() && t > 0.0) {
        return Ok(());
    }
    let mut on = x.clone();
    set.advance(&mut on, free, t);
    let mut beyond = x.clone();
    vector::axpy(-t * (1.0 + 1e-6), free, &mut beyond);
    let longest = set.violation(&beyond) > 0.0;
    let mut part = unwritten(x.len());
    set.split(&on, g, step, &mut part);
    let ends = (0..x.len()).any(|i| free[i] != 0.0 && part[i] == 0.0 && g[i] != 0.0);
    hold(
        *k,
        [
            ("the feasible step stays in the set", set.violation(&on) / size, 1e-15),
            ("the feasible step is the longest", failed(!longest), 0.0),
            ("the feasible step ends on the boundary", failed(!ends), 0.0),
        ],
    )
}
