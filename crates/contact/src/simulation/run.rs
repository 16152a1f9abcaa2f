//! Solving all steps that are left.

use super::observer::{Flow, Observer};
use super::simulation::Simulation;
use crate::error::ContactError;
use crate::report::RunReport;

impl Simulation {
    /// Solves all steps that are left, telling the observer; ends early if it says so. Not converging is no error: see
    /// the report, or ask it to [require](RunReport::require_converged) that all converged.
    ///
    /// # Errors
    /// As [`step`](Self::step), and [`ContactError::Observer`] if the observer fails; the run can be continued after
    /// it.
    pub fn run(&mut self, observer: &mut (impl Observer + ?Sized)) -> Result<RunReport, ContactError> {
        observer.started(self.plan(), self.plan().steps - self.state.step());
        let mut report = RunReport {
            unconverged_history: self.state.unconverged_history(),
            ..RunReport::default()
        };
        let mut failed = None;
        while !self.is_finished() {
            let result = self.step()?;
            report.enter(result.report(), result.failure(), result.certificate().largest());
            match observer.step(&result) {
                Flow::Continue => {}
                Flow::Stop => break,
                Flow::Fail(source) => {
                    let step = result.step();
                    failed = Some(ContactError::Observer { step, source });
                    break;
                }
            }
        }
        observer.finished(report.steps);
        failed.map_or(Ok(report), Err)
    }
}
