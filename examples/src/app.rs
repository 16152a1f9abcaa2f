//! The `brick` example: runs, table, files, pictures.

use std::io::Write;
use std::path::Path;

use signorini::contact::Plan;

use crate::brick::sizes;
use crate::dependence::Dependence;
use crate::error::ExampleError;
use crate::files::RunFiles;
use crate::options::BrickOptions;
use crate::pictures;
use crate::progress::Progress;
use crate::reactions::ReactionTable;
use crate::record::{RunRecord, write_json};
use crate::run::{Header, Outcome, Sink, pool, run};
use crate::table::{table, verdict, warnings};

/// Runs all sizes and loadings and prints what they show. With `--plan`, nothing is run and nothing returned.
///
/// # Errors
/// [`ExampleError`]: bad options, files that cannot be written, and with `--strict` levels that did not converge.
pub fn execute(options: &BrickOptions, out: &mut impl Write) -> Result<Vec<Outcome>, ExampleError> {
    if options.plan {
        plan(options, out)?;
        return Ok(Vec::new());
    }
    let pool = pool(options.common.threads)?;
    let mut outcomes = Vec::new();
    let mut forces = String::new();
    for &n in &options.n {
        for &loading in options.loading.loadings() {
            let scene = options.benchmark(n, loading).scene()?;
            let header = Header {
                n,
                loading: loading.name().to_owned(),
                cells: options.common.cells,
                formula: options.formula.name().to_owned(),
                it_name: options.common.method.iterations().to_owned(),
            };
            let mut progress = Progress::default();
            let mut files = options
                .out
                .as_ref()
                .map(|dir| RunFiles::new(dir, options.vtu_every).with_reactions(options.reactions));
            let mut sinks: Vec<&mut dyn Sink> = Vec::new();
            if !options.common.quiet {
                sinks.push(&mut progress);
            }
            if let Some(files) = &mut files {
                sinks.push(files);
            }
            let mut table = ReactionTable::default();
            if options.reactions {
                sinks.push(&mut table);
            }
            let settings = options.common.settings();
            outcomes.push(pool.install(|| run(scene, settings, &header, &mut sinks))?);
            forces.push_str(table.text());
        }
    }
    report(options, &outcomes, out)?;
    write!(out, "{forces}")?;
    let records = outcomes.iter().map(|o| &o.record);
    if let Some(path) = &options.common.json {
        write_json(path, records.clone())?;
    }
    if let Some(dir) = &options.out {
        draw(dir, &outcomes)?;
    }
    if let Some(path) = &options.chart {
        let records: Vec<&RunRecord> = records.clone().collect();
        save(path, &pictures::growth(&records, is_standard(options))?)?;
    }
    strict(options.common.strict, records)?;
    Ok(outcomes)
}

/// Whether the runs are the benchmark, but for its size.
fn is_standard(options: &BrickOptions) -> bool {
    let mut loadings = options.loading.loadings().iter();
    loadings.all(|&l| options.benchmark(1, l).is_standard())
}

fn plan(options: &BrickOptions, out: &mut impl Write) -> Result<(), ExampleError> {
    for &n in &options.n {
        let Some(&loading) = options.loading.loadings().first() else {
            continue;
        };
        let scene = options.benchmark(n, loading).scene()?;
        let settings = options.common.settings();
        let plan = Plan::new(&scene, &settings)?;
        let s = sizes(&scene, &settings)?;
        writeln!(out, "n = {n}\n{plan}")?;
        writeln!(
            out,
            "  n_s {}, n_p {}, n_d {} (full rank), {} as the paper counts\n",
            s.n_s, s.n_p, s.n_d, s.n_d_paper
        )?;
    }
    Ok(())
}

fn report(
    options: &BrickOptions,
    outcomes: &[Outcome],
    out: &mut impl Write,
) -> Result<(), ExampleError> {
    let records: Vec<&RunRecord> = outcomes.iter().map(|o| &o.record).collect();
    let Some(first) = records.first() else {
        return Ok(());
    };
    writeln!(
        out,
        "\nbrick, method {}, {} steps ({}), tolerance {:e}, H/h = {}, {} threads\n",
        first.method, options.steps, first.formula, first.tolerance, first.cells, first.threads
    )?;
    write!(out, "{}", table(&records))?;
    if is_standard(options) {
        writeln!(out, "{}", verdict(&records))?;
    } else {
        writeln!(
            out,
            "This is not the benchmark as it stands (steps, cells, formula or mesh differ): the paper's counts are of other work."
        )?;
    }
    for pair in outcomes.chunk_by(|a, b| a.record.n == b.record.n) {
        if let [first, second] = pair
            && let Some(dependence) = Dependence::new(first, second)
        {
            writeln!(out, "final state depends on the loading, {dependence}")?;
        }
    }
    write!(out, "{}", warnings(&records))?;
    Ok(())
}

fn draw(dir: &Path, outcomes: &[Outcome]) -> Result<(), ExampleError> {
    for outcome in outcomes {
        let label = &outcome.snapshot.label;
        let folder = dir.join(label);
        save(
            &folder.join("steps.svg"),
            &pictures::steps(&outcome.record)?,
        )?;
    }
    for group in outcomes.chunk_by(|a, b| a.record.n == b.record.n) {
        let snapshots: Vec<_> = group.iter().map(|o| &o.snapshot).collect();
        let n = group.first().map_or(0, |o| o.record.n);
        let name = |what: &str| dir.join(format!("{what}-n{n}.svg"));
        save(&name("brick"), &pictures::deformed(&snapshots))?;
        save(&name("friction"), &pictures::friction(&snapshots))?;
        save(&name("slip-rate"), &pictures::slip_rate(&snapshots))?;
    }
    Ok(())
}

/// Writes a picture.
///
/// # Errors
/// [`ExampleError`] if the file cannot be written.
pub(crate) fn save(path: &Path, svg: &str) -> Result<(), ExampleError> {
    std::fs::write(path, svg).map_err(ExampleError::write(path))
}

/// With `on`, an error if any level did not reach the tolerance.
///
/// # Errors
/// [`ExampleError::NotConverged`] with the number of such levels.
pub fn strict<'a>(
    on: bool,
    records: impl Iterator<Item = &'a RunRecord>,
) -> Result<(), ExampleError> {
    let levels = records.map(|r| r.unconverged.len()).sum();
    if on && levels > 0 {
        return Err(ExampleError::NotConverged { levels });
    }
    Ok(())
}
