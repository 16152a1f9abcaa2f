//! Elementary formulas of one bounded component and of one disc.
//!
//! | local | meaning |
//! |---|---|
//! | `lo`, `hi` | bounds, possibly infinite |
//! | `r` | radius; NaN or negative values are read as 0 |
//! | `a` | fixed step length of the reduced gradient |

use crate::set::BlockState;

/// A point whose distance from the circle is below this fraction of the radius lies on it.
pub(crate) const ON_CIRCLE: f64 = 1e-12;

/// Gradient parts of a block: `projected` is `phi` or `beta`, `reduced` its reduced counterpart.
#[derive(Clone, Copy)]
pub(crate) struct Parts<T> {
    pub(crate) state: BlockState,
    pub(crate) projected: T,
    pub(crate) reduced: T,
}

#[inline]
pub(crate) fn clamp(x: f64, lo: f64, hi: f64) -> f64 {
    if x < lo {
        lo
    } else if x > hi {
        hi
    } else {
        x
    }
}

#[inline]
pub(crate) fn bound_state(x: f64, lo: f64, hi: f64) -> BlockState {
    if lo >= hi {
        BlockState::Fixed
    } else if x <= lo {
        BlockState::AtLower
    } else if x >= hi {
        BlockState::AtUpper
    } else {
        BlockState::Free
    }
}

#[inline]
pub(crate) fn bound_parts(x: f64, g: f64, lo: f64, hi: f64, a: f64) -> Parts<f64> {
    let state = bound_state(x, lo, hi);
    let projected = match state {
        BlockState::Fixed => 0.0,
        // written so that NaN is passed on
        BlockState::AtLower if g > 0.0 => 0.0,
        BlockState::AtUpper if g < 0.0 => 0.0,
        _ => g,
    };
    let reduced = if projected > 0.0 {
        projected.min((x - lo) / a)
    } else {
        projected.max((x - hi) / a)
    };
    Parts {
        state,
        projected,
        reduced,
    }
}

#[inline]
pub(crate) fn bound_step(x: f64, p: f64, lo: f64, hi: f64) -> f64 {
    let room = if p > 0.0 {
        x - lo
    } else if p < 0.0 {
        x - hi
    } else {
        return f64::INFINITY;
    };
    // room and p have the same sign; an infinite bound gives +inf
    (room / p).max(0.0)
}

#[inline]
pub(crate) fn bound_advance(x: f64, p: f64, lo: f64, hi: f64, t: f64) -> f64 {
    if bound_step(x, p, lo, hi) <= t {
        if p > 0.0 { lo } else { hi }
    } else {
        clamp(x - t * p, lo, hi)
    }
}

#[inline]
pub(crate) fn disc_project(x: [f64; 2], r: f64) -> [f64; 2] {
    let r = r.max(0.0);
    let n = x[0].hypot(x[1]);
    if n > r { on_circle(x, n, r) } else { x }
}

/// `x` scaled to length `r`, never beyond it by rounding.
#[inline]
fn on_circle(x: [f64; 2], n: f64, r: f64) -> [f64; 2] {
    let s = r / n;
    let y = [s * x[0], s * x[1]];
    if y[0].hypot(y[1]) > r {
        let s = 1.0 - 2.0 * f64::EPSILON;
        return [s * y[0], s * y[1]];
    }
    y
}

#[inline]
pub(crate) fn disc_state(x: [f64; 2], r: f64) -> BlockState {
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
pub(crate) fn disc_parts(x: [f64; 2], g: [f64; 2], r: f64, a: f64) -> Parts<[f64; 2]> {
    let state = disc_state(x, r);
    let projected = match state {
        BlockState::Fixed => [0.0; 2],
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
    if state == BlockState::Fixed {
        return Parts {
            state,
            projected,
            reduced: projected,
        };
    }
    let y = [x[0] - a * g[0], x[1] - a * g[1]];
    let reduced = if y[0].hypot(y[1]) > r {
        let z = disc_project(y, r);
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

#[inline]
pub(crate) fn disc_step(x: [f64; 2], p: [f64; 2], r: f64) -> f64 {
    let r = r.max(0.0);
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
pub(crate) fn disc_advance(x: [f64; 2], p: [f64; 2], r: f64, t: f64) -> [f64; 2] {
    let own = disc_step(x, p, r);
    if own <= t {
        let y = [x[0] - own * p[0], x[1] - own * p[1]];
        let n = y[0].hypot(y[1]);
        if n > 0.0 {
            on_circle(y, n, r.max(0.0))
        } else {
            y
        }
    } else {
        disc_project([x[0] - t * p[0], x[1] - t * p[1]], r)
    }
}
