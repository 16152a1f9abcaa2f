//! Checkers of the laws that the solvers rely on, for implementations of the traits in other crates.
//!
//! Each takes a number of samples drawn from a fixed sequence and reports the first violated law.

use thiserror::Error;

use crate::problem::{Equality, SymmetricOperator};
use crate::vector;

/// A law that an implementation violates.
#[derive(Debug, Clone, PartialEq, Error)]
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
    fn vector(&mut self, n: usize) -> Vec<f64> {
        (0..n).map(|_| self.next()).collect()
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
        let (x, y) = (random.vector(n), random.vector(n));
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
        let (x, y) = (random.vector(n), random.vector(m));
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
