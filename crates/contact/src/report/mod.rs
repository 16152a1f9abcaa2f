//! What is said of a step and of a run: how it ended, what it cost, how accurate it is.
//!
//! Plain data, filled by solvers and estimates and read by the user.
//!
//! Uses: errors, and the status of a step.
//! In: counts and figures. Out: [`StepReport`], [`RunReport`], [`Counters`], [`AccuracyReport`].

mod counters;
mod errors;
pub mod fixed_point;
mod run;
mod step;

pub use counters::Counters;
pub(crate) use errors::relative;
pub use errors::{AccumulatedError, AccuracyReport, AlgebraicError};
pub(crate) use fixed_point::{Contraction, FixedPointReport, Verdict, successive_approximations};
pub use run::{RunReport, StepFailure};
pub use step::StepReport;
