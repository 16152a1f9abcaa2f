//! The default method: the active-set method of `signorini-qp` on the dual problem, slip bounds following the normal
//! forces.
//!
//! Where the active-set method makes no progress, the paper's method solves the step: from the last iterate where a
//! limit was reached, from the start of the step where the active-set method stagnated. Its steps lower a cost, and
//! with [`Expansion::FixedStep`](signorini_qp::Expansion) it is proved to solve every Tresca problem.

use super::iterate::{Attempt, Iterate, Task, is_coulomb, step_status};
use super::not_determined::not_determined;
use super::preconditioner::SelectedPreconditioner;
use super::release::Exchanges;
use super::row_scale::row_scale;
use super::smalse::SmalseSolver;
use crate::error::ContactError;
use crate::model::Model;
use crate::report::StepReport;
use crate::scene::Friction;
use crate::settings::{Preconditioner, Settings};
use crate::status::StepStatus;
use crate::tolerances::{
    AT_ONCE, BEFORE_INSIDE, CIRCLES, CONTRADICTION, EASY, EXPLICIT_PRODUCTS, INSIDE, LINEAR_AT_MOST, LINEAR_SLACK,
    LITTLE,
};
use signorini_qp::active_set::{ActiveSetPoint, ActiveSetProblem, ActiveSetWorkspace};
use signorini_qp::{
    ActiveSetSettings, EqualityProjector, MovingSet, ProductSet, QpError, Status, SymmetricOperator, active_set,
    interior_point, vector,
};
use signorini_tfeti::internal::{ExplicitCost, SystemPart};
use signorini_tfeti::{ActiveSetProjector, DualOperator};

/// A point that interior points have found, and its rigid amplitudes.
struct Inside {
    lambda: Vec<f64>,
    alpha: Vec<f64>,
}

/// Solves of a step with contradicting points released.
const TURNS: usize = 8;

pub(crate) struct ActiveSetSolver {
    /// Of several processes, where vectors can be spread.
    part: Option<SystemPart>,
    /// Contact rows.
    contact: usize,
    space: ActiveSetProjector,
    preconditioner: SelectedPreconditioner,
    /// The one that is not in use, of that of the settings and the inverse of a formed F.
    other: Option<SelectedPreconditioner>,
    /// What forming F costs, and steps with its inverse; `None` if that is not to be.
    explicit_cost: Option<ExplicitCost>,
    scale: Vec<f64>,
    set: ProductSet,
    work: ActiveSetWorkspace<DualOperator, SelectedPreconditioner>,
    settings: ActiveSetSettings,
    exchanges: Exchanges,
    /// The iterate at the start of a step, then the residual at its end.
    start: Vec<f64>,
    /// Made when it is first needed.
    paper: Option<Box<SmalseSolver>>,
}

impl ActiveSetSolver {
    pub(crate) fn new(model: &Model, settings: &Settings, own: ActiveSetSettings) -> Result<Self, ContactError> {
        let contact = model.contact_rows().end;
        let part = model.tfeti.part();
        let (dual, coarse) = match &part {
            Some(part) => (&part.dual, &part.coarse),
            None => (model.tfeti.dual(), model.tfeti.coarse()),
        };
        let preconditioner = SelectedPreconditioner::new(model, settings.preconditioner, part.as_ref())?;
        let scale = row_scale(model, dual.dim());
        let space = ActiveSetProjector::new(coarse, contact, model.tfeti.row_weights())?;
        let free = space.factor().free_motions();
        if model.points.is_empty() && !free.is_empty() {
            return Err(not_determined(model, free));
        }
        let explicit_cost = match settings.preconditioner {
            Preconditioner::None => None,
            _ if model.points.is_empty() => None,
            _ => model.tfeti.explicit_cost(),
        };
        Ok(Self {
            contact,
            space,
            work: ActiveSetWorkspace::new(dual, &preconditioner),
            other: None,
            explicit_cost,
            preconditioner,
            set: model.set_with(scale.len() - contact)?,
            scale,
            part,
            exchanges: Exchanges::new(model),
            settings: own,
            start: Vec::new(),
            paper: None,
        })
    }

    /// Has the loads [balanced](Model::balance_loads).
    pub(crate) fn balance_loads(&mut self, model: &mut Model) {
        let (rows, part) = (model.tfeti.dual_dim(), &self.part);
        let space = &mut self.space;
        model.balance_loads(|coarse| {
            let mut whole = vec![0.0; rows];
            match part {
                Some(part) => {
                    let mut own = part.take(&whole);
                    space.repair(&mut own, coarse);
                    part.complete(&own, &mut whole);
                }
                None => space.repair(&mut whole, coarse),
            }
            whole
        });
    }

    pub(crate) fn solve(&mut self, task: Task<'_>, iterate: &mut Iterate) -> Result<StepReport, ContactError> {
        let mut report = StepReport::default();
        let contact = !task.model.points.is_empty();
        report.counters.inequality_solves = usize::from(contact);
        iterate.alpha.clear();
        self.start.resize(iterate.lambda.len(), 0.0);
        vector::copy(&iterate.lambda, &mut self.start);
        if iterate.attempt == Attempt::Rest {
            // of no products, the active set alone, for the amplitudes
            let stood = [iterate.lambda.clone(), iterate.f_lambda.clone()];
            let known = iterate.known;
            self.active_sets(task, iterate, (0, usize::MAX), &mut report)?;
            ([iterate.lambda, iterate.f_lambda], iterate.known) = (stood, known);
            report.status = StepStatus::Stagnated;
            return self.stay(task, iterate, report);
        }
        report.status = match iterate.attempt {
            Attempt::Brief => {
                // whichever an earlier step has left in use a restart does not know
                self.use_explicit(self.is_hard(iterate), task, &mut report);
                step_status(self.active_sets(task, iterate, (EASY, CIRCLES), &mut report)?)
            }
            Attempt::Apart => {
                // that nothing presses is soon found, however many products a linear problem takes
                self.use_explicit(false, task, &mut report);
                self.work.trust_start();
                step_status(self.active_sets(task, iterate, (usize::MAX, CIRCLES), &mut report)?)
            }
            _ => step_status(self.active_sets_or_explicit(task, iterate, &mut report)?),
        };
        task.model.tfeti.check_processes()?;
        if contact && !report.status.converged() {
            if report.status.is_lost() || !is_finite(&iterate.lambda) {
                self.begin_again(iterate);
            }
            // another start comes before another method
            return match iterate.attempt {
                Attempt::Brief | Attempt::Apart => self.stay(task, iterate, report),
                Attempt::First if report.status.is_lost() => self.stay(task, iterate, report),
                _ => self.fall_back(task, iterate, report),
            };
        }
        if iterate.alpha.is_empty() {
            iterate.known = true;
            self.amplitudes(task, iterate);
        }
        Ok(report)
    }

    /// What was reached stands, with its status.
    fn stay(
        &mut self,
        task: Task<'_>,
        iterate: &mut Iterate,
        mut report: StepReport,
    ) -> Result<StepReport, ContactError> {
        if !std::mem::replace(&mut iterate.known, true) {
            let dual = task.model.tfeti.dual();
            dual.apply(&iterate.lambda, &mut iterate.f_lambda, &mut dual.scratch());
            report.counters.products += 1;
        }
        self.amplitudes(task, iterate);
        Ok(report)
    }

    /// Active sets with the preconditioner of the settings, and where that takes more products than forming F is worth,
    /// or stagnates, with the inverse of F.
    fn active_sets_or_explicit(
        &mut self,
        task: Task<'_>,
        iterate: &mut Iterate,
        report: &mut StepReport,
    ) -> Result<Status, ContactError> {
        let costs = self.explicit_cost;
        let (cost, contact) = (self.cost(), self.contact);
        let step = |x: &[f64]| costs.map_or(usize::MAX, |costs| costs.step(carrying(&x[..contact])));
        let at_once = |x: &[f64]| costs.is_some_and(|costs| costs.forming.saturating_add(step(x)) <= AT_ONCE);
        let mut status = Status::IterationLimit;
        if !self.is_hard(iterate) {
            self.use_explicit(false, task, report);
            // bodies that supports hold find a path out of circles
            let brief = !self.space.loose().is_empty() && at_once(&iterate.lambda);
            let mut patience = if brief { CIRCLES } else { usize::MAX };
            loop {
                let easy = step(&iterate.lambda).max(EASY);
                let most = cost.map_or(usize::MAX, |cost| {
                    cost.saturating_sub(iterate.effort).saturating_add(easy)
                });
                let left = most.saturating_sub(report.counters.products);
                if left == 0 {
                    break;
                }
                status = self.active_sets(task, iterate, (left, patience), report)?;
                let limited = status == Status::IterationLimit && report.counters.products >= most;
                let circles = patience == CIRCLES && status == Status::Stagnated && !at_once(&iterate.lambda);
                // what carries now may make the inverse dearer
                if !(limited || circles) {
                    break;
                }
                if circles {
                    patience = usize::MAX;
                }
            }
            let easy = step(&iterate.lambda).max(EASY);
            let effort = report.counters.products.saturating_sub(easy);
            iterate.effort = iterate.effort.saturating_add(effort);
        }
        let is_open = |status| matches!(status, Status::IterationLimit | Status::Stagnated);
        let hard = |cost| iterate.effort >= cost || status == Status::Stagnated;
        if let Some(cost) = cost.filter(|&cost| is_open(status) && hard(cost)) {
            iterate.effort = cost;
            if status == Status::Stagnated {
                self.begin_again(iterate);
            }
            if self.use_explicit(true, task, report) {
                let dear = costs.is_some_and(|costs| costs.inside(carrying(&iterate.lambda[..contact])) > EASY);
                let patience = if dear { CIRCLES } else { BEFORE_INSIDE };
                status = self.active_sets(task, iterate, (EXPLICIT_PRODUCTS, patience), report)?;
                if is_open(status) {
                    let inside = self.begin_inside(task, iterate, report)?;
                    let inside = inside.filter(|_| !std::mem::replace(&mut iterate.offered, true));
                    let patience = if inside.is_some() { patience } else { usize::MAX };
                    status = self.active_sets(task, iterate, (EXPLICIT_PRODUCTS, patience), report)?;
                    if is_open(status)
                        && let Some(inside) = inside
                    {
                        // active sets hardly hold a body whose friction is all spent: of interior points the
                        // certificate judges
                        (iterate.lambda, iterate.alpha) = (inside.lambda, inside.alpha);
                        iterate.known = false;
                        return Ok(Status::Converged);
                    }
                }
            }
        }
        Ok(status)
    }

    /// The effort from which on forming F pays; `None` if that is not to be.
    fn cost(&self) -> Option<usize> {
        self.explicit_cost.map(|costs| costs.forming.max(LITTLE))
    }

    /// Whether an earlier step was worth forming F. The next one may be easy all the same, which is looked at where its
    /// inverse would cost more.
    fn is_hard(&self, iterate: &Iterate) -> bool {
        let carrying = carrying(&iterate.lambda[..self.contact]);
        let cheap = self.explicit_cost.is_some_and(|costs| costs.step(carrying) <= EASY);
        cheap && self.cost().is_some_and(|cost| iterate.effort >= cost)
    }

    /// Looks for a start by interior points, with a formed F. None is no error.
    fn begin_inside(
        &mut self,
        task: Task<'_>,
        iterate: &mut Iterate,
        report: &mut StepReport,
    ) -> Result<Option<Inside>, ContactError> {
        let Task { model, problem, .. } = task;
        let SelectedPreconditioner::Explicit(explicit) = &self.preconditioner else {
            return Ok(None);
        };
        if !is_finite(&iterate.lambda) {
            self.begin_again(iterate);
        }
        // what is open in the last iterate is left out at first
        let mut x = iterate.lambda.clone();
        let mut set = model.set_with(0)?;
        let slopes = if is_coulomb(model) { problem.slip_slopes(model) } else { Vec::new() };
        let data = (&problem.linear[..], &problem.rhs[..]);
        let mut steps = 0;
        let mut written = Ok(());
        let found = explicit.through_contact(model.tfeti.coarse(), data, &mut x, |matrix, load, x| {
            written = problem.write_slip_bounds(model, x, &mut set);
            if written.is_err() {
                return Ok(Status::Stagnated);
            }
            let outcome = interior_point(matrix, load, &set, &slopes, INSIDE, x)?;
            steps += outcome.steps;
            Ok(outcome.status)
        });
        written?;
        report.counters.interior_steps += steps;
        let Some(alpha) = found.ok().flatten().filter(|_| is_finite(&x)) else {
            return Ok(None);
        };
        iterate.lambda.clone_from(&x);
        iterate.known = false;
        self.work.trust_start();
        Ok(Some(Inside { lambda: x, alpha }))
    }

    /// Back to the start of the step.
    fn begin_again(&self, iterate: &mut Iterate) {
        vector::copy(&self.start, &mut iterate.lambda);
        iterate.known = false;
    }

    /// Takes the inverse of a formed F, or the preconditioner of the settings. Whether it is the one asked for.
    fn use_explicit(&mut self, explicit: bool, task: Task<'_>, report: &mut StepReport) -> bool {
        if matches!(self.preconditioner, SelectedPreconditioner::Explicit(_)) == explicit {
            return true;
        }
        if self.other.is_none() {
            self.other = SelectedPreconditioner::explicit(task.model, self.part.as_ref());
            report.counters.formed_operators += usize::from(self.other.is_some());
        }
        let Some(other) = &mut self.other else {
            self.explicit_cost = None;
            return false;
        };
        std::mem::swap(&mut self.preconditioner, other);
        let dual = self.part.as_ref().map_or(task.model.tfeti.dual(), |part| &part.dual);
        self.work = ActiveSetWorkspace::new(dual, &self.preconditioner);
        true
    }

    /// Rigid amplitudes that go with an iterate of which `F lambda` is known.
    fn amplitudes(&mut self, task: Task<'_>, iterate: &mut Iterate) {
        iterate.alpha.resize(task.problem.rhs.len(), 0.0);
        let residual = &mut self.start;
        vector::difference(&iterate.f_lambda, &task.problem.linear, residual);
        let part = self.part.as_ref().map(|part| part.take(residual));
        let residual = part.as_ref().unwrap_or(residual);
        self.space.amplitudes(residual, &mut iterate.alpha);
    }

    /// Active sets with slip bounds that follow, again as long as rows of one node contradict each other.
    fn active_sets(
        &mut self,
        task: Task<'_>,
        iterate: &mut Iterate,
        (most, patience): (usize, usize),
        report: &mut StepReport,
    ) -> Result<Status, ContactError> {
        let Task { model, problem, .. } = task;
        problem.write_slip_bounds(model, &iterate.lambda, &mut self.set)?;
        let mut updates = usize::from(model.any_law(Friction::is_some));
        self.space.set_coarse_rhs(&problem.rhs);
        let part = self.part.as_ref();
        let linear = part.map(|part| part.take(&problem.linear));
        let dual = ActiveSetProblem {
            operator: part.map_or(model.tfeti.dual(), |part| &part.dual),
            preconditioner: &self.preconditioner,
            scale: &self.scale,
            linear: linear.as_ref().unwrap_or(&problem.linear),
            rhs: &problem.rhs,
        };
        let [least, least_contact] = problem.least(task.settings.tolerance);
        let least = least.max(vector::norm(&problem.balancing));
        let contact = !model.points.is_empty();
        let tolerance = if contact {
            task.settings.tolerance
        } else {
            (task.settings.tolerance * LINEAR_SLACK).min(LINEAR_AT_MOST)
        };
        let settings = self
            .settings
            .clone()
            .with_tolerance(tolerance)
            .limited_to(most.max(1))
            .with_patience(patience);
        let settings = settings.with_error_floor(least).with_contact_error_floor(least_contact);
        let coulomb = is_coulomb(model);
        if coulomb {
            let slopes = problem.slip_slopes(model);
            self.work.set_slopes(&slopes);
        }
        self.work.set_start(&iterate.known_rows, iterate.shortest_step);
        iterate.known_rows.clear();
        let mut written = Ok(());
        let mut hook = |x: &[f64], set: &mut ProductSet| {
            if coulomb && written.is_ok() {
                written = problem.write_slip_bounds(model, x, set);
                updates += 1;
            }
            coulomb
        };
        let mut turns = 0;
        let status = loop {
            let mut own = part.map(|part| [&iterate.lambda, &iterate.f_lambda].map(|whole| part.take(whole)));
            let (x, ax) = match &mut own {
                Some([x, ax]) => (x, ax),
                None => (&mut iterate.lambda, &mut iterate.f_lambda),
            };
            let (set, known) = (MovingSet::new(&mut self.set, &mut hook), iterate.known);
            let point = ActiveSetPoint { x, ax, known };
            if most == 0 {
                self.work.enter_only();
            }
            let outcome = active_set(&dual, &mut self.space, set, point, &settings, &mut self.work);
            if let (Some(part), Some([x, ax])) = (part, &own) {
                part.complete(x, &mut iterate.lambda);
                part.complete(ax, &mut iterate.f_lambda);
            }
            let status = match outcome {
                Ok(outcome) => {
                    let (sets, steps) = (outcome.active_sets, outcome.cg_steps);
                    report.iterations += if contact { sets } else { steps };
                    report.counters.products += outcome.products();
                    report.counters.preconditionings += outcome.preconditionings;
                    report.counters.coarse_factorisations += outcome.factorisations;
                    report.counters.active_sets += if contact { sets } else { 0 };
                    outcome.status
                }
                // the prediction ran away, the free rows do not hold the body, or rounding bends F: the paper's method
                // needs neither
                Err(QpError::CoarseDeficient { .. } | QpError::NotFinite { .. }) => {
                    iterate.known = false;
                    Status::Stagnated
                }
                Err(QpError::Indefinite { .. } | QpError::Unbounded { .. }) if contact => {
                    iterate.known = false;
                    Status::Stagnated
                }
                Err(error) => return Err(error.into()),
            };
            let size = vector::norm(&iterate.lambda).max(least);
            let limit = (&self.scale[..], CONTRADICTION * tolerance * size);
            let residual = self.work.residual();
            let solved = status == Status::Converged && turns < TURNS;
            if !solved || !self.exchanges.settle(task, residual, limit, &mut iterate.lambda) {
                break status;
            }
            iterate.known = false;
            turns += 1;
        };
        if self.work.shortest_step().is_finite() {
            iterate.shortest_step = self.work.shortest_step();
        }
        report.counters.slip_bound_updates += updates;
        written.map(|()| status)
    }

    fn fall_back(
        &mut self,
        task: Task<'_>,
        iterate: &mut Iterate,
        report: StepReport,
    ) -> Result<StepReport, ContactError> {
        let paper = self
            .paper
            .take()
            .map_or_else(|| SmalseSolver::new(task.model, task.settings).map(Box::new), Ok);
        let mut paper = match paper {
            Ok(paper) => paper,
            // the paper's method needs rows that stop every motion
            Err(ContactError::NotDetermined { .. }) => return self.stay(task, iterate, report),
            Err(error) => return Err(error),
        };
        iterate.multiplier.clear();
        // other normal forces may hold a body yet that only contact holds
        let most = task.settings.max_fallback_products;
        let outcome = if self.space.loose().is_empty() {
            paper.solve(most, task, iterate)
        } else {
            paper.solve_while_balancing(most, task, iterate)
        };
        self.paper = Some(paper);
        let mut second = outcome?;
        second.fallback = true;
        second.fallback_products = second.counters.products;
        iterate.multiplier.clear();
        Ok(report.resumed(second))
    }
}

/// How many contact rows carry a force.
fn carrying(contact: &[f64]) -> usize {
    contact.iter().filter(|v| **v != 0.0).count()
}

fn is_finite(x: &[f64]) -> bool {
    x.iter().all(|v| v.is_finite())
}
