//! The smooth cost that KPRGP minimises, as the iteration sees it: plain here, penalised in SMALSE.

use crate::problem::{QuadraticCost, SymmetricOperator};
use crate::vector;

/// A quadratic cost with the bookkeeping that follows the iterate.
pub(crate) trait Objective {
    /// Gradient at `x`; one product.
    fn gradient(&mut self, x: &[f64], g: &mut [f64]);
    /// Hessian times `p`; one product.
    fn direction(&mut self, p: &[f64], ap: &mut [f64]);
    /// The iterate moved by `-t p`, `p` being the last direction.
    fn moved(&mut self, t: f64);
    /// Upper bound of the norm of the Hessian.
    fn hessian_norm(&self) -> f64;
    /// Gradient norm at which the iteration may stop at the present iterate.
    fn tolerance(&self) -> f64;
}

/// `1/2 x·Ax - b·x`.
pub(crate) struct Plain<'a, A: SymmetricOperator> {
    pub(crate) cost: &'a QuadraticCost<'a, A>,
    pub(crate) tolerance: f64,
    pub(crate) scratch: &'a mut A::Scratch,
}

impl<A: SymmetricOperator> Objective for Plain<'_, A> {
    fn gradient(&mut self, x: &[f64], g: &mut [f64]) {
        self.cost.a.apply(x, g, self.scratch);
        vector::subtract(self.cost.b, g);
    }
    fn direction(&mut self, p: &[f64], ap: &mut [f64]) {
        self.cost.a.apply(p, ap, self.scratch);
    }
    fn moved(&mut self, _t: f64) {}
    fn hessian_norm(&self) -> f64 {
        self.cost.norm
    }
    fn tolerance(&self) -> f64 {
        self.tolerance
    }
}
