//! What the solvers have in common: tolerance, status, counts.

use crate::error::{QpError, expect_setting};

/// How a solve ended. All of these are in an `Ok` report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Status {
    /// The tolerance was reached.
    Converged,
    /// The allowed number of operator products or outer steps was spent.
    IterationLimit,
    /// No further progress: the gradient is at the level of rounding errors, above the tolerance.
    Stagnated,
    /// The set, as it follows the solution, holds no point that satisfies the equality.
    Infeasible,
    /// The caller's hook asked to stop.
    Stopped,
}

impl Status {
    /// Whether the tolerance was reached.
    #[must_use]
    pub fn converged(self) -> bool {
        self == Self::Converged
    }
}

/// When a solve ends: mostly where a gradient norm counts as small.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Tolerance {
    /// At most this value, in the units of the gradient.
    Absolute(f64),
    /// At most this multiple of the solver's own reference: `|b|` for KPRGP (the norm of the first gradient
    /// if `b` is zero), `|P (b - A C'e)|` for
    /// SMALSE (the paper's `|P h|`; one more product if `e` is not zero).
    Relative(f64),
    /// At most `factor * reference`, the reference being known to the caller.
    RelativeTo {
        /// Dimensionless factor.
        factor: f64,
        /// In the units of the gradient.
        reference: f64,
    },
    /// [`projected_cg`](crate::projected_cg()): the preconditioned gradient, which estimates the error of `x`, is at most this multiple of
    /// `|x|`. Solvers without preconditioner take it as [`Relative`](Self::Relative).
    Error {
        /// Dimensionless factor.
        factor: f64,
        /// What `|x|` counts at least, in its units.
        least: f64,
    },
}

impl Tolerance {
    /// The tolerance in the units of the gradient; `own` is the reference of the solver.
    #[must_use]
    pub fn resolve(self, own: f64) -> f64 {
        match self {
            Self::Absolute(t) => t,
            Self::Relative(f) | Self::Error { factor: f, .. } => f * own,
            Self::RelativeTo { factor, reference } => factor * reference,
        }
    }
}

/// A resolved tolerance, if it is usable.
pub(crate) fn usable(tolerance: f64) -> Result<f64, QpError> {
    let good = tolerance >= 0.0 && tolerance.is_finite();
    expect_setting("tolerance", tolerance, ">= 0, finite", good)?;
    Ok(tolerance)
}

impl Default for Tolerance {
    fn default() -> Self {
        Self::Relative(1e-6)
    }
}

/// Steps by kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub struct Steps {
    /// Conjugate gradient steps that stayed inside the set.
    pub cg: usize,
    /// Expansions of the active set.
    pub expansion: usize,
    /// Releases from the active set.
    pub proportioning: usize,
}

impl Steps {
    /// All steps.
    #[must_use]
    pub fn total(&self) -> usize {
        self.cg + self.expansion + self.proportioning
    }
}

impl std::ops::AddAssign for Steps {
    fn add_assign(&mut self, o: Self) {
        self.cg += o.cg;
        self.expansion += o.expansion;
        self.proportioning += o.proportioning;
    }
}

/// Operator products by cause.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub struct Products {
    /// Gradient at the start.
    pub initial: usize,
    /// Along conjugate gradient directions, those that end in an expansion included.
    pub cg: usize,
    /// Gradients after expansions.
    pub expansion: usize,
    /// Products of proportioning steps.
    pub proportioning: usize,
    /// Repeated steps after a long step that did not decrease the cost.
    pub fallback: usize,
    /// Gradients computed afresh: against drift, and after the caller changed the set.
    pub restart: usize,
    /// For the reference of a relative tolerance.
    pub reference: usize,
}

impl Products {
    /// All products.
    #[must_use]
    pub fn total(&self) -> usize {
        self.initial
            + self.cg
            + self.expansion
            + self.proportioning
            + self.fallback
            + self.restart
            + self.reference
    }
}

impl std::ops::AddAssign for Products {
    fn add_assign(&mut self, o: Self) {
        self.initial += o.initial;
        self.cg += o.cg;
        self.expansion += o.expansion;
        self.proportioning += o.proportioning;
        self.fallback += o.fallback;
        self.restart += o.restart;
        self.reference += o.reference;
    }
}
