//! Blocks of a separable convex set, and the parts of a gradient there.
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

/// One block of a separable set, as handed out by [`ProductSet::for_each_block`](super::ProductSet::for_each_block).
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
pub(crate) struct GradientNorms {
    /// `|phi|²`, free gradient.
    pub(crate) free: f64,
    /// `|beta|²`, chopped gradient.
    pub(crate) chopped: f64,
    /// Reduced free gradient times free gradient.
    pub(crate) reduced_free_dot: f64,
    /// Squared norm of the reduced free gradient.
    pub(crate) reduced_free: f64,
    /// Squared norm of the reduced chopped gradient.
    pub(crate) reduced_chopped: f64,
}

impl GradientNorms {
    /// Norm of the projected gradient `phi + beta`, the K-gradient of the paper.
    pub(crate) fn projected(&self) -> f64 {
        (self.free + self.chopped).sqrt()
    }
}
