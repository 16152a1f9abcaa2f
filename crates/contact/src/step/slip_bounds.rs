//! Slip bounds: what friction may take at each point, given or following the normal forces.

use super::problem::StepProblem;
use crate::error::ContactError;
use crate::model::{ConstrainedPoint, DISCS, INTERVALS, Model};
use crate::scene::Friction;
use crate::state::State;
use signorini_qp::active_set::RadiusSlope;
use signorini_qp::{ProductSet, QpError};
use signorini_tfeti::TangentialRows;

impl StepProblem {
    /// Coefficients and Tresca bounds of all points; anew only where the coefficient follows the slip rate.
    pub(super) fn find_friction(&mut self, model: &Model, state: &State) -> Result<(), ContactError> {
        let known = !self.coefficients.is_empty() && !model.any_law(Friction::depends_on_rate);
        if known || !model.any_law(Friction::is_some) {
            return Ok(());
        }
        // none where the law fails at a point: a later step must not take a part for all
        self.coefficients.clear();
        let value = |(k, point): (usize, &ConstrainedPoint)| -> Result<_, ContactError> {
            let at = point.contact.at();
            let rate = state.rate.get(k).copied().unwrap_or(0.0);
            Ok(match model.law(point) {
                Friction::None => (0.0, 0.0),
                Friction::Tresca(bound) => (0.0, bound.stress(at)? * point.area()),
                Friction::Coulomb(law) => (law.value(at, rate)?, 0.0),
            })
        };
        let values: Result<Vec<_>, _> = model.points.iter().enumerate().map(value).collect();
        (self.coefficients, self.tresca) = values?.into_iter().unzip();
        Ok(())
    }

    /// Slip bound of a point in units of force of its body (newtons): `-F_i lambda_nu,i`, or that of Tresca friction; 0
    /// where it has no tangential rows.
    pub(crate) fn slip_bound(&self, k: usize, point: &ConstrainedPoint, lambda: &[f64]) -> f64 {
        let (Some(tresca), Some(coefficient)) = (self.tresca.get(k), self.coefficients.get(k)) else {
            return 0.0;
        };
        if point.tangential == TangentialRows::None {
            return 0.0;
        }
        let unit = self.units.get(k).copied().unwrap_or(1.0);
        // pressing force, not negative
        let pressure = (-point.scale * lambda[point.row]).max(0.0);
        tresca / unit + coefficient * pressure
    }

    /// Writes the slip bounds that go with `lambda` into the feasible set, in units of the rows; an error for a set
    /// that has no discs or intervals in their places.
    pub(crate) fn write_slip_bounds(
        &self,
        model: &Model,
        lambda: &[f64],
        set: &mut ProductSet,
    ) -> Result<(), ContactError> {
        let ranges = model.tfeti.gluing().ranges();
        for (k, point) in model.points.iter().enumerate() {
            let bound = self.slip_bound(k, point, lambda);
            match point.tangential {
                TangentialRows::Disc { row, scale } => {
                    let radii = set.radii_mut(DISCS).map_err(QpError::from)?;
                    radii[(row - ranges.discs.start) / 2] = bound / scale;
                }
                TangentialRows::Interval { row, scale, .. } => {
                    let interval = row - ranges.intervals.start;
                    let (lower, upper) = set.bounds_mut(INTERVALS).map_err(QpError::from)?;
                    (lower[interval], upper[interval]) = (-bound / scale, bound / scale);
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// How the radii of discs follow the normal rows, then how half the lengths of intervals do.
    pub(crate) fn slip_slopes(&self, model: &Model) -> Vec<RadiusSlope> {
        let slope = |disc, scale, k: usize, point: &ConstrainedPoint| RadiusSlope {
            disc,
            component: point.row,
            // normal multipliers are negative where pressed
            slope: -self.coefficients[k] * point.scale / scale,
        };
        let with_rows = |rows: usize| {
            let points = model.points.iter().enumerate();
            points.filter_map(move |(k, point)| {
                let (row, _, scale) = point.tangential_rows().filter(|(_, count, _)| *count == rows)?;
                Some(slope(row, scale, k, point))
            })
        };
        with_rows(2).chain(with_rows(1)).collect()
    }

    /// Puts the friction forces of points that slide back on their circles: extrapolation leaves them a little inside,
    /// where they would be taken for sticking.
    pub(crate) fn restore_sliding(&self, model: &Model, sliding: &[bool], lambda: &mut [f64]) {
        for (k, point) in model.points.iter().enumerate() {
            let TangentialRows::Disc { row, scale } = point.tangential else {
                continue;
            };
            let length = lambda[row].hypot(lambda[row + 1]);
            if sliding.get(k) == Some(&true) && length > 0.0 {
                let radius = self.slip_bound(k, point, lambda) / scale;
                lambda[row] *= radius / length;
                lambda[row + 1] *= radius / length;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::step::example::{block, first_step};
    use signorini_qp::Segment;

    /// A set of another model is no place for slip bounds.
    #[test]
    fn a_set_without_discs_is_refused() {
        let (model, problem) = first_step(block(0.0, Friction::coulomb(0.5)));
        let lambda = vec![0.0; model.tfeti.dual_dim()];
        let mut own = model.set.clone();
        assert!(problem.write_slip_bounds(&model, &lambda, &mut own).is_ok());
        let mut other = ProductSet::new(vec![Segment::Free(lambda.len())]).expect("a set");
        let error = problem
            .write_slip_bounds(&model, &lambda, &mut other)
            .expect_err("no discs");
        assert!(error.to_string().contains("disc"), "{error}");
    }
}
