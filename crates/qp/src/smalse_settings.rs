//! Settings, hook, report and work memory of [`smalse`](crate::smalse::smalse).

use crate::error::{QpError, expect_setting};
use crate::kprgp_settings::{KprgpSettings, Vectors};
use crate::operator::{Equality, SymmetricOperator};
use crate::penalised::State;
use crate::report::{Products, Status, Steps, Tolerance};

/// What changes from one outer step to the next (Step 4).
///
/// The first two act when the augmented Lagrangian did not grow enough, the third when the residual of the
/// equality did not fall enough.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Update {
    /// The paper's rule: `M` is multiplied by `shrink` = 1 / beta.
    Precision {
        /// In (0, 1); the paper's `1/beta`.
        shrink: f64,
    },
    /// Dostal's earlier rule: `rho` is multiplied by `grow`, up to `max` times the norm.
    Penalty {
        /// Above 1.
        grow: f64,
        /// Largest penalty relative to the norm.
        max: f64,
    },
    /// `rho` is multiplied by `grow`, up to `max` times the norm, whenever `|Cx - e|` is above `ratio` times
    /// that of the step before (the classical rule of augmented Lagrangians). Helps where the equality
    /// can hardly be met inside the set, so that its multiplier is large.
    Residual {
        /// In (0, 1).
        ratio: f64,
        /// Above 1.
        grow: f64,
        /// Largest penalty relative to the norm.
        max: f64,
    },
    /// Nothing changes.
    Fixed,
}

impl Default for Update {
    fn default() -> Self {
        Self::Precision { shrink: 0.5 }
    }
}

/// Settings of [`smalse`](crate::smalse::smalse), all dimensionless.
///
/// | setting | meaning | relative to | range | default | the paper's letter |
/// |---|---|---|---|---|---|
/// | `tolerance` | projected gradient at the end | see [`Tolerance`] | >= 0 | 1e-6 | `eps_1` |
/// | `equality` | `Cx - e` at the end | `max(|x|, |e|)`, at least what rounding errors of `b` make of `x` | > 0 | 1e-6 | `eps_1 M_0` |
/// | `penalty` | penalty | norm of `PAP` | > 0 | 3 | `rho` |
/// | `precision` | inner tolerance over `Cx - e` | norm of `PAP` | > 0 | 1 | `M_0` |
/// | `gradient_cap` | largest inner tolerance | reference of `tolerance` | > 0 | 0.1 | `eta` |
/// | `update` | see [`Update`] | | | `M` halved | `beta > 1` |
/// | `max_outer` | outer steps | | >= 1 | 500 | |
/// | `inner` | KPRGP; its `max_products` limits all outer steps together | | | | |
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SmalseSettings {
    /// Projected gradient at the end.
    pub tolerance: Tolerance,
    /// Residual of the equality at the end, relative to the larger of `|x|` and `|e|`, and to no less than what rounding errors of `b` may
    /// make of `x`.
    pub equality: f64,
    /// Penalty relative to the norm of `PAP`.
    pub penalty: f64,
    /// First precision control relative to the norm of `PAP`.
    pub precision: f64,
    /// Largest inner tolerance relative to the reference of the tolerance.
    pub gradient_cap: f64,
    /// Rule of Step 4.
    pub update: Update,
    /// Largest number of outer steps.
    pub max_outer: usize,
    /// Settings of the inner solver.
    pub inner: KprgpSettings,
}

impl Default for SmalseSettings {
    fn default() -> Self {
        Self {
            tolerance: Tolerance::default(),
            equality: 1e-6,
            penalty: 3.0,
            precision: 1.0,
            gradient_cap: 0.1,
            update: Update::default(),
            max_outer: 500,
            inner: KprgpSettings::default(),
        }
    }
}

impl SmalseSettings {
    /// Sets the tolerance of the projected gradient.
    #[must_use]
    pub fn with_tolerance(mut self, tolerance: Tolerance) -> Self {
        self.tolerance = tolerance;
        self
    }
    /// Sets the tolerance of the equality.
    #[must_use]
    pub fn with_equality(mut self, equality: f64) -> Self {
        self.equality = equality;
        self
    }
    /// Sets the penalty.
    #[must_use]
    pub fn with_penalty(mut self, penalty: f64) -> Self {
        self.penalty = penalty;
        self
    }
    /// Sets the precision control.
    #[must_use]
    pub fn with_precision(mut self, precision: f64) -> Self {
        self.precision = precision;
        self
    }
    /// Sets the cap of the inner tolerance.
    #[must_use]
    pub fn with_gradient_cap(mut self, cap: f64) -> Self {
        self.gradient_cap = cap;
        self
    }
    /// Sets the update rule.
    #[must_use]
    pub fn with_update(mut self, update: Update) -> Self {
        self.update = update;
        self
    }
    /// Sets the limit of outer steps.
    #[must_use]
    pub fn with_max_outer(mut self, max: usize) -> Self {
        self.max_outer = max;
        self
    }
    /// Sets the inner solver.
    #[must_use]
    pub fn with_inner(mut self, inner: KprgpSettings) -> Self {
        self.inner = inner;
        self
    }

    /// Checks the ranges.
    ///
    /// # Errors
    /// [`QpError::Setting`] naming the setting and its range.
    pub fn validate(&self) -> Result<(), QpError> {
        self.inner.validate()?;
        for (name, v) in [
            ("equality", self.equality),
            ("penalty", self.penalty),
            ("precision", self.precision),
            ("gradient_cap", self.gradient_cap),
        ] {
            expect_setting(name, v, "> 0, finite", v > 0.0 && v.is_finite())?;
        }
        expect_setting(
            "max_outer",
            self.max_outer as f64,
            ">= 1",
            self.max_outer >= 1,
        )?;
        match self.update {
            Update::Precision { shrink } => expect_setting(
                "update.shrink",
                shrink,
                "(0, 1)",
                shrink > 0.0 && shrink < 1.0,
            ),
            Update::Penalty { grow, max } => {
                expect_setting(
                    "update.grow",
                    grow,
                    "> 1, finite",
                    grow > 1.0 && grow.is_finite(),
                )?;
                let inside = max >= self.penalty && max.is_finite();
                expect_setting("update.max", max, "at least the penalty, finite", inside)
            }
            Update::Residual { ratio, grow, max } => {
                expect_setting("update.ratio", ratio, "(0, 1)", ratio > 0.0 && ratio < 1.0)?;
                expect_setting(
                    "update.grow",
                    grow,
                    "> 1, finite",
                    grow > 1.0 && grow.is_finite(),
                )?;
                let inside = max >= self.penalty && max.is_finite();
                expect_setting("update.max", max, "at least the penalty, finite", inside)
            }
            Update::Fixed => Ok(()),
        }
    }
}

/// What a hook sees after Step 1 of an outer step.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct OuterStep<'a> {
    /// Number of the outer step, from 0.
    pub index: usize,
    /// Iterate, feasible for the set as it is before the hook.
    pub x: &'a [f64],
    /// Norm of the projected gradient.
    pub projected_gradient: f64,
    /// `|C x - e|`.
    pub equality: f64,
    /// Whether both are within their tolerances: the solve ends here if the hook changes nothing.
    pub converged: bool,
    /// Operator products so far.
    pub products: usize,
}

/// What a hook did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HookAction {
    /// Nothing, or nothing that matters: the solve may end.
    Continue,
    /// The set (radii, bounds) was changed: `x` is projected on it again and the solve goes on.
    SetChanged,
    /// The solve is to end with [`Status::Stopped`].
    Stop,
}

/// Called after Step 1 of every outer step; may change the set. Closures of that form implement it, `()`
/// does nothing.
pub trait OuterHook<S: ?Sized> {
    /// See [`OuterHook`].
    fn after_step(&mut self, step: &OuterStep<'_>, set: &mut S) -> HookAction;
}

impl<S: ?Sized> OuterHook<S> for () {
    fn after_step(&mut self, _step: &OuterStep<'_>, _set: &mut S) -> HookAction {
        HookAction::Continue
    }
}

impl<S: ?Sized, F: FnMut(&OuterStep<'_>, &mut S) -> HookAction> OuterHook<S> for F {
    fn after_step(&mut self, step: &OuterStep<'_>, set: &mut S) -> HookAction {
        self(step, set)
    }
}

/// Result of [`smalse`](crate::smalse::smalse).
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
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
    /// Penalty at the end, relative to the norm.
    pub penalty: f64,
    /// Precision control `M` at the end, relative to the norm.
    pub precision: f64,
}

/// Work memory of [`smalse`](crate::smalse::smalse): six vectors, six coarse ones, and the scratches.
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

    /// Gradient of the augmented Lagrangian at the end of the last solve.
    #[must_use]
    pub fn gradient(&self) -> &[f64] {
        &self.vectors.g
    }

    /// `A y - b` at the end of the last solve, `y = x - Cᵀ(C x - e)` being `x` moved onto the equality;
    /// kept by recurrence, no product is spent on it.
    #[must_use]
    pub fn residual(&self) -> &[f64] {
        &self.residual
    }

    /// Multiplier `mu` of `C x = e` in the original problem: `A y - b + Cᵀ mu` is the gradient of the
    /// Lagrangian. (The in/out multiplier of [`smalse`](crate::smalse::smalse) belongs to the projected
    /// problem.)
    #[must_use]
    pub fn equality_multiplier(&self) -> &[f64] {
        &self.mu
    }
}
