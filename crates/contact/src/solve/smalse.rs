//! The paper's methods: successive approximations (3.17) with given-friction problems by SMALSE and KPRGP
//! (Algorithm 4.1), and the one inexact loop in which the slip bounds follow the outer steps of SMALSE.

use super::coarse::orthonormal_coarse;
use super::iterate::{Iterate, is_coulomb, level_status};
use crate::error::ContactError;
use crate::model::{DISCS, INTERVALS, Model};
use crate::report::{
    Contraction, FixedPointReport, StepReport, Verdict, successive_approximations,
};
use crate::scene::Friction;
use crate::settings::{InnerAccuracy, Method, Settings};
use crate::status::StepStatus;
use crate::step::StepProblem;
use signorini_qp::{
    HookAction, NormSettings, OuterHook, OuterStep, ProductSet, Projected, Segment, SmalseReport,
    SmalseSettings, SmalseWorkspace, Status, Tolerance, norm_estimate, smalse, vector,
};
use signorini_tfeti::{CoarseScratch, DualOperator, OrthonormalCoarse};

/// Safety factor between the tolerance of a level and those of SMALSE.
const SAFETY: f64 = 0.05;

/// Relative changes below this one that do not halve are put down to the inner solve.
const STALL: f64 = 1e-4;

/// How often a level may tighten the inner tolerance tenfold.
const MAX_TIGHTENINGS: usize = 3;

pub(crate) struct SmalseSolver {
    coarse: OrthonormalCoarse,
    coarse_scratch: CoarseScratch,
    norm: f64,
    norm_products: usize,
    set: ProductSet,
    rhs: Vec<f64>,
    work: SmalseWorkspace<DualOperator, OrthonormalCoarse>,
    settings: SmalseSettings,
    accuracy: InnerAccuracy,
    one_loop: bool,
    /// Products left.
    left: usize,
}

impl std::fmt::Debug for SmalseSolver {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SmalseSolver")
            .field("norm", &self.norm)
            .field("one_loop", &self.one_loop)
            .finish_non_exhaustive()
    }
}

impl SmalseSolver {
    pub(crate) fn new(model: &Model, settings: &Settings) -> Result<Self, ContactError> {
        let (smalse, accuracy, one_loop) = match &settings.method {
            Method::OneLoop { smalse } => (*smalse, InnerAccuracy::Fixed, true),
            Method::SuccessiveApproximations { smalse, accuracy } => (*smalse, *accuracy, false),
            Method::ActiveSet(_) => match Method::paper() {
                Method::SuccessiveApproximations { smalse, accuracy } => (smalse, accuracy, false),
                _ => (SmalseSettings::default(), InnerAccuracy::default(), false),
            },
        };
        let factor = model.tfeti.coarse_factor();
        let coarse = orthonormal_coarse(model)?;
        let operator = model.tfeti.dual();
        let estimate = norm_estimate(
            &Projected::new(operator, &coarse)?,
            &NormSettings::default(),
        )?;
        Ok(Self {
            coarse_scratch: factor.scratch(),
            work: SmalseWorkspace::new(operator, &coarse),
            rhs: vec![0.0; model.tfeti.coarse().rows()],
            set: model.set.clone(),
            coarse,
            norm: estimate.upper,
            norm_products: estimate.products,
            settings: smalse,
            accuracy,
            one_loop,
            left: usize::MAX,
        })
    }

    /// As [`solve`](Self::solve), with at most `limit` products.
    pub(crate) fn solve_within(
        &mut self,
        limit: usize,
        model: &Model,
        level: &StepProblem,
        settings: &Settings,
        iterate: &mut Iterate,
    ) -> Result<StepReport, ContactError> {
        self.left = limit;
        let report = self.solve(model, level, settings, iterate);
        self.left = usize::MAX;
        report
    }

    pub(crate) fn solve(
        &mut self,
        model: &Model,
        level: &StepProblem,
        settings: &Settings,
        iterate: &mut Iterate,
    ) -> Result<StepReport, ContactError> {
        self.coarse
            .rhs(&level.rhs, &mut self.rhs, &mut self.coarse_scratch);
        iterate.multiplier.resize(self.rhs.len(), 0.0);
        let mut report = StepReport::new();
        report.counters.setup_products = std::mem::take(&mut self.norm_products);
        report.counters.inequality_solves = 1;
        if !is_coulomb(model) {
            level.slip_bounds(model, &iterate.lambda, &mut self.set);
            report.counters.slip_bound_updates = usize::from(model.any_law(Friction::is_some));
            let qp =
                self.given_friction(model, level, settings.tolerance * SAFETY, &mut (), iterate)?;
            add(&mut report, &qp);
            report.iterations = 1;
            report.status = level_status(qp.status);
        } else if self.one_loop {
            self.inexact_loop(model, level, settings, iterate, &mut report)?;
        } else {
            self.fixed_point(model, level, settings, iterate, &mut report)?;
        }
        iterate.known = false;
        iterate.alpha.resize(level.rhs.len(), 0.0);
        self.coarse.amplitudes(
            self.work.equality_multiplier(),
            &mut iterate.alpha,
            &mut self.coarse_scratch,
        );
        Ok(report)
    }

    /// Problem (D(g)) with the slip bounds that are in the set.
    fn given_friction(
        &mut self,
        model: &Model,
        level: &StepProblem,
        tolerance: f64,
        hook: &mut impl OuterHook<ProductSet>,
        iterate: &mut Iterate,
    ) -> Result<SmalseReport, ContactError> {
        let mut settings = self
            .settings
            .with_tolerance(Tolerance::Relative(tolerance))
            .with_equality(tolerance);
        settings.inner.max_products = settings.inner.max_products.min(self.left).max(1);
        let operator = model.tfeti.dual();
        let report = smalse(
            operator,
            &level.linear,
            &self.coarse,
            &self.rhs,
            &mut self.set,
            self.norm,
            &settings,
            hook,
            &mut iterate.lambda,
            &mut iterate.multiplier,
            &mut self.work,
        )?;
        self.left = self.left.saturating_sub(report.products.total());
        Ok(report)
    }

    /// (3.17): the map takes normal multipliers to normal multipliers.
    fn fixed_point(
        &mut self,
        model: &Model,
        level: &StepProblem,
        settings: &Settings,
        iterate: &mut Iterate,
        report: &mut StepReport,
    ) -> Result<(), ContactError> {
        let normal = model.tfeti.gluing().ranges().normal.clone();
        let mut x: Vec<f64> = iterate.lambda[normal.clone()]
            .iter()
            .map(|v| v.min(0.0))
            .collect();
        let mut inner = Status::Converged;
        let mut target = settings.tolerance * SAFETY;
        let mut last = f64::INFINITY;
        let mut tightenings = 0;
        let mut exact = 0;
        let outcome = successive_approximations(
            &mut x,
            settings.tolerance,
            level.least()[1],
            settings.max_fixed_point,
            |x, change| {
                // Small contact forces under large loads: changes that stall above the tolerance are
                // errors of the inner solve.
                let stalls = exact > 2 && change > 0.5 * last && change < STALL;
                if stalls && tightenings < MAX_TIGHTENINGS {
                    target *= 0.1;
                    tightenings += 1;
                    exact = 1;
                }
                last = change;
                if self.left == 0 {
                    return Err(None);
                }
                let tolerance = match self.accuracy {
                    InnerAccuracy::Adaptive { factor, loosest } if exact == 0 => {
                        (factor * change).min(loosest).max(target)
                    }
                    // once at full accuracy, always: a looser solve would undo it
                    _ => target,
                };
                iterate.lambda[normal.clone()].copy_from_slice(x);
                level.slip_bounds(model, &iterate.lambda, &mut self.set);
                report.counters.slip_bound_updates += 1;
                let qp = self
                    .given_friction(model, level, tolerance, &mut (), iterate)
                    .map_err(Some)?;
                inner = qp.status;
                add(report, &qp);
                x.copy_from_slice(&iterate.lambda[normal.clone()]);
                exact += usize::from(tolerance <= target);
                Ok(tolerance <= target)
            },
        );
        let outcome = match outcome {
            Ok(outcome) => outcome,
            // no products left
            Err(None) => {
                report.iterations = report.counters.quadratic_programs;
                report.status = StepStatus::IterationLimit;
                return Ok(());
            }
            Err(Some(error)) => return Err(error),
        };
        report.iterations = outcome.evaluations;
        report.status = match outcome.verdict {
            Verdict::Converged => level_status(inner),
            Verdict::NotContractive => StepStatus::NotContractive,
            _ => StepStatus::IterationLimit,
        };
        let mut outcome = outcome;
        if !inner.converged() && outcome.verdict == Verdict::Converged {
            // the iterates agree, but the last given-friction problem is not solved
            outcome.verdict = Verdict::Unknown;
        }
        report.fixed_point = Some(outcome);
        Ok(())
    }

    /// Slip bounds follow every outer step of one SMALSE run.
    fn inexact_loop(
        &mut self,
        model: &Model,
        level: &StepProblem,
        settings: &Settings,
        iterate: &mut Iterate,
        report: &mut StepReport,
    ) -> Result<(), ContactError> {
        level.slip_bounds(model, &iterate.lambda, &mut self.set);
        let tolerance = settings.tolerance * SAFETY;
        let mut contraction = Contraction::new();
        let mut updates = 1;
        let mut last_change = f64::INFINITY;
        // bounds of normal forces that vanish
        let coefficient = level.coefficients.iter().fold(0.0_f64, |a, b| a.max(*b));
        let least = coefficient * level.least()[1];
        let mut hook = |step: &OuterStep<'_>, set: &mut ProductSet| {
            let old = radii(set);
            level.slip_bounds(model, step.x, set);
            let new = radii(set);
            updates += 1;
            let difference = vector::distance(&old, &new);
            last_change = if difference == 0.0 {
                0.0
            } else {
                difference / vector::norm(&new).max(least)
            };
            contraction.record(difference);
            if last_change < tolerance {
                HookAction::Continue
            } else {
                HookAction::SetChanged
            }
        };
        let qp = self.given_friction(model, level, tolerance, &mut hook, iterate)?;
        add(report, &qp);
        report.counters.slip_bound_updates += updates;
        report.iterations = qp.outer;
        report.status = level_status(qp.status);
        let verdict = if report.status.converged() {
            Verdict::Converged
        } else {
            Verdict::Unknown
        };
        report.fixed_point = Some(FixedPointReport {
            verdict,
            evaluations: updates,
            change: last_change,
            rate: contraction.rate(),
        });
        Ok(())
    }
}

fn radii(set: &ProductSet) -> Vec<f64> {
    let mut out = Vec::new();
    if let Some(Segment::Discs { radii }) = set.segments().get(DISCS) {
        out.extend_from_slice(radii);
    }
    if let Some(Segment::Bounds { upper, .. }) = set.segments().get(INTERVALS) {
        out.extend_from_slice(upper);
    }
    out
}

fn add(report: &mut StepReport, qp: &SmalseReport) {
    report.counters.products += qp.products.total();
    report.counters.projections += qp.projections;
    report.counters.quadratic_programs += 1;
    report.steps += qp.steps;
}
