//! Weights of a face for the coarse space, and what happens where they do not hold every rigid mode.

use crate::coarse_space::CoarseSpace;
use crate::error::QpError;
use crate::face::FaceProblem;
use crate::face_settings::{FaceReport, FaceWorkspace};
use crate::operator::SymmetricOperator;
use crate::product::ProductSet;

/// Hands the weights of the current face to the coarse space; whether it factored anew.
pub(crate) fn set_face<A: SymmetricOperator, C: CoarseSpace, M: SymmetricOperator>(
    coarse: &mut C,
    set: &ProductSet,
    work: &mut FaceWorkspace<A, M>,
    report: &mut FaceReport,
) -> Result<bool, QpError> {
    work.face.weights(set, &mut work.w);
    let factored = coarse.set_weights(&work.w)?;
    report.factorisations += usize::from(factored);
    Ok(factored)
}

/// As [`set_face`]; where the free components of the predicted face do not hold every rigid mode, points that slide help
/// along their circles. Where that does not suffice, those that slide least are taken for sticking, as many as it needs,
/// and in the end every component for free.
pub(crate) fn hold<A: SymmetricOperator, C: CoarseSpace, M: SymmetricOperator>(
    problem: &FaceProblem<'_, A, M>,
    coarse: &mut C,
    set: &ProductSet,
    x: &[f64],
    work: &mut FaceWorkspace<A, M>,
    report: &mut FaceReport,
) -> Result<bool, QpError> {
    let mut count = 2;
    let (mut first, mut factored) = (true, false);
    loop {
        match set_face(coarse, set, work, report) {
            Ok(anew) => {
                factored |= anew;
                if coarse.balances(x, problem.rhs) {
                    return Ok(factored);
                }
            }
            Err(QpError::CoarseDeficient { .. }) => {}
            Err(error) => return Err(error),
        }
        let lines = if first {
            work.face.lines(set)
        } else {
            Vec::new()
        };
        first = false;
        if !lines.is_empty() {
            match coarse.set_weights_and_lines(&work.w, &lines) {
                Ok(anew) => {
                    factored |= anew;
                    report.factorisations += usize::from(anew);
                    if coarse.balances(x, problem.rhs) {
                        return Ok(factored);
                    }
                }
                Err(QpError::CoarseDeficient { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        if !work.face.release(count) {
            break;
        }
        count *= 2;
    }
    work.face.free_all();
    Ok(set_face(coarse, set, work, report)? || factored)
}
