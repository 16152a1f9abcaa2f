//! SMALSE: minimise `1/2 x·Ax - b·x` over a separable convex set with `C x = e`. Algorithm 4.1 of the paper.
//!
//! References: Haslinger, Kucera, Vlach, Baniotopoulos, "Approximation and numerical realization of 3D
//! quasistatic contact problems with Coulomb friction", section 5, (5.28) to (5.30) and Algorithm 4.1;
//! Z. Dostal, "Optimal Quadratic Programming Algorithms", Springer 2009 (\[4\] of the paper).
//!
//! | paper | here | meaning |
//! |---|---|---|
//! | `lambda = mu + lambda_Im` | `x` | unknown, **not shifted** |
//! | `F`, `h` | `a`, `P (b - A C'e)` | Hessian and load |
//! | `G`, `e` | `c`, `e` | equality with orthonormal rows |
//! | `beta` | `multiplier` | multiplier of `C x = e` in the projected problem |
//! | `rho`, `M_k`, `eta`, `eps_1` | `o.rho`, `o.precision`, `o.cap`, `o.floor` | in the units of the gradient |
//! | `g^K` | `inner.projected_gradient` | norm of the K-gradient |
//! | `beta > 1` | `1 / shrink` | how the precision control shrinks |
//!
//! The set is not shifted by `lambda_Im`: because `P Cᵀ = 0` and `Q lambda_Im = lambda_Im` the shift amounts
//! to `C x - e` in place of `C x`. One product with the Hessian `P A P + rho CᵀC` costs one product with
//! `A`, two with `C` and two with `Cᵀ`. Outer steps cost no product: the gradient follows the multiplier,
//! and the growth of the Lagrangian (Step 4) is known from the decrease in Step 1.

use crate::error::{QpError, expect_finite, expect_length, expect_lengths};
use crate::kprgp::{KprgpReport, Objective, Vectors, drifted, iterate};
use crate::problem::{ConstrainedCost, ConvexSet, Equality, Hook, MovingSet, QuadraticCost, SymmetricOperator};
use crate::report::{Products, Status, Steps};
use crate::settings::expect_setting;
use crate::tolerances::{LEAST_PRECISION, LEAST_RESPONSE, PROJECTED_LOAD, STAGNATIONS};
use crate::vector;

use super::penalised::Penalised;
use super::settings::{SmalseReport, SmalseSettings, SmalseWorkspace};

/// Minimises `cost` over a set, from the given `x` and `multiplier` (zeros, the last solution or an extrapolation,
/// [`vector::extrapolate`]), which are overwritten by the result.
///
/// The set may move after Step 1 of every outer step; if that matters, `x` is projected on it again and the solve goes
/// on. On return `x` is feasible for the set as it was when that last mattered, and the workspace holds the gradient,
/// `A x - b` and the multiplier of the original problem.
///
/// # Errors
/// As for [`kprgp`](crate::kprgp()). Not reaching the tolerance is no error: see
/// [`SmalseReport::status`].
///
/// # Example
/// ```
/// use signorini_qp::{
///     DenseEquality, DenseOperator, MovingSet, ProductSet, QuadraticCost, Segment, SmalseSettings, smalse,
/// };
/// use signorini_qp::smalse::SmalseWorkspace;
///
/// // nearest point to (2, 0, 0) with x >= 0 and x0 + x1 + x2 = 1
/// let a = DenseOperator::new(3, vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0])?;
/// let c = DenseEquality::orthonormal(1, 3, &[1.0; 3])?;
/// let e = c.right_side(&[1.0])?;
/// let mut set = ProductSet::new(vec![Segment::lower(vec![0.0; 3])])?;
/// let (mut x, mut multiplier) = (vec![0.0; 3], vec![0.0]);
/// let mut work = SmalseWorkspace::new(&a, &c);
/// let settings = SmalseSettings::default();
/// let cost = QuadraticCost::new(&a, &[2.0, 0.0, 0.0], 1.0).with_equality(&c, &e);
/// let report = smalse(&cost, MovingSet::fixed(&mut set), &mut x, &mut multiplier, &settings, &mut work)?;
/// assert!(report.status.converged());
/// assert!((x[0] - 1.0).abs() < 1e-5 && x[1].abs() < 1e-5);
/// # Ok::<(), signorini_qp::QpError>(())
/// ```
pub fn smalse<A: SymmetricOperator, C: Equality, S: ConvexSet + ?Sized>(
    cost: &ConstrainedCost<'_, A, C>,
    MovingSet { set, hook }: MovingSet<'_, S>,
    x: &mut [f64],
    multiplier: &mut [f64],
    settings: &SmalseSettings,
    work: &mut SmalseWorkspace<A, C>,
) -> Result<SmalseReport, QpError> {
    let &ConstrainedCost { ref cost, c, e } = cost;
    let &QuadraticCost { a, b, norm } = cost;
    settings.validate()?;
    set.validate()?;
    expect_setting("norm", norm, "(0, inf)")?;
    let n = a.dim();
    expect_lengths([
        ("the right side b", b.len(), n),
        ("the start x", x.len(), n),
        ("the set", set.dim(), n),
        ("the equality matrix", c.dim(), n),
        ("the right side e", e.len(), c.rows()),
        ("the multiplier", multiplier.len(), c.rows()),
        ("the workspace", work.residual.len(), n),
        ("the coarse part of the workspace", work.mu.len(), c.rows()),
    ])?;
    for (what, v) in [
        ("the right side b", b),
        ("the right side e", e),
        ("the start x", &*x),
        ("the multiplier", &*multiplier),
    ] {
        expect_finite(what, v)?;
    }
    work.state.projections = 0;
    let mut run = Run {
        o: Penalised {
            cost,
            c,
            e,
            beta: multiplier,
            rho: settings.penalty * norm,
            precision: settings.precision * norm,
            cap: 0.0,
            floor: 0.0,
            equality_tolerance: 0.0,
            s: &mut work.state,
            a_scratch: &mut work.a_scratch,
            c_scratch: &mut work.c_scratch,
        },
        least: vector::norm(e).max(settings.least),
        set,
        settings,
        hook: hook.map(|hook| hook as _),
        x,
        v: &mut work.vectors,
        steps: Steps::default(),
        products: Products::default(),
        outer: 0,
        stagnations: 0,
        before: None,
        gradient: f64::NAN,
        within: false,
    };
    run.start()?;
    let status = loop {
        // Step 1: x in the set with |g^K| <= min(M_k |C x - e|, eta)
        let inner = run.minimise()?;
        let changed = run.call_hook()?;
        // Step 2: done?
        match run.judge(inner.status, changed) {
            Verdict::End(status) => {
                if changed {
                    run.follow_set();
                }
                break status;
            }
            Verdict::Again => continue,
            Verdict::Update => {}
        }
        // Step 3: beta_{k+1} = beta_k + rho (C x - e); Step 4: M_{k+1}
        let grew = run.lagrangian_grew(inner.decrease);
        run.update_multiplier();
        if !grew {
            run.shrink_precision();
        }
        if changed {
            run.follow_set();
        }
    };
    let report = run.report(status);
    run.o.unproject(&run.v.g, &mut work.residual, &mut work.mu);
    Ok(report)
}

/// One solve.
struct Run<'s, A: SymmetricOperator, C: Equality, S: ?Sized> {
    o: Penalised<'s, A, C>,
    set: &'s mut S,
    settings: &'s SmalseSettings,
    hook: Option<&'s mut Hook<'s, S>>,
    x: &'s mut [f64],
    v: &'s mut Vectors,
    /// What the equality is measured against if `x` is smaller: `|e|`, what rounding errors of the load make of `x`, or
    /// what counts as nothing.
    least: f64,
    steps: Steps,
    products: Products,
    outer: usize,
    stagnations: usize,
    /// `|C x - e|` of the step before; none at `k = 0` and after the set changed.
    before: Option<f64>,
    /// `|g^K|` at the end of Step 1, and whether it and `|C x - e|` are within their tolerances.
    gradient: f64,
    within: bool,
}

/// What Step 2 decides.
enum Verdict {
    End(Status),
    /// Step 1 again, with a gradient computed afresh.
    Again,
    /// On to Steps 3 and 4.
    Update,
}

impl<A: SymmetricOperator, C: Equality, S: ConvexSet + ?Sized> Run<'_, A, C, S> {
    /// Tolerances, and the first gradient.
    fn start(&mut self) -> Result<(), QpError> {
        let settings = self.settings;
        // eps_1 = eps |P h|
        let (load, rounding) = reference(&mut self.o, &mut self.v.ap, &mut self.products);
        self.least = self.least.max(rounding / self.o.cost.norm);
        self.set.project(self.x);
        self.v.compute_gradient(&mut self.o, self.x);
        self.products.initial += 1;
        // without a load the set alone pushes
        let reference = if load > 0.0 { load } else { vector::norm(&self.v.g) };
        let reference = reference.max(LEAST_RESPONSE * self.o.cost.norm * settings.least);
        self.o.floor = settings.tolerance * reference;
        self.o.cap = settings.gradient_cap * reference;
        self.set_equality_tolerance();
        Ok(())
    }

    fn set_equality_tolerance(&mut self) {
        let size = vector::norm(self.x).max(self.least);
        self.o.equality_tolerance = self.settings.equality * size;
    }

    /// Step 1, by KPRGP.
    fn minimise(&mut self) -> Result<KprgpReport, QpError> {
        let settings = &self.settings.inner;
        let left = settings.max_products.saturating_sub(self.products.total());
        let inner = iterate(&mut self.o, &*self.set, settings, left, self.x, self.v)?;
        self.steps += inner.steps;
        self.products += inner.products;
        self.gradient = inner.projected_gradient;
        self.outer += 1;
        self.set_equality_tolerance();
        self.within = self.gradient <= self.o.floor && self.o.equality() <= self.o.equality_tolerance;
        Ok(inner)
    }

    /// The hook; if it changed the set, `x` is projected on it, and `v.p` keeps it as it was.
    fn call_hook(&mut self) -> Result<bool, QpError> {
        let Some(hook) = &mut self.hook else {
            return Ok(false);
        };
        let changed = hook(self.x, self.set);
        self.set.validate()?;
        expect_length("the set after the hook", self.set.dim(), self.x.len())?;
        if changed {
            vector::copy(self.x, &mut self.v.p);
            self.set.project(self.x);
        }
        Ok(changed)
    }

    /// Step 2.
    fn judge(&mut self, inner: Status, changed: bool) -> Verdict {
        let done = self.within && !changed;
        if done {
            if !drifted(self.o.hessian_norm(), self.x, self.v.stale, self.o.floor) {
                return Verdict::End(Status::Converged);
            }
            self.v.compute_gradient(&mut self.o, self.x);
            self.products.restart += 1;
        }
        if done || inner == Status::Stagnated {
            self.stagnations += 1;
            if self.stagnations > STAGNATIONS {
                return Verdict::End(Status::Stagnated);
            }
        }
        if done {
            Verdict::Again
        } else if inner == Status::IterationLimit || self.outer >= self.settings.max_outer {
            Verdict::End(Status::IterationLimit)
        } else {
            Verdict::Update
        }
    }

    /// Whether the Lagrangian grew enough since the step before. Step 4 compares `L_k = L(x_k, beta_k)` with
    /// `L_{k-1}`: from `x_{k-1}` with `beta_k` Step 1 went down by `decrease`, and the new multiplier had added `rho
    /// |C x_{k-1} - e|²` before.
    fn lagrangian_grew(&self, decrease: f64) -> bool {
        let (rho, equality) = (self.o.rho, self.o.equality());
        let enough = |c: f64| rho * c * c - decrease >= 0.5 * rho * equality * equality;
        self.before.is_none_or(enough)
    }

    /// Step 3.
    fn update_multiplier(&mut self) {
        self.before = Some(self.o.equality());
        self.o.update_multiplier(&mut self.v.g);
    }

    /// Step 4.
    fn shrink_precision(&mut self) {
        let o = &mut self.o;
        o.precision = (self.settings.shrink * o.precision).max(LEAST_PRECISION * o.cost.norm);
    }

    /// After a change of the set: the gradient at the projected `x`.
    fn follow_set(&mut self) {
        if vector::distance_squared(self.x, &self.v.p) > 0.0 {
            self.v.compute_gradient(&mut self.o, self.x);
            self.products.restart += 1;
        }
        self.before = None;
    }

    fn report(&self, status: Status) -> SmalseReport {
        SmalseReport {
            status,
            outer: self.outer,
            steps: self.steps,
            products: self.products,
            projections: self.o.s.projections,
            projected_gradient: self.gradient,
            tolerance: self.o.floor,
            equality: self.o.equality(),
            equality_tolerance: self.o.equality_tolerance,
            precision: self.o.precision / self.o.cost.norm,
        }
    }
}

/// Reference of the tolerance, `|P (b - A C'e)|`, and what of it may be rounding errors of a load that the equality
/// carries alone.
fn reference<A: SymmetricOperator, C: Equality>(
    o: &mut Penalised<'_, A, C>,
    h: &mut [f64],
    products: &mut Products,
) -> (f64, f64) {
    if o.e.iter().any(|v| *v != 0.0) {
        o.c.apply_transpose(o.e, &mut o.s.y, o.c_scratch);
        o.cost.a.apply(&o.s.y, h, o.a_scratch);
        vector::axpby(1.0, o.cost.b, -1.0, h);
        products.reference += 1;
    } else {
        vector::copy(o.cost.b, h);
    }
    let rounding = PROJECTED_LOAD * (vector::norm(h) + o.cost.norm * vector::norm(o.e));
    o.c.apply(h, &mut o.s.cx, o.c_scratch);
    o.c.apply_transpose(&o.s.cx, &mut o.s.y, o.c_scratch);
    o.s.projections += 1;
    vector::subtract(&o.s.y, h);
    (vector::norm(h).max(rounding), rounding)
}
