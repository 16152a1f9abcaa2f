//! Bodies that nothing presses any more: where all forces on a loose body vanish, none determines its rigid motions, and
//! it stays where it stood.

use super::simulation::Simulation;
use crate::error::ContactError;
use crate::model::{ConstrainedPoint, Model};
use crate::result::{ContactState, Recovered};
use crate::state::State;
use crate::tolerances::NULL_RANK;
use nalgebra::{DMatrix, DVector};
use signorini_qp::vector;
use std::collections::HashSet;

impl Simulation {
    /// Moves bodies without contact forces to where, in the mean, points touch and stick that were pressed in the last
    /// state; if none of them was, to where they stick. They stay as they are if that violates conditions.
    pub(super) fn stand(&mut self, state: &State, recovered: Recovered) -> Result<Recovered, ContactError> {
        let (model, problem) = (&self.model, &self.problem);
        if state.step() == 0 || !model.plan.effects.history || model.loose_motions()?.is_empty() {
            return Ok(recovered);
        }
        let points = || model.points.iter().zip(&recovered.points);
        let touching = points().filter(|(_, state)| state.state != ContactState::Open);
        let held_rows: HashSet<usize> = touching.flat_map(|(point, _)| rows(point)).collect();
        let held: HashSet<u32> = held_rows.iter().flat_map(|row| bodies(model, *row)).collect();
        let mut loose = model.loose_motions()?.iter().flat_map(|motion| &motion.bodies);
        if loose.all(|body| held.contains(&(body.body as u32))) {
            return Ok(recovered);
        }
        let motions = model.motions_left_by(|row| held_rows.contains(&row))?;
        let moved: HashSet<u32> = motions.iter().flat_map(|m| &m.bodies).map(|b| b.body as u32).collect();
        let own = |point: &&ConstrainedPoint| bodies(model, point.row).any(|body| moved.contains(&body));
        let own: Vec<&ConstrainedPoint> = model.points.iter().filter(own).collect();
        let last = &state.lambda[0];
        let pressed = |point: &&&ConstrainedPoint| last.get(point.row).is_some_and(|force| *force < 0.0);
        let mut targets: Vec<usize> = own.iter().filter(pressed).flat_map(|point| rows(point)).collect();
        if targets.is_empty() {
            targets = own.iter().flat_map(|p| p.along().map(|along| along.1)).collect();
        }
        if motions.is_empty() || targets.is_empty() {
            return Ok(recovered);
        }
        let missing = targets.iter().map(|&row| problem.offset[row] - recovered.rows[row]);
        let missing = DVector::from_iterator(targets.len(), missing);
        let coarse = model.tfeti.coarse();
        let mut moves = vec![0.0; coarse.dim()];
        let mut columns = DMatrix::zeros(targets.len(), motions.len());
        for (mut column, motion) in columns.column_iter_mut().zip(&motions) {
            coarse.transpose_times(&motion.amplitudes, &mut moves);
            column.iter_mut().zip(&targets).for_each(|(c, row)| *c = moves[*row]);
        }
        let svd = columns.svd(true, true);
        let cut = NULL_RANK * svd.singular_values.max();
        let Ok(ways) = svd.solve(&missing, cut) else {
            return Ok(recovered);
        };
        let mut alpha = self.iterate.alpha.clone();
        for (motion, way) in motions.iter().zip(ways.iter()) {
            vector::axpy(*way, &motion.amplitudes, &mut alpha);
        }
        let lambda = problem.multipliers(&self.iterate.lambda);
        let stands = Recovered::new(model, problem, &lambda, &alpha, Recovered::default())?;
        // where obstacles or partners have moved it may be inside them
        let largest = recovered.certificate.largest().max(self.settings.tolerance);
        if stands.certificate.largest() > largest {
            return Ok(recovered);
        }
        self.iterate.alpha = alpha;
        Ok(stands)
    }
}

/// The rows of a point.
fn rows(point: &ConstrainedPoint) -> impl Iterator<Item = usize> {
    point.directions().map(|direction| direction.1)
}

/// The bodies that a row acts on.
fn bodies(model: &Model, row: usize) -> impl Iterator<Item = u32> {
    let body_of = model.tfeti.coarse().body_of();
    model.tfeti.gluing().row(row).into_iter().map(|entry| body_of[entry.0])
}
