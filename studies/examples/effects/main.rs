//! Only what the scene calls for: one brick, its effects switched on one by one, each beside the plan's prediction;
//! then the plan against the truth on the benchmark and on other scenes. `--help` lists the options.

mod cases;
mod shapes;
mod table;

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use cases::{Case, Extra};
use clap::Parser;
use serde::Serialize;
use signorini::contact::{Plan, Rate, StepResult};
use signorini::prelude::PointState;
use signorini_studies::brick::{Block, CELLS, Loading, STEPS};
use signorini_studies::run::{pool, solve};
use signorini_studies::{Failure, exit, save};

/// Options of the `effects` example.
#[derive(Debug, Clone, Parser)]
#[command(name = "effects", about = "What each effect costs, beside the plan's prediction")]
pub struct EffectsOptions {
    /// Coarse mesh, few steps, benchmark with n = 1 only: seconds, for a first look.
    #[arg(long)]
    pub short: bool,
    /// Sizes of the benchmark for which the plan is compared with the truth.
    #[arg(long, value_delimiter = ',', default_value = "1,2,3")]
    pub n: Vec<usize>,
    /// Threads; 0 takes all cores.
    #[arg(long, default_value_t = 1)]
    pub threads: usize,
    /// Write the results to this file as JSON.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

#[allow(dead_code)]
fn main() -> ExitCode {
    exit(execute(&EffectsOptions::parse(), &mut std::io::stdout()))
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
    /// Numeric factorisations of the set-up; of a run with those of rebuilds.
    pub factorisations: usize,
    /// Products with F in all steps; of a plan those that are likely.
    pub products: usize,
    /// Seconds of the set-up.
    pub setup_seconds: f64,
    /// Seconds of all steps.
    pub solve_seconds: f64,
}

impl Cost {
    /// All rows.
    pub fn rows(&self) -> usize {
        self.normal_rows + self.tangential_rows + self.interface_rows + self.support_rows
    }
}

/// One run beside its plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Line {
    /// The effect that is new, or the benchmark's size.
    pub name: String,
    /// Time steps.
    #[serde(rename = "levels")]
    pub steps: usize,
    /// The plan.
    pub plan: Cost,
    /// The truth.
    pub truth: Cost,
    /// Bytes of the state between steps.
    pub state_bytes: usize,
    /// Entries into an inequality solver.
    pub inequality_solves: usize,
    /// Times the slip bounds were rewritten.
    pub slip_bound_updates: usize,
    /// Times slip rates were computed.
    pub rate_updates: usize,
    /// Steps that the default method handed to SMALSE.
    pub fallbacks: usize,
    /// Steps that did not converge.
    pub unconverged: usize,
    /// Seconds of stresses or error estimates.
    pub extra_seconds: f64,
    /// Largest certificate.
    pub certificate: f64,
    /// Forces of all contact points at all steps, N; for comparisons.
    #[serde(skip)]
    pub forces: Vec<f64>,
}

/// Everything measured.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Results {
    /// Effects switched on one by one.
    pub effects: Vec<Line>,
    /// The benchmark, loading c, for the sizes asked for.
    pub benchmark: Vec<Line>,
    /// Other shapes, materials, supports and settings.
    pub shapes: Vec<Line>,
}

/// Runs everything and prints the tables in Markdown.
pub fn execute(options: &EffectsOptions, out: &mut impl Write) -> Result<Results, Failure> {
    let pool = pool(options.threads)?;
    let rate = Rate::measure();
    let all = |cases: Vec<Case>| -> Result<Vec<Line>, Failure> {
        cases.iter().map(|case| pool.install(|| measure(case, rate))).collect()
    };
    let (cells, steps) = if options.short { (2, 4) } else { (CELLS, 10) };
    let effects = all(cases::cases(cells, steps)?)?;
    table::effects(&effects, out)?;

    let sizes: &[usize] = if options.short { &[1] } else { &options.n };
    let steps = if options.short { 8 } else { STEPS };
    let benchmark = |&n: &usize| {
        let block = Block {
            cells: [cells; 3],
            steps,
            ..Block::benchmark(n, Loading::C)
        };
        Ok(Case::new(format!("n = {n}"), block.scene()?))
    };
    let benchmark = all(sizes.iter().map(benchmark).collect::<Result<_, Failure>>()?)?;
    table::estimates(&benchmark, rate, out)?;

    let mut others = shapes::shapes()?;
    others.extend(shapes::accuracies()?);
    let shapes = all(others)?;
    table::shapes(&shapes, out)?;

    let results = Results {
        effects,
        benchmark,
        shapes,
    };
    if let Some(path) = &options.json {
        save(path, &(serde_json::to_string_pretty(&results)? + "\n"))?;
    }
    Ok(results)
}

/// Runs one scene beside its plan.
fn measure(case: &Case, rate: Rate) -> Result<Line, Failure> {
    let plan = Plan::new(&case.scene, &case.settings)?.with_machine(rate);
    let (mut extra, mut forces) = (0.0, Vec::new());
    let (scene, settings) = (case.scene.clone(), case.settings.clone());
    let (simulation, steps, solve) = solve(scene, settings, &mut |simulation, _| {
        let result = simulation.result().ok_or("no step is solved yet")?;
        let start = Instant::now();
        compute(case.extra, result)?;
        if case.extra != Extra::None {
            extra += start.elapsed().as_secs_f64();
        }
        let force = |p: &PointState| std::iter::once(p.normal_force).chain(p.friction_force);
        forces.extend(result.points().iter().flat_map(force));
        Ok(())
    })?;
    let (counters, setup) = (simulation.counters(), simulation.tfeti().report());
    let rows = simulation.tfeti().gluing().ranges();
    Ok(Line {
        name: case.name.clone(),
        steps: plan.steps,
        plan: Cost {
            normal_rows: plan.normal_rows,
            tangential_rows: plan.tangential_rows,
            interface_rows: plan.interface_rows,
            support_rows: plan.dirichlet_rows,
            bytes: plan.estimate.setup_bytes(),
            factorisations: plan.estimate.factorisations,
            products: plan.estimate.products,
            setup_seconds: plan.estimate.times.map_or(f64::NAN, |t| t.setup),
            solve_seconds: plan.estimate.times.map_or(f64::NAN, |t| t.steps),
        },
        truth: Cost {
            normal_rows: rows.normal.len(),
            tangential_rows: rows.tangential().len(),
            interface_rows: rows.interface.len(),
            support_rows: rows.dirichlet.len(),
            bytes: setup.inverse_bytes + setup.coarse_bytes + setup.table_bytes,
            factorisations: setup.factorisations,
            products: counters.products,
            setup_seconds: simulation.setup_time().as_secs_f64(),
            solve_seconds: solve,
        },
        state_bytes: simulation.state().memory(),
        inequality_solves: counters.inequality_solves,
        slip_bound_updates: counters.slip_bound_updates,
        rate_updates: counters.rate_updates,
        fallbacks: steps.iter().filter(|s| s.fallback).count(),
        unconverged: steps.iter().filter(|s| !s.converged()).count(),
        extra_seconds: extra,
        certificate: steps.iter().map(|s| s.certificate).fold(0.0, f64::max),
        forces,
    })
}

fn compute(extra: Extra, result: &StepResult) -> Result<(), Failure> {
    match extra {
        Extra::None => {}
        Extra::Stress => {
            let _ = result.stress();
        }
        Extra::Errors => {
            let _ = result.algebraic_error().relative();
            let _ = result.discretisation_error()?.relative();
        }
    }
    Ok(())
}
