//! The table of results, as text and as the document `docs/reports/stability.md`.

use super::case::{Case, Failure};
use super::locking;
use super::runner::{Ended, Measured, difference};
use std::fmt::Write;

/// A case, what was measured, and what is wrong with it, if anything.
#[derive(Debug)]
pub struct Line<'a> {
    /// The case.
    pub case: &'a Case,
    /// The result.
    pub measured: Measured,
    /// What is wrong.
    pub complaint: Option<String>,
}

/// Complaints that need the results of other cases.
pub fn compare(lines: &mut [Line<'_>]) {
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
#[must_use]
pub fn outcome(m: &Measured) -> String {
    match &m.ended {
        Ended::Solved(status, _) if status.converged() => match m.fallbacks {
            0 => "certified".to_owned(),
            1 => "certified, 1 step by the fall-back".to_owned(),
            n => format!("certified, {n} steps by the fall-back"),
        },
        Ended::Solved(status, level) => format!("says {status:?} at step {level}"),
        Ended::Refused(text) => format!("refused: {}", text.split(';').next().unwrap_or("")),
        Ended::Panicked(text) => format!("PANIC {text}"),
    }
}

/// One line of plain text.
#[must_use]
pub fn plain(line: &Line<'_>) -> String {
    let m = &line.measured;
    let mut out = format!(
        "{} {:<40} {:<38} cert {:>7.1e} balance {:>7.1e} products {:>6} {:>7.2} s",
        if line.complaint.is_some() {
            "FAIL"
        } else {
            " ok "
        },
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

const HEAD: &str = "\
# Hard cases

Written by `COMMAND`. The same cases are tests: `cargo test --release -p signorini-examples stability` runs the short ones, with
`-- --include-ignored` all of them.

Most cases are the benchmark's brick (steel, clamped at one end, floor 0.1 m below, coefficient 0.3) with 3 subdomains of 4 x 4 x 4 cells,
6 steps of backward Euler, and one thing made hard. Settings are the defaults. What has to hold:

- *certified*: every step converges, and the largest relative violation of all conditions (column *certificate*) stays below 1e-5, 1e-4 for a coefficient of 1000;
- or the *status* says that there is no certified result, and why;
- or the scene is *refused* before anything is solved, with a message that names the place;
- never a panic, NaN, or a result that is wrong and says nothing;
- *balance*: the largest error of the balances of force, moment and energy of every step, and of negative dissipation, stays below ten times the limit of the certificate;
- cases that are one problem in two forms give the same dimensionless results (*as 'X'*: as case X).

Columns: *n_s* subdomains, *rows* of B, *steps* (they count from 0), *products* with F of all steps, *s* seconds.

## What is conserved

With internal forces `K u`, loads `f`, contact forces `c` and reactions `R`, all computed from the mesh and the reported nodal values:

- Forces and moments: the sum of `f + c + R` and of its moments vanishes in every step.
- Energy: `E1 - E0` equals the work of the mean of `f + c + R` of two successive steps. This is an identity in the exact solution, for any step length.
- With the forces of the new step alone (backward Euler): `(f1 + R1)(u1 - u0) = (E1 - E0) + D_t + D_n + (u1 - u0) K (u1 - u0) / 2`, with friction loss `D_t >= 0` and `D_n = -c_n (u1 - u0) >= 0` of nodes that close. The last term is the price of the formula and vanishes in sum like the step.
- With the paper's formula friction can give energy back at nodes that stick after sliding ([theory](../theory.md#2-time)).

";

const BOUNDS: &str = "
## What the expensive cases are bound by

Most cases need 10 to 50 products a step. The others:

- *Jumps of stiffness between subdomains.* The soft copy of a contact node is displaced by the error of gluing. Rows therefore weigh copies by stiffness, and the jump has no influence on the number of products.
- *Poisson's ratios near 1/2, and flat elements.* With all its neighbours held, a node can hardly move: the lumped stiffness of its row is 120 times (nu = 0.499) to 12000 times (0.49999) the stiffness with the subdomain free; ordinary are 1 to 4. The error estimate is as much too large, so these cases are solved more accurately than asked. The Dirichlet preconditioner does not cure it: it holds the volume, too.
- *Barely not tipping.* Nearly all nodes of the edge slide by about a micrometre. Stick and slip change with the last digits.
- *A coefficient of 1000.* Neither method comes to rest; successive approximations say `NotContractive`. The result solves the Tresca problem of the last bounds, not Coulomb's. Whether there is a solution near is not known.

";

const LOCKING: &str = "
## Locking of linear tetrahedra

A linear tetrahedron with nearly no change of volume has hardly any way to bend. Deflection of the clamped brick under a transverse force
at its end, over that of Timoshenko's beam:

| nu | CELLS |
|---|RULES
ROWSHalving the cells divides the error by 3 to 4 at nu = 0, by 1.7 only at 0.499. This is a property of the discretisation: the certificates
above belong to converged solutions of the locked equations. For rubber use a mixed element (not in this library), a finer mesh, or the
smallest Poisson's ratio that the question allows.
";

/// The document. `command` wrote it.
///
/// # Errors
/// Those of the locking study.
pub fn document(lines: &[Line<'_>], command: &str) -> Result<String, Failure> {
    let mut out = HEAD.replace("COMMAND", command);
    let failed = lines.iter().filter(|l| l.complaint.is_some()).count();
    let _ = writeln!(
        out,
        "## Results\n\n{} cases, {failed} not as they should be.\n",
        lines.len()
    );
    let mut group = "";
    for line in lines {
        let (case, m) = (line.case, &line.measured);
        if case.group != group {
            group = case.group;
            let _ = writeln!(
                out,
                "\n### {group}\n\n| case | what is hard | what the library did | certificate | balance | n_s | rows | steps | products | s |\n|---|---|---|---|---|---|---|---|---|---|"
            );
        }
        let mut did = outcome(m);
        if let Some(text) = &line.complaint {
            let _ = write!(did, " **{text}**");
        }
        if let (None, Some((name, _))) = (&line.complaint, &case.same_as) {
            let _ = write!(did, ", as '{name}'");
        }
        if let Ended::Refused(_) = m.ended {
            let _ = writeln!(
                out,
                "| {} | {} | {did} | | | | | | | |",
                case.name, case.hard
            );
            continue;
        }
        let _ = writeln!(
            out,
            "| {} | {} | {did} | {:.1e} | {:.1e} | {} | {} | {} | {} | {:.2} |",
            case.name,
            case.hard,
            m.certificate.0,
            m.balance.largest(),
            m.subdomains,
            m.rows,
            m.levels,
            m.products,
            m.seconds
        );
    }
    out.push_str(BOUNDS.trim_end());
    out.push('\n');
    let cells: Vec<String> = locking::CELLS
        .iter()
        .map(|c| format!("{c} cells across"))
        .collect();
    let mut rows = String::new();
    for nu in locking::RATIOS {
        let _ = write!(rows, "| {nu} |");
        for cells in locking::CELLS {
            let _ = write!(rows, " {:.3} |", locking::deflection(nu, cells)?);
        }
        rows.push('\n');
    }
    let text = LOCKING
        .replace("CELLS", &cells.join(" | "))
        .replace("RULES", &"---|".repeat(cells.len()))
        .replace("ROWS", &rows);
    out.push_str(&text);
    Ok(out)
}
