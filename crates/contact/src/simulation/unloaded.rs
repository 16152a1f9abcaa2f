//! Bodies that nothing presses any more: where all forces on a loose body vanish, none determines its rigid motions,
//! and it stays where it stood.

use super::halving::Way;
use super::simulation::Simulation;
use crate::error::ContactError;
use crate::model::{ConstrainedPoint, Model, nearest};
use crate::report::StepReport;
use crate::result::{ContactState, Recovered, Sizes};
use crate::solve::Attempt;
use crate::state::State;
use crate::step::entry_or_zero;
use crate::tolerances::{LOCKED, NULL_RANK, PARTS_LEFT, REST, ROUNDING, VANISHING};
use nalgebra::{DMatrix, DVector};
use signorini_qp::vector;
use signorini_tfeti::FreeMotion;
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::sync::Arc;

/// What bodies are moved from.
struct Standing<'a> {
    lambda: &'a [f64],
    alpha: &'a [f64],
    /// `B u`, in row units.
    rows: &'a [f64],
    /// The torn displacement; empty where it is zero.
    torn: &'a [f64],
}

/// Rows, and what they measure where bodies are to stand.
pub(super) type Targets = Vec<(usize, f64)>;

impl Simulation {
    /// The result of an increment at whose end no load acts that acted at its start, if forces vanish with the loads;
    /// else where bodies stand whose own forces do; and the report of the solves that tell, from whose iterate an
    /// ordinary one sets out. Where loads do not end nothing is told.
    ///
    /// Without loads nothing gives forces a size, and active sets run in circles. A small part of the last loads does,
    /// and leaves the bodies where they stand without it. If a smaller part leaves more of the forces, friction locks
    /// them.
    pub(super) fn unload(
        &mut self,
        state: &State,
        way: &Way,
        (line, attempt): (bool, Attempt),
    ) -> Result<(StepReport, Option<Recovered>, Option<Targets>), ContactError> {
        let (model, increment, mut report) = (&self.model, way.increment(), StepReport::default());
        let loose = model.plan.effects.history && !model.loose_motions()?.is_empty();
        // a part of the last loads is at hand where they are those of the model
        let known = |start| model.mark(&model.factors(start)) == state.loads;
        let ends = self.problem.is_unloaded(model, state) && increment.start.is_some_and(known);
        if !loose || !ends {
            return Ok((report, None, None));
        }
        self.start(state, way, line, attempt);
        let contact = self.model.contact_rows();
        // each body is judged alone: the forces of the heaviest would hide those of another
        let mut before: Vec<f64> = Vec::new();
        let mut gone = vec![false; self.model.bodies.count().max(1)];
        let mut last = std::mem::take(&mut self.spare);
        for left in PARTS_LEFT {
            Arc::make_mut(&mut self.problem).prepare(&self.model, state, increment, left)?;
            self.spare = last;
            let (next, recovered) = self.solve()?;
            (report, last) = (report.resumed(next), recovered);
            self.controller = state.controller;
            if !report.status.converged() {
                gone.fill(false);
                break;
            }
            let mut squares = vec![0.0; gone.len()];
            (self.model.bodies).add_squares(&self.iterate.lambda, contact.clone(), &mut squares);
            let now: Vec<f64> = squares.iter().map(|square| square.sqrt()).collect();
            let rounding = ROUNDING * vector::norm(&now);
            let mut told = !before.is_empty();
            for ((gone, now), before) in gone.iter_mut().zip(&now).zip(&before) {
                let falls_to = |part: f64| *now <= (part * before).max(rounding);
                *gone = falls_to(VANISHING);
                told &= *gone || !falls_to(LOCKED);
            }
            if told {
                break;
            }
            before = now;
            for of_forces in [&mut self.iterate.lambda, &mut self.iterate.f_lambda] {
                vector::scale(PARTS_LEFT[1] / PARTS_LEFT[0], of_forces);
            }
        }
        Arc::make_mut(&mut self.problem).prepare(&self.model, state, increment, 0.0)?;
        let model = &self.model;
        let vanish = |point: &&ConstrainedPoint| gone[model.bodies.of_row(point.row)];
        let points = self.touching(&last).filter(vanish);
        let targets: Targets = points.flat_map(rows).map(|row| (row, last.rows[row])).collect();
        self.spare = last;
        if gone.contains(&false) {
            return Ok((report, None, Some(targets)));
        }
        let unloaded = self.without_forces(state, &targets, &mut report)?;
        Ok((report, unloaded, Some(targets)))
    }

    /// The result without any forces, with bodies where rows are closest to their targets, or those of the points that
    /// were pressed in the last state; `None` if that is no solution.
    pub(super) fn without_forces(
        &mut self,
        state: &State,
        targets: &Targets,
        report: &mut StepReport,
    ) -> Result<Option<Recovered>, ContactError> {
        let pressed = |point: &&ConstrainedPoint| was_pressed(state, point);
        let before = || self.model.points.iter().filter(pressed).flat_map(rows);
        let targets = if targets.is_empty() {
            &before().map(|row| (row, self.problem.offset[row])).collect()
        } else {
            targets
        };
        let zeros = vec![0.0; self.iterate.lambda.len()];
        let from = Standing {
            lambda: &zeros,
            alpha: &vec![0.0; self.problem.rhs.len()],
            rows: &zeros,
            torn: &[],
        };
        let placed = self.placed(state, self.model.loose_motions()?, &from, targets)?;
        report.counters.products += usize::from(placed.is_some());
        let certified = placed.filter(|(_, placed)| placed.certificate.largest() <= self.wanted());
        Ok(certified.map(|(alpha, placed)| {
            self.iterate.alpha = alpha;
            self.iterate.f_lambda.clone_from(&zeros);
            self.iterate.lambda = zeros;
            placed
        }))
    }

    /// The points with contact forces of more than rounding.
    fn touching<'a>(&'a self, recovered: &'a Recovered) -> impl Iterator<Item = &'a ConstrainedPoint> {
        let (model, problem) = (&self.model, &self.problem);
        let sizes = recovered.sizes.iter().enumerate();
        let rest = |(body, own): (usize, &Sizes)| problem.rest(body).max(REST * own.peak().multipliers);
        let rests: Vec<f64> = sizes.map(rest).collect();
        let rounding = ROUNDING * rests.iter().copied().fold(0.0, f64::max);
        let points = model.points.iter().zip(&recovered.points);
        let touching = points.filter(move |(point, at)| {
            let own = self.wanted() * rests[model.bodies.of_row(point.row)];
            at.state != ContactState::Open && -at.normal_force > own.max(rounding)
        });
        touching.map(|(point, _)| point)
    }

    /// Moves bodies without contact forces to where, in the mean, points touch and stick that were pressed in the last
    /// state; if none of them was, to where they stick. They stay as they are if that violates conditions.
    ///
    /// Bodies of which it is `told` where next to no load leaves them stand there.
    pub(super) fn stand(
        &mut self,
        state: &State,
        recovered: Recovered,
        told: Targets,
    ) -> Result<Recovered, ContactError> {
        let (model, problem) = (&self.model, &self.problem);
        // without a last place the solver's own is as good, where it is one
        let stood = state.step() > 0 && model.plan.effects.history;
        let certified = recovered.certificate.largest() <= self.wanted();
        if !stood && certified || model.loose_motions()?.is_empty() {
            return Ok(recovered);
        }
        let held_rows: HashSet<usize> = self.touching(&recovered).flat_map(rows).collect();
        let held: HashSet<u32> = held_rows.iter().flat_map(|row| bodies(model, *row)).collect();
        let mut loose = model.loose_motions()?.iter().flat_map(|motion| &motion.bodies);
        if loose.all(|body| held.contains(&(body.body as u32))) {
            return Ok(recovered);
        }
        let motions = model.motions_left_by(|row| held_rows.contains(&row))?;
        let own = || moved_points(model, &motions);
        let moved: HashSet<usize> = own().flat_map(rows).collect();
        let mut targets = told;
        targets.retain(|(row, _)| moved.contains(row));
        let known: HashSet<usize> = targets.iter().map(|(row, _)| model.bodies.of_row(*row)).collect();
        let pressed =
            |point: &&ConstrainedPoint| was_pressed(state, point) && !known.contains(&model.bodies.of_row(point.row));
        let offset = |row| (row, problem.offset[row]);
        targets.extend(own().filter(pressed).flat_map(rows).map(offset));
        if targets.is_empty() {
            targets = own().flat_map(|p| p.along().map(|along| offset(along.row))).collect();
        }
        // what rounding leaves of forces there is none
        let mut lambda = self.iterate.lambda.clone();
        moved.difference(&held_rows).for_each(|row| lambda[*row] = 0.0);
        let from = Standing {
            lambda: &lambda,
            alpha: &self.iterate.alpha,
            rows: &recovered.rows,
            torn: &recovered.torn,
        };
        // where obstacles or partners have moved it may be inside them
        let largest = recovered.certificate.largest().max(self.wanted());
        Ok(match self.placed(state, &motions, &from, &targets)? {
            Some((alpha, stands)) if stands.certificate.largest() <= largest => {
                (self.iterate.alpha, self.iterate.lambda) = (alpha, lambda);
                stands
            }
            _ => recovered,
        })
    }

    /// The amplitudes `alpha`, and what is recovered from them, after motions that bring rows closest to their targets
    /// and no points to overlap; `None` where nothing moves.
    fn placed(
        &self,
        state: &State,
        motions: &[FreeMotion],
        from: &Standing<'_>,
        targets: &Targets,
    ) -> Result<Option<(Vec<f64>, Recovered)>, ContactError> {
        let model = &self.model;
        if motions.is_empty() || targets.is_empty() {
            return Ok(None);
        }
        // bodies that cannot touch each other are placed one by one
        let mut groups: BTreeMap<usize, Vec<&FreeMotion>> = BTreeMap::new();
        for motion in motions {
            let body = motion.bodies.first().map_or(0, |body| model.bodies.of_body(body.body));
            groups.entry(body).or_default().push(motion);
        }
        let (mut alpha, mut rows) = (from.alpha.to_vec(), from.rows.to_vec());
        for (body, motions) in groups {
            let own = targets.iter().filter(|(row, _)| model.bodies.of_row(*row) == body);
            let (own, to) = (own.copied().collect(), (&mut *alpha, &mut *rows));
            if self.place(state, &motions, from.torn, own, to).is_none() {
                return Ok(None);
            }
        }
        let placed = self.recover([from.lambda, &alpha], Recovered::default())?;
        Ok(Some((alpha, placed)))
    }

    /// The same for bodies that may touch each other; moves amplitudes and rows. `None` if there is no room.
    fn place(
        &self,
        state: &State,
        motions: &[&FreeMotion],
        torn: &[f64],
        mut targets: Targets,
        (alpha, rows): (&mut [f64], &mut [f64]),
    ) -> Option<()> {
        let (model, problem) = (&self.model, &self.problem);
        let coarse = model.tfeti.coarse();
        let moves = motions.iter().map(|motion| {
            let mut moves = vec![0.0; coarse.dim()];
            coarse.transpose_times(&motion.amplitudes, &mut moves);
            moves
        });
        let moves: Vec<Vec<f64>> = moves.collect();
        // rounding is no motion: a body that was never loaded has no other size
        let sizes = problem.peaks.iter().map(|peak| peak.displacement);
        let rounding = ROUNDING * sizes.fold(0.0, f64::max);
        let mut go = |ways: &DVector<f64>, rows: &mut [f64]| {
            let all = motions.iter().zip(&moves).zip(ways);
            for ((motion, moves), way) in all.filter(|(_, way)| way.abs() > rounding) {
                vector::axpy(*way, &motion.amplitudes, alpha);
                vector::axpy(*way, moves, rows);
            }
        };
        let points = || moved_points(model, motions.iter().copied());
        // what targets do not determine stays where it stood
        if let Some(ways) = self.stood(state, motions, torn) {
            go(&ways, rows);
            let known: HashSet<usize> = targets.iter().map(|(row, _)| *row).collect();
            // tangential targets alone would tilt a body
            let stays = |p: &&ConstrainedPoint| {
                let slides = p.along().any(|along| known.contains(&along.row));
                known.is_empty() || slides && !known.contains(&p.row)
            };
            targets.extend(points().filter(stays).map(|p| (p.row, rows[p.row])));
        }
        if targets.is_empty() {
            return Some(());
        }
        let gaps = points().map(|point| (point.row, problem.offset[point.row])).collect();
        let wanted: [Targets; 2] = [targets, gaps];
        let columns = |wanted: &Targets| {
            let (rows, columns) = (wanted.len(), motions.len());
            DMatrix::from_fn(rows, columns, |i, k| moves[k][wanted[i].0])
        };
        let missing = |wanted: &Targets| DVector::from_fn(wanted.len(), |i, _| wanted[i].1 - rows[wanted[i].0]);
        let (columns, missing) = (wanted.each_ref().map(columns), wanted.each_ref().map(missing));
        go(&nearest(&columns, &missing)?, rows);
        Some(())
    }

    /// What motions lead from a torn displacement to where contact nodes were at the last step; `None` if that is not
    /// known.
    fn stood(&self, state: &State, motions: &[&FreeMotion], torn: &[f64]) -> Option<DVector<f64>> {
        let (model, tfeti) = (&self.model, &self.model.tfeti);
        let places = state.places(model.scene.mesh.points().len()).ok()?;
        let points = moved_points(model, motions.iter().copied());
        let nodes = points.flat_map(|point| point.contact.sides.nodes());
        let nodes: BTreeSet<u32> = nodes.map(|(node, _)| node).collect();
        if nodes.is_empty() {
            return None;
        }
        // of each node its first copy: the subdomain, and where the copy is in a torn vector
        let copy = |node: &u32| {
            let copy = model.discrete.decomposition.copies(*node as usize)[0];
            let subdomain = copy.subdomain as usize;
            (subdomain, tfeti.torn_range(subdomain).start + 3 * copy.local as usize)
        };
        let copies: Vec<(usize, usize)> = nodes.iter().map(copy).collect();
        let subdomains: BTreeSet<usize> = copies.iter().map(|copy| copy.0).collect();
        let mut moved = vec![0.0; tfeti.torn_dim()];
        let mut columns = DMatrix::zeros(3 * copies.len(), motions.len());
        for (motion, mut column) in motions.iter().zip(columns.column_iter_mut()) {
            for &subdomain in &subdomains {
                let own = &mut moved[tfeti.torn_range(subdomain)];
                own.fill(0.0);
                let amplitudes = &motion.amplitudes[6 * subdomain..6 * (subdomain + 1)];
                tfeti.kernel(subdomain).add_motion(1.0, amplitudes, own);
            }
            let values = copies.iter().flat_map(|(_, at)| &moved[*at..at + 3]);
            column.iter_mut().zip(values).for_each(|(c, value)| *c = *value);
        }
        let missing = nodes.iter().zip(&copies).flat_map(|(node, (_, at))| {
            let place = places[*node as usize];
            (0..3).map(move |c| place[c] - entry_or_zero(torn, at + c))
        });
        let missing = DVector::from_iterator(columns.nrows(), missing);
        let svd = columns.svd(true, true);
        svd.solve(&missing, NULL_RANK * svd.singular_values.max()).ok()
    }
}

/// Whether contact pressed a point in the last state.
fn was_pressed(state: &State, point: &ConstrainedPoint) -> bool {
    state.lambda[0].get(point.row).is_some_and(|force| *force < 0.0)
}

/// The contact points of bodies that motions move.
fn moved_points<'a>(
    model: &'a Model,
    motions: impl IntoIterator<Item = &'a FreeMotion>,
) -> impl Iterator<Item = &'a ConstrainedPoint> {
    let moved = motions.into_iter().flat_map(|motion| &motion.bodies);
    let moved: HashSet<u32> = moved.map(|body| body.body as u32).collect();
    let moves = move |point: &&ConstrainedPoint| bodies(model, point.row).any(|body| moved.contains(&body));
    model.points.iter().filter(moves)
}

/// The rows of a point.
fn rows(point: &ConstrainedPoint) -> impl Iterator<Item = usize> {
    point.rows().map(|own| own.row)
}

/// The bodies that a row acts on.
fn bodies(model: &Model, row: usize) -> impl Iterator<Item = u32> {
    let body_of = model.tfeti.coarse().body_of();
    model.tfeti.gluing().row(row).into_iter().map(|entry| body_of[entry.0])
}
