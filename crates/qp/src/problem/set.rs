//! What a solver asks of a separable convex set: project, split the gradient, feasible step.
//!
//! A set `Omega` is a product of blocks (single components or discs of two). At a feasible `x` with
//! gradient `g` every block is *free* (inside) or *active* (on its boundary), and the gradient falls
//! apart accordingly (Kucera, SIAM J. Optim. 19, 2008; Dostal and Schoeberl, Comput. Optim. Appl. 30, 2005):
//!
//! | part | on free blocks | on active blocks |
//! |---|---|---|
//! | free gradient `phi` | `g` | 0 |
//! | chopped gradient `beta` | 0 | `g` less its part along the outward normal, if `-g` points out |
//! | reduced free gradient | `(x - P(x - a g)) / a` | 0 |
//! | reduced chopped gradient | 0 | `(x - P(x - a g)) / a` |
//!
//! with `P` the projection on the set and `a > 0` a fixed step length. `phi + beta` is the projected
//! gradient, the K-gradient of the paper: it vanishes exactly at the minimiser.

use crate::error::SetError;

/// Where a block of a feasible point lies in its part of the set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum BlockState {
    /// Component(s) strictly between the bounds, or without bounds.
    Free,
    /// A component on its lower bound.
    AtLower,
    /// A component on its upper bound.
    AtUpper,
    /// A block with one admissible value: equal bounds or a disc of radius 0.
    Fixed,
    /// A point inside its disc.
    Interior,
    /// A point on the circle of its disc.
    Boundary,
}

impl BlockState {
    /// Whether all components of the block may move in both directions.
    pub(crate) fn is_free(self) -> bool {
        matches!(self, Self::Free | Self::Interior)
    }
}

/// One block of a separable set, as handed out by [`ConvexSet::for_each_block`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Block {
    /// First component.
    pub start: usize,
    /// Number of components: 1 for bounds, 2 for a disc, any number for free components.
    pub len: usize,
    /// Position of the given point.
    pub state: BlockState,
}

/// Squared norms and the one mixed product of the gradient parts.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct GradientNorms {
    /// `|phi|²`, free gradient.
    pub free: f64,
    /// `|beta|²`, chopped gradient.
    pub chopped: f64,
    /// Reduced free gradient times free gradient.
    pub reduced_free_dot: f64,
    /// Squared norm of the reduced free gradient.
    pub reduced_free: f64,
    /// Squared norm of the reduced chopped gradient.
    pub reduced_chopped: f64,
}

impl GradientNorms {
    /// Norm of the projected gradient `phi + beta`, the K-gradient of the paper.
    pub(crate) fn projected(&self) -> f64 {
        (self.free + self.chopped).sqrt()
    }

    /// Norm of the reduced gradient `(x - P(x - a g)) / a`; never larger than
    /// [`projected`](Self::projected) and, unlike it, a continuous function of `x`.
    pub(crate) fn reduced(&self) -> f64 {
        (self.reduced_free + self.reduced_chopped).sqrt()
    }
}

/// A closed convex set that is a product of small blocks.
///
/// Every method works on slices of length [`dim`](ConvexSet::dim). "Feasible" means as returned by
/// [`project`](ConvexSet::project): a component on a bound has exactly the value of the bound.
/// [`check_set_laws`](crate::laws::check_set_laws) tests an implementation.
///
/// # Panics
/// Methods may panic on slices of another length; solvers check them.
pub trait ConvexSet: Sync {
    /// Length of the vectors.
    fn dim(&self) -> usize;

    /// Checks the data of the set (bounds in order, radii not negative, nothing NaN); solvers call it
    /// before the first iteration and after every change.
    ///
    /// # Errors
    /// [`SetError`] naming the segment and the entry.
    fn validate(&self) -> Result<(), SetError> {
        Ok(())
    }

    /// Replaces `x` by the nearest point of the set.
    fn project(&self, x: &mut [f64]);

    /// Euclidean distance of `x` from the set.
    fn violation(&self, x: &[f64]) -> f64;

    /// Largest `t >= 0` with `x - t p` in the set, `+inf` if there is none; `x` is feasible.
    fn feasible_step(&self, x: &[f64], p: &[f64]) -> f64;

    /// `x -= t p`, with `t` at most the feasible step; blocks that reach their boundary at or before `t`
    /// are put on it without rounding error.
    fn advance(&self, x: &mut [f64], p: &[f64], t: f64);

    /// Writes the free gradient to `free` and returns the norms of all parts for the step length `step`.
    fn split(&self, x: &[f64], g: &[f64], step: f64, free: &mut [f64]) -> GradientNorms;

    /// Writes the chopped gradient to `out`.
    fn chopped(&self, x: &[f64], g: &[f64], out: &mut [f64]);

    /// Calls `visit` for every block in ascending order of components. A run of unconstrained components is one block.
    fn for_each_block(&self, x: &[f64], visit: &mut dyn FnMut(Block));
}
