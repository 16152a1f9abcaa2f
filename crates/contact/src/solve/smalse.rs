//! The paper's methods: successive approximations (3.17) with Tresca problems by SMALSE and KPRGP
//! (Algorithm 4.1), and the one inexact loop in which the slip bounds follow the outer steps of SMALSE.

use super::iterate::{Iterate, Task, is_coulomb, step_status};
use super::not_determined::not_determined;
use crate::error::ContactError;
use crate::model::{DISCS, INTERVALS, Model, friction_could_hold};
use crate::report::StepReport;
use crate::scene::Friction;
use crate::settings::{InnerAccuracy, Method, Settings, paper_smalse};
use crate::status::StepStatus;
use crate::tolerances::{
    BALANCING, IMBALANCE_FALLS, INNER_FACTOR, INNER_LOOSEST, INNER_STALL, NEAR_BALANCE, SMALSE_SAFETY,
};
use signorini_qp::KprgpSettings;
use signorini_qp::internal::Contraction;
use signorini_qp::smalse::{SmalseReport, SmalseWorkspace};
use signorini_qp::{
    Equality, MovingSet, ProductSet, Projected, QuadraticCost, Segment, SmalseSettings, Status, norm_estimate, smalse,
    vector,
};
use signorini_qp::{FixedPointReport, Verdict, successive_approximations};
use signorini_tfeti::internal::CoarseScratch;
use signorini_tfeti::{DualOperator, OrthonormalCoarse};

/// How often a step may tighten the inner tolerance tenfold.
const MAX_TIGHTENINGS: usize = 3;

/// Most evaluations of the Coulomb map in a step.
const MAX_EVALUATIONS: usize = 200;

/// Looks at which forces were no nearer to balance, while friction could hold the bodies, in all, before a step is
/// given up.
const MAX_STALLS: usize = 3;

pub(crate) struct SmalseSolver {
    /// Orthonormal coarse rows, which these methods need.
    coarse: OrthonormalCoarse,
    scratch: CoarseScratch,
    /// Right side of the step in these rows.
    rhs: Vec<f64>,
    norm: f64,
    norm_products: usize,
    set: ProductSet,
    work: SmalseWorkspace<DualOperator, OrthonormalCoarse>,
    settings: SmalseSettings,
    accuracy: InnerAccuracy,
    one_loop: bool,
    /// Products left.
    left: usize,
}

impl SmalseSolver {
    /// # Errors
    /// [`ContactError::NotDetermined`] if no row stops some rigid motion. The check of equilibrium has found before
    /// that the loads do not push along it.
    pub(crate) fn new(model: &Model, settings: &Settings) -> Result<Self, ContactError> {
        let (smalse, accuracy, one_loop) = match &settings.method {
            Method::OneLoop { smalse } => (*smalse, InnerAccuracy::Fixed, true),
            Method::SuccessiveApproximations { smalse, accuracy } => (*smalse, *accuracy, false),
            // the limit of the fall-back is that of its only problem
            Method::ActiveSet(_) if !is_coulomb(model) => {
                let inner = KprgpSettings::default().with_max_products(usize::MAX);
                (paper_smalse().with_inner(inner), InnerAccuracy::default(), false)
            }
            Method::ActiveSet(_) => (paper_smalse(), InnerAccuracy::default(), false),
        };
        let factor = model.tfeti.coarse_factor()?;
        let coarse = factor
            .orthonormal()
            .ok_or_else(|| not_determined(model, factor.free_motions()))?;
        let operator = model.tfeti.dual();
        let projected = Projected::new(operator, &coarse)?;
        // where balance alone determines all forces nothing but rounding is left of P F P
        let estimate = if coarse.rows() < model.tfeti.dual_dim() {
            norm_estimate(&projected)?
        } else {
            norm_estimate(operator)?
        };
        Ok(Self {
            work: SmalseWorkspace::new(operator, &coarse),
            set: model.set.clone(),
            scratch: factor.scratch(),
            rhs: vec![0.0; model.tfeti.coarse().rows()],
            coarse,
            norm: estimate.upper,
            norm_products: estimate.products,
            settings: smalse,
            accuracy,
            one_loop,
            left: 0,
        })
    }

    /// As [`solve`](Self::solve), for bodies that friction does not seem to hold: when products no longer bring the
    /// forces nearer to balance, it ends as [`StepStatus::NotHeld`] where friction within the slip bounds of the normal
    /// forces could not either, and where it could, after some such looks, as [`StepStatus::Stagnated`]. Slip bounds
    /// follow normal forces the sooner the fewer products there are between two looks.
    pub(crate) fn solve_while_balancing(
        &mut self,
        limit: usize,
        task: Task<'_>,
        iterate: &mut Iterate,
    ) -> Result<StepReport, ContactError> {
        let (mut all, mut left, mut share) = (StepReport::default(), limit, BALANCING);
        let (mut before, mut stalls) = ([f64::INFINITY; 2], 0);
        loop {
            let part = self.solve(left.min(share), task, iterate)?;
            left = left.saturating_sub(part.counters.products);
            all = all.resumed(part);
            if all.status != StepStatus::IterationLimit {
                return Ok(all);
            }
            let mut forces = vec![0.0; self.rhs.len()];
            self.coarse.apply(&iterate.lambda, &mut forces, &mut self.scratch);
            let now = vector::distance(&forces, &self.rhs);
            // where there are no loads, a part of what contact does tells what is small
            let contact = &iterate.lambda[task.model.contact_rows()];
            let size = vector::norm(&self.rhs).max(NEAR_BALANCE * vector::norm(contact));
            if now <= NEAR_BALANCE * size {
                // held: what is left needs longer solves
                share *= 2;
            } else if now > IMBALANCE_FALLS * before[0] {
                let (problem, lambda) = (task.problem, &iterate.lambda);
                let bound = |k, point: &_| problem.slip_bound(k, point, lambda);
                (share, stalls) = (2 * share, stalls + 1);
                if !friction_could_hold(task.model, &problem.rhs, lambda, bound)? {
                    all.status = StepStatus::NotHeld;
                } else if stalls == MAX_STALLS {
                    all.status = StepStatus::Stagnated;
                }
            }
            if left == 0 || all.status.is_lost() {
                return Ok(all);
            }
            before = [before[1], now];
        }
    }

    /// With at most `limit` products.
    pub(crate) fn solve(
        &mut self,
        limit: usize,
        task: Task<'_>,
        iterate: &mut Iterate,
    ) -> Result<StepReport, ContactError> {
        self.left = limit;
        self.coarse.rhs(&task.problem.rhs, &mut self.rhs, &mut self.scratch);
        iterate.multiplier.resize(self.rhs.len(), 0.0);
        let mut report = StepReport::default();
        report.counters.setup_products = std::mem::take(&mut self.norm_products);
        report.counters.inequality_solves = 1;
        if !is_coulomb(task.model) {
            self.tresca(task, iterate, &mut report)?;
        } else if self.one_loop {
            self.inexact_loop(task, iterate, &mut report)?;
        } else {
            self.fixed_point(task, iterate, &mut report)?;
        }
        iterate.known = false;
        iterate.alpha.resize(self.rhs.len(), 0.0);
        let multiplier = self.work.equality_multiplier();
        self.coarse
            .amplitudes(multiplier, &mut iterate.alpha, &mut self.scratch);
        Ok(report)
    }

    /// One problem whose slip bounds are known.
    fn tresca(&mut self, task: Task<'_>, iterate: &mut Iterate, report: &mut StepReport) -> Result<(), ContactError> {
        task.problem
            .write_slip_bounds(task.model, &iterate.lambda, &mut self.set)?;
        report.counters.slip_bound_updates = usize::from(task.model.any_law(Friction::is_some));
        let tolerance = task.settings.tolerance * SMALSE_SAFETY;
        let qp = self.tresca_problem(task, tolerance, &mut |_, _| false, iterate)?;
        add(report, &qp);
        report.iterations = 1;
        report.status = step_status(qp.status);
        Ok(())
    }

    /// Problem (D(g)) with the slip bounds that are in the set.
    fn tresca_problem(
        &mut self,
        task: Task<'_>,
        tolerance: f64,
        hook: &mut dyn FnMut(&[f64], &mut ProductSet) -> bool,
        iterate: &mut Iterate,
    ) -> Result<SmalseReport, ContactError> {
        let settings = self
            .settings
            .with_tolerance(tolerance)
            .with_equality(tolerance)
            .with_least(task.problem.least(task.settings.tolerance)[0])
            .limited_to(self.left);
        let cost = QuadraticCost::new(task.model.tfeti.dual(), &task.problem.linear, self.norm);
        let report = smalse(
            &cost.with_equality(&self.coarse, &self.rhs),
            MovingSet::new(&mut self.set, hook),
            &mut iterate.lambda,
            &mut iterate.multiplier,
            &settings,
            &mut self.work,
        )?;
        self.left = self.left.saturating_sub(report.products.total());
        Ok(report)
    }

    /// (3.17): the map takes normal multipliers to normal multipliers.
    fn fixed_point(
        &mut self,
        task: Task<'_>,
        iterate: &mut Iterate,
        report: &mut StepReport,
    ) -> Result<(), ContactError> {
        let Task {
            model,
            problem,
            settings,
        } = task;
        let normal = model.tfeti.gluing().ranges().normal.clone();
        let mut x: Vec<f64> = iterate.lambda[normal.clone()].iter().map(|v| v.min(0.0)).collect();
        let mut inner = Status::Converged;
        let mut tolerances = InnerTolerance::new(self.accuracy, settings.tolerance * SMALSE_SAFETY);
        let map = |x: &mut [f64], change: f64| {
            let tolerance = tolerances.next(change);
            if self.left == 0 {
                return Err(None);
            }
            iterate.lambda[normal.clone()].copy_from_slice(x);
            problem
                .write_slip_bounds(model, &iterate.lambda, &mut self.set)
                .map_err(Some)?;
            report.counters.slip_bound_updates += 1;
            let qp = self
                .tresca_problem(task, tolerance, &mut |_, _| false, iterate)
                .map_err(Some)?;
            inner = qp.status;
            add(report, &qp);
            x.copy_from_slice(&iterate.lambda[normal.clone()]);
            Ok(tolerances.is_full(tolerance))
        };
        let least = problem.least(settings.tolerance)[1];
        let outcome = successive_approximations(&mut x, settings.tolerance, least, MAX_EVALUATIONS, map);
        let mut outcome = match outcome {
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
            Verdict::Converged => step_status(inner),
            Verdict::NotContractive => StepStatus::NotContractive,
            _ => StepStatus::IterationLimit,
        };
        if !inner.converged() && outcome.verdict == Verdict::Converged {
            // the iterates agree, but the last Tresca problem is not solved
            outcome.verdict = Verdict::Unknown;
        }
        report.fixed_point = Some(outcome);
        Ok(())
    }

    /// Slip bounds follow every outer step of one SMALSE run.
    fn inexact_loop(
        &mut self,
        task: Task<'_>,
        iterate: &mut Iterate,
        report: &mut StepReport,
    ) -> Result<(), ContactError> {
        let Task { model, problem, .. } = task;
        problem.write_slip_bounds(model, &iterate.lambda, &mut self.set)?;
        let tolerance = task.settings.tolerance * SMALSE_SAFETY;
        let mut contraction = Contraction::default();
        let mut updates = 1;
        let mut last_change = f64::INFINITY;
        // bounds of normal forces that vanish
        let coefficient = problem.coefficients.iter().fold(0.0_f64, |a, b| a.max(*b));
        let least = coefficient * problem.least(task.settings.tolerance)[1];
        let mut written = Ok(());
        let mut hook = |x: &[f64], set: &mut ProductSet| {
            let old = radii(set);
            if written.is_ok() {
                written = problem.write_slip_bounds(model, x, set);
            }
            let new = radii(set);
            updates += 1;
            let difference = vector::distance(&old, &new);
            last_change = if difference == 0.0 { 0.0 } else { difference / vector::norm(&new).max(least) };
            contraction.record(difference);
            let settled = last_change < tolerance;
            !settled
        };
        let qp = self.tresca_problem(task, tolerance, &mut hook, iterate)?;
        written?;
        add(report, &qp);
        report.counters.slip_bound_updates += updates;
        report.iterations = qp.outer;
        report.status = step_status(qp.status);
        let verdict = if report.status.converged() { Verdict::Converged } else { Verdict::Unknown };
        report.fixed_point = Some(FixedPointReport {
            verdict,
            evaluations: updates,
            change: last_change,
            rate: contraction.rate(),
        });
        Ok(())
    }
}

/// Tolerances of the Tresca problems of a step.
struct InnerTolerance {
    accuracy: InnerAccuracy,
    /// That of full accuracy.
    full: f64,
    /// Relative change before the last evaluation.
    last: f64,
    tightenings: usize,
    /// Evaluations with full accuracy since it was last tightened.
    exact: usize,
}

impl InnerTolerance {
    fn new(accuracy: InnerAccuracy, full: f64) -> Self {
        Self {
            accuracy,
            full,
            last: f64::INFINITY,
            tightenings: 0,
            exact: 0,
        }
    }

    /// After a relative change of the normal multipliers.
    fn next(&mut self, change: f64) -> f64 {
        // small contact forces under large loads: changes that stall above the tolerance are errors of the inner solve
        let stalls = self.exact > 2 && change > 0.5 * self.last && change < INNER_STALL;
        if stalls && self.tightenings < MAX_TIGHTENINGS {
            self.full *= 0.1;
            self.tightenings += 1;
            self.exact = 1;
        }
        self.last = change;
        match self.accuracy {
            InnerAccuracy::Adaptive if self.exact == 0 => (INNER_FACTOR * change).min(INNER_LOOSEST).max(self.full),
            // once at full accuracy, always: a looser solve would undo it
            _ => self.full,
        }
    }

    /// Whether an evaluation had full accuracy.
    fn is_full(&mut self, tolerance: f64) -> bool {
        let full = tolerance <= self.full;
        self.exact += usize::from(full);
        full
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
