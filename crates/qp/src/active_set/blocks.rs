//! The active set of a product set: which blocks are active, free or sliding, and what that does to vectors.
//!
//! | local | meaning |
//! |---|---|
//! | `i`, `k` | first component of a block; number of the block among those of its kind |
//! | `n`, `tau` | outward normal and tangent of a disc |
//! | `kappa` | curvature that a disc adds along its tangent (`|du_T| / r` in contact) |

use crate::problem::{LineWeight, ProductSet, for_bounds, for_discs};
use crate::tolerances::MAY_SLIDE;

use super::disc::{Disc, along_circle};

/// Classification of all blocks; unconstrained components are free and not stored.
#[derive(Debug, Default)]
pub(crate) struct ActiveSet {
    /// For every component of bounds segments, in order: free or active.
    pub(crate) free: Vec<bool>,
    /// For every disc, in order.
    pub(crate) discs: Vec<Disc>,
    /// Bounds that are active in the next classification, then discs that slide, see [`foresee`](Self::foresee);
    /// empty where its own residual tells.
    pub(crate) foreseen: Vec<bool>,
    /// Largest radius of a disc that is held until a move takes it across its circle.
    pub(crate) crossing: f64,
    /// Bounded components that changed between free and active in the last [`classify`](Self::classify).
    pub(crate) changed: usize,
    /// Those of them that are free now.
    pub(crate) freed: usize,
    /// Bounded components that are free.
    pub(crate) free_bounds: usize,
}

impl ActiveSet {
    /// Makes room for the blocks of `set`; everything starts as active.
    pub(crate) fn resize(&mut self, set: &ProductSet) {
        let (mut bounds, mut discs) = (0, 0);
        for_bounds(set, |_, _, _, _| bounds += 1);
        for_discs(set, |_, _, _| discs += 1);
        self.free.clear();
        self.free.resize(bounds, false);
        self.discs.clear();
        self.discs.resize(discs, Disc::Fixed);
        self.foreseen.clear();
        self.changed = bounds;
        self.freed = 0;
        self.free_bounds = 0;
    }

    /// First guess from the point alone: components off their bounds are free, discs inside their circle stick.
    pub(crate) fn guess(&mut self, set: &ProductSet, x: &[f64]) {
        self.free_bounds = 0;
        for_bounds(set, |i, k, lo, hi| {
            self.free[k] = lo < hi && x[i] > lo && x[i] < hi;
            self.free_bounds += usize::from(self.free[k]);
        });
        for_discs(set, |i, k, radius| {
            let inside = radius > 0.0 && x[i].hypot(x[i + 1]) < radius * (1.0 - MAY_SLIDE);
            self.discs[k] = if inside { Disc::Free } else { Disc::Fixed };
        });
    }

    /// After a [guess](Self::guess): points on their circle slide along it. Where all do, these directions alone tell
    /// how far a body has gone.
    pub(crate) fn guess_sliding(&mut self, set: &ProductSet, x: &[f64]) {
        for_discs(set, |i, k, radius| {
            if self.discs[k] == Disc::Fixed && radius > 0.0 {
                self.discs[k] = along_circle([x[i], x[i + 1]], radius);
            }
        });
    }

    /// After a [guess](Self::guess): the next [`classify`](Self::classify) is to find what it has found, circles
    /// sliding.
    pub(crate) fn foresee_guess(&mut self) {
        let bounds = self.free.iter().map(|free| !free);
        self.foreseen = bounds
            .chain(self.discs.iter().map(|disc| *disc == Disc::Fixed))
            .collect();
    }

    /// Every bounded component and every disc free, whatever its bounds are now.
    pub(crate) fn free_all(&mut self) {
        self.free.fill(true);
        self.discs.fill(Disc::Free);
        self.free_bounds = self.free.len();
    }

    /// The directions of sliding discs, weighted like the preconditioner weighs them.
    pub(crate) fn lines(&self, set: &ProductSet, lines: &mut Vec<LineWeight>) {
        lines.clear();
        for_discs(set, |row, k, _| {
            if let Disc::Sliding { tau, damp, .. } = self.discs[k] {
                lines.push(LineWeight {
                    row,
                    direction: tau,
                    weight: damp,
                });
            }
        });
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

    /// Of the constrained components: 1 on those that may move in both directions, 0 on others (the one direction of
    /// sliding discs is among the [`lines`](Self::lines)).
    pub(crate) fn weights(&self, set: &ProductSet, w: &mut [f64]) {
        w.fill(1.0);
        let number = |free: bool| f64::from(u8::from(free));
        for_bounds(set, |i, k, _, _| w[i] = number(self.free[k]));
        for_discs(set, |i, k, _| {
            w[i..i + 2].fill(number(self.discs[k] == Disc::Free));
        });
    }

    /// Drops the components of `v` that are not free.
    pub(crate) fn restrict(&self, set: &ProductSet, v: &mut [f64]) {
        for_bounds(set, |i, k, _, _| {
            if !self.free[k] {
                v[i] = 0.0;
            }
        });
        for_discs(set, |i, k, _| match self.discs[k] {
            Disc::Fixed => v[i..i + 2].fill(0.0),
            Disc::Free => {}
            Disc::Sliding { tau, .. } => {
                let along = v[i] * tau[0] + v[i + 1] * tau[1];
                v[i] = along * tau[0];
                v[i + 1] = along * tau[1];
            }
        });
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
    /// Let `M` approximate the inverse of `A`. The inverse of `A + kappa` is then the parallel sum of `M` and
    /// `1/kappa`, `rᵀ X r = min over y of (r - y)ᵀ M (r - y) + yᵀ y / kappa`. The minimum for a diagonal `M`, `y =
    /// kappa m damp r`, bounds it from above for every `M`, and gives `damp M damp + own`: exact for small and for
    /// large curvatures. Scaling `M` by the square root of `damp` on both sides has the right diagonal only, and puts
    /// small eigenvalues where the curvature is large.
    pub(crate) fn add_own(&self, set: &ProductSet, r: &[f64], v: &mut [f64]) {
        for_discs(set, |i, k, _| {
            if let Disc::Sliding { own, .. } = self.discs[k] {
                v[i] += own * r[i];
                v[i + 1] += own * r[i + 1];
            }
        });
    }

    /// Notes the radii of all discs in the first entries of `out`.
    pub(crate) fn radii(&self, set: &ProductSet, out: &mut [f64]) {
        for_discs(set, |_, k, radius| out[k] = radius);
    }

    /// Whether a disc on whose circle a point slides, or which fixes it, has grown by more than `limit` since its
    /// radius was noted, or an interval has left an active component of `x` that far inside.
    pub(crate) fn grew(&self, set: &ProductSet, x: &[f64], radii: &[f64], limit: f64) -> bool {
        let mut found = false;
        for_bounds(set, |i, k, lo, hi| {
            found |= !self.free[k] && lo + limit < x[i] && x[i] < hi - limit
        });
        for_discs(set, |_, k, radius| {
            let bound = !matches!(self.discs[k], Disc::Free);
            found |= bound && radius - radii[k] > limit;
        });
        found
    }

    pub(crate) fn for_sliding(&self, set: &ProductSet, mut f: impl FnMut(usize, f64, f64)) {
        for_discs(set, |i, k, _| {
            if let Disc::Sliding { kappa, damp, .. } = self.discs[k] {
                f(i, kappa, damp);
            }
        });
    }
}
