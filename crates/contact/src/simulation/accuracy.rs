//! Solves of one level: one, or several until the certificate or an estimate of the error is small enough.

use super::simulation::Simulation;
use crate::error::ContactError;
use crate::report::{AccuracyReport, AlgebraicError, StepReport, relative};
use crate::result::contact_violation;
use crate::settings::Accuracy;
use crate::state::{Discretisation, certificate_limit};
use crate::status::StepStatus;
use crate::tolerances::ROUNDS;

/// Largest certificate of a converged level over the tolerance.
const CERTIFIED: f64 = 30.0;

/// Aim of a second round, as a fraction of the tolerance.
const MARGIN: f64 = 0.3;

/// Smallest tolerance that is tried, and the certificate that rounding leaves.
const LEAST: f64 = 1e-10;

impl Simulation {
    /// Solves the level to the accuracy of the settings: once, or until the estimated error is small enough.
    pub(super) fn solve(&mut self) -> Result<(StepReport, Vec<f64>, Vec<f64>), ContactError> {
        let accuracy = self.settings.accuracy;
        if accuracy == Accuracy::Tolerance {
            return self.solve_certified();
        }
        let mut total: Option<StepReport> = None;
        let mut rounds = 0;
        loop {
            let tolerance = self.controller.tolerance();
            let (mut report, lambda, rows) = self.solve_once(tolerance)?;
            rounds += 1;
            let algebraic = self.present().algebraic_error();
            let (discretisation, target) = match accuracy {
                Accuracy::Balanced { fraction } => {
                    let known = self.discretisation(&algebraic)?;
                    (Some(known), known.target(fraction))
                }
                Accuracy::Relative(x) => (None, x),
                Accuracy::Tolerance => (None, f64::INFINITY),
            };
            let found = algebraic.relative();
            let plan = &self.model.plan;
            let history = plan.effects.history;
            let share = if history {
                let left = plan.levels - self.level.index;
                self.controller
                    .errors
                    .share(&algebraic, target, left, plan.levels)
            } else {
                target
            };
            let reached = found <= share;
            let largest = contact_violation(&self.certificate);
            let limit = certificate_limit(target);
            let certified = largest <= limit;
            report.accuracy = Some(AccuracyReport {
                algebraic,
                accumulated: self.controller.errors.with(&algebraic, history),
                discretisation: discretisation.map(|d| d.relative),
                estimated_at: discretisation.map(|d| d.level),
                target,
                share,
                reached,
                certificate_limit: limit,
                certified,
                rounds,
                tolerance,
            });
            let converged = report.status.converged();
            let mut report = match total.take() {
                Some(before) => before.resumed(report),
                None => report,
            };
            let (good, targets) = (reached && certified, [(found, share), (largest, limit)]);
            if good && rounds == 1 {
                self.controller.relax(targets);
            }
            let again = !good && converged && rounds < ROUNDS;
            if !again || !self.controller.tighten(targets) {
                report.status = match report.status {
                    StepStatus::Converged if !reached => StepStatus::Stagnated,
                    StepStatus::Converged if !certified => StepStatus::NotCertified,
                    status => status,
                };
                return Ok((report, lambda, rows));
            }
            total = Some(report);
            self.iterate.lambda = lambda;
        }
    }

    /// The discretisation error of the level, or of an earlier one like it.
    fn discretisation(&mut self, own: &AlgebraicError) -> Result<Discretisation, ContactError> {
        let (known, level) = (self.controller.discretisation, self.level.index);
        if known.holds(level, own.scale) {
            return Ok(known);
        }
        let found = self.present().discretisation_error()?;
        self.controller.discretisation = Discretisation {
            relative: if own.scale > own.elastic {
                relative(found.energy(), own.scale)
            } else {
                found.relative()
            },
            level,
            scale: own.scale,
        };
        Ok(self.controller.discretisation)
    }

    /// Solves with the tolerance of the settings. The certificate has the last word: where it is above the tolerance, the
    /// solver continues once with a smaller one; where it stays far above (thin bodies, whose displacement magnifies
    /// errors of the forces), with ever smaller ones.
    fn solve_certified(&mut self) -> Result<(StepReport, Vec<f64>, Vec<f64>), ContactError> {
        let aim = self.settings.tolerance.max(LEAST);
        let limit = (CERTIFIED * self.settings.tolerance).max(LEAST);
        let mut tolerance = self.settings.tolerance;
        let mut total: Option<StepReport> = None;
        loop {
            let (report, lambda, rows) = self.solve_once(tolerance)?;
            let largest = self.certificate.largest();
            let certified = largest <= limit;
            let first = total.is_none();
            let mut converged = report.status.converged();
            let mut report = match total.take() {
                Some(before) => before.resumed(report),
                None => report,
            };
            if !first && !converged && certified {
                // an earlier round converged, and what this one could not improve is certified
                report.status = StepStatus::Converged;
                converged = true;
            }
            let enough = largest <= aim || certified && !first;
            if enough || !converged || tolerance <= LEAST {
                if converged && !certified {
                    report.status = StepStatus::NotCertified;
                }
                return Ok((report, lambda, rows));
            }
            let factor = if certified {
                (MARGIN * aim / largest).max(0.01)
            } else {
                0.01
            };
            tolerance = (factor * tolerance).max(LEAST);
            total = Some(report);
            self.iterate.lambda = lambda;
        }
    }
}
