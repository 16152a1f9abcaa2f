//! Hard cases: what makes a scene hard, what the library does with it, and what has to hold afterwards; `--help`
//! lists the options.
//!
//! | module | holds |
//! |---|---|
//! | `case` | a case: what is hard, how it is built, what is acceptable |
//! | `runner` | runs a case: never panics, measures certificate, balances, products, time |
//! | `balance` | forces, moments and energy, computed apart from the solver |
//! | `cases_*` | the cases, one group a file |
//! | `locking` | linear tetrahedra near incompressibility, measured |
//! | `report` | the table, and the document of the study |

pub(crate) mod balance;
pub(crate) mod case;
mod cases_bodies;
mod cases_contact;
mod cases_material;
mod cases_partners;
pub(crate) mod cases_restart;
mod cases_shape;
pub(crate) mod cases_sliding;
mod cases_time;
pub(crate) mod locking;
pub(crate) mod report;
pub(crate) mod runner;

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use case::Case;
use clap::Parser;
use report::{Line, compare, document, plain};
use signorini_studies::{Failure, exit, save};

/// All cases, in the order of the document.
pub(crate) fn cases() -> Vec<Case> {
    let groups = [
        cases_contact::friction(),
        cases_contact::sets(),
        cases_contact::sliding(),
        cases_sliding::cases(),
        cases_bodies::free(),
        cases_bodies::supports(),
        cases_partners::cases(),
        cases_material::cases(),
        cases_shape::cases(),
        cases_time::cases(),
        cases_restart::cases(),
    ];
    groups.into_iter().flatten().collect()
}

/// Options of the example.
#[derive(Debug, Clone, Parser)]
#[command(name = "stability", about = "Hard cases and what the library does with them")]
pub struct StabilityOptions {
    /// Leave the long cases out.
    #[arg(long)]
    pub short: bool,
    /// Only cases whose name or group contains this.
    #[arg(long, value_name = "NAME")]
    pub case: Option<String>,
    /// Write the document here.
    #[arg(long, value_name = "FILE")]
    pub markdown: Option<PathBuf>,
}

#[allow(dead_code)]
fn main() -> ExitCode {
    match execute(&StabilityOptions::parse(), &mut std::io::stdout()) {
        Ok(1..) => ExitCode::FAILURE,
        result => exit(result),
    }
}

/// The cases that the options ask for, with those that they are compared with.
pub(crate) fn chosen(options: &StabilityOptions) -> Vec<Case> {
    let part = options.case.as_deref().unwrap_or("");
    let wanted = |c: &Case| !(options.short && c.long) && (c.name.contains(part) || c.group.contains(part));
    let all = cases();
    let references: Vec<String> = all
        .iter()
        .filter(|c| wanted(c))
        .filter_map(|c| c.same_as.as_ref().map(|s| s.0.clone()))
        .collect();
    all.into_iter()
        .filter(|c| wanted(c) || references.contains(&c.name))
        .collect()
}

/// Runs cases in turn.
pub(crate) fn run_all(cases: &[Case], mut progress: impl FnMut(&Line<'_>)) -> Vec<Line<'_>> {
    let mut lines = Vec::with_capacity(cases.len());
    for case in cases {
        let measured = runner::run(case);
        let complaint = measured
            .complaint(case.expect)
            .or_else(|| measured.excess(case.at_most?));
        let line = Line {
            case,
            measured,
            complaint,
        };
        progress(&line);
        lines.push(line);
    }
    compare(&mut lines);
    lines
}

/// Runs the cases, prints the table, writes the document; returns how many are not as they should be.
pub fn execute(options: &StabilityOptions, out: &mut dyn Write) -> Result<usize, Failure> {
    let cases = chosen(options);
    let mut printed = Ok(());
    let lines = run_all(&cases, |line| {
        if printed.is_ok() {
            printed = writeln!(out, "{}", plain(line));
        }
    });
    printed?;
    let failed: Vec<&Line<'_>> = lines.iter().filter(|l| l.complaint.is_some()).collect();
    writeln!(out, "{} cases, {} failed", lines.len(), failed.len())?;
    for line in &failed {
        writeln!(out, "{}", plain(line))?;
    }
    if let Some(path) = &options.markdown {
        let short = if options.short { " --short" } else { "" };
        let command = format!(
            "cargo run --release --example stability --{short} --markdown {}",
            path.display()
        );
        save(path, &document(&lines, &command)?)?;
    }
    Ok(failed.len())
}
