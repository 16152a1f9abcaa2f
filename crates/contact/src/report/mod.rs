//! Reports of a step and of a run: how it ended, what it cost, how accurate it is.
//!
//! Plain data, filled by solvers and estimates and read by the user.
//!
//! Uses: errors, and the status of a step.
//! In: counts and figures. Out: [`StepReport`], [`RunReport`], [`Counters`], [`AccuracyReport`], [`Warning`].

mod counters;
mod errors;
mod run;
mod step;
mod warning;

pub use counters::Counters;
pub(crate) use errors::relative;
pub use errors::{AccumulatedError, AccuracyReport, AlgebraicError};
pub use run::RunReport;
pub(crate) use run::require;
pub use step::StepReport;
pub use warning::Warning;
