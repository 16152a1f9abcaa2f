//! Only what the scene calls for: one brick, its effects switched on one by one, each beside the plan's prediction; then
//! the estimate against the truth on the benchmark.

mod cases;
pub mod shapes;
pub mod table;

use std::io::Write;
use std::path::PathBuf;

use clap::Parser;
use serde::Serialize;
use signorini::contact::{Rate, StepResult};
use signorini::prelude::*;

use crate::brick::{Benchmark, CELLS, Loading, STEPS};
use crate::error::ExampleError;
use crate::run::pool;
pub use cases::{Case, Extra, cases};

/// Options of the `effects` example.
#[derive(Debug, Clone, Parser)]
#[command(
    name = "effects",
    about = "What each effect costs, beside the plan's prediction"
)]
pub struct EffectsOptions {
    /// Coarse mesh, few steps, benchmark with n = 1 only: seconds, for a first look.
    #[arg(long)]
    pub short: bool,
    /// Sizes of the benchmark for which the estimate is compared with the truth.
    #[arg(long, value_delimiter = ',', default_value = "1,2,3")]
    pub n: Vec<usize>,
    /// Threads; 0 takes all cores.
    #[arg(long, default_value_t = 1)]
    pub threads: usize,
    /// Write the results to this file as JSON.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

/// What a plan promises, or what a run needed.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Cost {
    /// Rows of N: one a contact node.
    pub normal_rows: usize,
    /// Rows of T.
    pub tangential_rows: usize,
    /// Rows that glue subdomains.
    pub interface_rows: usize,
    /// Rows of supports.
    pub support_rows: usize,
    /// Bytes of inverses, coarse factor and tables.
    pub bytes: u64,
    /// Numeric factorisations of the set-up; of a run those that it made.
    pub factorisations: usize,
    /// Products with F in all levels; of a plan those that are likely.
    pub products: usize,
    /// The range of a plan; the same number twice for a run.
    pub range: [usize; 2],
    /// Seconds of the set-up.
    pub setup_seconds: f64,
    /// Seconds of all levels.
    pub solve_seconds: f64,
}

impl Cost {
    /// All rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.normal_rows + self.tangential_rows + self.interface_rows + self.support_rows
    }
}

/// One run beside its plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Line {
    /// The effect that is new, or the benchmark's size.
    pub name: String,
    /// Time levels.
    pub levels: usize,
    /// The plan.
    pub plan: Cost,
    /// The truth.
    pub truth: Cost,
    /// Bytes of the state between levels.
    pub state_bytes: usize,
    /// Entries into an inequality solver.
    pub inequality_solves: usize,
    /// Times the slip bounds were rewritten.
    pub slip_bound_updates: usize,
    /// Times slip rates were computed.
    pub rate_updates: usize,
    /// Levels that the default method handed to SMALSE.
    pub fallbacks: usize,
    /// Levels that did not converge.
    pub unconverged: usize,
    /// Seconds of stresses or error estimates.
    pub extra_seconds: f64,
    /// Largest certificate.
    pub certificate: f64,
    /// Forces of all contact points at all levels, N; for comparisons.
    #[serde(skip)]
    pub forces: Vec<f64>,
}

/// Everything measured.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Results {
    /// Effects switched on one by one.
    pub effects: Vec<Line>,
    /// Other shapes, materials, supports and settings.
    pub shapes: Vec<Line>,
    /// The benchmark, loading c, for the sizes asked for.
    pub benchmark: Vec<Line>,
}

/// Runs everything and prints the tables in Markdown.
///
/// # Errors
/// [`ExampleError`] of the library or of a file.
pub fn execute(options: &EffectsOptions, out: &mut impl Write) -> Result<Results, ExampleError> {
    let pool = pool(options.threads)?;
    let rate = Rate::measure();
    let (cells, steps) = if options.short { (2, 4) } else { (CELLS, 10) };
    let mut results = Results {
        effects: Vec::new(),
        shapes: Vec::new(),
        benchmark: Vec::new(),
    };
    for case in cases(cells, steps)? {
        let line = pool.install(|| measure(&case, rate))?;
        results.effects.push(line);
    }
    table::effects(&results.effects, out)?;
    let sizes: &[usize] = if options.short { &[1] } else { &options.n };
    let steps = if options.short { 8 } else { STEPS };
    for &n in sizes {
        let benchmark = Benchmark {
            cells,
            steps,
            ..Benchmark::new(n, Loading::C)
        };
        let case = Case {
            name: format!("n = {n}"),
            scene: benchmark.scene()?,
            settings: Settings::default(),
            extra: Extra::None,
        };
        let line = pool.install(|| measure(&case, rate))?;
        results.benchmark.push(line);
    }
    table::estimates(&results.benchmark, rate, out)?;
    let mut others = shapes::shapes()?;
    others.extend(shapes::accuracies()?);
    for case in &others {
        let line = pool.install(|| measure(case, rate))?;
        results.shapes.push(line);
    }
    table::shapes(&results.shapes, out)?;
    if let Some(path) = &options.json {
        let mut text = serde_json::to_string_pretty(&results)?;
        text.push('\n');
        std::fs::write(path, text).map_err(ExampleError::write(path))?;
    }
    Ok(results)
}

/// Runs one scene beside its plan.
///
/// # Errors
/// [`ExampleError`] of the library.
pub fn measure(case: &Case, rate: Rate) -> Result<Line, ExampleError> {
    let plan = Plan::new(&case.scene, &case.settings)?.with_machine(rate);
    let mut simulation = Simulation::new(case.scene.clone(), case.settings.clone())?;
    let (mut solve, mut extra) = (0.0, 0.0);
    let factorisations = simulation.tfeti().report().factorisations;
    let (mut certificate, mut forces) = (0.0_f64, Vec::new());
    let (mut fallbacks, mut unconverged) = (0, 0);
    while !simulation.is_finished() {
        let start = std::time::Instant::now();
        let frame = simulation.step()?;
        solve += start.elapsed().as_secs_f64();
        let start = std::time::Instant::now();
        compute(case.extra, &frame)?;
        if case.extra != Extra::None {
            extra += start.elapsed().as_secs_f64();
        }
        certificate = certificate.max(frame.certificate().largest());
        fallbacks += usize::from(frame.report().fallback);
        unconverged += usize::from(!frame.report().status.converged());
        let force = |p: &PointState| std::iter::once(p.normal_force).chain(p.friction_force);
        forces.extend(frame.points().iter().flat_map(force));
    }
    let (counters, setup) = (simulation.counters(), simulation.tfeti().report());
    Ok(Line {
        name: case.name.clone(),
        levels: plan.levels,
        plan: Cost {
            normal_rows: plan.normal_rows,
            tangential_rows: plan.tangential_rows,
            interface_rows: plan.interface_rows,
            support_rows: plan.dirichlet_rows,
            bytes: plan.estimate.setup_bytes(),
            factorisations: plan.estimate.factorisations,
            products: plan.estimate.products,
            range: [plan.estimate.fewest_products, plan.estimate.most_products],
            setup_seconds: plan.estimate.setup_seconds(),
            solve_seconds: plan.estimate.solve_seconds(),
        },
        truth: Cost {
            normal_rows: setup.rows.normal.len(),
            tangential_rows: setup.rows.tangential().len(),
            interface_rows: setup.rows.interface.len(),
            support_rows: setup.rows.dirichlet.len(),
            bytes: setup.inverse_bytes + setup.coarse_bytes + setup.table_bytes,
            factorisations,
            products: counters.products,
            range: [counters.products; 2],
            setup_seconds: simulation.setup_time().as_secs_f64(),
            solve_seconds: solve,
        },
        state_bytes: simulation.state().memory(),
        inequality_solves: counters.inequality_solves,
        slip_bound_updates: counters.slip_bound_updates,
        rate_updates: counters.rate_updates,
        fallbacks,
        unconverged,
        extra_seconds: extra,
        certificate,
        forces,
    })
}

fn compute(extra: Extra, frame: &StepResult<'_>) -> Result<(), ExampleError> {
    match extra {
        Extra::None => {}
        Extra::Stress => {
            frame.stress()?;
        }
        Extra::Errors => {
            let _ = frame.algebraic_error().relative();
            let _ = frame.discretisation_error()?.relative();
        }
    }
    Ok(())
}
