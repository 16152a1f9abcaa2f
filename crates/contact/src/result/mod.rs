//! What a step ended with: states of contact points (`points`), sums over them (`summary`), contact stresses
//! (`surface_stress`), `reactions` with motions of couplings, and the `certificate` of all conditions, measured by
//! `certify`.
//!
//! All of it follows from the recovered displacement and the multipliers; nothing relies on a solver's own report.
//!
//! Uses: `step`, `model`, `discrete`, `state`, `scene`, `report`.
//! In: multipliers, displacement, residual. Out: plain data for the user.

mod certificate;
mod certify;
mod narrow;
mod neutral;
mod points;
mod reactions;
mod recovered;
mod sanity;
mod sizes;
mod summary;
mod surface_stress;
mod tilt;

pub(crate) use certificate::contact_violation;
pub use certificate::{Certificate, Violation};
pub use points::{ContactState, PointState};
pub use reactions::{CouplingMotion, EquationForce, NodalForce, Reactions, Resultant, SupportReaction};
pub(crate) use reactions::{nodal_reactions, reactions_about, tied_forces};
pub(crate) use recovered::Recovered;
pub(crate) use sanity::{Lengths, coarse_mesh, is_strained, warnings};
pub(crate) use sizes::Sizes;
pub use summary::ContactSummary;
pub(crate) use summary::summarise;
pub(crate) use surface_stress::{SurfaceStress, points_at_nodes};
