//! Given friction: the slip bound is data, so one quadratic program a time level suffices.
//!
//! The brick lies on the floor (no gap), is pressed by 1e8 Pa on the top and pulled at its end. Both methods must find the
//! same forces: the paper's, which counts its quadratic programs, and the library's default.

use std::io::Write;

use signorini::prelude::*;

use crate::brick::{DURATION, clamped};
use crate::error::ExampleError;
use crate::options::{MethodName, TrescaOptions};
use crate::record::{RunRecord, write_json};
use crate::run::{Header, Outcome, pool, run};
use crate::table::warnings;

/// Pressure on the top and pull at the end, Pa.
const PRESSURE: f64 = 1e8;
const PULL: f64 = 2e8;

/// The scene; `bound` is the slip bound of the friction stress in Pa.
///
/// # Errors
/// [`Error`] for sizes that are 0 or too large.
pub fn scene(cells: usize, steps: usize, bound: f64) -> Result<Scene, Error> {
    let floor = Contact::rigid(brick::Z_MIN).with_friction(Friction::tresca(bound));
    let pull = History::ramp(DURATION, 1.0)?;
    Ok(clamped(1, cells, 0.0)?
        .with_load(Load::pressure(brick::Z_MAX, PRESSURE))
        .with_load(Load::traction(brick::X_MAX, [PULL, 0.0, 0.0]).with_history(pull))
        .with_contact(floor)
        .with_analysis(
            Analysis::quasistatic(DURATION, steps).with_formula(DifferenceFormula::BACKWARD_EULER),
        ))
}

/// Solves by both methods and prints sums and certificates.
///
/// # Errors
/// [`ExampleError`] of the library, or if a file cannot be written.
pub fn execute(
    options: &TrescaOptions,
    out: &mut impl Write,
) -> Result<Vec<Outcome>, ExampleError> {
    let pool = pool(options.threads)?;
    let mut outcomes = Vec::new();
    for method in [MethodName::Paper, MethodName::Face] {
        let scene = scene(options.cells, options.steps, options.bound)?;
        let settings = Settings::default()
            .with_method(method.method())
            .with_tolerance(options.tolerance);
        let header = Header {
            n: 1,
            loading: "tresca".to_owned(),
            cells: options.cells,
            formula: "backward-euler".to_owned(),
            it_name: method.iterations().to_owned(),
        };
        let outcome = pool.install(|| run(scene, settings, &header, &mut []))?;
        print(&outcome.record, out)?;
        outcomes.push(outcome);
    }
    if let [paper, face] = outcomes.as_slice() {
        writeln!(
            out,
            "friction at the end, both methods: relative difference {:.1e}",
            difference(&paper.record, &face.record)
        )?;
    }
    if let Some(path) = &options.json {
        write_json(path, outcomes.iter().map(|o| &o.record))?;
    }
    Ok(outcomes)
}

/// Relative difference of the friction forces along x1 at the end.
#[must_use]
pub fn difference(a: &RunRecord, b: &RunRecord) -> f64 {
    match (a.steps.last(), b.steps.last()) {
        (Some(x), Some(y)) => {
            (x.tangential_force[0] - y.tangential_force[0]).abs() / x.tangential_force[0].abs()
        }
        _ => f64::NAN,
    }
}

fn print(run: &RunRecord, out: &mut impl Write) -> Result<(), ExampleError> {
    writeln!(out, "method {}", run.method)?;
    writeln!(
        out,
        "     t s  programs  products  stick  slip   normal N  friction N  dissipation J  certificate"
    )?;
    for s in &run.steps {
        writeln!(
            out,
            "{:>8.3} {:>9} {:>9} {:>6} {:>5} {:>10.3e} {:>11.3e} {:>14.3e} {:>12.1e}",
            s.t,
            s.quadratic_programs,
            s.n_m,
            s.stick,
            s.slip,
            s.normal_force,
            s.tangential_force[0],
            s.dissipation,
            s.certificate
        )?;
    }
    writeln!(out, "{}", warnings(&[run]))?;
    Ok(())
}
