//! Work-precision data: error against products and time, for everything that a user can choose.
//!
//! | study | what varies | reference |
//! |---|---|---|
//! | `tolerance` | tolerance of the solver, for three methods | the same mesh and steps, tolerance 1e-12, other preconditioner, no extrapolation |
//! | `mesh` | cell size, at fixed H/h and at fixed H | a mesh with half the smallest cells or less |
//! | `time` | time step, for two difference formulas | backward Euler with 16 times the most steps |
//! | `method` | solver and preconditioner on a larger brick | as `tolerance` |
//! | `effects` | what the scene contains | the scene with all effects, tolerance 1e-10 |
//!
//! Errors are relative: displacement in the energy norm and contact forces at the end, work of friction in all steps.
//! Forces are compared node by node on one mesh, by their resultant between meshes.

mod chart;
mod field;
mod measure;
mod scenes;
mod studies;
mod table;

use std::io::Write;
use std::path::PathBuf;

use clap::{Parser, ValueEnum};
use serde::Serialize;

use crate::error::ExampleError;
use crate::run::pool;
pub use measure::Errors;

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
    #[must_use]
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
    /// Largest certificate of all levels.
    pub certificate: f64,
    /// Levels that did not reach what was asked for.
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
///
/// # Errors
/// [`ExampleError`] of the library, or if a file cannot be written.
pub fn execute(
    options: &AccuracyOptions,
    out: &mut impl Write,
) -> Result<Vec<Curve>, ExampleError> {
    let pool = pool(options.threads)?;
    let all = Study::value_variants();
    let chosen: Vec<Study> = if options.study.is_empty() {
        all.to_vec()
    } else {
        options.study.clone()
    };
    if let Some(folder) = &options.out {
        std::fs::create_dir_all(folder).map_err(ExampleError::write(folder))?;
    }
    let mut curves = Vec::new();
    for study in chosen {
        let found = pool.install(|| studies::run(study, options.short))?;
        write!(out, "{}", table::text(study, &found))?;
        out.flush()?;
        if let Some(folder) = &options.out {
            let path = folder.join(format!("accuracy-{}.svg", study.name()));
            let picture = chart::draw(study, &found)?;
            std::fs::write(&path, picture).map_err(ExampleError::write(&path))?;
        }
        curves.extend(found);
    }
    if let Some(folder) = &options.out {
        field::write(&folder.join("discretisation-error.vtu"), options.short)?;
        let path = folder.join("accuracy.csv");
        std::fs::write(&path, table::csv(&curves)).map_err(ExampleError::write(&path))?;
        let path = folder.join("accuracy.json");
        let text = serde_json::to_string_pretty(&curves)?;
        std::fs::write(&path, text).map_err(ExampleError::write(&path))?;
        writeln!(out, "written to {}", folder.display())?;
    }
    Ok(curves)
}
