//! Observers: what a progress bar, a log or a file writer is told.

use crate::frame::Frame;
use crate::plan::Plan;

/// Whether a run goes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flow {
    /// Solve the next level.
    Continue,
    /// End the run after this level; it can be continued later.
    Stop,
}

/// Is told what a simulation does. All methods have empty defaults. A closure `FnMut(&Frame) -> Flow` is an observer.
pub trait Observer {
    /// The run begins; `levels` are left to solve.
    fn started(&mut self, plan: &Plan, levels: usize) {
        let _ = (plan, levels);
    }

    /// A level is solved.
    fn level(&mut self, frame: &Frame<'_>) -> Flow {
        let _ = frame;
        Flow::Continue
    }

    /// The run has ended; `levels` were solved in it.
    fn finished(&mut self, levels: usize) {
        let _ = levels;
    }
}

impl<F: FnMut(&Frame<'_>) -> Flow> Observer for F {
    fn level(&mut self, frame: &Frame<'_>) -> Flow {
        self(frame)
    }
}

/// Observes nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Silent;

impl Observer for Silent {}
