//! Two elastic bodies: a pad is pressed on a rail and then pulled along it, step by step; `--help` lists the options.
//!
//! The scene is that of the plain program `two_bodies`.

#[allow(dead_code, missing_docs)]
#[path = "../../examples/two_bodies.rs"]
pub mod two_bodies;

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use signorini_studies::files::RunFiles;
use signorini_studies::options::{Common, positive};
use signorini_studies::record::{RunRecord, csv, steps_chart, write_json};
use signorini_studies::run::{Outcome, pool, run_with, strict, warnings};
use signorini_studies::{Failure, aligned, exit, save};
pub use two_bodies::COEFFICIENT;

/// Options of `bodies`.
#[derive(Debug, Clone, PartialEq, Parser)]
#[command(
    name = "bodies",
    about = "Two elastic bodies: a pad is pressed on a rail and pulled along it"
)]
pub struct BodiesOptions {
    /// Equal time steps in one second.
    #[arg(long, default_value_t = 20, value_parser = positive)]
    pub steps: usize,
    /// Young's modulus of the rail over that of the pad.
    #[arg(long, default_value_t = 10.0)]
    pub softness: f64,
    /// Write files for ParaView into this folder.
    #[arg(long, value_name = "FOLDER")]
    pub out: Option<PathBuf>,
    /// What all studies have.
    #[command(flatten)]
    pub common: Common,
}

#[allow(dead_code)]
fn main() -> ExitCode {
    exit(execute(&BodiesOptions::parse(), &mut std::io::stdout()))
}

/// Runs the scene and prints step by step what the contact does.
pub fn execute(options: &BodiesOptions, out: &mut impl Write) -> Result<Outcome, Failure> {
    let common = &options.common;
    let scene = two_bodies::scene(common.cells, options.steps, options.softness)?;
    let header = common.header(1, "bodies", "backward-euler");
    let folder = options.out.as_ref().map(|folder| folder.join(header.label()));
    let mut files = folder.as_ref().map(|folder| RunFiles::new(folder, 1, false));
    let pool = pool(common.threads)?;
    let outcome = pool.install(|| {
        run_with(scene, common.settings(), &header, &mut |simulation, _| {
            files.as_mut().map_or(Ok(()), |files| files.write(simulation))
        })
    })?;
    let run = &outcome.record;
    write!(out, "{}", table(run))?;
    let ratio = final_ratio(run);
    writeln!(
        out,
        "at the end friction is {ratio:.4} times the normal force; the coefficient is {COEFFICIENT}"
    )?;
    writeln!(out, "{}", warnings(&[run]))?;
    if let Some(folder) = &folder {
        save(&folder.join("steps.csv"), &csv(run)?)?;
        save(&folder.join("steps.svg"), &steps_chart(run)?)?;
    }
    if let Some(path) = &common.json {
        write_json(path, &[run])?;
    }
    strict(common.strict, std::iter::once(run))?;
    Ok(outcome)
}

/// Friction force over normal force at the end.
pub fn final_ratio(run: &RunRecord) -> f64 {
    run.steps.last().map_or(f64::NAN, |s| {
        s.tangential_force[0].hypot(s.tangential_force[1]) / s.normal_force
    })
}

fn table(run: &RunRecord) -> String {
    let heads = [
        ["time", "s"],
        ["products", "with F"],
        ["nodes", "stick"],
        ["nodes", "slide"],
        ["normal", "N"],
        ["friction", "N"],
        ["friction /", "normal"],
        ["", "certificate"],
    ];
    let row = |s: &signorini_studies::record::StepRecord| {
        vec![
            format!("{:.3}", s.t),
            s.n_m.to_string(),
            s.stick.to_string(),
            s.slip.to_string(),
            format!("{:.3e}", s.normal_force),
            format!("{:.3e}", s.tangential_force[0]),
            format!("{:.4}", s.tangential_force[0] / s.normal_force),
            format!("{:.1e}", s.certificate),
        ]
    };
    aligned(&heads, &run.steps.iter().map(row).collect::<Vec<_>>())
}
