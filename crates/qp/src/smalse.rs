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
//! | `g^K` | `inner.projected_gradient()` | norm of the K-gradient |
//! | `beta > 1` | `1 / shrink` | see [`Update`] |
//!
//! The set is not shifted by `lambda_Im`: because `P Cᵀ = 0` and `Q lambda_Im = lambda_Im` the shift amounts
//! to `C x - e` in place of `C x`. One product with the Hessian `P A P + rho CᵀC` costs one product with
//! `A`, two with `C` and two with `Cᵀ`. Outer steps cost no product: the gradient follows the multiplier,
//! and the growth of the Lagrangian (Step 4) is known from the decrease in Step 1.

use crate::error::{QpError, expect_finite, expect_length, expect_setting};
use crate::kprgp::{drifted, iterate};
use crate::objective::Objective;
use crate::operator::{Equality, SymmetricOperator};
use crate::penalised::Penalised;
use crate::report::{Products, Status, Steps, Tolerance};
use crate::set::ConvexSet;
use crate::smalse_settings::{
    HookAction, OuterHook, OuterStep, SmalseReport, SmalseSettings, SmalseWorkspace, Update,
};
use crate::vector;

/// `M` relative to the norm is not reduced below this: it need not fall below `sqrt(rho lambda_min)`.
const LEAST_PRECISION: f64 = 1e-4;
/// Least reference of the tolerance, relative to the unprojected load.
const ROUNDING: f64 = 1e-7;
/// Outer steps without progress of a stagnating inner solver after which the solve ends.
const MAX_STAGNATIONS: usize = 3;

/// Minimises `1/2 x·Ax - b·x` over `set` with `C x = e`, from the given `x` and `multiplier` (zeros, the
/// last solution or an extrapolation, [`vector::extrapolate`]), which are overwritten by the result.
///
/// `norm` is an upper bound of the norm of `PAP` ([`norm_estimate`](crate::spectrum::norm_estimate) of
/// [`Projected`](crate::projected::Projected)). `hook` is called in every outer step and may change the
/// set; pass `&mut ()` for none. On return `x` is feasible for the set as the hook left it, and the workspace
/// holds the gradient, `A x - b` and the multiplier of the original problem.
///
/// # Errors
/// As for [`kprgp`](crate::kprgp::kprgp()). Not reaching the tolerance is no error: see
/// [`SmalseReport::status`].
///
/// # Example
/// ```
/// use signorini_qp::{DenseEquality, DenseOperator, ProductSet, Segment, SmalseSettings, SmalseWorkspace, smalse};
///
/// // nearest point to (2, 0, 0) with x >= 0 and x0 + x1 + x2 = 1
/// let a = DenseOperator::new(3, vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0])?;
/// let c = DenseEquality::orthonormal(1, 3, &[1.0; 3])?;
/// let e = c.right_side(&[1.0])?;
/// let mut set = ProductSet::new(vec![Segment::lower(vec![0.0; 3])])?;
/// let (mut x, mut multiplier) = (vec![0.0; 3], vec![0.0]);
/// let mut work = SmalseWorkspace::new(&a, &c);
/// let settings = SmalseSettings::default();
/// let report = smalse(
///     &a, &[2.0, 0.0, 0.0], &c, &e, &mut set, 1.0, &settings, &mut (), &mut x, &mut multiplier, &mut work,
/// )?;
/// assert!(report.status.converged());
/// assert!((x[0] - 1.0).abs() < 1e-5 && x[1].abs() < 1e-5);
/// # Ok::<(), signorini_qp::QpError>(())
/// ```
pub fn smalse<A: SymmetricOperator, C: Equality, S: ConvexSet + ?Sized>(
    a: &A,
    b: &[f64],
    c: &C,
    e: &[f64],
    set: &mut S,
    norm: f64,
    settings: &SmalseSettings,
    hook: &mut impl OuterHook<S>,
    x: &mut [f64],
    multiplier: &mut [f64],
    work: &mut SmalseWorkspace<A, C>,
) -> Result<SmalseReport, QpError> {
    let n = a.dim();
    settings.validate()?;
    set.validate()?;
    expect_setting("norm", norm, "> 0, finite", norm > 0.0 && norm.is_finite())?;
    for (what, found, expected) in [
        ("the right side b", b.len(), n),
        ("the start x", x.len(), n),
        ("the set", set.dim(), n),
        ("the equality matrix", c.dim(), n),
        ("the right side e", e.len(), c.rows()),
        ("the multiplier", multiplier.len(), c.rows()),
        ("the workspace", work.residual.len(), n),
        ("the coarse part of the workspace", work.mu.len(), c.rows()),
    ] {
        expect_length(what, found, expected)?;
    }
    for (what, v) in [
        ("the right side b", b),
        ("the right side e", e),
        ("the start x", &*x),
        ("the multiplier", &*multiplier),
    ] {
        expect_finite(what, v)?;
    }

    let v = &mut work.vectors;
    let mut products = Products::default();
    let mut o = Penalised {
        a,
        c,
        b,
        e,
        beta: multiplier,
        norm,
        rho: settings.penalty * norm,
        precision: settings.precision * norm,
        cap: 0.0,
        floor: 0.0,
        equality_tolerance: 0.0,
        s: &mut work.state,
        a_scratch: &mut work.a_scratch,
        c_scratch: &mut work.c_scratch,
    };
    o.s.projections = 0;
    // eps_1 = eps |P h|
    let reference = reference(&mut o, settings.tolerance, &mut v.ap, &mut products);
    o.floor = settings.tolerance.resolve(reference);
    o.cap = settings.gradient_cap * reference;
    expect_setting(
        "tolerance",
        o.floor,
        ">= 0, finite",
        o.floor >= 0.0 && o.floor.is_finite(),
    )?;
    let e_norm = vector::norm(e);

    set.project(x);
    o.gradient(x, &mut v.g);
    v.stale = 0;
    products.initial += 1;
    let mut steps = Steps::default();
    let (mut outer, mut stagnations) = (0, 0);
    // rho and |C x - e| of the step before; none at k = 0 and after the set or the penalty changed
    let mut before: Option<(f64, f64)> = None;
    let mut gradient;
    o.equality_tolerance = settings.equality * vector::norm(x).max(e_norm);
    let status = loop {
        // Step 1: x in the set with |g^K| <= min(M_k |C x - e|, eta)
        let left = settings.inner.max_products.saturating_sub(products.total());
        let inner = iterate(&mut o, set, &settings.inner, left, x, v)?;
        steps += inner.steps;
        products += inner.products;
        gradient = inner.measure;
        outer += 1;
        let equality = o.equality();
        o.equality_tolerance = settings.equality * vector::norm(x).max(e_norm);
        let within = gradient <= o.floor && equality <= o.equality_tolerance;

        let step = OuterStep {
            index: outer - 1,
            x,
            projected_gradient: gradient,
            equality,
            converged: within,
            products: products.total(),
        };
        let action = hook.after_step(&step, set);
        if action == HookAction::SetChanged {
            set.validate()?;
            expect_length("the set after the hook", set.dim(), x.len())?;
            vector::copy(x, &mut v.p);
            set.project(x);
        }
        // Step 2: done?
        if action == HookAction::Stop {
            break Status::Stopped;
        }
        if within && action == HookAction::Continue {
            if !drifted(settings.inner.verification, o.norm(), x, v.stale, o.floor) {
                break Status::Converged;
            }
            o.gradient(x, &mut v.g);
            v.stale = 0;
            products.restart += 1;
            stagnations += 1;
            if stagnations > MAX_STAGNATIONS {
                break Status::Stagnated;
            }
            continue;
        }
        if inner.status == Status::Stagnated {
            stagnations += 1;
            if stagnations > MAX_STAGNATIONS {
                break Status::Stagnated;
            }
        }
        if inner.status == Status::IterationLimit || outer >= settings.max_outer {
            break Status::IterationLimit;
        }
        // Step 4 compares L_k = L(x_k, beta_k) with L_{k-1}. From x_{k-1} with beta_k Step 1 went down by
        // `decrease`, and the new multiplier had added rho |C x_{k-1} - e|² before.
        let grew_enough = before
            .is_none_or(|(rho, c)| rho * c * c - inner.decrease >= 0.5 * rho * equality * equality);
        let fell = before.map_or(0.0, |(_, c)| equality / c);
        // Step 3: beta_{k+1} = beta_k + rho (C x - e)
        before = Some((o.rho, equality));
        o.update_multiplier(&mut v.g);
        let penalty = match settings.update {
            Update::Precision { shrink } if !grew_enough => {
                o.precision = (shrink * o.precision).max(LEAST_PRECISION * norm);
                None
            }
            Update::Penalty { grow, max } if !grew_enough => Some((grow * o.rho).min(max * norm)),
            Update::Residual { ratio, grow, max } if fell > ratio => {
                Some((grow * o.rho).min(max * norm))
            }
            _ => None,
        };
        if let Some(rho) = penalty.filter(|rho| *rho > o.rho) {
            o.set_penalty(rho, &mut v.g);
            // the Lagrangian is another one now
            before = None;
        }
        if action == HookAction::SetChanged {
            if vector::distance_squared(x, &v.p) > 0.0 {
                o.gradient(x, &mut v.g);
                v.stale = 0;
                products.restart += 1;
            }
            before = None;
        }
    };
    o.unproject(&v.g, &mut work.residual, &mut work.mu);
    Ok(SmalseReport {
        status,
        outer,
        steps,
        products,
        projections: o.s.projections,
        projected_gradient: gradient,
        tolerance: o.floor,
        equality: o.equality(),
        equality_tolerance: o.equality_tolerance,
        penalty: o.rho / norm,
        precision: o.precision / norm,
    })
}

/// Reference of the tolerance: the caller's, or `|P (b - A C'e)|`, or `|P b|` for an absolute tolerance.
fn reference<A: SymmetricOperator, C: Equality>(
    o: &mut Penalised<'_, A, C>,
    tolerance: Tolerance,
    h: &mut [f64],
    products: &mut Products,
) -> f64 {
    match tolerance {
        Tolerance::RelativeTo { reference, .. } => return reference,
        Tolerance::Relative(_) if o.e.iter().any(|v| *v != 0.0) => {
            o.c.apply_transpose(o.e, &mut o.s.y, o.c_scratch);
            o.a.apply(&o.s.y, h, o.a_scratch);
            vector::axpby(1.0, o.b, -1.0, h);
            products.reference += 1;
        }
        _ => vector::copy(o.b, h),
    }
    let load = vector::norm(h) + o.norm * vector::norm(o.e);
    o.c.apply(h, &mut o.s.cx, o.c_scratch);
    o.c.apply_transpose(&o.s.cx, &mut o.s.y, o.c_scratch);
    o.s.projections += 1;
    vector::subtract(&o.s.y, h);
    // a load that the equality carries alone leaves nothing but rounding
    vector::norm(h).max(ROUNDING * load)
}
