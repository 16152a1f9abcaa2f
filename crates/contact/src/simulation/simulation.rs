//! The simulation: set-up, and what is asked of it between steps.

use super::result::StepResult;
use crate::error::ContactError;
use crate::estimate::Caches;
use crate::model::{ConstrainedPoint, Model, check_equilibrium};
use crate::plan::Plan;
use crate::report::Counters;
use crate::result::Recovered;
use crate::scene::{Load, Scene, Stage};
use crate::settings::Settings;
use crate::solve::{Iterate, Solver};
use crate::state::{Controller, Fingerprint, State, operator_hash};
use crate::step::StepProblem;
use signorini_fem_mesh::Decomposition;
use signorini_tfeti::Tfeti;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A scene being simulated, step by step.
pub struct Simulation {
    pub(crate) model: Arc<Model>,
    pub(crate) caches: Arc<Caches>,
    pub(super) settings: Settings,
    pub(super) solver: Solver,
    pub(super) state: Arc<State>,
    /// What numbers of states refer to.
    pub(super) origin: Fingerprint,
    /// What products with F depend on.
    pub(super) operator: u64,
    pub(crate) problem: Arc<StepProblem>,
    pub(super) iterate: Iterate,
    pub(super) controller: Controller,
    /// Of the last step, if it was solved.
    pub(super) result: Option<Arc<StepResult>>,
    /// Memory for what the next step recovers.
    pub(super) spare: Recovered,
    pub(super) total: Counters,
    pub(super) setup: Duration,
}

/// The plan and how far it is; not the megabytes of tables and vectors.
impl std::fmt::Debug for Simulation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Simulation")
            .field("plan", &self.model.plan)
            .field("steps_solved", &self.state.step())
            .field("total", &self.total)
            .finish_non_exhaustive()
    }
}

/// The model of a scene that contact and supports can hold, from a `first` step on.
fn balanced(scene: Scene, settings: &Settings, first: usize) -> Result<Model, ContactError> {
    let model = Model::new(scene, settings)?;
    check_equilibrium(&model, first)?;
    Ok(model)
}

/// Refuses what would be refused in a later stage, and makes the plans of these.
fn plan_later_stages(scene: &Scene, settings: &Settings) -> Result<Vec<Plan>, ContactError> {
    let plan = |stage: Stage| {
        let mut scene = scene.clone();
        scene.enter(&stage);
        let model = balanced(scene, settings, 0)?;
        // what neither supports nor contact hold a solver finds
        if model.points.is_empty() {
            Solver::new(&model, settings)?;
        }
        Ok(model.plan)
    };
    scene.later_stages().map(plan).collect()
}

impl Simulation {
    /// Sets up: decomposition, stiffness, inverses, coarse problem, unit loads.
    ///
    /// # Errors
    /// [`ContactError`] naming what is wrong with the scene or the settings.
    pub fn new(mut scene: Scene, settings: Settings) -> Result<Self, ContactError> {
        // a scene of a simulation may be that of a later stage
        scene.enter(&Stage::default());
        let names = scene.names.clone();
        let set_up = || {
            let start = Instant::now();
            // before the first one, so that two are not held; what is wrong with that is told first
            let later = plan_later_stages(&scene, &settings);
            let mut first = Self::set_up(scene, settings, 0)?;
            let later = later?;
            if let Some(model) = Arc::get_mut(&mut first.model) {
                model.plan.warn(&later);
            }
            if !later.is_empty() {
                first.setup = start.elapsed();
            }
            Ok(first)
        };
        on_pool(set_up).map_err(|error| names.tell(error))
    }

    /// The same before the steps from a `first` one on.
    pub(super) fn set_up(scene: Scene, settings: Settings, first: usize) -> Result<Self, ContactError> {
        let start = Instant::now();
        let mut model = balanced(scene, &settings, first)?;
        let origin = || {
            let origin = Fingerprint::new(&model);
            (origin, operator_hash(&origin, &model, &settings))
        };
        let (solver, (origin, operator)) = rayon::join(|| Solver::new(&model, &settings), origin);
        let mut solver = solver?;
        solver.balance_loads(&mut model);
        model.tfeti.check_processes()?;
        let state = State {
            origin: Some(origin),
            stage: model.scene.stage(),
            ..State::default()
        };
        Ok(Self {
            model: Arc::new(model),
            caches: Arc::default(),
            settings,
            solver,
            state: Arc::new(state),
            origin,
            operator,
            problem: Arc::default(),
            iterate: Iterate::default(),
            controller: Controller::default(),
            result: None,
            spare: Recovered::default(),
            total: Counters::default(),
            setup: start.elapsed(),
        })
    }

    /// Takes other loads from the next step on, such as pressures or temperatures that another program computes step by
    /// step. All else stays, eigenstrains of the materials and all matrices too: it takes a fraction of a new set-up,
    /// and gives the same bits as a simulation of the scene with these loads that [resumes](Self::resume) here. Steps
    /// solved before keep theirs; warnings of the plan are those of the first loads.
    ///
    /// # Errors
    /// What [`new`](Self::new) would refuse of them until supports or contacts start or end; the simulation is then as
    /// it was.
    pub fn set_loads(&mut self, loads: Vec<Load>) -> Result<(), ContactError> {
        let mut names = self.model.scene.names.clone();
        names.forget_loads();
        let set = || {
            let mut model = self.model.with_loads(loads)?;
            check_equilibrium(&model, self.state.step())?;
            self.solver.balance_loads(&mut model);
            model.tfeti.check_processes()?;
            self.model = Arc::new(model);
            Ok(())
        };
        on_pool(set).map_err(|error| names.tell(error))
    }

    /// The plan; where supports or contacts start or end that of the stage at hand.
    pub fn plan(&self) -> &Plan {
        &self.model.plan
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.model.scene
    }

    /// The decomposition.
    pub fn decomposition(&self) -> &Decomposition {
        &self.model.discrete.decomposition
    }

    /// The T-FETI system with its set-up report, for measurements of the solver.
    #[doc(hidden)]
    pub fn tfeti(&self) -> &Tfeti {
        &self.model.tfeti
    }

    /// The contact points with their rows.
    pub fn constrained_points(&self) -> &[ConstrainedPoint] {
        &self.model.points
    }

    /// The settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Wall-clock time of the set-up, with those of the stages entered so far.
    pub fn setup_time(&self) -> Duration {
        self.setup
    }

    /// Wall-clock time, within the set-up, of the contact search.
    pub fn search_time(&self) -> Duration {
        self.model.discrete.search
    }

    /// Counters of all steps so far.
    pub fn counters(&self) -> &Counters {
        &self.total
    }

    /// The state between steps; store it to continue later.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Whether all steps are solved.
    pub fn is_finished(&self) -> bool {
        self.state.step() >= self.model.scene.analysis.steps()
    }

    /// The result of the last step; `None` before the first one, after [`resume`](Self::resume) and after a step that
    /// failed.
    pub fn result(&self) -> Option<&Arc<StepResult>> {
        self.result.as_ref()
    }
}

/// Runs `work` on a thread of the pool of rayon. Parts of it that run in parallel then begin where it runs; from
/// another thread each of them would cost a change of threads, about as long as a product of a small scene.
pub(super) fn on_pool<R: Send>(work: impl FnOnce() -> R + Send) -> R {
    rayon::scope(|_| work())
}
