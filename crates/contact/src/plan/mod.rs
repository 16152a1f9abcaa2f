//! The plan: which effects a scene has, how large each is, and what a run is likely to cost. Made before any work.
//!
//! Uses: `discrete`, `report`, `scene`, `settings` (and the forecast of `tfeti`).
//! In: a scene and settings. Out: a [`Plan`], which prints as a table; the effects decide what a model sets up.

mod cost;
mod effects;
mod mesh_error;
mod never;
mod plan;
mod print;
mod sanity;
mod unmerged;

pub use cost::{Estimate, Times};
pub use effects::{Effects, FrictionKind};
pub use plan::Plan;
