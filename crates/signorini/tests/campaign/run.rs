//! Runs a scene and judges its levels.

use crate::apart::Apart;
use crate::check::apart::ApartJudge;
use crate::check::{Judge, Violation};
use crate::recipe::Recipe;
use crate::say;
use signorini::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// A level that the library solved.
#[derive(Debug, Clone)]
pub(crate) struct Level {
    pub(crate) status: StepStatus,
    pub(crate) products: usize,
    pub(crate) faces: usize,
    pub(crate) fallback: bool,
    pub(crate) certificate: f64,
    /// Whether an earlier level on which this one depends is not solved.
    pub(crate) inherited: bool,
    /// Largest violation that is accepted.
    pub(crate) limit: f64,
    pub(crate) violations: Vec<Violation>,
}

impl Level {
    /// The condition that is violated most, by what it may be.
    pub(crate) fn worst(&self) -> Violation {
        let none = ("nothing", 0.0);
        let worse = |a: Violation, b: Violation| if b.1 > a.1 || b.1.is_nan() { b } else { a };
        self.violations.iter().copied().fold(none, worse)
    }

    /// Whether it is said to be solved, and what it depends on, too.
    pub(crate) fn is_solved(&self) -> bool {
        self.status.converged() && !self.inherited
    }

    /// Whether it is said to be solved and is not.
    pub(crate) fn is_wrong(&self) -> bool {
        let (_, worst) = self.worst();
        self.is_solved() && (worst > self.limit || worst.is_nan())
    }
}

/// How a scene ended.
#[derive(Debug)]
pub(crate) enum Outcome {
    /// Refused before anything was solved: the kind of the error, and its words.
    Refused(String, String),
    Solved(Vec<Level>),
    /// A panic, an error that is no verdict on the scene, or any in a level.
    Broken(String),
}

/// Violations that a converged level may have.
pub(crate) const LIMIT: f64 = 1e-4;

pub(crate) fn run(recipe: &Recipe) -> Outcome {
    guarded(|| {
        let mut judge = Judge::new(recipe);
        levels(|see| each_level(recipe, |frame| see(frame, judge.step(frame)?)))
    })
}

/// The same of bodies meshed apart.
pub(crate) fn run_apart(apart: &Apart) -> Outcome {
    guarded(|| {
        let mut judge = ApartJudge::new(apart);
        levels(|see| {
            each_apart_level(apart, |simulation, frame| {
                see(frame, judge.step(simulation.constrained_points(), frame)?)
            })
        })
    })
}

/// Shows all levels of bodies meshed apart; says what refuses them.
pub(crate) fn each_apart_level(
    apart: &Apart,
    see: impl FnMut(&Simulation, &StepResult) -> Result<(), Error>,
) -> Result<Option<Refusal>, Error> {
    let recipe = &apart.recipe;
    levels_of(apart.scene(say::scene(recipe)?)?, recipe, &say::settings(recipe), see)
}

/// An outcome, or how it broke.
fn guarded(run: impl FnOnce() -> Result<Outcome, Error>) -> Outcome {
    match catch_unwind(AssertUnwindSafe(run)) {
        Ok(Ok(outcome)) => outcome,
        Ok(Err(error)) => Outcome::Broken(error.to_string()),
        Err(panic) => {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
            Outcome::Broken(format!("panic: {}", text.unwrap_or("?")))
        }
    }
}

/// What refuses a scene: the kind of the error, and its words.
type Refusal = (String, String);

/// Shows all levels of a scene as they are solved; says what refuses it.
pub(crate) fn each_level(
    recipe: &Recipe,
    mut see: impl FnMut(&StepResult) -> Result<(), Error>,
) -> Result<Option<Refusal>, Error> {
    levels_of(say::scene(recipe)?, recipe, &say::settings(recipe), |_, frame| {
        see(frame)
    })
}

/// The same of a scene that says more than its recipe.
fn levels_of(
    scene: Scene,
    recipe: &Recipe,
    settings: &Settings,
    mut see: impl FnMut(&Simulation, &StepResult) -> Result<(), Error>,
) -> Result<Option<Refusal>, Error> {
    let mut simulation = match Simulation::new(scene.clone(), settings.clone()) {
        Ok(simulation) => simulation,
        Err(error) => {
            let name = match &error {
                ContactError::NotHeld { .. } => "NotHeld",
                ContactError::NotDetermined { .. } => "NotDetermined",
                ContactError::SharedNode { .. } => "SharedNode",
                ContactError::SupportInObstacle { .. } => "SupportInObstacle",
                // bodies that overhang may miss the one below
                ContactError::NoPartner { .. } => "NoPartner",
                _ => return Err(error.into()),
            };
            return Ok(Some((name.to_owned(), error.to_string())));
        }
    };
    let mut solved = 0;
    while !simulation.is_finished() {
        if recipe.how.resume == Some(solved) {
            let state = simulation.state().clone();
            simulation = Simulation::new(scene.clone(), settings.clone())?;
            simulation.resume(state)?;
        }
        let result = simulation.step()?;
        see(&simulation, &result)?;
        solved += 1;
    }
    Ok(None)
}

/// Bits of the displacements and certificates of all levels, and how the scene ended; solved by one of several ranks.
pub(crate) fn bits(scene: Scene, recipe: &Recipe, communicator: Arc<dyn Communicator>) -> (Vec<u64>, String) {
    let mut bits = Vec::new();
    let settings = say::settings(recipe).with_communicator(communicator);
    let end = levels_of(scene, recipe, &settings, |_, frame| {
        bits.extend(frame.torn_displacement().iter().map(|v| v.to_bits()));
        bits.extend([frame.certificate().largest(), frame.algebraic_error().energy].map(f64::to_bits));
        bits.push(frame.report().counters.products as u64);
        Ok(())
    });
    (bits, format!("{end:?}"))
}

/// Takes a level with its violations.
type Take<'t> = dyn FnMut(&StepResult, Vec<Violation>) -> Result<(), Error> + 't;

/// The levels that a run shows.
fn levels(run: impl FnOnce(&mut Take<'_>) -> Result<Option<Refusal>, Error>) -> Result<Outcome, Error> {
    let mut out = Vec::new();
    let refused = run(&mut |frame, violations| {
        let report = frame.report();
        let certified = report.accuracy.map_or(0.0, |a| a.certificate_limit);
        out.push(Level {
            status: report.status,
            products: report.counters.products,
            faces: report.counters.active_sets,
            fallback: report.fallback,
            inherited: frame.report().unconverged_history.is_some(),
            certificate: frame.certificate().largest(),
            limit: LIMIT.max(10.0 * certified),
            violations,
        });
        Ok(())
    })?;
    Ok(match refused {
        Some((kind, text)) => Outcome::Refused(kind, text),
        None => Outcome::Solved(out),
    })
}
