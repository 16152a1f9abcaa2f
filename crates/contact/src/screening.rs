//! Screening: contact points that stay open leave the dual problem, and come back when they are needed.
//!
//! An open point carries no force. If its rows are left out and the recovered displacement keeps it off the obstacle, all its
//! conditions hold, and the result is that of the complete problem: its zero multipliers are part of the solution. This is
//! checked after every level for every point left out, on the recovered displacement, at the cost of a sparse product
//! with its rows. Points that come closer at a speed that makes them touch at the next level come back before it. If one
//! penetrates nevertheless, it and all points closer than a margin come back, the tables and the boundary
//! inverses are made anew, and the level is solved again from the multipliers it has. The first solve has no contact
//! rows at all: it finds the points that the loads press down, and where nothing touches no inequality solver is entered.
//!
//! States between levels count the rows of all points, so that a stored state does not depend on what was left out, and
//! keep the tangential history of points left out: it comes from the recovered displacement, too.
//!
//! Screening is not used where points act while open or are needed before anything is known: with given friction, whose
//! bounds do not vanish with the pressure, and for bodies that contact must hold.

use crate::candidates::contact_nodes;
use crate::contact_surface::Contact;
use crate::error::ContactError;
use crate::law::Friction;
use crate::level::{StepProblem, between_bodies};
use crate::model::{ConstrainedPoint, Model, constrained_points, supports};
use crate::point_state::{PointState, Rows, point_state};
use crate::scene::Scene;
use crate::settings::Settings;
use crate::state::State;
use signorini_tfeti::Gluing;

/// Whether open contact points are left out of the dual problem.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum Screening {
    /// All points are in.
    #[default]
    Off,
    /// Points are left out until they are needed.
    On {
        /// When points come back, so do those closer to the obstacle than this, relative to the largest displacement;
        /// in [0, 10].
        margin: f64,
    },
}

impl Screening {
    /// On, with margin 0.05.
    #[must_use]
    pub fn on() -> Self {
        Self::On { margin: 0.05 }
    }

    pub(crate) fn validate(self) -> Result<(), ContactError> {
        match self {
            Self::On { margin } if !(0.0..=10.0).contains(&margin) => Err(ContactError::Setting {
                name: "screening.margin",
                value: margin,
                range: "[0, 10]",
            }),
            _ => Ok(()),
        }
    }
}

/// Penetration relative to the largest displacement that is rounding.
const ROUNDING: f64 = 1e-12;

/// Levels for which points are taken in at once when one is expected to touch.
const AHEAD: f64 = 4.0;
/// Points leave that would not touch within so many: more, so that they do not come and go.
const AWAY: f64 = 12.0;

/// All contact points and which of them are in the dual problem.
#[derive(Debug)]
pub(crate) struct Screen {
    margin: f64,
    /// `B` with the rows of all points: the numbering of states.
    gluing: Gluing,
    /// All points, with rows of `gluing`.
    points: Vec<ConstrainedPoint>,
    /// Entries (torn unknown, coefficient) of the contact rows of `gluing`.
    entries: Vec<Vec<(usize, f64)>>,
    /// Whether a point is in.
    active: Vec<bool>,
    /// Row of `gluing` of each row of the dual problem.
    rows: Vec<usize>,
}

impl Screen {
    /// The screen of a model without contact points; `None` where screening is not used.
    pub(crate) fn new(model: &Model, settings: &Settings) -> Result<Option<Self>, ContactError> {
        let Screening::On { margin } = settings.screening else {
            return Ok(None);
        };
        if !model.tfeti.coarse_factor().free_motions().is_empty() {
            return Ok(None);
        }
        let (supports, _) = supports(&model.scene)?;
        let nodes = contact_nodes(&model.scene, model.found.points.iter());
        let gluing = Gluing::new(
            &model.decomposition,
            &supports,
            Some(&nodes),
            model.tfeti.copy_stiffness(),
        )?;
        let places: Vec<usize> = (0..model.found.points.len()).collect();
        let points = constrained_points(&model.scene, &model.found.points, &places, &gluing);
        let entry = |(subdomain, dof, value): (usize, usize, f64)| {
            (model.tfeti.torn_range(subdomain).start + dof, value)
        };
        let entries = gluing
            .ranges()
            .contact()
            .map(|row| gluing.row(row).into_iter().map(entry).collect())
            .collect();
        let mut screen = Self {
            margin,
            active: vec![false; points.len()],
            gluing,
            points,
            entries,
            rows: Vec::new(),
        };
        screen.install(model, vec![false; screen.points.len()]);
        Ok(Some(screen))
    }

    /// Whether a scene can be screened, judged without work.
    pub(crate) fn applies(scene: &Scene, settings: &Settings) -> bool {
        let given = |c: &Contact| matches!(c.friction(), Friction::Tresca(_));
        settings.screening != Screening::Off
            && !scene.contacts.is_empty()
            && !scene.contacts.iter().any(given)
    }

    /// Takes over a model with the points `active` in.
    pub(crate) fn install(&mut self, model: &Model, active: Vec<bool>) {
        let (own, all) = (model.tfeti.gluing().ranges(), self.gluing.ranges());
        let mut rows = vec![0; own.total()];
        let mut inside = model.points.iter();
        for (point, _) in self.points.iter().zip(&active).filter(|(_, a)| **a) {
            let Some(solved) = inside.next() else { break };
            rows[solved.row] = point.row;
            if let (Some((to, count, _)), Some((from, ..))) =
                (solved.tangential.rows(), point.tangential.rows())
            {
                (0..count).for_each(|j| rows[to + j] = from + j);
            }
        }
        for (to, from) in (own.interface.start..own.total()).zip(all.interface.start..) {
            rows[to] = from;
        }
        self.rows = rows;
        self.active = active;
    }

    /// All points.
    pub(crate) fn points(&self) -> &[ConstrainedPoint] {
        &self.points
    }

    pub(crate) fn active(&self) -> &[bool] {
        &self.active
    }

    /// Points left out.
    pub(crate) fn left_out(&self) -> usize {
        self.active.iter().filter(|a| !**a).count()
    }

    /// Places of the points in a mask, ascending.
    pub(crate) fn places(&self, active: &[bool]) -> Vec<usize> {
        let kept = self.points.iter().zip(active).filter(|(_, a)| **a);
        kept.map(|(p, _)| p.place).collect()
    }

    /// Rows and tangential rows of the complete problem.
    pub(crate) fn sizes(&self) -> (usize, usize) {
        let ranges = self.gluing.ranges();
        (ranges.total(), ranges.tangential().len())
    }

    /// A dual vector of the complete problem: zero where rows are left out.
    pub(crate) fn expand(&self, own: &[f64]) -> Vec<f64> {
        if own.is_empty() {
            return Vec::new();
        }
        let mut all = vec![0.0; self.gluing.rows_full_rank()];
        for (&to, &value) in self.rows.iter().zip(own) {
            all[to] = value;
        }
        all
    }

    /// The entries of the rows that are in.
    pub(crate) fn restrict(&self, all: &[f64]) -> Vec<f64> {
        if all.is_empty() {
            return Vec::new();
        }
        self.rows.iter().map(|&row| all[row]).collect()
    }

    /// The state on the rows and points that are in. `F lambda` of other rows is not known.
    pub(crate) fn view(&self, state: &State) -> State {
        let start = self.gluing.ranges().tangential().start;
        let end = start + self.gluing.ranges().tangential().len();
        let tangential: Vec<usize> = self
            .rows
            .iter()
            .filter(|row| (start..end).contains(*row))
            .map(|row| row - start)
            .collect();
        let points: Vec<usize> = (0..self.points.len()).filter(|&k| self.active[k]).collect();
        let mut view = state.part(|all| self.restrict(all), &tangential, &points);
        if state.active() != self.active {
            view.forget_products();
        }
        view
    }

    /// States of all points: those of `solved`, and the open ones from the recovered displacement `torn`.
    pub(crate) fn states(
        &self,
        model: &Model,
        level: &StepProblem,
        state: &State,
        solved: &[PointState],
        torn: &[f64],
    ) -> Result<Vec<PointState>, ContactError> {
        let contact = self.entries.len();
        let mut offset = self.prescribed(model, level);
        let prescribed = between_bodies(&self.points, &offset);
        let formula = model.scene.analysis.formula();
        let start = self.gluing.ranges().tangential().start;
        let mut displacement = vec![0.0; contact];
        let mut solved = solved.iter();
        let mut out = Vec::with_capacity(self.points.len());
        for (point, &active) in self.points.iter().zip(&self.active) {
            if active {
                out.extend(solved.next());
                continue;
            }
            let tangential = point.tangential.rows();
            let own = tangential.map_or(0..0, |(row, count, _)| row..row + count);
            for row in std::iter::once(point.row).chain(own.clone()) {
                displacement[row] = self.times(row, torn);
            }
            offset[point.row] += point.scale * level.gap(&model.scene, point)?;
            for (direction, row, scale) in point.directions() {
                offset[row] += scale * level.carried(point.surface, &direction);
            }
            if let (Some(formula), Some((.., scale)), true) =
                (formula, tangential, model.plan.effects.history)
            {
                for row in own {
                    let (last, before) = state.traces(row - start);
                    offset[row] += scale * formula.offset(last, before);
                }
            }
            let rows = Rows {
                lambda: None,
                displacement: &displacement,
                offset: &offset,
                prescribed: &prescribed,
            };
            out.push(point_state(model, level, point, &rows, 0.0));
        }
        Ok(out)
    }

    /// Tangential displacements of the points left out, written into a complete trace.
    pub(crate) fn fill_trace(
        &self,
        model: &Model,
        level: &StepProblem,
        torn: &[f64],
        trace: &mut [f64],
    ) {
        let start = self.gluing.ranges().tangential().start;
        let prescribed = between_bodies(&self.points, &self.prescribed(model, level));
        for (point, _) in self.points.iter().zip(&self.active).filter(|(_, a)| !**a) {
            for along in point.along() {
                let k = along.1;
                let value = self.times(k, torn);
                trace[k - start] = level.relative(point.surface, along, value, &prescribed);
            }
        }
    }

    /// Offsets of all contact rows that come from supports.
    fn prescribed(&self, model: &Model, level: &StepProblem) -> Vec<f64> {
        let mut offset = vec![0.0; self.entries.len()];
        for (case, history) in model.motions.iter().enumerate() {
            let factor = history.value(level.time);
            for &(row, value) in self.gluing.prescribed(case) {
                if let Some(offset) = offset.get_mut(row as usize) {
                    *offset += factor * value;
                }
            }
        }
        offset
    }

    /// The complete trace of the tangential rows that are in.
    pub(crate) fn expand_trace(&self, own: &[f64], own_start: usize) -> Vec<f64> {
        let (start, len) = (
            self.gluing.ranges().tangential().start,
            self.gluing.ranges().tangential().len(),
        );
        let mut all = vec![0.0; len];
        for (k, &value) in own.iter().enumerate() {
            all[self.rows[own_start + k] - start] = value;
        }
        all
    }

    /// The points that must be in after these states; `None` if the result holds for all points.
    pub(crate) fn needed(&self, states: &[PointState], torn: &[f64]) -> Option<Vec<bool>> {
        let reach = signorini_qp::vector::max_abs(torn);
        let outside = |limit: f64| {
            let list = states.iter().zip(&self.active);
            list.map(move |(s, a)| !*a && s.gap < limit)
        };
        if !outside(-ROUNDING * reach).any(|p| p) {
            return None;
        }
        let close = outside(self.margin * reach);
        Some(close.zip(&self.active).map(|(c, a)| c || *a).collect())
    }

    /// Before a level: the points that should be in, each point keeping the speed of its last step; `None` if those that are in
    /// will do. If another one would touch at this level, all that would within [`AHEAD`] levels come in, and points without force
    /// that would not within [`AWAY`] leave: the tables are made anew in any case.
    pub(crate) fn expected(&self, state: &State) -> Option<Vec<bool>> {
        let [last, before] = state.gaps();
        if last.len() != self.points.len() || before.len() != last.len() {
            return None;
        }
        let touches = |k: usize, levels: f64| last[k] + levels * (last[k] - before[k]) < 0.0;
        let lambda = &state.lambda()[0];
        let idle = |k: usize| {
            let free = |row: usize| lambda.get(row).is_none_or(|l| *l == 0.0);
            let point = &self.points[k];
            let tangential = point.tangential.rows();
            let own = tangential.map_or(0..0, |(row, count, _)| row..row + count);
            last[k] > 0.0 && !touches(k, AWAY) && free(point.row) && own.into_iter().all(free)
        };
        let all = 0..self.points.len();
        if !all.clone().any(|k| !self.active[k] && touches(k, 1.0)) {
            return None;
        }
        let stays = |k| {
            if self.active[k] {
                !idle(k)
            } else {
                touches(k, AHEAD)
            }
        };
        Some(all.map(stays).collect())
    }

    fn times(&self, row: usize, torn: &[f64]) -> f64 {
        self.entries[row].iter().map(|(k, v)| v * torn[*k]).sum()
    }
}
