//! Preconditioners for `F`: `operator` applies them, `scaling` weighs rows where copies of a node differ in stiffness
//! or contact points share nodes, `joined` does so for groups of many rows. `split` tells what is eliminated,
//! `released` what of it depends on the active set. `evened` brings lumped blocks of stiff bodies to the spectrum of
//! soft ones. `explicit` forms `F` and inverts it.
//!
//! Uses `system` and what it uses. In goes a system, out comes an operator that the active set method takes.

pub(crate) mod evened;
pub(crate) mod explicit;
mod joined;
pub(crate) mod operator;
mod released;
pub(crate) mod scaling;
mod split;
mod springs;
