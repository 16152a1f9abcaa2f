//! Settings, report and work memory of [`smalse`](crate::smalse()).

use crate::error::QpError;
use crate::kprgp::{KprgpSettings, Vectors};
use crate::problem::{Equality, SymmetricOperator};
use crate::report::{Products, Status, Steps};
use crate::settings::settings;

use super::penalised::State;

settings! {
    /// Settings of [`smalse`](crate::smalse()), dimensionless but for `least`.
    #[derive(Debug, Clone, Copy, PartialEq)]
    SmalseSettings or QpError {
        /// Projected gradient at the end over `|P (b - A C'e)|`, the paper's `|P h|` (one more product if `e` is not
        /// zero), or over the norm of the first gradient where that is zero: `eps`.
        tolerance, with_tolerance: f64 = 1e-6, in "[0, inf)";
        /// Residual `Cx - e` at the end, relative to the larger of `|x|` and `|e|` and to no less than what rounding
        /// errors of `b` make of `x`: `eps_1 M_0`.
        equality, with_equality: f64 = 1e-6, in "(0, inf)";
        /// Size of `x` that counts as nothing: it is measured against no less, and the reference of the tolerance is at
        /// least a hundredth of the norm of `PAP` times that. Where the data vanish no tolerance relative to them ends.
        least, with_least: f64 = 0.0, in "[0, inf)";
        /// Penalty relative to the norm of `PAP`: `rho`.
        penalty, with_penalty: f64 = 3.0, in "(0, inf)";
        /// First precision control, inner tolerance over `Cx - e`, relative to the norm of `PAP`: `M_0`.
        precision, with_precision: f64 = 1.0, in "(0, inf)";
        /// Largest inner tolerance relative to the reference of the tolerance: `eta`.
        gradient_cap, with_gradient_cap: f64 = 0.1, in "(0, inf)";
        /// What the precision control is multiplied by where the Lagrangian grew too little (Step 4): `1 / beta`.
        shrink, with_shrink: f64 = 0.5, in "(0, 1)";
        /// Most outer steps.
        max_outer, with_max_outer: usize = 500, in "[1, inf)";
        /// KPRGP, the inner solver; its `max_products` limits all outer steps together.
        inner, with_inner: KprgpSettings = KprgpSettings::default();
    }
    and inner
}

impl SmalseSettings {
    /// Limits the operator products of all outer steps to this number, at least 1, if they may be more.
    #[must_use]
    pub fn limited_to(mut self, products: usize) -> Self {
        self.inner.max_products = self.inner.max_products.min(products).max(1);
        self
    }
}

/// Result of [`smalse`](crate::smalse()).
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[must_use = "it may not have converged: see `status`"]
pub struct SmalseReport {
    /// How the solve ended.
    pub status: Status,
    /// Outer steps.
    pub outer: usize,
    /// Inner steps by kind.
    pub steps: Steps,
    /// Operator products by cause.
    pub products: Products,
    /// Applications of a projector (one with `C` and one with `Cᵀ` each).
    pub projections: usize,
    /// Norm of the projected gradient at the end.
    pub projected_gradient: f64,
    /// Its tolerance.
    pub tolerance: f64,
    /// `|C x - e|` at the end.
    pub equality: f64,
    /// Its tolerance.
    pub equality_tolerance: f64,
    /// Precision control `M` at the end, relative to the norm.
    pub precision: f64,
}

/// Work memory of [`smalse`](crate::smalse()): six vectors, six coarse ones, and the scratches.
pub struct SmalseWorkspace<A: SymmetricOperator, C: Equality> {
    pub(crate) vectors: Vectors,
    pub(crate) state: State,
    pub(crate) residual: Vec<f64>,
    pub(crate) mu: Vec<f64>,
    pub(crate) a_scratch: A::Scratch,
    pub(crate) c_scratch: C::Scratch,
}

impl<A: SymmetricOperator, C: Equality> SmalseWorkspace<A, C> {
    /// Work memory for the two operators.
    #[must_use]
    pub fn new(a: &A, c: &C) -> Self {
        Self {
            vectors: Vectors::new(a.dim()),
            state: State::new(a.dim(), c.rows()),
            residual: vec![0.0; a.dim()],
            mu: vec![0.0; c.rows()],
            a_scratch: a.scratch(),
            c_scratch: c.scratch(),
        }
    }

    /// `A y - b` at the end of the last solve, `y = x - Cᵀ(C x - e)` being `x` moved onto the equality;
    /// kept by recurrence, no product is spent on it.
    #[must_use]
    pub fn residual(&self) -> &[f64] {
        &self.residual
    }

    /// Multiplier `mu` of `C x = e` in the original problem: `A y - b + Cᵀ mu` is the gradient of the Lagrangian.
    /// (The in/out multiplier of [`smalse`](crate::smalse()) belongs to the projected problem.)
    #[must_use]
    pub fn equality_multiplier(&self) -> &[f64] {
        &self.mu
    }
}
