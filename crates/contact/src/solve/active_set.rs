//! The default method: the face method of `signorini-qp` on the dual problem, slip bounds following the normal forces.
//!
//! Where the face method makes no progress, the paper's method solves the level: from the last iterate where a limit was
//! reached, from the start of the level where the face method stagnated. It is proved to solve every given-friction problem.

use super::iterate::{Iterate, is_coulomb, level_status};
use super::preconditioner::SelectedPreconditioner;
use super::release::Exchanges;
use super::smalse::SmalseSolver;
use crate::error::ContactError;
use crate::model::Model;
use crate::report::StepReport;
use crate::scene::Friction;
use crate::settings::Settings;
use crate::status::StepStatus;
use crate::step::StepProblem;
use signorini_qp::{
    ActiveSetProblem, ActiveSetSettings, ActiveSetWorkspace, ProductSet, Status, active_set, vector,
};
use signorini_tfeti::{ActiveSetProjector, DualOperator};

/// Safety factor between the tolerance of a level and the estimated error at which the face method stops.
const SAFETY: f64 = 1.0;

/// Stiffness of a row with all other unknowns held over that with its subdomain free, above which the natural map takes
/// this multiple of the latter. In well shaped, compressible bodies it is 1 to 4; a natural map that is much too stiff
/// predicts faces from gradients alone.
const LOOSE: f64 = 5.0;

/// Part of the stiffness that the natural map takes at rows that may depend on others of their node: two rows along one
/// direction move it twice.
const SHARED: f64 = 0.5;

/// What a release would change, over the error of a solved face, from which on it is worth it.
const CONTRADICTION: f64 = 10.0;

/// Solves of a level with contradicting points released.
const TURNS: usize = 8;

#[derive(Debug)]
pub(crate) struct ActiveSetSolver {
    space: ActiveSetProjector,
    preconditioner: SelectedPreconditioner,
    scale: Vec<f64>,
    set: ProductSet,
    work: ActiveSetWorkspace<DualOperator, SelectedPreconditioner>,
    settings: ActiveSetSettings,
    exchanges: Exchanges,
    /// Made when it is first needed.
    paper: Option<Box<SmalseSolver>>,
}

impl ActiveSetSolver {
    pub(crate) fn new(
        model: &Model,
        settings: &Settings,
        face: &ActiveSetSettings,
    ) -> Result<Self, ContactError> {
        let contact = model.tfeti.gluing().ranges().contact().end;
        let preconditioner = SelectedPreconditioner::new(model, settings.preconditioner)?;
        let mut scale = vec![0.0; model.tfeti.dual_dim()];
        model.tfeti.row_stiffness(0..contact, &mut scale[..contact]);
        let mut compliance = vec![0.0; contact];
        model.tfeti.row_compliance(0..contact, &mut compliance);
        for (scale, compliance) in scale.iter_mut().zip(compliance) {
            *scale = scale.min(LOOSE / compliance);
        }
        let gluing = model.tfeti.gluing();
        let shared = |row: usize| gluing.node(row).is_some_and(|n| gluing.is_dependent(n));
        for (_, scale) in scale
            .iter_mut()
            .enumerate()
            .take(contact)
            .filter(|s| shared(s.0))
        {
            *scale *= SHARED;
        }
        Ok(Self {
            space: ActiveSetProjector::new(
                model.tfeti.coarse(),
                contact,
                model.tfeti.row_weights(),
            )?,
            work: ActiveSetWorkspace::new(model.tfeti.dual(), &preconditioner),
            preconditioner,
            scale,
            set: model.set.clone(),
            exchanges: Exchanges::new(model),
            settings: face.clone(),
            paper: None,
        })
    }

    pub(crate) fn solve(
        &mut self,
        model: &Model,
        level: &StepProblem,
        settings: &Settings,
        iterate: &mut Iterate,
    ) -> Result<StepReport, ContactError> {
        let mut report = StepReport::new();
        report.counters.inequality_solves = 1;
        level.slip_bounds(model, &iterate.lambda, &mut self.set);
        report.counters.slip_bound_updates = usize::from(model.any_law(Friction::is_some));
        let start = iterate.lambda.clone();
        self.space.set_rhs(&level.rhs);
        let problem = ActiveSetProblem {
            operator: model.tfeti.dual(),
            preconditioner: &self.preconditioner,
            scale: &self.scale,
            linear: &level.linear,
            rhs: &level.rhs,
        };
        let [least, least_contact] = level.least();
        let face_settings = self
            .settings
            .clone()
            .with_tolerance(settings.tolerance * SAFETY)
            .with_error_floor(least)
            .with_contact_error_floor(least_contact);
        let coulomb = is_coulomb(model);
        if coulomb {
            let slopes = model.slip_slopes(|k| level.coefficients[k]);
            self.work.set_slopes(&slopes);
        }
        let mut updates = 0;
        let mut hook = |x: &[f64], set: &mut ProductSet| {
            if coulomb {
                level.slip_bounds(model, x, set);
                updates += 1;
            }
        };
        let mut turns = 0;
        let status = loop {
            let outcome = active_set(
                &problem,
                &mut self.space,
                &mut self.set,
                &mut iterate.lambda,
                &mut iterate.f_lambda,
                iterate.known,
                &face_settings,
                &mut self.work,
                &mut hook,
            );
            let status = match outcome {
                Ok(outcome) => {
                    report.iterations += outcome.faces;
                    report.counters.products += outcome.products();
                    report.counters.preconditionings += outcome.preconditionings;
                    report.counters.coarse_factorisations += outcome.factorisations;
                    report.counters.faces += outcome.faces;
                    report.estimated_error = Some(outcome.error.max(outcome.constrained_error));
                    outcome.status
                }
                // the prediction ran away, or the free rows do not hold the body: the paper's method needs neither
                Err(
                    signorini_qp::QpError::CoarseDeficient { .. }
                    | signorini_qp::QpError::NotFinite { .. },
                ) => Status::Stagnated,
                Err(error) => return Err(error.into()),
            };
            let limit = CONTRADICTION
                * face_settings.tolerance
                * vector::norm(&iterate.lambda).max(face_settings.error_floor);
            if status != Status::Converged
                || turns == TURNS
                || !self.exchanges.settle(
                    model,
                    level,
                    self.work.residual(),
                    (&self.scale, limit),
                    &mut iterate.lambda,
                )
            {
                break status;
            }
            iterate.known = false;
            turns += 1;
        };
        report.counters.slip_bound_updates += updates;
        report.status = level_status(status);
        if report.status.converged() {
            iterate.known = true;
            iterate.alpha.resize(level.rhs.len(), 0.0);
            let mut residual = iterate.f_lambda.clone();
            vector::axpy(-1.0, &level.linear, &mut residual);
            self.space.amplitudes(&residual, &mut iterate.alpha);
            return Ok(report);
        }
        self.fall_back(model, level, settings, iterate, start, report)
    }

    fn fall_back(
        &mut self,
        model: &Model,
        level: &StepProblem,
        settings: &Settings,
        iterate: &mut Iterate,
        start: Vec<f64>,
        mut report: StepReport,
    ) -> Result<StepReport, ContactError> {
        if !iterate.lambda.iter().all(|v| v.is_finite())
            || matches!(report.status, StepStatus::Stagnated | StepStatus::NotHeld)
        {
            iterate.lambda = start;
        }
        let mut paper = match self.paper.take() {
            Some(paper) => paper,
            None => Box::new(SmalseSolver::new(model, settings)?),
        };
        iterate.multiplier.clear();
        // other normal forces may hold the body yet
        let not_held = report.status == StepStatus::NotHeld;
        let limit = settings.max_fallback_products;
        let outcome = paper.solve_within(limit, model, level, settings, iterate);
        self.paper = Some(paper);
        let second = outcome?;
        report.fallback = true;
        report.fallback_products = second.counters.products;
        // SMALSE has no such estimate
        report.estimated_error = None;
        report.status = match second.status {
            StepStatus::IterationLimit if not_held => StepStatus::NotHeld,
            status => status,
        };
        report.iterations += second.iterations;
        report.counters += second.counters;
        report.steps += second.steps;
        report.fixed_point = second.fixed_point;
        iterate.multiplier.clear();
        Ok(report)
    }
}
