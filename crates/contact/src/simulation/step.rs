//! One step: prepared, solved, recovered, remembered.

use super::halving::{Before, Way};
use super::result::StepResult;
use super::simulation::{Simulation, on_pool};
use super::unloaded::Targets;
use crate::error::ContactError;
use crate::model::{Model, slides};
use crate::plan::FrictionKind;
use crate::report::StepReport;
use crate::result::{ContactState, PointState, Recovered, Sizes, summarise};
use crate::scene::{Friction, Increment};
use crate::settings::{Accuracy, Method};
use crate::solve::{Attempt, Iterate, Task};
use crate::state::{Kept, Peak, State};
use crate::status::StepStatus;
use crate::step::{Acting, StepProblem};
use crate::tolerances::CERTIFIED;
use signorini_qp::vector;
use signorini_tfeti::internal::{of_length, zeros};
use std::sync::Arc;

impl Simulation {
    /// Solves the next step. Not converging is no error: see the report of the result.
    ///
    /// # Errors
    /// [`ContactError::Finished`] after the last step; a breakdown of a solver. The state is then unchanged, but for
    /// what starts, ends or is locked before the step.
    pub fn step(&mut self) -> Result<Arc<StepResult>, ContactError> {
        let analysis = &self.model.scene.analysis;
        let steps = analysis.steps();
        let whole = analysis.increment(self.state.step());
        let whole = whole.ok_or(ContactError::Finished { steps })?;
        if let Some(last) = self.result.take().and_then(Arc::into_inner) {
            self.spare = last.recovered;
        }
        let entered = self.enter_due();
        entered.map_err(|error| self.model.scene.names.tell(error))?;
        let result = on_pool(|| self.take_step(whole)).map_err(|error| self.model.scene.names.tell(error))?;
        let result = Arc::new(result);
        self.total += result.report.counters;
        self.result = Some(result.clone());
        Ok(result)
    }

    /// Takes the next step, in increments where it fails and the settings allow it.
    fn take_step(&mut self, whole: Increment) -> Result<StepResult, ContactError> {
        // not taken out: laws of the user may panic
        let mut state = self.state.clone();
        let last = (state.step() > 0).then_some(state.halved);
        // what did not converge leaves wrong slip
        let most = match state.unconverged_history() {
            None => self.settings.step_halving,
            Some(_) => 0,
        };
        let mut way = Way::new(whole, most, last);
        let mut before = Before::default();
        loop {
            if way.halved() > 0 {
                self.model.scene.check_histories(way.increment().end)?;
            }
            let solved = self.solve_after(&state, &way);
            self.model.tfeti.check_processes()?;
            let converged = matches!(&solved, Ok(result) if result.report.status.converged());
            let halved = way.halved();
            if !converged && way.retry() {
                before.enter_failed(solved.ok().map(|result| result.report), way.halved() > halved);
                continue;
            }
            let mut result = solved?;
            result.report.unconverged_history = self.state.unconverged_history();
            if way.goes_on() {
                self.remember(Arc::make_mut(&mut state), &mut result, &way);
                before.enter_between(result);
                way.pass();
                continue;
            }
            self.state = Arc::default();
            self.remember(Arc::make_mut(&mut state), &mut result, &way);
            self.state = state;
            before.complete(&mut result);
            return Ok(result);
        }
    }

    /// Solves the increment that follows on a state.
    fn solve_after(&mut self, state: &State, way: &Way) -> Result<StepResult, ContactError> {
        let increment = way.increment();
        self.controller = state.controller;
        Arc::make_mut(&mut self.problem).prepare(&self.model, state, increment, Acting::All)?;
        // the line through the last two steps leads on where the loads have stopped, and astray where friction has
        // turned round: there is another start
        let rests = |last| self.problem.rests(&self.model.scene, last);
        let rests = self.settings.extrapolate && increment.start.is_some_and(rests);
        let line = self.settings.extrapolate && !rests;
        let two_starts = self.settings.extrapolate && state.step() > 0 && state.unconverged_history().is_none();
        let falls_back = matches!(self.settings.method, Method::ActiveSet(_)) && !self.model.points.is_empty();
        // with a formula of more steps the rate is yet to fall; estimates judge what was solved
        let is_one_step = (self.problem.formula).is_some_and(|formula| formula.is_one_step());
        let by_tolerance = self.settings.accuracy == Accuracy::Tolerance;
        let stands = rests && is_one_step && by_tolerance;
        let effects = &self.model.plan.effects;
        let moves = effects.history && (effects.motion || effects.moving_obstacle);
        let loose = self.model.loose_motions()?;
        let settles = falls_back && state.step() == 0 && moves && !loose.is_empty();
        let balanced = by_tolerance && falls_back && !loose.is_empty() && self.problem.is_balanced(loose);
        let starts = match (two_starts, falls_back) {
            (false, _) if settles => &[(line, Attempt::First), (line, Attempt::Settled)][..],
            (false, _) => &[(line, Attempt::Whole)],
            (true, false) => &[(line, Attempt::First), (!line, Attempt::Whole)],
            (true, true) => &[
                (line, Attempt::Rest),
                (line, Attempt::First),
                (!line, Attempt::Whole),
                (line, Attempt::Fallback),
            ][usize::from(!stands)..],
        };
        let (tried, unloaded, told) = self.unload(state, way, starts[0])?;
        let (mut report, recovered) = match unloaded {
            Some(recovered) => (tried, recovered),
            None => {
                let (report, recovered) = self.solve_from(starts, state, way, (tried, told.as_ref()), balanced)?;
                (report, self.stand(state, recovered, told.unwrap_or_default())?)
            }
        };
        // bodies that stand elsewhere now
        if by_tolerance && recovered.certificate.largest() <= self.settings.tolerance {
            report.status = StepStatus::Converged;
        }
        let (model, problem) = (&self.model, &self.problem);
        let certificate = &recovered.certificate;
        let unbalanced = certificate.equilibrium.relative() >= certificate.largest();
        // the force from which on a body slides
        let least = match report.status {
            StepStatus::NotHeld => Some(0.0),
            StepStatus::IterationLimit | StepStatus::Stagnated if unbalanced => {
                Some(CERTIFIED * self.settings.tolerance * certificate.equilibrium.reference)
            }
            _ => None,
        };
        if let Some(least) = least {
            let slide = slides(model, &problem.rhs, &problem.multipliers(&self.iterate.lambda))?;
            report.slide = slide.filter(|slide| slide.force > least);
        }
        Ok(StepResult {
            summary: summarise(model, problem, &recovered, &self.iterate.lambda, state.last_trace())?,
            model: model.clone(),
            caches: self.caches.clone(),
            problem: problem.clone(),
            report,
            recovered,
        })
    }

    /// Solves from one start after another as long as the step is lost; from the iterate of what was tried before, if
    /// that converged, in place of the first one. Where loads end, it was told where bodies stand: then without forces,
    /// too.
    fn solve_from(
        &mut self,
        starts: &[(bool, Attempt)],
        state: &State,
        way: &Way,
        (tried, told): (StepReport, Option<&Targets>),
        mut balanced: bool,
    ) -> Result<(StepReport, Recovered), ContactError> {
        let mut sets_out = tried.status.converged();
        let mut report = tried;
        // friction may lock bodies that were pressed, and a first step is mostly to press them
        let locks = self.model.plan.effects.friction != FrictionKind::None;
        balanced &= !locks || told.is_none() && state.step() > 0;
        // mostly bodies that stood apart still do, and those whose forces fade get there
        if balanced && !sets_out && (self.stood_apart(state) || !locks && self.fades(state, way)) {
            balanced = false;
            if let Some(apart) = self.apart(state, way, &mut report)? {
                report.status = StepStatus::Converged;
                return Ok((report, apart));
            }
        }
        let mut recovered = std::mem::take(&mut self.spare);
        let briefly = |&(line, attempt): &(bool, Attempt)| {
            let both = [(line, Attempt::Brief), (line, attempt)];
            both.into_iter().skip(usize::from(attempt == Attempt::Rest))
        };
        for (line, attempt) in starts.iter().flat_map(briefly) {
            if attempt == Attempt::Brief && !balanced {
                continue;
            }
            self.spare = recovered;
            self.controller = state.controller;
            if !std::mem::take(&mut sets_out) {
                self.start(state, way, line, attempt);
                if attempt == Attempt::Settled {
                    report = report.resumed(self.settle(state, way, line)?);
                }
            }
            let (next, found) = self.solve()?;
            (report, recovered) = (report.resumed(next), found);
            let goes_on = report.status.is_lost() || attempt == Attempt::Brief && !report.status.converged();
            if !goes_on {
                break;
            }
            // friction that nearly locks bodies lets active sets run in circles where forces vanish, too
            if let Some(told) = told
                && let Some(left) = self.without_forces(state, told, &mut report)?
            {
                report.status = StepStatus::Converged;
                return Ok((report, left));
            }
            if (!locks || attempt == Attempt::Brief) && std::mem::take(&mut balanced) {
                let (kept, lost) = (self.iterate.clone(), report.status);
                if let Some(apart) = self.apart(state, way, &mut report)? {
                    report.status = StepStatus::Converged;
                    return Ok((report, apart));
                }
                (self.iterate, report.status) = (kept, lost);
            }
        }
        Ok((report, recovered))
    }

    /// From a start to where loads bring bodies that nothing moves yet: what moves may carry them far along, with
    /// forces that friction decides once they are pressed.
    fn settle(&mut self, state: &State, way: &Way, line: bool) -> Result<StepReport, ContactError> {
        let prepare = |own: &mut Self, acting| {
            Arc::make_mut(&mut own.problem).prepare(&own.model, state, way.increment(), acting)
        };
        prepare(self, Acting::Unmoved)?;
        self.iterate.attempt = Attempt::First;
        let (report, recovered) = self.solve()?;
        (self.spare, self.controller) = (recovered, state.controller);
        prepare(self, Acting::All)?;
        if !report.status.converged() {
            self.start(state, way, line, Attempt::Settled);
        }
        (self.iterate.attempt, self.iterate.offered) = (Attempt::Settled, false);
        Ok(report)
    }

    /// One run of the solver from the present iterate, and what is recovered from it.
    pub(super) fn solve_once(&mut self, tolerance: f64) -> Result<(StepReport, Recovered), ContactError> {
        let (model, problem, iterate) = (&self.model, &self.problem, &mut self.iterate);
        let settings = self.settings.clone().with_tolerance(tolerance);
        let task = Task {
            model,
            problem,
            settings: &settings,
        };
        let solved = self.solver.solve(task, iterate);
        model.tfeti.check_processes()?;
        let mut report = solved?;
        let old = std::mem::take(&mut self.spare);
        let lambda = problem.multipliers(&iterate.lambda);
        let recovered = Recovered::new(model, problem, &lambda, &iterate.alpha, old);
        model.tfeti.check_processes()?;
        let recovered = recovered?;
        report.counters.products += 1;
        Ok((report, recovered))
    }

    /// Start vectors of an increment: zero, the last vectors, or the line through the last two.
    pub(super) fn start(&mut self, state: &State, way: &Way, line: bool, attempt: Attempt) {
        let (model, iterate) = (&self.model, &mut self.iterate);
        (iterate.effort, iterate.shortest_step) = (state.effort, state.shortest_step);
        (iterate.attempt, iterate.offered) = (attempt, false);
        let (lambda, f_lambda) = (&state.lambda, &state.f_lambda);
        let (rows, coarse) = (model.tfeti.dual_dim(), model.tfeti.coarse().rows());
        // before the first step everything is at rest: zero is known, too
        let from_rest = state.step() <= 1 && !lambda[0].is_empty() && lambda[1].is_empty();
        let along = line.then(|| {
            let last = way.increment().start.filter(|_| from_rest);
            let growth = last.map_or(f64::INFINITY, |last| self.problem.growth(model, last));
            growth.min(way.ratio())
        });
        let extrapolate = |[last, before]: &[Vec<f64>; 2], x: &mut Vec<f64>| {
            let before = (!from_rest).then_some(&before[..]);
            start_vector(last, before, rows, along, x);
        };
        extrapolate(lambda, &mut iterate.lambda);
        extrapolate(f_lambda, &mut iterate.f_lambda);
        iterate.known = (0..2).all(|k| lambda[k].len() == f_lambda[k].len());
        let [last, before] = &state.multiplier;
        start_vector(last, Some(before), coarse, along, &mut iterate.multiplier);
        iterate.known_rows.clear();
        if attempt != Attempt::Rest && state.sliding.iter().any(|s| *s) {
            let contact = model.tfeti.gluing().ranges().contact().end;
            iterate.known_rows.extend_from_slice(&iterate.lambda[..contact]);
            (self.problem).restore_sliding(model, &state.sliding, &mut iterate.lambda);
        }
    }

    /// Makes the state after an increment from that before it.
    fn remember(&mut self, state: &mut State, result: &mut StepResult, way: &Way) {
        let (model, problem, recovered) = (&self.model, &self.problem, &result.recovered);
        let history = model.plan.effects.history;
        let mut kept = Kept {
            time: problem.time,
            halved: way.halved(),
            between: way.goes_on(),
            effort: self.iterate.effort,
            shortest_step: self.iterate.shortest_step,
            ..Kept::default()
        };
        if history {
            let rows = self.caches.agreed(model, &problem.offset, recovered);
            kept.trace = traces(model, problem, &rows);
            let slides = |p: &PointState| p.state == ContactState::Slip;
            kept.sliding = recovered.points.iter().map(slides).collect();
        }
        let motions = model.coupling_motions(&recovered.torn).into_iter().enumerate();
        let along = |(k, motion)| model.discrete.couplings.along(k, motion);
        kept.motions = motions.map(along).collect();
        let spans = model.scene.has_spans() && model.scene.stage_steps().end < model.plan.steps;
        let goes_on = kept.between || problem.index + 1 < model.plan.steps;
        let loose = || model.loose_motions().is_ok_and(|motions| !motions.is_empty());
        if spans || history && goes_on && loose() {
            kept.displacement = model.tfeti.nodal_mean(&recovered.torn);
        }
        if history && model.any_law(Friction::depends_on_rate) {
            kept.rate = recovered.points.iter().map(|p| p.slip_rate).collect();
            result.report.counters.rate_updates += 1;
        }
        if model.plan.steps > 1 || kept.between {
            product(model, problem, &recovered.rows, &mut self.iterate);
            kept.f_lambda = std::mem::take(&mut self.iterate.f_lambda);
            kept.lambda = std::mem::take(&mut self.iterate.lambda);
            kept.multiplier = std::mem::take(&mut self.iterate.multiplier);
        }
        if result.report.status.converged() {
            // what did not converge is no scale for later steps
            let peaks: Vec<Peak> = recovered.sizes.iter().map(Sizes::peak).collect();
            state.raise(&peaks);
        } else if history || model.scene.leaves() || model.scene.couplings.iter().any(|c| c.pending().is_some()) {
            state.note_unconverged();
        }
        let old = state.advance(self.settings.extrapolate, self.operator, kept);
        [self.iterate.lambda, self.iterate.f_lambda] = old;
        if let Some(accuracy) = &result.report.accuracy {
            self.controller.errors = accuracy.accumulated;
            state.controller = self.controller;
        }
    }
}

/// `x` becomes the last vector, or the line through the last two, so many of their distances on; zero before the first.
/// The one before is zero if `None`.
fn start_vector(last: &[f64], before: Option<&[f64]>, n: usize, along: Option<f64>, x: &mut Vec<f64>) {
    if last.is_empty() {
        *x = zeros(std::mem::take(x), n);
        return;
    }
    *x = of_length(std::mem::take(x), last.len());
    vector::copy(last, x);
    match (along, before) {
        (Some(ratio), Some(before)) if before.len() == n => vector::extrapolate(last, before, ratio, x),
        (Some(ratio), None) => vector::axpy(ratio, last, x),
        _ => {}
    }
}

/// Tangential displacements relative to the obstacle or the other body, m, by tangential row; without elastic slip,
/// which comes back.
fn traces(model: &Model, problem: &StepProblem, rows: &[f64]) -> Vec<f64> {
    let mut trace = vec![0.0; model.tangential_rows()];
    let start = model.tangential_start();
    for point in &model.points {
        for along in point.along() {
            let k = along.1;
            trace[k - start] = problem.relative(point, along, rows[k]);
        }
    }
    trace
}

/// `F lambda` afresh from the recovered displacement: rows, with what gives way, are `F lambda + B K+ f + Gᵀ alpha`.
pub(super) fn product(model: &Model, problem: &StepProblem, rows: &[f64], iterate: &mut Iterate) {
    let out = &mut iterate.f_lambda;
    model.tfeti.coarse().transpose_times(&iterate.alpha, out);
    vector::axpy(1.0, &problem.load, out);
    vector::axpby(1.0, rows, -1.0, out);
    iterate.known = true;
}
