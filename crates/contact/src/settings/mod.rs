//! The settings: how a scene is solved, and nothing about what.
//!
//! The method of a step, its accuracy and when it ends, and what the set-up shares and holds.
//!
//! Uses: errors only (and the settings of `qp` and `tfeti`, which are part of these).
//! In: calls of builders. Out: [`Settings`], checked once by plan and simulation.

mod accuracy;
mod method;
mod settings;

pub use accuracy::Accuracy;
pub use method::{InnerAccuracy, Method};
pub use settings::{Preconditioner, Settings};
