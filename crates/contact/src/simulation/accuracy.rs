//! Solves of one step: one, or several until the certificate or an estimate of the error is small enough.

use super::simulation::Simulation;
use super::step::product;
use crate::error::ContactError;
use crate::estimate::Solved;
use crate::report::{AccuracyReport, AlgebraicError, StepReport, relative};
use crate::result::{Recovered, contact_violation};
use crate::settings::Accuracy;
use crate::state::{Controller, Discretisation, certificate_limit};
use crate::status::StepStatus;
use crate::tolerances::{CERTIFIED, CONTACT_LIMITS, LEAST_TOLERANCE, NEXT_AIM, NEXT_TOLERANCE, ROUNDS};

/// Ends the rounds of a step by its certificate, which has the last word: where it is above the tolerance, the solver
/// goes on once or twice with a smaller one; where it stays far above (thin bodies, whose displacement magnifies errors
/// of the forces), with ever smaller ones.
struct ByCertificate {
    tolerance: f64,
    /// What is wanted of the certificate, and what is accepted.
    aim: f64,
    limit: f64,
}

impl ByCertificate {
    fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            aim: tolerance.max(LEAST_TOLERANCE),
            limit: (CERTIFIED * tolerance)
                .min(tolerance.max(CONTACT_LIMITS[1]))
                .max(LEAST_TOLERANCE),
        }
    }

    /// How the step ended with this round; `None` if another one is to come. After interior points were `taken`
    /// for a start, it may end near by without converging.
    fn judge(&mut self, (round, taken): (usize, bool), status: StepStatus, largest: f64) -> Option<StepStatus> {
        let certified = largest <= self.limit;
        // what is wanted is there, whatever the solver says; or an earlier round converged, and what this one could not
        // improve is certified
        let not_better = round > 2 || (round > 1 || taken) && !status.converged();
        let enough = largest <= self.aim || certified && not_better;
        let status = if enough { StepStatus::Converged } else { status };
        if enough || !status.converged() || self.tolerance <= LEAST_TOLERANCE {
            let refused = status.converged() && !certified;
            return Some(if refused { StepStatus::NotCertified } else { status });
        }
        let factor = if certified {
            (NEXT_AIM * self.aim / largest).max(NEXT_TOLERANCE)
        } else {
            NEXT_TOLERANCE
        };
        self.tolerance = (factor * self.tolerance).max(LEAST_TOLERANCE);
        None
    }
}

impl Simulation {
    /// Solves the step to the accuracy of the settings, in as many rounds as that takes, each warm from the one before.
    pub(super) fn solve(&mut self) -> Result<(StepReport, Recovered), ContactError> {
        let by_estimates = self.settings.accuracy != Accuracy::Tolerance;
        let mut certificate = ByCertificate::new(self.settings.tolerance);
        let mut before: Option<StepReport> = None;
        let mut round = 0;
        loop {
            round += 1;
            let tolerance = if by_estimates { self.controller.tolerance() } else { certificate.tolerance };
            let (mut report, recovered) = self.solve_once(tolerance)?;
            let ended = if by_estimates {
                self.judge(round, &mut report, &recovered)?
            } else {
                let largest = recovered.certificate.largest();
                certificate.judge((round, self.iterate.offered), report.status, largest)
            };
            if let Some(before) = before.take() {
                report = before.resumed(report);
            }
            if let Some(status) = ended {
                report.status = status;
                return Ok((report, recovered));
            }
            before = Some(report);
            product(&self.model, &self.problem, &recovered.rows, &mut self.iterate);
            self.spare = recovered;
        }
    }

    /// What is wanted of the certificate where no solver has made a result.
    pub(super) fn wanted(&self) -> f64 {
        if self.settings.accuracy == Accuracy::Tolerance {
            self.settings.tolerance
        } else {
            self.controller.tolerance()
        }
    }

    /// The same by estimates of the error, which it writes to the report.
    fn judge(
        &mut self,
        round: usize,
        report: &mut StepReport,
        recovered: &Recovered,
    ) -> Result<Option<StepStatus>, ContactError> {
        let solved = Solved {
            model: &self.model,
            caches: &self.caches,
            problem: &self.problem,
            recovered,
        };
        let algebraic = solved.algebraic_error();
        let (discretisation, target) = match self.settings.accuracy {
            Accuracy::Balanced { fraction } => {
                let known = discretisation(&mut self.controller, &solved, &algebraic)?;
                (Some(known), known.target(fraction))
            }
            Accuracy::Relative(x) => (None, x),
            Accuracy::Tolerance => (None, f64::INFINITY),
        };
        let plan = &self.model.plan;
        let history = plan.effects.history;
        let errors = &self.controller.errors;
        let share = if history {
            errors.share(&algebraic, target, plan.steps - self.problem.index, plan.steps)
        } else {
            target
        };
        let certificate = &recovered.certificate;
        let (found, mut largest) = (algebraic.relative(), contact_violation(certificate));
        // the estimate brings bodies into balance by their supports
        if !self.model.loose_motions()?.is_empty() {
            largest = largest.max(certificate.equilibrium.relative());
        }
        let limit = certificate_limit(target);
        let (reached, certified) = (found <= share, largest <= limit);
        report.accuracy = Some(AccuracyReport {
            algebraic,
            accumulated: errors.with(&algebraic, history),
            discretisation: discretisation.map(|d| d.relative),
            estimated_at: discretisation.map(|d| d.step),
            target,
            share,
            reached,
            certificate_limit: limit,
            certified,
            rounds: round,
            tolerance: self.controller.tolerance(),
        });
        let (good, targets) = (reached && certified, [(found, share), (largest, limit)]);
        if good && round == 1 {
            self.controller.relax(targets);
        }
        let again = !good && report.status.converged() && round < ROUNDS;
        if again && self.controller.tighten(targets) {
            return Ok(None);
        }
        Ok(Some(match report.status {
            StepStatus::Converged if !reached => StepStatus::Stagnated,
            StepStatus::Converged if !certified => StepStatus::NotCertified,
            _ if good => StepStatus::Converged,
            status => status,
        }))
    }

    /// Judges by estimates, where there are any, what took the place of a solver's result.
    pub(super) fn judge_again(&mut self, report: &mut StepReport, recovered: &Recovered) -> Result<(), ContactError> {
        let Some(before) = report.accuracy else {
            return Ok(());
        };
        // no further round
        if let Some(status) = self.judge(ROUNDS, report, recovered)? {
            report.status = status;
        }
        report.accuracy = report.accuracy.map(|own| AccuracyReport {
            rounds: before.rounds,
            ..own
        });
        Ok(())
    }
}

/// The discretisation error of the step, or of an earlier one like it.
fn discretisation(
    controller: &mut Controller,
    solved: &Solved<'_>,
    own: &AlgebraicError,
) -> Result<Discretisation, ContactError> {
    let (known, step) = (controller.discretisation, solved.problem.index);
    if known.holds(step, own.scale) {
        return Ok(known);
    }
    let found = solved.discretisation_error()?;
    controller.discretisation = Discretisation {
        relative: if own.scale > own.elastic { relative(found.energy, own.scale) } else { found.relative() },
        step,
        scale: own.scale,
    };
    Ok(controller.discretisation)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What an earlier round reached counts, also where the next one, with a smaller tolerance, makes no progress.
    #[test]
    fn what_a_further_round_could_not_improve_is_certified() {
        let rounds = |ends: [(StepStatus, f64); 2]| {
            let mut certificate = ByCertificate::new(1e-6);
            let [first, second] = ends;
            assert_eq!(certificate.judge((1, false), first.0, first.1), None);
            certificate.judge((2, false), second.0, second.1)
        };
        let (converged, stagnated) = (StepStatus::Converged, StepStatus::Stagnated);
        assert_eq!(rounds([(converged, 5e-6), (stagnated, 5e-6)]), Some(converged));
        assert_eq!(rounds([(converged, 5e-6), (stagnated, 5e-5)]), Some(stagnated));
        assert_eq!(rounds([(converged, 5e-5), (converged, 5e-7)]), Some(converged));
        // of a rough tolerance, too, what is accepted is no gross violation
        for (tolerance, largest, end) in [(1e-3, 9e-3, converged), (1e-3, 2e-2, stagnated), (0.05, 0.8, stagnated)] {
            let mut certificate = ByCertificate::new(tolerance);
            assert_eq!(certificate.judge((1, false), converged, largest), None);
            assert_eq!(
                certificate.judge((2, false), stagnated, largest),
                Some(end),
                "{tolerance:e}, {largest:e}"
            );
        }
    }
}
