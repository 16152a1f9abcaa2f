//! Work memory of the active-set method.

use crate::problem::{LineWeight, SymmetricOperator};

use super::blocks::ActiveSet;
use super::coupling::{Coupling, RadiusSlope};

/// Vectors of the active-set method: five of the length of `x`, a sixth where radii follow other components, five
/// of its constrained part and the classification of the blocks.
#[derive(Debug)]
pub struct ActiveSetWorkspace<A: SymmetricOperator, M: SymmetricOperator> {
    pub(crate) operator: A::Scratch,
    pub(crate) preconditioner: M::Scratch,
    /// `A x - b` without its part in the image of `Gᵀ`.
    pub(crate) residual: Vec<f64>,
    /// Constrained part of the residual on the active set.
    pub(crate) restricted: Vec<f64>,
    /// Constrained part of `residual` while the restricted one stands in its place.
    pub(crate) saved: Vec<f64>,
    /// Constrained part of `x` before it moves to the next active set.
    pub(crate) before: Vec<f64>,
    pub(crate) z_norm: f64,
    pub(crate) z: Vec<f64>,
    pub(crate) p: Vec<f64>,
    pub(crate) ap: Vec<f64>,
    /// Weights of the constrained components.
    pub(crate) w: Vec<f64>,
    pub(crate) lines: Vec<LineWeight>,
    /// The point whose product `ax` is, once marked; the move away from it, once asked for and while `ahead`.
    pub(crate) t: Vec<f64>,
    /// Constrained components of the point that the product handed in is of; empty for those of the start.
    pub(crate) known: Vec<f64>,
    /// Length of a step that may share the product of the start; 0 for none.
    pub(crate) first_step: f64,
    /// Whether the start tells the first active set.
    pub(crate) told: bool,
    /// Whether the next solve ends on the first active set.
    pub(crate) enters_only: bool,
    pub(crate) active: ActiveSet,
    pub(crate) coupling: Coupling,
    /// Length of the last step of conjugate gradients.
    pub(crate) length: f64,
    /// Shortest step so far, and the largest `|Ap| / |p|` of those that were the shortest.
    pub(crate) shortest: f64,
    pub(crate) steepest: f64,
    /// Whether any step was long, and the farthest that one has led since `A x` was computed afresh.
    pub(crate) leapt: bool,
    pub(crate) leap: f64,
}

impl<A: SymmetricOperator, M: SymmetricOperator> ActiveSetWorkspace<A, M> {
    /// Allocates everything the method needs.
    pub fn new(operator: &A, preconditioner: &M) -> Self {
        let n = operator.dim();
        let v = || vec![0.0; n];
        Self {
            operator: operator.scratch(),
            preconditioner: preconditioner.scratch(),
            residual: v(),
            restricted: Vec::new(),
            saved: Vec::new(),
            before: Vec::new(),
            z_norm: 0.0,
            z: v(),
            p: v(),
            ap: v(),
            w: Vec::new(),
            lines: Vec::new(),
            t: v(),
            known: Vec::new(),
            first_step: 0.0,
            told: false,
            enters_only: false,
            active: ActiveSet::default(),
            coupling: Coupling::default(),
            length: 0.0,
            shortest: f64::INFINITY,
            steepest: 0.0,
            leapt: false,
            leap: 0.0,
        }
    }

    /// Tells how the hook moves the radii, for the solves to come: conjugate gradients then take this along instead
    /// of meeting it at each change of the active set. Optional; a disc without a slope is moved by the hook alone.
    /// The solution does not depend on it. The next solve refuses slopes that are not finite, or of no disc.
    pub fn set_slopes(&mut self, slopes: &[RadiusSlope]) {
        self.coupling.set(slopes);
    }

    /// Tells the next solve that the product handed in is that of the start with these constrained components in place
    /// of its own (none: with its own), and the [shortest step](Self::shortest_step) of an earlier solve, 0 if there
    /// was none: where the set moves the start, a step of that length shares the product.
    pub fn set_start(&mut self, known: &[f64], shortest: f64) {
        self.known.clear();
        self.known.extend_from_slice(known);
        self.first_step = shortest;
    }

    /// Tells the next solve that components on their bounds at the start are active, and discs on their circles slide,
    /// but no others, as [`interior_point()`](crate::interior_point()) leaves them: its gradient is too rough to tell.
    pub fn trust_start(&mut self) {
        self.told = true;
    }

    /// Tells the next solve to enter the active set of its start, with projector and preconditioner, and to solve
    /// nothing on it; its point is then not to be used.
    #[doc(hidden)]
    pub fn enter_only(&mut self) {
        self.enters_only = true;
    }

    /// The shortest step of conjugate gradients in the last solve, infinite if it made none: one of that length
    /// magnifies next to nothing.
    #[must_use]
    pub fn shortest_step(&self) -> f64 {
        self.shortest
    }

    /// Makes room for `constrained` leading components with constraints.
    pub(crate) fn resize(&mut self, constrained: usize) {
        self.restricted.resize(constrained, 0.0);
        self.saved.resize(constrained, 0.0);
        self.before.resize(constrained, 0.0);
        self.w.resize(constrained, 0.0);
    }

    /// `P_Wᵀ (A x - b)` at the last iterate: the gradient without the part that the multiplier of
    /// `G x = e` balances.
    #[must_use]
    pub fn residual(&self) -> &[f64] {
        &self.residual
    }
}
