//! Weights of an active set for the projector, and what happens where they do not hold every mode of the equality.

use crate::error::QpError;
use crate::problem::{EqualityProjector, SymmetricOperator};

use super::iterate::Iterate;
use super::view::ActiveSetPreconditioner;

impl<A: SymmetricOperator, C: EqualityProjector, M: ActiveSetPreconditioner> Iterate<'_, A, C, M> {
    /// Hands the weights of the active set to the projector; whether it factored anew, `None` if they do not hold
    /// every mode.
    ///
    /// The directions of points that slide belong to them, too.
    pub(crate) fn set_weights(&mut self) -> Result<Option<bool>, QpError> {
        match self.weigh() {
            Ok(factored) => Ok(Some(factored)),
            Err(QpError::CoarseDeficient { .. }) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// All components free, whatever their bounds; whether the projector factored anew.
    ///
    /// # Errors
    /// [`QpError::CoarseDeficient`] if not even they hold every mode.
    pub(crate) fn set_all_free(&mut self) -> Result<bool, QpError> {
        self.work.active.free_all();
        self.weigh()
    }

    fn weigh(&mut self) -> Result<bool, QpError> {
        let work = &mut *self.work;
        work.active.weights(self.set, &mut work.w);
        self.compliance.damp(&mut work.w);
        work.active.lines(self.set, &mut work.lines);
        let factored = self.projector.set_weights_and_lines(&work.w, &work.lines)?;
        self.report.factorisations += usize::from(factored);
        Ok(factored)
    }

    /// As [`set_weights`](Iterate::set_weights); where the free components, and the points that slide along their
    /// circles, do not hold every mode, those that slide least are taken for sticking, as many as it needs, and in
    /// the end every component for free.
    pub(crate) fn hold_modes(&mut self) -> Result<bool, QpError> {
        let mut factored = false;
        let mut count = 2;
        loop {
            if let Some(anew) = self.set_weights()? {
                factored |= anew;
                // where constraints hold a mode, a set in which its springs would is a body that is thrown off
                let held = self.on_springs || self.projector.holds_without_springs();
                if held && self.projector.balances(self.x, self.problem.rhs) {
                    return Ok(factored);
                }
            }
            if !self.work.active.release(count) {
                break;
            }
            count *= 2;
        }
        Ok(self.set_all_free()? || factored)
    }
}
