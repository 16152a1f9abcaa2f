//! The table of results beside the paper's, and the sentence under it.

use signorini_studies::brick::Loading;
use signorini_studies::record::RunRecord;
use signorini_studies::{aligned, paper};

/// The runs beside Table 6.1.
pub(crate) fn table(runs: &[&RunRecord]) -> String {
    let heads = [
        ["size", "n"],
        ["load-", "ing"],
        ["sub-", "domains"],
        ["", "unknowns"],
        ["multipliers", "solved for"],
        ["as the", "paper counts"],
        ["outer", "iterations"],
        ["products", "with F"],
        ["for", "norms"],
        ["set-up", "s"],
        ["steps", "s"],
        ["ms a", "product"],
        ["largest", "certificate"],
        ["|", "|"],
        ["the paper,", "outer it."],
        ["Table 6.1:", "products"],
        ["", "s"],
    ];
    let row = |run: &&RunRecord| {
        let mut cells = vec![
            run.n.to_string(),
            run.loading.clone(),
            run.n_s.to_string(),
            run.n_p.to_string(),
            run.n_d.to_string(),
            run.n_d_paper.to_string(),
            run.it.to_string(),
            run.n_m.to_string(),
            run.n_m_setup.to_string(),
            format!("{:.3}", run.setup_seconds),
            format!("{:.2}", run.solve_seconds),
            format!("{:.4}", 1e3 * run.solve_seconds / run.n_m.max(1) as f64),
            format!("{:.1e}", run.largest_certificate),
        ];
        cells.extend(match published(run) {
            Some((it, n_m, seconds)) => [it.to_string(), n_m.to_string(), format!("{seconds:.0}")],
            None => ["-", "-", "-"].map(str::to_owned),
        });
        cells
    };
    let rows: Vec<Vec<String>> = runs.iter().map(row).collect();
    let iterations = match runs.first().map(|r| r.it_name.as_str()) {
        Some("auxiliary problems") | None => "auxiliary problems, as in the paper".to_owned(),
        Some(other) => format!("{other}; the paper's are auxiliary problems"),
    };
    aligned(&heads, &rows)
        + &format!(
            "The paper's letters: subdomains n_s, unknowns n_p, multipliers n_d (it counts contact rows of fixed \
             nodes, too; we\n\
             solve for full rank), outer iterations it ({iterations}), products n_m (those for norms apart).\n"
        )
}

/// Which runs need at most as many products as the paper's, in a sentence; empty if none is in the paper.
pub(crate) fn verdict(runs: &[&RunRecord]) -> String {
    let (mut below, mut above) = (Vec::new(), Vec::new());
    for run in runs {
        if let Some((_, n_m, _)) = published(run) {
            let list = if run.n_m <= n_m { &mut below } else { &mut above };
            let ratio = run.n_m as f64 / n_m as f64;
            list.push(format!("n = {} ({}): {ratio:.2}", run.n, run.loading));
        }
    }
    if below.is_empty() && above.is_empty() {
        return String::new();
    }
    let [below, above] = [below, above].map(|list| if list.is_empty() { "none".to_owned() } else { list.join(", ") });
    let method = runs.first().map_or("", |r| r.method_name());
    format!("products over the paper's, method {method}: at or below: {below}; above: {above}")
}

/// The paper's outer iterations, products and seconds for a run of its loading.
fn published(run: &RunRecord) -> Option<(usize, usize, f64)> {
    let loading = Loading::BOTH.into_iter().find(|l| l.name() == run.loading)?;
    Some(paper::row(run.n)?.costs(loading))
}
