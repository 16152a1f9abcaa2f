//! Observers: what a progress bar, a log or a file writer is told.

use super::result::StepResult;
use crate::plan::Plan;
use crate::report::Warning;
use std::error::Error;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether a run continues.
///
/// A `Result` converts into it: an observer that can fail returns `Flow::from(...)`.
#[derive(Debug)]
#[non_exhaustive]
pub enum Flow {
    /// Solve the next step.
    Continue,
    /// Stop the run after this step; it can be continued later.
    Stop,
    /// Stop the run after this step with [`ContactError::Observer`](crate::ContactError::Observer); it can be continued
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

/// Receives the events of a run. All methods have empty defaults. A closure `FnMut(&StepResult) -> Flow` is an
/// observer.
pub trait Observer {
    /// The run begins; `steps` remain to be solved.
    fn started(&mut self, plan: &Plan, steps: usize) {
        let _ = (plan, steps);
    }

    /// Something in the scene or in a result is allowed but suspicious. Called once per run for each kind: of the scene
    /// after [`started`](Self::started), of a step before [`step`](Self::step), of the mesh before
    /// [`finished`](Self::finished).
    fn warning(&mut self, warning: &Warning) {
        let _ = warning;
    }

    /// A step is solved.
    fn step(&mut self, result: &StepResult) -> Flow {
        let _ = result;
        Flow::Continue
    }

    /// The run has ended, also by [`Flow::Fail`]; `steps` were solved in it. Not called when a solve ends in an error.
    fn finished(&mut self, steps: usize) {
        let _ = steps;
    }
}

impl<F: FnMut(&StepResult) -> Flow> Observer for F {
    fn step(&mut self, result: &StepResult) -> Flow {
        self(result)
    }
}

/// A flag that a Ctrl-C handler or another thread may set: the run ends after the step in which it was set.
/// [`RunReport::stopped`](crate::report::RunReport::stopped) says so.
impl Observer for Arc<AtomicBool> {
    fn step(&mut self, _: &StepResult) -> Flow {
        if self.load(Ordering::Relaxed) { Flow::Stop } else { Flow::Continue }
    }
}

/// Both are called, the first one first. If either fails, the run fails; otherwise, if either stops, it stops.
impl<A: Observer, B: Observer> Observer for (A, B) {
    fn started(&mut self, plan: &Plan, steps: usize) {
        self.0.started(plan, steps);
        self.1.started(plan, steps);
    }

    fn warning(&mut self, warning: &Warning) {
        self.0.warning(warning);
        self.1.warning(warning);
    }

    fn step(&mut self, result: &StepResult) -> Flow {
        match (self.0.step(result), self.1.step(result)) {
            (Flow::Fail(error), _) | (_, Flow::Fail(error)) => Flow::Fail(error),
            (Flow::Stop, _) | (_, Flow::Stop) => Flow::Stop,
            _ => Flow::Continue,
        }
    }

    fn finished(&mut self, steps: usize) {
        self.0.finished(steps);
        self.1.finished(steps);
    }
}

/// Observes nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Silent;

impl Observer for Silent {}
