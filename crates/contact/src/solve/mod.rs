//! Solvers of one step: active sets, which are conjugate gradients where there is no contact, and the paper's methods.
//!
//! `solver` chooses; each solver holds all its work memory. `scaling` gives every body its own unit of force,
//! `release` resolves contradictory rows of one node, `row_scale` tells active sets how stiff rows are.
//!
//! Uses: `step`, `model`, `scene`, `settings`, `report` (and `qp`, `tfeti`).
//! In: a [`StepProblem`](crate::step::StepProblem) and an [`Iterate`]. Out: multipliers and a report of the step.

mod active_set;
mod iterate;
mod not_determined;
mod preconditioner;
mod release;
mod row_scale;
mod scaling;
mod smalse;
mod solver;

pub(crate) use iterate::{Attempt, Iterate, Task};
pub(crate) use solver::Solver;
