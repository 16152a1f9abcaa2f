//! The simulation: steps one after another, each prepared, solved, recovered, judged and remembered.
//!
//! `step` is one step, `accuracy` solves it until certificate or estimates are satisfied, `run` takes all steps,
//! `halving` the way through a step that fails as a whole, `resume` goes on from a stored state, `checkpoints` (feature
//! `checkpoint`) keeps states in a folder, `result` is what the user is shown, `step_doubling` estimates errors in
//! time.
//!
//! Uses: everything below.
//! In: a scene and settings. Out: a [`StepResult`] a step.

mod accuracy;
#[cfg(feature = "checkpoint")]
mod checkpoints;
mod halving;
mod observer;
mod progress;
mod result;
mod resume;
mod run;
mod simulation;
mod step;
mod step_doubling;

#[cfg(feature = "checkpoint")]
pub use checkpoints::Every;
pub use observer::{Flow, Observer, Silent};
pub use progress::Progress;
pub use result::StepResult;
pub use simulation::Simulation;
pub use step_doubling::{StepDoubling, TimeError};
