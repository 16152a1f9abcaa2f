//! The brick benchmark: quasistatic contact with Coulomb friction, its table beside the paper's; `--help` lists the
//! options.

mod dependence;
mod pictures;
mod table;

use std::fmt::Write as _;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

use clap::Parser;
use signorini::contact::Plan;
use signorini::contact::result::Resultant;
use signorini::prelude::{Communicator, Scene, Simulation};
use signorini::tfeti::Alone;
use signorini_studies::brick::{Block, CELLS, Loading, STEPS, sizes};
use signorini_studies::files::RunFiles;
use signorini_studies::options::{Common, FormulaName, LoadingChoice, positive};
use signorini_studies::record::{RunRecord, csv, steps_chart, write_json};
use signorini_studies::run::{Outcome, pool, run_with, strict, warnings};
use signorini_studies::{Failure, exit, save};

/// Amplitude of the displaced inner nodes of `--perturb`, relative to a cell.
const PERTURBATION: f64 = 0.1;

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
    /// Order of the elements: 1 (linear tetrahedra) or 2 (quadratic ones, best with --cells 2 or 3).
    #[arg(long, value_name = "ORDER", default_value_t = 1, value_parser = order)]
    pub order: usize,
    /// Displace inner nodes at random, so that no two subdomains share matrices.
    #[arg(long)]
    pub perturb: bool,
    /// Write pictures, CSV files and VTU series into this folder; without it, pictures and CSV go into out/brick.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// With --out: write a VTU file at every K-th step and at the last; 0 writes none.
    #[arg(long, value_name = "K", default_value_t = 1)]
    pub vtu_every: usize,
    /// Print what supports, floor and loads do to the body at the end; with --out: write the reactions at its nodes,
    /// too.
    #[arg(long)]
    pub reactions: bool,
    /// Draw products and seconds against the size into this SVG file.
    #[arg(long, value_name = "FILE")]
    pub chart: Option<PathBuf>,
    /// Print the plan only.
    #[arg(long)]
    pub plan: bool,
    /// What all studies have.
    #[command(flatten)]
    pub common: Common,
}

impl BrickOptions {
    fn scene(&self, n: usize, loading: Loading) -> Result<Scene, Failure> {
        let block = Block {
            cells: [self.common.cells; 3],
            order: self.order,
            steps: self.steps,
            formula: self.formula.formula().0,
            perturbation: if self.perturb { PERTURBATION } else { 0.0 },
            ..Block::benchmark(n, loading)
        };
        block.scene()
    }

    /// Whether the runs are the benchmark as it stands, so that the paper's counts are comparable.
    fn is_standard(&self) -> bool {
        let sizes = (self.common.cells, self.steps) == (CELLS, STEPS);
        sizes && self.formula == FormulaName::ThreeStep && !self.perturb && self.order == 1
    }
}

/// Reads the order of the elements.
fn order(text: &str) -> Result<usize, String> {
    match text {
        "1" => Ok(1),
        "2" => Ok(2),
        _ => Err("elements have order 1 or 2".into()),
    }
}

/// Not used by the tests, which call [`execute`].
#[allow(dead_code)]
fn main() -> ExitCode {
    exit(execute(&BrickOptions::parse(), &mut std::io::stdout()))
}

/// Runs all sizes and loadings and prints what they show. With `--plan`, nothing is run and nothing returned.
pub fn execute(options: &BrickOptions, out: &mut impl Write) -> Result<Vec<Outcome>, Failure> {
    execute_on(options, Arc::new(Alone), out)
}

/// The same on several processes, of which rank 0 prints and writes.
pub fn execute_on(
    options: &BrickOptions,
    communicator: Arc<dyn Communicator>,
    out: &mut impl Write,
) -> Result<Vec<Outcome>, Failure> {
    let root = communicator.rank() == 0;
    if options.plan && !root {
        return Ok(Vec::new());
    }
    if options.plan {
        plan(options, out)?;
        return Ok(Vec::new());
    }
    let common = &options.common;
    let pool = pool(common.threads)?;
    let folder = options.out.clone().unwrap_or(PathBuf::from("out/brick"));
    let every = if options.out.is_some() { options.vtu_every } else { 0 };
    let mut outcomes = Vec::new();
    let mut forces = String::new();
    for &n in &options.n {
        for &loading in options.loading.loadings() {
            let scene = options.scene(n, loading)?;
            let mut header = common.header(n, loading.name(), options.formula.formula().1);
            header.progress &= root;
            let own = folder.join(header.label());
            let mut files = RunFiles::new(&own, every, options.reactions);
            let mut on_step = |simulation: &Simulation, _: &_| {
                if options.reactions && simulation.is_finished() {
                    forces += &reactions(&header.label(), simulation)?;
                }
                files.write(simulation)
            };
            let settings = common.settings().with_communicator(communicator.clone());
            let outcome = pool.install(|| run_with(scene, settings, &header, &mut on_step))?;
            if root {
                save(&own.join("steps.csv"), &csv(&outcome.record)?)?;
                save(&own.join("steps.svg"), &steps_chart(&outcome.record)?)?;
            }
            outcomes.push(outcome);
        }
    }
    if !root {
        return Ok(outcomes);
    }
    report(options, &outcomes, out)?;
    write!(out, "{forces}")?;
    let records: Vec<&RunRecord> = outcomes.iter().map(|o| &o.record).collect();
    if let Some(path) = &common.json {
        write_json(path, &records)?;
    }
    for group in outcomes.chunk_by(|a, b| a.record.n == b.record.n) {
        for (name, picture) in pictures::bodies(group) {
            save(&folder.join(format!("{name}-n{}.svg", group[0].record.n)), &picture)?;
        }
    }
    writeln!(out, "pictures (SVG) and steps.csv of each run: {}", folder.display())?;
    if let Some(path) = &options.chart {
        save(path, &pictures::growth(&records, options.is_standard())?)?;
    }
    strict(common.strict, records.into_iter())?;
    Ok(outcomes)
}

fn plan(options: &BrickOptions, out: &mut impl Write) -> Result<(), Failure> {
    let loading = options.loading.loadings()[0];
    for &n in &options.n {
        let scene = options.scene(n, loading)?;
        let settings = options.common.settings();
        let (plan, s) = (Plan::new(&scene, &settings)?, sizes(&scene, &settings)?);
        writeln!(out, "n = {n}\n{plan}")?;
        writeln!(
            out,
            "  n_s {}, n_p {}, n_d {} (full rank), {} as the paper counts\n",
            s.n_s, s.n_p, s.n_d, s.n_d_paper
        )?;
    }
    Ok(())
}

fn report(options: &BrickOptions, outcomes: &[Outcome], out: &mut impl Write) -> Result<(), Failure> {
    let records: Vec<&RunRecord> = outcomes.iter().map(|o| &o.record).collect();
    let Some(first) = records.first() else {
        return Ok(());
    };
    writeln!(
        out,
        "\nbrick, method {}, {} steps ({}), tolerance {:e}, H/h = {}, {} threads\n",
        first.method_name(),
        options.steps,
        first.formula,
        first.tolerance,
        first.cells,
        first.threads
    )?;
    write!(out, "{}", table::table(&records))?;
    if options.is_standard() {
        writeln!(out, "{}", table::verdict(&records))?;
    } else {
        let why = "steps, cells, formula, elements or mesh differ";
        writeln!(
            out,
            "This is not the benchmark as it stands ({why}): the paper's counts are of other work."
        )?;
    }
    for pair in outcomes.chunk_by(|a, b| a.record.n == b.record.n) {
        if let [first, second] = pair
            && let Some(text) = dependence::dependence(first, second)
        {
            writeln!(out, "final state depends on the loading, {text}")?;
        }
    }
    write!(out, "{}", warnings(&records))?;
    Ok(())
}

/// The forces on the body, and their moments about the origin, at the last step.
fn reactions(label: &str, simulation: &Simulation) -> Result<String, Failure> {
    let result = simulation.result().ok_or("no step is solved yet")?;
    let reactions = result.reactions();
    let mut text = format!(
        "{label} at {} s, on the body: forces along x, y, z in N and moments about the axes in N m\n",
        result.time()
    );
    let mut line = |name: &str, r: &Resultant| {
        let ([x, y, z], [a, b, c]) = (r.force, r.moment);
        let _ = writeln!(
            text,
            "  {name:12} {x:>12.4e} {y:>12.4e} {z:>12.4e}   {a:>12.4e} {b:>12.4e} {c:>12.4e}"
        );
    };
    for (k, support) in reactions.supports.iter().enumerate() {
        line(&format!("support {k}"), &support.resultant);
    }
    line("floor", &reactions.contact);
    line("loads", &reactions.loads);
    line("sum", &reactions.imbalance());
    Ok(text)
}
