//! The face method: conjugate gradients on the current face, projected by the coarse space of its free
//! components, and a natural map that predicts the next face.
//!
//! Minimises `1/2 xᵀ A x - xᵀ b` over `x` in a [`ProductSet`] with `G x = e`, without a penalty. For
//! fixed sets of held, free and sliding blocks the problem is linear: held components drop out, a
//! point on its circle keeps one component along the tangent with the curvature of the circle,
//! and the rest is solved by conjugate gradients with the projector `P_W`, `W` marking the free
//! components. The face is left as soon as the estimated error has fallen by `forcing`; then
//! `x - a g` tells which blocks are held next (a primal-dual active set step), `x` is moved there, made
//! to satisfy `G x = e` again, and one product keeps `A x` exact.
//!
//! The error estimate is the length of the preconditioned residual: the preconditioner approximates the
//! inverse of `A` on the face, so its length is the distance to the solution up to the quality of
//! the preconditioner.
//!
//! A predicted face must hold every rigid mode; where it does not, points that slide help along their circles, or those
//! that slide least are taken for sticking. The prediction is not monotone in general. After `patience` faces without
//! progress the faces are solved more accurately, every move has to lower the cost, and the set follows the solution
//! only where the problem with the present set is solved. [`Status::Stagnated`] tells that this did not help either;
//! [`smalse`](crate::smalse()) can then continue and is proved to converge.
//!
//! The move to the next face and the next conjugate gradient step share one product: the step is taken with the length of
//! the last one, and conjugate gradients start anew from the exact residual.
//!
//! Where the caller tells how the set follows the solution ([`ActiveSetWorkspace::set_slopes`]), conjugate gradients take it
//! along once the hook has been called.
//!
//! | local | meaning |
//! |---|---|
//! | `x`, `ax` | iterate and `A x`, kept exact by recurrence and one correction a face |
//! | `residual` | `P_Wᵀ (A x - b)` |
//! | `z` | preconditioned residual on the face |
//! | `constrained` | components up to the last constrained one; only these differ between a vector and its part on the face |

use crate::coarse_space::EqualityProjector;
use crate::error::{QpError, expect_finite, expect_length};
use crate::face_run::Run;
use crate::face_settings::{ActiveSetReport, ActiveSetSettings, ActiveSetWorkspace};
use crate::face_view::ActiveSetPreconditioner;
use crate::operator::SymmetricOperator;
use crate::product::ProductSet;
use crate::report::Status;
use crate::set::ConvexSet;

/// The data of one problem; see the [module](self).
#[derive(Debug)]
pub struct ActiveSetProblem<'a, A, M> {
    /// `A`.
    pub operator: &'a A,
    /// Approximates the inverse of `A` on the image of the projector.
    pub preconditioner: &'a M,
    /// Diagonal of the preconditioner, positive on constrained components: turns gradients into steps.
    pub scale: &'a [f64],
    /// `b`.
    pub linear: &'a [f64],
    /// `e`.
    pub rhs: &'a [f64],
}

/// Is told the iterate after each settled face and may change bounds and radii of the set.
pub type ActiveSetHook<'h> = dyn FnMut(&[f64], &mut ProductSet) + 'h;

/// Solves the problem from the start `x`.
///
/// `ax` holds `A x` if `ax_known`, else it is computed. On return both belong to the last iterate, and
/// [`ActiveSetWorkspace::residual`] holds `P_Wᵀ (A x - b)`. `hook` couples the set to the solution (Coulomb
/// friction); pass `&mut |_, _| {}` for a fixed set.
///
/// # Errors
/// [`QpError`] for wrong lengths, settings or sets, for NaN, for an indefinite operator, and
/// [`QpError::CoarseDeficient`] if not even all components together hold the rigid modes.
pub fn active_set<A: SymmetricOperator, C: EqualityProjector, M: ActiveSetPreconditioner>(
    problem: &ActiveSetProblem<'_, A, M>,
    coarse: &mut C,
    set: &mut ProductSet,
    x: &mut [f64],
    ax: &mut [f64],
    ax_known: bool,
    settings: &ActiveSetSettings,
    work: &mut ActiveSetWorkspace<A, M>,
    hook: &mut ActiveSetHook<'_>,
) -> Result<ActiveSetReport, QpError> {
    settings.validate()?;
    check(problem, coarse, set, (x, ax), work)?;
    let mut run = Run::new(problem, coarse, set, (x, ax), settings, work, hook);
    run.start(ax_known)?;
    let status = loop {
        // 1. the face that the natural map predicts, and how far its solution is
        let Some(place) = run.enter_face()? else {
            break Status::Stagnated;
        };
        if run.refreshes(&place) || run.releases(&place) {
            continue;
        }
        if run.is_solved(&place) {
            if run.is_balanced(&place) && run.set_agrees(&place)? {
                break Status::Converged;
            }
            continue;
        }
        run.note_progress(&place);
        if run.in_circles() {
            run.start_guard();
        }
        if let Some(status) = run.gives_up() {
            break status;
        }
        // 2. conjugate gradients on the face
        let length = run.solve_face(&place)?;
        // 3. the natural map moves x to the next face, and the set follows the solution
        run.move_on(length, &place)?;
    };
    Ok(run.finish(status))
}

fn check<A: SymmetricOperator, C: EqualityProjector, M: ActiveSetPreconditioner>(
    problem: &ActiveSetProblem<'_, A, M>,
    coarse: &C,
    set: &ProductSet,
    (x, ax): (&[f64], &[f64]),
    work: &ActiveSetWorkspace<A, M>,
) -> Result<(), QpError> {
    let n = problem.operator.dim();
    for (what, found) in [
        ("x", x.len()),
        ("ax", ax.len()),
        ("the linear term", problem.linear.len()),
        ("the scale", problem.scale.len()),
        ("the preconditioner", problem.preconditioner.dim()),
        ("the set", set.dim()),
        ("the coarse space", coarse.dim()),
        ("the workspace", work.z.len()),
    ] {
        expect_length(what, found, n)?;
    }
    expect_length(
        "the right side of the equality",
        problem.rhs.len(),
        coarse.rows(),
    )?;
    set.validate()?;
    expect_finite("x", x)?;
    expect_finite("the linear term", problem.linear)?;
    expect_finite("the right side of the equality", problem.rhs)?;
    Ok(())
}
