//! The augmented Lagrangian of SMALSE as a cost for KPRGP.
//!
//! In unshifted variables (`P x_im = 0` and `Q x_im = x_im` for `x_im = Cᵀe`)
//!
//! `L(x, beta) = 1/2 x·PAPx - x·P(b - A x_im) + rho/2 |Cx - e|² + beta·(Cx - e)` up to a constant,
//! `grad L = P (A y - b) + Cᵀ(rho (Cx - e) + beta)` with `y = Px + x_im = x - Cᵀ(Cx - e)`.
//!
//! With `r = A y - b` this is `r + Cᵀ(rho (Cx - e) + beta - C r)`: two products with `C` and two with `Cᵀ`.
//!
//! | paper | here | meaning |
//! |---|---|---|
//! | `G mu` | `cx` | residual `C x - e` of the equality, follows `x` by recurrence |
//! | | `cr` | `C (A y - b)`, likewise: `r` is `g - Cᵀ(rho cx + beta - cr)` without a product |
//! | `beta` | `beta` | multiplier |
//! | `rho` | `rho` | penalty, in the units of `A` |
//! | `M_k`, `eta` | `precision`, `cap` | inner tolerance `min(M |Cx - e|, eta)` |
//! | `eps_1` | `floor` | no less than this once `|Cx - e|` is within `equality_tolerance` |

use crate::kprgp::Objective;
use crate::problem::{Equality, QuadraticCost, SymmetricOperator};
use crate::vector;

/// Vectors and numbers of the penalised cost that live in the workspace.
pub(crate) struct State {
    pub(crate) cx: Vec<f64>,
    pub(crate) cr: Vec<f64>,
    cp: Vec<f64>,
    crp: Vec<f64>,
    z: Vec<f64>,
    pub(crate) y: Vec<f64>,
    pub(crate) projections: usize,
}

impl State {
    pub(crate) fn new(n: usize, rows: usize) -> Self {
        let coarse = || vec![0.0; rows];
        Self {
            cx: coarse(),
            cr: coarse(),
            cp: coarse(),
            crp: coarse(),
            z: coarse(),
            y: vec![0.0; n],
            projections: 0,
        }
    }
}

pub(crate) struct Penalised<'a, A: SymmetricOperator, C: Equality> {
    pub(crate) cost: &'a QuadraticCost<'a, A>,
    pub(crate) c: &'a C,
    pub(crate) e: &'a [f64],
    pub(crate) beta: &'a mut [f64],
    pub(crate) rho: f64,
    pub(crate) precision: f64,
    pub(crate) cap: f64,
    pub(crate) floor: f64,
    pub(crate) equality_tolerance: f64,
    pub(crate) s: &'a mut State,
    pub(crate) a_scratch: &'a mut A::Scratch,
    pub(crate) c_scratch: &'a mut C::Scratch,
}

impl<A: SymmetricOperator, C: Equality> Penalised<'_, A, C> {
    /// `|C x - e|`.
    pub(crate) fn equality(&self) -> f64 {
        vector::norm(&self.s.cx)
    }

    /// `beta += rho (C x - e)` and the gradient with it (Step 3).
    pub(crate) fn update_multiplier(&mut self, g: &mut [f64]) {
        let State { cx, y, .. } = &mut *self.s;
        vector::axpy(self.rho, cx, self.beta);
        self.c.apply_transpose(cx, y, self.c_scratch);
        vector::axpy(self.rho, y, g);
    }

    /// From the gradient `g` of the Lagrangian: `r = A y - b` into `r`, and into `mu` the multiplier of the
    /// original problem, `r + Cᵀ mu = g`.
    pub(crate) fn unproject(&mut self, g: &[f64], r: &mut [f64], mu: &mut [f64]) {
        vector::copy(self.beta, mu);
        vector::axpy(self.rho, &self.s.cx, mu);
        vector::subtract(&self.s.cr, mu);
        self.c.apply_transpose(mu, r, self.c_scratch);
        vector::xpby(g, -1.0, r);
    }
}

impl<A: SymmetricOperator, C: Equality> Objective for Penalised<'_, A, C> {
    fn gradient(&mut self, x: &[f64], g: &mut [f64]) {
        let State { cx, cr, z, y, .. } = &mut *self.s;
        self.c.apply(x, cx, self.c_scratch);
        vector::subtract(self.e, cx);
        self.c.apply_transpose(cx, y, self.c_scratch);
        vector::xpby(x, -1.0, y);
        self.cost.a.apply(y, g, self.a_scratch);
        vector::subtract(self.cost.b, g);
        self.c.apply(g, cr, self.c_scratch);
        vector::copy(self.beta, z);
        vector::axpy(self.rho, cx, z);
        vector::subtract(cr, z);
        self.c.apply_transpose(z, y, self.c_scratch);
        vector::axpy(1.0, y, g);
        self.s.projections += 2;
    }

    fn direction(&mut self, p: &[f64], ap: &mut [f64]) {
        let State { cp, crp, z, y, .. } = &mut *self.s;
        self.c.apply(p, cp, self.c_scratch);
        self.c.apply_transpose(cp, y, self.c_scratch);
        vector::xpby(p, -1.0, y);
        self.cost.a.apply(y, ap, self.a_scratch);
        self.c.apply(ap, crp, self.c_scratch);
        vector::copy(crp, z);
        vector::axpby(self.rho, cp, -1.0, z);
        self.c.apply_transpose(z, y, self.c_scratch);
        vector::axpy(1.0, y, ap);
        self.s.projections += 2;
    }

    fn moved(&mut self, t: f64) {
        vector::axpy(-t, &self.s.cp, &mut self.s.cx);
        vector::axpy(-t, &self.s.crp, &mut self.s.cr);
    }

    fn hessian_norm(&self) -> f64 {
        self.cost.norm.max(self.rho)
    }

    fn tolerance(&self) -> f64 {
        let equality = self.equality();
        let t = (self.precision * equality).min(self.cap);
        if equality <= self.equality_tolerance { t.max(self.floor) } else { t }
    }
}
