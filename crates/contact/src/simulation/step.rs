//! One step: prepared, solved, recovered, remembered.

use super::frame::StepResult;
use super::simulation::Simulation;
use super::threads::on_pool;
use crate::error::ContactError;
use crate::report::StepReport;
use crate::result::{ContactState, Measured, Sizes, certify, point_states, sizes, summarise};
use crate::scene::Friction;
use crate::solve::restore_sliding;
use crate::state::{Peak, State};
use signorini_qp::vector;
use std::sync::Arc;

impl Simulation {
    /// Solves the next level. Not converging is no error: see the frame's report.
    ///
    /// # Errors
    /// [`ContactError::Finished`] after the last level; a breakdown of a solver. The state is then unchanged.
    pub fn step(&mut self) -> Result<StepResult<'_>, ContactError> {
        let index = self.state.step();
        // not taken out: laws of the user may panic
        let state = self.state.clone();
        self.solved = false;
        let busy = self.settings.busy_waiting;
        let outcome = on_pool(busy, || self.solve_level(&state, index));
        drop(state);
        let (mut report, lambda, rows) = outcome?;
        report.unconverged_history = self.state.unconverged_history();
        self.remember(lambda, rows, &mut report);
        self.total += report.counters;
        self.report = report;
        self.solved = true;
        Ok(self.present())
    }

    /// Solves a level that follows on a state.
    fn solve_level(
        &mut self,
        state: &State,
        index: usize,
    ) -> Result<(StepReport, Vec<f64>, Vec<f64>), ContactError> {
        self.controller = state.controller();
        self.level.prepare(&self.model, state, index)?;
        self.start(state)?;
        let (report, lambda, rows) = self.solve()?;
        let before: Vec<f64> = (0..self.model.tangential_rows())
            .map(|k| state.traces(k).0)
            .collect();
        self.summary = summarise(
            &self.model,
            &self.level,
            &self.points,
            &lambda,
            &rows,
            &before,
        )?;
        Ok((report, lambda, rows))
    }

    /// One run of the solver from the present iterate, and what is recovered from it: multipliers and `B u`.
    pub(super) fn solve_once(
        &mut self,
        tolerance: f64,
    ) -> Result<(StepReport, Vec<f64>, Vec<f64>), ContactError> {
        let model = &self.model;
        let other;
        let settings = if tolerance == self.settings.tolerance {
            &self.settings
        } else {
            other = self.settings.clone().with_tolerance(tolerance);
            &other
        };
        let mut report = self
            .solver
            .solve(model, &self.level, settings, &mut self.iterate)?;
        // recovery: u, and from it everything that is reported
        let tfeti = &model.tfeti;
        let force = self.level.forces(model);
        let lambda = std::mem::take(&mut self.iterate.lambda);
        self.torn = tfeti.recover(&force, &lambda, &self.iterate.alpha)?;
        report.counters.products += 1;
        let mut rows = vec![0.0; tfeti.dual_dim()];
        tfeti.rows_times(&self.torn, &mut rows);
        self.residual = tfeti.equilibrium_residual(&self.torn, &force, &lambda)?;
        let measured = Measured {
            rows: &rows,
            u: &self.torn,
            force: &force,
            residual: &self.residual,
        };
        self.sizes = sizes(model, &self.level, &lambda, &measured);
        self.certificate = certify(model, &self.level, &lambda, &measured, &self.sizes);
        self.points = point_states(model, &self.level, &lambda, &rows);
        let supports = tfeti.gluing().ranges().dirichlet.clone();
        self.held.clear();
        self.held.extend_from_slice(&lambda[supports]);
        Ok((report, lambda, rows))
    }

    /// Start vectors of a level: zero, the last level, or the line through the last two.
    fn start(&mut self, state: &State) -> Result<(), ContactError> {
        let rows = self.model.tfeti.dual_dim();
        let extrapolate = |pair: &[Vec<f64>; 2], n: usize, on: bool| -> Vec<f64> {
            let [last, before] = pair;
            if last.is_empty() {
                return vec![0.0; n];
            }
            let mut x = last.clone();
            if on && before.len() == n {
                vector::extrapolate(last, before, 1.0, &mut x);
            }
            x
        };
        let on = self.settings.extrapolate;
        // before the first level everything is at rest: zero is known, too
        let before_known = state.step() != 1 || self.model.plan.levels == 1;
        let pairs = (state.lambda(), state.f_lambda());
        let zero = vec![0.0; rows];
        if on && !before_known && pairs.0[1].is_empty() {
            let first = [pairs.0[0].clone(), zero.clone()];
            let product = [pairs.1[0].clone(), zero];
            self.iterate.lambda = extrapolate(&first, rows, true);
            self.iterate.f_lambda = extrapolate(&product, rows, true);
        } else {
            self.iterate.lambda = extrapolate(pairs.0, rows, on);
            self.iterate.f_lambda = extrapolate(pairs.1, rows, on);
        }
        self.iterate.known = (0..2).all(|k| pairs.0[k].len() == pairs.1[k].len());
        let coarse = self.model.tfeti.coarse().rows();
        self.iterate.multiplier = extrapolate(state.multiplier(), coarse, on);
        if state.sliding().iter().any(|s| *s) {
            let old = self.iterate.lambda.clone();
            let mut set = self.model.set.clone();
            self.level
                .slip_bounds(&self.model, &self.iterate.lambda, &mut set);
            restore_sliding(&self.model, &set, state.sliding(), &mut self.iterate.lambda);
            self.iterate.known &= old == self.iterate.lambda;
        }
        Ok(())
    }

    fn remember(&mut self, lambda: Vec<f64>, rows: Vec<f64>, report: &mut StepReport) {
        let effects = &self.model.plan.effects;
        let quasistatic = self.model.plan.levels > 1;
        let mut trace = Vec::new();
        let mut sliding = Vec::new();
        let mut rate = Vec::new();
        if effects.history {
            trace.resize(self.model.tangential_rows(), 0.0);
            let start = self.model.tangential_start();
            for point in &self.model.points {
                // relative to the obstacle or the other body
                for along in point.along() {
                    let k = along.1;
                    trace[k - start] = self.level.relative(point.surface, along, rows[k]);
                }
            }
            sliding.extend(self.points.iter().map(|p| p.state == ContactState::Slip));
        }
        if effects.history && self.model.any_law(Friction::depends_on_rate) {
            rate.extend(self.points.iter().map(|p| p.slip_rate));
            report.counters.rate_updates += 1;
        }
        let (lambda, f_lambda, multiplier) = if quasistatic {
            // F lambda afresh from the recovered displacement: B u = F lambda + B K+ f + G^T alpha
            let tfeti = &self.model.tfeti;
            let mut f_lambda = rows;
            let mut rigid = vec![0.0; f_lambda.len()];
            tfeti.coarse().apply_transpose(
                &self.iterate.alpha,
                &mut rigid,
                &mut tfeti.coarse().scratch(),
            );
            for ((f, load), rigid) in f_lambda.iter_mut().zip(&self.level.load).zip(&rigid) {
                *f -= load + rigid;
            }
            (
                lambda,
                f_lambda,
                std::mem::take(&mut self.iterate.multiplier),
            )
        } else {
            (Vec::new(), Vec::new(), Vec::new())
        };
        let state = Arc::make_mut(&mut self.state);
        state.pass(self.level.time);
        if report.status.converged() {
            // what did not converge is no scale for later levels
            let peaks: Vec<Peak> = self.sizes.iter().map(Sizes::peak).collect();
            state.raise(&peaks);
        } else if effects.history {
            state.note_unconverged();
        }
        state.advance(
            self.settings.extrapolate,
            lambda,
            f_lambda,
            multiplier,
            trace,
            rate,
            sliding,
        );
        state.seal(self.operator);
        if let Some(accuracy) = &report.accuracy {
            self.controller.errors = accuracy.accumulated;
            state.set_controller(self.controller);
        }
    }
}
