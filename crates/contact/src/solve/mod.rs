//! Solvers of one step: conjugate gradients without contact, active sets, and the paper's methods.
//!
//! `solver` chooses; each solver holds all its work memory. `scaling` gives every body a unit of force of its own,
//! `warm_start` mends start vectors, `release` ends what rows of one node contradict.
//!
//! Uses: `step`, `model`, `settings`, `report` (and `qp`, `tfeti`).
//! In: a [`StepProblem`](crate::step::StepProblem) and an [`Iterate`]. Out: multipliers and a report of the step.

mod active_set;
mod coarse;
mod iterate;
mod linear;
mod preconditioner;
mod release;
mod scaling;
mod smalse;
mod solver;
mod warm_start;

pub(crate) use iterate::Iterate;
pub(crate) use solver::Solver;
pub(crate) use warm_start::restore_sliding;
