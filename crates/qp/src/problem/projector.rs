//! What the active-set method asks of the equality constraint `G x = e`.

use crate::error::QpError;

/// The constraint `G x = e` seen from an active set: weighted (oblique) projectors on `Ker G`.
///
/// With weights `W >= 0` of the components that vanish where the inequalities are active,
///
/// ```text
/// P_W = I - W Gᵀ (G W Gᵀ)⁻¹ G,        G P_W = 0
/// ```
///
/// changes weighted components only; weights 0 and 1 give the projector of projected conjugate gradients among the free
/// components. The projector keeps its factor of `G W Gᵀ` between calls and is therefore used through `&mut`.
///
/// The six methods without a default are all that a projector needs. The others are for projectors that know more:
/// directions along which pairs of components slide, steps in single precision, modes that constraints alone stop.
///
/// # Panics
/// Methods without a `Result` may panic on slices of another length; solvers check them.
pub trait EqualityProjector {
    /// Length of `x`.
    fn dim(&self) -> usize;

    /// Number of rows of `G`.
    fn rows(&self) -> usize;

    /// Sets the weights and factors `G W Gᵀ` if they differ from the last ones; returns whether it had to.
    ///
    /// # Errors
    /// [`QpError::CoarseDeficient`] if `G W Gᵀ` is singular: the free components do not determine the multiplier. The
    /// previous factor is then lost.
    fn set_weights(&mut self, w: &[f64]) -> Result<bool, QpError>;

    /// `x <- P_W x`.
    fn project(&mut self, x: &mut [f64]);

    /// `g <- P_Wᵀ g = g - Gᵀ (G W Gᵀ)⁻¹ G W g`: the residual left after the best multiplier of `G`.
    fn project_transpose(&mut self, g: &mut [f64]);

    /// The least change of unconstrained components that restores `G x = e`, but for [loose](Self::loose) modes.
    fn repair(&mut self, x: &mut [f64], e: &[f64]);

    // Directions besides weights.

    /// As [`set_weights`](Self::set_weights) for the leading components, while those behind them have weight 1, with
    /// pairs of components of weight zero that may move along one direction each (points that slide). The default
    /// leaves these out, and allocates.
    ///
    /// # Errors
    /// [`QpError::CoarseDeficient`] if that does not determine the multiplier either.
    #[doc(hidden)]
    fn set_weights_and_lines(&mut self, w: &[f64], _lines: &[LineWeight]) -> Result<bool, QpError> {
        let mut all = w.to_vec();
        all.resize(self.dim(), 1.0);
        self.set_weights(&all)
    }

    // Steps that round.

    /// Whether the steps of an iteration are projected in less than working precision; `G x = e` then has to be
    /// restored after many of them.
    #[doc(hidden)]
    fn rounds_steps(&self) -> bool {
        false
    }

    /// [`project`](Self::project) for a step of an iteration: errors are relative to the step.
    #[doc(hidden)]
    fn project_step(&mut self, x: &mut [f64]) {
        self.project(x);
    }

    /// [`project_transpose`](Self::project_transpose) for the change of a residual in a step, likewise.
    #[doc(hidden)]
    fn project_step_transpose(&mut self, g: &mut [f64]) {
        self.project_transpose(g);
    }

    /// [`project_transpose`](Self::project_transpose) for the gradients of one problem, one after another: errors are
    /// relative to what the last multiplier leaves of free components.
    #[doc(hidden)]
    fn project_gradient(&mut self, g: &mut [f64]) {
        self.project_transpose(g);
    }

    /// After a change of the weights: the same for the gradient that was projected last. Whether it is done; where it
    /// is not, the gradient is projected afresh.
    #[doc(hidden)]
    fn project_gradient_again(&mut self, _g: &mut [f64]) -> bool {
        false
    }

    /// [`repair`](Self::repair) between two active sets: errors are relative to what it changes.
    #[doc(hidden)]
    fn repair_step(&mut self, x: &mut [f64], e: &[f64]) {
        self.repair(x, e);
    }

    /// A step in which the leading components change further: `to = from + change`, with what [`repair`](Self::repair)
    /// adds for the `change`. This default allocates.
    #[doc(hidden)]
    fn compensate(&mut self, from: &[f64], change: &[f64], to: &mut [f64]) {
        to.fill(0.0);
        to[..change.len()].copy_from_slice(change);
        self.repair(to, &vec![0.0; self.rows()]);
        to.iter_mut().zip(from).for_each(|(t, f)| *t += f);
    }

    // Modes that no unconstrained component stops.

    /// These modes: [`repair`](Self::repair) leaves them as they are, and constrained components have to balance them,
    /// with their springs where they cannot alone.
    #[doc(hidden)]
    fn loose(&self) -> &[LooseMode] {
        &[]
    }

    /// Whether the components of weight zero, at their values in `x`, leave a balance that the others can complete:
    /// modes that no component of positive weight stops must see no work of `e - G x`.
    #[doc(hidden)]
    fn balances(&mut self, _x: &[f64], _e: &[f64]) -> bool {
        true
    }

    /// Whether the components of positive weight stop every [loose](Self::loose) mode without its springs.
    #[doc(hidden)]
    fn holds_without_springs(&mut self) -> bool {
        true
    }

    /// The change of weighted components, least in their metric, that restores `G x = e`; constrained ones may leave
    /// their set.
    #[doc(hidden)]
    fn balance(&mut self, x: &mut [f64], e: &[f64]) {
        self.repair(x, e);
    }
}

/// Weight `weight * c cᵀ` on the rows `row` and `row + 1` of `Gᵀ`, which are components of `x`; `c` is the unit
/// `direction`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineWeight {
    /// First of the two rows.
    pub row: usize,
    /// Unit vector.
    pub direction: [f64; 2],
    /// Weight, not negative.
    pub weight: f64,
}

/// A mode that no unconstrained component stops: a combination of the rows of `G` that vanishes on all of them but
/// springs.
#[derive(Debug, Clone, PartialEq)]
pub struct LooseMode {
    /// Factor of each row of `G`.
    pub amplitudes: Vec<f64>,
    /// What of the combination is not zero on the leading, constrained components: their numbers, in order, and values.
    pub row: Vec<(usize, f64)>,
    /// Unconstrained components that stop it like springs: number, value, and how much the component changes per
    /// gradient.
    pub springs: Vec<(usize, f64, f64)>,
}

impl LooseMode {
    /// From the factors of the rows of `G`, and what they make of the constrained components.
    #[must_use]
    pub fn new(amplitudes: Vec<f64>, row: &[f64]) -> Self {
        let entries = row.iter().copied().enumerate();
        Self {
            amplitudes,
            row: entries.filter(|(_, c)| *c != 0.0).collect(),
            springs: Vec::new(),
        }
    }
}
