//! Solving all levels that are left.

use super::observer::{Flow, Observer};
use super::simulation::Simulation;
use crate::error::ContactError;
use crate::report::RunReport;

impl Simulation {
    /// Solves all levels that are left, telling the observer; ends early if it says so. Not converging is no error: see the
    /// report, or ask it to [require](RunReport::require_converged) that all converged.
    ///
    /// # Errors
    /// As [`step`](Self::step), and [`ContactError::Observer`] if the observer fails; the run can be continued after it.
    pub fn run(
        &mut self,
        observer: &mut (impl Observer + ?Sized),
    ) -> Result<RunReport, ContactError> {
        let levels = self.model.scene.analysis.steps() - self.state.step();
        observer.started(&self.model.plan, levels);
        let mut report = RunReport {
            unconverged_history: self.state.unconverged_history(),
            ..RunReport::default()
        };
        let mut failed = None;
        while !self.is_finished() {
            let frame = self.step()?;
            let (level, certificate) = (frame.step(), frame.certificate().largest());
            report.enter(frame.report(), level, frame.time(), certificate);
            match observer.step(&frame) {
                Flow::Continue => {}
                Flow::Stop => break,
                Flow::Fail(source) => {
                    failed = Some(ContactError::Observer { level, source });
                    break;
                }
            }
        }
        observer.finished(report.levels);
        failed.map_or(Ok(report), Err)
    }
}
