//! The table of results, as text and as the document of the study.

use std::fmt::Write;

use signorini_studies::Failure;

use super::case::Case;
use super::locking;
use super::runner::{Ended, Measured, difference};

/// A case, what was measured, and what is wrong with it, if anything.
pub(crate) struct Line<'a> {
    /// The case.
    pub(crate) case: &'a Case,
    /// The result.
    pub(crate) measured: Measured,
    /// What is wrong.
    pub(crate) complaint: Option<String>,
}

/// Complaints that need the results of other cases.
pub(crate) fn compare(lines: &mut [Line<'_>]) {
    let figures: Vec<(String, Vec<f64>)> = lines
        .iter()
        .map(|l| (l.case.name.clone(), l.measured.figures.clone()))
        .collect();
    for line in lines.iter_mut().filter(|l| l.complaint.is_none()) {
        let Some((name, within)) = &line.case.same_as else {
            continue;
        };
        let Some((_, reference)) = figures.iter().find(|f| f.0 == *name) else {
            continue;
        };
        let off = difference(reference, &line.measured.figures);
        if off.is_nan() || off > *within {
            line.complaint = Some(format!("differs from '{name}' by {off:.1e}"));
        }
    }
}

/// What the library did, in words.
pub(crate) fn outcome(m: &Measured) -> String {
    match &m.ended {
        Ended::Solved(status, _) if status.converged() => match m.fallbacks {
            0 => "certified".to_owned(),
            1 => "certified, 1 step by the fall-back".to_owned(),
            n => format!("certified, {n} steps by the fall-back"),
        },
        Ended::Solved(status, step) => format!("status {status:?} at step {step}"),
        Ended::Refused(text) => format!("refused: {}", text.split(';').next().unwrap_or("")),
        Ended::Panicked(text) => format!("PANIC {text}"),
    }
}

/// One line of plain text.
pub(crate) fn plain(line: &Line<'_>) -> String {
    let m = &line.measured;
    let mut out = format!(
        "{} {:<40} {:<38} cert {:>7.1e} balance {:>7.1e} products {:>6} {:>7.2} s",
        if line.complaint.is_some() { "FAIL" } else { " ok " },
        line.case.name,
        outcome(m).chars().take(38).collect::<String>(),
        m.certificate.0,
        m.balance.largest(),
        m.products,
        m.seconds
    );
    if let Some(text) = &line.complaint {
        let _ = write!(out, "\n     {text}");
    }
    out
}

/// The document; what is measured stands in place of the words in capitals.
const DOCUMENT: &str = include_str!("report.txt");

/// The document. `command` wrote it.
pub(crate) fn document(lines: &[Line<'_>], command: &str) -> Result<String, Failure> {
    let mut rows = String::new();
    for nu in locking::RATIOS {
        let _ = write!(rows, "| {nu} |");
        for cells in locking::CELLS {
            let _ = write!(rows, " {:.3} |", locking::deflection(nu, cells)?);
        }
        rows.push('\n');
    }
    let cells = locking::CELLS.map(|c| format!("{c} cells across"));
    Ok(DOCUMENT
        .replace("COMMAND", command)
        .replace("RESULTS", &results(lines))
        .replace("CELLS", &cells.join(" | "))
        .replace("RULES", &"---|".repeat(cells.len()))
        .replace("ROWS", &rows))
}

fn results(lines: &[Line<'_>]) -> String {
    let failed = lines.iter().filter(|l| l.complaint.is_some()).count();
    let mut out = format!("{} cases, {failed} failed.\n", lines.len());
    let mut group = "";
    for line in lines {
        let (case, m) = (line.case, &line.measured);
        if case.group != group {
            group = case.group;
            let _ = writeln!(
                out,
                "\n### {group}\n\n| case | difficulty | outcome | certificate | balance | n_s | rows | \
                 steps | products | s |\n|---|---|---|---|---|---|---|---|---|---|"
            );
        }
        let mut did = outcome(m);
        match (&line.complaint, &case.same_as) {
            (Some(text), _) => did += &format!(" **{text}**"),
            (None, Some((name, _))) => did += &format!(", as '{name}'"),
            (None, None) => {}
        }
        let _ = write!(out, "| {} | {} | {did} |", case.name, case.hard);
        let _ = match m.ended {
            Ended::Refused(_) => writeln!(out, " | | | | | | |"),
            _ => writeln!(
                out,
                " {:.1e} | {:.1e} | {} | {} | {} | {} | {:.2} |",
                m.certificate.0,
                m.balance.largest(),
                m.subdomains,
                m.rows,
                m.steps,
                m.products,
                m.seconds
            ),
        };
    }
    out.trim_end().to_owned()
}
