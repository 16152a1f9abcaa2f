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

use crate::error::{QpError, expect_finite, expect_length, expect_setting};
use crate::operator::{Equality, SymmetricOperator};
use crate::report::{Status, Tolerance};
use crate::vector;

/// `|P b|` below this fraction of `|P A x|` is no reference.
const NEGLIGIBLE: f64 = 1e-10;

/// Iterations without a smaller residual after which the solve ends.
const PATIENCE: usize = 300;

/// Residual, relative to the first, below which a curvature that is not positive is put down to rounding.
const ROUNDING: f64 = 1e-8;

/// The identity as operator: no preconditioner.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Identity(
    /// Dimension.
    pub usize,
);

impl SymmetricOperator for Identity {
    type Scratch = ();
    fn dim(&self) -> usize {
        self.0
    }
    fn scratch(&self) -> Self::Scratch {}
    fn apply(&self, x: &[f64], y: &mut [f64], _s: &mut ()) {
        vector::copy(x, y);
    }
}

/// Result of [`projected_cg`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
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

    /// `out = P v`, the coarse vector becomes `C v`.
    fn project(c: &C, v: &[f64], out: &mut [f64], coarse: &mut [f64], s: &mut C::Scratch) {
        c.apply(v, coarse, s);
        c.apply_transpose(coarse, out, s);
        vector::xpby(v, -1.0, out);
    }
}

/// Minimises `1/2 x·Ax - b·x` with `C x = e`, from the point of the equality nearest to `x`.
///
/// `m` is a preconditioner, positive definite on the kernel of `C` ([`Identity`] for none).
/// `Tolerance::Relative` refers to `|P b|`, or to `|P A x|` at the start if `P b` is negligible beside it (a load that
/// acts through the equality alone). A semidefinite `A` is allowed as long as the load does no work
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
    for (what, found, expected) in [
        ("the right side b", b.len(), n),
        ("the start x", x.len(), n),
        ("the equality matrix", c.dim(), n),
        ("the preconditioner", m.dim(), n),
        ("the right side e", e.len(), c.rows()),
        ("the workspace", work.g.len(), n),
        (
            "the coarse part of the workspace",
            work.coarse.len(),
            c.rows(),
        ),
    ] {
        expect_length(what, found, expected)?;
    }
    expect_finite("the right side b", b)?;
    expect_finite("the right side e", e)?;
    expect_finite("the start x", x)?;
    let CgWorkspace {
        g,
        w,
        y,
        p,
        ap,
        coarse,
        a_scratch,
        c_scratch,
        m_scratch,
    } = work;
    let project = CgWorkspace::<A, C, M>::project;

    project(c, b, w, coarse, c_scratch);
    let load = vector::norm(w);

    // x -= C'(C x - e)
    c.apply(x, coarse, c_scratch);
    vector::subtract(e, coarse);
    c.apply_transpose(coarse, y, c_scratch);
    vector::subtract(y, x);
    a.apply(x, g, a_scratch);
    // the load may sit in the equality alone
    project(c, g, w, coarse, c_scratch);
    let product = vector::norm(w);
    let reference = if load > NEGLIGIBLE * product {
        load
    } else {
        product
    };
    let tolerance = tolerance.resolve(reference);
    expect_setting(
        "tolerance",
        tolerance,
        ">= 0, finite",
        tolerance >= 0.0 && tolerance.is_finite(),
    )?;
    vector::subtract(b, g);
    project(c, g, w, coarse, c_scratch);
    let mut report = CgReport {
        status: Status::Converged,
        iterations: 0,
        products: 1,
        preconditionings: 0,
        projected_gradient: vector::norm(w),
        tolerance,
    };
    let mut wy_before = f64::NAN;
    let start = report.projected_gradient;
    let (mut best, mut waited) = (start, 0);
    loop {
        let products = report.products;
        if !report.projected_gradient.is_finite() {
            return Err(QpError::NotFinite {
                quantity: "the gradient",
                products,
            });
        }
        if report.projected_gradient <= tolerance {
            break;
        }
        if products >= max_products {
            report.status = Status::IterationLimit;
            break;
        }
        m.apply(w, ap, m_scratch);
        report.preconditionings += 1;
        project(c, ap, y, coarse, c_scratch);
        let wy = vector::dot(w, y);
        if report.iterations == 0 {
            vector::copy(y, p);
        } else {
            vector::xpby(y, wy / wy_before, p);
        }
        wy_before = wy;
        a.apply(p, ap, a_scratch);
        report.products += 1;
        report.iterations += 1;
        let pap = vector::dot(p, ap);
        if !(pap > 0.0 && wy > 0.0) {
            if pap.is_nan() || wy.is_nan() {
                return Err(QpError::NotFinite {
                    quantity: "a product",
                    products: report.products,
                });
            }
            if pap > 0.0 || report.projected_gradient <= ROUNDING * start {
                // rounding errors have taken over: the preconditioned residual is no longer one
                report.status = Status::Stagnated;
                break;
            }
            let curvature = pap / vector::dot(p, p);
            return Err(QpError::Indefinite {
                curvature,
                products: report.products,
            });
        }
        let t = wy / pap;
        vector::axpy(-t, p, x);
        vector::axpy(-t, ap, g);
        project(c, g, w, coarse, c_scratch);
        report.projected_gradient = vector::norm(w);
        if report.projected_gradient < 0.9 * best {
            best = report.projected_gradient;
            waited = 0;
        } else {
            waited += 1;
        }
        if waited >= PATIENCE {
            report.status = Status::Stagnated;
            break;
        }
    }
    // the multiplier -C (A x - b)
    c.apply(g, coarse, c_scratch);
    vector::scale(-1.0, coarse);
    Ok(report)
}
