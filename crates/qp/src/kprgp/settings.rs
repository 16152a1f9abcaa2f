//! Settings, report and work memory of [`kprgp`](crate::kprgp()).

use crate::error::QpError;
use crate::problem::SymmetricOperator;
use crate::report::{Products, Status, Steps};
use crate::settings::settings;

use super::objective::Objective;

/// How the active set is enlarged when a conjugate gradient step leaves the set.
///
/// Both first go to the boundary along the conjugate direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
#[non_exhaustive]
pub enum Expansion {
    /// Projected step along the free gradient with the fixed length. Has the convergence proof of
    /// Kucera (2008); one product.
    FixedStep,
    /// Projection of the full conjugate gradient step; one product. Where that does not decrease the cost enough, the
    /// fixed step is made instead, counted in [`Products::fallback`].
    #[default]
    ProjectedCg,
}

settings! {
    /// Settings of [`kprgp`](crate::kprgp()).
    #[derive(Debug, Clone, Copy, PartialEq)]
    KprgpSettings or QpError {
        /// Ratio of chopped to free gradient at which components are released: Gamma.
        proportioning, with_proportioning: f64 = 1.0, in "(0, inf)";
        /// Fixed step length, times 1 / norm of the Hessian: alpha.
        step_length, with_step_length: f64 = 1.9, in "(0, 2]";
        /// How the active set is enlarged.
        expansion, with_expansion: Expansion = Expansion::ProjectedCg;
        /// Most operator products of one solve.
        max_products, with_max_products: usize = 10_000, in "[1, inf)";
    }
}

/// Result of [`kprgp`](crate::kprgp()).
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[must_use = "it may not have converged: see `status`"]
pub struct KprgpReport {
    /// How the solve ended.
    pub status: Status,
    /// Steps by kind.
    pub steps: Steps,
    /// Operator products by cause.
    pub products: Products,
    /// Norm of the projected gradient at the end.
    pub projected_gradient: f64,
    /// The tolerance it was compared with.
    pub tolerance: f64,
    /// How often the fixed step was halved because it raised the cost: above 0 the `norm` given to the solver was too
    /// small.
    pub halvings: usize,
    /// By how much the cost decreased since the (projected) start.
    pub(crate) decrease: f64,
    /// Cost `1/2 x·Ax - b·x` at the end.
    pub cost: f64,
}

/// The four vectors of the iteration, and how stale the gradient is.
pub(crate) struct Vectors {
    /// Gradient.
    pub(crate) g: Vec<f64>,
    /// Conjugate direction; remembers the point before a projected step.
    pub(crate) p: Vec<f64>,
    /// Hessian times direction; remembers the gradient before a projected step.
    pub(crate) ap: Vec<f64>,
    /// Free gradient.
    pub(crate) phi: Vec<f64>,
    /// Recurrence updates since the gradient was computed from `x`.
    pub(crate) stale: usize,
}

impl Vectors {
    pub(crate) fn new(n: usize) -> Self {
        Self {
            g: vec![0.0; n],
            p: vec![0.0; n],
            ap: vec![0.0; n],
            phi: vec![0.0; n],
            stale: 0,
        }
    }

    /// The gradient at `x`, from `x`; one product.
    pub(crate) fn compute_gradient(&mut self, objective: &mut impl Objective, x: &[f64]) {
        objective.gradient(x, &mut self.g);
        self.stale = 0;
    }
}

/// Work memory of [`kprgp`](crate::kprgp()): four vectors and the operator's scratch, created once.
pub struct KprgpWorkspace<A: SymmetricOperator> {
    pub(crate) vectors: Vectors,
    pub(crate) scratch: A::Scratch,
}

impl<A: SymmetricOperator> KprgpWorkspace<A> {
    /// Work memory for `operator`.
    #[must_use]
    pub fn new(operator: &A) -> Self {
        Self {
            vectors: Vectors::new(operator.dim()),
            scratch: operator.scratch(),
        }
    }

    /// Gradient `A x - b` at the end of the last solve.
    #[must_use]
    pub fn gradient(&self) -> &[f64] {
        &self.vectors.g
    }
}
