//! The ladder from the paper's method to the default: what each idea saves, on the brick; `--help` lists the options.

pub(crate) mod cuts;

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use signorini::contact::InnerAccuracy;
use signorini::prelude::*;
use signorini::qp::ActiveSetSettings;
use signorini_studies::brick::{Block, CELLS, Loading, STEPS};
use signorini_studies::run::{Header, pool, run};
use signorini_studies::{Failure, chart, exit, paper, save};

/// Options of the `performance` example.
#[derive(Debug, Clone, Parser)]
#[command(
    name = "performance",
    about = "Products and time of each method on the brick, from the paper's to the default"
)]
pub struct PerformanceOptions {
    /// Sizes: subdomains along the short edges.
    #[arg(long, value_delimiter = ',', default_value = "1,2")]
    pub n: Vec<usize>,
    /// Time steps.
    #[arg(long, default_value_t = STEPS)]
    pub steps: usize,
    /// Cells along the edge of a subdomain, several for a sweep of H/h with the default method.
    #[arg(long, value_delimiter = ',', default_value = "5")]
    pub cells: Vec<usize>,
    /// Threads; 0 means one a core.
    #[arg(long, default_value_t = 0)]
    pub threads: usize,
    /// Only the default method and its neighbours, not the paper's.
    #[arg(long, alias = "face-only")]
    pub active_set_only: bool,
    /// Subdomains of every shape instead, as they are given and made compact.
    #[arg(long)]
    pub cuts: bool,
    /// With --cuts: a Gmsh mesh of the brick instead of the regular one.
    #[arg(long, value_name = "FILE", requires = "cuts")]
    pub mesh: Option<PathBuf>,
    /// With --cuts: part numbers of the tetrahedra from a file, besides random ones.
    #[arg(long, value_name = "FILE", requires = "cuts")]
    pub parts: Option<PathBuf>,
    /// Draw the ladder into this SVG file.
    #[arg(long, value_name = "FILE")]
    pub chart: Option<PathBuf>,
}

#[allow(dead_code)]
fn main() -> ExitCode {
    let (options, mut out) = (PerformanceOptions::parse(), std::io::stdout());
    if options.cuts {
        exit(cuts::execute(&options, &mut out))
    } else {
        exit(execute(&options, &mut out))
    }
}

/// What is new on each rung of the ladder, with the ideas of those before it unless its name says otherwise, and
/// settings.
fn ladder(active_set_only: bool) -> Vec<(&'static str, Settings)> {
    let base = Settings::default;
    let full = match Method::paper() {
        Method::SuccessiveApproximations { smalse, .. } => {
            let accuracy = InnerAccuracy::Fixed;
            Method::SuccessiveApproximations { smalse, accuracy }
        }
        other => other,
    };
    let forcing = |f: f64| base().with_method(Method::ActiveSet(ActiveSetSettings::default().with_forcing(f)));
    let paper = [
        (
            "paper, every Tresca problem to full accuracy, no extrapolation",
            base().with_method(full).with_extrapolation(false),
        ),
        (
            "paper, inner accuracy follows the fixed point",
            base().with_method(Method::paper()).with_extrapolation(false),
        ),
        ("paper, start extrapolated in time", base().with_method(Method::paper())),
        ("paper's one inexact loop", base().with_method(Method::one_loop())),
    ];
    let own = [
        (
            "active set, no preconditioner",
            base().with_preconditioner(Preconditioner::None),
        ),
        ("active set, lumped, no extrapolation", base().with_extrapolation(false)),
        ("active set, lumped, forcing 0.02", forcing(0.02)),
        ("active set, lumped, forcing 0.5", forcing(0.5)),
        ("active set, lumped (the default)", base()),
        (
            "active set, Dirichlet",
            base().with_preconditioner(Preconditioner::Dirichlet),
        ),
    ];
    let paper = paper.into_iter().filter(|_| !active_set_only);
    paper.chain(own).collect()
}

/// One measured line.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Size, H/h and loading.
    pub run: (usize, usize, Loading),
    /// The rung.
    pub name: &'static str,
    /// Products with F.
    pub products: usize,
}

/// Measures all rungs and prints a table in Markdown.
pub fn execute(options: &PerformanceOptions, out: &mut impl Write) -> Result<Vec<Line>, Failure> {
    let pool = pool(options.threads)?;
    let mut lines = Vec::new();
    writeln!(
        out,
        "| n | H/h | loading | method | products | paper / products | certificate | seconds |"
    )?;
    writeln!(out, "|---|---|---|---|---|---|---|---|")?;
    for &n in &options.n {
        for &cells in &options.cells {
            for loading in Loading::BOTH {
                for (name, settings) in ladder(options.active_set_only) {
                    let steps = options.steps;
                    let block = Block {
                        steps,
                        cells: [cells; 3],
                        ..Block::benchmark(n, loading)
                    };
                    let header = Header {
                        n,
                        loading: loading.name().to_owned(),
                        cells,
                        formula: "three-step".to_owned(),
                        it_name: "it".to_owned(),
                        progress: false,
                    };
                    let scene = block.scene()?;
                    let record = pool.install(|| run(scene, settings, &header))?.record;
                    let standard = (steps, cells) == (STEPS, CELLS);
                    let paper = paper::row(n).filter(|_| standard);
                    let ratio = paper.map_or("-".to_owned(), |row| {
                        format!("{:.1}", row.costs(loading).1 as f64 / record.n_m as f64)
                    });
                    let failed = match record.unconverged.len() {
                        0 => String::new(),
                        count => format!(" ({count} steps not converged)"),
                    };
                    writeln!(
                        out,
                        "| {n} | {cells} | {} | {name}{failed} | {} | {ratio} | {:.1e} | {:.2} |",
                        loading.name(),
                        record.n_m,
                        record.largest_certificate,
                        record.solve_seconds
                    )?;
                    out.flush()?;
                    lines.push(Line {
                        run: (n, cells, loading),
                        name,
                        products: record.n_m,
                    });
                }
            }
        }
    }
    if let Some(path) = &options.chart {
        save(path, &bars(&lines)?)?;
    }
    Ok(lines)
}

/// One group of bars for each method, one bar in it for each size and loading.
fn bars(lines: &[Line]) -> Result<String, Failure> {
    let (mut names, mut runs) = (Vec::new(), Vec::new());
    for line in lines {
        if !names.contains(&line.name) {
            names.push(line.name);
        }
        if !runs.contains(&line.run) {
            runs.push(line.run);
        }
    }
    let count = |name: &str, run| {
        lines
            .iter()
            .find(|l| l.name == name && l.run == run)
            .map(|l| l.products)
    };
    let group = |name: &&'static str| (*name, runs.iter().map(|&run| count(name, run)).collect());
    let groups: Vec<_> = names.iter().map(group).collect();
    let kinds = runs
        .iter()
        .map(|(n, cells, loading)| format!("n = {n}, H/h = {cells}, {}", loading.name()));
    chart::bars("Products with F of all steps", &kinds.collect::<Vec<_>>(), &groups)
}
