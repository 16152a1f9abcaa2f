//! Checkers of the laws that the solvers rely on, for implementations of the traits in other crates.
//!
//! Each takes a number of samples drawn from a fixed sequence and reports the first violated law.

use crate::operator::{Equality, SymmetricOperator};
use crate::set::ConvexSet;
use crate::vector;
use thiserror::Error;

/// A law that an implementation violates.
#[derive(Clone, PartialEq, Error)]
#[error("{law}: off by {error:e} in sample {sample}")]
#[non_exhaustive]
pub struct LawViolation {
    /// The law in words.
    pub law: &'static str,
    /// Size of the violation, relative to the data.
    pub error: f64,
    /// Number of the sample.
    pub sample: usize,
}

fn hold(law: &'static str, sample: usize, error: f64, allowed: f64) -> Result<(), LawViolation> {
    if error <= allowed {
        Ok(())
    } else {
        Err(LawViolation { law, error, sample })
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

/// Checks that an operator is symmetric, linear, not negative along the samples, and reproducible.
///
/// # Errors
/// The first law that is violated beyond `tolerance` (relative; 1e-12 suits a well-scaled operator).
pub fn check_operator_laws<A: SymmetricOperator>(
    a: &A,
    samples: usize,
    tolerance: f64,
) -> Result<(), LawViolation> {
    let n = a.dim();
    let mut s = a.scratch();
    let mut random = Sequence(1);
    for k in 0..samples {
        let (x, y) = (random.vector(n, 1.0), random.vector(n, 1.0));
        let (mut ax, mut ay, mut az) = (vec![f64::NAN; n], vec![f64::NAN; n], vec![f64::NAN; n]);
        a.apply(&x, &mut ax, &mut s);
        a.apply(&y, &mut ay, &mut s);
        let size = vector::norm(&x) * vector::norm(&ay) + vector::norm(&y) * vector::norm(&ax);
        let size = size.max(f64::MIN_POSITIVE);
        let asymmetry = (vector::dot(&x, &ay) - vector::dot(&y, &ax)).abs() / size;
        hold("the operator is symmetric", k, asymmetry, tolerance)?;
        hold(
            "the operator is positive semidefinite",
            k,
            -vector::dot(&x, &ax) / size,
            tolerance,
        )?;
        let mut z = x.clone();
        vector::axpy(-0.7, &y, &mut z);
        a.apply(&z, &mut az, &mut s);
        vector::axpy(-1.0, &ax, &mut az);
        vector::axpy(0.7, &ay, &mut az);
        let scale = (vector::norm(&ax) + vector::norm(&ay)).max(f64::MIN_POSITIVE);
        hold(
            "the operator is linear",
            k,
            vector::norm(&az) / scale,
            tolerance,
        )?;
        a.apply(&x, &mut az, &mut a.scratch());
        let same = az.iter().zip(&ax).all(|(u, v)| u.to_bits() == v.to_bits());
        hold(
            "a repeated product has the same bits",
            k,
            if same { 0.0 } else { 1.0 },
            0.0,
        )?;
    }
    Ok(())
}

/// Checks that the rows are orthonormal and that the two products are adjoint.
///
/// # Errors
/// The first law that is violated beyond `tolerance` (relative).
pub fn check_equality_laws<C: Equality>(
    c: &C,
    samples: usize,
    tolerance: f64,
) -> Result<(), LawViolation> {
    let (n, m) = (c.dim(), c.rows());
    let mut s = c.scratch();
    let mut random = Sequence(2);
    for k in 0..samples {
        let (x, y) = (random.vector(n, 1.0), random.vector(m, 1.0));
        let (mut cx, mut ty, mut cty) = (vec![f64::NAN; m], vec![f64::NAN; n], vec![f64::NAN; m]);
        c.apply(&x, &mut cx, &mut s);
        c.apply_transpose(&y, &mut ty, &mut s);
        c.apply(&ty, &mut cty, &mut s);
        let size = (vector::norm(&x) * vector::norm(&y)).max(f64::MIN_POSITIVE);
        let gap = (vector::dot(&cx, &y) - vector::dot(&x, &ty)).abs() / size;
        hold(
            "the product and the transposed product are adjoint",
            k,
            gap,
            tolerance,
        )?;
        let gap = vector::distance(&cty, &y) / vector::norm(&y).max(f64::MIN_POSITIVE);
        hold("the rows are orthonormal, C C' = I", k, gap, tolerance)?;
    }
    Ok(())
}

/// Checks projection, gradient split and feasible step of a set. `scale` is the size of typical points.
///
/// # Errors
/// The first law that is violated beyond rounding.
pub fn check_set_laws<S: ConvexSet + ?Sized>(
    set: &S,
    scale: f64,
    samples: usize,
) -> Result<(), LawViolation> {
    let n = set.dim();
    let mut random = Sequence(3);
    for k in 0..samples {
        let wide = if k % 2 == 0 { 1.0 } else { 10.0 };
        let (u, w) = (
            random.vector(n, wide * scale),
            random.vector(n, wide * scale),
        );
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

/// Rounding allowed of laws of a set.
const TOLERANCE: f64 = 1e-10;

fn projected<S: ConvexSet + ?Sized>(set: &S, x: &[f64]) -> Vec<f64> {
    let mut p = x.to_vec();
    set.project(&mut p);
    p
}

/// `sample` holds the projections of `u` and `w`.
fn check_projection<S: ConvexSet + ?Sized>(
    set: &S,
    sample: &Sample,
    u: &[f64],
    w: &[f64],
) -> Result<(), LawViolation> {
    let Sample { k, size, x, y } = sample;
    let (k, size) = (*k, *size);
    let again = projected(set, x);
    hold(
        "projecting twice changes nothing",
        k,
        vector::distance(&again, x) / size,
        0.0,
    )?;
    hold(
        "a projected point is in the set",
        k,
        set.violation(x) / size,
        1e-15,
    )?;
    let moved = (vector::distance(u, x) - set.violation(u)).abs() / size;
    hold(
        "the violation is the distance to the projection",
        k,
        moved,
        TOLERANCE,
    )?;
    let stretch = (vector::distance(x, y) - vector::distance(u, w)) / size;
    hold("the projection does not expand", k, stretch, TOLERANCE)?;
    let cone: f64 = (0..x.len()).map(|i| (u[i] - x[i]) * (y[i] - x[i])).sum();
    hold(
        "the projection is the nearest point",
        k,
        cone / size / size,
        TOLERANCE,
    )?;
    Ok(())
}

/// Returns the free gradient.
fn check_split<S: ConvexSet + ?Sized>(
    set: &S,
    sample: &Sample,
    g: &[f64],
    step: f64,
) -> Result<Vec<f64>, LawViolation> {
    let Sample { k, size, x, y } = sample;
    let (k, size, n) = (*k, *size, x.len());
    let (mut free, mut chopped, mut tangent) =
        (vec![f64::NAN; n], vec![f64::NAN; n], vec![f64::NAN; n]);
    let norms = set.split(x, g, step, &mut free);
    set.chopped(x, g, &mut chopped);
    set.projected_gradient(x, g, &mut tangent);
    let gg = vector::dot(g, g).max(f64::MIN_POSITIVE);
    let off =
        (0..n).map(|i| (free[i] + chopped[i] - tangent[i]).abs() + (free[i] * chopped[i]).abs());
    hold(
        "free and chopped gradient share no component and add up",
        k,
        off.fold(0.0, f64::max),
        0.0,
    )?;
    let off = (norms.free - vector::dot(&free, &free)).abs()
        + (norms.chopped - vector::dot(&chopped, &chopped)).abs();
    hold("the norms belong to the parts", k, off / gg, TOLERANCE)?;
    // Moreau: g = projected gradient + normal part, orthogonal; the normal part is in minus the normal cone
    let normal: Vec<f64> = g.iter().zip(&tangent).map(|(a, b)| a - b).collect();
    hold(
        "tangent and normal part are orthogonal",
        k,
        vector::dot(&normal, &tangent).abs() / gg,
        TOLERANCE,
    )?;
    let outward: f64 = (0..n).map(|i| -normal[i] * (y[i] - x[i])).sum();
    // points within rounding of a circle count as on it, hence the wider margin
    hold(
        "the normal part is in the normal cone",
        k,
        outward / gg.sqrt() / size,
        1e-6,
    )?;
    let target: Vec<f64> = (0..n).map(|i| x[i] - step * g[i]).collect();
    let reduced = vector::distance(x, &projected(set, &target)) / step;
    hold(
        "the reduced gradient is (x - P(x - a g)) / a",
        k,
        (norms.reduced() - reduced).abs() / gg.sqrt(),
        1e-8,
    )?;
    hold(
        "the reduced gradient is not longer",
        k,
        (norms.reduced() - norms.projected()) / gg.sqrt(),
        1e-6,
    )?;
    hold(
        "reduced and free gradient agree in direction",
        k,
        norms.reduced_free - norms.reduced_free_dot,
        1e-12 * gg,
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
    let (k, size) = (*k, *size);
    let t = set.feasible_step(x, free);
    if !(t.is_finite() && t > 0.0) {
        return Ok(());
    }
    let mut on = x.clone();
    set.advance(&mut on, free, t);
    hold(
        "the feasible step stays in the set",
        k,
        set.violation(&on) / size,
        1e-15,
    )?;
    let mut beyond = x.clone();
    vector::axpy(-t * (1.0 + 1e-6), free, &mut beyond);
    let out = if set.violation(&beyond) > 0.0 {
        0.0
    } else {
        1.0
    };
    hold("the feasible step is the longest", k, out, 0.0)?;
    let mut part = vec![f64::NAN; x.len()];
    set.split(&on, g, step, &mut part);
    let gained = (0..x.len())
        .filter(|&i| free[i] != 0.0 && part[i] == 0.0 && g[i] != 0.0)
        .count();
    hold(
        "the feasible step ends on the boundary",
        k,
        if gained > 0 { 0.0 } else { 1.0 },
        0.0,
    )?;
    Ok(())
}
