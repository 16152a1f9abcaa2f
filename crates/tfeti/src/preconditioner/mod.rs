//! Preconditioners for `F`: `operator` applies them, `scaling` weighs rows where copies of a node differ in stiffness.
//!
//! Uses `system` and what it uses. In goes a system, out comes an operator that the active set method takes.

pub(crate) mod operator;
pub(crate) mod scaling;
