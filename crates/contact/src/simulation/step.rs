//! One step: prepared, solved, recovered, remembered.

use super::halving::{Before, Way};
use super::result::StepResult;
use super::simulation::{Simulation, on_pool};
use crate::error::ContactError;
use crate::model::{Model, slides};
use crate::report::StepReport;
use crate::result::{ContactState, PointState, Recovered, Sizes, summarise};
use crate::scene::{Friction, Increment};
use crate::settings::Accuracy;
use crate::solve::{Attempt, Iterate, Task};
use crate::state::{Peak, State};
use crate::status::StepStatus;
use crate::step::StepProblem;
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
        Arc::make_mut(&mut self.problem).prepare(&self.model, state, increment, 0.0)?;
        let attempts = self.attempts(state, increment);
        let (tried, unloaded, told) = self.unload(state, way, attempts[0])?;
        let (mut report, recovered, replaced) = match unloaded {
            Some(recovered) => (tried, recovered, true),
            None => {
                let (report, recovered) = self.attempt(attempts, state, way, (tried, told.as_ref()))?;
                let certificate = recovered.certificate;
                let stands = self.stand(state, recovered, told.unwrap_or_default())?;
                let replaced = stands.certificate != certificate;
                (report, stands, replaced)
            }
        };
        // bodies that stand elsewhere now
        if replaced {
            self.judge_again(&mut report, &recovered)?;
        }
        let by_tolerance = self.settings.accuracy == Accuracy::Tolerance;
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
            summaries: summarise(model, problem, &recovered, &self.iterate.lambda, &state.trace[0])?,
            model: model.clone(),
            caches: self.caches.clone(),
            problem: problem.clone(),
            report,
            recovered,
        })
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
        let recovered = self.recover([&self.iterate.lambda, &self.iterate.alpha], old);
        model.tfeti.check_processes()?;
        let recovered = recovered?;
        report.counters.products += 1;
        Ok((report, recovered))
    }

    /// What follows from multipliers of a solver and rigid amplitudes, in the memory of an `old` one.
    pub(super) fn recover(&self, [found, alpha]: [&[f64]; 2], old: Recovered) -> Result<Recovered, ContactError> {
        let lambda = self.problem.multipliers(found);
        let of = (&*self.model, &*self.problem);
        Recovered::new(of, self.settings.tolerance, [&lambda, alpha], old)
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
        // without contact forces nothing slides
        let rubs = !matches!(attempt, Attempt::Rest | Attempt::Apart);
        if rubs && state.sliding.iter().any(|s| *s) {
            iterate
                .known_rows
                .extend_from_slice(&iterate.lambda[model.contact_rows()]);
            (self.problem).restore_sliding(model, &state.sliding, &mut iterate.lambda);
        }
    }

    /// Makes the state after an increment from that before it.
    fn remember(&mut self, state: &mut State, result: &mut StepResult, way: &Way) {
        let (model, problem, recovered) = (&self.model, &self.problem, &result.recovered);
        let history = model.plan.effects.history;
        let mut trace = Vec::new();
        state.sliding.clear();
        if history {
            let rows = self.caches.agreed(model, &problem.offset, recovered);
            trace = traces(model, problem, &rows);
            let slides = |p: &PointState| p.state == ContactState::Slip;
            state.sliding.extend(recovered.points.iter().map(slides));
        }
        state.push_trace(trace);
        state.loads = model.mark(&problem.factors);
        let motions = model.coupling_motions(&recovered.torn).into_iter().enumerate();
        let along = |(k, motion)| model.discrete.couplings.along(k, motion);
        state.motions = motions.map(along).collect();
        let spans = model.scene.has_spans() && model.scene.stage_steps().end < model.plan.steps;
        // what a longer analysis may hold from here on
        let ends = model.scene.analysis.formula().is_some() && problem.index + 1 == model.plan.steps;
        let is_held = || model.loose_motions().is_ok_and(|motions| motions.is_empty());
        state.displacement = if spans || ends || history && !is_held() {
            model.tfeti.nodal_mean(&recovered.torn)
        } else {
            Vec::new()
        };
        state.rate.clear();
        if history && model.any_law(Friction::depends_on_rate) {
            state.rate.extend(recovered.points.iter().map(|p| p.slip_rate));
            result.report.counters.rate_updates += 1;
        }
        let mut vectors = <[Vec<f64>; 3]>::default();
        if model.plan.steps > 1 || way.goes_on() || history {
            product(model, problem, &recovered.rows, &mut self.iterate);
            let iterate = &mut self.iterate;
            vectors = [&mut iterate.lambda, &mut iterate.f_lambda, &mut iterate.multiplier].map(std::mem::take);
        }
        if result.report.status.converged() {
            // what did not converge is no scale for later steps
            let peaks: Vec<Peak> = recovered.sizes.iter().map(Sizes::peak).collect();
            state.raise(&peaks);
        } else if history || model.scene.leaves() || model.scene.couplings.iter().any(|c| c.pending().is_some()) {
            state.note_unconverged();
        }
        let old = state.push(self.settings.extrapolate, self.operator, vectors);
        [self.iterate.lambda, self.iterate.f_lambda] = old;
        (state.halved, state.effort) = (way.halved(), self.iterate.effort);
        state.shortest_step = self.iterate.shortest_step;
        if !way.goes_on() {
            state.pass(problem.time);
        }
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
    let tangential = model.tangential_rows();
    let mut trace = vec![0.0; tangential.len()];
    for point in model.points.iter() {
        for along in point.along() {
            trace[along.row - tangential.start] = problem.relative(point, along, rows[along.row]);
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
