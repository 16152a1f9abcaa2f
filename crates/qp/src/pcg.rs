//! Projected preconditioned conjugate gradients for problems without inequalities.
//!
//! Minimises `1/2 xᵀ A x - xᵀ b` subject to `G x = e`: the linear problem of a body without contact. Starts from a point
//! that satisfies the equality and stays on it.
//!
//! | local | meaning |
//! |---|---|
//! | `r` | `Pᵀ (b - A x)` |
//! | `z` | preconditioned residual `P M r`; its length estimates the error of `x` |
//! | `p`, `ap` | direction and `A p` |
//! | `rho` | `r·z` |

use crate::coarse_space::CoarseSpace;
use crate::error::{QpError, expect_finite, expect_length};
use crate::operator::SymmetricOperator;
use crate::report::Status;
use crate::vector;

/// What [`projected_cg`] did.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CgReport {
    /// How it ended.
    pub status: Status,
    /// Operator products: one to start unless `A x` was known, one a step.
    pub products: usize,
    /// Applications of the preconditioner.
    pub preconditionings: usize,
    /// Estimated error of `x` relative to its norm.
    pub error: f64,
}

/// Vectors of the method: five of the length of `x`.
#[derive(Debug)]
pub struct CgWorkspace<A: SymmetricOperator, M: SymmetricOperator> {
    operator: A::Scratch,
    preconditioner: M::Scratch,
    residual: Vec<f64>,
    z: Vec<f64>,
    p: Vec<f64>,
    ap: Vec<f64>,
}

impl<A: SymmetricOperator, M: SymmetricOperator> CgWorkspace<A, M> {
    /// Allocates everything the method needs.
    pub fn new(operator: &A, preconditioner: &M) -> Self {
        let v = || vec![0.0; operator.dim()];
        Self {
            operator: operator.scratch(),
            preconditioner: preconditioner.scratch(),
            residual: v(),
            z: v(),
            p: v(),
            ap: v(),
        }
    }

    /// `Pᵀ (A x - b)` at the last iterate.
    #[must_use]
    pub fn residual(&self) -> &[f64] {
        &self.residual
    }
}

/// Solves from the start `x` to the relative error `tolerance` with at most `max_products` products.
///
/// `coarse` must carry the weights it is to be used with (all ones for a body without contact). `ax` holds `A x` if
/// `ax_known`, and `A x` on return.
///
/// # Errors
/// [`QpError`] for wrong lengths, NaN and an indefinite operator.
pub fn projected_cg<A: SymmetricOperator, C: CoarseSpace, M: SymmetricOperator>(
    a: &A,
    preconditioner: &M,
    coarse: &mut C,
    b: &[f64],
    e: &[f64],
    x: &mut [f64],
    ax: &mut [f64],
    ax_known: bool,
    tolerance: f64,
    max_products: usize,
    work: &mut CgWorkspace<A, M>,
) -> Result<CgReport, QpError> {
    let n = a.dim();
    for (what, found) in [("x", x.len()), ("ax", ax.len()), ("b", b.len()), ("the workspace", work.z.len())] {
        expect_length(what, found, n)?;
    }
    expect_finite("x", x)?;
    expect_finite("b", b)?;
    let mut report =
        CgReport { status: Status::IterationLimit, products: 0, preconditionings: 0, error: f64::INFINITY };
    // onto the equality, keeping A x exact
    vector::copy(x, &mut work.p);
    coarse.repair(x, e);
    if ax_known {
        for (p, v) in work.p.iter_mut().zip(&*x) {
            *p = v - *p;
        }
        if work.p.iter().any(|v| *v != 0.0) {
            a.apply(&work.p, &mut work.ap, &mut work.operator);
            vector::axpy(1.0, &work.ap, ax);
            report.products += 1;
        }
    } else {
        a.apply(x, ax, &mut work.operator);
        report.products += 1;
    }
    let mut rho = 0.0;
    loop {
        vector::copy(ax, &mut work.residual);
        vector::axpy(-1.0, b, &mut work.residual);
        coarse.project_transpose(&mut work.residual);
        preconditioner.apply(&work.residual, &mut work.z, &mut work.preconditioner);
        coarse.project(&mut work.z);
        report.preconditionings += 1;
        let (error, size) = (vector::norm(&work.z), vector::norm(x));
        if !(error.is_finite() && size.is_finite()) {
            return Err(QpError::NotFinite { quantity: "the residual", products: report.products });
        }
        report.error = if error == 0.0 { 0.0 } else { error / size };
        if error <= tolerance * size {
            report.status = Status::Converged;
            return Ok(report);
        }
        if report.products >= max_products {
            return Ok(report);
        }
        let next = vector::dot(&work.residual, &work.z);
        if next <= 0.0 {
            report.status = Status::Stagnated;
            return Ok(report);
        }
        // work.residual = -r and work.z = -P M r: the direction is built from z's negative
        if rho == 0.0 {
            for (p, z) in work.p.iter_mut().zip(&work.z) {
                *p = -z;
            }
        } else {
            let ratio = next / rho;
            for (p, z) in work.p.iter_mut().zip(&work.z) {
                *p = ratio * *p - z;
            }
        }
        rho = next;
        a.apply(&work.p, &mut work.ap, &mut work.operator);
        report.products += 1;
        let curvature = vector::dot(&work.p, &work.ap);
        if curvature <= 0.0 {
            let pp = vector::dot(&work.p, &work.p);
            return Err(QpError::Indefinite { curvature: curvature / pp, products: report.products });
        }
        let step = rho / curvature;
        vector::axpy(step, &work.p, x);
        vector::axpy(step, &work.ap, ax);
    }
}
