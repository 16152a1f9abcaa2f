//! Preconditioners for `F`: `operator` applies them, `scaling` weighs rows where copies of a node differ in stiffness
//! or contact points share nodes, `joined` does so for groups of many rows.
//!
//! Uses `system` and what it uses. In goes a system, out comes an operator that the active set method takes.

pub(crate) mod joined;
pub(crate) mod operator;
pub(crate) mod scaling;
mod springs;
