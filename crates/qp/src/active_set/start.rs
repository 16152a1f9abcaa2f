//! The start of the active-set method: a point, its product and a first active set.

use crate::error::QpError;
use crate::problem::{ConvexSet, EqualityProjector, SymmetricOperator};
use crate::tolerances::{PRESSED, ROUNDED, SINK_ROUNDS};
use crate::vector;

use super::run::Run;
use super::view::ActiveSetPreconditioner;

impl<A: SymmetricOperator, C: EqualityProjector, M: ActiveSetPreconditioner> Run<'_, A, C, M> {
    /// A feasible point that satisfies `G x = e`, a first active set and the product with the point.
    pub(crate) fn start(&mut self) -> Result<(), QpError> {
        self.at.mark();
        let work = &mut *self.at.work;
        let partly = !work.known.is_empty();
        work.t[..work.known.len()].copy_from_slice(&work.known);
        work.known.clear();
        self.path.unknown = !self.is_known();
        let told = std::mem::take(&mut self.at.work.told);
        self.guess();
        // what nothing touches hangs on its springs
        self.at.on_springs = told && !self.is_known();
        if told {
            self.at.work.active.foresee_guess();
            // what slides all over stops a mode, too
            self.at.work.active.guess_sliding(self.at.set, self.at.x);
        }
        let stopped = if self.repairs_suffice || told {
            self.at.set_weights()?.is_some()
        } else {
            self.is_known() && self.at.project_start()
        };
        if !stopped {
            // only constraints stop a mode: a balance with all of them at work tells the first active set
            self.at.set_all_free()?;
            self.at.projector.balance(self.at.x, self.at.problem.rhs);
            self.follow()?;
            self.guess();
            if !self.repairs_suffice {
                self.sink()?;
            }
        }
        if !self.repairs_suffice {
            if !told || !stopped {
                self.settle_loose(true, true)?;
            }
            self.at.work.active.guess(self.at.set, self.at.x);
            if stopped {
                self.at.work.active.guess_sliding(self.at.set, self.at.x);
            }
        }
        if !(stopped && self.repairs_suffice) && self.at.set_weights()?.is_none() {
            self.at.set_all_free()?;
        }
        self.at.projector.repair(self.at.x, self.at.problem.rhs);
        self.peak = self.at.problem.operator.norm(self.at.x);
        // without constraints nothing but rounding may have moved
        let moves = self.at.constrained() > 0;
        // from nothing there is no way yet that a step could go on
        let shares = moves && self.at.work.first_step > 0.0 && stopped && self.repairs_suffice && !self.path.unknown;
        // all of a start costs as much as its move, and rounds less
        if !self.ax_known || partly && !shares {
            self.at.multiply();
        } else if shares {
            self.at.ahead = self.at.moved(0.0);
        } else {
            self.at.correct(if moves { 0.0 } else { ROUNDED * self.peak });
        }
        Ok(())
    }

    /// Where nothing is known of the contact, bodies that constraints alone hold sink into springs until they balance,
    /// rigid and without gluing. A spring alone has the stiffness of the preconditioner; `n` that are pressed at once
    /// are softer by the root of `n`, for a patch of `n` points is softer than its points by as much. Where most are
    /// pressed at once the gaps tell nothing, and `x` stays if it tells something.
    fn sink(&mut self) -> Result<(), QpError> {
        let (from, told) = (self.at.x.to_vec(), self.is_known());
        let mut stiffness = 1.0;
        for _ in 0..SINK_ROUNDS {
            let balances = self.at.sink(stiffness);
            let active = &mut self.at.work.active;
            active.guess(self.at.set, self.at.x);
            let pressed = active.free_bounds;
            if !balances || told && pressed as f64 > PRESSED * active.free.len() as f64 {
                vector::copy(&from, self.at.x);
                return self.follow();
            }
            stiffness = 1.0 / (pressed.max(1) as f64).sqrt();
            self.follow()?;
        }
        Ok(())
    }

    /// Projects `x` on the set and guesses the active set from it.
    fn guess(&mut self) {
        let at = &mut self.at;
        at.set.project(at.x);
        at.work.active.guess(at.set, at.x);
    }
}
