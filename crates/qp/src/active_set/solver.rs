//! The loop of the active-set method.
//!
//! Minimises `1/2 xᵀ A x - xᵀ b` over `x` in a [`ProductSet`] with `G x = e`, without a penalty. For fixed sets of
//! active, free and sliding blocks the problem is linear: active components drop out, a point on its circle keeps one
//! component along the tangent with the curvature of the circle, and the rest is solved by conjugate gradients with
//! the projector `P_W`, `W` marking the free components. The active set is left as soon as the estimated error has
//! fallen by `forcing`; then `x - a g` tells which blocks are active next (a primal-dual active-set step), `x` is
//! moved there, made to satisfy `G x = e` again, and one product keeps `A x` exact. That product is shared with the
//! next step of conjugate gradients, of the length of the last one. A set of which much has just changed is not solved:
//! this step leads over it, and over the first one where the product of the start is known before the set has moved it.
//! Where predictions run in circles, or away from a start that told nothing, a path of compliant constraints leads to
//! another set ([`path`](super::path)).
//!
//! The error is the length of the preconditioned residual. [`Status::Stagnated`] tells that `PATIENCE` sets have made no
//! progress behind the last path either; [`smalse`](crate::smalse()) lowers a cost in every step, and is proved to
//! converge with [`Expansion::FixedStep`](crate::Expansion).
//!
//! | local | meaning |
//! |---|---|
//! | `x`, `ax` | iterate and `A x`, kept exact by recurrence and one correction a set but a last one of next to nothing |
//! | `residual`, `restricted` | `P_Wᵀ (A x - b)`, and its constrained part on the active set |
//! | `z` | preconditioned residual on the active set |
//! | `constrained` | components up to the last constrained one; only these differ on the set |

use crate::error::{QpError, expect_finite, expect_length, expect_lengths};
use crate::problem::{ConvexSet, EqualityProjector, MovingSet, ProductSet, SymmetricOperator};
use crate::report::Status;
use crate::tolerances::PATIENCE;

use super::problem::{ActiveSetPoint, ActiveSetProblem};
use super::run::Run;
use super::settings::{ActiveSetReport, ActiveSetSettings};
use super::view::ActiveSetPreconditioner;
use super::workspace::ActiveSetWorkspace;

/// Solves the problem from the start `point`, which becomes the solution.
///
/// On return [`ActiveSetWorkspace::residual`] holds `P_Wᵀ (A x - b)`. The set may move after each settled active set,
/// whatever its hook answers.
///
/// # Errors
/// [`QpError`] for wrong lengths, settings or sets, for NaN, for an indefinite operator, and
/// [`QpError::CoarseDeficient`] if not even all components together determine the multiplier of the equality.
pub fn active_set<A: SymmetricOperator, C: EqualityProjector, M: ActiveSetPreconditioner>(
    problem: &ActiveSetProblem<'_, A, M>,
    projector: &mut C,
    set: MovingSet<'_, ProductSet>,
    point: ActiveSetPoint<'_>,
    settings: &ActiveSetSettings,
    work: &mut ActiveSetWorkspace<A, M>,
) -> Result<ActiveSetReport, QpError> {
    let enters_only = std::mem::take(&mut work.enters_only);
    check(problem, projector, set.set, &point, (settings, work))?;
    let mut run = Run::new(problem, projector, set, point, settings, work)?;
    if enters_only {
        run.start()?;
        run.enter()?;
        run.at.report.status = Status::IterationLimit;
        return Ok(run.at.report);
    }
    let status = solve(&mut run)?;
    Ok(run.finish(status))
}

/// From the start to a solution, or to where the run gives up.
fn solve<A: SymmetricOperator, C: EqualityProjector, M: ActiveSetPreconditioner>(
    run: &mut Run<'_, A, C, M>,
) -> Result<Status, QpError> {
    run.start()?;
    loop {
        // 1. the active set that the natural map predicts, and how far its solution is
        let Some(place) = run.enter()? else {
            return Ok(Status::Stagnated);
        };
        if run.refreshes(&place) {
            continue;
        }
        if run.sets_out(&place)? {
            continue;
        }
        if run.is_solved(&place) {
            if run.is_balanced(&place) && run.set_agrees(&place)? {
                return Ok(Status::Converged);
            }
            continue;
        }
        if run.catches_up() {
            continue;
        }
        if run.hardens(&place) {
            continue;
        }
        run.note_progress(&place);
        if run.in_circles(run.settings.patience) {
            return Ok(Status::Stagnated);
        }
        if run.wants_path(&place) {
            run.begin_path();
            continue;
        }
        if run.in_circles(PATIENCE) {
            if run.leave_path() {
                continue;
            }
            return Ok(Status::Stagnated);
        }
        if let Some(status) = run.gives_up() {
            return Ok(status);
        }
        // 2. conjugate gradients on it
        let length = run.solve_on_set(&place)?;
        // 3. the natural map moves x to the next active set, and the set follows the solution
        run.move_on(length, &place)?;
    }
}

fn check<A: SymmetricOperator, C: EqualityProjector, M: ActiveSetPreconditioner>(
    problem: &ActiveSetProblem<'_, A, M>,
    projector: &C,
    set: &ProductSet,
    ActiveSetPoint { x, ax, .. }: &ActiveSetPoint<'_>,
    (settings, work): (&ActiveSetSettings, &ActiveSetWorkspace<A, M>),
) -> Result<(), QpError> {
    settings.validate()?;
    let n = problem.operator.dim();
    expect_lengths([
        ("x", x.len(), n),
        ("ax", ax.len(), n),
        ("the linear term", problem.linear.len(), n),
        ("the scale", problem.scale.len(), n),
        ("the preconditioner", problem.preconditioner.dim(), n),
        ("the set", set.dim(), n),
        ("the projector", projector.dim(), n),
        ("the workspace", work.z.len(), n),
    ])?;
    if !work.known.is_empty() {
        expect_length("the known components", work.known.len(), set.constrained())?;
        expect_finite("the known components", &work.known)?;
    }
    expect_length("the right side of the equality", problem.rhs.len(), projector.rows())?;
    set.validate()?;
    expect_finite("x", x)?;
    expect_finite("the linear term", problem.linear)?;
    let scale = &problem.scale[..set.constrained()];
    expect_finite("the scale", scale)?;
    if let Some(entry) = scale.iter().position(|s| *s <= 0.0) {
        let value = scale[entry];
        return Err(QpError::Scale { entry, value });
    }
    expect_finite("the right side of the equality", problem.rhs)
}
