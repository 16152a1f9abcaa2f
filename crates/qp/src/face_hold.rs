//! Weights of a face for the coarse space, and what happens where they do not hold every rigid mode.

use crate::coarse_space::EqualityProjector;
use crate::error::QpError;
use crate::face_iterate::Iterate;
use crate::operator::SymmetricOperator;

impl<A: SymmetricOperator, C: EqualityProjector, M: SymmetricOperator> Iterate<'_, A, C, M> {
    /// Hands the weights of the current face to the coarse space; whether it factored anew, `None` if they do not hold every
    /// rigid mode.
    ///
    /// The directions of points that slide belong to the face too. Where predictions run in
    /// circles, they are left out as long as the other components suffice (`sparing`): measured, not proved, to need fewer
    /// faces there.
    pub(crate) fn set_face(&mut self, sparing: bool) -> Result<Option<bool>, QpError> {
        match self.weigh(sparing) {
            Ok(factored) => Ok(Some(factored)),
            Err(QpError::CoarseDeficient { .. }) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// All components free, whatever their bounds; whether the coarse space factored anew.
    ///
    /// # Errors
    /// [`QpError::CoarseDeficient`] if not even they hold every rigid mode.
    pub(crate) fn set_free(&mut self) -> Result<bool, QpError> {
        self.work.face.free_all();
        self.weigh(false)
    }

    fn weigh(&mut self, sparing: bool) -> Result<bool, QpError> {
        let work = &mut *self.work;
        work.face.weights(self.set, &mut work.w);
        if sparing {
            work.lines.clear();
        } else {
            work.face.lines(self.set, &mut work.lines);
        }
        let factored = self.coarse.set_weights_and_lines(&work.w, &work.lines)?;
        self.report.factorisations += usize::from(factored);
        Ok(factored)
    }

    /// As [`set_face`](Iterate::set_face); where the free components of the predicted face, and the points that slide along
    /// their circles, do not hold every rigid mode, those that slide least are taken for sticking, as many as it needs, and in
    /// the end every component for free.
    pub(crate) fn hold(&mut self, sparing: bool) -> Result<bool, QpError> {
        let mut factored = false;
        let mut sparing = sparing;
        let mut count = 2;
        loop {
            if let Some(anew) = self.set_face(sparing)? {
                factored |= anew;
                if self.coarse.balances(self.x, self.problem.rhs) {
                    return Ok(factored);
                }
            }
            if sparing {
                sparing = false;
                continue;
            }
            if !self.work.face.release(count) {
                break;
            }
            count *= 2;
        }
        Ok(self.set_free()? || factored)
    }
}
