//! The simulation: set-up, levels, recovery, certificate.

use super::frame::StepResult;
use super::threads::on_pool;
use crate::error::ContactError;
use crate::estimate::Caches;
use crate::model::{ConstrainedPoint, Model, check_equilibrium};
use crate::plan::Plan;
use crate::report::{Counters, StepReport};
use crate::result::{Certificate, ContactSummary, PointState, Sizes};
use crate::scene::{Scene, check_laws};
use crate::settings::Settings;
use crate::solve::{Iterate, Solver};
use crate::state::{Controller, Fingerprint, State, operator_hash};
use crate::step::StepProblem;
use signorini_fem_mesh::Decomposition;
use signorini_tfeti::Tfeti;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A scene being simulated, level by level.
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
///     let frame = simulation.step()?;
///     assert!(frame.report().status.converged());
///     assert!(frame.certificate().largest() < 1e-6);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Simulation {
    pub(super) model: Model,
    pub(super) caches: Caches,
    pub(super) settings: Settings,
    pub(super) solver: Solver,
    pub(super) state: Arc<State>,
    /// What numbers of states refer to.
    pub(super) origin: Fingerprint,
    /// What products with F depend on.
    pub(super) operator: u64,
    /// Whether the fields below belong to a level that was solved.
    pub(super) solved: bool,
    pub(super) level: StepProblem,
    pub(super) iterate: Iterate,
    pub(super) report: StepReport,
    pub(super) certificate: Certificate,
    /// Sizes of the bodies at the level.
    pub(super) sizes: Vec<Sizes>,
    pub(super) points: Vec<PointState>,
    pub(super) summary: ContactSummary,
    pub(super) torn: Vec<f64>,
    pub(super) residual: Vec<f64>,
    /// Multipliers of the support rows.
    pub(super) held: Vec<f64>,
    pub(super) total: Counters,
    pub(super) setup: Duration,
    pub(super) controller: Controller,
}

/// The plan and how far it is; not the megabytes of tables and vectors.
impl std::fmt::Debug for Simulation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Simulation")
            .field("plan", &self.model.plan)
            .field("levels_solved", &self.state.step())
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
        on_pool(false, || Self::set_up(scene, settings))
    }

    fn set_up(scene: Scene, settings: Settings) -> Result<Self, ContactError> {
        let start = Instant::now();
        let model = Model::new(scene, &settings)?;
        let places = model
            .points
            .iter()
            .map(|p| (model.law(p), p.node, p.position));
        check_laws(places)?;
        check_equilibrium(&model)?;
        let origin = || {
            let (scene, gluing) = (&model.scene, model.tfeti.gluing());
            let decomposition = &model.decomposition;
            let origin = Fingerprint::new(
                &scene.mesh,
                &scene.analysis,
                decomposition,
                gluing,
                &model.points,
            );
            (origin, operator_hash(&origin, &model, &settings))
        };
        let (solver, (origin, operator)) = rayon::join(|| Solver::new(&model, &settings), origin);
        let solver = solver?;
        let mut state = State::default();
        state.set_origin(origin);
        Ok(Self {
            state: Arc::new(state),
            origin,
            operator,
            solved: false,
            level: StepProblem::default(),
            iterate: Iterate::default(),
            report: StepReport::new(),
            certificate: Certificate::default(),
            sizes: Vec::new(),
            points: Vec::new(),
            summary: ContactSummary::default(),
            torn: Vec::new(),
            residual: Vec::new(),
            held: Vec::new(),
            total: Counters::default(),
            setup: start.elapsed(),
            controller: Controller::default(),
            model,
            caches: Caches::default(),
            settings,
            solver,
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
        &self.model.decomposition
    }

    /// The T-FETI system, with its set-up report.
    #[must_use]
    pub fn tfeti(&self) -> &Tfeti {
        &self.model.tfeti
    }

    /// The touch points.
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

    /// Counters of all levels so far.
    #[must_use]
    pub fn counters(&self) -> &Counters {
        &self.total
    }

    /// The state between levels; store it to continue later.
    #[must_use]
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Whether all levels are solved.
    #[must_use]
    pub fn is_finished(&self) -> bool {
        self.state.step() >= self.model.scene.analysis.steps()
    }

    /// The frame of the last level solved; `None` before the first one, after [`resume`](Self::resume) and after a step that
    /// failed.
    #[must_use]
    pub fn frame(&self) -> Option<StepResult<'_>> {
        self.solved.then(|| self.present())
    }

    /// The frame of what was computed last.
    pub(crate) fn present(&self) -> StepResult<'_> {
        StepResult {
            model: &self.model,
            caches: &self.caches,
            level: &self.level,
            report: &self.report,
            certificate: &self.certificate,
            summary: &self.summary,
            points: &self.points,
            torn: &self.torn,
            residual: &self.residual,
            held: &self.held,
        }
    }
}
