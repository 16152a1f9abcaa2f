//! Runs a scene step by step and collects the record.

use std::fmt::Write as _;
use std::io::{IsTerminal, Write as _};
use std::time::Instant;

use signorini::prelude::{Scene, Settings, Simulation};

use crate::Failure;
use crate::options::name_in_files;
use crate::record::{RunRecord, StepRecord};
use crate::snapshot::Snapshot;

/// What a run is called in its record.
#[derive(Debug, Clone, PartialEq)]
pub struct Header {
    /// Subdomains along the short edges.
    pub n: usize,
    /// Loading or scene.
    pub loading: String,
    /// Cells along the edge of a subdomain.
    pub cells: usize,
    /// Difference formula.
    pub formula: String,
    /// The method's name of its outer iterations.
    pub it_name: String,
    /// Whether to write progress to the standard error stream.
    pub progress: bool,
}

impl Header {
    /// A name for files and progress.
    pub fn label(&self) -> String {
        format!("n{}-{}", self.n, self.loading)
    }
}

/// Result of a run.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// The numbers.
    pub record: RunRecord,
    /// The last state, for pictures and comparisons.
    pub snapshot: Snapshot,
}

/// Makes the pool in which runs take place; 0 threads means one a core.
pub fn pool(threads: usize) -> Result<rayon::ThreadPool, Failure> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let remedy = "use a smaller --threads";
    pool.map_err(|e| format!("cannot start {threads} threads: {e}; {remedy}").into())
}

/// Is called after each step, in which `simulation.result()` has its result.
pub type OnStep<'a> = dyn FnMut(&Simulation, &StepRecord) -> Result<(), Failure> + Send + 'a;

/// Solves all steps of a scene: the simulation at its end, its steps, and the seconds that they took, without
/// `on_step`. Not converging is no error: see the records.
pub fn solve(
    scene: Scene,
    settings: Settings,
    on_step: &mut OnStep<'_>,
) -> Result<(Simulation, Vec<StepRecord>, f64), Failure> {
    let mut simulation = Simulation::new(scene, settings)?;
    let (mut seconds, mut steps) = (0.0, Vec::new());
    while !simulation.is_finished() {
        let start = Instant::now();
        let result = simulation.step()?;
        seconds += start.elapsed().as_secs_f64();
        steps.push(StepRecord::new(&result));
        on_step(&simulation, &steps[steps.len() - 1])?;
    }
    Ok((simulation, steps, seconds))
}

/// Solves all steps of a scene and keeps what tables and pictures need.
pub fn run(scene: Scene, settings: Settings, header: &Header) -> Result<Outcome, Failure> {
    run_with(scene, settings, header, &mut |_, _| Ok(()))
}

/// [`run`], with something to do after each step.
pub fn run_with(
    scene: Scene,
    settings: Settings,
    header: &Header,
    on_step: &mut OnStep<'_>,
) -> Result<Outcome, Failure> {
    let (label, mut products) = (header.label(), 0);
    let shown = header.progress && std::io::stderr().is_terminal();
    let (simulation, steps, seconds) = solve(scene, settings, &mut |simulation, record| {
        products += record.n_m;
        if shown {
            let StepRecord { step, active, slip, .. } = record;
            eprint!("\r{label}: step {step}, {active} touch, {slip} slide, {products} products ");
            std::io::stderr().flush()?;
        }
        on_step(simulation, record)
    })?;
    let record = collect(&simulation, header, seconds, steps);
    if header.progress {
        let failed = match record.unconverged.len() {
            0 => String::new(),
            count => format!(", {count} NOT CONVERGED"),
        };
        let (steps, products) = (record.steps.len(), record.n_m);
        eprintln!("\r{label}: {steps} steps, {products} products, {seconds:.2} s{failed}           ");
    }
    let snapshot = Snapshot::new(&simulation, header)?;
    Ok(Outcome { record, snapshot })
}

fn collect(simulation: &Simulation, header: &Header, solve_seconds: f64, steps: Vec<StepRecord>) -> RunRecord {
    let (counters, plan) = (simulation.counters(), simulation.plan());
    let gluing = simulation.tfeti().gluing();
    let setup = simulation.tfeti().report();
    let unconverged = steps.iter().filter(|s| !s.converged());
    RunRecord {
        n: header.n,
        loading: header.loading.clone(),
        // the default's name in this file since there is one
        method: name_in_files(plan.method),
        threads: rayon::current_num_threads(),
        n_s: plan.subdomains,
        n_p: plan.primal,
        n_d: gluing.ranges().total(),
        n_d_paper: gluing.rows_as_paper(),
        it: steps.iter().map(|s| s.it).sum(),
        n_m: counters.products,
        n_m_setup: counters.setup_products,
        setup_seconds: simulation.setup_time().as_secs_f64(),
        solve_seconds,
        peak_rss_bytes: peak_memory(),
        it_name: header.it_name.clone(),
        cells: header.cells,
        tolerance: simulation.settings().tolerance(),
        formula: header.formula.clone(),
        faces: counters.active_sets,
        quadratic_programs: counters.quadratic_programs,
        preconditionings: counters.preconditionings,
        projections: counters.projections,
        coarse_factorisations: counters.coarse_factorisations,
        setup_bytes: setup.inverse_bytes + setup.coarse_bytes + setup.table_bytes,
        largest_certificate: steps.iter().map(|s| s.certificate).fold(0.0, f64::max),
        unconverged: unconverged.map(|s| s.step).collect(),
        steps,
    }
}

/// Largest resident memory of this process in bytes; 0 where the system does not tell.
fn peak_memory() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    let kib = line.and_then(|l| l.split_whitespace().next()?.parse::<u64>().ok());
    kib.map_or(0, |k| 1024 * k)
}

/// A loud line for each run with steps that did not reach the tolerance, and notes on what is unusual.
pub fn warnings(runs: &[&RunRecord]) -> String {
    let mut text = String::new();
    for run in runs {
        let name = format!("n = {}, {}", run.n, run.loading);
        if !run.unconverged.is_empty() {
            let (steps, tolerance) = (&run.unconverged, run.tolerance);
            let _ = writeln!(
                text,
                "WARNING: {name}: steps {steps:?} DID NOT REACH the tolerance {tolerance:e}; their states are the \
                 last iterates"
            );
            let mut history = run.steps.iter().filter_map(|s| s.unconverged_history);
            if let Some(first) = history.next() {
                let later = history.count() + 1;
                let _ = writeln!(text, "         the slip of {later} later steps depends on step {first}");
            }
        }
        let which = |what: &dyn Fn(&StepRecord) -> bool| -> Vec<usize> {
            run.steps.iter().filter(|s| what(s)).map(|s| s.step).collect()
        };
        let above = which(&|s| s.certificate > run.tolerance);
        if !above.is_empty() {
            let (largest, tolerance) = (run.largest_certificate, run.tolerance);
            let _ = writeln!(
                text,
                "note: {name}: certificate {largest:.1e} above the tolerance {tolerance:e}; steps {above:?}"
            );
        }
        let fallen = which(&|s| s.fallback);
        if !fallen.is_empty() {
            let _ = writeln!(
                text,
                "note: {name}: the active-set method handed steps {fallen:?} to SMALSE"
            );
        }
    }
    text
}

/// With `on`, an error if any step did not reach the tolerance.
pub fn strict<'a>(on: bool, mut runs: impl Iterator<Item = &'a RunRecord>) -> Result<(), Failure> {
    let steps: usize = runs.by_ref().map(|r| r.unconverged.len()).sum();
    if on && steps > 0 {
        Err(format!("{steps} steps did not reach the tolerance (--strict)").into())
    } else {
        Ok(())
    }
}
