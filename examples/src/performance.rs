//! The ladder from the paper's method to the default: what each idea saves, on the brick.

use std::io::Write;
use std::path::PathBuf;

use clap::Parser;
use signorini::contact::InnerAccuracy;
use signorini::prelude::*;
use signorini::qp::ActiveSetSettings;

use crate::app::save;
use crate::brick::{Benchmark, Loading};
use crate::error::ExampleError;
use crate::paper;
use crate::pictures;
use crate::run::{Header, pool, run};

/// Options of the `performance` example.
#[derive(Debug, Clone, Parser)]
#[command(about = "Products and time of each method on the brick, from the paper's to the default")]
pub struct PerformanceOptions {
    /// Sizes: subdomains along the short edges.
    #[arg(long, value_delimiter = ',', default_value = "1,2")]
    pub n: Vec<usize>,
    /// Time steps.
    #[arg(long, default_value_t = crate::brick::STEPS)]
    pub steps: usize,
    /// Cells along the edge of a subdomain, several for a sweep of H/h with the default method.
    #[arg(long, value_delimiter = ',', default_value = "5")]
    pub cells: Vec<usize>,
    /// Threads; 0 means one a core.
    #[arg(long, default_value_t = 0)]
    pub threads: usize,
    /// Only the default method and its neighbours, not the paper's.
    #[arg(long)]
    pub face_only: bool,
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

/// One rung of the ladder.
#[derive(Debug, Clone)]
pub struct Rung {
    /// What is new on it.
    pub name: &'static str,
    /// Settings that show it.
    pub settings: Settings,
}

/// The rungs, each with the ideas of those before it unless its name says otherwise.
#[must_use]
pub fn ladder(face_only: bool) -> Vec<Rung> {
    let rung = |name, settings| Rung { name, settings };
    let base = Settings::default();
    let paper = |accuracy: InnerAccuracy| match Method::paper() {
        Method::SuccessiveApproximations { smalse, .. } => {
            Method::SuccessiveApproximations { smalse, accuracy }
        }
        other => other,
    };
    let face = |forcing: f64| Method::ActiveSet(ActiveSetSettings::default().with_forcing(forcing));
    let mut rungs = vec![
        rung(
            "paper, every given-friction problem to full accuracy, no extrapolation",
            base.clone()
                .with_method(paper(InnerAccuracy::Fixed))
                .with_extrapolation(false),
        ),
        rung(
            "paper, inner accuracy follows the fixed point",
            base.clone()
                .with_method(Method::paper())
                .with_extrapolation(false),
        ),
        rung(
            "paper, start extrapolated in time",
            base.clone().with_method(Method::paper()),
        ),
        rung(
            "paper's one inexact loop",
            base.clone().with_method(Method::one_loop()),
        ),
    ];
    if face_only {
        rungs.clear();
    }
    rungs.extend([
        rung(
            "face method, no preconditioner",
            base.clone().with_preconditioner(Preconditioner::None),
        ),
        rung(
            "face method, lumped, no extrapolation",
            base.clone().with_extrapolation(false),
        ),
        rung(
            "face method, lumped, forcing 0.02",
            base.clone().with_method(face(0.02)),
        ),
        rung(
            "face method, lumped, forcing 0.5",
            base.clone().with_method(face(0.5)),
        ),
        rung("face method, lumped (the default)", base.clone()),
        rung(
            "face method, Dirichlet",
            base.with_preconditioner(Preconditioner::Dirichlet),
        ),
    ]);
    rungs
}

/// One measured line.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Size.
    pub n: usize,
    /// H/h.
    pub cells: usize,
    /// Loading.
    pub loading: Loading,
    /// The rung.
    pub name: &'static str,
    /// Products with F.
    pub products: usize,
    /// Levels that did not converge.
    pub failed: usize,
    /// Largest certificate.
    pub certificate: f64,
    /// Seconds of the solve.
    pub seconds: f64,
}

/// Measures all rungs and prints a table in Markdown.
///
/// # Errors
/// [`ExampleError`] of the library or of the output.
pub fn execute(
    options: &PerformanceOptions,
    out: &mut impl Write,
) -> Result<Vec<Line>, ExampleError> {
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
                for rung in ladder(options.face_only) {
                    let benchmark = Benchmark {
                        steps: options.steps,
                        cells,
                        ..Benchmark::new(n, loading)
                    };
                    let header = Header {
                        n,
                        loading: loading.name().to_owned(),
                        cells,
                        formula: "three-step".to_owned(),
                        it_name: "it".to_owned(),
                    };
                    let scene = benchmark.scene()?;
                    let settings = rung.settings.clone();
                    let outcome = pool.install(|| run(scene, settings, &header, &mut []))?;
                    let record = &outcome.record;
                    let line = Line {
                        n,
                        cells,
                        loading,
                        name: rung.name,
                        products: record.n_m,
                        failed: record.unconverged.len(),
                        certificate: record.largest_certificate,
                        seconds: record.solve_seconds,
                    };
                    print(&line, benchmark.is_standard(), out)?;
                    lines.push(line);
                }
            }
        }
    }
    if let Some(path) = &options.chart {
        save(path, &pictures::ladder(&lines))?;
    }
    Ok(lines)
}

fn print(line: &Line, standard: bool, out: &mut impl Write) -> Result<(), ExampleError> {
    let paper = paper::TABLE.iter().find(|row| standard && row.n == line.n);
    let ratio = paper.map_or("-".to_owned(), |row| {
        format!(
            "{:.1}",
            row.costs(line.loading).1 as f64 / line.products as f64
        )
    });
    let failed = if line.failed > 0 {
        format!(" ({} levels not converged)", line.failed)
    } else {
        String::new()
    };
    writeln!(
        out,
        "| {} | {} | {} | {}{failed} | {} | {ratio} | {:.1e} | {:.2} |",
        line.n,
        line.cells,
        line.loading.name(),
        line.name,
        line.products,
        line.certificate,
        line.seconds
    )?;
    out.flush()?;
    Ok(())
}
