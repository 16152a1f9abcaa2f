//! KPRGP: minimise `1/2 x·Ax - b·x` over a separable convex set.
//!
//! References: R. Kucera, "Minimizing quadratic functions with separable quadratic constraints", Optim.
//! Methods Softw. 22, 2007, and "Convergence rate of an optimization algorithm for minimizing quadratic
//! functions with separable convex constraints", SIAM J. Optim. 19, 2008 (\[15\], \[16\] of the paper). For
//! bounds alone it is MPRGP of Z. Dostal and J. Schoeberl, Comput. Optim. Appl. 30, 2005.
//!
//! | literature | here | meaning |
//! |---|---|---|
//! | `g` | `v.g` | gradient `A x - b`, updated by recurrence in CG steps |
//! | `phi` | `v.phi` | free gradient |
//! | `beta`, reduced beta | `norms.chopped`, `norms.reduced_chopped` | squared norms of the chopped gradient |
//! | `p`, `A p` | `v.p`, `v.ap` | conjugate direction and its product |
//! | `Gamma` | `settings.proportioning` | proportioning constant |
//! | `alpha bar` | `fixed` | fixed step length, `step_length / norm` |
//! | `alpha_cg`, `alpha_f` | `t_cg`, `t_f` | minimising and feasible step along `p` |
//!
//! One iteration: if `x` is *proportional*, `|reduced beta|² <= Gamma² (reduced phi · phi)`, a conjugate
//! gradient step is tried; if it leaves the set, the step is cut at the boundary and an *expansion*
//! follows. If `x` is not proportional, a *proportioning* step releases active blocks. After both the
//! conjugate directions start again from the free gradient.

use crate::error::{QpError, expect_finite, expect_lengths};
use crate::problem::{ConvexSet, GradientNorms, QuadraticCost, SymmetricOperator};
use crate::report::{Products, Status, Steps};
use crate::settings::expect_setting;
use crate::tolerances::{
    COST_RISE, DRIFTED, FAILED_CHECKS, KPRGP_PATIENCE, KPRGP_PROGRESS, LONG_STEP, NEGATIVE_CURVATURE, ROUNDED_GRADIENT,
};
use crate::vector;

use super::objective::{Objective, Plain};
use super::settings::{Expansion, KprgpReport, KprgpSettings, KprgpWorkspace, Vectors};

/// Minimises `cost` over `set`, starting from the projection of `x`.
///
/// `tolerance` is that of the projected gradient over `|b|`, or over the norm of the first
/// gradient where that is zero. On return `x` is feasible, and
/// [`KprgpWorkspace::gradient`] holds `A x - b`.
///
/// # Errors
/// [`QpError`] for wrong lengths, settings, NaN in the arguments, a wrong set; when something becomes
/// NaN or infinite; when `A` is indefinite or the problem unbounded. Not reaching the tolerance is no
/// error: see [`KprgpReport::status`].
///
/// # Example
/// ```
/// use signorini_qp::{DenseOperator, KprgpSettings, ProductSet, QuadraticCost, Segment, kprgp};
/// use signorini_qp::kprgp::KprgpWorkspace;
///
/// let a = DenseOperator::new(2, vec![2.0, -1.0, -1.0, 2.0])?;
/// let set = ProductSet::new(vec![Segment::lower(vec![0.0, 0.0])])?;
/// let mut x = [0.0, 0.0];
/// let mut work = KprgpWorkspace::new(&a);
/// let cost = QuadraticCost::new(&a, &[1.0, -3.0], 3.0);
/// let report = kprgp(&cost, &set, 1e-10, &KprgpSettings::default(), &mut x, &mut work)?;
/// assert!(report.status.converged());
/// assert!((x[0] - 0.5).abs() < 1e-9 && x[1] == 0.0);
/// # Ok::<(), signorini_qp::QpError>(())
/// ```
pub fn kprgp<A: SymmetricOperator, S: ConvexSet + ?Sized>(
    cost: &QuadraticCost<'_, A>,
    set: &S,
    tolerance: f64,
    settings: &KprgpSettings,
    x: &mut [f64],
    work: &mut KprgpWorkspace<A>,
) -> Result<KprgpReport, QpError> {
    let &QuadraticCost { a, b, norm } = cost;
    let n = a.dim();
    settings.validate()?;
    set.validate()?;
    expect_setting("norm", norm, "(0, inf)")?;
    expect_setting("tolerance", tolerance, "[0, inf)")?;
    expect_lengths([
        ("the right side b", b.len(), n),
        ("the start x", x.len(), n),
        ("the set", set.dim(), n),
        ("the workspace", work.vectors.g.len(), n),
    ])?;
    expect_finite("the right side b", b)?;
    expect_finite("the start x", x)?;
    let mut objective = Plain {
        cost,
        tolerance: 0.0,
        scratch: &mut work.scratch,
    };
    let v = &mut work.vectors;
    set.project(x);
    v.compute_gradient(&mut objective, x);
    let load = vector::norm(b);
    objective.tolerance = tolerance * if load > 0.0 { load } else { vector::norm(&v.g) };
    if objective.tolerance.is_nan() {
        return Err(QpError::NotFinite {
            quantity: "the gradient",
            products: 1,
        });
    }
    let mut report = iterate(
        &mut objective,
        set,
        settings,
        settings.max_products.saturating_sub(1),
        x,
        v,
    )?;
    report.products.initial += 1;
    report.cost = 0.5 * (vector::dot(x, &v.g) - vector::dot(x, b));
    Ok(report)
}

/// Whether the rounding that the recurrence accumulated in `stale` updates may matter against `tolerance`.
pub(crate) fn drifted(norm: f64, x: &[f64], stale: usize, tolerance: f64) -> bool {
    stale > 0 && f64::EPSILON * (stale as f64) * norm * vector::norm(x) > DRIFTED * tolerance
}

/// The iteration, from a feasible `x` whose gradient is in `v.g`.
pub(crate) fn iterate<O: Objective, S: ConvexSet + ?Sized>(
    objective: &mut O,
    set: &S,
    settings: &KprgpSettings,
    max_products: usize,
    x: &mut [f64],
    v: &mut Vectors,
) -> Result<KprgpReport, QpError> {
    let mut run = Run {
        fixed: settings.step_length / objective.hessian_norm(),
        o: objective,
        set,
        settings,
        x,
        v,
        spectral: f64::INFINITY,
        norms: GradientNorms::default(),
        steps: Steps::default(),
        products: Products::default(),
        decrease: 0.0,
        halvings: 0,
    };
    run.restart();
    let (mut best, mut waited, mut failed_checks) = (f64::INFINITY, 0, 0);
    let status = loop {
        let (measure, tolerance) = (run.norms.projected(), run.o.tolerance());
        if !measure.is_finite() {
            return Err(QpError::NotFinite {
                quantity: "the gradient",
                products: run.products.total(),
            });
        }
        if measure <= tolerance {
            if !drifted(run.o.hessian_norm(), run.x, run.v.stale, tolerance) {
                break Status::Converged;
            }
            run.v.compute_gradient(run.o, run.x);
            run.products.restart += 1;
            run.restart();
            if run.norms.projected() > run.o.tolerance() {
                failed_checks += 1;
                if failed_checks >= FAILED_CHECKS {
                    break Status::Stagnated;
                }
            }
            continue;
        }
        if measure < KPRGP_PROGRESS * best {
            (best, waited) = (measure, 0);
        } else {
            waited += 1;
            if waited >= KPRGP_PATIENCE {
                if measure <= ROUNDED_GRADIENT * run.o.hessian_norm() * vector::norm(run.x) {
                    break Status::Stagnated;
                }
                waited = 0;
            }
        }
        if run.products.total() >= max_products {
            break Status::IterationLimit;
        }
        // proportional? (Kucera 2008; Dostal and Schoeberl 2005, (2.7))
        let gamma = settings.proportioning;
        if run.norms.reduced_chopped <= gamma * gamma * run.norms.reduced_free_dot {
            run.conjugate()?;
        } else {
            run.proportioning()?;
        }
    };
    Ok(KprgpReport {
        status,
        steps: run.steps,
        products: run.products,
        projected_gradient: run.norms.projected(),
        tolerance: run.o.tolerance(),
        halvings: run.halvings,
        decrease: run.decrease,
        cost: f64::NAN,
    })
}

/// One run.
struct Run<'a, O, S: ?Sized> {
    o: &'a mut O,
    set: &'a S,
    settings: &'a KprgpSettings,
    x: &'a mut [f64],
    v: &'a mut Vectors,
    /// Fixed step length, and the Barzilai-Borwein length of the last release.
    fixed: f64,
    spectral: f64,
    norms: GradientNorms,
    steps: Steps,
    products: Products,
    decrease: f64,
    halvings: usize,
}

impl<O: Objective, S: ConvexSet + ?Sized> Run<'_, O, S> {
    fn split(&mut self) {
        self.norms = (self.set).split(self.x, &self.v.g, self.fixed, &mut self.v.phi);
    }

    /// Splits the gradient and starts new conjugate directions from the free gradient.
    fn restart(&mut self) {
        self.split();
        vector::copy(&self.v.phi, &mut self.v.p);
    }

    /// `t` minimising the cost along `-p` for slope `gp = g·p` and curvature `pap = p·Ap`. Infinite where the
    /// curvature is below rounding; but where the slope is, too, the fixed step, which lowers the cost whatever the
    /// curvature is.
    fn minimising(&self, p: &[f64], gp: f64, pap: f64) -> Result<f64, QpError> {
        let products = self.products.total();
        if !(gp.is_finite() && pap.is_finite()) {
            return Err(QpError::NotFinite {
                quantity: "a product with the operator",
                products,
            });
        }
        let (norm, pp) = (self.o.hessian_norm(), vector::dot(p, p));
        if pap > 0.0 && !below_rounding(pap, norm, pp) {
            return Ok(gp / pap);
        }
        if pap < -NEGATIVE_CURVATURE * norm * pp {
            return Err(QpError::Indefinite {
                curvature: pap / pp,
                products,
            });
        }
        let size = norm * vector::norm(self.x) + vector::norm(&self.v.g);
        if gp <= (ROUNDED_GRADIENT * size).max(self.o.tolerance()) * pp.sqrt() {
            return Ok(self.fixed);
        }
        Ok(f64::INFINITY)
    }

    /// Conjugate gradient step, followed by an expansion if it leaves the set.
    fn conjugate(&mut self) -> Result<(), QpError> {
        let v = &mut *self.v;
        let mut gp = vector::dot(&v.phi, &v.p);
        if gp <= 0.0 {
            // conjugacy lost to rounding
            vector::copy(&v.phi, &mut v.p);
            gp = self.norms.free;
        }
        self.o.direction(&v.p, &mut v.ap);
        self.products.cg += 1;
        let pap = vector::dot(&v.p, &v.ap);
        let t_cg = self.minimising(&self.v.p, gp, pap)?;
        let t_f = self.set.feasible_step(self.x, &self.v.p);
        self.straight(t_cg.min(t_f), gp, pap)?;
        if t_cg <= t_f {
            self.steps.cg += 1;
            let pp = vector::dot(&self.v.p, &self.v.p);
            if below_rounding(pap, self.o.hessian_norm(), pp) {
                self.restart();
                return Ok(());
            }
            self.split();
            let v = &mut *self.v;
            let gamma = vector::dot(&v.phi, &v.ap) / pap;
            vector::xpby(&v.phi, -gamma, &mut v.p);
        } else {
            self.steps.expansion += 1;
            self.expand(t_cg - t_f);
            self.restart();
        }
        Ok(())
    }

    /// A step of length `t` along `-p` within the set, with slope `gp` and curvature `pap`; the gradient by recurrence.
    fn straight(&mut self, t: f64, gp: f64, pap: f64) -> Result<(), QpError> {
        if t == f64::INFINITY {
            return Err(QpError::Unbounded {
                products: self.products.total(),
            });
        }
        self.set.advance(self.x, &self.v.p, t);
        self.follow(t);
        self.decrease += t * (gp - 0.5 * t * pap);
        Ok(())
    }

    /// The gradient after a step of length `t` along the direction whose product is in `ap`.
    fn follow(&mut self, t: f64) {
        vector::axpy(-t, &self.v.ap, &mut self.v.g);
        self.o.moved(t);
        self.v.stale += 1;
    }

    /// From the boundary point `x` to a point with more active blocks. `rest` is what is left of the conjugate
    /// gradient step.
    fn expand(&mut self, rest: f64) {
        self.split();
        if self.norms.free == 0.0 {
            // nothing free is left to expand along; the gradient at x is known
            return;
        }
        // the gradient before the step goes to ap, the point to p
        vector::copy(&self.v.g, &mut self.v.ap);
        self.products.expansion += 1;
        if self.settings.expansion == Expansion::ProjectedCg && rest.is_finite() && rest > 0.0 {
            vector::step_keeping_start(&mut self.v.p, self.x, rest);
            let gained = self.project();
            if gained >= LONG_STEP * self.fixed * self.norms.reduced_free_dot {
                self.decrease += gained;
                return;
            }
            self.products.fallback += 1;
            vector::copy(&self.v.p, self.x);
        } else {
            vector::copy(self.x, &mut self.v.p);
        }
        let gained = self.projected_step(self.fixed);
        self.check_fixed(gained);
        self.decrease += gained;
    }

    /// `x = P(x - t phi)`; what it gained from the point in `p`.
    fn projected_step(&mut self, t: f64) -> f64 {
        vector::axpy(-t, &self.v.phi, self.x);
        self.project()
    }

    fn project(&mut self) -> f64 {
        self.set.project(self.x);
        self.v.compute_gradient(self.o, self.x);
        vector::decrease(&self.v.p, &self.v.ap, self.x, &self.v.g)
    }

    /// A fixed step from `p` to `x` cannot raise the cost beyond rounding unless the norm was too small.
    fn check_fixed(&mut self, gained: f64) {
        if gained < 0.0 {
            let rounding = f64::EPSILON * vector::norm(self.x) * vector::norm(&self.v.ap);
            let explained = COST_RISE * vector::distance_squared(self.x, &self.v.p) / self.fixed;
            if -gained > explained + 64.0 * rounding {
                self.fixed *= 0.5;
                self.halvings += 1;
            }
        }
    }

    /// Releases active blocks.
    fn proportioning(&mut self) -> Result<(), QpError> {
        self.steps.proportioning += 1;
        self.products.proportioning += 1;
        let v = &mut *self.v;
        self.set.chopped(self.x, &v.g, &mut v.p);
        let t_f = self.set.feasible_step(self.x, &v.p);
        if t_f >= self.fixed {
            // a straight line along -beta: the minimising length, gradient by recurrence
            self.o.direction(&v.p, &mut v.ap);
            let (gp, pap) = (vector::dot(&v.p, &v.g), vector::dot(&v.p, &v.ap));
            let t = self.minimising(&self.v.p, gp, pap)?.min(t_f);
            self.straight(t, gp, pap)?;
        } else {
            self.release();
        }
        self.restart();
        Ok(())
    }

    /// Projected step `x = P(x - t (g - phi))` on the active blocks, the reduced chopped gradient. Its length is that
    /// of Barzilai and Borwein of the last release: points that slide along their discs move at their own scale.
    fn release(&mut self) {
        let long = self.spectral.is_finite() && self.spectral > self.fixed;
        let mut t = if long { self.spectral } else { self.fixed };
        // phi turns into g on active blocks; the point before the step goes to p, its gradient to ap
        let v = &mut *self.v;
        vector::axpby(1.0, &v.g, -1.0, &mut v.phi);
        vector::copy(self.x, &mut v.p);
        vector::copy(&v.g, &mut v.ap);
        loop {
            let gained = self.projected_step(t);
            if t > self.fixed && gained < LONG_STEP * self.fixed * self.norms.reduced_chopped {
                self.products.fallback += 1;
                vector::copy(&self.v.p, self.x);
                t = self.fixed;
                continue;
            }
            if t == self.fixed {
                self.check_fixed(gained);
            }
            self.decrease += gained;
            break;
        }
        let v = &mut *self.v;
        vector::axpby(1.0, self.x, -1.0, &mut v.p);
        vector::axpby(1.0, &v.g, -1.0, &mut v.ap);
        let (ss, sy) = (vector::dot(&v.p, &v.p), vector::dot(&v.p, &v.ap));
        self.spectral = if sy > 0.0 { ss / sy } else { f64::INFINITY };
    }
}

/// Whether a curvature `p·Ap` is rounding error, or has underflowed.
fn below_rounding(pap: f64, norm: f64, pp: f64) -> bool {
    pap <= f64::EPSILON * norm * pp
}
