//! What a face leaves free, as preconditioners and coarse spaces see it.

use crate::dense::DenseOperator;
use crate::face_state::{Constrained, Disc, Face, for_constrained};
use crate::operator::SymmetricOperator;
use crate::product::ProductSet;
use crate::projected_cg::Identity;

/// How a block may move on a face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Freedom {
    /// Not at all.
    Held,
    /// In every direction.
    Free,
    /// A point on its circle: along this unit vector only.
    Along([f64; 2]),
}

/// The constrained blocks of a face.
#[derive(Debug, Clone, Copy)]
pub struct ActiveSetView<'a> {
    set: &'a ProductSet,
    face: &'a Face,
}

impl<'a> ActiveSetView<'a> {
    pub(crate) fn new(set: &'a ProductSet, face: &'a Face) -> Self {
        Self { set, face }
    }

    /// Hands each constrained block in order to `f`: first component, number of components, freedom. Unconstrained
    /// components are left out.
    pub fn for_each(&self, mut f: impl FnMut(usize, usize, Freedom)) {
        for_constrained(self.set, |block| match block {
            Constrained::Bound { i, k, .. } => {
                let free = self.face.free[k];
                f(i, 1, if free { Freedom::Free } else { Freedom::Held });
            }
            Constrained::Disc { i, k, .. } => {
                let freedom = match self.face.discs[k] {
                    Disc::Fixed => Freedom::Held,
                    Disc::Free => Freedom::Free,
                    Disc::Sliding { tau, .. } => Freedom::Along(tau),
                };
                f(i, 2, freedom);
            }
        });
    }
}

/// A preconditioner of the face method.
///
/// What approximates the inverse of `A` on one face need not do so on another: held components drop out of the matrix
/// that is inverted. A preconditioner that can follow is told every face before it is used there.
pub trait ActiveSetPreconditioner: SymmetricOperator {
    /// The next products are on this face: they start from vectors that vanish where it is held, and only the free part
    /// of their result counts. Stays symmetric on such vectors.
    fn enter(&self, _face: &ActiveSetView<'_>, _s: &mut Self::Scratch) {}
}

impl ActiveSetPreconditioner for Identity {}
impl ActiveSetPreconditioner for DenseOperator {}

impl<T: ActiveSetPreconditioner + ?Sized> ActiveSetPreconditioner for &T {
    fn enter(&self, face: &ActiveSetView<'_>, s: &mut Self::Scratch) {
        (**self).enter(face, s);
    }
}
