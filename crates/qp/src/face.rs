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
//! Where the caller tells how the set follows the solution ([`FaceWorkspace::set_slopes`]), conjugate gradients take it
//! along once the hook has been called.
//!
//! | local | meaning |
//! |---|---|
//! | `x`, `ax` | iterate and `A x`, kept exact by recurrence and one correction a face |
//! | `residual` | `P_Wᵀ (A x - b)` |
//! | `z` | preconditioned residual on the face |
//! | `constrained` | components up to the last constrained one; only these differ between a vector and its part on the face |

use crate::coarse_space::CoarseSpace;
use crate::error::{QpError, SetError, expect_finite, expect_length};
use crate::face_cg::{Limits, conjugate_gradients, estimate, precondition, start_residual};
use crate::face_hold::{hold, set_face};
use crate::face_settings::{FaceReport, FaceSettings, FaceWorkspace};
use crate::face_view::{FacePreconditioner, FaceView};
use crate::guard::{Guard, SHORT, SHORTEST, restore};
use crate::operator::SymmetricOperator;
use crate::product::{ProductSet, Segment};
use crate::report::Status;
use crate::set::ConvexSet;
use crate::vector;

/// The data of one problem; see the [module](self).
#[derive(Debug)]
pub struct FaceProblem<'a, A, M> {
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
pub type FaceHook<'h> = dyn FnMut(&[f64], &mut ProductSet) + 'h;

/// Solves the problem from the start `x`.
///
/// `ax` holds `A x` if `ax_known`, else it is computed. On return both belong to the last iterate, and
/// [`FaceWorkspace::residual`] holds `P_Wᵀ (A x - b)`. `hook` couples the set to the solution (Coulomb
/// friction); pass `&mut |_, _| {}` for a fixed set.
///
/// # Errors
/// [`QpError`] for wrong lengths, settings or sets, for NaN, for an indefinite operator, and
/// [`QpError::CoarseDeficient`] if not even all components together hold the rigid modes.
pub fn face<A: SymmetricOperator, C: CoarseSpace, M: FacePreconditioner>(
    problem: &FaceProblem<'_, A, M>,
    coarse: &mut C,
    set: &mut ProductSet,
    x: &mut [f64],
    ax: &mut [f64],
    ax_known: bool,
    settings: &FaceSettings,
    work: &mut FaceWorkspace<A, M>,
    hook: &mut FaceHook<'_>,
) -> Result<FaceReport, QpError> {
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
    settings.validate()?;
    set.validate()?;
    expect_finite("x", x)?;
    expect_finite("the linear term", problem.linear)?;
    expect_finite("the right side of the equality", problem.rhs)?;

    let mut report = FaceReport::new();
    let constrained = constrained_length(set);
    let shapes: Vec<(u8, usize)> = set.segments().iter().map(shape).collect();
    work.resize(constrained);
    work.coupling.start(set, constrained);

    // start: a feasible point that satisfies G x = e
    vector::copy(x, &mut work.t);
    set.project(x);
    work.face.resize(set);
    work.face.guess(set, x);
    if let Err(QpError::CoarseDeficient { .. }) = set_face(coarse, set, work, &mut report, false) {
        // held by its constraints only: forces that balance with all of them at work tell the first face
        work.face.free_all();
        set_face(coarse, set, work, &mut report, false)?;
        coarse.repair(x, problem.rhs);
        follow(hook, x, set, &shapes, &mut report)?;
        set.project(x);
        work.face.guess(set, x);
        if let Err(QpError::CoarseDeficient { .. }) =
            set_face(coarse, set, work, &mut report, false)
        {
            work.face.free_all();
            set_face(coarse, set, work, &mut report, false)?;
        }
    }
    coarse.repair(x, problem.rhs);
    correct(problem, x, ax, ax_known, work, &mut report);

    // bodies that only contact holds are touchier: every move of theirs changes constrained components
    let apart = coarse.repairs_apart();
    let mut last_jump = f64::INFINITY;
    let mut peak = vector::norm(x);
    let mut forcing = settings.forcing;
    let mut best = f64::INFINITY;
    let mut waited = 0;
    // error estimate after the last face
    let mut left = (f64::INFINITY, f64::INFINITY);
    let mut guard: Option<Guard> = None;
    // whether the hook was called at the last move, and the constrained error that the last face began with
    let (mut followed, mut begun) = (false, f64::INFINITY);
    // with a guard: whether the set followed the last face, how far x moved then, and very short steps in a row
    let (mut current, mut drift, mut held_up) = (true, f64::INFINITY, 0);
    loop {
        residual(problem, coarse, ax, work);
        work.face
            .classify(set, x, &work.residual, problem.scale, settings.natural_step);
        let sparing = guard.is_some() || !apart;
        match hold(problem, coarse, set, x, work, &mut report, sparing) {
            Ok(true) => residual(problem, coarse, ax, work),
            Ok(false) => {}
            Err(QpError::CoarseDeficient { .. }) => {
                report.status = Status::Stagnated;
                return Ok(report);
            }
            Err(error) => return Err(error),
        }
        let view = FaceView::new(set, &work.face);
        problem
            .preconditioner
            .enter(&view, &mut work.preconditioner);
        start_residual(set, work);
        let rho = precondition(problem, coarse, set, work, &mut report);
        let (x_norm, c_norm) = (vector::norm(x), vector::norm(&x[..constrained]));
        let limits = Limits::new(settings.tolerance, x_norm, c_norm, settings.least);
        let errors = estimate(work);
        report.error = ratio(errors.0, limits.all / settings.tolerance);
        report.constrained_error = ratio(errors.1, limits.constrained / settings.tolerance);
        if !(errors.0.is_finite() && x_norm.is_finite()) {
            return Err(QpError::NotFinite {
                quantity: "the error estimate",
                products: report.products(),
            });
        }
        // the jump is what the last move to the predicted face changed
        let settled =
            report.faces == 0 || current && last_jump <= limits.constrained.max(f64::MIN_POSITIVE);
        if peak > SHRUNK * x_norm {
            // A x still carries the rounding errors of a much larger x
            peak = x_norm;
            correct(problem, x, ax, false, work, &mut report);
            residual(problem, coarse, ax, work);
            continue;
        }
        peak = peak.max(x_norm);
        // with a guard the set follows the solution only where the problem with the present set is solved
        let solved = errors.1 <= (FOLLOW * drift).max(limits.constrained);
        let any = !work.face.blocked.is_empty();
        if let Some(guard) = &mut guard
            && guard.releases(any, solved, errors.1, limits.constrained)
        {
            work.face.blocked.clear();
            continue;
        }
        let small = errors.0 <= limits.all && errors.1 <= limits.constrained;
        // held bounds are judged again by the residual of this face, which the last classification did not have
        if small
            && settled
            && set.violation(x) <= limits.constrained
            && !work.face.contradicted(
                set,
                x,
                &work.residual,
                problem.scale,
                settings.natural_step,
                limits.constrained,
            )
        {
            if !followed {
                // the set may never have followed the solution
                work.face.radii(set, &mut work.before);
                follow(hook, x, set, &shapes, &mut report)?;
                followed = true;
                if set.violation(x) > limits.constrained
                    || work.face.grew(set, &work.before, limits.constrained)
                {
                    continue;
                }
            }
            report.status = Status::Converged;
            return Ok(report);
        }
        let measure =
            (errors.0 / limits.all).max(errors.1.max(last_jump.min(f64::MAX)) / limits.constrained);
        if measure < 0.9 * best {
            best = measure;
            waited = 0;
        } else if report.faces > 0 {
            waited += 1;
        }
        if waited >= settings.patience && guard.is_none() {
            // predictions run in circles: solve the faces better, and descend
            guard = Some(Guard::new(n));
            forcing *= FINER;
            best = measure;
            waited = 0;
            if !apart {
                vector::copy(x, &mut work.t);
                work.face.loose_weights(set, &mut work.z);
                restore(coarse, set, x, problem.rhs, &work.z)?;
                last_jump = last_jump.max(set.violation(x));
                correct(problem, x, ax, true, work, &mut report);
                continue;
            }
        }
        if waited >= settings.patience.saturating_mul(LONGER) || held_up >= HELD_UP {
            report.status = Status::Stagnated;
            return Ok(report);
        }
        let longer = if guard.is_some() { LONGER } else { 1 };
        let faces = settings.max_faces.saturating_mul(longer);
        if report.faces >= faces || report.products() >= settings.max_products {
            report.status = Status::IterationLimit;
            return Ok(report);
        }
        if let Some(guard) = &mut guard {
            guard.enter(x, ax, &work.residual);
        }
        let free = followed && guard.is_none() && apart;
        work.coupling.begin(free, report.constrained_error, waited);
        let goal = work.coupling.forcing(forcing, last_jump, begun);
        begun = errors.1;
        let step = conjugate_gradients(
            problem,
            coarse,
            set,
            x,
            ax,
            rho,
            settings.max_products,
            goal,
            &limits,
            (
                MAGNIFIED * (last_jump + left.0),
                MAGNIFIED * (last_jump + left.1),
            ),
            work,
            &mut report,
        )?;
        left = estimate(work);
        report.faces += 1;
        if let Some(guard) = &mut guard
            && guard.leave(x, ax)
        {
            waited = 0;
        }

        // the natural map predicts the next face, and x moves there, with the next step on top: without constraints
        // there is no move to share a product with, and with a guard only what descends is taken
        vector::copy(x, &mut work.t);
        let joint = if constrained > 0 && guard.is_none() && apart {
            settings.joint_step * step
        } else {
            0.0
        };
        if joint > 0.0 {
            vector::axpy(joint, &work.p, x);
        }
        work.before.copy_from_slice(&x[..constrained]);
        let natural = settings.natural_step;
        work.face
            .settle_bounds(set, x, &work.residual, problem.scale, natural);
        let few = (settings.settled * work.face.free_bounds as f64).max(2.0);
        let call = (guard.is_none() || solved) && work.face.changed as f64 <= few;
        current = guard.is_none() || call;
        followed = call;
        if call {
            follow(hook, x, set, &shapes, &mut report)?;
            // held components go with bounds that moved
            work.face
                .settle_bounds(set, x, &work.residual, problem.scale, natural);
        }
        work.face
            .settle_discs(set, x, &work.residual, problem.scale, natural);
        last_jump = vector::distance(&x[..constrained], &work.before);
        if guard.is_some() {
            // z is free until the next face
            work.face.loose_weights(set, &mut work.z);
        }
        if guard.is_some() && !apart {
            restore(coarse, set, x, problem.rhs, &work.z)?;
            // where set and equality do not meet, this does not fall
            last_jump =
                vector::distance(&x[..constrained], &work.t[..constrained]).max(set.violation(x));
            correct(problem, x, ax, true, work, &mut report);
        } else if last_jump > 0.0 || joint > 0.0 {
            if last_jump > 0.0 {
                coarse.repair(x, problem.rhs);
            }
            correct(problem, x, ax, true, work, &mut report);
        }
        let Some(guard) = &mut guard else { continue };
        if current {
            drift = last_jump;
            continue;
        }
        let mut t = 1.0;
        while t > SHORTEST && !guard.descends(x, ax, t) {
            guard.shorten(t, x, ax);
            vector::copy(x, &mut work.t);
            restore(coarse, set, x, problem.rhs, &work.z)?;
            // where set and equality do not meet, this does not fall
            last_jump =
                vector::distance(&x[..constrained], &work.t[..constrained]).max(set.violation(x));
            correct(problem, x, ax, true, work, &mut report);
            t *= 0.5;
        }
        held_up = if t > 16.0 * SHORTEST || !apart {
            0
        } else {
            held_up + 1
        };
        let (rises, reach) = guard.judge(set, x, ax, t);
        if t < SHORT {
            let (from, step) = guard.path();
            let more = work.face.block(set, from, step, reach);
            if rises && more {
                guard.back(x, ax);
                last_jump = f64::INFINITY;
            }
        } else {
            work.face.blocked.clear();
        }
    }
}

/// An error after a jump larger than that many times the jump and the error before it comes from bad conditioning, and
/// has to fall further than `forcing` before the face tells anything.
const MAGNIFIED: f64 = 10.0;

/// Factor on the forcing after faces without progress.
const FINER: f64 = 0.05;

/// With a guard: factor on patience and faces; share of the last move of the set to which its problem is solved before the
/// set follows again; very short steps in a row that end it.
const LONGER: usize = 5;
const FOLLOW: f64 = 0.1;
const HELD_UP: usize = 20;

/// Norm of the largest iterate over that of the present one from which on `A x` is computed afresh.
const SHRUNK: f64 = 1e5;

/// Components up to the last constrained one.
fn constrained_length(set: &ProductSet) -> usize {
    let mut end = 0;
    let mut constrained = 0;
    for segment in set.segments() {
        end += segment.len();
        if !matches!(segment, Segment::Free(_)) {
            constrained = end;
        }
    }
    constrained
}

/// Calls the hook, which may change the data of segments but not the segments.
fn follow(
    hook: &mut FaceHook<'_>,
    x: &[f64],
    set: &mut ProductSet,
    shapes: &[(u8, usize)],
    report: &mut FaceReport,
) -> Result<(), QpError> {
    hook(x, set);
    report.hook_calls += 1;
    set.validate()?;
    if set.segments().iter().map(shape).eq(shapes.iter().copied()) {
        Ok(())
    } else {
        let wanted = "the segments that it had before the hook";
        Err(SetError::Kind { segment: 0, wanted }.into())
    }
}

/// Kind and length of a segment.
fn shape(segment: &Segment) -> (u8, usize) {
    let kind = match segment {
        Segment::Free(_) => 0,
        Segment::Bounds { .. } => 1,
        Segment::Discs { .. } => 2,
    };
    (kind, segment.len())
}

fn ratio(a: f64, b: f64) -> f64 {
    if a == 0.0 { 0.0 } else { a / b }
}

/// `residual = P_Wᵀ (A x - b)`.
fn residual<A: SymmetricOperator, C: CoarseSpace, M: SymmetricOperator>(
    problem: &FaceProblem<'_, A, M>,
    coarse: &mut C,
    ax: &[f64],
    work: &mut FaceWorkspace<A, M>,
) {
    vector::copy(ax, &mut work.residual);
    vector::axpy(-1.0, problem.linear, &mut work.residual);
    coarse.project_transpose(&mut work.residual);
}

/// `ax += A (x - t)`, or `ax = A x`.
fn correct<A: SymmetricOperator, M: SymmetricOperator>(
    problem: &FaceProblem<'_, A, M>,
    x: &[f64],
    ax: &mut [f64],
    known: bool,
    work: &mut FaceWorkspace<A, M>,
    report: &mut FaceReport,
) {
    if known {
        for (t, v) in work.t.iter_mut().zip(x) {
            *t = v - *t;
        }
        if work.t.iter().all(|t| *t == 0.0) {
            return;
        }
        problem
            .operator
            .apply(&work.t, &mut work.ap, &mut work.operator);
        vector::axpy(1.0, &work.ap, ax);
    } else {
        problem.operator.apply(x, ax, &mut work.operator);
    }
    report.corrections += 1;
}
