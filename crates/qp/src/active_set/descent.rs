//! Descent for active sets whose predictions do not settle.
//!
//! The natural map is a Newton step on a piecewise linear problem and can run in circles. Where it does, each move to
//! a predicted set has to lower the cost `q(x) = 1/2 xᵀ A x - xᵀ b` from the last feasible point; where it does not,
//! the step of conjugate gradients is shortened and projected until it does (Bertsekas 1982: the projected step
//! descends as long as components that the gradient presses against their bound are active). Costs are compared by
//! their difference, which keeps its digits near the solution.
//!
//! Blocks that a shortened step takes across their boundary are held (*blocked*).
//! Where no length descends, the point stays and more blocks are held. They are released when the problem with them
//! is solved. All this holds between feasible points only: where set and equality hardly meet, moves that do not
//! descend are taken, too.

use crate::problem::{ConvexSet, ProductSet, SymmetricOperator};
use crate::tolerances::{INSIDE, KEPT_DECREASE, PROGRESS, RELEASE};
use crate::vector;

/// The last feasible point and the step from it to the minimum on its active set.
#[derive(Debug)]
pub(crate) struct DescentSafeguard {
    x: Vec<f64>,
    ax: Vec<f64>,
    residual: Vec<f64>,
    step: Vec<f64>,
    astep: Vec<f64>,
    /// Change of the cost by the whole step, before projection.
    full: f64,
    /// Smallest decrease by a whole step so far.
    best: f64,
    /// Whether the last step led from one feasible point to another, and whether it was taken back.
    exact: bool,
    stuck: bool,
    /// Error estimate of the last active set without blocked blocks.
    unblocked: f64,
    /// Whether the set followed at the last move, and how far constrained components moved when it did.
    pub(crate) current: bool,
    pub(crate) drift: f64,
}

impl DescentSafeguard {
    pub(crate) fn new(n: usize) -> Self {
        let v = || vec![0.0; n];
        Self {
            x: v(),
            ax: v(),
            residual: v(),
            step: v(),
            astep: v(),
            full: 0.0,
            best: f64::INFINITY,
            exact: false,
            stuck: false,
            unblocked: f64::INFINITY,
            current: true,
            drift: f64::INFINITY,
        }
    }

    /// Remembers a feasible point and its gradient.
    pub(crate) fn enter(&mut self, x: &[f64], ax: &[f64], residual: &[f64]) {
        vector::copy(x, &mut self.x);
        vector::copy(ax, &mut self.ax);
        vector::copy(residual, &mut self.residual);
    }

    /// Remembers the step to the minimum on the active set; whether less than ever is left to gain.
    pub(crate) fn leave(&mut self, operator: &impl SymmetricOperator, (x, ax): (&[f64], &[f64])) -> bool {
        vector::copy(x, &mut self.step);
        vector::subtract(&self.x, &mut self.step);
        vector::copy(ax, &mut self.astep);
        vector::subtract(&self.ax, &mut self.astep);
        let along = |v: &[f64]| operator.dot(&self.step, v);
        self.full = along(&self.residual) + 0.5 * along(&self.astep);
        let progress = self.exact && -self.full < PROGRESS * self.best;
        if progress {
            self.best = -self.full;
        }
        progress
    }

    /// Whether blocked blocks (`any` of them) are to be released at a set with this error estimate; `solved` is what
    /// decides where points are not feasible.
    pub(crate) fn releases(&mut self, any: bool, solved: bool, error: f64, limit: f64) -> bool {
        if !any {
            self.unblocked = error;
            return false;
        }
        let enough = if self.exact { error <= (RELEASE * self.unblocked).max(limit) } else { solved };
        enough && !self.stuck
    }

    /// Whether the cost at `x` has fallen enough for a step of length `t`.
    pub(crate) fn descends(&self, operator: &impl SymmetricOperator, (x, ax): (&[f64], &[f64]), t: f64) -> bool {
        let own = |(k, v): (usize, &f64)| (v - self.x[k]) * (self.residual[k] + 0.5 * (ax[k] - self.ax[k]));
        let changes: Vec<f64> = x.iter().enumerate().map(own).collect();
        operator.sum(&changes) <= KEPT_DECREASE * t * self.full
    }

    /// After a step of length `t`: whether it is one between feasible points that does not descend.
    pub(crate) fn judge(
        &mut self,
        operator: &impl SymmetricOperator,
        set: &ProductSet,
        (x, ax): (&[f64], &[f64]),
        t: f64,
    ) -> bool {
        let limit = 2.0 * INSIDE * operator.norm(x);
        self.exact = set.violation(&self.x) <= limit && set.violation(x) <= limit;
        self.stuck = false;
        self.exact && !self.descends(operator, (x, ax), t)
    }

    /// Back to the last feasible point.
    pub(crate) fn back(&mut self, x: &mut [f64], ax: &mut [f64]) {
        vector::copy(&self.x, x);
        vector::copy(&self.ax, ax);
        self.stuck = true;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::{Identity, Segment};

    /// At zero with the cost `1/2 |x|² - sum x` on the way to its minimum, all ones.
    fn safeguard() -> DescentSafeguard {
        let mut safeguard = DescentSafeguard::new(2);
        safeguard.enter(&[0.0; 2], &[0.0; 2], &[-1.0; 2]);
        assert!(
            !safeguard.leave(&Identity(2), (&[1.0; 2], &[1.0; 2])),
            "the first step tells nothing"
        );
        safeguard
    }

    fn half_space() -> ProductSet {
        ProductSet::new(vec![Segment::upper(vec![0.0]), Segment::Free(1)]).expect("a set")
    }

    #[test]
    fn a_move_has_to_keep_a_part_of_the_decrease() {
        let mut safeguard = safeguard();
        assert_eq!(safeguard.full, -1.0);
        assert!(safeguard.descends(&Identity(2), (&[1.0; 2], &[1.0; 2]), 1.0));
        assert!(
            !safeguard.descends(&Identity(2), (&[2.0; 2], &[2.0; 2]), 1.0),
            "as high as the start"
        );
        let (mut x, mut ax) = ([9.0; 2], [9.0; 2]);
        safeguard.shorten(0.25, &mut x, &mut ax);
        assert_eq!((x, ax), ([0.25; 2], [0.25; 2]));
        assert!(safeguard.descends(&Identity(2), (&x, &ax), 0.25));
        safeguard.back(&mut x, &mut ax);
        assert_eq!((x, ax), ([0.0; 2], [0.0; 2]));
    }

    #[test]
    fn moves_between_feasible_points_are_judged_and_others_are_not() {
        let (mut safeguard, set) = (safeguard(), half_space());
        // to the other side: feasible, and the cost rises
        let (x, ax) = ([-1.0, 0.0], [-1.0, 0.0]);
        assert!(safeguard.judge(&Identity(2), &set, (&x, &ax), 0.1) && safeguard.exact);
        // out of the set: nothing taken back
        let rises = safeguard.judge(&Identity(2), &set, (&[1.0; 2], &[1.0; 2]), 0.1);
        assert!(!rises && !safeguard.exact);
    }

    #[test]
    fn less_to_gain_than_ever_is_progress() {
        let (mut safeguard, set) = (safeguard(), half_space());
        let step = |safeguard: &mut DescentSafeguard, gain: f64| {
            safeguard.judge(&Identity(2), &set, (&[0.0; 2], &[0.0; 2]), 1.0);
            safeguard.enter(&[0.0; 2], &[0.0; 2], &[0.0, -gain]);
            safeguard.leave(&Identity(2), (&[0.0, 1.0], &[0.0; 2]))
        };
        assert!(step(&mut safeguard, 4.0));
        assert!(!step(&mut safeguard, 3.9), "hardly less");
        assert!(step(&mut safeguard, 3.0) && !step(&mut safeguard, 5.0));
    }

    #[test]
    fn blocked_blocks_are_released_where_the_problem_with_them_is_solved() {
        let mut safeguard = safeguard();
        assert!(!safeguard.releases(false, true, 1.0, 0.0), "there are none");
        // points that are not feasible: as the caller says
        assert!(safeguard.releases(true, true, 0.5, 0.0) && !safeguard.releases(true, false, 0.0, 1.0));
        safeguard.judge(&Identity(2), &half_space(), (&[0.0; 2], &[0.0; 2]), 1.0);
        assert!(!safeguard.releases(true, true, 0.5, 0.0));
        assert!(
            safeguard.releases(true, false, RELEASE, 0.0),
            "a hundredth of the error"
        );
        assert!(safeguard.releases(true, false, 0.5, 0.5), "within the limit");
        safeguard.back(&mut [0.0; 2], &mut [0.0; 2]);
        assert!(
            !safeguard.releases(true, true, 0.0, 1.0),
            "the point stays where it was"
        );
    }
}
