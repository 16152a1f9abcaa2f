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

/// All are called, in their order. If any fails, the run fails; otherwise, if any stops, it stops. With `&mut dyn` an
/// observer can be asked after the run what it has seen:
///
/// ```
/// use signorini_contact::{Flow, Observer, Silent, StepResult};
///
/// let mut steps = Vec::new();
/// let mut count = |result: &StepResult| {
///     steps.push(result.step());
///     Flow::Continue
/// };
/// let mut silent = Silent;
/// let mut all: Vec<&mut dyn Observer> = vec![&mut count, &mut silent];
/// // simulation.run(&mut all)?
/// # all.finished(0);
/// ```
impl<O: Observer> Observer for [O] {
    fn started(&mut self, plan: &Plan, steps: usize) {
        self.iter_mut().for_each(|observer| observer.started(plan, steps));
    }

    fn warning(&mut self, warning: &Warning) {
        self.iter_mut().for_each(|observer| observer.warning(warning));
    }

    fn step(&mut self, result: &StepResult) -> Flow {
        let flows = self.iter_mut().map(|observer| observer.step(result));
        flows.fold(Flow::Continue, |before, flow| match (before, flow) {
            (Flow::Fail(error), _) | (_, Flow::Fail(error)) => Flow::Fail(error),
            (Flow::Stop, _) | (_, Flow::Stop) => Flow::Stop,
            _ => Flow::Continue,
        })
    }

    fn finished(&mut self, steps: usize) {
        self.iter_mut().for_each(|observer| observer.finished(steps));
    }
}

/// An observer that hands all on to others.
macro_rules! hands_on {
    ($(#[$about:meta])* [$($bounded:tt)*] $observer:ty, $own:ident => $others:expr) => {
        $(#[$about])*
        impl $($bounded)* Observer for $observer {
            fn started(&mut $own, plan: &Plan, steps: usize) {
                $others.started(plan, steps);
            }

            fn warning(&mut $own, warning: &Warning) {
                $others.warning(warning);
            }

            fn step(&mut $own, result: &StepResult) -> Flow {
                $others.step(result)
            }

            fn finished(&mut $own, steps: usize) {
                $others.finished(steps);
            }
        }
    };
}

hands_on!([<O: Observer>] Vec<O>, self => self[..]);
hands_on!([] &mut (dyn Observer + '_), self => (**self));
hands_on!([] Box<dyn Observer + '_>, self => (**self));
hands_on!(
    /// As a list of both.
    [<A: Observer, B: Observer>] (A, B), self => [&mut self.0 as &mut dyn Observer, &mut self.1][..]
);

/// Observes nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Silent;

impl Observer for Silent {}
