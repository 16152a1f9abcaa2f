//! Descent for faces whose predictions do not settle.
//!
//! The natural map is a Newton step on a piecewise linear problem and can run in circles. Where it does, each move to
//! a predicted face has to lower the cost `q(x) = 1/2 xᵀ A x - xᵀ b` from the last feasible point; where it does not,
//! the step of conjugate gradients is shortened and projected until it does (Bertsekas 1982: the projected step descends
//! as long as components that the gradient presses against their bound are held). Costs are compared by their difference,
//! which keeps its digits near the solution.

use crate::coarse_space::CoarseSpace;
use crate::error::QpError;
use crate::product::ProductSet;
use crate::set::ConvexSet;
use crate::vector;

/// The last feasible point and the step from it to the minimum on its face.
#[derive(Debug)]
pub(crate) struct Guard {
    x: Vec<f64>,
    ax: Vec<f64>,
    residual: Vec<f64>,
    step: Vec<f64>,
    astep: Vec<f64>,
    /// Change of the cost by the whole step, before projection.
    full: f64,
}

/// Share of the decrease on the face that a move has to keep.
const SUFFICIENT: f64 = 1e-2;

/// Steps shortened below this part of their length are held up by blocks at their boundary.
pub(crate) const SHORT: f64 = 0.3;

/// Shortest step that is tried.
pub(crate) const SHORTEST: f64 = 1e-3;

impl Guard {
    pub(crate) fn new(n: usize) -> Self {
        let v = || vec![0.0; n];
        Self {
            x: v(),
            ax: v(),
            residual: v(),
            step: v(),
            astep: v(),
            full: 0.0,
        }
    }

    /// Remembers a feasible point and its gradient.
    pub(crate) fn enter(&mut self, x: &[f64], ax: &[f64], residual: &[f64]) {
        vector::copy(x, &mut self.x);
        vector::copy(ax, &mut self.ax);
        vector::copy(residual, &mut self.residual);
    }

    /// Remembers the step to the minimum on the face.
    pub(crate) fn leave(&mut self, x: &[f64], ax: &[f64]) {
        vector::copy(x, &mut self.step);
        vector::subtract(&self.x, &mut self.step);
        vector::copy(ax, &mut self.astep);
        vector::subtract(&self.ax, &mut self.astep);
        self.full =
            vector::dot(&self.step, &self.residual) + 0.5 * vector::dot(&self.step, &self.astep);
    }

    /// Whether the cost at `x` has fallen enough for a step of length `t`.
    pub(crate) fn descends(&self, x: &[f64], ax: &[f64], t: f64) -> bool {
        let mut change = 0.0;
        for (k, v) in x.iter().enumerate() {
            change += (v - self.x[k]) * (self.residual[k] + 0.5 * (ax[k] - self.ax[k]));
        }
        change <= SUFFICIENT * t * self.full
    }

    /// The last feasible point and the step from it.
    pub(crate) fn path(&self) -> (&[f64], &[f64]) {
        (&self.x, &self.step)
    }

    /// The point at `t` times the step, not projected.
    pub(crate) fn shorten(&self, t: f64, x: &mut [f64], ax: &mut [f64]) {
        vector::copy(&self.x, x);
        vector::axpy(t, &self.step, x);
        vector::copy(&self.ax, ax);
        vector::axpy(t, &self.astep, ax);
    }
}

/// Most rounds of [`restore`].
const ROUNDS: usize = 500;

/// Distance to the set over the norm of `x` that ends them.
const INSIDE: f64 = 1e-11;

/// Moves `x` into the set and to `G x = e`: once each where unconstrained components make up for the rest, else
/// alternately (von Neumann's projections on two convex sets). `w` marks the components that may move.
pub(crate) fn restore<C: CoarseSpace>(
    coarse: &mut C,
    set: &ProductSet,
    x: &mut [f64],
    e: &[f64],
    w: &[f64],
) -> Result<(), QpError> {
    set.project(x);
    coarse.balance(x, e, w)?;
    if coarse.repairs_apart() {
        set.project(x);
        coarse.repair(x, e);
        return Ok(());
    }
    for _ in 0..ROUNDS {
        if set.violation(x) <= INSIDE * vector::norm(x) {
            break;
        }
        set.project(x);
        coarse.balance(x, e, w)?;
    }
    Ok(())
}
