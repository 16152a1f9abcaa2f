//! Work-precision data: error against products and time, for everything that a user can choose.
//!
//! | study | what varies | reference |
//! |---|---|---|
//! | `tolerance` | tolerance of the solver, for three methods | same mesh and steps, 1e-12, other preconditioner, no extrapolation |
//! | `mesh` | cell size, at fixed H/h and at fixed H | a mesh with half the smallest cells or less |
//! | `time` | time step, for two difference formulas | backward Euler with 16 times the most steps |
//! | `method` | solver and preconditioner on a larger brick | as `tolerance` |
//! | `effects` | what the scene contains | the scene with all effects, tolerance 1e-10 |
//!
//! Errors are relative: displacement in the energy norm and contact forces at the end, work of friction in all steps.
//! Forces are compared node by node on one mesh, by their resultant between meshes.

mod measure;
mod studies;
mod table;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Parser, ValueEnum};
use measure::Errors;
use serde::Serialize;
use signorini::fem_mesh::output::{Field, write_vtu};
use signorini::prelude::*;
use signorini_studies::brick::{Block, EULER, Loading};
use signorini_studies::chart::{self, Chart};
use signorini_studies::run::pool;
use signorini_studies::{Failure, exit, save};

#[allow(dead_code)]
fn main() -> ExitCode {
    exit(execute(&AccuracyOptions::parse(), &mut std::io::stdout()))
}

/// The studies, in the order in which they run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Study {
    /// Tolerance of the solver.
    Tolerance,
    /// Size of the cells.
    Mesh,
    /// Time step.
    Time,
    /// Solver and preconditioner.
    Method,
    /// Effects of the scene.
    Effects,
}

impl Study {
    /// Name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tolerance => "tolerance",
            Self::Mesh => "mesh",
            Self::Time => "time",
            Self::Method => "method",
            Self::Effects => "effects",
        }
    }
}

/// Options of `accuracy`.
#[derive(Debug, Clone, PartialEq, Parser)]
#[command(
    name = "accuracy",
    about = "What accuracy costs in time: error against products and seconds"
)]
pub struct AccuracyOptions {
    /// Small scenes and few points: a few seconds.
    #[arg(long)]
    pub short: bool,
    /// Studies to run; all if none is named.
    #[arg(long, value_enum, value_delimiter = ',')]
    pub study: Vec<Study>,
    /// Write accuracy.csv, accuracy.json, one SVG a study and discretisation-error.vtu into this folder.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Threads; 0 takes all cores.
    #[arg(long, default_value_t = 1)]
    pub threads: usize,
}

/// One run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sample {
    /// What is varied along the curve: tolerance, cell size or time step.
    pub parameter: f64,
    /// Products with F.
    pub products: usize,
    /// Set-up, s.
    pub setup_seconds: f64,
    /// Solving, s, without set-up: the shortest of up to five runs.
    pub seconds: f64,
    /// Distance to the reference.
    pub errors: Errors,
    /// Largest certificate of all steps.
    pub certificate: f64,
    /// Steps that did not reach what was asked for.
    pub unconverged: usize,
    /// An estimate of the relative error at the end in the energy norm that needs no reference: the library's of the
    /// algebraic error for a tolerance, of the discretisation error for a mesh; step doubling for a time step.
    pub estimate: Option<f64>,
}

/// Runs that differ in one parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Curve {
    /// The study.
    pub study: Study,
    /// What the curve stands for.
    pub name: String,
    /// What the parameter is.
    pub parameter: &'static str,
    /// What the errors are distances to.
    pub reference: String,
    /// The runs.
    pub samples: Vec<Sample>,
    /// Measured order in the parameter, of displacement, force and work.
    pub orders: Errors,
}

/// Runs the studies, prints their tables and writes files.
pub fn execute(options: &AccuracyOptions, out: &mut impl Write) -> Result<Vec<Curve>, Failure> {
    let pool = pool(options.threads)?;
    let chosen = match options.study.as_slice() {
        [] => Study::value_variants(),
        some => some,
    };
    let mut curves = Vec::new();
    for &study in chosen {
        let found = pool.install(|| studies::run(study, options.short))?;
        write!(out, "{}", table::text(study, &found))?;
        out.flush()?;
        if let Some(folder) = &options.out {
            save(
                &folder.join(format!("accuracy-{}.svg", study.name())),
                &draw(study, &found)?,
            )?;
        }
        curves.extend(found);
    }
    if let Some(folder) = &options.out {
        save(&folder.join("accuracy.csv"), &table::csv(&curves)?)?;
        save(&folder.join("accuracy.json"), &serde_json::to_string_pretty(&curves)?)?;
        write_field(&folder.join("discretisation-error.vtu"), options.short)?;
        writeln!(out, "written to {}", folder.display())?;
    }
    Ok(curves)
}

/// A name and a number of a sample.
type Value = (&'static str, fn(&Sample) -> f64);

/// Error against cost on logarithmic axes: displacement, force and work side by side; products above, seconds below.
fn draw(study: Study, curves: &[Curve]) -> Result<String, Failure> {
    let along = match study {
        Study::Mesh => "Curves run along the cell size.",
        Study::Time => "Curves run along the time step.",
        Study::Effects => "One point for each scene.",
        Study::Tolerance | Study::Method => "Curves run along the tolerance.",
    };
    let costs: [Value; 2] = [
        ("products with F", |s| s.products as f64),
        ("seconds, set-up apart", |s| s.seconds),
    ];
    let errors: [Value; 3] = [
        ("displacement", |s| s.errors.u),
        ("contact force", |s| s.errors.force),
        ("work of friction", |s| s.errors.work),
    ];
    let mut charts = Vec::new();
    for (cost_name, cost) in costs {
        for (error_name, error) in errors {
            let points = |c: &Curve| c.samples.iter().map(|s| (cost(s), error(s))).collect::<Vec<_>>();
            let line = |(k, c): (usize, &Curve)| chart::Curve::new(&c.name, k, points(c));
            charts.push(Chart {
                title: String::new(),
                axes: [cost_name, error_name].map(str::to_owned),
                log: [true; 2],
                marks: true,
                legend: false,
                curves: curves.iter().enumerate().map(line).collect(),
            });
        }
    }
    let heading = format!("Study {}: relative error against cost. {along}", study.name());
    chart::page((1080, 640), [2, 3], &heading, &charts)
}

/// Solves the brick pressed on the floor and writes displacement, estimated error energies (J) and error stresses (Pa).
fn write_field(path: &Path, short: bool) -> Result<(), Failure> {
    let (n, cells) = if short { (1, 2) } else { (2, 5) };
    let block = Block {
        cells: [cells; 3],
        steps: 4,
        formula: EULER,
        floor: Some(Friction::coulomb(0.3)),
        ..Block::benchmark(n, Loading::B)
    };
    let mut simulation = Simulation::new(block.scene()?, Settings::default())?;
    simulation.run(&mut Silent)?.require_converged()?;
    let result = simulation.result().ok_or("no step is solved yet")?;
    let error = result.discretisation_error()?;
    let scene = simulation.scene();
    let stress = error.stress_errors(scene.mesh(), scene.materials())?;
    let points = [Field::vector("displacement", &result.displacement())];
    let cells = [
        Field::scalar("error_energy", error.energies.clone()),
        Field::scalar("error_stress", stress),
    ];
    Ok(write_vtu(path, scene.mesh(), &points, &cells)?)
}
