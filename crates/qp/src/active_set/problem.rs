//! What the active-set method is given, besides projector and set.

use crate::problem::ProductSet;

/// The data of one problem.
#[derive(Debug)]
pub struct ActiveSetProblem<'a, A, M> {
    /// `A`.
    pub operator: &'a A,
    /// Approximates the inverse of `A` on the image of the projector. It measures the error of `x`: one that is a millionth
    /// of the inverse ends the solve with a millionfold error. [`Identity`](crate::problem::Identity) is for operators with
    /// a norm of about one, [`Diagonal`](crate::problem::Diagonal) for others.
    pub preconditioner: &'a M,
    /// Diagonal of the preconditioner, positive on constrained components: turns gradients into steps.
    pub scale: &'a [f64],
    /// `b`.
    pub linear: &'a [f64],
    /// `e`.
    pub rhs: &'a [f64],
}

/// Is told the iterate after each settled active set and may change bounds and radii of the set.
pub(crate) type ActiveSetHook<'h> = dyn FnMut(&[f64], &mut ProductSet) + 'h;
