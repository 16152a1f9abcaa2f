//! Estimate of the error of the time steps by step doubling.
//!
//! Every step is taken once, and again as two steps of half the length. If the error falls like the step to the power `p`, that of
//! the *whole* step is the difference times `1 / (1 - 2^-p)`, and that of the *half* steps `2^-p` of that. Both difference formulas are of
//! first order on sliding that begins, ends and turns, better where nothing changes, and without order where another step
//! leads to another sequence of sticking and sliding. `Twice` takes quarter steps as well and measures `p`.
//!
//! | [`Doubling`] | the half steps start from | tells | formulas | cost |
//! |---|---|---|---|---|
//! | `Local` | the same [`State`](crate::State) as the whole step | what this step adds | one-step ones (backward Euler), unequal steps too | 3 runs |
//! | `Global` | their own last state | what all steps so far have added | all | 3 runs |
//! | `Twice` | their own last state, and so do quarter steps | the same, with its order and whether it can be trusted | all | 7 runs |
//!
//! The three-step formula has no local version: half a step needs the displacement half a step before the start, which is
//! no level of the run, and equal steps. From rest both start alike: the body is at rest before time 0, so the missing
//! old displacements are zero.
//!
//! **Below the solver.** Both runs carry the errors that their solver has left ([`AccumulatedError::likely`]). A difference that is
//! not three times as large as both together says nothing of the time steps: `is_below_solver` tells, nothing is said about
//! reliability, and such steps do not enter the order. A smaller tolerance would show how small the error is. In
//! [`Doubling::Local`] only what the step itself adds counts: both runs inherit the same.
//!
//! The memory is that of two runs, of three with `Twice`.

use super::frame::StepResult;
use super::simulation::Simulation;
use crate::error::ContactError;
use crate::report::{AccumulatedError, Counters, relative};
use crate::result::ContactState;
use crate::scene::{Analysis, Scene};
use crate::settings::Settings;
use signorini_fem_mesh::fields;

/// Where the half steps start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Doubling {
    /// From the state of the whole step: the error of one step.
    Local,
    /// From the last half step: the error of all steps so far.
    Global,
    /// As `Global`, with quarter steps, from which the order follows.
    Twice,
}

/// Difference between a step and two half steps, at the end of the step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct TimeError {
    /// Position of the level, from 0.
    pub level: usize,
    /// Time, s.
    pub time: f64,
    /// Energy of the difference of the displacements, `1/2 |u - u'|²`, J.
    pub energy: f64,
    /// Elastic energy of the half steps' displacement, J.
    pub elastic: f64,
    /// What energies are compared with, J: that, or more for a [body at rest](crate::AlgebraicError::scale).
    pub scale: f64,
    /// What the solver is likely to have left in the difference of the two finest runs, as an energy, J: the square of the sum of
    /// the roots of their accumulated algebraic errors.
    pub algebraic: f64,
    /// Euclidean norm of the differences of the nodal contact forces, N.
    pub contact_force: f64,
    /// Euclidean norm of the nodal contact forces, N.
    pub contact_force_size: f64,
    /// Difference of the work of friction in this step (`Local`) or since the start (`Global`), J.
    pub dissipated_work: f64,
    /// That work, J.
    pub dissipated_work_size: f64,
    /// Contact points whose state (open, sticking, sliding) is another one after the half steps.
    pub changed_points: usize,
    /// Contact points that touch after the half steps.
    pub touching_points: usize,
    /// With [`Doubling::Twice`]: energy of the difference of the whole to the quarter steps, J.
    pub quarter_energy: Option<f64>,
    /// With [`Doubling::Twice`]: energy of the difference of the half to the quarter steps, J.
    pub finest_energy: Option<f64>,
    /// With [`Doubling::Twice`]: order `p` measured on all steps so far in which more differs than the solver leaves; NaN as long
    /// as there is none.
    pub order: Option<f64>,
}

/// Differences are time error, and not the solver's, from this many times the solver's errors on.
const ABOVE: f64 = 3.0;

/// A smaller order means that the steps have not settled into a sequence of sticking and sliding.
const LOWEST: f64 = 0.5;
/// The steps themselves have no more: a larger measured order comes from such a settling.
const HIGHEST: f64 = 2.5;

impl TimeError {
    /// Difference of the displacements relative to the displacement, in the energy norm. 0 where nothing differs.
    #[must_use]
    pub fn displacement(&self) -> f64 {
        relative(self.energy, self.scale)
    }

    /// Estimated error of the displacement after the whole step, relative, in the energy norm: the difference to the finest run
    /// there is, extrapolated with the measured order (taken into its admissible range), or with order one if none was measured.
    #[must_use]
    pub fn whole_error(&self) -> f64 {
        match (self.quarter_energy, self.order) {
            (Some(energy), Some(order)) => {
                let order = if order.is_nan() { 1.0 } else { order };
                let rest = 4.0_f64.powf(-order.clamp(LOWEST, HIGHEST));
                relative(energy, self.scale) / (1.0 - rest)
            }
            _ => 2.0 * self.displacement(),
        }
    }

    /// Whether the difference of the two finest runs is no more than what their solver may have left in it: at most three times the
    /// algebraic error. The error of the time steps is then as small as that or smaller; how small only a smaller tolerance can
    /// tell.
    #[must_use]
    pub fn is_below_solver(&self) -> bool {
        self.finest_energy.unwrap_or(self.energy) <= ABOVE * ABOVE * self.algebraic
    }

    /// Whether the error falls with the step: the measured order is at least 0.5. Where it does not, smaller steps lead to another
    /// sequence of sticking and sliding, and the estimate tells no more than that the results still differ. `None` where nobody
    /// can tell: without [`Doubling::Twice`], and where the difference [is no more than the solver's
    /// error](Self::is_below_solver).
    #[must_use]
    pub fn is_reliable(&self) -> Option<bool> {
        let order = self.order?;
        (!self.is_below_solver()).then_some(order >= LOWEST)
    }

    /// Relative difference of the contact forces. Infinite where no point touches any more after the half steps.
    #[must_use]
    pub fn force(&self) -> f64 {
        ratio(self.contact_force, self.contact_force_size)
    }

    /// Relative difference of the work of friction.
    #[must_use]
    pub fn work(&self) -> f64 {
        ratio(self.dissipated_work.abs(), self.dissipated_work_size.abs())
    }
}

/// 0 for no value, whatever the size.
fn ratio(value: f64, size: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value / size }
}

/// A run beside the same run with steps of half the length.
///
/// ```
/// use signorini_contact::{
///     Analysis, Contact, DifferenceFormula, Doubling, Friction, Load, Scene, Settings, StepDoubling, Support,
/// };
/// use signorini_fem_mesh::{brick, Brick, History, Hooke, Materials};
///
/// let mesh = Brick::new([2.0, 1.0, 1.0], [4, 2, 2]).build()?;
/// let ramp = History::ramp(1.0, 1.0)?;
/// let scene = Scene::new(mesh, Materials::uniform(Hooke::isotropic(1e9, 0.3)?))
///     .with_support(Support::fixed(brick::X_MIN))
///     .with_load(Load::pressure(brick::Z_MAX, 1e6).with_history(ramp.clone()))
///     .with_load(Load::traction(brick::X_MAX, [1e6, 0.0, 0.0]).with_history(ramp))
///     .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.3)))
///     .with_analysis(Analysis::quasistatic(1.0, 4).with_formula(DifferenceFormula::BACKWARD_EULER));
/// let mut doubling = StepDoubling::new(&scene, &Settings::default(), Doubling::Local)?;
/// while !doubling.is_finished() {
///     let error = doubling.step()?;
///     assert!(error.displacement() < 0.1);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct StepDoubling {
    whole: Simulation,
    half: Simulation,
    quarter: Option<Simulation>,
    mode: Doubling,
    /// Energies of the differences whole - half and half - quarter, relative, summed over the steps.
    differences: [f64; 2],
    /// Work of friction so far, of the whole and the half steps.
    work: [f64; 2],
    /// Algebraic errors so far of the whole, half and quarter steps.
    solver: [AccumulatedError; 3],
}

impl StepDoubling {
    /// Sets both runs up.
    ///
    /// # Errors
    /// [`ContactError::Doubling`] for static scenes, and for `Local` with a formula of more than one step; and those
    /// of [`Simulation::new`].
    pub fn new(scene: &Scene, settings: &Settings, mode: Doubling) -> Result<Self, ContactError> {
        let Analysis::Quasistatic { times, formula } = scene.analysis() else {
            return Err(ContactError::Doubling {
                reason: "a static scene has no time steps",
            });
        };
        if mode == Doubling::Local && !formula.is_one_step() {
            return Err(ContactError::Doubling {
                reason: "a formula of three steps cannot start half a step from one state; use Doubling::Global or backward Euler",
            });
        }
        let run = |times: &[f64]| {
            let analysis = Analysis::Quasistatic {
                times: times.to_vec(),
                formula: *formula,
            };
            Simulation::new(scene.clone().with_analysis(analysis), settings.clone())
        };
        let half = halves(times);
        Ok(Self {
            whole: Simulation::new(scene.clone(), settings.clone())?,
            half: run(&half)?,
            quarter: match mode {
                Doubling::Twice => Some(run(&halves(&half))?),
                _ => None,
            },
            mode,
            differences: [0.0; 2],
            work: [0.0; 2],
            solver: [AccumulatedError::default(); 3],
        })
    }

    /// Whether all levels are solved.
    #[must_use]
    pub fn is_finished(&self) -> bool {
        self.whole.is_finished()
    }

    /// The run with whole steps.
    #[must_use]
    pub fn whole(&self) -> &Simulation {
        &self.whole
    }

    /// The run with half steps.
    #[must_use]
    pub fn half(&self) -> &Simulation {
        &self.half
    }

    /// The run with quarter steps, with [`Doubling::Twice`].
    #[must_use]
    pub fn quarter(&self) -> Option<&Simulation> {
        self.quarter.as_ref()
    }

    /// What all runs have cost.
    #[must_use]
    pub fn counters(&self) -> Counters {
        let mut sum = *self.whole.counters();
        sum += *self.half.counters();
        if let Some(quarter) = &self.quarter {
            sum += *quarter.counters();
        }
        sum
    }

    /// Takes the next step in all ways.
    ///
    /// # Errors
    /// As [`Simulation::step`].
    pub fn step(&mut self) -> Result<TimeError, ContactError> {
        if self.mode == Doubling::Local {
            self.work = [0.0; 2];
            self.solver = [AccumulatedError::default(); 3];
            let level = self.whole.state().step();
            self.half.resume(self.whole.state().rebased(2 * level))?;
        }
        let [of_whole, of_half, of_quarter] = &mut self.solver;
        for _ in 0..2 {
            let frame = self.half.step()?;
            self.work[1] += frame.summary().friction_work;
            of_half.add(&frame);
        }
        let frame = self.whole.step()?;
        self.work[0] += frame.summary().friction_work;
        of_whole.add(&frame);
        let mut error = compare(&self.whole.present(), &self.half.present(), self.work)?;
        error.scale = error.elastic.max(of_half.scale());
        error.algebraic = of_whole.likely_difference(of_half);
        if let Some(quarter) = &mut self.quarter {
            for _ in 0..4 {
                of_quarter.add(&quarter.step()?);
            }
            let quarter = quarter.present();
            let far = energy_of_difference(&self.whole.present(), &quarter)?;
            let near = energy_of_difference(&self.half.present(), &quarter)?;
            error.quarter_energy = Some(far);
            error.finest_energy = Some(near);
            error.algebraic = of_half.likely_difference(of_quarter);
            if !error.is_below_solver() {
                for (sum, energy) in self.differences.iter_mut().zip([error.energy, near]) {
                    *sum += ratio(energy, error.scale);
                }
            }
            let [first, second] = self.differences;
            error.order = Some(0.5 * (first / second).log2());
        }
        Ok(error)
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

fn energy_of_difference(a: &StepResult<'_>, b: &StepResult<'_>) -> Result<f64, ContactError> {
    let scene = &a.model.scene;
    let mut difference = a.displacement();
    let other = b.displacement();
    difference.iter_mut().zip(&other).for_each(|(a, b)| *a -= b);
    Ok(fields::strain_energy(
        &scene.mesh,
        &scene.materials,
        &difference,
    )?)
}

fn compare(
    whole: &StepResult<'_>,
    half: &StepResult<'_>,
    work: [f64; 2],
) -> Result<TimeError, ContactError> {
    let scene = &whole.model.scene;
    let other = half.displacement();
    let (mut force, mut size) = (0.0, 0.0);
    let (mut changed, mut touching) = (0, 0);
    for (a, b) in whole.points().iter().zip(half.points()) {
        force += (a.normal_force - b.normal_force).powi(2);
        size += b.normal_force.powi(2);
        changed += usize::from(a.state != b.state);
        touching += usize::from(b.state != ContactState::Open);
        for c in 0..3 {
            force += (a.friction_force[c] - b.friction_force[c]).powi(2);
            size += b.friction_force[c].powi(2);
        }
    }
    Ok(TimeError {
        level: whole.step(),
        time: whole.time(),
        energy: energy_of_difference(whole, half)?,
        scale: 0.0,
        algebraic: 0.0,
        elastic: fields::strain_energy(&scene.mesh, &scene.materials, &other)?,
        contact_force: force.sqrt(),
        contact_force_size: size.sqrt(),
        dissipated_work: work[0] - work[1],
        dissipated_work_size: work[1],
        changed_points: changed,
        touching_points: touching,
        quarter_energy: None,
        finest_energy: None,
        order: None,
    })
}
