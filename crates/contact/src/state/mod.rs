//! The state between two steps: what one step hands to the next, and what its numbers refer to.
//!
//! Multipliers, their products, old tangential displacements, the tolerance that estimates have chosen. With feature
//! `checkpoint` also as bytes. `fingerprint` tells whether a stored state belongs to a scene, `carry` takes it to
//! another stage.
//!
//! Uses: `model`, `report`, `scene`, `settings`.
//! In: the result of a step. Out: a [`State`] from which a run goes on bit for bit.

#[cfg(feature = "checkpoint")]
mod bytes;
mod carry;
mod fingerprint;
mod state;
mod tolerance;

#[cfg(feature = "checkpoint")]
pub(crate) use bytes::{explained, failed};
pub(crate) use fingerprint::{Fingerprint, operator_hash};
pub use state::State;
pub(crate) use state::{NOT_FINITE, Peak};
pub(crate) use tolerance::{Controller, Discretisation, certificate_limit};
