//! Projected preconditioned conjugate gradients on one active set.
//!
//! It restricts constrained components only. The residual on the active set is therefore the vector `residual` with its
//! leading part replaced by `restricted`; no second long vector is kept. Curvature enters before the projection: the
//! multiplier is fitted to the residual on the set, else the projected matrix is not symmetric.
//!
//! | local | meaning |
//! |---|---|
//! | `residual` | `P_Wᵀ (A x - b + kappa s)`, `s` the steps so far |
//! | `restricted` | its constrained part, restricted to the active set |
//! | `z` | `P_W R (D M D + T) R` of the residual on the set; `R` restricts |
//! | `D`, `T` | account for the curvature, `D = 1 / (1 + kappa m)` (`D²` in `docs/theory.md`) |
//! | `p`, `ap` | direction, and `A p + kappa p`, then `P_Wᵀ` of it, then restricted |
//! | `q` | `E p`, what `x` moves by; `p` where radii are fixed ([`coupling`](super::coupling)) |
//! | `rho` | residual on the set times `z` |

use crate::error::QpError;
use crate::problem::{Constrained, EqualityProjector, SymmetricOperator, for_constrained};
use crate::tolerances::{
    ASTRAY, ASTRAY_STEP, ENOUGH, FEW_STEPS, FLAT, FLAT_GRADIENT, GROWN, LENT, LONG, MOST_STEPS, NEGATIVE_CURVATURE,
    PASSING, PASSING_STEP, ROUNDED_STEPS,
};
use crate::vector;

use super::iterate::{Iterate, Lengths, Wanted, natural_map};
use super::view::ActiveSetPreconditioner;

/// How far the errors are to fall on an active set.
pub(crate) struct Goal {
    /// By this factor from the smaller of their values at the start and those expected,
    pub(crate) forcing: f64,
    pub(crate) expected: Lengths,
    /// or below these limits.
    pub(crate) limits: Lengths,
    /// No more products than that in the whole solve.
    pub(crate) max_products: usize,
    /// It goes on as long as the natural map leaves the active set as it is, and `|x|` has not outgrown its value at the
    /// start, `size`, by which the limits were set.
    pub(crate) size: f64,
}

impl<A: SymmetricOperator, C: EqualityProjector, M: ActiveSetPreconditioner> Iterate<'_, A, C, M> {
    /// Runs until the goal is reached; `z` is ready, with `rho`. Returns the length of the last step if another one
    /// is worth while; its direction is then `p`.
    pub(crate) fn conjugate_gradients(&mut self, rho: f64, goal: &Goal) -> Result<f64, QpError> {
        let first = self.errors();
        let start = first.zip(goal.expected, f64::min);
        // further than that, steps that round move the equality more than the iterate
        let digits = if self.projector.rounds_steps() { ROUNDED_STEPS } else { 0.0 };
        let fallen = |from: Lengths| {
            from.zip(goal.limits, |from, limit| {
                (goal.forcing * from).max(ENOUGH * limit).max(digits * first.all)
            })
        };
        let mut enough = fallen(start);
        // without constraints there is no other set
        let most = if self.constrained() == 0 {
            usize::MAX
        } else if self.compliance.c > 0.0 || self.problem.preconditioner.knows_added() {
            FEW_STEPS
        } else {
            MOST_STEPS
        };
        let last = goal.max_products.min(self.report.products().saturating_add(most));
        self.first_direction();
        let (mut rho, mut steps) = (rho, 0);
        while self.report.products() < last && rho > 0.0 {
            let coupled = self.multiply_direction();
            steps += 1;
            let Some(curvature) = self.curvature(rho, coupled)? else {
                break;
            };
            let longest = self.longest_step(first.all, goal.size, coupled);
            let length = longest.min(rho / curvature);
            self.work.length = length;
            self.advance(length, coupled);
            // a direction that is coupled or rounded is kept conjugate to the last one
            let conjugate = coupled || digits > 0.0;
            let wanted = if conjugate { Wanted::Along } else { Wanted::Nothing };
            let (next, along) = self.precondition(wanted);
            let beta = if conjugate { along / curvature } else { next / rho };
            vector::axpby(-1.0, &self.work.z, beta, &mut self.work.p);
            rho = next;
            let errors = self.errors();
            if errors.within(enough) {
                let more = !errors.within(goal.limits);
                let exact = errors.all > digits * first.all;
                if more && exact && self.stays(goal) {
                    enough = fallen(errors);
                    continue;
                }
                return Ok(if more { length } else { 0.0 });
            }
            if length == longest || self.work.coupling.too_strong(steps, first.all, errors.all) {
                break;
            }
        }
        Ok(0.0)
    }

    /// Length of a step that is the last one on this set. Where rows that are free depend on one another, as those of a
    /// support and of a point that sticks at one node, a set does not determine all forces, and conjugate gradients
    /// lead far away while the error grows: a part of that way tells which rows cannot be free.
    fn longest_step(&self, first_error: f64, size: f64, coupled: bool) -> f64 {
        if self.work.z_norm <= ASTRAY * first_error {
            return f64::INFINITY;
        }
        let work = &self.work;
        let q = if coupled { &work.coupling.step } else { &work.p };
        ASTRAY_STEP * size / self.problem.operator.norm(q)
    }

    /// Whether a move would change nothing: radii that follow, blocks or the limits.
    fn stays(&self, goal: &Goal) -> bool {
        let work = &*self.work;
        let map = natural_map(self.problem, &work.residual, self.step);
        self.problem.operator.norm(self.x) <= GROWN * goal.size
            && !work.coupling.follows(self.set, self.x)
            && work.active.stays(self.set, self.x, &map)
    }

    /// Whether so much of the active set has changed, and one way, that its solution tells little.
    pub(crate) fn is_on_the_way(&self) -> bool {
        let (active, first) = (&self.work.active, self.report.active_sets == 0);
        let many = (PASSING * active.free_bounds as f64).max(2.0);
        let one_way = 2 * (2 * active.freed).abs_diff(active.changed) >= active.changed;
        !first && !self.work.coupling.on && active.changed as f64 > many && one_way
    }

    /// Passes over a set on the way: the next step is the first one, of about the last length.
    pub(crate) fn pass(&mut self) -> f64 {
        self.first_direction();
        PASSING_STEP * self.work.length
    }

    /// `p = -z`.
    pub(crate) fn first_direction(&mut self) {
        // not by a factor of zero: what an earlier solve has left need not be finite
        vector::copy(&self.work.z, &mut self.work.p);
        vector::scale(-1.0, &mut self.work.p);
    }

    /// `ap = A q`, with `q = E p` where the radii follow, which is returned, else `q = p`.
    fn multiply_direction(&mut self) -> bool {
        let work = &mut *self.work;
        let coupled = work.coupling.on;
        if coupled {
            work.coupling.extend(self.projector, self.set, &work.active, &work.p);
        }
        let q = if coupled { &work.coupling.step } else { &work.p };
        let part = work.restricted.len();
        self.compliance
            .apply(self.problem, part, q, &mut work.ap, &mut work.operator);
        self.report.cg_steps += 1;
        coupled
    }

    /// `pᵀ (A q + kappa p)`; `None` where it is not positive, by rounding or because the coupling is too strong. Where
    /// there is none, and the way ends at the boundary of the set, some is lent.
    fn curvature(&mut self, rho: f64, coupled: bool) -> Result<Option<f64>, QpError> {
        let work = &mut *self.work;
        let operator = self.problem.operator;
        let plain = operator.dot(&work.p, &work.ap);
        let curvature = plain + work.active.curvature(self.set, &work.p);
        if !curvature.is_finite() {
            return Err(self.not_finite("the curvature"));
        }
        let length = rho / curvature;
        let long = curvature > 0.0 && length > LONG * work.shortest;
        if curvature > 0.0 && !long {
            if length < work.shortest {
                work.shortest = length;
                let [pp, dd] = operator.dots([(&work.p, &work.p), (&work.ap, &work.ap)]);
                work.steepest = work.steepest.max((dd / pp).sqrt());
            }
            return Ok(Some(curvature));
        }
        work.leapt = true;
        let pp = operator.dot(&work.p, &work.p);
        let largest = work.steepest * pp;
        if !coupled && curvature.abs() <= FLAT * largest {
            let lent = LENT * if largest > 0.0 { largest } else { rho };
            work.leap = work.leap.max(rho / lent * pp.sqrt());
            return self.without_curvature(lent);
        }
        if curvature > 0.0 {
            work.leap = work.leap.max(length * pp.sqrt());
            return Ok(Some(curvature));
        }
        if coupled {
            work.coupling.failed = true;
            return Ok(None);
        }
        if plain < -NEGATIVE_CURVATURE * operator.norm(&work.ap) * pp.sqrt() {
            return Err(QpError::Indefinite {
                curvature: curvature / pp,
                products: self.report.products(),
            });
        }
        Ok(None)
    }

    /// What a direction without curvature is given: nothing where the gradient along it is rounding.
    fn without_curvature(&self, lent: f64) -> Result<Option<f64>, QpError> {
        let (work, operator) = (&*self.work, self.problem.operator);
        let size = operator.norm(self.problem.linear) + operator.norm(self.ax);
        if operator.norm(&work.residual) <= FLAT_GRADIENT * size {
            return Ok(None);
        }
        let mut ends = false;
        let towards = |p: f64, lower: f64, upper: f64| {
            if p < 0.0 { lower.is_finite() } else { p > 0.0 && upper.is_finite() }
        };
        for_constrained(self.set, |block| {
            ends |= match block {
                Constrained::Bound { i, lower, upper, .. } => towards(work.p[i], lower, upper),
                Constrained::Disc { i, radius, .. } => radius.is_finite() && work.p[i..i + 2] != [0.0; 2],
            };
        });
        if ends {
            return Ok(Some(lent));
        }
        Err(QpError::Unbounded {
            products: self.report.products(),
        })
    }

    /// A step of this length: `x`, `ax` and both residuals; `ap` becomes that of the residual on the set.
    fn advance(&mut self, length: f64, coupled: bool) {
        let work = &mut *self.work;
        let q = if coupled { &work.coupling.step } else { &work.p };
        vector::axpy(length, q, self.x);
        vector::axpy(length, &work.ap, self.ax);
        let constrained = work.restricted.len();
        work.active
            .add_curvature(self.set, &work.p, &mut work.ap[..constrained]);
        self.projector.project_step_transpose(&mut work.ap);
        vector::axpy(length, &work.ap, &mut work.residual);
        let part = &mut work.ap[..constrained];
        work.active.restrict(self.set, part);
        vector::axpy(length, part, &mut work.restricted);
    }
}
