//! Options that several studies have.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use signorini::prelude::{DifferenceFormula, Method, Settings};

use crate::brick::{CELLS, EULER, Loading, PAPER_FORMULA};
use crate::run::Header;

/// Solver of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MethodName {
    /// The library's default: predicted active sets.
    #[value(alias = "face")]
    ActiveSet,
    /// The paper's: Tresca problems by SMALSE, repeated.
    Paper,
    /// The paper's one inexact loop.
    OneLoop,
}

impl MethodName {
    /// The method with its default settings, and what its outer iterations are.
    pub fn method(self) -> (Method, &'static str) {
        match self {
            Self::ActiveSet => (Method::default(), "faces"),
            Self::Paper => (Method::paper(), "auxiliary problems"),
            Self::OneLoop => (Method::one_loop(), "outer steps"),
        }
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
    /// The formula, and its name on the command line.
    pub fn formula(self) -> (DifferenceFormula, &'static str) {
        match self {
            Self::ThreeStep => (PAPER_FORMULA, "three-step"),
            Self::BackwardEuler => (EULER, "backward-euler"),
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
    pub fn loadings(self) -> &'static [Loading] {
        match self {
            Self::B => &Loading::BOTH[..1],
            Self::C => &Loading::BOTH[1..],
            Self::Both => &Loading::BOTH,
        }
    }
}

/// Options of the studies that run one scene after the other.
#[derive(Debug, Clone, PartialEq, Args)]
pub struct Common {
    /// Solver of a step.
    #[arg(long, value_enum, default_value = "active-set")]
    pub method: MethodName,
    /// Relative tolerance of every step.
    #[arg(long, default_value_t = 1e-6)]
    pub tolerance: f64,
    /// Threads; 0 takes all cores.
    #[arg(long, default_value_t = 0)]
    pub threads: usize,
    /// Threads stay awake between the parallel parts of a step.
    #[arg(long)]
    pub busy_waiting: bool,
    /// Cells along the edge of a subdomain, H/h.
    #[arg(long, default_value_t = CELLS, value_parser = positive)]
    pub cells: usize,
    /// Write the results to this file as JSON.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// No progress.
    #[arg(long)]
    pub quiet: bool,
    /// End with exit code 1 if a step did not reach the tolerance.
    #[arg(long)]
    pub strict: bool,
}

impl Common {
    /// Settings of the library.
    pub fn settings(&self) -> Settings {
        Settings::default()
            .with_method(self.method.method().0)
            .with_tolerance(self.tolerance)
            .with_busy_waiting(self.busy_waiting)
    }

    /// The header of a run.
    pub fn header(&self, n: usize, loading: &str, formula: &str) -> Header {
        Header {
            n,
            loading: loading.to_owned(),
            cells: self.cells,
            formula: formula.to_owned(),
            it_name: self.method.method().1.to_owned(),
            progress: !self.quiet,
        }
    }
}

/// A whole number from 1.
pub fn positive(text: &str) -> Result<usize, String> {
    match text.trim().parse::<usize>() {
        Ok(0) => Err("must be at least 1".to_owned()),
        Ok(value) => Ok(value),
        Err(e) => Err(e.to_string()),
    }
}
