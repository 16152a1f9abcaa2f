//! Conjugate gradients on `C x = e`: problems without inequalities, with or without preconditioner.
//!
//! Reference: Farhat, Mandel, Roux, "Optimal convergence properties of the FETI domain decomposition method",
//! Comput. Methods Appl. Mech. Engrg. 115, 1994.
//!
//! | literature | here | meaning |
//! |---|---|---|
//! | `r` | `w.g` | `A x - b`, by recurrence |
//! | `w = P r` | `w.w` | projected gradient |
//! | `y = P M w` | `w.y` | preconditioned and projected again |
//! | `p`, `A p` | `w.p`, `w.ap` | direction and its product |
//!
//! All iterates satisfy the equality. One iteration costs one product with `A`, one projection, and with a
//! preconditioner one product with it and a second projection.

use crate::error::{QpError, expect_finite, expect_lengths};
use crate::problem::{Equality, Identity, SymmetricOperator};
use crate::report::{Status, Tolerance, usable};
use crate::tolerances::{CG_PATIENCE, CG_ROUNDING, FLAT, NEGLIGIBLE_LOAD, PROGRESS, SOLVED_BY_EQUALITY, VANISHED_LOAD};
use crate::vector;

/// Result of [`projected_cg`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[must_use = "it may not have converged: see `status`"]
pub struct CgReport {
    /// How the solve ended.
    pub status: Status,
    /// Iterations.
    pub iterations: usize,
    /// Products with `A`, the first gradient included.
    pub products: usize,
    /// Products with the preconditioner.
    pub preconditionings: usize,
    /// Norm of the projected gradient `P (A x - b)` at the end.
    pub projected_gradient: f64,
    /// Its tolerance.
    pub tolerance: f64,
}

/// Work memory of [`projected_cg`]: five vectors, one coarse one, and the scratches.
pub struct CgWorkspace<A: SymmetricOperator, C: Equality, M: SymmetricOperator = Identity> {
    g: Vec<f64>,
    w: Vec<f64>,
    y: Vec<f64>,
    p: Vec<f64>,
    ap: Vec<f64>,
    coarse: Vec<f64>,
    a_scratch: A::Scratch,
    c_scratch: C::Scratch,
    m_scratch: M::Scratch,
}

impl<A: SymmetricOperator, C: Equality, M: SymmetricOperator> CgWorkspace<A, C, M> {
    /// Work memory for the three operators.
    #[must_use]
    pub fn new(a: &A, c: &C, m: &M) -> Self {
        let v = || vec![0.0; a.dim()];
        Self {
            g: v(),
            w: v(),
            y: v(),
            p: v(),
            ap: v(),
            coarse: vec![0.0; c.rows()],
            a_scratch: a.scratch(),
            c_scratch: c.scratch(),
            m_scratch: m.scratch(),
        }
    }

    /// `A x - b` at the end of the last solve.
    #[must_use]
    pub fn residual(&self) -> &[f64] {
        &self.g
    }

    /// Multiplier `mu` of the equality: `A x - b + Cᵀ mu` is the projected gradient.
    #[must_use]
    pub fn equality_multiplier(&self) -> &[f64] {
        &self.coarse
    }
}

/// Minimises `1/2 x·Ax - b·x` with `C x = e`, from the point of the equality nearest to `x`.
///
/// `m` is a preconditioner, positive definite on the kernel of `C` ([`Identity`] for none). `Tolerance::Relative`
/// refers to `|P b|`, or to `|P A x|` at the start if `P b` is negligible beside it (a load that acts through the
/// equality alone). If both are below 1e-12 of `|b|`, they are rounding errors, and the solution is one of them: a
/// projected gradient of 1e-14 of `|b|` is enough then. A semidefinite `A` is allowed as long as the load does no work
/// along its kernel within that of `C`.
///
/// # Errors
/// [`QpError`] for wrong lengths or NaN; when something becomes NaN; when `A` is indefinite, or singular
/// along a loaded direction.
pub fn projected_cg<A: SymmetricOperator, C: Equality, M: SymmetricOperator>(
    a: &A,
    b: &[f64],
    c: &C,
    e: &[f64],
    m: &M,
    tolerance: Tolerance,
    max_products: usize,
    x: &mut [f64],
    work: &mut CgWorkspace<A, C, M>,
) -> Result<CgReport, QpError> {
    let n = a.dim();
    expect_lengths([
        ("the right side b", b.len(), n),
        ("the start x", x.len(), n),
        ("the equality matrix", c.dim(), n),
        ("the preconditioner", m.dim(), n),
        ("the right side e", e.len(), c.rows()),
        ("the workspace", work.g.len(), n),
        ("the coarse part of the workspace", work.coarse.len(), c.rows()),
    ])?;
    expect_finite("the right side b", b)?;
    expect_finite("the right side e", e)?;
    expect_finite("the start x", x)?;
    let mut run = Run {
        a,
        c,
        m,
        x,
        work,
        report: CgReport {
            status: Status::Converged,
            iterations: 0,
            products: 0,
            preconditionings: 0,
            projected_gradient: f64::NAN,
            tolerance: f64::NAN,
        },
        slope: f64::NAN,
        start: f64::NAN,
        best: f64::NAN,
        waited: 0,
        steepest: 0.0,
    };
    run.start(b, e, tolerance)?;
    run.report.status = loop {
        if let Some(status) = run.ended(max_products)? {
            break status;
        }
        run.precondition();
        run.direction();
        let Some(length) = run.step_length()? else {
            break Status::Stagnated;
        };
        run.advance(length);
    };
    Ok(run.finish())
}

/// One solve.
struct Run<'s, A: SymmetricOperator, C: Equality, M: SymmetricOperator> {
    a: &'s A,
    c: &'s C,
    m: &'s M,
    x: &'s mut [f64],
    work: &'s mut CgWorkspace<A, C, M>,
    report: CgReport,
    /// `w·y` of the last direction.
    slope: f64,
    /// Projected gradient at the start, the smallest so far, and iterations since it.
    start: f64,
    best: f64,
    waited: usize,
    /// Largest `|Ap| / |p|` so far.
    steepest: f64,
}

impl<A: SymmetricOperator, C: Equality, M: SymmetricOperator> Run<'_, A, C, M> {
    /// Moves `x` onto the equality, computes its gradient and resolves the tolerance.
    fn start(&mut self, b: &[f64], e: &[f64], tolerance: Tolerance) -> Result<(), QpError> {
        let load = self.projected_norm(b);
        let w = &mut *self.work;
        // x -= C'(C x - e)
        self.c.apply(self.x, &mut w.coarse, &mut w.c_scratch);
        vector::subtract(e, &mut w.coarse);
        self.c.apply_transpose(&w.coarse, &mut w.y, &mut w.c_scratch);
        vector::subtract(&w.y, self.x);
        self.a.apply(self.x, &mut w.g, &mut w.a_scratch);
        self.report.products += 1;
        // the load may sit in the equality alone
        let product = self.project_gradient();
        let reference = if load > NEGLIGIBLE_LOAD * product {
            load
        } else {
            product
        };
        let size = vector::norm(b);
        let tolerance = usable(match tolerance {
            // what the projector leaves of the load is rounding, and nothing else acts
            Tolerance::Relative(_) if reference <= VANISHED_LOAD * size => SOLVED_BY_EQUALITY * size,
            tolerance => tolerance.resolve(reference),
        })?;
        vector::subtract(b, &mut self.work.g);
        self.start = self.project_gradient();
        self.best = self.start;
        self.report.projected_gradient = self.start;
        self.report.tolerance = tolerance;
        Ok(())
    }

    /// `|P v|`; `w` becomes `P v`.
    fn projected_norm(&mut self, v: &[f64]) -> f64 {
        let w = &mut *self.work;
        project(self.c, v, &mut w.w, &mut w.coarse, &mut w.c_scratch);
        vector::norm(&w.w)
    }

    /// `w = P g`, and its norm.
    fn project_gradient(&mut self) -> f64 {
        let w = &mut *self.work;
        project(self.c, &w.g, &mut w.w, &mut w.coarse, &mut w.c_scratch);
        vector::norm(&w.w)
    }

    /// How the solve ends at this iterate, if it does.
    fn ended(&self, max_products: usize) -> Result<Option<Status>, QpError> {
        let report = &self.report;
        if !report.projected_gradient.is_finite() {
            return Err(QpError::NotFinite {
                quantity: "the gradient",
                products: report.products,
            });
        }
        Ok(if report.projected_gradient <= report.tolerance {
            Some(Status::Converged)
        } else if self.waited >= CG_PATIENCE {
            Some(Status::Stagnated)
        } else if report.products >= max_products {
            Some(Status::IterationLimit)
        } else {
            None
        })
    }

    /// `y = P M w`.
    fn precondition(&mut self) {
        let w = &mut *self.work;
        self.m.apply(&w.w, &mut w.ap, &mut w.m_scratch);
        self.report.preconditionings += 1;
        project(self.c, &w.ap, &mut w.y, &mut w.coarse, &mut w.c_scratch);
    }

    /// The direction `p`, conjugate to the last one, and `ap = A p`.
    fn direction(&mut self) {
        let w = &mut *self.work;
        let slope = vector::dot(&w.w, &w.y);
        if self.report.iterations == 0 {
            vector::copy(&w.y, &mut w.p);
        } else {
            vector::xpby(&w.y, slope / self.slope, &mut w.p);
        }
        self.slope = slope;
        self.a.apply(&w.p, &mut w.ap, &mut w.a_scratch);
        self.report.products += 1;
        self.report.iterations += 1;
    }

    /// The minimising length; `None` where rounding errors have taken over.
    fn step_length(&mut self) -> Result<Option<f64>, QpError> {
        let (w, products) = (&*self.work, self.report.products);
        let (pap, pp) = (vector::dot(&w.p, &w.ap), vector::dot(&w.p, &w.p));
        self.steepest = self.steepest.max((vector::dot(&w.ap, &w.ap) / pp).sqrt());
        let flat = pap.abs() <= FLAT * self.steepest * pp;
        if pap > 0.0 && self.slope > 0.0 && !flat {
            return Ok(Some(self.slope / pap));
        }
        if pap.is_nan() || self.slope.is_nan() {
            return Err(QpError::NotFinite {
                quantity: "a product",
                products,
            });
        }
        // with a positive curvature the preconditioned residual is no longer one
        if pap > 0.0 && !flat || self.report.projected_gradient <= CG_ROUNDING * self.start {
            return Ok(None);
        }
        if flat {
            return Err(QpError::Unbounded { products });
        }
        let curvature = pap / pp;
        Err(QpError::Indefinite { curvature, products })
    }

    /// A step of this length along `-p`.
    fn advance(&mut self, length: f64) {
        vector::axpy(-length, &self.work.p, self.x);
        let w = &mut *self.work;
        vector::axpy(-length, &w.ap, &mut w.g);
        let found = self.project_gradient();
        self.report.projected_gradient = found;
        if found < PROGRESS * self.best {
            (self.best, self.waited) = (found, 0);
        } else {
            self.waited += 1;
        }
    }

    /// Leaves the multiplier `-C (A x - b)` in the workspace.
    fn finish(self) -> CgReport {
        let w = self.work;
        self.c.apply(&w.g, &mut w.coarse, &mut w.c_scratch);
        vector::scale(-1.0, &mut w.coarse);
        self.report
    }
}

/// `out = P v`, the coarse vector becomes `C v`.
fn project<C: Equality>(c: &C, v: &[f64], out: &mut [f64], coarse: &mut [f64], s: &mut C::Scratch) {
    c.apply(v, coarse, s);
    c.apply_transpose(coarse, out, s);
    vector::xpby(v, -1.0, out);
}
