//! Observers: what a progress bar, a log or a file writer is told.

use super::frame::StepResult;
use crate::plan::Plan;
use std::error::Error;

/// Whether a run goes on.
///
/// A `Result` converts into it, so that an observer that can fail ends with `Flow::from(...)`:
///
/// ```
/// use signorini_contact::{Flow, StepResult};
///
/// let mut log = Vec::new();
/// let mut write = |frame: &StepResult<'_>| {
///     use std::io::Write;
///     Flow::from(writeln!(log, "{} {}", frame.time(), frame.summary().active))
/// };
/// # fn check(_: &mut impl signorini_contact::Observer) {}
/// # check(&mut write);
/// ```
#[derive(Debug)]
#[non_exhaustive]
pub enum Flow {
    /// Solve the next level.
    Continue,
    /// End the run after this level; it can be continued later.
    Stop,
    /// End the run after this level with [`ContactError::Observer`](crate::ContactError::Observer); it can be continued
    /// later.
    Fail(Box<dyn Error + Send + Sync>),
}

impl<E: Into<Box<dyn Error + Send + Sync>>> From<Result<(), E>> for Flow {
    fn from(result: Result<(), E>) -> Self {
        Self::from(result.map(|()| Self::Continue))
    }
}

impl<E: Into<Box<dyn Error + Send + Sync>>> From<Result<Self, E>> for Flow {
    fn from(result: Result<Self, E>) -> Self {
        result.unwrap_or_else(|error| Self::Fail(error.into()))
    }
}

/// Is told what a simulation does. All methods have empty defaults. A closure `FnMut(&StepResult) -> Flow` is an observer.
pub trait Observer {
    /// The run begins; `levels` are left to solve.
    fn started(&mut self, plan: &Plan, levels: usize) {
        let _ = (plan, levels);
    }

    /// A level is solved.
    fn step(&mut self, frame: &StepResult<'_>) -> Flow {
        let _ = frame;
        Flow::Continue
    }

    /// The run has ended, also by [`Flow::Fail`]; `levels` were solved in it. Not called when a solve ends in an error.
    fn finished(&mut self, levels: usize) {
        let _ = levels;
    }
}

impl<F: FnMut(&StepResult<'_>) -> Flow> Observer for F {
    fn step(&mut self, frame: &StepResult<'_>) -> Flow {
        self(frame)
    }
}

/// Observes nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Silent;

impl Observer for Silent {}
