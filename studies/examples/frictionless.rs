//! The brick without friction, static: small enough to compare solvers product by product; `--help` lists the options.

use std::io::Write;
use std::process::ExitCode;

use clap::Parser;
use signorini::prelude::{Friction, Scene};
use signorini_studies::brick::{Block, Loading};
use signorini_studies::options::{Common, positive};
use signorini_studies::record::{RunRecord, write_json};
use signorini_studies::run::{Outcome, pool, run, strict, warnings};
use signorini_studies::{Failure, aligned, exit};

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
    /// What all studies have.
    #[command(flatten)]
    pub common: Common,
}

/// What the best existing code (T-FETI with bounds) needs, to 1e-6: n, pressure in Pa, products at its best
/// settings, at its defaults, and on two processes the seconds of set-up and solve.
pub type Known = (usize, f64, usize, Option<(usize, f64, f64)>);

/// Counts and times of that code.
pub const KNOWN: [Known; 9] = [
    (1, 2.5e8, 126, Some((151, 0.005, 0.005))),
    (2, 2.5e8, 163, Some((228, 0.026, 0.041))),
    (3, 2.5e8, 186, Some((289, 0.095, 0.199))),
    (4, 2.5e8, 208, Some((373, 0.221, 0.540))),
    (5, 2.5e8, 242, Some((407, 0.430, 1.250))),
    (2, 1e9, 165, None),
    (3, 1e9, 186, None),
    (4, 1e9, 214, None),
    (5, 1e9, 223, None),
];

#[allow(dead_code)]
fn main() -> ExitCode {
    exit(execute(&FrictionlessOptions::parse(), &mut std::io::stdout()))
}

/// Pressure on the top only, a smooth floor below the gap.
fn scene(n: usize, cells: usize, traction: f64) -> Result<Scene, Failure> {
    let block = Block {
        cells: [cells; 3],
        floor: Some(Friction::None),
        top: [0.0, 0.0, -traction],
        end: [0.0; 3],
        steps: 0,
        ..Block::benchmark(n, Loading::B)
    };
    block.scene()
}

/// Solves all sizes and prints the table.
pub fn execute(options: &FrictionlessOptions, out: &mut impl Write) -> Result<Vec<Outcome>, Failure> {
    let common = &options.common;
    let pool = pool(common.threads)?;
    let mut outcomes = Vec::new();
    for &n in &options.n {
        let scene = scene(n, common.cells, options.traction)?;
        let header = common.header(n, "frictionless", "static");
        outcomes.push(pool.install(|| run(scene, common.settings(), &header))?);
    }
    let records: Vec<&RunRecord> = outcomes.iter().map(|o| &o.record).collect();
    let method = records.first().map_or("", |r| r.method_name());
    let (traction, tolerance) = (options.traction, common.tolerance);
    writeln!(
        out,
        "frictionless brick, {traction:e} Pa, method {method}, tolerance {tolerance:e}\n"
    )?;
    write!(out, "{}{}", table(options, &records), warnings(&records))?;
    if let Some(path) = &common.json {
        write_json(path, &records)?;
    }
    strict(common.strict, records.into_iter())?;
    Ok(outcomes)
}

fn table(options: &FrictionlessOptions, records: &[&RunRecord]) -> String {
    let heads = [
        ["size", "n"],
        ["", "multipliers"],
        ["touching", "nodes"],
        ["products", "with F"],
        ["for", "norms"],
        ["outer", "iterations"],
        ["set-up", "s"],
        ["solve", "s"],
        ["", "certificate"],
        ["|", "|"],
        ["best existing code,", "products to 1e-6"],
        ["at its", "defaults"],
        ["set-up", "s"],
        ["solve", "s"],
    ];
    let row = |run: &&RunRecord| {
        let same = |k: &&Known| k.0 == run.n && k.1 == options.traction && run.cells == 5;
        let known = KNOWN.iter().find(same);
        let or_none = |text: Option<String>| text.unwrap_or("-".to_owned());
        let seconds = known.and_then(|k| k.3);
        vec![
            run.n.to_string(),
            run.n_d.to_string(),
            run.steps[0].active.to_string(),
            run.n_m.to_string(),
            run.n_m_setup.to_string(),
            run.it.to_string(),
            format!("{:.3}", run.setup_seconds),
            format!("{:.4}", run.solve_seconds),
            format!("{:.1e}", run.largest_certificate),
            or_none(known.map(|k| k.2.to_string())),
            or_none(seconds.map(|s| s.0.to_string())),
            or_none(seconds.map(|s| format!("{:.3}", s.1))),
            or_none(seconds.map(|s| format!("{:.3}", s.2))),
        ]
    };
    aligned(&heads, &records.iter().map(row).collect::<Vec<_>>())
}
