//! What screening adds to a simulation: points that come back, and states on all points.

use super::Simulation;
use crate::error::ContactError;
use crate::level::StepProblem;
use crate::model::Model;
use crate::point_state::PointState;
use crate::scene::Scene;
use crate::screening::Screen;
use crate::settings::Settings;
use crate::solver::{Iterate, Solver};
use crate::state::State;
use std::borrow::Cow;

/// The model of a scene: complete, or without contact points and with a screen.
pub(super) fn set_up(
    scene: Scene,
    settings: &Settings,
) -> Result<(Model, Option<Screen>), ContactError> {
    if !Screen::applies(&scene, settings) {
        return Ok((Model::new(scene, settings)?, None));
    }
    let model = Model::with_points(scene, settings, &[])?;
    match Screen::new(&model, settings)? {
        Some(screen) => Ok((model, Some(screen))),
        None => Ok((Model::new(model.scene, settings)?, None)),
    }
}

impl Simulation {
    /// The state on the rows of the model.
    pub(super) fn view<'a>(&self, state: &'a State) -> Cow<'a, State> {
        match &self.screen {
            Some(screen) => Cow::Owned(screen.view(state)),
            None => Cow::Borrowed(state),
        }
    }

    /// States of all points.
    pub(super) fn states(&self) -> &[PointState] {
        if self.screen.is_some() {
            &self.all
        } else {
            &self.points
        }
    }

    /// Before a level: lets points in that are expected to touch, and others out; whether the model was made anew.
    pub(super) fn look_ahead(&mut self, state: &State) -> Result<bool, ContactError> {
        let expected = self.screen.as_ref().and_then(|s| s.expected(state));
        match expected {
            Some(active) => self.admit(active).map(|()| true),
            None => Ok(false),
        }
    }

    /// After a solve: whether points had to come back, so that the level must be solved again. The iterate then starts
    /// from `lambda`.
    pub(super) fn widen(&mut self, state: &State, lambda: &[f64]) -> Result<bool, ContactError> {
        let Some(screen) = &self.screen else {
            return Ok(false);
        };
        self.all = screen.states(&self.model, &self.level, state, &self.points, &self.torn)?;
        let Some(active) = screen.needed(&self.all, &self.torn) else {
            return Ok(false);
        };
        let complete = screen.expand(lambda);
        self.admit(active)?;
        let lambda = match &self.screen {
            Some(screen) => screen.restrict(&complete),
            None => complete,
        };
        self.iterate = Iterate {
            f_lambda: vec![0.0; lambda.len()],
            lambda,
            known: false,
            multiplier: vec![0.0; self.model.tfeti.coarse().rows()],
            alpha: Vec::new(),
        };
        Ok(true)
    }

    /// Makes the model with these points in; the old one stays after an error.
    pub(super) fn admit(&mut self, active: Vec<bool>) -> Result<(), ContactError> {
        let Some(screen) = &mut self.screen else {
            return Ok(());
        };
        if screen.active() == active {
            return Ok(());
        }
        let places = screen.places(&active);
        let model = self.model.with_other_points(&self.settings, &places)?;
        let solver = Solver::new(&model, &self.settings)?;
        screen.install(&model, active);
        self.rebuilt += model.tfeti.report().factorisations;
        self.model = model;
        self.solver = solver;
        self.level = StepProblem::default();
        Ok(())
    }
}
