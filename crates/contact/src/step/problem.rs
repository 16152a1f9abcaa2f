//! The dual problem of one step: loads and offsets.

use crate::discrete::rounded;
use crate::error::ContactError;
use crate::model::{ConstrainedPoint, Model, PointRow};
use crate::part::Part;
use crate::scene::{Contact, DifferenceFormula, Increment, Pose, Scene};
use crate::state::{Peak, State};
use crate::tolerances::{FORCE_ROUNDING, OPENED, REACHED, REST, ROUNDING};
use crate::vec3::dot;
use signorini_fem_mesh::History;
use signorini_qp::vector;
use signorini_tfeti::internal::zeros;
use signorini_tfeti::{FreeMotion, LoadResponse};
use std::borrow::Cow;

/// Data of one step.
#[derive(Debug, Default, Clone)]
pub(crate) struct StepProblem {
    /// Position in the analysis, from 0.
    pub(crate) index: usize,
    /// Time, s.
    pub(crate) time: f64,
    /// Length of the increment; `None` in a static scene.
    pub(crate) step: Option<f64>,
    /// Difference formula of the increment; `None` in a static scene.
    pub(crate) formula: Option<DifferenceFormula>,
    /// Factor of each load.
    pub(crate) factors: Vec<f64>,
    /// `c`: gap, old tangential displacement and prescribed displacement, in row units.
    pub(crate) offset: Vec<f64>,
    /// `B K+ f`.
    pub(crate) load: Vec<f64>,
    /// `d = c - B K+ f`.
    pub(crate) linear: Vec<f64>,
    /// `e = -R^T f`.
    pub(crate) rhs: Vec<f64>,
    /// Multipliers that balance the loads, and are not what a solver finds; empty with contact. `load` and `rhs` are
    /// those of the loads with them.
    pub(crate) balancing: Vec<f64>,
    /// The obstacle of each contact surface, now and an increment before; empty where none moves and no gap changes.
    pub(crate) obstacles: [Vec<Pose>; 2],
    /// The part of `c` that comes from supports, in tangential rows of points of several nodes: what supports move
    /// there is not in `B u`. By contact row, in row units; empty where no support moves or all points are one node.
    pub(crate) prescribed: Vec<f64>,
    /// Largest sizes of each body at earlier steps.
    pub(crate) peaks: Vec<Peak>,
    /// Coefficient of friction at each point, 0 without; empty where there is no friction at all.
    pub(crate) coefficients: Vec<f64>,
    /// What supports that move a body, and eigenstrain, would do to its nodes with all others held, norm for each body,
    /// N; empty if there are none.
    pub(crate) prescribed_force: Vec<f64>,
    /// Slip bound of Tresca friction at each point, N, 0 without.
    pub(crate) tresca: Vec<f64>,
    /// Unit of force of each point, N; empty if it is 1 N everywhere.
    pub(crate) units: Vec<f64>,
}

impl StepProblem {
    /// Computes the data of an increment from the model and the state before it. Besides its own loads this part of those
    /// at its start is `left`: zero but on the way to where none act.
    pub(crate) fn prepare(
        &mut self,
        model: &Model,
        state: &State,
        increment: Increment,
        left: f64,
    ) -> Result<(), ContactError> {
        let time = increment.end;
        self.index = increment.index;
        self.time = time;
        self.step = increment.length;
        self.formula = increment.formula;
        self.peaks.clone_from(&state.peaks);
        self.peaks.resize(model.bodies.count().max(1), Peak::default());
        let before = increment.start.filter(|_| left != 0.0);
        let factor = |load| model.factor(load, time) + before.map_or(0.0, |start| left * model.factor(load, start));
        self.factors = (0..model.loads.len()).map(factor).collect();
        let (rows, take) = (model.tfeti.dual_dim(), std::mem::take::<Vec<f64>>);
        self.load = zeros(take(&mut self.load), rows);
        self.rhs = zeros(take(&mut self.rhs), model.tfeti.coarse().rows());
        for (factor, load) in self.factors.iter().zip(&model.loads) {
            vector::axpy(*factor, &load.dual, &mut self.load);
            vector::axpy(*factor, &load.coarse, &mut self.rhs);
        }
        let balancing = if model.balancing.is_empty() { 0 } else { rows };
        self.balancing = zeros(take(&mut self.balancing), balancing);
        for (factor, lambda) in self.factors.iter().zip(&model.balancing) {
            vector::axpy(*factor, lambda, &mut self.balancing);
        }
        let histories = model.discrete.supports.motions.iter();
        let cases: Vec<(usize, f64)> = histories.map(|h| h.value(time)).enumerate().collect();
        self.offset = model.tfeti.prescribed_offsets(take(&mut self.offset), &cases);
        self.part_ties(model);
        self.prescribed_force = model.prescribed_force(&self.offset, &self.factors);
        self.prescribed.clear();
        let several = model.plan.effects.partners || model.scene.mesh.order() == 2;
        if model.plan.effects.motion && several {
            let several = |p: &&ConstrainedPoint| p.contact.sides.nodes().nth(1).is_some();
            for PointRow { row, .. } in model.points.iter().filter(several).flat_map(|p| p.along()) {
                let rows = self.prescribed.len().max(row + 1);
                self.prescribed.resize(rows, 0.0);
                self.prescribed[row] = self.offset[row];
            }
        }
        self.find_obstacles(model, [Some(time), increment.start]);
        self.add_offsets(model, state)?;
        self.linear.resize(rows, 0.0);
        vector::difference(&self.offset, &self.load, &mut self.linear);
        self.find_friction(model, state)
    }

    /// Opens all contacts: gaps beyond all that bodies move by.
    pub(crate) fn open(&mut self, model: &Model) {
        let largest = self.linear.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        for point in model.points.iter() {
            self.offset[point.row] += OPENED * largest;
            self.linear[point.row] += OPENED * largest;
        }
    }

    /// Whether the loads do no work, but rounding, on any motion that contact alone stops.
    pub(crate) fn is_balanced(&self, motions: &[FreeMotion]) -> bool {
        let least = ROUNDING * vector::norm(&self.rhs);
        let works = |m: &FreeMotion| vector::dot(&m.amplitudes, &self.rhs).abs() > least * vector::norm(&m.amplitudes);
        !motions.iter().any(works)
    }

    /// How far the loads have grown along themselves since a time, over what they were then: 0 if they stayed, infinite
    /// if nothing tells.
    pub(crate) fn growth(&self, model: &Model, time: f64) -> f64 {
        let mut before = vec![0.0; self.rhs.len()];
        let (mut along, mut square) = (0.0, 0.0);
        let loads = model.loads.iter().zip(&model.strained).zip(&self.factors);
        for (k, ((load, strained), now)) in loads.enumerate() {
            let factor = model.factor(k, time);
            vector::axpy(factor, &load.coarse, &mut before);
            let size: f64 = strained.iter().sum();
            along += now * factor * size;
            square += factor * factor * size;
        }
        // eigenstrains count where nothing else does
        let pushed = vector::dot(&before, &before);
        if pushed > 0.0 {
            (along, square) = (vector::dot(&self.rhs, &before), pushed);
        }
        let growth = along / square - 1.0;
        if square > 0.0 { growth.max(0.0) * (1.0 + ROUNDING) } else { f64::INFINITY }
    }

    /// Whether no load acts, and one did in a state.
    pub(crate) fn is_unloaded(&self, model: &Model, state: &State) -> bool {
        model.mark(&self.factors) == 0 && state.loads != 0
    }

    /// Whether all that acts is back at zero, and was not in a state, which is of that time.
    pub(crate) fn is_back(&self, model: &Model, (state, before): (&State, f64)) -> bool {
        let at_zero = |time: f64| moving(&model.scene).all(|history| history.value(time) == 0.0);
        model.mark(&self.factors) == 0 && at_zero(self.time) && (state.loads != 0 || !at_zero(before))
    }

    /// Whether nothing that acts has changed since a state, which is of that time.
    pub(crate) fn rests(&self, model: &Model, (state, since): (&State, f64)) -> bool {
        let stays = |history: &History| history.value(since) == history.value(self.time);
        model.mark(&self.factors) == state.loads && moving(&model.scene).all(stays)
    }

    /// Adds to the offsets of contact rows what is theirs: gap, position of rest, way of the obstacle.
    fn add_offsets(&mut self, model: &Model, state: &State) -> Result<(), ContactError> {
        let effects = &model.plan.effects;
        let formula = self.formula.filter(|_| effects.history);
        let start = model.tangential_rows().start;
        for point in model.points.iter() {
            if effects.gap {
                let gap = rounded(self.gap(&model.scene, point, 0)?, model.discrete.rounding);
                self.offset[point.row] += point.scale * gap;
            }
            if let Some(formula) = formula {
                for PointRow { row, scale, .. } in point.along() {
                    let (last, before) = state.traces(row - start);
                    self.offset[row] += scale * formula.offset(last, before);
                }
            }
            if effects.moving_obstacle {
                for PointRow { direction, row, scale } in point.rows() {
                    self.offset[row] += scale * self.carried(point, &direction);
                }
            }
        }
        Ok(())
    }

    /// Adds to the offsets of tied rows what the first side is to move against the other.
    fn part_ties(&mut self, model: &Model) {
        if !model.plan.effects.moving_ties {
            return;
        }
        for (tied, tie) in model.tied() {
            let way = model.scene.contacts[tie.surface].shift(self.time);
            for (row, (direction, length)) in tied.rows.clone().zip(&tied.directions) {
                self.offset[row] += length * tie.sides.sign() * dot(&way, direction);
            }
        }
    }

    /// Where the obstacles that move are, and the gaps that change.
    fn find_obstacles(&mut self, model: &Model, times: [Option<f64>; 2]) {
        let effects = &model.plan.effects;
        if !effects.moving_obstacle && !effects.gap_history {
            return;
        }
        let analysis = &model.scene.analysis;
        let index = self.index;
        // where a step is reached its pose is known; between, the obstacle comes from the last step
        let at = |time: f64, contact: usize| {
            let poses = &model.discrete.poses[contact];
            let reached = [Some(index), index.checked_sub(1)].into_iter().flatten();
            let known = reached
                .filter(|k| analysis.time(*k) == Some(time))
                .find_map(|k| poses.get(k));
            known.copied().or_else(|| {
                let times = [&analysis.times()[..index], &[time]].concat();
                model.scene.contacts[contact].poses(&times).pop()
            })
        };
        self.obstacles = times.map(|time| {
            let contacts = model.scene.contacts.iter().enumerate();
            let pose = |(k, contact): (usize, &Contact)| {
                let known = time.and_then(|time| at(time, k));
                known.unwrap_or_else(|| contact.pose_at_rest())
            };
            contacts.map(pose).collect()
        });
    }

    /// The gap of a point with what an obstacle that moves along the surface has brought and its factor in time,
    /// without what the obstacle opens, m: now (0), or an increment before (1).
    pub(crate) fn gap(&self, scene: &Scene, point: &ConstrainedPoint, ago: usize) -> Result<f64, ContactError> {
        match self.obstacles[ago].get(point.surface()) {
            Some(pose) => point.contact.gap_brought(scene, pose),
            None => Ok(point.contact.gap),
        }
    }

    /// Where the obstacle of a point is; at rest where none moves.
    pub(crate) fn pose(&self, point: &ConstrainedPoint) -> Pose {
        self.obstacles[0]
            .get(point.contact.surface)
            .copied()
            .unwrap_or_default()
    }

    /// Way of its obstacle past a point along a direction, m.
    fn carried(&self, point: &ConstrainedPoint, direction: &[f64; 3]) -> f64 {
        dot(&self.pose(point).drag(&point.contact.centre), direction)
    }

    /// Displacement of a point along one of its tangential directions relative to the obstacle or the other body, m:
    /// `value` is what `B u` has of it.
    pub(crate) fn relative(
        &self,
        point: &ConstrainedPoint,
        PointRow { direction, row, scale }: PointRow,
        value: f64,
    ) -> f64 {
        (value - entry_or_zero(&self.prescribed, row)) / scale - self.carried(point, &direction)
    }

    /// What vanishing multipliers of a body are measured against, N: earlier ones, and the rounding errors of its
    /// motion.
    pub(crate) fn rest(&self, body: usize) -> f64 {
        self.at_rest(body, FORCE_ROUNDING, |p| p.multipliers)
    }

    fn at_rest(&self, body: usize, rounded: f64, size: fn(&Peak) -> f64) -> f64 {
        let earlier = self.peaks.get(body).map_or(0.0, |p| REST * size(p));
        let rounding = self.prescribed_force.get(body).map_or(0.0, |f| rounded * f);
        earlier.max(rounding)
    }

    /// What vanishing multipliers are measured against, N, where errors of this part of them are asked for: all, and
    /// those of contact.
    pub(crate) fn least(&self, tolerance: f64) -> [f64; 2] {
        let sizes: [fn(&Peak) -> f64; 2] = [|p| p.multipliers, |p| p.force];
        let rounded = force_rounding(tolerance);
        sizes.map(|size| match self.peaks.len() {
            0 | 1 => self.at_rest(0, rounded, size),
            n => (0..n)
                .map(|b| self.at_rest(b, rounded, size).powi(2))
                .sum::<f64>()
                .sqrt(),
        })
    }

    /// All multipliers, from those of a solver.
    pub(crate) fn multipliers<'a>(&self, found: &'a [f64]) -> Cow<'a, [f64]> {
        if self.balancing.is_empty() {
            return Cow::Borrowed(found);
        }
        let mut all = found.to_vec();
        vector::axpy(1.0, &self.balancing, &mut all);
        Cow::Owned(all)
    }

    /// The torn load, N.
    pub(crate) fn forces(&self, model: &Model) -> Vec<f64> {
        let all = 0..model.tfeti.subdomains();
        all.flat_map(|subdomain| self.forces_on(model, subdomain)).collect()
    }

    /// The same in old memory, of several processes what of it acts on the subdomains of this one.
    pub(crate) fn forces_here(&self, old: Vec<f64>, model: &Model) -> Vec<f64> {
        let loads: Vec<(f64, &LoadResponse)> = self.factors.iter().copied().zip(&model.loads).collect();
        model.tfeti.combine_forces(old, &loads)
    }

    /// The part of it on a subdomain.
    pub(crate) fn forces_on(&self, model: &Model, subdomain: usize) -> Vec<f64> {
        let range = model.tfeti.torn_range(subdomain);
        let mut force = vec![0.0; range.len()];
        for (factor, load) in self.factors.iter().zip(&model.loads) {
            vector::axpy(*factor, &load.force[range.clone()], &mut force);
        }
        force
    }
}

/// The histories of all that acts but loads, which may have been others before.
fn moving(scene: &Scene) -> impl Iterator<Item = &History> {
    let all = scene.histories();
    all.filter(|(part, _)| !matches!(part, Part::Load(_)))
        .map(|(_, history)| history)
}

/// Part of displacement times stiffness that forces are measured against at least, where errors of this part of them
/// are asked for.
pub(crate) fn force_rounding(tolerance: f64) -> f64 {
    FORCE_ROUNDING.max(REACHED / tolerance)
}

/// A value by row of a table that may end before; zero there.
pub(crate) fn entry_or_zero(table: &[f64], row: usize) -> f64 {
    table.get(row).copied().unwrap_or(0.0)
}
