//! The projected operator `P A P` with `P = I - CᵀC`.

use crate::error::{QpError, expect_length};
use crate::vector;

use super::operator::{Equality, SymmetricOperator};

/// `P A P`, the operator `A` seen from the kernel of `C`; its norm scales the settings of SMALSE. With as many rows as
/// columns `C` leaves nothing of it but rounding: take the norm of `A` then.
///
/// One product with it is one product with `A` and two projections.
#[derive(Debug, Clone, Copy)]
pub struct Projected<'a, A, C> {
    a: &'a A,
    c: &'a C,
}

impl<'a, A: SymmetricOperator, C: Equality> Projected<'a, A, C> {
    /// `P A P`.
    ///
    /// # Errors
    /// [`QpError::Length`] if the two operators differ in dimension.
    pub fn new(a: &'a A, c: &'a C) -> Result<Self, QpError> {
        expect_length("the equality matrix", c.dim(), a.dim())?;
        Ok(Self { a, c })
    }
}

/// Work memory of [`Projected`].
#[derive(Debug)]
pub struct ProjectedScratch<SA, SC> {
    a: SA,
    c: SC,
    coarse: Vec<f64>,
    y: Vec<f64>,
}

impl<A: SymmetricOperator, C: Equality> SymmetricOperator for Projected<'_, A, C> {
    type Scratch = ProjectedScratch<A::Scratch, C::Scratch>;
    fn dim(&self) -> usize {
        self.a.dim()
    }
    fn scratch(&self) -> Self::Scratch {
        ProjectedScratch {
            a: self.a.scratch(),
            c: self.c.scratch(),
            coarse: vec![0.0; self.c.rows()],
            y: vec![0.0; self.a.dim()],
        }
    }
    fn apply(&self, x: &[f64], out: &mut [f64], s: &mut Self::Scratch) {
        self.c.apply(x, &mut s.coarse, &mut s.c);
        self.c.apply_transpose(&s.coarse, &mut s.y, &mut s.c);
        vector::xpby(x, -1.0, &mut s.y);
        self.a.apply(&s.y, out, &mut s.a);
        self.c.apply(out, &mut s.coarse, &mut s.c);
        self.c.apply_transpose(&s.coarse, &mut s.y, &mut s.c);
        vector::subtract(&s.y, out);
    }
}
