//! Options of the command lines.

use std::path::PathBuf;

use clap::{Args, Parser, ValueEnum};
use signorini::contact::MethodKind;
use signorini::prelude::{DifferenceFormula, Method, Settings};

use crate::brick::{Benchmark, CELLS, Loading, PERTURBATION, STEPS};

/// Solver of a time level.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MethodName {
    /// The library's default: predicted faces.
    Face,
    /// The paper's: given-friction problems by SMALSE, repeated.
    Paper,
    /// The paper's one inexact loop.
    OneLoop,
}

impl MethodName {
    /// The method with its default settings.
    #[must_use]
    pub fn method(self) -> Method {
        match self {
            Self::Face => Method::default(),
            Self::Paper => Method::paper(),
            Self::OneLoop => Method::one_loop(),
        }
    }

    /// What the method's outer iterations are.
    #[must_use]
    pub fn iterations(self) -> &'static str {
        match self {
            Self::Face => "faces",
            Self::Paper => "auxiliary problems",
            Self::OneLoop => "outer steps",
        }
    }
}

/// A method as tables and files name it, since their first version: those of [`MethodName`], and `linear`.
#[must_use]
pub fn name_in_files(kind: MethodKind) -> String {
    match kind {
        MethodKind::ActiveSet => "face".to_owned(),
        other => other.to_string(),
    }
}

/// Difference formula of the quasistatic steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FormulaName {
    /// The paper's 3/2, -2, 1/2.
    ThreeStep,
    /// 1, -1, 0.
    BackwardEuler,
}

impl FormulaName {
    /// The formula.
    #[must_use]
    pub fn formula(self) -> DifferenceFormula {
        match self {
            Self::ThreeStep => DifferenceFormula::PAPER,
            Self::BackwardEuler => DifferenceFormula::BACKWARD_EULER,
        }
    }

    /// As on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::ThreeStep => "three-step",
            Self::BackwardEuler => "backward-euler",
        }
    }
}

/// Which loading histories are run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum LoadingChoice {
    /// One ramp.
    B,
    /// Up, down and up.
    C,
    /// Both, one after the other.
    Both,
}

impl LoadingChoice {
    /// The loadings in order.
    #[must_use]
    pub fn loadings(self) -> &'static [Loading] {
        match self {
            Self::B => &Loading::BOTH[..1],
            Self::C => &Loading::BOTH[1..],
            Self::Both => &Loading::BOTH,
        }
    }
}

/// Options of every example that runs a simulation.
#[derive(Debug, Clone, PartialEq, Args)]
pub struct Common {
    /// Solver of a time level.
    #[arg(long, value_enum, default_value = "face")]
    pub method: MethodName,
    /// Relative tolerance of every level.
    #[arg(long, default_value_t = 1e-6)]
    pub tolerance: f64,
    /// Threads; 0 takes all cores.
    #[arg(long, default_value_t = 0)]
    pub threads: usize,
    /// Cells along the edge of a subdomain, H/h.
    #[arg(long, default_value_t = CELLS, value_parser = positive)]
    pub cells: usize,
    /// Write the results to this file as JSON.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// No progress bar.
    #[arg(long)]
    pub quiet: bool,
    /// End with exit code 1 if a level did not reach the tolerance.
    #[arg(long)]
    pub strict: bool,
}

impl Common {
    /// Settings of the library.
    #[must_use]
    pub fn settings(&self) -> Settings {
        Settings::default()
            .with_method(self.method.method())
            .with_tolerance(self.tolerance)
    }
}

/// Options of `brick`.
#[derive(Debug, Clone, PartialEq, Parser)]
#[command(
    name = "brick",
    about = "The brick benchmark: quasistatic contact with Coulomb friction, its table beside the paper's"
)]
pub struct BrickOptions {
    /// Sizes: 3n x n x n subdomains each.
    #[arg(long, value_delimiter = ',', default_value = "1,2,3", value_parser = positive)]
    pub n: Vec<usize>,
    /// Loading history at the free end.
    #[arg(long, value_enum, default_value = "both")]
    pub loading: LoadingChoice,
    /// Equal time steps in one second.
    #[arg(long, default_value_t = STEPS, value_parser = positive)]
    pub steps: usize,
    /// Difference formula.
    #[arg(long, value_enum, default_value = "three-step")]
    pub formula: FormulaName,
    /// Displace inner nodes at random, so that no two subdomains share matrices.
    #[arg(long)]
    pub perturb: bool,
    /// Write pictures, VTU series and CSV files into this folder.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// With --out: write a VTU file at every K-th step and at the last; 0 writes none.
    #[arg(long, value_name = "K", default_value_t = 1)]
    pub vtu_every: usize,
    /// Print what supports, floor and loads do to the body at the end; with --out: write the reactions at its nodes, too.
    #[arg(long)]
    pub reactions: bool,
    /// Draw products and seconds against the size into this SVG file.
    #[arg(long, value_name = "FILE")]
    pub chart: Option<PathBuf>,
    /// Print the plan only.
    #[arg(long)]
    pub plan: bool,
    /// What all examples have.
    #[command(flatten)]
    pub common: Common,
}

impl BrickOptions {
    /// The scene for one size and loading.
    #[must_use]
    pub fn benchmark(&self, n: usize, loading: Loading) -> Benchmark {
        Benchmark {
            cells: self.common.cells,
            steps: self.steps,
            formula: self.formula.formula(),
            perturbation: if self.perturb { PERTURBATION } else { 0.0 },
            ..Benchmark::new(n, loading)
        }
    }
}

/// Options of `frictionless`.
#[derive(Debug, Clone, PartialEq, Parser)]
#[command(
    name = "frictionless",
    about = "The brick, static and without friction, beside the best existing code's products"
)]
pub struct FrictionlessOptions {
    /// Sizes: 3n x n x n subdomains each.
    #[arg(long, value_delimiter = ',', default_value = "1,2,3", value_parser = positive)]
    pub n: Vec<usize>,
    /// Pressure on the top, Pa.
    #[arg(long, default_value_t = 2.5e8)]
    pub traction: f64,
    /// What all examples have.
    #[command(flatten)]
    pub common: Common,
}

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
    /// What all examples have.
    #[command(flatten)]
    pub common: Common,
}

/// Options of `tresca`.
#[derive(Debug, Clone, PartialEq, Parser)]
#[command(
    name = "tresca",
    about = "Given friction: one quadratic program a time level, by two methods"
)]
pub struct TrescaOptions {
    /// Equal time steps in one second.
    #[arg(long, default_value_t = 5, value_parser = positive)]
    pub steps: usize,
    /// Cells along the edge of each of the three cubes.
    #[arg(long, default_value_t = 4, value_parser = positive)]
    pub cells: usize,
    /// Bound of the friction stress, Pa.
    #[arg(long, default_value_t = 3e7)]
    pub bound: f64,
    /// Relative tolerance of every level.
    #[arg(long, default_value_t = 1e-8)]
    pub tolerance: f64,
    /// Threads; 0 takes all cores.
    #[arg(long, default_value_t = 0)]
    pub threads: usize,
    /// Write the results to this file as JSON.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

/// A whole number from 1.
fn positive(text: &str) -> Result<usize, String> {
    match text.trim().parse::<usize>() {
        Ok(0) => Err("must be at least 1".to_owned()),
        Ok(value) => Ok(value),
        Err(e) => Err(e.to_string()),
    }
}
