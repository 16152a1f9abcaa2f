//! Quasistatic contact with Coulomb friction: scenes, plans, time steps and certificates.
//!
//! Elastic bodies are loaded slowly and may touch rigid obstacles or each other. A [`Scene`] describes the problem, a
//! [`Simulation`] solves it step by step, and each step returns a [`StepResult`]. Only the effects that a scene has are
//! set up: without friction, for instance, there are no tangential rows.
//!
//! | you want | you use |
//! |---|---|
//! | a body on a rigid obstacle | [`Scene`], [`Support`], [`Load`], [`Contact`] with a gap and a [`Friction`] law |
//! | bodies that touch each other | [`Contact::between`]; [`ContactPair::find`] finds where |
//! | a part of a body that is rigid; a bolt, a hinge | [`Coupling`], loaded by [`Load::on_coupling`] |
//! | clamps that are released, contacts that come or go | [`Support::with_end`], [`Contact::with_start`] |
//! | displacements that depend on one another; periodic cells | [`Equation`], with points by [`Coupling::point`] |
//! | friction that depends on place or slip rate | [`Coefficient`], [`SlipBound`] |
//! | time steps | [`Analysis`] with a [`DifferenceFormula`]; for one state [`Analysis::Static`] |
//! | to know the cost in advance | [`Plan`], [`plan::Estimate`] |
//! | another solver or tolerance | [`Settings`]; [`Method::ActiveSet`] is the default, [`Method::paper`] the paper's |
//! | forces, states, stress, reactions | [`StepResult`], [`PointState`], [`result`] |
//! | to know whether a result is right | [`Certificate`]; [`StepStatus`] tells why not |
//! | to estimate or prescribe its accuracy | [`Accuracy`], [`report`], [`StepDoubling`] |
//! | files for ParaView and a table | `ResultWriter` (feature `vtu`) |
//! | warnings of suspicious input or results | [`Warning`]: [`Plan::warnings`], [`RunReport::warnings`] |
//! | to follow or stop a run | [`Observer`], [`Flow`], [`Progress`] |
//! | to stop and continue | [`State`]; with feature `checkpoint` bytes, and `Simulation::run_or_resume` |
//!
//! # Example
//!
//! A beam is pressed on a floor and its end is pulled along it; the coefficient of friction falls with the slip rate.
//!
//! ```
//! use signorini_contact::{
//!     Analysis, Coefficient, Contact, ContactState, Friction, Load, Scene, Settings, Simulation, Support,
//! };
//! use signorini_fem_mesh::{Brick, History, Hooke, Materials, brick};
//!
//! let mesh = Brick::new([3.0, 1.0, 1.0], [9, 3, 3]).build()?;
//! let pull = History::table(vec![(0.0, 0.0), (0.5, 0.0), (1.0, 1.0)])?;
//! let law = Coefficient::Exponential { fixed: 0.3, kinetic: 0.1, decay: 0.05 };
//! let scene = Scene::new(mesh, Materials::uniform(Hooke::isotropic(211.9e9, 0.277)?))
//!     .with_support(Support::fixed(brick::X_MIN))
//!     .with_load(Load::pressure(brick::Z_MAX, 1e8).with_history(History::ramp(0.5, 1.0)?))
//!     .with_load(Load::traction(brick::X_MAX, [5e8, 0.0, 0.0]).with_history(pull))
//!     .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::Coulomb(law)))
//!     .with_boxes([3, 1, 1])
//!     .with_analysis(Analysis::quasistatic(1.0, 8));
//!
//! let mut simulation = Simulation::new(scene, Settings::default())?;
//! while !simulation.is_finished() {
//!     let result = simulation.step()?;
//!     assert!(result.report().status.converged());
//!     assert!(result.certificate().largest() < 1e-6);
//! }
//! let last = simulation.result().expect("eight steps");
//! assert!(last.points().iter().any(|point| point.state == ContactState::Slip));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Conventions
//!
//! - This documentation names SI units; any consistent units give the same digits.
//! - Forces act on the body. Normal contact forces are at most zero: obstacles press, they do not pull.
//! - A step leads to a time `t_i`. Steps are counted from 0; before the first one the body is at rest without forces.
//! - Mesh nodes are `u32`; a vector field has one `[f64; 3]` per node.
//!
//! # What can go wrong
//!
//! [`Simulation::new`] refuses scenes that make no sense (regions without material, contradictory supports, loads
//! that nothing can hold) with a [`ContactError`] that names the place and a remedy. A step that does not converge is
//! not an error: its [`StepStatus`] is not `Converged`, its result holds the last iterate, and the certificate tells
//! how far that is off. Later steps whose friction depends on its slip name it
//! ([`unconverged_history`](report::StepReport::unconverged_history)). To get an error instead, call
//! [`RunReport::require_converged`] or [`StepResult::require_converged`].
//!
//! Work runs on the current [`rayon`] pool; results are bit-identical for any number of threads.

// the file that has the name of its folder holds its main type
#![allow(clippy::module_inception)]

mod discrete;
mod error;
mod estimate;
mod hash;
mod model;
mod mortar;
mod names;
#[cfg(feature = "vtu")]
mod output;
mod part;
pub mod plan;
pub mod report;
pub mod result;
pub mod scene;
mod settings;
mod simulation;
mod solve;
mod state;
mod status;
mod step;
mod tolerances;
mod vec3;

pub use error::ContactError;
pub use model::ConstrainedPoint;
#[cfg(feature = "vtu")]
pub use output::{ResultField, ResultWriter};
pub use part::Part;
pub use plan::Plan;
pub use report::{RunReport, Warning};
pub use result::{Certificate, ContactState, PointState};
pub use scene::{
    Analysis, Coefficient, Contact, ContactPair, Coupling, DifferenceFormula, Equation, Friction, Load, Obstacle,
    Partition, Place, Scene, SlipBound, Spring, Support,
};
pub use settings::{Accuracy, InnerAccuracy, Method, MethodKind, Preconditioner, Settings};
pub use signorini_tfeti::internal::Rate;
pub use signorini_tfeti::{Communicator, Directions};
#[cfg(feature = "checkpoint")]
pub use simulation::Every;
pub use simulation::{Flow, Observer, Progress, Silent, Simulation, StepDoubling, StepResult, TimeError};
pub use state::State;
pub use status::{FreeCoupling, Slide, StepFailure, StepStatus};
