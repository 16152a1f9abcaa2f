//! The algebraic error of a step by the duality gap: how far the solver stopped from the discrete solution.
//!
//! `admissible` constructs a continuous displacement that satisfies supports and gaps from the torn one, node by node,
//! or all at once where points share nodes (`shared`), of which there may be too few (`settled`); springs pull at some
//! of them (`sprung`). `duality_gap` is the difference between its energy and the dual one. `agreed` makes what a step
//! hands on agree with ties, and where rows depend on one another (`dependent`).
//!
//! Uses: `result`, `step`, `model`, `report`. In: a solved step. Out: an
//! [`AlgebraicError`](crate::report::AlgebraicError).

mod admissible;
mod agreed;
mod dependent;
mod duality_gap;
mod settled;
mod shared;
mod sprung;

pub(crate) use duality_gap::{Caches, Solved};
