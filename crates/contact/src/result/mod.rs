//! What a step ended with: states of contact points, sums over them, reactions, and the certificate of all conditions.
//!
//! All of it follows from the recovered displacement and the multipliers; nothing is taken from a solver's word.
//!
//! Uses: `step`, `model`, `discrete`, `state`.
//! In: multipliers, displacement, residual. Out: plain data for the user.

mod certificate;
mod points;
mod reactions;
mod summary;

pub use certificate::{Certificate, Violation};
pub(crate) use certificate::{Measured, Sizes, certify, contact_violation, sizes};
pub(crate) use points::point_states;
pub use points::{ContactState, PointState};
pub use reactions::{NodalForce, Reactions, Resultant, SupportReaction};
pub(crate) use reactions::{nodal_reactions, reactions_about};
pub use summary::ContactSummary;
pub(crate) use summary::summarise;
