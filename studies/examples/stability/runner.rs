//! Runs a case: never panics, measures everything, and judges the outcome.

use super::balance::{Balance, Ledger};
use super::case::{Case, Expect, Setup};
use signorini::prelude::*;
use signorini_studies::Failure;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

/// How a run ended.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Ended {
    /// All steps were solved; the worst status of a step, and that step.
    Solved(StepStatus, usize),
    /// The library refused the scene or broke down, with this text.
    Refused(String),
    /// It panicked: a defect.
    Panicked(String),
}

/// What was measured.
#[derive(Debug, Clone)]
pub(crate) struct Measured {
    /// How it ended.
    pub(crate) ended: Ended,
    /// Largest relative violation over all steps that converged, and which condition.
    pub(crate) certificate: (f64, &'static str),
    /// Subdomains.
    pub(crate) subdomains: usize,
    /// Rows of the dual problem.
    pub(crate) rows: usize,
    /// Steps solved.
    pub(crate) steps: usize,
    /// Products with F.
    pub(crate) products: usize,
    /// Steps that the fall-back finished.
    pub(crate) fallbacks: usize,
    /// Balances of the steps that converged.
    pub(crate) balance: Balance,
    /// Wall-clock seconds, set-up included.
    pub(crate) seconds: f64,
    /// Dimensionless figures of the last step: normal force, friction force (three components), norm of the friction
    /// forces and mean displacement (three components), by the load and the size of the body.
    pub(crate) figures: Vec<f64>,
}

impl Measured {
    fn new() -> Self {
        Self {
            ended: Ended::Refused(String::new()),
            certificate: (0.0, ""),
            subdomains: 0,
            rows: 0,
            steps: 0,
            products: 0,
            fallbacks: 0,
            balance: Balance::default(),
            seconds: 0.0,
            figures: Vec::new(),
        }
    }

    /// What is wrong with the outcome, if anything.
    pub(crate) fn complaint(&self, expect: Expect) -> Option<String> {
        match (&self.ended, expect) {
            (Ended::Panicked(text), _) => Some(format!("panic: {text}")),
            (Ended::Refused(text), Expect::Refused(part)) if text.contains(part) => None,
            (Ended::Refused(text), _) => Some(format!("refused: {text}")),
            (Ended::Solved(..), Expect::Refused(part)) => Some(format!("should have been refused ({part})")),
            (Ended::Solved(status, step), Expect::Certified(limit) | Expect::CertifiedOr(limit, _)) => {
                let allowed = matches!(expect, Expect::CertifiedOr(_, s) if s.contains(status));
                if !status.converged() && !allowed {
                    return Some(format!("step {step} ended as {status:?}"));
                }
                if above(self.certificate.0, limit) {
                    return Some(format!(
                        "certificate {:.1e} ({})",
                        self.certificate.0, self.certificate.1
                    ));
                }
                if above(self.balance.largest(), 10.0 * limit) {
                    return Some(format!("balances {:?}", self.balance));
                }
                (!self.figures.iter().all(|v| v.is_finite())).then(|| "NaN".to_owned())
            }
        }
    }

    /// What is wrong where products a step are limited to this mean and no step may need the fall-back.
    pub(crate) fn excess(&self, at_most: usize) -> Option<String> {
        let (most, products, fallbacks) = (at_most * self.steps, self.products, self.fallbacks);
        let text = format!("{products} products, {fallbacks} fall-backs; at most {most} and none");
        (products > most || fallbacks > 0).then_some(text)
    }
}

/// Whether `a` is above `b` or no number.
pub(super) fn above(a: f64, b: f64) -> bool {
    a.is_nan() || a > b
}

/// Runs a case.
pub(crate) fn run(case: &Case) -> Measured {
    let start = Instant::now();
    let mut measured = Measured::new();
    let result = catch_unwind(AssertUnwindSafe(|| {
        let setup = (case.build)()?;
        solve(setup, &mut measured)
    }));
    measured.ended = match result {
        Ok(Ok(ended)) => ended,
        Ok(Err(error)) => Ended::Refused(error.to_string()),
        Err(payload) => Ended::Panicked(
            payload
                .downcast_ref::<String>()
                .cloned()
                .or_else(|| payload.downcast_ref::<&str>().map(|s| (*s).to_owned()))
                .unwrap_or_default(),
        ),
    };
    measured.seconds = start.elapsed().as_secs_f64();
    measured
}

/// Largest difference of the figures of two runs, relative to the largest figure.
pub(crate) fn difference(a: &[f64], b: &[f64]) -> f64 {
    if a.len() != b.len() || a.is_empty() {
        return f64::INFINITY;
    }
    // forces and displacements apart
    let part = |range: std::ops::Range<usize>| {
        let size = a[range.clone()].iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let off = a[range.clone()]
            .iter()
            .zip(&b[range])
            .fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
        if off == 0.0 { 0.0 } else { off / size }
    };
    part(0..5).max(part(5..8))
}

fn solve(setup: Setup, measured: &mut Measured) -> Result<Ended, Failure> {
    let mut simulation = Simulation::new(setup.scene, setup.settings)?;
    let resumed = setup.start.is_some();
    if let Some(state) = setup.start {
        simulation.resume(state)?;
    }
    measured.subdomains = simulation.plan().subdomains;
    measured.rows = simulation.tfeti().dual_dim();
    let scene = simulation.scene().clone();
    let mut ledger = Ledger::new(&scene, &setup.loads, &simulation)?;
    if resumed {
        ledger.skip_first_step();
    }
    let mut worst = (StepStatus::Converged, 0);
    let mut largest_load = 0.0_f64;
    while !simulation.is_finished() {
        let result = simulation.step()?;
        let report = result.report();
        measured.steps += 1;
        measured.fallbacks += usize::from(report.fallback);
        let load = ledger.load(result.time());
        largest_load = largest_load.max(load.iter().map(|v| v.abs()).sum());
        if report.status.converged() {
            for (name, violation) in result.certificate().parts() {
                let relative = violation.relative();
                if above(relative, measured.certificate.0) {
                    measured.certificate = (relative, name);
                }
            }
        } else if worst.0.converged() {
            worst = (report.status, result.step());
        }
        // a step that did not converge balances nothing, and neither does the step after it
        if worst.0.converged() {
            ledger.enter(&result);
        }
        measured.figures = figures(&result, &scene, largest_load);
    }
    measured.products = simulation.counters().products + simulation.counters().setup_products;
    measured.balance = ledger.balance;
    Ok(Ended::Solved(worst.0, worst.1))
}

fn figures(result: &StepResult, scene: &Scene, load: f64) -> Vec<f64> {
    let s = result.summary();
    let unit = if load > 0.0 { load } else { 1.0 };
    let (low, high) = scene.mesh().extent();
    let length = (0..3).map(|c| (high[c] - low[c]).powi(2)).sum::<f64>().sqrt();
    let mut out = vec![s.normal_force / unit];
    out.extend(s.friction_force.map(|v| v / unit));
    out.push(s.friction_norm / unit);
    let u = result.displacement();
    let nodes = u.len() as f64;
    for c in 0..3 {
        let sum: f64 = u.iter().map(|u| u[c]).sum();
        out.push(sum / nodes / length);
    }
    out
}
