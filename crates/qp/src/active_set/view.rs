//! What an active set leaves free, as preconditioners see it.

use crate::problem::{Constrained, DenseOperator, Diagonal, ProductSet, SymmetricOperator, for_constrained};

use super::blocks::ActiveSet;
use super::disc::Disc;

/// How a block may move on an active set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Freedom {
    /// Not at all.
    Held,
    /// In every direction.
    Free,
    /// A point on its circle: along this unit vector only.
    Along([f64; 2]),
}

/// The constrained blocks of an active set.
#[derive(Debug, Clone, Copy)]
pub struct ActiveSetView<'a> {
    set: &'a ProductSet,
    active: &'a ActiveSet,
    /// What springs in series add to the diagonal over the inverse of `scale`, and that.
    springs: (f64, &'a [f64]),
}

impl<'a> ActiveSetView<'a> {
    pub(crate) fn new(set: &'a ProductSet, active: &'a ActiveSet, springs: (f64, &'a [f64])) -> Self {
        Self { set, active, springs }
    }

    /// Hands each constrained block in order to `f`: first component, number of components, freedom. Unconstrained
    /// components are left out.
    pub fn for_each(&self, mut f: impl FnMut(usize, usize, Freedom)) {
        for_constrained(self.set, |block| match block {
            Constrained::Bound { i, k, .. } => {
                let free = self.active.free[k];
                f(i, 1, if free { Freedom::Free } else { Freedom::Held });
            }
            Constrained::Disc { i, k, .. } => {
                let freedom = match self.active.discs[k] {
                    Disc::Fixed => Freedom::Held,
                    Disc::Free => Freedom::Free,
                    Disc::Sliding { tau, .. } => Freedom::Along(tau),
                };
                f(i, 2, freedom);
            }
        });
    }

    /// Hands each component to `f` that the method adds something to the diagonal of `A` at, and this: the curvature of
    /// circles on which points slide, and springs on a path.
    pub fn for_each_added(&self, mut f: impl FnMut(usize, f64)) {
        let (c, scale) = self.springs;
        if c > 0.0 {
            let springs = scale.iter().enumerate().take(self.set.constrained());
            springs.filter(|s| *s.1 > 0.0).for_each(|(i, scale)| f(i, c / scale));
        }
        self.active.for_sliding(self.set, |i, kappa, _| {
            f(i, kappa);
            f(i + 1, kappa);
        });
    }
}

/// A preconditioner of the active-set method.
///
/// What approximates the inverse of `A` on one active set need not do so on another: active components drop out of
/// the matrix that is inverted. A preconditioner that can follow is told every active set before it is used there.
pub trait ActiveSetPreconditioner: SymmetricOperator {
    /// The next products are on this set: they start from vectors that vanish where it is active, and only the free
    /// part of their result counts. Stays symmetric on such vectors.
    fn enter(&self, _active: &ActiveSetView<'_>, _s: &mut Self::Scratch) {}

    /// Whether it is nearly the inverse on a set, with what the method [adds to the
    /// diagonal](ActiveSetView::for_each_added): a set then has few steps. Else the method damps it there.
    fn knows_added(&self) -> bool {
        false
    }
}

impl ActiveSetPreconditioner for DenseOperator {}
impl ActiveSetPreconditioner for Diagonal {}
