//! Solving all steps that are left.

use super::observer::{Flow, Observer};
use super::simulation::{Simulation, on_pool};
use crate::error::ContactError;
use crate::report::{RunReport, Warning};

impl Simulation {
    /// Solves all remaining steps and tells the observer of each; ends early if the observer asks for it. A step that
    /// does not converge is not an error; call [`RunReport::require_converged`] to get one.
    ///
    /// Results are checked for anything suspicious (see [`Warning`]), and the error of the mesh is estimated at the
    /// end; neither changes a result.
    ///
    /// # Errors
    /// As [`step`](Self::step), and [`ContactError::Observer`] if the observer fails; the run can be continued after
    /// it.
    pub fn run(&mut self, observer: &mut (impl Observer + ?Sized)) -> Result<RunReport, ContactError> {
        self.run_and_keep(observer, None, |_, _| Ok(()))
    }

    /// The same; `keep` is called after each step that the observer has not failed at, with whether it is the last one.
    /// `warnings` are told first.
    pub(super) fn run_and_keep(
        &mut self,
        observer: &mut (impl Observer + ?Sized),
        warnings: impl IntoIterator<Item = Warning>,
        mut keep: impl FnMut(&Self, bool) -> Result<(), ContactError>,
    ) -> Result<RunReport, ContactError> {
        observer.started(self.plan(), self.plan().steps - self.state.step());
        let mut report = RunReport {
            unconverged_history: self.state.unconverged_history(),
            names: self.model.scene.names.clone(),
            ..RunReport::default()
        };
        warn(&mut report, observer, warnings);
        warn(&mut report, observer, self.plan().warnings().to_vec());
        let mut failed = None;
        while !self.is_finished() {
            let result = self.step()?;
            report.enter(result.report(), result.failure(), result.certificate().largest());
            let new = on_pool(|| result.warnings_but(&report.warnings));
            warn(&mut report, observer, new);
            let flow = self.agreed(observer.step(&result))?;
            if let Flow::Fail(source) = flow {
                let step = result.step();
                failed = Some(ContactError::Observer { step, source });
                break;
            }
            let stop = matches!(flow, Flow::Stop);
            if let Err(error) = keep(self, stop || self.is_finished()) {
                failed = Some(error);
                break;
            }
            if stop {
                report.stopped = !self.is_finished();
                break;
            }
        }
        if let (None, true, Some(result)) = (&failed, report.steps > 0, self.result())
            && let Some((error, warning)) = on_pool(|| result.mesh_error())
        {
            report.mesh_error = Some(error);
            warn(&mut report, observer, warning);
        }
        observer.finished(report.steps);
        failed.map_or(Ok(report), Err)
    }

    /// What the observers of all processes want: to fail if one fails, else to stop if one stops.
    fn agreed(&self, flow: Flow) -> Result<Flow, ContactError> {
        if self.plan().ranks == 1 {
            return Ok(flow);
        }
        let wish = match flow {
            Flow::Continue => 0.0,
            Flow::Stop => 1.0,
            Flow::Fail(_) => 2.0,
        };
        let wishes = self.model.tfeti.gather(wish)?;
        let most = wishes.iter().copied().fold(0.0, f64::max);
        let rank = wishes.iter().position(|w| *w == most).unwrap_or(0);
        Ok(match flow {
            Flow::Fail(_) => flow,
            _ if most == 2.0 => Flow::Fail(format!("that of rank {rank} failed, see there").into()),
            _ if most == 1.0 => Flow::Stop,
            _ => flow,
        })
    }
}

/// Tells the observer of warnings, and keeps them.
fn warn(report: &mut RunReport, observer: &mut (impl Observer + ?Sized), warnings: impl IntoIterator<Item = Warning>) {
    for warning in warnings {
        observer.warning(&warning);
        report.warnings.push(warning);
    }
}
