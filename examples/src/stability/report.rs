//! The table of results, as text and as the document `docs/stability.md`.

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
            1 => "certified, 1 level by the fall-back".to_owned(),
            n => format!("certified, {n} levels by the fall-back"),
        },
        Ended::Solved(status, level) => format!("says {status:?} at level {level}"),
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

Written by `COMMAND`; run it to see the numbers of your machine. The same cases are tests: `cargo test --release -p \
signorini-examples --test stability` runs the short ones, with `-- --include-ignored` all of them.

Most cases are the benchmark's brick (3 m x 1 m x 1 m, steel, clamped at one end, floor 0.1 m below, coefficient 0.3) with \
3 subdomains of 4 x 4 x 4 cells and 6 steps of backward Euler, and one thing made hard. Settings are the defaults: method \
`face`, tolerance 1e-6. What has to hold:

- *certified*: every level converges, and the largest relative violation of all conditions (column *certificate*; computed \
from the recovered displacement, not by the solver) stays below 1e-5 (1e-4 for a coefficient of 1000, which may also say that it is not solved);
- or the *status* says that there is no certified result, and why: `NotContractive`, `IterationLimit`, `Stagnated`, \
`NotCertified` (the solver met its tolerance, the certificate did not follow);
- or the scene is *refused* before anything is solved, with a message that names the place;
- never a panic, NaN, or a result that is wrong and says nothing;
- *balance*: the largest error of the balances of force, moment and energy of every step, and of negative dissipation, \
below ten times the limit of the certificate;
- cases that are one problem in two forms (units, cuts, restarts, redundant supports) give the same dimensionless results (*as 'X'*: as case X).

Columns: *n_s* subdomains, *rows* of B, *levels* (they count from 0), *products* with F of all levels, *s* seconds.

## What is conserved

With internal forces `K u`, loads `f`, contact forces `c`, reactions `R` at supported nodes, all computed from the mesh and the \
reported nodal values:

- forces and moments: the sum of `f + c + R` and of its moments vanishes at every level;
- energy: `E1 - E0` equals the work of the mean of `f + c + R` of two successive levels in the step between them. For linear \
elasticity this is an identity in the exact solution, for any step length;
- with the forces of the new level alone (backward Euler) the balance is
  `(f1 + R1)(u1 - u0) = (E1 - E0) + D_t + D_n + (u1 - u0) K (u1 - u0) / 2`
  with friction loss `D_t >= 0` and `D_n = -c_n (u1 - u0) >= 0` of nodes that close in the step. The last term is the price of the \
formula: it is never negative and vanishes in sum like the step;
- with the paper's formula `3/2, -2, 1/2` the friction force times *its* difference is never negative; the friction work of the \
displacement increments can be slightly negative at nodes that stick after sliding (see `docs/theory.md`).

";

const BOUNDS: &str = "
## What the expensive cases are bound by

Most cases need 10 to 50 products a level. The others, and what was found in them:

- *Jumps of stiffness between subdomains.* While the interface is not glued yet, the soft copy of a contact node is displaced \
by the error of gluing, which is large in the soft part. Rows on the plain mean of the copies showed this error as slip and \
penetration of the stiff part: wrong faces, error estimates 1e5 times too large, tens of thousands of products. Rows now weigh \
the copies by stiffness (`CopyStiffness`), and the jump has no influence on the number of products. Nodal displacements are the \
same mean, else the energy of the stiff part would carry the error of the soft one.
- *Poisson's ratios near 1/2, and flat elements.* With all its neighbours held, a node can hardly move: the lumped stiffness of its \
row is 120 times (nu = 0.499) to 12000 times (0.49999) the stiffness with the subdomain free; ordinary are 1 to 4. The natural map \
that predicts faces had steps that much too large. They are now limited (to five times the latter). What is left is the \
condition of the preconditioner: conjugate gradients need 100 and more steps on a face, and the estimate of the error, the length \
of the preconditioned residual, is as much too large as the stiffness. These cases are therefore solved more accurately than \
asked (see their certificates), at some times the cost. The Dirichlet preconditioner does not cure it: with all boundary nodes of \
a subdomain held its volume is held, too. It saves up to half of the products in flat bodies and costs more near nu = 1/2.
- *Barely not tipping.* Nearly all nodes of the edge slide, by about a micrometre, and stick and slip change with the last digits. \
Small changes of the rules change the products by a fifth.
- *A coefficient of 1000.* Slip bounds follow normal forces with a factor of 1000, and neither the face method nor successive \
approximations come to rest; the latter see changes that do not shrink and say `NotContractive`. The result reported solves the \
problem of given friction with the last bounds (see its certificate), not Coulomb's. A damped outer loop was not tried. Whether there is a \
solution near is not known.

";

const LOCKING: &str = "
## Locking of linear tetrahedra

The solver copes with Poisson's ratios near 1/2, but the element does not: a linear tetrahedron with nearly no change of \
volume has hardly any way to bend. Deflection of the clamped brick under a transverse force at its end, over that of \
Timoshenko's beam (bending and shear; the clamped end makes a few per cent):

| nu | CELLS |
|---|RULES
ROWS
At nu = 0 halving the cells divides the error by 3 to 4, as linear elements should. At 0.499 it divides it by 1.7 only, and with \
8 cells the bar is still a fifth too stiff, six times the error at nu = 0. (A few per cent of that are real: the clamped end \
stiffens a body that cannot change its volume.) This is a property of the discretisation, not of the solution of its equations: \
the certificates above belong to converged solutions of the locked equations. For rubber use a mixed element (not in this \
library), a finer mesh, or the smallest Poisson's ratio that the question allows.
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
                "\n### {group}\n\n| case | what is hard | what the library did | certificate | balance | n_s | rows | levels | products | s |\n|---|---|---|---|---|---|---|---|---|---|"
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
