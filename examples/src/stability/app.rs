//! What the example `stability` does.

use std::io::Write;
use std::path::PathBuf;

use super::case::Case;
use super::report::{Line, compare, document, plain};
use super::runner;
use crate::error::ExampleError;
use clap::Parser;

/// Options of the example.
#[derive(Debug, Clone, Parser)]
#[command(
    name = "stability",
    about = "Hard cases and what the library does with them"
)]
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

/// The cases that the options ask for, with those that they are compared with.
#[must_use]
pub fn chosen(options: &StabilityOptions) -> Vec<Case> {
    let part = options.case.as_deref().unwrap_or("");
    let wanted =
        |c: &Case| !(options.short && c.long) && (c.name.contains(part) || c.group.contains(part));
    let all = super::cases();
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
pub fn run_all(cases: &[Case], mut progress: impl FnMut(&Line<'_>)) -> Vec<Line<'_>> {
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
///
/// # Errors
/// [`ExampleError`] if something cannot be printed or written. A case that fails is no error.
pub fn execute(options: &StabilityOptions, out: &mut dyn Write) -> Result<usize, ExampleError> {
    let cases = chosen(options);
    let mut printed = Ok(());
    let lines = run_all(&cases, |line| {
        if printed.is_ok() {
            printed = writeln!(out, "{}", plain(line));
        }
    });
    printed?;
    let failed: Vec<&Line<'_>> = lines.iter().filter(|l| l.complaint.is_some()).collect();
    writeln!(
        out,
        "{} cases, {} not as they should be",
        lines.len(),
        failed.len()
    )?;
    for line in &failed {
        writeln!(out, "{}", plain(line))?;
    }
    if let Some(path) = &options.markdown {
        let short = if options.short { " --short" } else { "" };
        let command = format!(
            "cargo run --release --example stability --{short} --markdown {}",
            path.display()
        );
        let text = document(&lines, &command)
            .map_err(|e| ExampleError::Print(std::io::Error::other(e.to_string())))?;
        std::fs::write(path, text).map_err(ExampleError::write(path))?;
    }
    Ok(failed.len())
}
