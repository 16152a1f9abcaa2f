//! The face of a product set: which components are free, and the natural map that predicts the next one.
//!
//! | local | meaning |
//! |---|---|
//! | `x`, `g` | point, and gradient without its part in the image of `Gᵀ` |
//! | `s` | `x - a g`, the natural map before projection; `a = natural_step * scale` |
//! | `n`, `tau` | outward normal and tangent of a disc at `x` |
//! | `kappa` | curvature `-g·n / radius` that a disc adds along its tangent (`|du_T| / r` in contact) |

use crate::coarse_space::Line;
use crate::product::{ProductSet, Segment};

/// State of a disc on the current face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Disc {
    /// Radius 0.
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

/// Classification of all blocks; unconstrained components are free and not stored.
#[derive(Debug, Default)]
pub(crate) struct Face {
    /// For every component of bounds segments, in order: free or held.
    pub(crate) free: Vec<bool>,
    /// For every disc, in order.
    pub(crate) discs: Vec<Disc>,
    /// Blocks that stopped a step at their boundary, bounds first, then discs; empty for none. They stay there.
    pub(crate) blocked: Vec<bool>,
    /// Whether they stay where they are inside of their boundary, too.
    pub(crate) near: bool,
    /// Bounded components that changed between free and held in the last [`classify`](Face::classify).
    pub(crate) changed: usize,
    /// Bounded components that are free.
    pub(crate) free_bounds: usize,
}

/// A point on the circle within rounding.
const ON_CIRCLE: f64 = 1e-9;

/// Calls `bounds(start, index, lower, upper)` or `discs(start, index, radius)` for every constrained block.
pub(crate) fn visit(
    set: &ProductSet,
    mut bounds: impl FnMut(usize, usize, f64, f64),
    mut discs: impl FnMut(usize, usize, f64),
) {
    let (mut start, mut bound, mut disc) = (0, 0, 0);
    for segment in set.segments() {
        match segment {
            Segment::Free(n) => start += n,
            Segment::Bounds { lower, upper } => {
                for (&lo, &hi) in lower.iter().zip(upper) {
                    bounds(start, bound, lo, hi);
                    start += 1;
                    bound += 1;
                }
            }
            Segment::Discs { radii } => {
                for &radius in radii {
                    discs(start, disc, radius);
                    start += 2;
                    disc += 1;
                }
            }
        }
    }
}

impl Face {
    /// Makes room for the blocks of `set`; everything starts as held.
    pub(crate) fn resize(&mut self, set: &ProductSet) {
        let (mut bounds, mut discs) = (0, 0);
        visit(set, |_, _, _, _| bounds += 1, |_, _, _| discs += 1);
        self.free.clear();
        self.free.resize(bounds, false);
        self.discs.clear();
        self.discs.resize(discs, Disc::Fixed);
        self.blocked.clear();
        self.changed = bounds;
        self.free_bounds = 0;
    }

    /// First guess of the face from the point alone: components off their bounds are free, discs
    /// inside their circle stick.
    pub(crate) fn guess(&mut self, set: &ProductSet, x: &[f64]) {
        let Self { free, discs, .. } = self;
        let mut free_bounds = 0;
        visit(
            set,
            |i, k, lo, hi| {
                free[k] = lo < hi && x[i] > lo && x[i] < hi;
                free_bounds += usize::from(free[k]);
            },
            |i, k, radius| {
                let inside = radius > 0.0 && x[i].hypot(x[i + 1]) < radius * (1.0 - ON_CIRCLE);
                discs[k] = if inside { Disc::Free } else { Disc::Fixed };
            },
        );
        self.free_bounds = free_bounds;
    }

    /// Every bounded component and every disc free, whatever its bounds are now.
    pub(crate) fn free_all(&mut self) {
        self.free.fill(true);
        self.discs.fill(Disc::Free);
        self.free_bounds = self.free.len();
    }

    /// The directions of sliding discs, weighted like the preconditioner weighs them.
    pub(crate) fn lines(&self, set: &ProductSet, lines: &mut Vec<Line>) {
        lines.clear();
        visit(
            set,
            |_, _, _, _| {},
            |first, k, _| {
                if let Disc::Sliding { tau, damp, .. } = self.discs[k] {
                    lines.push(Line {
                        first,
                        direction: tau,
                        weight: damp,
                    });
                }
            },
        );
    }

    /// Frees the `count` discs that slide least; false if none slides.
    pub(crate) fn release(&mut self, count: usize) -> bool {
        let mut sliding: Vec<(f64, usize)> = Vec::new();
        for (k, disc) in self.discs.iter().enumerate() {
            if let Disc::Sliding { slip, .. } = disc {
                sliding.push((*slip, k));
            }
        }
        sliding.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for &(_, k) in sliding.iter().take(count) {
            self.discs[k] = Disc::Free;
        }
        !sliding.is_empty()
    }

    /// Classifies every block at the feasible point `x` with gradient `g`.
    pub(crate) fn classify(
        &mut self,
        set: &ProductSet,
        x: &[f64],
        g: &[f64],
        scale: &[f64],
        step: f64,
    ) {
        let Self {
            free,
            discs,
            blocked,
            near,
            ..
        } = self;
        let near = *near;
        let bounds = free.len();
        let stays = |k: usize| blocked.get(k).is_some_and(|b| *b);
        let (mut changed, mut free_bounds) = (0, 0);
        visit(
            set,
            |i, k, lo, hi| {
                let s = x[i] - step * scale[i] * g[i];
                // a component is held only if it also is where it would be held
                let held = lo >= hi
                    || (x[i] <= lo && (s <= lo || stays(k)))
                    || (x[i] >= hi && (s >= hi || stays(k)))
                    || (near && stays(k));
                changed += usize::from(free[k] == held);
                free[k] = !held;
                free_bounds += usize::from(!held);
            },
            |i, k, radius| {
                let at = [x[i], x[i + 1]];
                let state = disc_state(at, [g[i], g[i + 1]], radius, scale[i]);
                discs[k] = if stays(bounds + k) && state == Disc::Free {
                    along_circle(at, if near { 0.0 } else { radius })
                } else {
                    state
                };
            },
        );
        self.changed = changed;
        self.free_bounds = free_bounds;
    }

    /// Keeps the blocks where they are that stand at their boundary in `x` and that `step` takes across it; with a `reach`
    /// also those that this part of the step takes across. Whether there are more than before.
    pub(crate) fn block(&mut self, set: &ProductSet, x: &[f64], step: &[f64], reach: f64) -> bool {
        let (bounds, discs) = (self.free.len(), self.discs.len());
        let mut blocked = std::mem::take(&mut self.blocked);
        blocked.resize(bounds + discs, false);
        let count = |blocked: &[bool]| blocked.iter().filter(|b| **b).count();
        let before = count(&blocked);
        let blocked = std::cell::RefCell::new(blocked);
        visit(
            set,
            |i, k, lo, hi| {
                let end = x[i] + reach * step[i];
                if (x[i].min(end) <= lo && step[i] < 0.0) || (x[i].max(end) >= hi && step[i] > 0.0)
                {
                    blocked.borrow_mut()[k] = true;
                }
            },
            |i, k, radius| {
                let outward = x[i] * step[i] + x[i + 1] * step[i + 1];
                let end = (x[i] + reach * step[i]).hypot(x[i + 1] + reach * step[i + 1]);
                let far = x[i].hypot(x[i + 1]).max(end);
                if far >= radius * (1.0 - ON_CIRCLE) && outward > 0.0 {
                    blocked.borrow_mut()[bounds + k] = true;
                }
            },
        );
        self.blocked = blocked.into_inner();
        self.near = reach > 0.0;
        count(&self.blocked) > before
    }

    /// 1 on components that may move in both directions, 0 on others (the one direction of sliding discs is among the
    /// [`lines`](Self::lines)).
    pub(crate) fn weights(&self, set: &ProductSet, w: &mut [f64]) {
        w.fill(1.0);
        let (mut start, mut bound, mut disc) = (0, 0, 0);
        for segment in set.segments() {
            let end = start + segment.len();
            match segment {
                Segment::Free(_) => {}
                Segment::Bounds { .. } => {
                    for value in &mut w[start..end] {
                        *value = f64::from(u8::from(self.free[bound]));
                        bound += 1;
                    }
                }
                Segment::Discs { .. } => {
                    for pair in w[start..end].chunks_exact_mut(2) {
                        pair.fill(if self.discs[disc] == Disc::Free {
                            1.0
                        } else {
                            0.0
                        });
                        disc += 1;
                    }
                }
            }
            start = end;
        }
    }

    /// As [`weights`](Self::weights), with 1 on both components of sliding discs too.
    pub(crate) fn loose_weights(&self, set: &ProductSet, w: &mut [f64]) {
        self.weights(set, w);
        self.for_sliding(set, |i, _, _| w[i..i + 2].fill(1.0));
    }

    /// Drops the components of `v` that are not free on the face.
    pub(crate) fn restrict(&self, set: &ProductSet, v: &mut [f64]) {
        let mut start = 0;
        let (mut bound, mut disc) = (0, 0);
        for segment in set.segments() {
            let end = start + segment.len();
            match segment {
                Segment::Free(_) => {}
                Segment::Bounds { .. } => {
                    for value in &mut v[start..end] {
                        if !self.free[bound] {
                            *value = 0.0;
                        }
                        bound += 1;
                    }
                }
                Segment::Discs { .. } => {
                    for pair in v[start..end].chunks_exact_mut(2) {
                        match self.discs[disc] {
                            Disc::Fixed => pair.fill(0.0),
                            Disc::Free => {}
                            Disc::Sliding { tau, .. } => {
                                let along = pair[0] * tau[0] + pair[1] * tau[1];
                                pair[0] = along * tau[0];
                                pair[1] = along * tau[1];
                            }
                        }
                        disc += 1;
                    }
                }
            }
            start = end;
        }
    }

    /// `sum kappa |p|^2` over sliding discs.
    pub(crate) fn curvature(&self, set: &ProductSet, p: &[f64]) -> f64 {
        let mut sum = 0.0;
        self.for_sliding(set, |i, kappa, _| {
            sum += kappa * (p[i] * p[i] + p[i + 1] * p[i + 1]);
        });
        sum
    }

    /// Adds the curvature of sliding discs: `y += kappa * p` on their components (`p` is restricted).
    pub(crate) fn add_curvature(&self, set: &ProductSet, p: &[f64], y: &mut [f64]) {
        self.for_sliding(set, |i, kappa, _| {
            y[i] += kappa * p[i];
            y[i + 1] += kappa * p[i + 1];
        });
    }

    /// Scales sliding components by the share of the preconditioner that the curvature leaves; see
    /// [`add_own`](Self::add_own).
    pub(crate) fn damp(&self, set: &ProductSet, v: &mut [f64]) {
        self.for_sliding(set, |i, _, damp| {
            v[i] *= damp;
            v[i + 1] *= damp;
        });
    }

    /// Adds what the preconditioner has on sliding components besides the damped one: `v += own r`.
    ///
    /// Let `M` approximate the inverse of `A`. The inverse of `A + kappa` is then the parallel sum of `M` and `1/kappa`,
    /// `rᵀ X r = min over y of (r - y)ᵀ M (r - y) + yᵀ y / kappa`. The minimum for a diagonal `M`, `y = kappa m damp r`,
    /// bounds it from above for every `M`, and gives `damp M damp + own`: exact for small and for large curvatures.
    /// Scaling `M` by the square root of `damp` on both sides has the right diagonal only, and puts small
    /// eigenvalues where the curvature is large.
    pub(crate) fn add_own(&self, set: &ProductSet, r: &[f64], v: &mut [f64]) {
        visit(
            set,
            |_, _, _, _| {},
            |i, k, _| {
                if let Disc::Sliding { own, .. } = self.discs[k] {
                    v[i] += own * r[i];
                    v[i + 1] += own * r[i + 1];
                }
            },
        );
    }

    fn for_sliding(&self, set: &ProductSet, mut f: impl FnMut(usize, f64, f64)) {
        visit(
            set,
            |_, _, _, _| {},
            |i, k, _| {
                if let Disc::Sliding { kappa, damp, .. } = self.discs[k] {
                    f(i, kappa, damp);
                }
            },
        );
    }

    /// Moves the bounded components of `x` by the natural map: onto their bound where it predicts that
    /// they are held, else into the interval.
    pub(crate) fn settle_bounds(
        &self,
        set: &ProductSet,
        x: &mut [f64],
        g: &[f64],
        scale: &[f64],
        step: f64,
    ) {
        let mut start = 0;
        for segment in set.segments() {
            if let Segment::Bounds { lower, upper } = segment {
                for (k, (&lo, &hi)) in lower.iter().zip(upper).enumerate() {
                    let i = start + k;
                    let s = x[i] - step * scale[i] * g[i];
                    x[i] = if s <= lo {
                        lo
                    } else if s >= hi {
                        hi
                    } else {
                        x[i].clamp(lo.min(hi), hi)
                    };
                }
            }
            start += segment.len();
        }
    }

    /// Moves the discs of `x` into their circles: sliding points are drawn back along the radius, others
    /// go where the natural map predicts that they slide.
    pub(crate) fn settle_discs(
        &self,
        set: &ProductSet,
        x: &mut [f64],
        g: &[f64],
        scale: &[f64],
        step: f64,
    ) {
        let (mut start, mut disc) = (0, 0);
        for segment in set.segments() {
            if let Segment::Discs { radii } = segment {
                for (k, &radius) in radii.iter().enumerate() {
                    let i = start + 2 * k;
                    let sliding = matches!(self.discs[disc], Disc::Sliding { .. });
                    let moved = settle_disc(
                        [x[i], x[i + 1]],
                        [g[i], g[i + 1]],
                        radius,
                        step * scale[i],
                        sliding,
                    );
                    x[i] = moved[0];
                    x[i + 1] = moved[1];
                    disc += 1;
                }
            }
            start += segment.len();
        }
    }
}

/// Free along the circle, without curvature; free everywhere inside of it. With radius 0 along the circle through `x`.
fn along_circle(x: [f64; 2], radius: f64) -> Disc {
    let length = x[0].hypot(x[1]);
    if length <= 0.0 || length < radius * (1.0 - ON_CIRCLE) {
        return Disc::Free;
    }
    slides([x[0] / length, x[1] / length], 0.0, 1.0, 0.0)
}

/// Sliding with outward normal `n`.
fn slides(n: [f64; 2], slip: f64, radius: f64, scale: f64) -> Disc {
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

fn disc_state(x: [f64; 2], g: [f64; 2], radius: f64, scale: f64) -> Disc {
    if radius <= 0.0 {
        return Disc::Fixed;
    }
    let length = x[0].hypot(x[1]);
    if length < radius * (1.0 - ON_CIRCLE) {
        return Disc::Free;
    }
    let n = [x[0] / length, x[1] / length];
    let outward = g[0] * n[0] + g[1] * n[1];
    if outward >= 0.0 {
        return Disc::Free;
    }
    slides(n, -outward, radius, scale)
}

fn settle_disc(x: [f64; 2], g: [f64; 2], radius: f64, a: f64, sliding: bool) -> [f64; 2] {
    if radius <= 0.0 {
        return [0.0; 2];
    }
    let length = x[0].hypot(x[1]);
    if sliding {
        return if length > 0.0 {
            [x[0] * (radius / length), x[1] * (radius / length)]
        } else {
            x
        };
    }
    let s = [x[0] - a * g[0], x[1] - a * g[1]];
    let reach = s[0].hypot(s[1]);
    if reach > radius {
        [s[0] * (radius / reach), s[1] * (radius / reach)]
    } else if length > radius {
        [x[0] * (radius / length), x[1] * (radius / length)]
    } else {
        x
    }
}
