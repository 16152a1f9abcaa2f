//! A disc at a point: its state by the gradient there, and where the natural map settles it.
//!
//! | local | meaning |
//! |---|---|
//! | `x`, `g`, `a` | point, gradient, length of the map's step |
//! | `n`, `tau` | outward normal and tangent at `x` |
//! | `kappa` | curvature `-g·n / radius` that the disc adds along its tangent (`|du_T| / r` in contact) |

use crate::tolerances::{ACROSS, MAY_SLIDE};

/// State of a disc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Disc {
    /// Radius 0, or held until a move takes it across its circle.
    Fixed,
    /// Both components free.
    Free,
    /// On the circle: free along `tau` only, with extra curvature `kappa`.
    Sliding {
        tau: [f64; 2],
        kappa: f64,
        /// `1 / (1 + kappa m)`, `m` the scale: share of the preconditioner that the curvature leaves.
        damp: f64,
        /// `kappa (m damp)^2`: what it adds on its own.
        own: f64,
        /// `-g·n`.
        slip: f64,
    },
}

/// Free along the circle, without curvature; free everywhere inside of it. With radius 0 along the circle through `x`.
pub(crate) fn along_circle(x: [f64; 2], radius: f64) -> Disc {
    outward(x, radius).map_or(Disc::Free, |n| slides(n, 0.0, 1.0, 0.0))
}

/// The outward normal at a point that is not inside.
fn outward(x: [f64; 2], radius: f64) -> Option<[f64; 2]> {
    let length = x[0].hypot(x[1]);
    let inside = length <= 0.0 || length < radius * (1.0 - MAY_SLIDE);
    (!inside).then(|| [x[0] / length, x[1] / length])
}

/// Sliding with outward normal `n`.
pub(crate) fn slides(n: [f64; 2], slip: f64, radius: f64, scale: f64) -> Disc {
    let kappa = slip / radius;
    let damp = 1.0 / (1.0 + kappa * scale);
    Disc::Sliding {
        tau: [-n[1], n[0]],
        kappa,
        damp,
        own: (kappa * scale * damp) * (scale * damp),
        slip,
    }
}

pub(crate) fn disc_state(x: [f64; 2], g: [f64; 2], radius: f64, scale: f64) -> Disc {
    if radius <= 0.0 {
        return Disc::Fixed;
    }
    let pushed = |n: &[f64; 2]| g[0] * n[0] + g[1] * n[1] < 0.0;
    match outward(x, radius).filter(pushed) {
        Some(n) => slides(n, -(g[0] * n[0] + g[1] * n[1]), radius, scale),
        None => Disc::Free,
    }
}

/// Whether a point on its circle goes so far inwards that it comes to the other side, or one in the centre so far out
/// of a circle that has just grown, as far as its own scale tells. A solve with the disc free would take it there and
/// spoil what else it finds; so it is held, and the move takes it across. On the circle not twice in a row: with others
/// that go with it a point gives way further than it does alone.
pub(crate) fn crosses(x: [f64; 2], g: [f64; 2], radius: f64, a: f64, is_held: bool) -> bool {
    let length = x[0].hypot(x[1]);
    if length <= 0.0 {
        return a * g[0].hypot(g[1]) > ACROSS * radius;
    }
    let inward = a * (g[0] * x[0] + g[1] * x[1]) / length;
    !is_held && length >= radius * (1.0 - MAY_SLIDE) && inward > ACROSS * radius
}

pub(crate) fn settle_disc(x: [f64; 2], g: [f64; 2], radius: f64, a: f64, sliding: bool) -> [f64; 2] {
    if radius <= 0.0 {
        return [0.0; 2];
    }
    let to = |v: [f64; 2], length: f64| [v[0] * (radius / length), v[1] * (radius / length)];
    let length = x[0].hypot(x[1]);
    if sliding {
        return if length > 0.0 { to(x, length) } else { x };
    }
    let s = [x[0] - a * g[0], x[1] - a * g[1]];
    let reach = s[0].hypot(s[1]);
    match (reach > radius, length > radius) {
        (true, _) => to(s, reach),
        (_, true) => to(x, length),
        _ => x,
    }
}
