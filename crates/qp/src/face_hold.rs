//! Weights of a face for the coarse space, and what happens where they do not hold every rigid mode.

use crate::coarse_space::CoarseSpace;
use crate::error::QpError;
use crate::face::FaceProblem;
use crate::face_settings::{FaceReport, FaceWorkspace};
use crate::face_state::{Disc, Face, visit};
use crate::operator::SymmetricOperator;
use crate::product::ProductSet;

/// Hands the weights of the current face to the coarse space; whether it factored anew.
///
/// The directions of points that slide belong to the face too. Where predictions run in circles, and for
/// bodies that only contact holds, they are left out as long as the other components suffice (`sparing`): measured, not
/// proved, to need fewer faces there.
pub(crate) fn set_face<A: SymmetricOperator, C: CoarseSpace, M: SymmetricOperator>(
    coarse: &mut C,
    set: &ProductSet,
    work: &mut FaceWorkspace<A, M>,
    report: &mut FaceReport,
    sparing: bool,
) -> Result<bool, QpError> {
    work.face.weights(set, &mut work.w);
    if sparing {
        work.lines.clear();
    } else {
        work.face.lines(set, &mut work.lines);
    }
    let factored = coarse.set_weights_and_lines(&work.w, &work.lines)?;
    report.factorisations += usize::from(factored);
    Ok(factored)
}

/// As [`set_face`]; where the free components of the predicted face, and the points that slide along their circles, do not
/// hold every rigid mode, those that slide least are taken for sticking, as many as it needs, and in the end every
/// component for free.
pub(crate) fn hold<A: SymmetricOperator, C: CoarseSpace, M: SymmetricOperator>(
    problem: &FaceProblem<'_, A, M>,
    coarse: &mut C,
    set: &ProductSet,
    x: &[f64],
    work: &mut FaceWorkspace<A, M>,
    report: &mut FaceReport,
    sparing: bool,
) -> Result<bool, QpError> {
    let mut count = 2;
    let mut factored = false;
    let mut sparing = sparing;
    loop {
        match set_face(coarse, set, work, report, sparing) {
            Ok(anew) => {
                factored |= anew;
                if sparing && !coarse.holds_all() {
                    // steps along circles would unbalance the modes that are left
                    sparing = false;
                    continue;
                }
                if coarse.balances(x, problem.rhs) {
                    return Ok(factored);
                }
            }
            Err(QpError::CoarseDeficient { .. }) => {}
            Err(error) => return Err(error),
        }
        if sparing {
            sparing = false;
            continue;
        }
        if !work.face.release(count) {
            break;
        }
        count *= 2;
    }
    work.face.free_all();
    Ok(set_face(coarse, set, work, report, false)? || factored)
}

impl Face {
    /// Whether the natural map would free a held bound, and move it by more than `limit`.
    pub(crate) fn contradicted(
        &self,
        set: &ProductSet,
        x: &[f64],
        g: &[f64],
        scale: &[f64],
        step: f64,
        limit: f64,
    ) -> bool {
        let mut found = false;
        visit(
            set,
            |i, k, lower, upper| {
                if !self.free[k] && lower < upper {
                    let moved = (x[i] - step * scale[i] * g[i]).clamp(lower, upper);
                    found |= (moved - x[i]).abs() > limit;
                }
            },
            |_, _, _| {},
        );
        found
    }

    /// Notes the radii of all discs in the first entries of `out`.
    pub(crate) fn radii(&self, set: &ProductSet, out: &mut [f64]) {
        visit(set, |_, _, _, _| {}, |_, k, radius| out[k] = radius);
    }

    /// Whether a disc on whose circle a point slides, or which holds it, has grown by more than `limit` since its radius was noted.
    pub(crate) fn grew(&self, set: &ProductSet, radii: &[f64], limit: f64) -> bool {
        let mut found = false;
        visit(
            set,
            |_, _, _, _| {},
            |_, k, radius| {
                let bound = !matches!(self.discs[k], Disc::Free);
                found |= bound && radius - radii[k] > limit;
            },
        );
        found
    }
}
