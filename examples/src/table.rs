//! The table of results beside the paper's, and the sentences under it.

use std::fmt::Write as _;

use crate::brick::Loading;
use crate::paper;
use crate::record::RunRecord;

/// The runs beside Table 6.1.
#[must_use]
pub fn table(runs: &[&RunRecord]) -> String {
    let mut text = String::new();
    let title = "the paper, Table 6.1";
    let _ = writeln!(text, "{:101}| {title}", "");
    let _ = writeln!(
        text,
        "{:>2} {:>3} {:>4} {:>7} {:>7} {:>7} {:>6} {:>7} {:>6} {:>9} {:>8} {:>9} {:>14} | {:>6} {:>5} {:>6} {:>8}",
        "n",
        "phi",
        "n_s",
        "n_p",
        "n_d *",
        "n_d",
        "it **",
        "n_m",
        "norm",
        "set-up s",
        "solve s",
        "ms/prod.",
        "certificate",
        "n_d",
        "it",
        "n_m",
        "s"
    );
    for run in runs {
        let _ = write!(
            text,
            "{:>2} {:>3} {:>4} {:>7} {:>7} {:>7} {:>6} {:>7} {:>6} {:>9.3} {:>8.2} {:>9.4} {:>14.1e} |",
            run.n,
            run.loading,
            run.n_s,
            run.n_p,
            run.n_d_paper,
            run.n_d,
            run.it,
            run.n_m,
            run.n_m_setup,
            run.setup_seconds,
            run.solve_seconds,
            1e3 * run.solve_seconds / run.n_m.max(1) as f64,
            run.largest_certificate
        );
        match published(run) {
            Some((n_d, it, n_m, seconds)) => {
                let _ = writeln!(text, " {n_d:>6} {it:>5} {n_m:>6} {seconds:>8.0}");
            }
            None => text.push_str("      -     -      -        -\n"),
        }
    }
    let name = match runs.first().map(|r| r.it_name.as_str()) {
        Some("auxiliary problems") | None => "auxiliary problems, as in the paper".to_owned(),
        Some(other) => format!("{other}; the paper's are auxiliary problems"),
    };
    let _ = writeln!(
        text,
        "* as the paper counts (with the contact rows of fixed nodes); the next column has full rank and is what is solved.\n\
         ** {name}. n_m: products with F; norm: those spent on norms, apart. ms/prod.: solve time over n_m."
    );
    text
}

/// Which runs need at most as many products as the paper's, in a sentence; empty if none is in the paper.
#[must_use]
pub fn verdict(runs: &[&RunRecord]) -> String {
    let mut below = Vec::new();
    let mut above = Vec::new();
    for run in runs {
        let Some((.., n_m, _)) = published(run) else {
            continue;
        };
        let ratio = run.n_m as f64 / n_m as f64;
        let entry = format!("n = {} ({}): {ratio:.2}", run.n, run.loading);
        if run.n_m <= n_m {
            below.push(entry)
        } else {
            above.push(entry)
        }
    }
    let list = |v: &[String]| {
        if v.is_empty() {
            "none".to_owned()
        } else {
            v.join(", ")
        }
    };
    if below.is_empty() && above.is_empty() {
        return String::new();
    }
    format!(
        "products over the paper's n_m, method {}: at or below: {}; above: {}",
        runs.first().map_or("", |r| r.method.as_str()),
        list(&below),
        list(&above)
    )
}

/// A loud line for each run with levels that did not reach the tolerance.
#[must_use]
pub fn warnings(runs: &[&RunRecord]) -> String {
    let mut text = String::new();
    for run in runs.iter().filter(|r| !r.unconverged.is_empty()) {
        let _ = writeln!(
            text,
            "WARNING: n = {}, {}: steps {:?} DID NOT REACH the tolerance {:e}; their states are the last iterates",
            run.n, run.loading, run.unconverged, run.tolerance
        );
        let mut history = run.steps.iter().filter_map(|s| s.unconverged_history);
        if let Some(first) = history.next() {
            let _ = writeln!(
                text,
                "         the slip of {} later steps depends on step {first}",
                history.count() + 1
            );
        }
    }
    for run in runs.iter().filter(|r| r.largest_certificate > r.tolerance) {
        let above = run.steps.iter().filter(|s| s.certificate > run.tolerance);
        let steps: Vec<usize> = above.map(|s| s.step).collect();
        let _ = writeln!(
            text,
            "note: n = {}, {}: certificate {:.1e} above the tolerance {:e}; steps {steps:?}",
            run.n, run.loading, run.largest_certificate, run.tolerance
        );
    }
    for run in runs {
        let steps: Vec<usize> = run
            .steps
            .iter()
            .filter(|s| s.fallback)
            .map(|s| s.step)
            .collect();
        if !steps.is_empty() {
            let _ = writeln!(
                text,
                "note: n = {}, {}: the face method handed steps {steps:?} to SMALSE",
                run.n, run.loading
            );
        }
    }
    text
}

/// The paper's n_d, it, n_m and seconds for a run of its loading.
fn published(run: &RunRecord) -> Option<(usize, usize, usize, f64)> {
    let loading = Loading::BOTH
        .into_iter()
        .find(|l| l.name() == run.loading)?;
    let row = paper::row(run.n)?;
    let (it, n_m, seconds) = row.costs(loading);
    Some((row.n_d, it, n_m, seconds))
}
