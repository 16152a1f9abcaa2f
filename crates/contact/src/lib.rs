//! Quasistatic contact with Coulomb friction: scenes, plans, time levels, fixed-point loops and certificates.

mod certificate;
mod clock;
mod error;
mod face_solver;
pub mod fixed_point;
mod frame;
mod held;
mod law;
mod level;
mod linear_solver;
mod model;
mod observer;
mod paper_solver;
mod plan;
mod preconditioner;
mod report;
mod scene;
mod settings;
mod simulation;
mod solver;
mod state;

pub use certificate::{Certificate, Violation};
pub use clock::{Analysis, DifferenceFormula};
pub use error::ContactError;
pub use frame::{ContactState, ContactSummary, Frame, PointState};
pub use law::{Coefficient, Friction, PlaceField, RateField, SlipBound};
pub use model::TouchPoint;
pub use observer::{Flow, Observer, Silent};
pub use plan::{Effects, FrictionKind, Plan};
pub use report::{Counters, LevelReport, LevelStatus};
pub use scene::{Contact, ContactNormal, Cut, Gap, Load, Place, Scene, Support};
pub use settings::{InnerAccuracy, Method, Preconditioner, Settings};
pub use signorini_tfeti::Directions;
pub use simulation::Simulation;
pub use state::State;
