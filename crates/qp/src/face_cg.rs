//! Projected preconditioned conjugate gradients on one face.
//!
//! The face restricts constrained components only. The residual on the face is therefore the vector `residual` with its
//! leading part replaced by `face_residual`; no second long vector is kept. Curvature enters before the projection: the
//! rigid amplitudes are fitted to the residual on the face, else the projected matrix is not symmetric.
//!
//! | local | meaning |
//! |---|---|
//! | `residual` | `P_Wᵀ (A x - b + kappa s)`, `s` the steps so far |
//! | `face_residual` | its constrained part, restricted to the face |
//! | `z` | `P_W R (D M D + T) R` of the residual on the face; `R` restricts, `D = 1 / (1 + kappa m)` (`D²` in `docs/theory.md`) and `T` account for the curvature |
//! | `p`, `ap` | direction, and `A p + kappa p`, then `P_Wᵀ` of it, then restricted |
//! | `q` | `E p`, what `x` moves by; `p` where radii are fixed ([`face_coupling`](crate::face_coupling)) |
//! | `rho` | residual on the face times `z` |

use crate::coarse_space::CoarseSpace;
use crate::error::QpError;
use crate::face::FaceProblem;
use crate::face_settings::{FaceReport, FaceWorkspace};
use crate::operator::SymmetricOperator;
use crate::product::ProductSet;
use crate::vector;

/// Part of the norm of `x` that vanishing constrained components are measured against.
const SMALL_PART: f64 = 1e-4;

/// Absolute limits of the two error estimates.
pub(crate) struct Limits {
    pub(crate) all: f64,
    pub(crate) constrained: f64,
}

impl Limits {
    /// `least` is what a vanishing solution is measured against, and a small part of it vanishing constrained components.
    pub(crate) fn new(tolerance: f64, x_norm: f64, c_norm: f64, least: f64) -> Self {
        let all = x_norm.max(least);
        Self {
            all: tolerance * all,
            constrained: tolerance * c_norm.max(SMALL_PART * all),
        }
    }
}

/// Lengths of `z` and of its constrained part.
pub(crate) fn estimate<A: SymmetricOperator, M: SymmetricOperator>(
    work: &FaceWorkspace<A, M>,
) -> (f64, f64) {
    let z = &work.z;
    (work.z_norm, vector::norm(&z[..work.face_residual.len()]))
}

/// The residual on the face from `residual`.
pub(crate) fn start_residual<A: SymmetricOperator, M: SymmetricOperator>(
    set: &ProductSet,
    work: &mut FaceWorkspace<A, M>,
) {
    let constrained = work.face_residual.len();
    work.face_residual
        .copy_from_slice(&work.residual[..constrained]);
    work.face.restrict(set, &mut work.face_residual);
}

/// `z` from the residual on the face; sets its norm and returns `rho`.
pub(crate) fn precondition<A: SymmetricOperator, C: CoarseSpace, M: SymmetricOperator>(
    problem: &FaceProblem<'_, A, M>,
    coarse: &mut C,
    set: &ProductSet,
    work: &mut FaceWorkspace<A, M>,
    report: &mut FaceReport,
) -> f64 {
    let FaceWorkspace {
        residual,
        face_residual,
        saved,
        z,
        face,
        ..
    } = work;
    let constrained = face_residual.len();
    saved.copy_from_slice(&residual[..constrained]);
    residual[..constrained].copy_from_slice(face_residual);
    face.damp(set, &mut residual[..constrained]);
    problem
        .preconditioner
        .apply(residual, z, &mut work.preconditioner);
    let part = &mut z[..constrained];
    face.restrict(set, part);
    face.damp(set, part);
    face.add_own(set, face_residual, part);
    coarse.project(z);
    report.preconditionings += 1;
    residual[..constrained].copy_from_slice(face_residual);
    let (rho, square) = vector::dot_and_square(residual, z);
    residual[..constrained].copy_from_slice(saved);
    work.z_norm = square.sqrt();
    rho
}

/// Most steps on one face: where more are needed, rounding has taken over or the face is not worth it.
const MOST_STEPS: usize = 500;

/// Runs until both estimates have fallen by `forcing` from the smaller of their values now and those `expected`, or below
/// the limits; `z` is ready, with `rho`. Returns the length of the last step if another one is worth while; its direction
/// is then `p`.
pub(crate) fn conjugate_gradients<A: SymmetricOperator, C: CoarseSpace, M: SymmetricOperator>(
    problem: &FaceProblem<'_, A, M>,
    coarse: &mut C,
    set: &ProductSet,
    x: &mut [f64],
    ax: &mut [f64],
    rho: f64,
    max_products: usize,
    forcing: f64,
    limits: &Limits,
    expected: (f64, f64),
    work: &mut FaceWorkspace<A, M>,
    report: &mut FaceReport,
) -> Result<f64, QpError> {
    let mut rho = rho;
    // not by a factor of zero: what an earlier solve has left need not be finite
    vector::copy(&work.z, &mut work.p);
    vector::scale(-1.0, &mut work.p);
    let first = estimate(work);
    let start = (first.0.min(expected.0), first.1.min(expected.1));
    let last = max_products.min(report.products() + MOST_STEPS);
    let mut steps = 0;
    // below a third of the limits further steps buy nothing
    let goal = |(all, part): (f64, f64)| {
        all <= (forcing * start.0).max(0.3 * limits.all)
            && part <= (forcing * start.1).max(0.3 * limits.constrained)
    };
    loop {
        if report.products() >= last || rho <= 0.0 {
            return Ok(0.0);
        }
        let coupled = work.coupling.on;
        if coupled {
            work.coupling.extend(coarse, set, &work.face, &work.p);
        }
        let q = if coupled {
            &work.coupling.step
        } else {
            &work.p
        };
        problem.operator.apply(q, &mut work.ap, &mut work.operator);
        report.cg_steps += 1;
        steps += 1;
        let plain = vector::dot(&work.p, &work.ap);
        let curvature = plain + work.face.curvature(set, &work.p);
        if !curvature.is_finite() {
            return Err(QpError::NotFinite {
                quantity: "the curvature",
                products: report.products(),
            });
        }
        if curvature <= 0.0 && coupled {
            work.coupling.failed = true;
            return Ok(0.0);
        }
        if curvature <= 0.0 {
            let pp = vector::dot(&work.p, &work.p);
            if plain < -1e-10 * vector::norm(&work.ap) * pp.sqrt() {
                return Err(QpError::Indefinite {
                    curvature: curvature / pp,
                    products: report.products(),
                });
            }
            return Ok(0.0);
        }
        let step = rho / curvature;
        vector::axpy(step, q, x);
        vector::axpy(step, &work.ap, ax);
        let constrained = work.face_residual.len();
        work.face
            .add_curvature(set, &work.p, &mut work.ap[..constrained]);
        coarse.project_transpose(&mut work.ap);
        vector::axpy(step, &work.ap, &mut work.residual);
        let part = &mut work.ap[..constrained];
        work.face.restrict(set, part);
        vector::axpy(step, part, &mut work.face_residual);
        let next = precondition(problem, coarse, set, work, report);
        let errors = estimate(work);
        let beta = if coupled {
            vector::dot(&work.z, &work.ap) / curvature
        } else {
            next / rho
        };
        vector::axpby(-1.0, &work.z, beta, &mut work.p);
        rho = next;
        if goal(errors) {
            let more = errors.0 > limits.all || errors.1 > limits.constrained;
            return Ok(if more { step } else { 0.0 });
        }
        if work.coupling.too_strong(steps, first.0, errors.0) {
            return Ok(0.0);
        }
    }
}
