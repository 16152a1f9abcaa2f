//! The model: what is computed once from a scene and read-only afterwards.
//!
//! The T-FETI system, unit loads, contact points with their rows, the feasible set, and which rows belong to which
//! body. `equilibrium` judges before anything is solved whether supports and contact can hold the bodies, by the cone
//! of contact forces in `friction_cone`.
//!
//! Uses: `plan`, `discrete`, `scene`, `settings` (and `tfeti`).
//! In: a scene and settings. Out: a [`Model`], borrowed by everything above.

mod bodies;
mod contact_point;
mod equilibrium;
mod friction_cone;
mod model;
mod nearest;
mod positive_factors;

pub use contact_point::ConstrainedPoint;
pub(crate) use contact_point::PointRow;
pub(crate) use equilibrium::{check_equilibrium, freed, friction_could_hold, loose_motions_of, slide, slides};
pub(crate) use model::{DISCS, INTERVALS, Model};
pub(crate) use nearest::nearest;
