//! Runs a scene level by level and collects the record.

use std::time::{Duration, Instant};

use signorini::prelude::{Scene, Settings, Simulation};

use crate::error::ExampleError;
use crate::record::{RunRecord, StepRecord};
use crate::snapshot::Snapshot;

/// Is told what a run does; writes files, shows progress.
pub trait Sink: Send {
    /// The set-up is done; `label` names the run.
    ///
    /// # Errors
    /// [`ExampleError`] ends the run.
    fn started(&mut self, label: &str, simulation: &Simulation) -> Result<(), ExampleError> {
        let _ = (label, simulation);
        Ok(())
    }

    /// A level is solved: `simulation.result()` has its fields.
    ///
    /// # Errors
    /// [`ExampleError`] ends the run.
    fn step(&mut self, simulation: &Simulation, step: &StepRecord) -> Result<(), ExampleError>;

    /// All levels are solved.
    ///
    /// # Errors
    /// [`ExampleError`] ends the run.
    fn finished(&mut self, record: &RunRecord) -> Result<(), ExampleError> {
        let _ = record;
        Ok(())
    }
}

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
}

impl Header {
    /// A name for files and progress bars.
    #[must_use]
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
///
/// # Errors
/// [`ExampleError::Threads`] if the system refuses.
pub fn pool(threads: usize) -> Result<rayon::ThreadPool, ExampleError> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|e| ExampleError::Threads {
            threads,
            reason: e.to_string(),
        })
}

/// Sets a scene up and solves all its levels. Time spent in the sinks is not counted.
///
/// # Errors
/// [`ExampleError`] of the library or of a sink. Not converging is no error: see the record.
pub fn run(
    scene: Scene,
    settings: Settings,
    header: &Header,
    sinks: &mut [&mut dyn Sink],
) -> Result<Outcome, ExampleError> {
    let mut simulation = Simulation::new(scene, settings)?;
    let label = header.label();
    for sink in sinks.iter_mut() {
        sink.started(&label, &simulation)?;
    }
    let mut solve = Duration::ZERO;
    let mut steps = Vec::with_capacity(simulation.plan().steps);
    while !simulation.is_finished() {
        let start = Instant::now();
        let frame = simulation.step()?;
        solve += start.elapsed();
        let step = StepRecord::new(&frame);
        for sink in sinks.iter_mut() {
            sink.step(&simulation, &step)?;
        }
        steps.push(step);
    }
    let record = collect(&simulation, header, solve, steps);
    for sink in sinks.iter_mut() {
        sink.finished(&record)?;
    }
    let snapshot = Snapshot::new(&simulation, &label, header)?;
    Ok(Outcome { record, snapshot })
}

fn collect(
    simulation: &Simulation,
    header: &Header,
    solve: Duration,
    steps: Vec<StepRecord>,
) -> RunRecord {
    let counters = simulation.counters();
    let gluing = simulation.tfeti().gluing();
    let setup = simulation.tfeti().report();
    RunRecord {
        n: header.n,
        loading: header.loading.clone(),
        method: crate::options::name_in_files(simulation.plan().method),
        threads: rayon::current_num_threads(),
        n_s: simulation.plan().subdomains,
        n_p: simulation.plan().primal,
        n_d: gluing.rows_full_rank(),
        n_d_paper: gluing.rows_as_paper(),
        it: steps.iter().map(|s| s.it).sum(),
        n_m: counters.products,
        n_m_setup: counters.setup_products,
        setup_seconds: simulation.setup_time().as_secs_f64(),
        solve_seconds: solve.as_secs_f64(),
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
        unconverged: steps
            .iter()
            .filter(|s| !s.converged())
            .map(|s| s.step)
            .collect(),
        steps,
    }
}

/// Largest resident memory of this process in bytes; 0 where the system does not tell.
#[must_use]
pub fn peak_memory() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    let kib = line
        .and_then(|l| l.split_whitespace().next())
        .and_then(|v| v.parse::<u64>().ok());
    kib.map_or(0, |k| 1024 * k)
}
