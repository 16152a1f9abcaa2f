//! One time level: the dual problem at a time, and the slip bounds.

use crate::error::ContactError;
use crate::model::{ConstrainedPoint, Model};
use crate::scene::{Friction, Scene};
use crate::state::{Peak, State};
use crate::tolerances::{REST, ROUNDED};
use crate::vec3::dot;
use signorini_qp::{ProductSet, vector};

/// Data of one level; vectors are allocated once and rewritten.
#[derive(Debug, Default, Clone)]
pub(crate) struct StepProblem {
    /// Position in the analysis, from 0.
    pub(crate) index: usize,
    /// Time, s.
    pub(crate) time: f64,
    /// Step length; `None` in a static scene.
    pub(crate) step: Option<f64>,
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
    /// Displacement of the obstacle of each contact surface, now and at the level before; empty where none moves.
    pub(crate) obstacles: [Vec<[f64; 3]>; 2],
    /// The part of `c` that comes from supports, in tangential rows between bodies: what supports move there is not in `B u`.
    /// By contact row, in row units; empty where no support moves such a point.
    pub(crate) prescribed: Vec<f64>,
    /// Largest sizes of each body at earlier levels.
    pub(crate) peaks: Vec<Peak>,
    /// Coefficient of friction at each point, 0 without; empty where there is no friction at all.
    pub(crate) coefficients: Vec<f64>,
    /// What supports that move a body would do to its nodes with all others held, norm for each body, N; empty if none moves.
    pub(crate) driven: Vec<f64>,
    /// Given slip bound at each point, N, 0 without.
    pub(crate) given: Vec<f64>,
    /// Unit of force of each point, N; empty if it is 1 N everywhere.
    pub(crate) units: Vec<f64>,
}

impl StepProblem {
    /// Computes the data of level `index` from the model and the state before it.
    pub(crate) fn prepare(
        &mut self,
        model: &Model,
        state: &State,
        index: usize,
    ) -> Result<(), ContactError> {
        let analysis = &model.scene.analysis;
        let levels = analysis.steps();
        let time = analysis
            .time(index)
            .ok_or(ContactError::Finished { levels })?;
        self.index = index;
        self.time = time;
        self.step = analysis.step_size(index);
        self.peaks.clear();
        self.peaks.extend_from_slice(state.peaks());
        self.peaks
            .resize(model.bodies.count().max(1), Peak::default());
        self.factors.clear();
        self.factors.extend(
            model
                .scene
                .loads
                .iter()
                .map(|load| load.history.value(time)),
        );
        let rows = model.tfeti.dual_dim();
        self.load.resize(rows, 0.0);
        self.load.fill(0.0);
        self.rhs.resize(model.tfeti.coarse().rows(), 0.0);
        self.rhs.fill(0.0);
        for (factor, load) in self.factors.iter().zip(&model.loads) {
            vector::axpy(*factor, &load.dual, &mut self.load);
            vector::axpy(*factor, &load.coarse, &mut self.rhs);
        }
        let cases: Vec<(usize, f64)> = model
            .motions
            .iter()
            .map(|h| h.value(time))
            .enumerate()
            .collect();
        self.offset = model.tfeti.prescribed_offsets(&cases);
        self.driven = model.driven(&self.offset);
        self.prescribed.clear();
        if model.plan.effects.motion && model.plan.effects.partners {
            for point in model.points.iter().filter(|p| p.partner.is_some()) {
                for (_, row, _) in point.along() {
                    let rows = self.prescribed.len().max(row + 1);
                    self.prescribed.resize(rows, 0.0);
                    self.prescribed[row] = self.offset[row];
                }
            }
        }
        self.find_obstacles(model, index);
        if model.plan.effects.gap {
            for point in &model.points {
                self.offset[point.row] += point.scale * self.gap(&model.scene, point)?;
            }
        }
        if let (true, Some(formula)) = (model.plan.effects.history, analysis.formula()) {
            let start = model.tangential_start();
            for point in &model.points {
                let Some((row, count, scale)) = point.tangential.rows() else {
                    continue;
                };
                for k in row..row + count {
                    let (last, before) = state.traces(k - start);
                    self.offset[k] += scale * formula.offset(last, before);
                }
            }
        }
        self.move_obstacles(model);
        self.linear.resize(rows, 0.0);
        for ((d, c), l) in self.linear.iter_mut().zip(&self.offset).zip(&self.load) {
            *d = c - l;
        }
        self.friction(model, state)
    }

    /// Where the obstacles that move are.
    fn find_obstacles(&mut self, model: &Model, index: usize) {
        if !model.plan.effects.moving_obstacle {
            return;
        }
        let analysis = &model.scene.analysis;
        let before = index.checked_sub(1).and_then(|i| analysis.time(i));
        self.obstacles = [Some(self.time), before].map(|time| {
            let contacts = model.scene.contacts.iter();
            contacts
                .map(|c| time.map_or([0.0; 3], |t| c.obstacle_at(t)))
                .collect()
        });
    }

    /// Offsets of the obstacles that move.
    fn move_obstacles(&mut self, model: &Model) {
        if self.obstacles[0].is_empty() {
            return;
        }
        for point in &model.points {
            for (direction, row, scale) in point.directions() {
                self.offset[row] += scale * self.carried(point.surface, &direction);
            }
        }
    }

    /// The gap of a point with what an obstacle that moves along the surface has brought, without what it opens, m.
    pub(crate) fn gap(&self, scene: &Scene, point: &ConstrainedPoint) -> Result<f64, ContactError> {
        gap_brought(scene, point, &self.obstacles[0])
    }

    /// The same at the level before.
    pub(crate) fn gap_before(
        &self,
        scene: &Scene,
        point: &ConstrainedPoint,
    ) -> Result<f64, ContactError> {
        gap_brought(scene, point, &self.obstacles[1])
    }

    /// Displacement of the obstacle of a surface along a direction, m.
    pub(crate) fn carried(&self, surface: usize, direction: &[f64; 3]) -> f64 {
        self.obstacles[0]
            .get(surface)
            .map_or(0.0, |w| dot(w, direction))
    }

    /// Displacement of a point along one of its tangential directions relative to the obstacle or the other body, m: `value` is
    /// what `B u` has of it.
    pub(crate) fn relative(
        &self,
        surface: usize,
        (direction, row, scale): ([f64; 3], usize, f64),
        value: f64,
    ) -> f64 {
        (value - entry_or_zero(&self.prescribed, row)) / scale - self.carried(surface, &direction)
    }

    /// What vanishing multipliers of a body are measured against, N: earlier ones, and the rounding errors of its motion.
    pub(crate) fn rest(&self, body: usize) -> f64 {
        self.at_rest(body, |p| p.multipliers)
    }

    fn at_rest(&self, body: usize, size: fn(&Peak) -> f64) -> f64 {
        let earlier = self.peaks.get(body).map_or(0.0, |p| REST * size(p));
        let driven = self.driven.get(body).map_or(0.0, |f| ROUNDED * f);
        earlier.max(driven)
    }

    /// What vanishing multipliers are measured against, N: all, and those of contact.
    pub(crate) fn least(&self) -> [f64; 2] {
        let sizes = |of: fn(&Peak) -> f64| match self.peaks.len() {
            0 | 1 => self.at_rest(0, of),
            n => (0..n)
                .map(|b| self.at_rest(b, of).powi(2))
                .sum::<f64>()
                .sqrt(),
        };
        [sizes(|p| p.multipliers), sizes(|p| p.force)]
    }

    /// The torn load, N.
    pub(crate) fn forces(&self, model: &Model) -> Vec<f64> {
        let loads: Vec<_> = self.factors.iter().copied().zip(&model.loads).collect();
        model.tfeti.combine_forces(&loads)
    }

    fn friction(&mut self, model: &Model, state: &State) -> Result<(), ContactError> {
        if !model.any_law(Friction::is_some)
            || (!self.coefficients.is_empty() && !model.any_law(Friction::depends_on_rate))
        {
            return Ok(());
        }
        // none where the law fails at a point: a later level must not take a part for all
        self.coefficients.clear();
        let value = |(k, point): (usize, &ConstrainedPoint)| match model.law(point) {
            Friction::None => Ok((0.0, 0.0)),
            Friction::Tresca(bound) => {
                Ok((0.0, bound.stress(point.node, point.position)? * point.area))
            }
            Friction::Coulomb(law) => {
                let rate = state.rates().get(k).copied().unwrap_or(0.0);
                Ok((law.value(point.node, point.position, rate)?, 0.0))
            }
        };
        let values: Result<Vec<_>, ContactError> =
            model.points.iter().enumerate().map(value).collect();
        (self.coefficients, self.given) = values?.into_iter().unzip();
        Ok(())
    }

    /// Writes the slip bounds into the set: given ones, or the coefficients times the normal forces in `lambda`.
    pub(crate) fn slip_bounds(&self, model: &Model, lambda: &[f64], set: &mut ProductSet) {
        model.set_slip_bounds(set, |k, point| self.bound(k, point, lambda));
    }

    /// Slip bound of a point in units of force of its body (newtons), `-F_i lambda_nu,i` or the given one; 0 without friction.
    pub(crate) fn bound(&self, k: usize, point: &ConstrainedPoint, lambda: &[f64]) -> f64 {
        match (self.given.get(k), self.coefficients.get(k)) {
            (Some(given), Some(coefficient)) => {
                let unit = self.units.get(k).copied().unwrap_or(1.0);
                given / unit + coefficient * normal_force(point, lambda)
            }
            _ => 0.0,
        }
    }
}

fn gap_brought(
    scene: &Scene,
    point: &ConstrainedPoint,
    obstacles: &[[f64; 3]],
) -> Result<f64, ContactError> {
    let Some(way) = obstacles.get(point.surface) else {
        return Ok(point.gap);
    };
    let contact = &scene.contacts[point.surface];
    let normal = &point.frame.normal;
    contact.gap_brought(
        point.surface,
        point.node,
        point.position,
        normal,
        (point.gap, way),
    )
}

/// Pressing force at a point in newtons, not negative.
pub(crate) fn normal_force(point: &ConstrainedPoint, lambda: &[f64]) -> f64 {
    (-point.scale * lambda[point.row]).max(0.0)
}

/// A value by row of a table that may end before; zero there.
pub(crate) fn entry_or_zero(table: &[f64], row: usize) -> f64 {
    table.get(row).copied().unwrap_or(0.0)
}
