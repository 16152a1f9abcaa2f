//! Settings, report and work memory of [`kprgp`](crate::kprgp::kprgp).

use crate::error::{QpError, expect_setting};
use crate::operator::SymmetricOperator;
use crate::report::{Products, Status, Steps};

/// How the active set is enlarged when a conjugate gradient step leaves the set.
///
/// All of them first go to the boundary along the conjugate direction. The long steps (all but the
/// first) are kept only if they decrease the cost enough, else a fixed step is made instead, counted
/// in [`Products::fallback`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
#[non_exhaustive]
pub enum Expansion {
    /// Projected step along the free gradient with the fixed length. Has the convergence proof of
    /// Kucera (2008); one product.
    FixedStep,
    /// Projection of the full conjugate gradient step; one product.
    #[default]
    ProjectedCg,
    /// Projected step along the free gradient with the length that minimises the cost along it; two
    /// products, or one if the step stays inside.
    Optimal,
    /// Projected step along the free gradient with the shorter Barzilai-Borwein length of the last
    /// conjugate direction, `p·Ap / Ap·Ap`; one product.
    BarzilaiBorwein,
}

/// How components are released when the iterate is not proportional.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
#[non_exhaustive]
pub enum Release {
    /// Where a straight line is possible (bounds), the minimising length along the chopped gradient;
    /// else (discs) a projected step with the fixed length.
    Fixed,
    /// As `Fixed`, but projected steps take the Barzilai-Borwein length of the last such step: points
    /// that slide along their discs move at their own scale. Kept only if the cost decreases enough.
    #[default]
    Spectral,
}

/// Which gradient is compared with the tolerance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
#[non_exhaustive]
pub enum Measure {
    /// Norm of the projected gradient, the K-gradient of the paper.
    #[default]
    Projected,
    /// Norm of the reduced gradient `(x - P(x - a g)) / a`, which also becomes small where a radius is
    /// nearly 0.
    Reduced,
}

/// When the gradient, updated by recurrence, is computed afresh before convergence is declared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
#[non_exhaustive]
pub enum Verification {
    /// If the estimated drift of the recurrence is above a tenth of the tolerance.
    #[default]
    WhenNeeded,
    /// Always (one more product).
    Always,
    /// Never.
    Never,
}

/// Settings of [`kprgp`](crate::kprgp::kprgp).
///
/// | setting | meaning, relative to | range | default | letter in the literature |
/// |---|---|---|---|---|
/// | `proportioning` | ratio of chopped to free gradient at which components are released | > 0 | 1 | Gamma |
/// | `step_length` | fixed step, times 1 / norm of the Hessian | (0, 2] | 1.9 | alpha |
/// | `expansion` | see [`Expansion`] | | projected CG | |
/// | `release` | see [`Release`] | | spectral | |
/// | `measure` | see [`Measure`] | | projected | g^K |
/// | `verification` | see [`Verification`] | | when needed | |
/// | `max_products` | operator products of one solve | >= 1 | 10,000 | |
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct KprgpSettings {
    /// Ratio of chopped to free gradient at which components are released.
    pub proportioning: f64,
    /// Fixed step length times the norm of the Hessian.
    pub step_length: f64,
    /// Expansion of the active set.
    pub expansion: Expansion,
    /// Release from the active set.
    pub release: Release,
    /// Gradient norm that is compared with the tolerance.
    pub measure: Measure,
    /// Fresh gradient before convergence is declared.
    pub verification: Verification,
    /// Limit of the number of operator products.
    pub max_products: usize,
}

impl Default for KprgpSettings {
    fn default() -> Self {
        Self {
            proportioning: 1.0,
            step_length: 1.9,
            expansion: Expansion::default(),
            release: Release::default(),
            measure: Measure::default(),
            verification: Verification::default(),
            max_products: 10_000,
        }
    }
}

impl KprgpSettings {
    /// Sets the proportioning constant Gamma.
    #[must_use]
    pub fn with_proportioning(mut self, gamma: f64) -> Self {
        self.proportioning = gamma;
        self
    }
    /// Sets the fixed step length, relative to 1 / norm of the Hessian.
    #[must_use]
    pub fn with_step_length(mut self, step: f64) -> Self {
        self.step_length = step;
        self
    }
    /// Sets the expansion.
    #[must_use]
    pub fn with_expansion(mut self, expansion: Expansion) -> Self {
        self.expansion = expansion;
        self
    }
    /// Sets the release.
    #[must_use]
    pub fn with_release(mut self, release: Release) -> Self {
        self.release = release;
        self
    }
    /// Sets the measure of convergence.
    #[must_use]
    pub fn with_measure(mut self, measure: Measure) -> Self {
        self.measure = measure;
        self
    }
    /// Sets the verification.
    #[must_use]
    pub fn with_verification(mut self, verification: Verification) -> Self {
        self.verification = verification;
        self
    }
    /// Sets the limit of products.
    #[must_use]
    pub fn with_max_products(mut self, max: usize) -> Self {
        self.max_products = max;
        self
    }

    /// Checks the ranges.
    ///
    /// # Errors
    /// [`QpError::Setting`] naming the setting and its range.
    pub fn validate(&self) -> Result<(), QpError> {
        let g = self.proportioning;
        expect_setting("proportioning", g, "> 0, finite", g > 0.0 && g.is_finite())?;
        let a = self.step_length;
        expect_setting("step_length", a, "(0, 2]", a > 0.0 && a <= 2.0)?;
        expect_setting(
            "max_products",
            self.max_products as f64,
            ">= 1",
            self.max_products >= 1,
        )
    }
}

/// Result of [`kprgp`](crate::kprgp::kprgp).
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct KprgpReport {
    /// How the solve ended.
    pub status: Status,
    /// Steps by kind.
    pub steps: Steps,
    /// Operator products by cause.
    pub products: Products,
    /// Norm of the free gradient at the end.
    pub free: f64,
    /// Norm of the chopped gradient at the end.
    pub chopped: f64,
    /// The measure of convergence at the end.
    pub measure: f64,
    /// The tolerance it was compared with.
    pub tolerance: f64,
    /// How often the fixed step was halved because it raised the cost: above 0 the `norm` given to the
    /// solver was too small.
    pub halvings: usize,
    /// By how much the cost decreased since the (projected) start.
    pub decrease: f64,
    /// Cost `1/2 x·Ax - b·x` at the end.
    pub cost: f64,
}

impl KprgpReport {
    /// Norm of the projected gradient at the end.
    #[must_use]
    pub fn projected_gradient(&self) -> f64 {
        self.free.hypot(self.chopped)
    }
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
}

/// Work memory of [`kprgp`](crate::kprgp::kprgp): four vectors and the operator's scratch, created once.
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
