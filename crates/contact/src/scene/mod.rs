//! The scene: plain data on what is to be simulated, not how.
//!
//! Mesh, materials, supports, loads, contact surfaces with their gaps and friction, how the mesh is partitioned, and
//! the times with their difference formula (`time`), and what acts in which steps (`stage`). Everything here is what a
//! user writes; nodes, rows and numbers of the mesh come in `discrete`.
//!
//! Uses: errors only (and `fem-mesh` for meshes and histories).
//! In: calls of builders. Out: a [`Scene`] whose data can be asked one by one.
//! `validate` makes the checks that need no computation, `discrete` the others.

mod contact;
mod coupling;
mod equation;
mod facets;
mod friction;
mod gap;
mod groups;
mod load;
mod motions;
mod obstacle;
mod pairs;
mod partition;
mod pose;
mod scene;
mod seen;
mod span;
mod spring;
mod stage;
mod support;
mod time;
mod validate;

pub use contact::Contact;
pub(crate) use contact::{Closing, ContactNormal};
pub(crate) use coupling::Coupled;
pub use coupling::Coupling;
pub use equation::Equation;
pub(crate) use friction::check_laws;
pub use friction::{Coefficient, Friction, SlipBound};
pub(crate) use gap::Gap;
pub use load::Load;
pub(crate) use load::{CouplingLoad, Kind as LoadKind};
pub use obstacle::Obstacle;
pub use pairs::ContactPair;
pub use partition::Partition;
pub(crate) use pose::Pose;
pub use scene::Scene;
pub(crate) use seen::Seen;
pub(crate) use span::{Span, is_past};
pub use spring::Spring;
pub(crate) use stage::Stage;
pub use support::{Place, Support};
pub(crate) use time::Increment;
pub use time::{Analysis, DifferenceFormula};
