//! What the face method asks of the equality constraint `G x = e`.

use crate::balanced::LooseMode;
use crate::error::QpError;

/// The constraint `G x = e` seen from a face: weighted (oblique) projectors on `Ker G`.
///
/// With row weights `W >= 0` that vanish on every component held fixed by the inequality
/// constraints,
///
/// ```text
/// P_W = I - W Gᵀ (G W Gᵀ)⁻¹ G,        G P_W = 0
/// ```
///
/// changes weighted components only. With 0/1 weights that mark the free components of a face it is the
/// projector of projected conjugate gradients on that face. The space keeps its factorisation of
/// `G W Gᵀ` between calls and is therefore used through `&mut`.
pub trait EqualityProjector {
    /// Length of `x`.
    fn dim(&self) -> usize;

    /// Number of rows of `G`.
    fn rows(&self) -> usize;

    /// Sets the weights and factors `G W Gᵀ` if they differ from the last ones; returns whether it had to.
    ///
    /// # Errors
    /// [`QpError::CoarseDeficient`] if `G W Gᵀ` is singular: the free components do not hold every
    /// rigid mode. The previous factorisation is then lost.
    fn set_weights(&mut self, w: &[f64]) -> Result<bool, QpError>;

    /// As [`set_weights`](Self::set_weights), with pairs of components of weight zero that may move along one direction
    /// each (points that slide). For faces whose free components alone do not suffice; a space without such weights
    /// leaves the lines out.
    ///
    /// # Errors
    /// [`QpError::CoarseDeficient`] if that does not hold every rigid mode either.
    fn set_weights_and_lines(&mut self, w: &[f64], _lines: &[Line]) -> Result<bool, QpError> {
        self.set_weights(w)
    }

    /// Whether the components of weight zero, at their values in `x`, leave a balance that the others can complete: rigid
    /// modes that no component of positive weight holds must see no work of `e - G x`.
    fn balances(&mut self, _x: &[f64], _e: &[f64]) -> bool {
        true
    }

    /// `x <- P_W x`.
    fn project(&mut self, x: &mut [f64]);

    /// `g <- P_Wᵀ g = g - Gᵀ (G W Gᵀ)⁻¹ G W g`: the residual left after the best multiplier of `G`.
    fn project_transpose(&mut self, g: &mut [f64]);

    /// Whether [`project_step`](Self::project_step), [`project_step_transpose`](Self::project_step_transpose) and
    /// [`compensate`](Self::compensate) are rounded to less than working precision. `G x = e` then has to be restored
    /// after many steps.
    fn rounds_steps(&self) -> bool {
        false
    }

    /// [`project`](Self::project) for a step of an iteration: errors are relative to the step and need not be those of
    /// working precision.
    fn project_step(&mut self, x: &mut [f64]) {
        self.project(x);
    }

    /// [`project_transpose`](Self::project_transpose) for the change of a residual in a step of an iteration, likewise.
    fn project_step_transpose(&mut self, g: &mut [f64]) {
        self.project_transpose(g);
    }

    /// Multiplier of `G`: `out = -(G W Gᵀ)⁻¹ G W g`, so that `g + Gᵀ out = P_Wᵀ g`.
    fn multiplier(&mut self, g: &[f64], out: &mut [f64]);

    /// The least change of unconstrained components that restores `G x = e`, but for [loose](Self::loose) modes.
    fn repair(&mut self, x: &mut [f64], e: &[f64]);

    /// A step of an iteration in which the leading components change further: `to = from + change`, with what
    /// [`repair`](Self::repair) adds for the `change`. This default allocates; a space that iterates should have its own.
    fn compensate(&mut self, from: &[f64], change: &[f64], to: &mut [f64]) {
        to.fill(0.0);
        to[..change.len()].copy_from_slice(change);
        self.repair(to, &vec![0.0; self.rows()]);
        to.iter_mut().zip(from).for_each(|(t, f)| *t += f);
    }

    /// Modes that no unconstrained component stops: [`repair`](Self::repair) leaves them as they are, and constrained
    /// components have to balance them.
    fn loose(&self) -> &[LooseMode] {
        &[]
    }

    /// The change of weighted components, least in their metric, that restores `G x = e`; constrained ones may leave their
    /// set.
    fn balance(&mut self, x: &mut [f64], e: &[f64]) {
        self.repair(x, e);
    }
}

/// Weight `weight * c cᵀ` on the components `first` and `first + 1`, `c` the unit `direction`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// First of the two components.
    pub first: usize,
    /// Unit vector.
    pub direction: [f64; 2],
    /// Positive weight.
    pub weight: f64,
}

/// No equality constraint at all: every projector is the identity.
#[derive(Debug, Clone, Copy)]
pub struct NoEquality {
    dim: usize,
}

impl NoEquality {
    /// For vectors of length `dim`.
    #[must_use]
    pub fn new(dim: usize) -> Self {
        Self { dim }
    }
}

impl EqualityProjector for NoEquality {
    fn dim(&self) -> usize {
        self.dim
    }
    fn rows(&self) -> usize {
        0
    }
    fn set_weights(&mut self, _w: &[f64]) -> Result<bool, QpError> {
        Ok(false)
    }
    fn project(&mut self, _x: &mut [f64]) {}
    fn project_transpose(&mut self, _g: &mut [f64]) {}
    fn multiplier(&mut self, _g: &[f64], _out: &mut [f64]) {}
    fn repair(&mut self, _x: &mut [f64], _e: &[f64]) {}
    fn compensate(&mut self, from: &[f64], change: &[f64], to: &mut [f64]) {
        to.copy_from_slice(from);
        to.iter_mut().zip(change).for_each(|(t, c)| *t += c);
    }
}
