//! The attempts at an increment, one after another as long as it is lost.

use super::halving::Way;
use super::simulation::Simulation;
use super::unloaded::Targets;
use crate::error::ContactError;
use crate::plan::FrictionKind;
use crate::report::StepReport;
use crate::result::Recovered;
use crate::scene::Increment;
use crate::settings::{Accuracy, Method};
use crate::solve::Attempt;
use crate::state::State;
use crate::status::StepStatus;
use crate::tolerances::ROUNDING;
use signorini_qp::vector;
use std::sync::Arc;

/// Whether an attempt starts on the line through the last two steps, or else from the last one.
type Start = (bool, Attempt);

impl Simulation {
    /// The attempts at an increment that follows on a state.
    pub(super) fn attempts(&self, state: &State, increment: Increment) -> Vec<Start> {
        // the line leads on where the loads have stopped, and astray where friction has turned round: there is another
        // start
        let extrapolates = self.settings.extrapolate;
        let rests = |last| self.problem.rests(&self.model, (state, last));
        let rests = extrapolates && increment.start.is_some_and(rests);
        let line = extrapolates && !rests;
        if extrapolates && state.step() > 0 && state.unconverged_history().is_none() {
            if !self.falls_back() {
                return vec![(line, Attempt::First), (!line, Attempt::Whole)];
            }
            // with a formula of more steps the rate is yet to fall; estimates judge what was solved
            let is_one_step = (self.problem.formula).is_some_and(|formula| formula.is_one_step());
            let stands = rests && is_one_step && self.settings.accuracy == Accuracy::Tolerance;
            let all = [(line, Attempt::Rest), (line, Attempt::First), (!line, Attempt::Whole)];
            return all[usize::from(!stands)..].to_vec();
        }
        vec![(line, Attempt::Whole)]
    }

    /// The attempts, and one without contact forces where loads do no work on what contact alone stops: first, if
    /// bodies stood apart, else after a brief one. So it is after that where all loads end,
    /// or all that acts is back at zero.
    fn with_apart(
        &self,
        mut attempts: Vec<Start>,
        state: &State,
        way: &Way,
        told: bool,
    ) -> Result<Vec<Start>, ContactError> {
        // friction may lock bodies that were pressed, and a first step is mostly to press them
        let locks = self.model.plan.effects.friction != FrictionKind::None;
        let by_tolerance = self.settings.accuracy == Accuracy::Tolerance;
        if !by_tolerance || !self.falls_back() || locks && (told || state.step() == 0) {
            return Ok(attempts);
        }
        let loose = self.model.loose_motions()?;
        let held = loose.is_empty();
        // forces of bodies that supports hold may vanish with the loads, too
        let (problem, model) = (&self.problem, &self.model);
        let ends = |start| problem.is_unloaded(model, state) || problem.is_back(model, (state, start));
        let may_vanish = if held {
            way.increment().start.is_some_and(ends)
        } else {
            self.problem.is_balanced(loose)
        };
        if !may_vanish {
            return Ok(attempts);
        }
        let apart = (false, Attempt::Apart);
        if !held && self.stood_apart(state) {
            attempts.insert(0, apart);
            return Ok(attempts);
        }
        let at = usize::from(attempts[0].1 == Attempt::Rest);
        let brief = (attempts[at].0, Attempt::Brief);
        attempts.splice(at..at, [brief, apart]);
        Ok(attempts)
    }

    /// Whether the paper's method follows where active sets make no progress.
    fn falls_back(&self) -> bool {
        matches!(self.settings.method, Method::ActiveSet(_)) && !self.model.points.is_empty()
    }

    /// Makes one attempt after another as long as the step is lost, the first from the iterate of what was tried
    /// before, if that converged. Where loads end, it was told where bodies stand: then without forces, too.
    pub(super) fn attempt(
        &mut self,
        attempts: Vec<Start>,
        state: &State,
        way: &Way,
        (tried, told): (StepReport, Option<&Targets>),
    ) -> Result<(StepReport, Recovered), ContactError> {
        let mut sets_out = tried.status.converged();
        let mut report = tried;
        let (mut found, mut overlapping) = (None, None);
        for (line, attempt) in self.with_apart(attempts, state, way, told.is_some())? {
            self.spare = found.take().unwrap_or_else(|| std::mem::take(&mut self.spare));
            self.controller = state.controller;
            if attempt == Attempt::Apart {
                let (kept, lost) = (self.iterate.clone(), report.status);
                let apart = self.apart(state, way, &mut report)?;
                let overlaps = apart.as_ref().is_some_and(|apart| self.overlaps(apart));
                if let Some(apart) = apart {
                    if !overlaps {
                        return Ok((report, apart));
                    }
                    overlapping = Some((std::mem::take(&mut self.iterate), report.status, apart));
                }
                (self.iterate, report.status) = (kept, lost);
                continue;
            }
            if !std::mem::take(&mut sets_out) {
                self.start(state, way, line, attempt);
            }
            let (next, recovered) = self.solve()?;
            (report, found) = (report.resumed(next), Some(recovered));
            let goes_on = report.status.is_lost() || attempt == Attempt::Brief && !report.status.converged();
            if !goes_on {
                break;
            }
            // friction that nearly locks bodies lets active sets run in circles where forces vanish, too
            if let Some(told) = told
                && let Some(left) = self.without_forces(state, told, &mut report)?
            {
                report.status = StepStatus::Converged;
                self.judge_again(&mut report, &left)?;
                return Ok((report, left));
            }
        }
        // no contact force was found that an overlap next to none would make
        if let Some((iterate, status, apart)) = overlapping.filter(|_| !report.status.converged()) {
            (self.iterate, report.status) = (iterate, status);
            return Ok((report, apart));
        }
        Ok((report, found.unwrap_or_default()))
    }

    /// Whether points overlap by more than solvers and rounding leave: a ride of the whole body has no part in it.
    fn overlaps(&self, recovered: &Recovered) -> bool {
        let tfeti = &self.model.tfeti;
        let strained = tfeti.of_subdomains(|subdomain| {
            let mut own = recovered.torn[tfeti.torn_range(subdomain)].to_vec();
            let kernel = tfeti.kernel(subdomain);
            kernel.add_motion(-1.0, &kernel.transpose_times(&own), &mut own);
            [vector::max_abs(&own)]
        });
        let strained = strained.into_iter().map(|[own]| own).fold(0.0, f64::max);
        let gap = recovered.certificate.gap;
        let allowed = self.settings.tolerance * strained + ROUNDING * gap.reference;
        gap.value > allowed.max(self.model.discrete.rounding)
    }

    /// The result without contact forces: bodies then stand apart, or touch without force, and active sets run in
    /// circles. Without friction there are no other forces if that is a solution, and with it none that anything
    /// presses. `None` if it is none; the iterate is then lost.
    fn apart(&mut self, state: &State, way: &Way, report: &mut StepReport) -> Result<Option<Recovered>, ContactError> {
        self.start(state, way, false, Attempt::Apart);
        // where forces vanish, those of the last step leave errors that are large beside them
        self.iterate.lambda.fill(0.0);
        self.iterate.f_lambda = vec![0.0; self.iterate.lambda.len()];
        self.iterate.known = true;
        let problem = Arc::make_mut(&mut self.problem);
        problem.open(&self.model);
        let solved = self.solve_once(self.settings.tolerance)?;
        Arc::make_mut(&mut self.problem).prepare(&self.model, state, way.increment(), 0.0)?;
        let (next, old) = solved;
        let converged = next.status.converged();
        *report = std::mem::take(report).resumed(next);
        if !converged {
            self.spare = old;
            return Ok(None);
        }
        let recovered = self.recover([&self.iterate.lambda, &self.iterate.alpha], old)?;
        report.counters.products += 1;
        let stands = self.stand(state, recovered, Targets::new())?;
        if stands.certificate.largest() <= self.settings.tolerance {
            return Ok(Some(stands));
        }
        self.spare = stands;
        Ok(None)
    }

    /// Whether no contact force acted in the last state; at rest none did.
    fn stood_apart(&self, state: &State) -> bool {
        let small = |row: usize| self.settings.tolerance * self.problem.rest(self.model.bodies.of_row(row));
        let force = |row: usize| state.lambda[0].get(row).copied().unwrap_or(0.0);
        self.model.points.iter().all(|p| -force(p.row) <= small(p.row))
    }
}
