//! Blocks of a set as inequalities `q >= 0`: bounds, and circles whose radius may follow another component.

use std::ops::Range;

use crate::active_set::{RadiusSlope, slope_table};
use crate::error::QpError;
use crate::problem::{Constrained, ProductSet, for_constrained};
use crate::tolerances::{BEYOND, ROUNDED};
use crate::vector;

/// One inequality. A multiplier `y >= 0` pushes `x` along the normal: the gradient is `-y` times that.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Cone {
    /// `q = sign (bound - x_i)`.
    Half { i: usize, sign: f64, bound: f64 },
    /// `q = (r² - |t|²) / 2r`: its multiplier stays finite where a circle vanishes.
    Circle(Circle),
}

/// One or two components `t` from `first` on, in a circle of radius `r = own`, or `own + slope * x[of]` where it
/// follows `(of, slope)`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Circle {
    pub(crate) first: usize,
    width: usize,
    own: f64,
    pub(crate) follows: Option<(usize, f64)>,
}

impl Circle {
    fn components(&self) -> Range<usize> {
        self.first..self.first + self.width
    }

    fn radius(&self, x: &[f64]) -> f64 {
        self.own + self.growth(x)
    }

    /// What `d` adds to the radius.
    fn growth(&self, d: &[f64]) -> f64 {
        self.follows.map_or(0.0, |(of, slope)| slope * d[of])
    }
}

/// The value of an inequality along a line, times the radius: `q + rate s + bend s²`.
pub(crate) struct Along {
    q: f64,
    rate: f64,
    bend: f64,
}

impl Along {
    /// The first `s` at which it vanishes.
    pub(crate) fn root(&self) -> f64 {
        let (half, square) = (0.5 * self.rate, 0.25 * self.rate * self.rate - self.bend * self.q);
        if square < 0.0 {
            return f64::INFINITY;
        }
        // the smallest positive root, without cancellation
        let sum = half.abs() + square.sqrt();
        let roots = if half <= 0.0 {
            [self.q / sum, sum / self.bend]
        } else {
            [-sum / self.bend, -self.q / sum]
        };
        roots.into_iter().filter(|s| *s > 0.0).fold(f64::INFINITY, f64::min)
    }
}

impl Cone {
    /// The value at `x`.
    pub(crate) fn value(&self, x: &[f64]) -> f64 {
        match *self {
            Self::Half { i, sign, bound } => sign * (bound - x[i]),
            Self::Circle(circle) => {
                let (r, length) = (circle.radius(x), vector::norm(&x[circle.components()]));
                // near the circle its digits count
                0.5 * (r - length) * (1.0 + length / r)
            }
        }
    }

    /// How the value changes from `x` along `d`.
    pub(crate) fn along(&self, x: &[f64], d: &[f64]) -> Along {
        match *self {
            Self::Half { i, sign, .. } => Along {
                q: self.value(x),
                rate: -sign * d[i],
                bend: 0.0,
            },
            Self::Circle(circle) => {
                let (r, grows) = (circle.radius(x), circle.growth(d));
                let q = r * self.value(x);
                let [x, d] = [x, d].map(|v| &v[circle.components()]);
                Along {
                    q,
                    rate: r * grows - vector::dot(x, d),
                    bend: 0.5 * (grows * grows - vector::dot(d, d)),
                }
            }
        }
    }

    /// The derivative of the value along `d`.
    pub(crate) fn rate(&self, x: &[f64], d: &[f64]) -> f64 {
        let mut rate = 0.0;
        self.derivative(x, |i, a| rate += a * d[i]);
        rate
    }

    /// Puts `x` on the boundary: on the bound, or along the radius on the circle.
    pub(crate) fn settle(&self, x: &mut [f64]) {
        match *self {
            Self::Half { i, bound, .. } => x[i] = bound,
            Self::Circle(circle) => {
                // a radius that is computed again may differ by rounding
                let radius = circle.radius(x).max(0.0) * BEYOND;
                let t = &mut x[circle.components()];
                let length = vector::norm(t);
                if length > 0.0 {
                    vector::scale(radius / length, t);
                }
            }
        }
    }

    /// Calls `f` with the components of the normal.
    pub(crate) fn normal(&self, x: &[f64], mut f: impl FnMut(usize, f64)) {
        match *self {
            Self::Half { i, sign, .. } => f(i, sign),
            Self::Circle(circle) => {
                let r = circle.radius(x);
                circle.components().for_each(|i| f(i, x[i] / r));
            }
        }
    }

    /// Calls `f` with those of the derivative of `q`, which is the normal turned round, and more where a radius
    /// follows.
    pub(crate) fn derivative(&self, x: &[f64], mut f: impl FnMut(usize, f64)) {
        self.normal(x, |i, n| f(i, -n));
        if let Self::Circle(circle) = self
            && let Some((of, slope)) = circle.follows
        {
            let part = vector::norm(&x[circle.components()]) / circle.radius(x);
            f(of, 0.5 * slope * (1.0 + part * part));
        }
    }

    /// Calls `f` with the derivative of the normal: component, by which, value.
    pub(crate) fn curvature(&self, x: &[f64], mut f: impl FnMut(usize, usize, f64)) {
        if let Self::Circle(circle) = self {
            let r = circle.radius(x);
            for i in circle.components() {
                f(i, i, 1.0 / r);
                if let Some((of, slope)) = circle.follows {
                    f(i, of, -slope * x[i] / r / r);
                }
            }
        }
    }
}

/// The inequalities of a set, bounds before circles, which may follow them, and which components stay at what they are.
pub(crate) struct Cones {
    pub(crate) all: Vec<Cone>,
    /// Bounds on which components rest, and circles that vanish there.
    resting: Vec<Cone>,
    pub(crate) fixed: Vec<bool>,
}

impl Cones {
    /// Puts fixed components of `x` where the set has them. The radii of the set, and intervals that slopes tell of,
    /// are those at `x`. What has one bound and is on it rests there, unless that is so everywhere.
    pub(crate) fn new(set: &ProductSet, slopes: &[RadiusSlope], x: &mut [f64]) -> Result<Self, QpError> {
        let slope_of = slope_table(set, slopes)?;
        let before = x.to_vec();
        let (mut rests, mut held) = (vec![false; x.len()], vec![None; x.len()]);
        let mut some_do_not = false;
        for_constrained(set, |block| {
            if let Constrained::Bound { i, lower, upper, .. } = block
                && slope_of[i].is_none()
            {
                if lower.is_finite() != upper.is_finite() {
                    rests[i] = before[i] == lower || before[i] == upper;
                    some_do_not |= !rests[i];
                }
                held[i] = (lower == upper).then_some(lower);
            }
        });
        if !some_do_not {
            rests.fill(false);
        }
        let (mut all, mut resting, mut fixed) = (Vec::new(), Vec::new(), vec![false; x.len()]);
        let mut fix = |components: Range<usize>, value: f64| {
            x[components.clone()].fill(value);
            fixed[components].fill(true);
        };
        for_constrained(set, |block| {
            let (first, width, radius) = match block {
                Constrained::Disc { i, radius, .. } => (i, 2, radius),
                Constrained::Bound { i, upper, .. } if slope_of[i].is_some() => (i, 1, upper),
                Constrained::Bound { i, lower, upper, .. } => {
                    if let Some(value) = held[i] {
                        return fix(i..i + 1, value);
                    }
                    let sides = [(-1.0, lower), (1.0, upper)];
                    let halves = sides.into_iter().filter(|(_, bound)| bound.is_finite());
                    let halves = halves.map(|(sign, bound)| Cone::Half { i, sign, bound });
                    if rests[i] {
                        fix(i..i + 1, before[i]);
                        return resting.extend(halves);
                    }
                    return all.extend(halves);
                }
            };
            let mut circle = Circle {
                first,
                width,
                own: radius,
                follows: slope_of[first],
            };
            let mut vanishes = radius == 0.0;
            if let Some((of, slope)) = circle.follows {
                let own = radius - slope * before[of];
                circle.own = if own.abs() > ROUNDED * radius { own } else { 0.0 };
                if let Some(value) = held[of] {
                    (circle.own, circle.follows) = (own + slope * value, None);
                    vanishes = circle.own <= 0.0;
                }
            }
            match circle.follows {
                _ if !radius.is_finite() => {}
                Some((of, _)) if vanishes && rests[of] => {
                    fix(circle.components(), 0.0);
                    resting.push(Cone::Circle(circle));
                }
                None if vanishes => fix(circle.components(), 0.0),
                _ => all.push(Cone::Circle(circle)),
            }
        });
        let mut out = Self { all, resting, fixed };
        out.sort();
        Ok(out)
    }

    fn sort(&mut self) {
        self.all.sort_by_key(|cone| matches!(cone, Cone::Circle(_)));
    }

    /// Lets go what `pushes` off the bound on which it rests, given component and sign, with circles that follow.
    /// Whether there is any.
    pub(crate) fn let_go(&mut self, pushes: impl Fn(usize, f64) -> bool) -> bool {
        let mut goes = vec![false; self.fixed.len()];
        for cone in &self.resting {
            if let Cone::Half { i, sign, .. } = *cone {
                goes[i] = pushes(i, sign);
            }
        }
        let before = self.all.len();
        for cone in std::mem::take(&mut self.resting) {
            let (components, of) = match cone {
                Cone::Half { i, .. } => (i..i + 1, Some(i)),
                Cone::Circle(circle) => (circle.components(), circle.follows.map(|(of, _)| of)),
            };
            if of.is_some_and(|of| goes[of]) {
                self.fixed[components].fill(false);
                self.all.push(cone);
            } else {
                self.resting.push(cone);
            }
        }
        self.sort();
        self.all.len() > before
    }

    /// Components that rest on a bound.
    pub(crate) fn rests(&self) -> impl Iterator<Item = usize> {
        self.resting.iter().filter_map(|cone| match *cone {
            Cone::Half { i, .. } => Some(i),
            Cone::Circle(_) => None,
        })
    }

    /// Whether `x` is inside of all.
    pub(crate) fn holds(&self, x: &[f64]) -> bool {
        self.all.iter().all(|cone| cone.value(x) > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::Segment;

    #[test]
    fn the_first_root_is_found_whatever_bends() {
        for (q, rate, bend, root) in [
            (1.0, -1.0, 0.0, 1.0),
            (1.0, 1.0, 0.0, f64::INFINITY),
            (2.0, -3.0, 1.0, 1.0),
            (2.0, 3.0, 1.0, f64::INFINITY),
            (2.0, 1.0, -1.0, 2.0),
            (2.0, -1.0, -1.0, 1.0),
            (1.0, 0.0, -1.0, 1.0),
            (1.0, 0.0, 1.0, f64::INFINITY),
            (1.0, 0.0, 0.0, f64::INFINITY),
            (1.0, -1.0, 1.0, f64::INFINITY),
        ] {
            let found = Along { q, rate, bend }.root();
            let near = found == root || (found - root).abs() < 1e-14;
            assert!(near, "{q} {rate} {bend}: {found} for {root}");
        }
    }

    /// Derivatives by differences, for each kind of block.
    #[test]
    fn values_change_as_their_derivatives_tell() {
        let set = ProductSet::new(vec![
            Segment::upper(vec![0.0, 0.0]),
            Segment::discs(vec![0.7]),
            Segment::bounds(vec![-0.6, 1.0], vec![0.6, 3.0]),
            Segment::bounds(vec![2.0], vec![2.0]),
            Segment::discs(vec![0.0]),
            Segment::Free(1),
        ])
        .expect("a set");
        let follows = |disc, component, slope| RadiusSlope { disc, component, slope };
        let slopes = [follows(2, 0, -0.5), follows(4, 1, -0.2)];
        let mut x = vec![-1.0, -2.0, 0.3, 0.4, -0.1, 1.5, 9.0, 9.0, 9.0, 9.0];
        let cones = Cones::new(&set, &slopes, &mut x).expect("valid slopes");
        assert_eq!(x[6..], [2.0, 0.0, 0.0, 9.0]);
        assert_eq!(
            cones.fixed,
            [false, false, false, false, false, false, true, true, true, false]
        );
        // two bounds, a disc, an interval that follows, two sides of one that does not
        assert_eq!(cones.all.len(), 6);
        assert!(cones.holds(&x));
        let d: Vec<f64> = (0..10).map(|k| (k as f64).sin()).collect();
        for cone in &cones.all {
            let along = cone.along(&x, &d);
            let moved = |s: f64| -> Vec<f64> { x.iter().zip(&d).map(|(x, d)| x + s * d).collect() };
            let radius = |x: &[f64]| match *cone {
                Cone::Half { .. } => 1.0,
                Cone::Circle(circle) => circle.radius(x),
            };
            let far = moved(0.01);
            let q = radius(&far) * cone.value(&far);
            let told = along.q + 0.01 * along.rate + 1e-4 * along.bend;
            assert!((told - q).abs() < 1e-14, "{cone:?}");
            let [ahead, behind] = [1e-5, -1e-5].map(moved);
            let rate = (cone.value(&ahead) - cone.value(&behind)) / 2e-5;
            assert!((cone.rate(&x, &d) - rate).abs() < 1e-9, "{cone:?}");
            let normal = |x: &[f64]| {
                let mut out = vec![0.0; x.len()];
                cone.normal(x, |i, n| out[i] += n);
                out
            };
            let mut turns = vec![0.0; x.len()];
            cone.curvature(&x, |i, j, v| turns[i] += v * d[j]);
            for ((turns, a), b) in turns.iter().zip(normal(&ahead)).zip(normal(&behind)) {
                assert!((turns - (a - b) / 2e-5).abs() < 1e-8, "{cone:?}");
            }
        }
    }
}
