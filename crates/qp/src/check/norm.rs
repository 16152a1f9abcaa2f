//! A safe upper estimate of the norm of a positive semidefinite operator.
//!
//! Lanczos from a fixed start vector. After `k` products the largest Ritz value `theta` is below the norm;
//! `theta` plus the norm of its residual is above an eigenvalue, in practice above all (Zhou and Li,
//! "Bounding the spectrum of large Hermitian matrices", Linear Algebra Appl. 435, 2011), and a margin is
//! added on top.
//!
//! | literature | here |
//! |---|---|
//! | `alpha_j`, `beta_j` | `diagonal`, `off`: entries of the tridiagonal matrix |
//! | `theta` | `lower`: its largest eigenvalue |
//! | last entry of the eigenvector | `last` |

use crate::error::QpError;
use crate::problem::SymmetricOperator;
use crate::tolerances::{EXHAUSTED, NORM_ACCURACY, NORM_MARGIN, NORM_PRODUCTS};
use crate::vector;
use faer::{Mat, Side};

/// Result of [`norm_estimate`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct NormEstimate {
    /// Largest Ritz value: never above the norm.
    pub lower: f64,
    /// Safe upper value: 1.02 times the sum of `lower` and its residual. Use this one as step bound.
    pub upper: f64,
    /// Products spent.
    pub products: usize,
}

/// Estimates the norm of a positive semidefinite `operator`.
///
/// The start vector is fixed (no randomness between runs). Allocates three vectors; meant to be called
/// once an operator. Dimension 0 and the zero operator give 0, with which no solver begins.
///
/// # Errors
/// A product that is not finite.
pub fn norm_estimate<A: SymmetricOperator>(operator: &A) -> Result<NormEstimate, QpError> {
    let n = operator.dim();
    let mut scratch = operator.scratch();
    let mut q: Vec<f64> = (0..n).map(start_entry).collect();
    let length = vector::norm(&q);
    vector::scale(if length > 0.0 { 1.0 / length } else { 0.0 }, &mut q);
    let (mut before, mut w) = (vec![0.0; n], vec![0.0; n]);
    let mut diagonal: Vec<f64> = Vec::with_capacity(NORM_PRODUCTS);
    let mut off: Vec<f64> = Vec::with_capacity(NORM_PRODUCTS);
    let mut estimate = NormEstimate {
        lower: 0.0,
        upper: 0.0,
        products: 0,
    };
    for k in 0..NORM_PRODUCTS.min(n) {
        operator.apply(&q, &mut w, &mut scratch);
        estimate.products += 1;
        if let Some(&beta) = off.last() {
            vector::axpy(-beta, &before, &mut w);
        }
        let alpha = vector::dot(&q, &w);
        vector::axpy(-alpha, &q, &mut w);
        diagonal.push(alpha);
        let beta = vector::norm(&w);
        if !(alpha.is_finite() && beta.is_finite()) {
            return Err(QpError::NotFinite {
                quantity: "the norm estimate",
                products: estimate.products,
            });
        }
        // without an eigenvector the residual is at most this
        let (lower, last) = largest_eigenpair(&diagonal, &off).unwrap_or((alpha, 1.0));
        let residual = beta * last.abs();
        estimate.lower = lower;
        estimate.upper = NORM_MARGIN * (lower + residual);
        if beta <= EXHAUSTED * lower.abs() || (k >= 4 && residual <= NORM_ACCURACY * lower) {
            break;
        }
        off.push(beta);
        vector::copy(&q, &mut before);
        vector::copy(&w, &mut q);
        vector::scale(1.0 / beta, &mut q);
    }
    Ok(estimate)
}

/// Entries of the start vector: reproducible, without pattern, in [0.5, 1.5] up to sign.
fn start_entry(i: usize) -> f64 {
    // splitmix64
    let mut z = (i as u64).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^= z >> 31;
    let magnitude = 0.5 + (z >> 12) as f64 / (1u64 << 52) as f64;
    if z & 1 == 0 { magnitude } else { -magnitude }
}

/// Largest eigenvalue of the tridiagonal matrix, and the last entry of its unit eigenvector.
fn largest_eigenpair(diagonal: &[f64], off: &[f64]) -> Option<(f64, f64)> {
    let n = diagonal.len();
    let matrix = Mat::from_fn(n, n, |i, j| match i.abs_diff(j) {
        0 => diagonal[i],
        1 => off[i.min(j)],
        _ => 0.0,
    });
    let eigen = matrix.self_adjoint_eigen(Side::Lower).ok()?;
    Some((eigen.S()[n - 1], eigen.U()[(n - 1, n - 1)]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::DenseOperator;

    #[test]
    fn upper_is_above_lower_is_below() {
        let n = 60;
        let mut a = vec![0.0; n * n];
        for i in 0..n {
            a[i * n + i] = 2.0;
            if i > 0 {
                a[i * n + i - 1] = -1.0;
                a[(i - 1) * n + i] = -1.0;
            }
        }
        let exact = 2.0 + 2.0 * (std::f64::consts::PI / (n as f64 + 1.0)).cos();
        let a = DenseOperator::new(n, a).expect("matrix");
        let e = norm_estimate(&a).expect("estimate");
        assert!(e.lower <= exact * (1.0 + 1e-12) && e.upper >= exact, "{e:?} {exact}");
        assert!(e.upper <= 1.1 * exact && e.products <= 20);
        let zero = DenseOperator::new(3, vec![0.0; 9]).expect("matrix");
        assert_eq!(norm_estimate(&zero).expect("estimate").upper, 0.0);
    }
}
