//! The simulation: one step after another, each prepared, solved, recovered, certified and stored.
//!
//! `step` is one step, `attempts` those at it, `accuracy` solves it until certificate or estimates are satisfied, `run`
//! takes all steps, `halving` repeats a failed step in halves, `stages` sets up anew where supports and contacts start
//! or end, `resume` continues from a stored state, `checkpoints` (feature `checkpoint`) keeps states in a folder,
//! `result` is what the user sees, `step_doubling` estimates errors in time, `unloaded` leaves bodies where loads that
//! vanish leave them.
//!
//! Uses: everything below.
//! In: a scene and settings. Out: a [`StepResult`] per step.

mod accuracy;
mod attempts;
#[cfg(feature = "checkpoint")]
mod checkpoints;
mod halving;
mod observer;
mod progress;
mod result;
mod resume;
mod run;
mod simulation;
mod stages;
mod step;
mod step_doubling;
mod unloaded;

#[cfg(feature = "checkpoint")]
pub use checkpoints::Every;
pub use observer::{Flow, Observer, Silent};
pub use progress::Progress;
pub use result::StepResult;
pub use simulation::Simulation;
pub use step_doubling::{StepDoubling, TimeError};
