//! The loop of the interior point method.
//!
//! Newton's method on `A x - b + sum y n = 0` and `q y = tau` for each inequality `q >= 0` with multiplier `y`, with
//! `tau` on the way to zero: predictor and corrector by Mehrotra (SIAM J. Optim. 2, 1992), inequalities of discs as in
//! Kucera, Machalova, Netuka, Zencak (Optim. Methods Softw. 28, 2013). A radius that follows a component stays out of
//! `n`, but not of the derivative of `q`: the equations are those of Coulomb friction itself, no sequence of problems
//! with given radii. No active set is predicted, so the number of steps, 15 to 70 a round, hardly depends on the
//! problem.

use crate::active_set::RadiusSlope;
use crate::error::{QpError, expect_finite, expect_length, expect_lengths};
use crate::problem::{ConvexSet, DenseOperator, ProductSet, SymmetricOperator};
use crate::report::Status;
use crate::tolerances::{
    BEHIND, CENTRED, CONTRADICTING, DEPTHS, FACTOR_ROUNDING, FALLS, HELD_UP, INTERIOR_STEPS, MORE_STEPS, PUSHES, ROUGH,
    ROUNDS, SETTLED_STEPS, SHORT_OF_BOUNDARY, SOLVED, STUCK,
};
use crate::vector;

use super::cones::{Circle, Cone, Cones};
use super::system::System;

/// What [`interior_point`] did.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[must_use = "it may not have converged: see `status`"]
pub struct InteriorPointReport {
    /// How it ended: [`Status::Stagnated`] tells that complementarity fell no more, or that nothing inside was found.
    pub status: Status,
    /// Steps, with one factorisation each; the first round takes another one.
    pub steps: usize,
    /// Residual of the gradient and the multipliers of the last round, before it goes to bounds and circles, over the
    /// load, each component over the root of its diagonal entry. Where radii vanish, what is on those circles means
    /// nothing.
    pub residual: f64,
}

/// Minimises `1/2 x·Ax - b·x` over the set from inside of it, up to `complementarity`: values of inequalities times
/// their multipliers, in all, over the work of the load, or what rounding leaves, at most 1e-9.
///
/// `x` is the point that the radii of the set belong to, where `slopes` tell that they follow it. What has one bound
/// and is on it there begins fixed to it and is let go, with radii that follow it, once the gradient pushes it off: the
/// equations of a step are those of all other components only. Beyond that the method begins where it likes; where
/// nothing is off its bound, all are free. A slope may also tell of an interval symmetric to zero. The result is on
/// bounds and circles where multipliers tell so: a start for [`active_set()`](crate::active_set()).
///
/// # Errors
/// [`QpError`] for wrong lengths, sets and slopes, and for NaN.
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
    if !(0.0..1.0).contains(&complementarity) {
        let (name, value, range) = ("complementarity", complementarity, "[0, 1)");
        return Err(QpError::Setting { name, value, range });
    }
    let cones = Cones::new(set, slopes, x)?;
    let origin = vec![0.0; n];
    if set.violation(&origin) == 0.0 && linear.iter().all(|b| *b == 0.0) {
        x.copy_from_slice(&origin);
        return Ok(InteriorPointReport {
            status: Status::Converged,
            steps: 0,
            residual: 0.0,
        });
    }
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
        system: System::new(&cones.fixed),
        depth: None,
        cones,
        x,
    };
    let (mut steps, mut rounds) = (0, 0);
    loop {
        run.begin();
        let (status, more) = run.solve(complementarity);
        steps += more;
        rounds += 1;
        let goes_on = match status {
            Status::Converged => run.let_go(rounds < ROUNDS),
            // what is free may not carry the load
            _ => run.let_all_go(),
        };
        if !goes_on {
            let residual = run.weighted_norm(&run.residual) / run.weighted_norm(linear).max(f64::MIN_POSITIVE);
            run.settle();
            let lost = status == Status::Converged && !vector::norm(run.x).is_finite();
            let status = if lost { Status::Stagnated } else { status };
            return Ok(InteriorPointReport {
                status,
                steps,
                residual,
            });
        }
    }
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
    /// `A x - b + sum y n`.
    residual: Vec<f64>,
    /// One over the root of the diagonal.
    weights: Vec<f64>,
    system: System,
    /// How far from bounds it begins.
    depth: Option<f64>,
}

impl Run<'_> {
    /// A point inside, as far from bounds as the solution without them is from zero, and multipliers to match.
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
            if let Cone::Circle(circle) = cone
                && let Some((of, slope)) = circle.follows
                && bounds[of] == [f64::NEG_INFINITY, f64::INFINITY]
            {
                inwards[of] = slope.signum();
            }
        }
        let mut depth = match self.depth {
            Some(depth) => depth,
            None => self.without_bounds(&inwards),
        };
        self.depth = Some(depth);
        for _ in 0..DEPTHS {
            for i in (0..n).filter(|i| !self.cones.fixed[*i]) {
                self.x[i] = match bounds[i] {
                    [lower, upper] if lower.is_finite() && upper.is_finite() => 0.5 * (lower + upper),
                    [lower, _] if lower.is_finite() => lower + depth,
                    [_, upper] if upper.is_finite() => upper - depth,
                    _ => depth * inwards[i],
                };
            }
            // a radius may shrink on the way
            if self.cones.holds(self.x) {
                break;
            }
            depth *= 0.5;
        }
        self.multipliers = vec![0.0; self.cones.all.len()];
        self.update_residual();
        let free = self.cones.fixed.iter().filter(|fixed| !**fixed).count();
        let size = self.weighted_norm(&self.residual) / (free.max(1) as f64).sqrt();
        let own = |cone: &Cone| {
            let (Cone::Half { i: at, .. } | Cone::Circle(Circle { first: at, .. })) = *cone;
            (size / self.weights[at]).max(f64::MIN_POSITIVE)
        };
        self.multipliers = self.cones.all.iter().map(own).collect();
    }

    /// How large the components that go `inwards` are in the solution without bounds.
    fn without_bounds(&mut self, inwards: &[f64]) -> f64 {
        self.system.set(self.matrix.entries());
        // rows that depend on one another may contradict each other
        for (i, weight) in self.weights.iter().enumerate() {
            self.system.add(i, i, CONTRADICTING * weight.powi(-2));
        }
        self.system.factor();
        let mut whole = self.linear.to_vec();
        self.system.solve(&mut whole);
        let of_bounds = || whole.iter().zip(inwards).filter(|(_, inwards)| **inwards != 0.0);
        let squares: f64 = of_bounds().map(|(x, _)| x * x).sum();
        let depth = (squares / of_bounds().count() as f64).sqrt();
        if depth.is_finite() && depth > 0.0 { depth } else { 1.0 }
    }

    fn update_residual(&mut self) {
        self.matrix.apply(self.x, &mut self.residual, &mut ());
        vector::subtract(self.linear, &mut self.residual);
        for (cone, y) in self.cones.all.iter().zip(&self.multipliers) {
            cone.normal(self.x, |i, n| self.residual[i] += y * n);
        }
    }

    /// Lets go the components that the gradient pushes off their bounds, `only` those or all that rest as soon as there
    /// is one; whether there is.
    fn let_go(&mut self, only: bool) -> bool {
        // over the root of the diagonal: stiff components stand beside soft ones
        let push = |i: usize| self.residual[i] * self.weights[i];
        let pressed = self.cones.all.iter().zip(&self.multipliers);
        let pressed = pressed.filter_map(|(cone, y)| match *cone {
            Cone::Half { i, .. } => Some(y * self.weights[i]),
            Cone::Circle(_) => None,
        });
        let resting = self.cones.rests().map(|i| push(i).abs());
        let least = PUSHES * resting.chain(pressed).fold(0.0, f64::max);
        let any = self.cones.let_go(|i, sign| sign * push(i) > least);
        if any && !only {
            self.cones.let_go(|_, _| true);
        }
        self.renew(any)
    }

    fn let_all_go(&mut self) -> bool {
        self.depth = None;
        let any = self.cones.let_go(|_, _| true);
        self.renew(any)
    }

    /// The equations of what is free now.
    fn renew(&mut self, any: bool) -> bool {
        if any {
            self.system = System::new(&self.cones.fixed);
            (self.unchanged, self.active) = (0, Vec::new());
        }
        any
    }

    /// Sum of `q y`.
    fn complementarity(&self) -> f64 {
        self.products().into_iter().map(|[q, y]| q * y).sum()
    }

    /// What the residual does on the way from zero, a constraint: nothing on circles that vanish.
    fn residual_work(&self) -> f64 {
        let all = self.residual.iter().zip(&*self.x).zip(&self.cones.fixed);
        all.filter(|(_, fixed)| !**fixed).map(|((r, x), _)| (r * x).abs()).sum()
    }

    /// What rounding leaves of the work of the residual: an equality that the matrix holds with a large weight works
    /// much more in parts than in all.
    fn rounding(&self) -> f64 {
        let columns = self.matrix.entries().chunks_exact(self.x.len());
        let column = |column: &[f64]| column.iter().zip(&*self.x).map(|(a, x)| (a * x).abs()).sum::<f64>();
        let parts: f64 = columns
            .zip(&*self.x)
            .map(|(entries, x)| x.abs() * column(entries))
            .sum();
        FACTOR_ROUNDING * parts
    }

    /// What values of inequalities times multipliers are compared with: twice the work of the load, that of the
    /// residual, and of what bounds hold.
    fn energy(&self) -> f64 {
        let mut held = 0.0;
        for (cone, y) in self.cones.all.iter().zip(&self.multipliers) {
            if let Cone::Half { i, .. } = *cone {
                held += (y * self.x[i]).abs();
            }
        }
        2.0 * vector::dot(self.linear, self.x).abs() + vector::dot(&self.residual, self.x).abs() + held
    }

    /// Of what is not fixed.
    fn weighted_norm(&self, v: &[f64]) -> f64 {
        let squares = v.iter().zip(&self.weights).map(|(v, w)| (v * w).powi(2));
        let free = squares.zip(&self.cones.fixed).filter(|(_, fixed)| !**fixed);
        free.map(|(square, _)| square).sum::<f64>().sqrt()
    }

    /// Status and steps.
    fn solve(&mut self, target: f64) -> (Status, usize) {
        let (mut steps, mut stuck, mut small, mut last) = (0, 0, 0, f64::INFINITY);
        let status = loop {
            self.update_residual();
            let (tau, size) = (self.complementarity(), self.energy());
            let work = self.residual_work();
            let solved = work <= SOLVED * size || work <= self.rounding();
            small = if solved && tau <= target * size { small + 1 } else { 0 };
            // without inequalities one step is all
            let enough = if self.cones.all.is_empty() {
                solved && steps > 0
            } else {
                self.unchanged >= SETTLED_STEPS && small > 0 || small >= MORE_STEPS
            };
            if enough {
                break Status::Converged;
            }
            let falls = tau < FALLS * last;
            last = last.min(tau);
            stuck = if falls { 0 } else { stuck + 1 };
            if stuck >= STUCK || !tau.is_finite() || !self.cones.holds(self.x) {
                // rounding ends it, too
                break if solved && tau <= ROUGH * size { Status::Converged } else { Status::Stagnated };
            }
            if steps >= INTERIOR_STEPS {
                break Status::IterationLimit;
            }
            self.step(tau / self.cones.all.len().max(1) as f64);
            steps += 1;
        };
        (status, steps)
    }

    /// One step of predictor and corrector from a mean `tau` of `q y`.
    fn step(&mut self, tau: f64) {
        self.assemble();
        let (towards, change) = self.direction(&vec![0.0; self.cones.all.len()]);
        let length = self.longest(&towards, &change).min(1.0);
        let centring = (1.0 - length).powi(3).max(CENTRED);
        // what the predictor leaves of its own products, as far as it goes
        let second = |(k, cone): (usize, &Cone)| {
            let rate = cone.rate(self.x, &towards);
            centring * tau - length * length * rate * change[k]
        };
        let wanted: Vec<f64> = self.cones.all.iter().enumerate().map(second).collect();
        let (towards, change) = self.direction(&wanted);
        let length = (SHORT_OF_BOUNDARY * self.longest(&towards, &change)).min(1.0);
        let before = self.products();
        vector::axpy(length, &towards, self.x);
        vector::axpy(length, &change, &mut self.multipliers);
        self.tell_active(&before);
        if length < HELD_UP {
            self.bring_back();
        }
    }

    /// Raises multipliers whose products with the values of their inequalities have fallen behind.
    fn bring_back(&mut self) {
        let least = BEHIND * self.complementarity() / self.cones.all.len() as f64;
        for (cone, y) in self.cones.all.iter().zip(&mut self.multipliers) {
            let raised = least / cone.value(self.x);
            if raised > *y && raised.is_finite() {
                *y = raised;
            }
        }
    }

    /// Values of the inequalities and multipliers.
    fn products(&self) -> Vec<[f64; 2]> {
        let blocks = self.cones.all.iter().zip(&self.multipliers);
        blocks.map(|(cone, y)| [cone.value(self.x), *y]).collect()
    }

    /// Which inequalities the last step brought further to zero than their multipliers: those become active, in any
    /// units (El-Bakry, Tapia, Zhang, SIAM Review 36, 1994).
    fn tell_active(&mut self, before: &[[f64; 2]]) {
        let pairs = self.products().into_iter().zip(before);
        let active: Vec<bool> = pairs.map(|([q, y], [q0, y0])| q * y0 < y * q0).collect();
        self.unchanged = if active == self.active { self.unchanged + 1 } else { 0 };
        self.active = active;
    }

    /// The matrix at the present point, factored.
    fn assemble(&mut self) {
        self.system.set(self.matrix.entries());
        for (cone, y) in self.cones.all.iter().zip(&self.multipliers) {
            let (x, q) = (&*self.x, cone.value(self.x));
            cone.curvature(x, |row, column, v| self.system.add(row, column, y * v));
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
        let change = |((cone, y), lacks): ((&Cone, &f64), &f64)| lacks - y * cone.rate(x, &towards) / cone.value(x);
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
