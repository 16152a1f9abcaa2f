//! The simulation: set-up, and what is asked of it between steps.

use super::result::StepResult;
use crate::error::ContactError;
use crate::estimate::Caches;
use crate::model::{ConstrainedPoint, Model, check_equilibrium};
use crate::plan::Plan;
use crate::report::Counters;
use crate::scene::Scene;
use crate::settings::Settings;
use crate::solve::{Iterate, Solver};
use crate::state::{Controller, Fingerprint, State, operator_hash};
use crate::step::StepProblem;
use signorini_fem_mesh::Decomposition;
use signorini_tfeti::Tfeti;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A scene being simulated, step by step.
///
/// ```
/// use signorini_contact::{Analysis, Contact, Friction, Load, Scene, Settings, Simulation, Support};
/// use signorini_fem_mesh::{brick, Brick, History, Hooke, Materials};
///
/// let mesh = Brick::new([3.0, 1.0, 1.0], [6, 2, 2]).build()?;
/// let scene = Scene::new(mesh, Materials::uniform(Hooke::isotropic(211.9e9, 0.277)?))
///     .with_support(Support::fixed(brick::X_MIN))
///     .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -3e9]).with_history(History::ramp(1.0, 1.0)?))
///     .with_contact(Contact::rigid(brick::Z_MIN).with_gap(0.1).with_friction(Friction::coulomb(0.3)))
///     .with_boxes([3, 1, 1])
///     .with_analysis(Analysis::quasistatic(1.0, 4));
/// let mut simulation = Simulation::new(scene, Settings::default())?;
/// while !simulation.is_finished() {
///     let result = simulation.step()?;
///     assert!(result.report().status.converged());
///     assert!(result.certificate().largest() < 1e-6);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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

impl Simulation {
    /// Sets up: decomposition, stiffness, inverses, coarse problem, unit loads.
    ///
    /// # Errors
    /// [`ContactError`] naming what is wrong with the scene or the settings.
    pub fn new(scene: Scene, settings: Settings) -> Result<Self, ContactError> {
        on_pool(|| Self::set_up(scene, settings))
    }

    fn set_up(scene: Scene, settings: Settings) -> Result<Self, ContactError> {
        let start = Instant::now();
        let mut model = Model::new(scene, &settings)?;
        check_equilibrium(&model)?;
        let origin = || {
            let origin = Fingerprint::new(&model);
            (origin, operator_hash(&origin, &model, &settings))
        };
        let (solver, (origin, operator)) = rayon::join(|| Solver::new(&model, &settings), origin);
        let mut solver = solver?;
        solver.hand_on(&mut model);
        model.tfeti.check_processes()?;
        let state = State {
            origin: Some(origin),
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
            total: Counters::default(),
            setup: start.elapsed(),
        })
    }

    /// The plan.
    #[must_use]
    pub fn plan(&self) -> &Plan {
        &self.model.plan
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.model.scene
    }

    /// The decomposition.
    #[must_use]
    pub fn decomposition(&self) -> &Decomposition {
        &self.model.discrete.decomposition
    }

    /// The T-FETI system, with its set-up report: for those who measure the solver.
    #[doc(hidden)]
    #[must_use]
    pub fn tfeti(&self) -> &Tfeti {
        &self.model.tfeti
    }

    /// The contact points with their rows.
    #[must_use]
    pub fn constrained_points(&self) -> &[ConstrainedPoint] {
        &self.model.points
    }

    /// The settings.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Wall-clock time of the set-up.
    #[must_use]
    pub fn setup_time(&self) -> Duration {
        self.setup
    }

    /// Wall-clock time, within the set-up, of the search for what the sides of the contacts face.
    #[must_use]
    pub fn search_time(&self) -> Duration {
        self.model.discrete.search
    }

    /// Counters of all steps so far.
    #[must_use]
    pub fn counters(&self) -> &Counters {
        &self.total
    }

    /// The state between steps; store it to continue later.
    #[must_use]
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Whether all steps are solved.
    #[must_use]
    pub fn is_finished(&self) -> bool {
        self.state.step() >= self.model.scene.analysis.steps()
    }

    /// The result of the last step; `None` before the first one, after [`resume`](Self::resume) and after a step that
    /// failed.
    #[must_use]
    pub fn result(&self) -> Option<&Arc<StepResult>> {
        self.result.as_ref()
    }
}

/// Runs `work` on a thread of the pool of rayon. Parts of it that run in parallel then begin where it runs; from
/// another thread each of them would cost a change of threads, about as long as a product of a small scene.
pub(super) fn on_pool<R: Send>(work: impl FnOnce() -> R + Send) -> R {
    rayon::scope(|_| work())
}
