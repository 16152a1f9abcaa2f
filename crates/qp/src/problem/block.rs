//! The shapes of a block and their formulas: an interval, a disc. Another shape is another one here and a segment in
//! [`product`](super::product).

use crate::tolerances::ON_CIRCLE;

use super::set::BlockState;

/// A closed convex set of `N` components, as the methods of a [`ConvexSet`](super::set::ConvexSet) see one of its
/// blocks.
pub(crate) trait Shape<const N: usize>: Copy {
    fn state(self, x: [f64; N]) -> BlockState;
    /// The nearest point.
    fn project(self, x: [f64; N]) -> [f64; N];
    fn distance(self, x: [f64; N]) -> f64;
    /// Largest `t >= 0` with `x - t p` inside.
    fn step(self, x: [f64; N], p: [f64; N]) -> f64;
    /// `x - t p`, on the boundary without rounding error if that is reached.
    fn advance(self, x: [f64; N], p: [f64; N], t: f64) -> [f64; N];
    /// The parts of the gradient `g`, reduced ones for steps of length `a`.
    fn parts(self, x: [f64; N], g: [f64; N], a: f64) -> Parts<N>;
}

/// Gradient parts of a block: `projected` is `phi` or `beta`, `reduced` its reduced counterpart.
#[derive(Clone, Copy)]
pub(crate) struct Parts<const N: usize> {
    pub(crate) state: BlockState,
    pub(crate) projected: [f64; N],
    pub(crate) reduced: [f64; N],
}

/// One component between bounds, possibly infinite.
#[derive(Clone, Copy)]
pub(crate) struct Interval {
    pub(crate) lower: f64,
    pub(crate) upper: f64,
}

impl Interval {
    fn clamp(self, x: f64) -> f64 {
        if x < self.lower {
            self.lower
        } else if x > self.upper {
            self.upper
        } else {
            x
        }
    }
}

impl Shape<1> for Interval {
    #[inline]
    fn state(self, [x]: [f64; 1]) -> BlockState {
        if self.lower >= self.upper {
            BlockState::Fixed
        } else if x <= self.lower {
            BlockState::AtLower
        } else if x >= self.upper {
            BlockState::AtUpper
        } else {
            BlockState::Free
        }
    }

    #[inline]
    fn project(self, [x]: [f64; 1]) -> [f64; 1] {
        [self.clamp(x)]
    }

    #[inline]
    fn distance(self, [x]: [f64; 1]) -> f64 {
        (x - self.clamp(x)).abs()
    }

    #[inline]
    fn step(self, [x]: [f64; 1], [p]: [f64; 1]) -> f64 {
        let room = if p > 0.0 {
            x - self.lower
        } else if p < 0.0 {
            x - self.upper
        } else {
            return f64::INFINITY;
        };
        // room and p have the same sign; an infinite bound gives +inf
        (room / p).max(0.0)
    }

    #[inline]
    fn advance(self, x: [f64; 1], p: [f64; 1], t: f64) -> [f64; 1] {
        if self.step(x, p) <= t {
            [if p[0] > 0.0 { self.lower } else { self.upper }]
        } else {
            [self.clamp(x[0] - t * p[0])]
        }
    }

    #[inline]
    fn parts(self, x: [f64; 1], [g]: [f64; 1], a: f64) -> Parts<1> {
        let state = self.state(x);
        let projected = match state {
            BlockState::Fixed => 0.0,
            // written so that NaN is passed on
            BlockState::AtLower if g > 0.0 => 0.0,
            BlockState::AtUpper if g < 0.0 => 0.0,
            _ => g,
        };
        let reduced = if projected > 0.0 {
            projected.min((x[0] - self.lower) / a)
        } else {
            projected.max((x[0] - self.upper) / a)
        };
        Parts {
            state,
            projected: [projected],
            reduced: [reduced],
        }
    }
}

/// Two components of at most this length; a radius that is negative or NaN is read as 0.
#[derive(Clone, Copy)]
pub(crate) struct Disc {
    pub(crate) radius: f64,
}

impl Disc {
    fn radius(self) -> f64 {
        self.radius.max(0.0)
    }

    /// `x` of length `n` scaled to the radius, never beyond it by rounding.
    #[inline]
    fn on_circle(self, x: [f64; 2], n: f64) -> [f64; 2] {
        let r = self.radius();
        let s = r / n;
        let y = [s * x[0], s * x[1]];
        if y[0].hypot(y[1]) > r {
            let s = 1.0 - 2.0 * f64::EPSILON;
            return [s * y[0], s * y[1]];
        }
        y
    }
}

impl Shape<2> for Disc {
    #[inline]
    fn state(self, x: [f64; 2]) -> BlockState {
        let r = self.radius;
        if r > 0.0 {
            if x[0].hypot(x[1]) >= r * (1.0 - ON_CIRCLE) {
                BlockState::Boundary
            } else {
                BlockState::Interior
            }
        } else {
            BlockState::Fixed
        }
    }

    #[inline]
    fn project(self, x: [f64; 2]) -> [f64; 2] {
        let n = x[0].hypot(x[1]);
        if n > self.radius() { self.on_circle(x, n) } else { x }
    }

    #[inline]
    fn distance(self, x: [f64; 2]) -> f64 {
        (x[0].hypot(x[1]) - self.radius()).max(0.0)
    }

    #[inline]
    fn step(self, x: [f64; 2], p: [f64; 2]) -> f64 {
        let r = self.radius();
        let pp = p[0] * p[0] + p[1] * p[1];
        if pp == 0.0 || r.is_infinite() {
            return f64::INFINITY;
        }
        // |x - t p|² = r²: pp t² - 2 xp t - c = 0, c >= 0; the larger root without cancellation
        let n = x[0].hypot(x[1]);
        let c = ((r - n) * (r + n)).max(0.0);
        let xp = x[0] * p[0] + x[1] * p[1];
        let d = (xp * xp + pp * c).sqrt();
        let t = if xp > 0.0 {
            (xp + d) / pp
        } else if d - xp > 0.0 {
            c / (d - xp)
        } else {
            0.0
        };
        t.max(0.0)
    }

    #[inline]
    fn advance(self, x: [f64; 2], p: [f64; 2], t: f64) -> [f64; 2] {
        let own = self.step(x, p);
        if own <= t {
            let y = [x[0] - own * p[0], x[1] - own * p[1]];
            let n = y[0].hypot(y[1]);
            if n > 0.0 { self.on_circle(y, n) } else { y }
        } else {
            self.project([x[0] - t * p[0], x[1] - t * p[1]])
        }
    }

    #[inline]
    fn parts(self, x: [f64; 2], g: [f64; 2], a: f64) -> Parts<2> {
        let state = self.state(x);
        let projected = match state {
            BlockState::Fixed => {
                return Parts {
                    state,
                    projected: [0.0; 2],
                    reduced: [0.0; 2],
                };
            }
            BlockState::Boundary => {
                let n = x[0].hypot(x[1]);
                let n = [x[0] / n, x[1] / n];
                if g[0] * n[0] + g[1] * n[1] < 0.0 {
                    // -g points out of the disc: what is left of it is along the circle
                    let along = g[1] * n[0] - g[0] * n[1];
                    [-along * n[1], along * n[0]]
                } else {
                    g
                }
            }
            _ => g,
        };
        let y = [x[0] - a * g[0], x[1] - a * g[1]];
        let reduced = if y[0].hypot(y[1]) > self.radius {
            let z = self.project(y);
            [(x[0] - z[0]) / a, (x[1] - z[1]) / a]
        } else {
            g
        };
        Parts {
            state,
            projected,
            reduced,
        }
    }
}
