//! The moves of the active-set method from a solved set to the next one.

use crate::error::QpError;
use crate::problem::{EqualityProjector, SymmetricOperator};
use crate::tolerances::{BALANCE_ROUNDS, LEAST_PART, NEGLIGIBLE, SETTLED, SWING, SWINGING_ROUNDS, UNSURE};
use crate::vector;

use super::blocks::ActiveSet;
use super::iterate::natural_map;
use super::natural_map::settle_bounds;
use super::run::{Place, Run};
use super::view::ActiveSetPreconditioner;

impl<A: SymmetricOperator, C: EqualityProjector, M: ActiveSetPreconditioner> Run<'_, A, C, M> {
    /// Moves `x` to the next active set, with the next step of conjugate gradients, of this `length`, on top. The set
    /// follows where the active set has settled. Then set, equality and product are in order again.
    pub(crate) fn move_on(&mut self, length: f64, place: &Place) -> Result<(), QpError> {
        let constrained = self.at.constrained();
        self.at.mark();
        let (joint, unsure) = (self.joint_step(length), self.is_unsure());
        let at = &mut self.at;
        at.work.before.copy_from_slice(&at.x[..constrained]);
        if self.repairs_suffice && unsure {
            at.tell_map(ActiveSet::foresee);
        }
        self.moved.followed = self.has_settled();
        if self.repairs_suffice {
            self.settle()?;
        } else {
            self.settle_loose(false, self.moved.followed)?;
            if unsure {
                self.at.tell_map(ActiveSet::foresee_moved);
            }
        }
        let at = &mut self.at;
        self.moved.jump = vector::distance(&at.x[..constrained], &at.work.before);
        self.balance(joint, place);
        Ok(())
    }

    /// Whether the solved set is to tell what is active next, not the point moved to: on bodies that bend easily forces
    /// that pull, and are cut off, come back there.
    fn is_unsure(&self) -> bool {
        self.is_near_path() || self.progress.waited >= UNSURE
    }

    /// Moves `x` into the set as the natural map says, and lets the set follow.
    fn settle(&mut self) -> Result<(), QpError> {
        self.settle_bounds();
        if self.moved.followed {
            self.follow()?;
            // active components go with bounds that moved
            self.settle_bounds();
        }
        let at = &mut self.at;
        let map = natural_map(at.problem, &at.work.residual, at.step);
        at.work.active.settle_discs(at.set, at.x, &map);
        Ok(())
    }

    /// The same such that constrained components balance. At the `start` there is no natural map yet. A set that
    /// follows and a balance that follows the set may swing ever wider (friction that takes more than all of a pressure
    /// away): then it follows a point between.
    pub(crate) fn settle_loose(&mut self, start: bool, follow: bool) -> Result<(), QpError> {
        let constrained = self.at.constrained();
        let from = self.at.x[..constrained].to_vec();
        let mut rounds = if follow { BALANCE_ROUNDS } else { 1 };
        let mut swings = Swings::default();
        self.moved.unrest = 0.0;
        let mut round = 1;
        loop {
            let at = &mut self.at;
            let last = at.x[..constrained].to_vec();
            at.x[..constrained].copy_from_slice(&from);
            let mut balances = true;
            if !start {
                let map = natural_map(at.problem, &at.work.residual, at.step);
                at.work.active.aim(at.set, at.x, &map);
                balances = at.project();
            } else {
                at.begin()?;
            }
            if round > 1 {
                self.moved.unrest = vector::distance(&at.x[..constrained], &last);
                if swings.note(&last, &at.x[..constrained]) {
                    rounds = SWINGING_ROUNDS;
                }
            }
            if round >= rounds {
                if !start {
                    self.moved.unbalanced = if balances { 0 } else { self.moved.unbalanced + 1 };
                }
                return Ok(());
            }
            swings.calm(&mut at.x[..constrained]);
            self.follow()?;
            round += 1;
        }
    }

    /// The next step of conjugate gradients, which shares its product with the move: without constraints there is no
    /// move. Whether there is one.
    fn joint_step(&mut self, length: f64) -> bool {
        let at = &mut self.at;
        if at.constrained() == 0 {
            return false;
        }
        if length > 0.0 {
            vector::axpy(length, &at.work.p, at.x);
        }
        length > 0.0
    }

    fn settle_bounds(&mut self) {
        let at = &mut self.at;
        let map = natural_map(at.problem, &at.work.residual, at.step);
        settle_bounds(at.set, at.x, &map);
    }

    /// Whether few bounded components changed between free and active.
    pub(crate) fn has_settled(&self) -> bool {
        let active = &self.at.work.active;
        let few = (SETTLED * active.free_bounds as f64).max(2.0);
        active.changed as f64 <= few
    }

    /// Makes `G x = e` hold again, and the product exact; after what may be the last move, of next to nothing, only if
    /// the solve goes on.
    fn balance(&mut self, joint: bool, place: &Place) {
        let at = &mut self.at;
        if self.moved.jump > 0.0 || joint && self.moved.drifted {
            at.projector.repair_step(at.x, at.problem.rhs);
            self.moved.drifted = false;
        }
        if self.moved.jump > 0.0 || joint {
            let length = if self.may_end(place) { NEGLIGIBLE * place.limits.all } else { 0.0 };
            self.moved.behind = !self.at.correct(length) && length > 0.0;
        }
    }

    /// Whether the problem on the set is solved, and the move to the next one next to nothing.
    fn may_end(&self, place: &Place) -> bool {
        let short = self.moved.jump <= NEGLIGIBLE * place.limits.constrained;
        self.at.compliance.c == 0.0 && short && self.moved.followed && self.left.within(place.limits)
    }
}

/// Rounds in which a point that balances and a set that follows it swing about their limit: parts of ways as Irons and
/// Tuck (Int. J. Numer. Meth. Eng. 1, 1969) take them.
#[derive(Default)]
struct Swings {
    /// The last two ways from the point that was followed to the one that balances.
    ways: [Vec<f64>; 2],
    /// Part of the way at which the last point to be followed was taken.
    part: f64,
}

impl Swings {
    /// After a round that led from one point to another. Whether it went back most of the way of the round before.
    fn note(&mut self, from: &[f64], to: &[f64]) -> bool {
        self.ways.swap(0, 1);
        self.ways[1].clear();
        self.ways[1].extend(to.iter().zip(from).map(|(a, b)| a - b));
        let [before, now] = &self.ways;
        if before.is_empty() {
            self.part = 1.0;
            return false;
        }
        let change: Vec<f64> = now.iter().zip(before).map(|(a, b)| a - b).collect();
        let square = vector::dot(&change, &change);
        let swings = vector::dot(now, before) < -SWING * vector::dot(before, before);
        if square > 0.0 && (swings || self.part < 1.0) {
            self.part = (-self.part * vector::dot(before, &change) / square).clamp(LEAST_PART, 1.0);
        }
        swings
    }

    /// The point to be followed next, from the one that balances.
    fn calm(&self, x: &mut [f64]) {
        if self.part < 1.0 && !self.ways[1].is_empty() {
            vector::axpy(self.part - 1.0, &self.ways[1], x);
        }
    }
}
