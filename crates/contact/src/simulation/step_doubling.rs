//! Estimate of the error of the time steps by step doubling.
//!
//! Every step is taken once, as two half steps and as four quarter steps, each run going on from its own last state
//! (docs/theory.md, section 11). Both difference formulas are of first order where sliding begins, ends and turns,
//! better where nothing changes, and without order where another step leads to another sequence of sticking and
//! sliding.

use super::result::StepResult;
use super::simulation::Simulation;
use crate::error::ContactError;
use crate::report::{AccumulatedError, Counters, relative};
use crate::scene::{Analysis, Scene};
use crate::settings::Settings;
use crate::tolerances::{ABOVE_SOLVER, ORDERS};
use signorini_fem_mesh::fields;
use std::sync::Arc;

/// Difference between a step and two half steps, at the end of the step.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct TimeError {
    /// Position of the step, from 0.
    pub step: usize,
    /// Time, s.
    pub time: f64,
    /// Energy of the difference of the displacements, `1/2 |u - u'|²`, J.
    energy: f64,
    /// What energies are compared with, J: the elastic energy of the half steps' displacement, or more for a
    /// [body at rest](crate::report::AlgebraicError::scale).
    scale: f64,
    /// What the solver is likely to have left in the difference of the two finest runs, as an energy, J: the square of
    /// the sum of the roots of their accumulated algebraic errors.
    algebraic: f64,
    /// Energy of the difference of the whole to the quarter steps, J.
    quarter_energy: f64,
    /// Energy of the difference of the half to the quarter steps, J.
    finest_energy: f64,
    /// Order `p` measured on all steps so far in which more differs than the solver leaves; `None` as long as there is
    /// none.
    pub order: Option<f64>,
}

impl TimeError {
    /// Difference of the displacements relative to the displacement, in the energy norm. 0 where nothing differs.
    pub fn displacement(&self) -> f64 {
        relative(self.energy, self.scale)
    }

    /// Estimated error of the displacement after the whole step, relative, in the energy norm: the difference to the
    /// quarter steps, extrapolated with the measured order (taken into its admissible range), or with order one if none
    /// was measured.
    pub fn whole_error(&self) -> f64 {
        let order = self.order.unwrap_or(1.0).clamp(ORDERS[0], ORDERS[1]);
        relative(self.quarter_energy, self.scale) / (1.0 - 4.0_f64.powf(-order))
    }

    /// Whether the difference of the two finest runs is no more than what their solver may have left in it: at most
    /// three times the algebraic error. The error of the time steps is then as small as that or smaller; how small only
    /// a smaller tolerance can tell.
    pub fn is_below_solver(&self) -> bool {
        self.finest_energy <= ABOVE_SOLVER * ABOVE_SOLVER * self.algebraic
    }

    /// Whether the error falls with the step: the measured order is at least 0.5. Where it does not, smaller steps lead
    /// to another sequence of sticking and sliding, and the estimate tells no more than that the results still differ.
    /// `None` where the difference [is no more than the solver's error](Self::is_below_solver).
    pub fn is_reliable(&self) -> Option<bool> {
        (!self.is_below_solver()).then(|| self.order.is_some_and(|order| order >= ORDERS[0]))
    }
}

/// A run beside the same run with steps of half and of a quarter of the length.
#[derive(Debug)]
pub struct StepDoubling {
    whole: Simulation,
    half: Simulation,
    quarter: Simulation,
    /// Energies of the differences whole - half and half - quarter, relative, summed over the steps.
    differences: [f64; 2],
    /// Algebraic errors so far of the half and quarter steps.
    solver: [AccumulatedError; 2],
}

impl StepDoubling {
    /// Sets the three runs up.
    ///
    /// # Errors
    /// [`ContactError::Doubling`] for static scenes; and those of [`Simulation::new`].
    pub fn new(scene: &Scene, settings: &Settings) -> Result<Self, ContactError> {
        let Analysis::Quasistatic { times, formula } = scene.analysis() else {
            let reason = "a static scene has no time steps";
            return Err(ContactError::Doubling { reason });
        };
        let run = |times: &[f64]| {
            let (times, formula) = (times.to_vec(), *formula);
            let scene = scene.clone().with_analysis(Analysis::Quasistatic { times, formula });
            Simulation::new(scene, settings.clone())
        };
        let half = halves(times);
        Ok(Self {
            whole: run(times)?,
            half: run(&half)?,
            quarter: run(&halves(&half))?,
            differences: [0.0; 2],
            solver: [AccumulatedError::default(); 2],
        })
    }

    /// Whether all steps are solved.
    pub fn is_finished(&self) -> bool {
        self.whole.is_finished()
    }

    /// The run with whole steps.
    pub fn whole(&self) -> &Simulation {
        &self.whole
    }

    /// What all runs have cost.
    pub fn counters(&self) -> Counters {
        let mut sum = *self.whole.counters();
        sum += *self.half.counters();
        sum += *self.quarter.counters();
        sum
    }

    /// Takes the next step in all ways. After an error runs that are behind catch up, but not at the last step.
    ///
    /// # Errors
    /// As [`Simulation::step`].
    pub fn step(&mut self) -> Result<TimeError, ContactError> {
        let [of_half, of_quarter] = &mut self.solver;
        let whole = self.whole.step()?;
        let steps = whole.step() + 1;
        let half = advance(&mut self.half, 2 * steps, of_half)?;
        let quarter = advance(&mut self.quarter, 4 * steps, of_quarter)?;
        let mut error = TimeError {
            step: whole.step(),
            time: whole.time(),
            energy: energy_of_difference(&whole, &half)?,
            quarter_energy: energy_of_difference(&whole, &quarter)?,
            finest_energy: energy_of_difference(&half, &quarter)?,
            scale: half.strain_energy().max(of_half.scale()),
            algebraic: of_half.likely_difference(of_quarter),
            order: None,
        };
        if !error.is_below_solver() {
            let energies = [error.energy, error.finest_energy];
            for (sum, energy) in self.differences.iter_mut().zip(energies) {
                // no difference is none, whatever the size
                *sum += if energy == 0.0 { 0.0 } else { energy / error.scale };
            }
        }
        let [first, second] = self.differences;
        let order = 0.5 * (first / second).log2();
        error.order = (!order.is_nan()).then_some(order);
        Ok(error)
    }
}

/// Takes steps of a run until so many are solved, returns the last, and adds up algebraic errors.
fn advance(run: &mut Simulation, until: usize, errors: &mut AccumulatedError) -> Result<Arc<StepResult>, ContactError> {
    loop {
        let result = run.step()?;
        errors.add(&result);
        if run.state().step() >= until {
            return Ok(result);
        }
    }
}

/// The times with one more in the middle of each step.
fn halves(times: &[f64]) -> Vec<f64> {
    let mut halves = Vec::with_capacity(2 * times.len());
    let mut before = 0.0;
    for &time in times {
        halves.extend([0.5 * (before + time), time]);
        before = time;
    }
    halves
}

fn energy_of_difference(a: &StepResult, b: &StepResult) -> Result<f64, ContactError> {
    let (mut difference, other) = (a.displacement(), b.displacement());
    let numbers = difference.as_flattened_mut().iter_mut();
    numbers.zip(other.as_flattened()).for_each(|(a, b)| *a -= b);
    let scene = a.scene();
    Ok(fields::strain_energy(
        scene.mesh(),
        scene.materials(),
        difference.as_flattened(),
    )?)
}
