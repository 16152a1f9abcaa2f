//! What is minimised.

use super::operator::{Equality, SymmetricOperator};

/// The cost `1/2 x·Ax - b·x`.
#[derive(Debug)]
pub struct QuadraticCost<'a, A> {
    pub(crate) a: &'a A,
    pub(crate) b: &'a [f64],
    pub(crate) norm: f64,
}

impl<'a, A: SymmetricOperator> QuadraticCost<'a, A> {
    /// From `A`, `b` and an upper bound of the norm of `A` ([`norm_estimate`](crate::norm_estimate)): steps and
    /// penalties are relative to it.
    pub fn new(a: &'a A, b: &'a [f64], norm: f64) -> Self {
        Self { a, b, norm }
    }

    /// With the equality `C x = e`. The norm is then that of `P A P` ([`Projected`](crate::Projected)).
    pub fn with_equality<C: Equality>(self, c: &'a C, e: &'a [f64]) -> ConstrainedCost<'a, A, C> {
        ConstrainedCost { cost: self, c, e }
    }
}

/// The cost `1/2 x·Ax - b·x` of points with `C x = e`, `C` with orthonormal rows.
#[derive(Debug)]
pub struct ConstrainedCost<'a, A, C> {
    pub(crate) cost: QuadraticCost<'a, A>,
    pub(crate) c: &'a C,
    pub(crate) e: &'a [f64],
}
