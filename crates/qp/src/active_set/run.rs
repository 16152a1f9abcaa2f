//! The steps of the active-set method: what happens on one active set. [`moves`](super::moves) lead to the next one.

use std::mem::Discriminant;

use crate::error::{QpError, SetError};
use crate::problem::{ConvexSet, EqualityProjector, Hook, MovingSet, ProductSet, Segment, SymmetricOperator};
use crate::report::Status;
use crate::tolerances::{
    BEHIND_PATH, LONGER, MAGNIFIED, NATURAL_STEP, NEGLIGIBLE, ON_PATH, PASSING_PART, PATIENCE, PROGRESS, ROUNDED,
    RUNAWAY, SHRUNK, SMALL_PART, UNBALANCED,
};
use crate::vector;

use super::blocks::ActiveSet;
use super::cg::Goal;
use super::compliance::Compliance;
use super::iterate::{Iterate, Lengths, Wanted, natural_map};
use super::problem::{ActiveSetPoint, ActiveSetProblem};
use super::settings::{ActiveSetReport, ActiveSetSettings};
use super::view::{ActiveSetPreconditioner, ActiveSetView};
use super::workspace::ActiveSetWorkspace;

/// An active set as it is entered.
pub(crate) struct Place {
    /// Residual times `z`.
    rho: f64,
    /// Estimated distance to the solution on the set.
    pub(crate) errors: Lengths,
    /// What it is to fall below.
    pub(crate) limits: Lengths,
    x_norm: f64,
    /// Whether the constrained part is so small that directions in it mean nothing.
    vanishes: bool,
}

/// What the last move from one active set to the next did.
pub(crate) struct LastMove {
    /// Change of the constrained components.
    pub(crate) jump: f64,
    /// Change by the last of the rounds in which balance and set follow each other: they may run in circles.
    pub(crate) unrest: f64,
    /// Moves in a row at which the set held no balance.
    pub(crate) unbalanced: usize,
    /// Whether the hook was called.
    pub(crate) followed: bool,
    /// Whether steps that round have been made since `G x = e` was restored.
    pub(crate) drifted: bool,
    /// Whether the product has yet to follow.
    pub(crate) behind: bool,
}

impl LastMove {
    /// How far constrained components may still move.
    fn length(&self) -> f64 {
        self.jump.max(self.unrest)
    }
}

/// The error, relative to its limit: the smallest so far, and active sets since.
pub(crate) struct Progress {
    best: f64,
    pub(crate) waited: usize,
}

impl Progress {
    pub(crate) const NONE: Self = Self {
        best: f64::INFINITY,
        waited: 0,
    };
}

/// What a solve remembers of its path.
#[derive(Debug, Default)]
pub(crate) struct Path {
    /// Whether the start told nothing of the constrained components.
    pub(crate) unknown: bool,
    /// Times that a path was begun.
    pub(crate) begun: i32,
    /// Active sets when the compliance was changed.
    pub(crate) since: usize,
    /// Estimated error on the first active set that was not solved when it was entered.
    pub(crate) first: Option<f64>,
    /// Sets in a row whose error was well above that.
    pub(crate) away: usize,
}

/// One solve: the iterate, and what it remembers of earlier active sets.
pub(crate) struct Run<'s, A: SymmetricOperator, C, M: SymmetricOperator> {
    pub(crate) at: Iterate<'s, A, C, M>,
    pub(crate) settings: &'s ActiveSetSettings,
    pub(crate) hook: Option<&'s mut Hook<'s, ProductSet>>,
    /// Kind and length of each segment.
    shape: Vec<(Discriminant<Segment>, usize)>,
    /// Whether the product with the start is known.
    pub(crate) ax_known: bool,
    /// Whether unconstrained components alone stop every mode of the equality.
    pub(crate) repairs_suffice: bool,
    /// How far the natural map moves the constrained part of `x = 0`.
    reach: f64,
    /// Whether gaps alone can call for forces.
    unloaded: bool,
    /// Largest norm of `x` since `A x` was computed afresh.
    pub(crate) peak: f64,
    pub(crate) moved: LastMove,
    pub(crate) progress: Progress,
    /// Estimated errors when the last set was left, that of the constrained part when it was entered, and the least
    /// with which a set was entered.
    pub(crate) left: Lengths,
    pub(crate) first_error: f64,
    pub(crate) least_error: f64,
    pub(crate) path: Path,
}

impl<'s, A: SymmetricOperator, C: EqualityProjector, M: ActiveSetPreconditioner> Run<'s, A, C, M> {
    pub(crate) fn new<'h: 's>(
        problem: &'s ActiveSetProblem<'s, A, M>,
        projector: &'s mut C,
        MovingSet { set, hook }: MovingSet<'h, ProductSet>,
        ActiveSetPoint { x, ax, known }: ActiveSetPoint<'s>,
        settings: &'s ActiveSetSettings,
        work: &'s mut ActiveSetWorkspace<A, M>,
    ) -> Result<Self, QpError> {
        let constrained = set.constrained();
        work.resize(constrained);
        work.coupling.start(set, constrained)?;
        work.length = 0.0;
        (work.shortest, work.steepest) = (f64::INFINITY, 0.0);
        (work.leapt, work.leap) = (false, 0.0);
        work.active.resize(set);
        let map = problem.scale[..constrained].iter().zip(problem.linear);
        let reach = map.map(|(a, b)| (a * b).powi(2)).sum::<f64>().sqrt();
        // asked of the operator: where processes keep parts of vectors, loads may be on another one
        let unloaded = problem.rhs.iter().all(|f| *f == 0.0) && {
            vector::copy(problem.linear, &mut work.ap);
            work.ap[..constrained].fill(0.0);
            problem.operator.norm(&work.ap) == 0.0
        };
        Ok(Self {
            shape: set.shape().collect(),
            ax_known: known,
            repairs_suffice: projector.loose().is_empty(),
            settings,
            hook: hook.map(|hook| hook as _),
            reach,
            unloaded,
            peak: 0.0,
            moved: LastMove {
                jump: f64::INFINITY,
                unrest: 0.0,
                unbalanced: 0,
                followed: false,
                drifted: false,
                behind: false,
            },
            progress: Progress::NONE,
            left: Lengths::INFINITE,
            first_error: f64::INFINITY,
            least_error: f64::INFINITY,
            path: Path::default(),
            at: Iterate {
                problem,
                projector,
                set,
                x,
                ax,
                work,
                report: ActiveSetReport::new(),
                compliance: Compliance::default(),
                step: NATURAL_STEP,
                ahead: false,
                on_springs: false,
            },
        })
    }

    /// Whether constrained components are more than rounding.
    pub(crate) fn is_known(&self) -> bool {
        vector::norm(&self.at.x[..self.at.constrained()]) > ROUNDED * self.reach
    }

    /// Classifies the blocks by the natural map, and enters the active set with projector and preconditioner. `None`
    /// if no choice of blocks allows for the equality.
    pub(crate) fn enter(&mut self) -> Result<Option<Place>, QpError> {
        // without loads and contact nothing else tells what is small
        let nothing = self.unloaded && !self.is_known();
        let rounding = if nothing { ROUNDED * self.reach } else { 0.0 };
        let (at, settings) = (&mut self.at, self.settings);
        at.residual();
        at.tell_map(ActiveSet::classify);
        match at.hold_modes() {
            Ok(true) if at.projector.project_gradient_again(&mut at.work.residual) => {}
            Ok(true) => at.residual(),
            Ok(false) => {}
            Err(QpError::CoarseDeficient { .. }) => return Ok(None),
            Err(error) => return Err(error),
        }
        let springs = (at.compliance.c, at.problem.scale);
        let view = ActiveSetView::new(at.set, &at.work.active, springs);
        let preconditioner = at.problem.preconditioner;
        preconditioner.enter(&view, &mut at.work.preconditioner);
        at.start_residual();
        let (rho, square) = at.precondition(Wanted::Size);
        let errors = at.errors();
        // what vanishes is measured against `error_floor`, and its constrained part against a small part of that at
        // least
        let x_norm = square.sqrt();
        let all = x_norm.max(settings.error_floor);
        let part = vector::norm(&at.x[..at.constrained()]);
        let vanishes = part < settings.contact_error_floor;
        let part = part.max(SMALL_PART * all).max(settings.contact_error_floor);
        let tolerance = match at.compliance.c {
            0.0 => settings.tolerance,
            _ => ON_PATH,
        };
        let mut limits = Lengths {
            all: (tolerance * all).max(rounding),
            constrained: (tolerance * part).max(rounding),
        };
        // without a size: solved where rounding of the load is all that is left
        if limits.all == 0.0 {
            let (left, load) = (&at.work.residual, at.problem.linear);
            let [left, load] = [&left[..], load].map(|v| at.problem.operator.norm(v));
            limits.all = if left <= ROUNDED * load { errors.all } else { 0.0 };
        }
        at.report.error = ratio(errors.all, limits.all / tolerance);
        at.report.constrained_error = ratio(errors.constrained, limits.constrained / tolerance);
        if !(errors.all.is_finite() && x_norm.is_finite()) {
            return Err(at.not_finite("the error estimate"));
        }
        Ok(Some(Place {
            rho,
            errors,
            limits,
            x_norm,
            vanishes,
        }))
    }

    /// Computes `A x` afresh if it still carries the rounding errors of a much larger `x`.
    pub(crate) fn refreshes(&mut self, place: &Place) -> bool {
        let peak = self.peak.max(self.at.work.leap);
        let stale = peak > SHRUNK * place.x_norm;
        if stale {
            (self.peak, self.at.work.leap) = (place.x_norm, 0.0);
            self.moved.behind = false;
            self.at.multiply();
        }
        self.peak = self.peak.max(place.x_norm);
        stale
    }

    /// Whether `x` solves the problem with the present set: errors, last move, violation and circles to be crossed are
    /// small, and active bounds, judged by the residual on this set, which the last classification did not have, stay
    /// active.
    pub(crate) fn is_solved(&self, place: &Place) -> bool {
        let (at, limit) = (&self.at, place.limits.constrained);
        let moved = self.moved.length();
        let settled = at.report.active_sets == 0 || moved <= limit.max(f64::MIN_POSITIVE);
        let map = natural_map(at.problem, &at.work.residual, at.step);
        at.compliance.c == 0.0
            && place.errors.within(place.limits)
            && settled
            && at.set.violation(at.x) <= limit
            && 2.0 * at.work.active.crossing <= limit
            && !at.work.active.contradicted(at.set, at.x, &map, limit)
            && self.is_gradient_small(place)
    }

    /// Whether the residual on the set, at least `rho / |z|`, is small against `b` and `A x`, after a long step: an `x`
    /// that runs away along a direction without curvature makes any error small against itself.
    fn is_gradient_small(&self, place: &Place) -> bool {
        let (problem, norm) = (self.at.problem, |v: &[f64]| self.at.problem.operator.norm(v));
        let load = norm(problem.linear);
        !self.at.work.leapt || load == 0.0 || place.rho <= RUNAWAY * place.errors.all * (load + norm(self.at.ax))
    }

    /// A start that is ahead of its product needs one in any case: a step of a safe length and the move to the next
    /// active set share it. Whether that was so.
    pub(crate) fn sets_out(&mut self, place: &Place) -> Result<bool, QpError> {
        let ahead = self.at.ahead;
        if ahead {
            self.at.first_direction();
            self.first_error = place.errors.constrained;
            self.moved.drifted = self.at.projector.rounds_steps();
            let length = self.at.step.min(self.at.work.first_step);
            self.move_on(length, place)?;
            // from a set that was not solved: it does not tell how far the next one is worth solving
            self.moved.jump = f64::INFINITY;
        }
        Ok(ahead)
    }

    /// Lets the product follow the last move, if that is yet to be done. Whether it was.
    pub(crate) fn catches_up(&mut self) -> bool {
        let behind = std::mem::take(&mut self.moved.behind);
        if behind {
            self.at.catch_up();
        }
        behind
    }

    /// Whether `G x = e` holds as exactly as `x` is known, after steps that round. It does afterwards.
    pub(crate) fn is_balanced(&mut self, place: &Place) -> bool {
        if !self.moved.drifted {
            return true;
        }
        self.moved.drifted = false;
        let at = &mut self.at;
        at.mark();
        at.projector.repair(at.x, at.problem.rhs);
        vector::copy(at.x, &mut at.work.ap);
        vector::subtract(&at.work.t, &mut at.work.ap);
        let drift = at.problem.operator.norm(&at.work.ap);
        if drift <= NEGLIGIBLE * place.limits.all {
            vector::copy(&at.work.t, at.x);
            return true;
        }
        at.correct(0.0);
        false
    }

    /// Whether the set agrees with the solution: it has followed at the last move, or does now and hardly changes.
    pub(crate) fn set_agrees(&mut self, place: &Place) -> Result<bool, QpError> {
        if self.moved.followed {
            return Ok(true);
        }
        let work = &mut *self.at.work;
        work.active.radii(self.at.set, &mut work.before);
        self.follow()?;
        self.moved.followed = true;
        let (at, limit) = (&self.at, place.limits.constrained);
        let moved = at.set.violation(at.x) > limit || at.work.active.grew(at.set, at.x, &at.work.before, limit);
        Ok(!moved)
    }

    /// Compares the error with the smallest so far.
    pub(crate) fn note_progress(&mut self, place: &Place) {
        let (errors, limits) = (place.errors, place.limits);
        let moved = self.moved.length();
        let constrained = errors.constrained.max(moved.min(f64::MAX));
        let progress = &mut self.progress;
        let last = (errors.all / limits.all).max(constrained / limits.constrained);
        if last < PROGRESS * progress.best {
            progress.best = last;
            progress.waited = 0;
        } else if self.at.report.active_sets > 0 {
            progress.waited += 1;
        }
    }

    /// Whether predictions have made no progress on so many sets.
    pub(crate) fn in_circles(&self, patience: usize) -> bool {
        let on_path = self.at.compliance.c > 0.0;
        self.progress.waited >= patience || on_path && self.moved.unbalanced >= patience
    }

    /// Why the solve ends without a solution, if it does.
    pub(crate) fn gives_up(&self) -> Option<Status> {
        let (settings, report) = (self.settings, &self.at.report);
        if self.moved.unbalanced >= PATIENCE * UNBALANCED {
            return Some(Status::Infeasible);
        }
        let longer = if self.path.begun > 0 { LONGER } else { 1 };
        let most = settings.max_active_sets.saturating_mul(longer);
        let limit = report.active_sets >= most || report.products() >= settings.max_products;
        limit.then_some(Status::IterationLimit)
    }

    /// Conjugate gradients on the active set. Returns the length of the last step, zero if another one is not worth
    /// while.
    pub(crate) fn solve_on_set(&mut self, place: &Place) -> Result<f64, QpError> {
        let (settled, near_path) = (self.has_settled(), self.is_near_path());
        let at = &mut self.at;
        let steady = self.moved.unbalanced == 0;
        let free = self.moved.followed && steady && !place.vanishes;
        let error = at.report.constrained_error;
        at.work.coupling.begin(free, error, self.progress.waited);
        let falls = place.errors.all < self.least_error;
        let expected = |left: f64| MAGNIFIED * (self.moved.jump + left);
        // behind a path a set that is hardly solved may lead away again
        let forcing = if near_path && at.compliance.c == 0.0 && self.progress.waited > 0 {
            self.settings.forcing.min(BEHIND_PATH)
        } else {
            self.settings.forcing
        };
        let goal = Goal {
            forcing: (at.work.coupling).forcing(forcing, self.moved.jump, self.first_error),
            // of an error in other blocks than before the last move tells nothing
            expected: if settled {
                self.left.zip(self.left, |left, _| expected(left))
            } else {
                Lengths::INFINITE
            },
            limits: place.limits,
            max_products: self.settings.max_products,
            size: place.x_norm.max(self.settings.error_floor),
        };
        self.first_error = place.errors.constrained;
        self.least_error = self.least_error.min(place.errors.all);
        let matters = place.limits.constrained > PASSING_PART * place.limits.all;
        let passes = steady && falls && matters && at.is_on_the_way();
        let length = if passes { at.pass() } else { at.conjugate_gradients(place.rho, &goal)? };
        self.moved.drifted = at.projector.rounds_steps();
        self.left = at.errors();
        at.report.active_sets += 1;
        Ok(length)
    }

    /// Calls the hook, which may change the data of segments but not the segments.
    pub(crate) fn follow(&mut self) -> Result<(), QpError> {
        let at = &mut self.at;
        if let Some(hook) = &mut self.hook {
            hook(at.x, at.set);
        }
        at.report.hook_calls += 1;
        at.set.validate()?;
        if at.set.shape().eq(self.shape.iter().copied()) {
            Ok(())
        } else {
            let wanted = "the segments that it had before the hook";
            Err(SetError::Kind { segment: 0, wanted }.into())
        }
    }

    pub(crate) fn finish(mut self, status: Status) -> ActiveSetReport {
        self.leave_path();
        if self.at.ahead {
            self.at.catch_up();
        }
        self.at.report.status = status;
        self.at.report
    }
}

fn ratio(a: f64, b: f64) -> f64 {
    if a == 0.0 { 0.0 } else { a / b }
}
