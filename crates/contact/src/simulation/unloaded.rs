//! Bodies that nothing presses any more: where all forces on a loose body vanish, none determines its rigid motions, and
//! it stays where it stood.

use super::halving::Way;
use super::simulation::Simulation;
use crate::error::ContactError;
use crate::model::{ConstrainedPoint, Model, nearest};
use crate::report::StepReport;
use crate::result::{ContactState, Recovered};
use crate::solve::Attempt;
use crate::state::State;
use crate::tolerances::{LOCKED, PARTS_LEFT, VANISHING};
use nalgebra::{DMatrix, DVector};
use signorini_qp::vector;
use signorini_tfeti::FreeMotion;
use std::collections::HashSet;
use std::sync::Arc;

/// What bodies are moved from.
struct Place<'a> {
    lambda: &'a [f64],
    alpha: &'a [f64],
    /// `B u`, in row units.
    rows: &'a [f64],
}

impl Simulation {
    /// The result of an increment at whose end no load acts that acted at its start, if forces vanish with the loads;
    /// and the report of the solves that tell, from whose iterate an ordinary one sets out.
    ///
    /// Without loads nothing gives forces a size, and active sets run in circles. A small part of the last loads does, and
    /// leaves the bodies where they stand without it. If a smaller part leaves more of the forces, friction locks them.
    pub(super) fn unload(
        &mut self,
        state: &State,
        way: &Way,
        (line, attempt): (bool, Attempt),
    ) -> Result<(StepReport, Option<Recovered>), ContactError> {
        let (model, increment, mut report) = (&self.model, way.increment(), StepReport::new());
        if !model.plan.effects.history || model.loose_motions()?.is_empty() {
            return Ok((report, None));
        }
        let unloaded = |start| self.problem.is_unloaded(&model.scene, start);
        if !increment.start.is_some_and(unloaded) {
            return Ok((report, None));
        }
        self.start(state, way, line, attempt);
        let contact = self.model.tfeti.gluing().ranges().contact();
        let mut forces = f64::INFINITY;
        let mut vanish = false;
        let mut last = std::mem::take(&mut self.spare);
        for left in PARTS_LEFT {
            Arc::make_mut(&mut self.problem).prepare(&self.model, state, increment, left)?;
            self.spare = last;
            let (next, recovered) = self.solve()?;
            (report, last) = (report.resumed(next), recovered);
            self.controller = state.controller;
            let before = std::mem::replace(&mut forces, vector::norm(&self.iterate.lambda[contact.clone()]));
            vanish = report.status.converged() && forces <= VANISHING * before && before.is_finite();
            if vanish || !report.status.converged() || forces > LOCKED * before {
                break;
            }
            for of_forces in [&mut self.iterate.lambda, &mut self.iterate.f_lambda] {
                vector::scale(PARTS_LEFT[1] / PARTS_LEFT[0], of_forces);
            }
        }
        Arc::make_mut(&mut self.problem).prepare(&self.model, state, increment, 0.0)?;
        if !vanish {
            self.spare = last;
            return Ok((report, None));
        }
        let (model, zeros) = (&self.model, vec![0.0; self.iterate.lambda.len()]);
        let points = model.points.iter().zip(&last.points);
        let touching = points.filter(|(_, state)| state.state != ContactState::Open);
        let targets = touching.flat_map(|(point, _)| rows(point));
        let targets = targets.map(|row| (row, last.rows[row])).collect();
        let from = Place {
            lambda: &zeros,
            alpha: &vec![0.0; self.problem.rhs.len()],
            rows: &zeros,
        };
        let placed = self.placed(model.loose_motions()?, &from, targets)?;
        report.counters.products += usize::from(placed.is_some());
        self.spare = last;
        let certified = placed.filter(|(_, placed)| placed.certificate.largest() <= self.settings.tolerance);
        let unloaded = certified.map(|(alpha, placed)| {
            self.iterate.alpha = alpha;
            self.iterate.f_lambda.clone_from(&zeros);
            self.iterate.lambda = zeros;
            placed
        });
        Ok((report, unloaded))
    }

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
        let own = || moved_points(model, &motions);
        let last = &state.lambda[0];
        let pressed = |point: &&ConstrainedPoint| last.get(point.row).is_some_and(|force| *force < 0.0);
        let mut targets: Vec<usize> = own().filter(pressed).flat_map(rows).collect();
        if targets.is_empty() {
            targets = own().flat_map(|p| p.along().map(|along| along.1)).collect();
        }
        let targets = targets.into_iter().map(|row| (row, problem.offset[row])).collect();
        let from = Place {
            lambda: &self.iterate.lambda,
            alpha: &self.iterate.alpha,
            rows: &recovered.rows,
        };
        // where obstacles or partners have moved it may be inside them
        let largest = recovered.certificate.largest().max(self.settings.tolerance);
        Ok(match self.placed(&motions, &from, targets)? {
            Some((alpha, stands)) if stands.certificate.largest() <= largest => {
                self.iterate.alpha = alpha;
                stands
            }
            _ => recovered,
        })
    }

    /// The amplitudes `alpha`, and what is recovered from them, after motions that bring rows closest to their targets
    /// and no points to overlap; `None` where nothing moves.
    fn placed(
        &self,
        motions: &[FreeMotion],
        from: &Place<'_>,
        targets: Vec<(usize, f64)>,
    ) -> Result<Option<(Vec<f64>, Recovered)>, ContactError> {
        let (model, problem) = (&self.model, &self.problem);
        if motions.is_empty() || targets.is_empty() {
            return Ok(None);
        }
        let gaps = moved_points(model, motions).map(|point| (point.row, problem.offset[point.row]));
        let wanted = [targets, gaps.collect()];
        let coarse = model.tfeti.coarse();
        let mut moves = vec![0.0; coarse.dim()];
        let mut columns = [0, 1].map(|k: usize| DMatrix::zeros(wanted[k].len(), motions.len()));
        for (k, motion) in motions.iter().enumerate() {
            coarse.transpose_times(&motion.amplitudes, &mut moves);
            for (columns, wanted) in columns.iter_mut().zip(&wanted) {
                columns
                    .column_mut(k)
                    .iter_mut()
                    .zip(wanted)
                    .for_each(|(c, (row, _))| *c = moves[*row]);
            }
        }
        let missing = wanted.map(|wanted| {
            let missing = wanted.iter().map(|(row, place)| place - from.rows[*row]);
            DVector::from_iterator(wanted.len(), missing)
        });
        let Some(ways) = nearest(&columns, &missing) else {
            return Ok(None);
        };
        let mut alpha = from.alpha.to_vec();
        for (motion, way) in motions.iter().zip(ways.iter()) {
            vector::axpy(*way, &motion.amplitudes, &mut alpha);
        }
        let lambda = problem.multipliers(from.lambda);
        let placed = Recovered::new(model, problem, &lambda, &alpha, Recovered::default())?;
        Ok(Some((alpha, placed)))
    }
}

/// The contact points of bodies that motions move.
fn moved_points<'a>(model: &'a Model, motions: &[FreeMotion]) -> impl Iterator<Item = &'a ConstrainedPoint> + use<'a> {
    let moved: HashSet<u32> = motions.iter().flat_map(|m| &m.bodies).map(|b| b.body as u32).collect();
    let moves = move |point: &&ConstrainedPoint| bodies(model, point.row).any(|body| moved.contains(&body));
    model.points.iter().filter(moves)
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
