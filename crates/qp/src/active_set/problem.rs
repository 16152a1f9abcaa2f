//! What the active-set method is given, besides projector and set.

/// The data of one problem.
#[derive(Debug)]
pub struct ActiveSetProblem<'a, A, M> {
    /// `A`.
    pub operator: &'a A,
    /// Approximates the inverse of `A` on the image of the projector. It measures the error of `x`: one that is a
    /// millionth of the inverse ends the solve with a millionfold error. [`Diagonal`](crate::problem::Diagonal) is the
    /// simplest.
    pub preconditioner: &'a M,
    /// Diagonal of the preconditioner, positive on constrained components: turns gradients into steps.
    pub scale: &'a [f64],
    /// `b`.
    pub linear: &'a [f64],
    /// `e`.
    pub rhs: &'a [f64],
}

/// Where a solve starts, and then where it ends.
#[derive(Debug)]
pub struct ActiveSetPoint<'a> {
    /// `x`.
    pub x: &'a mut [f64],
    /// On return `A x` up to 3 % of the tolerance.
    pub ax: &'a mut [f64],
    /// Whether `ax` holds `A x` at the start; else it is computed.
    pub known: bool,
}
