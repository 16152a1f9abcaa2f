//! The loop of the interior point method.
//!
//! Newton's method on `A x - b + sum y n = 0` and `q y = tau` for each inequality `q >= 0` with multiplier `y`, with
//! `tau` on the way to zero: predictor and corrector by Mehrotra (SIAM J. Optim. 2, 1992), inequalities of discs as in
//! Kucera, Machalova, Netuka, Zencak (Optim. Methods Softw. 28, 2013). A radius that follows a component stays out of
//! `n`, but not of the derivative of `q`: the equations are those of Coulomb friction itself, no sequence of problems
//! with given radii. No active set is predicted, so the number of steps, 15 to 40, hardly depends on the problem.

use crate::active_set::RadiusSlope;
use crate::error::{QpError, expect_finite, expect_length, expect_lengths};
use crate::problem::{ConvexSet, DenseOperator, ProductSet, SymmetricOperator};
use crate::report::Status;
use crate::tolerances::{
    CENTRED, INTERIOR_STEPS, INTO_THE_SET, MORE_STEPS, SETTLED_STEPS, SHORT_OF_BOUNDARY, SHORT_STEP, STUCK,
};
use crate::vector;

use super::cones::{Along, Circle, Cone, Cones};
use super::system::System;

/// What [`interior_point`] did.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[must_use = "it may not have converged: see `status`"]
pub struct InteriorPointReport {
    /// How it ended: [`Status::Stagnated`] tells that steps became too short.
    pub status: Status,
    /// Steps, with one factorisation each.
    pub steps: usize,
    /// Residual of the gradient and the multipliers over the load, each component over the root of its diagonal entry. Large
    /// where radii vanish: what is on those circles means nothing.
    pub residual: f64,
}

/// Minimises `1/2 x·Ax - b·x` over the set from inside of it, up to `complementarity`: mean of the values of inequalities
/// times their multipliers, relative to the start.
///
/// `x` is the point that the radii of the set belong to, where `slopes` tell that they follow it; its components mean
/// nothing else, the method begins where it likes. A slope may also tell of an interval symmetric to zero. The result is on
/// bounds and circles where multipliers tell so: a start for [`active_set()`](crate::active_set()).
///
/// # Errors
/// [`QpError`] for wrong lengths or sets, and for NaN.
pub fn interior_point(
    matrix: &DenseOperator,
    linear: &[f64],
    set: &ProductSet,
    slopes: &[RadiusSlope],
    complementarity: f64,
    x: &mut [f64],
) -> Result<InteriorPointReport, QpError> {
    let n = matrix.dim();
    expect_lengths([("x", x.len(), n), ("the linear term", linear.len(), n)])?;
    expect_length("the set", set.dim(), n)?;
    set.validate()?;
    expect_finite("x", x)?;
    expect_finite("the linear term", linear)?;
    let cones = Cones::new(set, slopes, x);
    let mut run = Run {
        matrix,
        linear,
        multipliers: Vec::new(),
        active: Vec::new(),
        unchanged: 0,
        residual: vec![0.0; n],
        weights: (0..n)
            .map(|i| matrix.entries()[i * (n + 1)].max(f64::MIN_POSITIVE).sqrt().recip())
            .collect(),
        system: System::new(n),
        cones,
        x,
    };
    run.begin();
    let report = run.solve(complementarity);
    run.settle();
    Ok(report)
}

struct Run<'a> {
    matrix: &'a DenseOperator,
    linear: &'a [f64],
    cones: Cones,
    x: &'a mut [f64],
    multipliers: Vec<f64>,
    /// Which inequalities become equalities, as the last step tells, and for how many steps that has been so.
    active: Vec<bool>,
    unchanged: usize,
    /// `A x - b + sum y n`, zero where fixed.
    residual: Vec<f64>,
    /// One over the root of the diagonal.
    weights: Vec<f64>,
    system: System,
}

impl Run<'_> {
    /// A point inside, as far from bounds as the load would press against all of them, and multipliers to match.
    fn begin(&mut self) {
        let n = self.x.len();
        let (mut bounds, mut inwards) = (vec![[f64::NEG_INFINITY, f64::INFINITY]; n], vec![0.0; n]);
        for cone in &self.cones.all {
            if let Cone::Half { i, sign, bound } = *cone {
                bounds[i][usize::from(sign > 0.0)] = bound;
                inwards[i] -= sign;
            }
        }
        for cone in &self.cones.all {
            // a circle needs a radius
            if let Cone::Circle(Circle { of, slope, .. }) = *cone
                && bounds[of] == [f64::NEG_INFINITY, f64::INFINITY]
            {
                inwards[of] = slope.signum() * f64::from(slope != 0.0);
            }
        }
        let mut along = vec![0.0; n];
        self.matrix.apply(&inwards, &mut along, &mut ());
        let depth = INTO_THE_SET * vector::norm(self.linear) / vector::norm(&along);
        let depth = if depth.is_finite() && depth > 0.0 { depth } else { 1.0 };
        for i in (0..n).filter(|i| !self.cones.fixed[*i]) {
            self.x[i] = match bounds[i] {
                [lower, upper] if lower.is_finite() && upper.is_finite() => 0.5 * (lower + upper),
                [lower, _] if lower.is_finite() => lower + depth,
                [_, upper] if upper.is_finite() => upper - depth,
                _ => depth * inwards[i],
            };
        }
        self.multipliers = vec![0.0; self.cones.all.len()];
        self.update_residual();
        let size = self.weighted_norm(&self.residual) / (n.max(1) as f64).sqrt();
        let own = |cone: &Cone| {
            let (at, length) = match *cone {
                Cone::Half { i, .. } => (i, 1.0),
                Cone::Circle(Circle { first, .. }) => (first, (2.0 * cone.value(self.x)).sqrt()),
            };
            (size / self.weights[at] / length).max(f64::MIN_POSITIVE)
        };
        self.multipliers = self.cones.all.iter().map(own).collect();
    }

    fn update_residual(&mut self) {
        self.matrix.apply(self.x, &mut self.residual, &mut ());
        vector::subtract(self.linear, &mut self.residual);
        for (cone, y) in self.cones.all.iter().zip(&self.multipliers) {
            cone.normal(self.x, |i, n| self.residual[i] += y * n);
        }
        let fixed = self.residual.iter_mut().zip(&self.cones.fixed);
        fixed
            .filter(|(_, fixed)| **fixed)
            .for_each(|(residual, _)| *residual = 0.0);
    }

    /// Mean of `q y`.
    fn complementarity(&self) -> f64 {
        let products = self.products().into_iter().map(|[q, y]| q * y);
        products.sum::<f64>() / self.cones.all.len().max(1) as f64
    }

    fn weighted_norm(&self, v: &[f64]) -> f64 {
        let squares = v.iter().zip(&self.weights).map(|(v, w)| (v * w).powi(2));
        squares.sum::<f64>().sqrt()
    }

    fn solve(&mut self, target: f64) -> InteriorPointReport {
        let load = self.weighted_norm(self.linear).max(f64::MIN_POSITIVE);
        let first = self.complementarity();
        let (mut steps, mut stuck, mut small) = (0, 0, 0);
        let status = loop {
            self.update_residual();
            let tau = self.complementarity();
            small = if tau <= target * first { small + 1 } else { 0 };
            // without inequalities one step is all
            let enough = match self.cones.all.is_empty() {
                true => steps > 0,
                false => self.unchanged >= SETTLED_STEPS && small > 0 || small >= MORE_STEPS,
            };
            if enough {
                break Status::Converged;
            }
            if stuck >= STUCK || !tau.is_finite() || !self.cones.holds(self.x) {
                // rounding ends it, too
                break if small > 0 {
                    Status::Converged
                } else {
                    Status::Stagnated
                };
            }
            if steps >= INTERIOR_STEPS {
                break Status::IterationLimit;
            }
            let length = self.step(tau);
            stuck = if length < SHORT_STEP { stuck + 1 } else { 0 };
            steps += 1;
        };
        InteriorPointReport {
            status,
            steps,
            residual: self.weighted_norm(&self.residual) / load,
        }
    }

    /// One step of predictor and corrector; its length.
    fn step(&mut self, tau: f64) -> f64 {
        self.assemble();
        let (towards, change) = self.direction(&vec![0.0; self.cones.all.len()]);
        let length = self.longest(&towards, &change).min(1.0);
        let centring = (1.0 - length).powi(3).max(CENTRED);
        // what the predictor leaves of its own products, as far as it goes
        let second = |(k, cone): (usize, &Cone)| {
            let rate = cone.along(self.x, &towards).rate;
            centring * tau - length * length * rate * change[k]
        };
        let wanted: Vec<f64> = self.cones.all.iter().enumerate().map(second).collect();
        let (towards, change) = self.direction(&wanted);
        let length = (SHORT_OF_BOUNDARY * self.longest(&towards, &change)).min(1.0);
        let before = self.products();
        vector::axpy(length, &towards, self.x);
        vector::axpy(length, &change, &mut self.multipliers);
        self.tell_active(&before);
        length
    }

    /// Values of the inequalities and multipliers.
    fn products(&self) -> Vec<[f64; 2]> {
        let blocks = self.cones.all.iter().zip(&self.multipliers);
        blocks.map(|(cone, y)| [cone.value(self.x), *y]).collect()
    }

    /// Which inequalities the last step brought further to zero than their multipliers: those become active, in any units
    /// (El-Bakry, Tapia, Zhang, SIAM Review 36, 1994).
    fn tell_active(&mut self, before: &[[f64; 2]]) {
        let pairs = self.products().into_iter().zip(before);
        let active: Vec<bool> = pairs.map(|([q, y], [q0, y0])| q * y0 < y * q0).collect();
        self.unchanged = if active == self.active { self.unchanged + 1 } else { 0 };
        self.active = active;
    }

    /// The matrix at the present point, factored.
    fn assemble(&mut self) {
        self.system.set(self.matrix.entries());
        for (at, fixed) in self.cones.fixed.iter().enumerate() {
            if *fixed {
                self.system.decouple(at);
            }
        }
        for (cone, y) in self.cones.all.iter().zip(&self.multipliers) {
            let (x, q) = (&*self.x, cone.value(self.x));
            cone.curved().for_each(|i| self.system.add(i, i, *y));
            cone.normal(x, |row, n| {
                cone.derivative(x, |column, a| self.system.add(row, column, -y / q * n * a))
            });
        }
        self.system.factor();
    }

    /// Changes of `x` and the multipliers for `q y` to become `wanted`.
    fn direction(&mut self, wanted: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let mut towards: Vec<f64> = self.residual.iter().map(|r| -r).collect();
        let x = &*self.x;
        let lacking = |([q, y], wanted): ([f64; 2], &f64)| (wanted - q * y) / q;
        let lacks: Vec<f64> = self.products().into_iter().zip(wanted).map(lacking).collect();
        for (cone, lacks) in self.cones.all.iter().zip(&lacks) {
            cone.normal(x, |i, n| towards[i] -= n * lacks);
        }
        self.system.solve(&mut towards);
        let blocks = self.cones.all.iter().zip(&self.multipliers).zip(&lacks);
        let change = |((cone, y), lacks): ((&Cone, &f64), &f64)| {
            let Along { q, rate, .. } = cone.along(x, &towards);
            lacks - y * rate / q
        };
        let change = blocks.map(change).collect();
        (towards, change)
    }

    /// Goes to bounds and circles that become active.
    fn settle(&mut self) {
        for (cone, _) in self.cones.all.iter().zip(&self.active).filter(|(_, active)| **active) {
            cone.settle(self.x);
        }
    }

    /// The largest multiple of a step that stays inside.
    fn longest(&self, towards: &[f64], change: &[f64]) -> f64 {
        let mut length = f64::INFINITY;
        for (k, cone) in self.cones.all.iter().enumerate() {
            length = length.min(cone.along(self.x, towards).root());
            if change[k] < 0.0 {
                length = length.min(-self.multipliers[k] / change[k]);
            }
        }
        length
    }
}
