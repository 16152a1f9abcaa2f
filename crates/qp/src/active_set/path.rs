//! A path of compliant constraints to an active set where predictions fail.
//!
//! Where a body bends easily, forces gather at the rim of what touches, and a set predicted from a solved one is no
//! closer to the solution. [Springs](super::compliance) in series with the constrained components spread the forces,
//! and with much compliance few predictions settle. From one such set to that of a tenth of it little changes, down to
//! none (Moreau-Yosida regularisation with path-following: Hintermüller and Kunisch, SIAM J. Optim. 17, 2006). A change
//! of the compliance costs no product, only its end one, for large terms have rounded.

use crate::problem::{ConvexSet, EqualityProjector, SymmetricOperator};
use crate::tolerances::{
    AWAY, AWAY_SETS, LEAST_COMPLIANCE, LED_AWAY, LESS_COMPLIANT, MORE_COMPLIANT, PATHS, PATIENCE, START_COMPLIANCE,
};

use super::iterate::Lengths;
use super::run::{Place, Progress, Run};
use super::view::ActiveSetPreconditioner;

impl<A: SymmetricOperator, C: EqualityProjector, M: ActiveSetPreconditioner> Run<'_, A, C, M> {
    /// Whether predictions run in circles, or away from a start that told nothing, and a path is to be tried.
    pub(crate) fn wants_path(&mut self, place: &Place) -> bool {
        if self.path.first.is_none() && !place.errors.within(place.limits) {
            self.path.first = Some(place.errors.all);
        }
        let over = self.path.first.map_or(0.0, |first| place.errors.all / first);
        self.path.away = if over > AWAY { self.path.away + 1 } else { 0 };
        let stays_away = self.repairs_suffice && self.path.away >= AWAY_SETS;
        let far = self.path.begun == 0 && (over > LED_AWAY || stays_away);
        let lost = self.path.unknown && far || self.in_circles(PATIENCE);
        lost && self.path.begun < PATHS
    }

    /// Begins the path, or one of more compliance, from no forces.
    pub(crate) fn begin_path(&mut self) {
        let at = &mut self.at;
        let c = START_COMPLIANCE * MORE_COMPLIANT.powi(self.path.begun);
        self.path.begun += 1;
        at.x.fill(0.0);
        at.set.project(at.x);
        at.projector.balance(at.x, at.problem.rhs);
        at.projector.repair(at.x, at.problem.rhs);
        at.set_compliance(c);
        at.multiply();
        self.peak = at.problem.operator.norm(at.x);
        self.begin_anew();
    }

    /// Where the problem with springs is solved: those of a tenth, in the end none. Whether they have changed.
    pub(crate) fn hardens(&mut self, place: &Place) -> bool {
        let c = self.at.compliance.c;
        let tried = self.at.report.active_sets > self.path.since;
        let hardens = c > 0.0 && tried && self.has_settled() && place.errors.within(place.limits);
        if hardens {
            let less = LESS_COMPLIANT * c;
            if less >= LEAST_COMPLIANCE {
                self.at.set_compliance(less);
                self.begin_anew();
            } else {
                self.leave_path();
            }
        }
        hardens
    }

    /// Whether supports hold the bodies, and a path has not been left for long.
    pub(crate) fn is_near_path(&self) -> bool {
        let soon = self.at.report.active_sets <= self.path.since + PATIENCE;
        self.repairs_suffice && self.path.begun > 0 && (soon || self.at.compliance.c > 0.0)
    }

    /// Ends the path: no springs. Whether there were any.
    pub(crate) fn leave_path(&mut self) -> bool {
        let on = self.at.compliance.c > 0.0;
        if on {
            self.at.set_compliance(0.0);
            self.at.multiply();
            self.begin_anew();
        }
        on
    }

    /// Another problem: nothing is known of errors.
    fn begin_anew(&mut self) {
        self.path.since = self.at.report.active_sets;
        self.progress = Progress::NONE;
        self.left = Lengths::INFINITE;
        self.first_error = f64::INFINITY;
        self.least_error = f64::INFINITY;
        self.moved.behind = false;
        self.moved.unbalanced = 0;
    }
}
