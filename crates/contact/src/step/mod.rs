//! The data of one step: the dual problem at a time, with offsets and coefficients (`problem`), and how slip bounds
//! follow the normal forces (`slip_bounds`).
//!
//! Uses: `state`, `model`, `scene`.
//! In: a model, the state before the step and its number. Out: a [`StepProblem`], which solvers and results read.

#[cfg(test)]
pub(crate) mod example;
mod problem;
mod slip_bounds;

pub(crate) use problem::{StepProblem, entry_or_zero, force_rounding};
