//! The two things a solver asks of a problem: a symmetric product and an orthonormal constraint matrix.
//!
//! Operators are immutable and shared; what a product writes to is a typed scratch that the caller owns and creates
//! once, so that a product allocates nothing.

use crate::vector;

/// A symmetric linear operator `A` on vectors of length [`dim`](SymmetricOperator::dim).
///
/// Implementations must be symmetric (`x·Ay = y·Ax`), deterministic (the same bits for the same
/// input, whatever the number of threads) and must not allocate in
/// [`apply`](SymmetricOperator::apply). [`check_operator_laws`](crate::laws::check_operator_laws)
/// tests the first two.
///
/// Sums over the entries of vectors are asked of the operator, too: where several processes keep a part of each vector,
/// it sums over all of them.
///
/// # Panics
/// Products may panic on slices of another length; solvers check them.
pub trait SymmetricOperator: Sync {
    /// Work memory of one product.
    type Scratch: Send;

    /// Length of the vectors the operator acts on.
    fn dim(&self) -> usize;

    /// Creates the work memory of one product.
    fn scratch(&self) -> Self::Scratch;

    /// `y = A x`. Both slices have length [`dim`](SymmetricOperator::dim); `y` is overwritten.
    fn apply(&self, x: &[f64], y: &mut [f64], s: &mut Self::Scratch);

    /// `x · y`.
    #[doc(hidden)]
    fn dot(&self, x: &[f64], y: &[f64]) -> f64 {
        vector::dot(x, y)
    }

    /// `x · y` of each pair.
    #[doc(hidden)]
    fn dots<const K: usize>(&self, pairs: [(&[f64], &[f64]); K]) -> [f64; K]
    where
        Self: Sized,
    {
        vector::dots(pairs)
    }

    /// Euclidean norm.
    #[doc(hidden)]
    fn norm(&self, x: &[f64]) -> f64 {
        self.dot(x, x).sqrt()
    }
}

/// A constraint matrix `C` with **orthonormal rows**: `C Cᵀ = I`.
///
/// The right side `e` of `C x = e` is no part of it and is passed to the solvers, because it changes
/// from one time step to the next while `C` stays. `Q = CᵀC` and `P = I - CᵀC` are then the orthogonal
/// projectors of the paper. [`check_equality_laws`](crate::laws::check_equality_laws) tests that the
/// rows are orthonormal and that the two products are adjoint. A matrix with zero rows is allowed.
///
/// # Panics
/// Products may panic on slices of another length; solvers check them.
pub trait Equality: Sync {
    /// Work memory of one product.
    type Scratch: Send;

    /// Length of `x`.
    fn dim(&self) -> usize;

    /// Number of rows of `C`.
    fn rows(&self) -> usize;

    /// Creates the work memory of one product.
    fn scratch(&self) -> Self::Scratch;

    /// `y = C x`; `x` has length [`dim`](Equality::dim), `y` has length [`rows`](Equality::rows) and
    /// is overwritten.
    fn apply(&self, x: &[f64], y: &mut [f64], s: &mut Self::Scratch);

    /// `x = Cᵀ y`; `y` has length [`rows`](Equality::rows), `x` has length [`dim`](Equality::dim) and
    /// is overwritten.
    fn apply_transpose(&self, y: &[f64], x: &mut [f64], s: &mut Self::Scratch);
}
