//! The natural map: which active set it predicts, and where it moves the point.
//!
//! | local | meaning |
//! |---|---|
//! | `x`, `g` | point, and gradient without its part in the image of `Gᵀ` |
//! | `s` | `x - a g`, the natural map before projection; `a = step * scale` |
//! | `n`, `tau` | outward normal and tangent of a disc at `x` |
//! | `kappa` | curvature `-g·n / radius` that a disc adds along its tangent (`|du_T| / r` in contact) |

use crate::problem::{ProductSet, for_bounds, for_discs};
use crate::tolerances::MAY_SLIDE;

use super::blocks::ActiveSet;
use super::disc::{Disc, along_circle, crosses, disc_state, settle_disc};

/// Gradient and lengths of the natural map.
#[derive(Clone, Copy)]
pub(crate) struct NaturalMap<'a> {
    /// `g`.
    pub(crate) gradient: &'a [f64],
    pub(crate) scale: &'a [f64],
    /// `NATURAL_STEP`, on a path that of its springs.
    pub(crate) step: f64,
}

impl NaturalMap<'_> {
    /// Component `i` of `s`.
    fn of(&self, x: &[f64], i: usize) -> f64 {
        x[i] - self.step * self.scale[i] * self.gradient[i]
    }

    /// The gradient on the disc that begins with component `i`.
    fn on_disc(&self, i: usize) -> [f64; 2] {
        [self.gradient[i], self.gradient[i + 1]]
    }
}

impl ActiveSet {
    /// Classifies every block at the feasible point `x`; as [foreseen](Self::foresee), if it was.
    pub(crate) fn classify(&mut self, set: &ProductSet, x: &[f64], map: &NaturalMap<'_>) {
        let Self {
            free, discs, foreseen, ..
        } = self;
        let bounds = free.len();
        let (mut changed, mut freed, mut free_bounds, mut crossing) = (0, 0, 0, 0.0_f64);
        for_bounds(set, |i, k, lo, hi| {
            let s = map.of(x, i);
            // a component is active only if it also is at its bound
            let agrees = |beyond: bool| foreseen.get(k).copied().unwrap_or(beyond);
            let active = lo >= hi || (x[i] <= lo && agrees(s <= lo)) || (x[i] >= hi && agrees(s >= hi));
            changed += usize::from(free[k] == active);
            freed += usize::from(!free[k] && !active);
            free[k] = !active;
            free_bounds += usize::from(!active);
        });
        for_discs(set, |i, k, radius| {
            let at = [x[i], x[i + 1]];
            let g = map.on_disc(i);
            let mut state = disc_state(at, g, radius, map.scale[i]);
            if state == Disc::Free && crosses(at, g, radius, map.step * map.scale[i], discs[k] == Disc::Fixed) {
                state = Disc::Fixed;
                crossing = crossing.max(radius);
            }
            discs[k] = match (foreseen.get(bounds + k), state) {
                (Some(true), Disc::Free) => along_circle(at, radius),
                (Some(false), Disc::Sliding { .. }) => Disc::Free,
                _ => state,
            };
        });
        foreseen.clear();
        self.crossing = crossing;
        self.changed = changed;
        self.freed = freed;
        self.free_bounds = free_bounds;
    }

    /// Notes the bounds that the natural map makes active at `x`, the solution on this set, and the discs that slide:
    /// those and no others are so in the next [`classify`](Self::classify).
    pub(crate) fn foresee(&mut self, set: &ProductSet, x: &[f64], map: &NaturalMap<'_>) {
        let (foreseen, discs) = (&mut self.foreseen, &self.discs);
        foreseen.clear();
        for_bounds(set, |i, _, lo, hi| {
            let s = map.of(x, i);
            foreseen.push(s <= lo || s >= hi);
        });
        for_discs(set, |i, k, radius| {
            let g = map.on_disc(i);
            foreseen.push(match discs[k] {
                Disc::Sliding { .. } => g[0] * x[i] + g[1] * x[i + 1] < 0.0,
                _ => map.of(x, i).hypot(map.of(x, i + 1)) > radius,
            });
        });
    }

    /// The same for a point `x` that has been moved since: blocks that came to a boundary stay there, those that were
    /// there before as long as the map does not release them.
    pub(crate) fn foresee_moved(&mut self, set: &ProductSet, x: &[f64], map: &NaturalMap<'_>) {
        let (foreseen, free, discs) = (&mut self.foreseen, &self.free, &self.discs);
        foreseen.clear();
        for_bounds(set, |i, k, lo, hi| {
            let (at, s) = (x[i] <= lo || x[i] >= hi, map.of(x, i));
            foreseen.push(at && (free[k] || s <= lo || s >= hi));
        });
        for_discs(set, |i, k, radius| {
            let (at, g) = (x[i].hypot(x[i + 1]) >= radius * (1.0 - MAY_SLIDE), map.on_disc(i));
            let slid = matches!(discs[k], Disc::Sliding { .. });
            foreseen.push(at && (!slid || g[0] * x[i] + g[1] * x[i + 1] < 0.0));
        });
    }

    /// Whether the natural map leaves every block as it is and where it is; a point that slides moves with its circle.
    pub(crate) fn stays(&self, set: &ProductSet, x: &[f64], map: &NaturalMap<'_>) -> bool {
        let mut stays = true;
        for_bounds(set, |i, k, lo, hi| {
            let s = map.of(x, i);
            let inside = |v: f64| v > lo && v < hi;
            stays &= inside(s) == self.free[k] && (!self.free[k] || inside(x[i]));
        });
        for_discs(set, |i, k, radius| {
            stays &= match self.discs[k] {
                Disc::Fixed => radius <= 0.0,
                Disc::Free => map.of(x, i).hypot(map.of(x, i + 1)) <= radius && x[i].hypot(x[i + 1]) <= radius,
                Disc::Sliding { .. } => false,
            };
        });
        stays
    }

    /// Whether the natural map would free an active bound, and move it by more than `limit`.
    pub(crate) fn contradicted(&self, set: &ProductSet, x: &[f64], map: &NaturalMap<'_>, limit: f64) -> bool {
        let mut found = false;
        for_bounds(set, |i, k, lower, upper| {
            if !self.free[k] && lower < upper {
                let moved = map.of(x, i).clamp(lower, upper);
                found |= (moved - x[i]).abs() > limit;
            }
        });
        found
    }

    /// Moves the discs of `x` into their circles: sliding points are drawn back along the radius, others
    /// go where the natural map predicts that they slide.
    pub(crate) fn settle_discs(&self, set: &ProductSet, x: &mut [f64], map: &NaturalMap<'_>) {
        for_discs(set, |i, k, radius| {
            let sliding = matches!(self.discs[k], Disc::Sliding { .. });
            let (at, a) = ([x[i], x[i + 1]], map.step * map.scale[i]);
            let moved = settle_disc(at, map.on_disc(i), radius, a, sliding);
            x[i] = moved[0];
            x[i + 1] = moved[1];
        });
    }

    /// Where `x` goes before it is projected on the set: as far outside as the natural map says, else it stays. Along
    /// circles the gradient is balanced by the curvature already.
    pub(crate) fn aim(&self, set: &ProductSet, x: &mut [f64], map: &NaturalMap<'_>) {
        for_bounds(set, |i, _, lo, hi| {
            let s = map.of(x, i);
            if s <= lo || s >= hi {
                x[i] = s;
            }
        });
        for_discs(set, |i, k, radius| {
            let (at, a, g) = ([x[i], x[i + 1]], map.step * map.scale[i], map.on_disc(i));
            let moved = if let Disc::Sliding { tau, .. } = self.discs[k] {
                let slip = (g[1] * tau[0] - g[0] * tau[1]).max(0.0);
                let length = at[0].hypot(at[1]);
                let share = if length > 0.0 { (radius + a * slip) / length } else { 1.0 };
                [share * at[0], share * at[1]]
            } else {
                let s = [at[0] - a * g[0], at[1] - a * g[1]];
                if s[0].hypot(s[1]) > radius { s } else { at }
            };
            x[i] = moved[0];
            x[i + 1] = moved[1];
        });
    }
}

/// Moves the bounded components of `x` by the natural map: onto their bound where it predicts that
/// they are active, else into the interval.
pub(crate) fn settle_bounds(set: &ProductSet, x: &mut [f64], map: &NaturalMap<'_>) {
    for_bounds(set, |i, _, lo, hi| {
        let s = map.of(x, i);
        x[i] = if s <= lo {
            lo
        } else if s >= hi {
            hi
        } else {
            x[i].clamp(lo.min(hi), hi)
        };
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::active_set::disc::slides;
    use crate::problem::Segment;
    use crate::tolerances::ACROSS;

    /// The map of a set of one segment, with scale 2 and step 0.5: `s = x - g`.
    fn with<T>(segment: Segment, g: &[f64], f: impl Fn(&ProductSet, &NaturalMap<'_>) -> T) -> T {
        let set = ProductSet::new(vec![segment]).expect("set");
        let (gradient, scale, step) = (g, &[2.0; 2][..], 0.5);
        f(&set, &NaturalMap { gradient, scale, step })
    }

    fn active_set(set: &ProductSet) -> ActiveSet {
        let mut own = ActiveSet::default();
        own.resize(set);
        own
    }

    #[test]
    fn components_are_active_where_they_are_and_would_be_so() {
        // x, gradient: free?
        for (x, g, free) in [
            (0.0, 0.5, false),
            (0.0, -0.5, true),
            (1.0, -0.5, false),
            (1.0, 0.5, true),
            // predicted to be active, but not there
            (0.5, 2.0, true),
            (0.5, -2.0, true),
        ] {
            let what = format!("{x} {g}");
            with(Segment::bounds(vec![0.0], vec![1.0]), &[g], |set, map| {
                let mut own = active_set(set);
                own.classify(set, &[x], map);
                assert_eq!(own.free, [free], "{what}");
                let count = usize::from(free);
                let counts = |own: &ActiveSet| [own.changed, own.freed, own.free_bounds];
                assert_eq!(counts(&own), [count; 3], "{what}");
                // again: nothing changes
                own.classify(set, &[x], map);
                assert_eq!(counts(&own), [0, 0, count], "{what}");
            });
        }
        with(Segment::bounds(vec![1.0], vec![1.0]), &[-3.0], |set, map| {
            let mut own = active_set(set);
            own.classify(set, &[1.0], map);
            assert_eq!(own.free, [false]);
        });
    }

    #[test]
    fn active_bounds_that_the_map_would_move_contradict() {
        for (x, g, free, expected) in [
            (0.0, -0.5, false, true),
            (0.0, 0.5, false, false),
            (0.0, -0.5, true, false),
            (1.0, 0.5, false, true),
            // by less than the limit
            (0.0, -0.05, false, false),
        ] {
            with(Segment::bounds(vec![0.0], vec![1.0]), &[g], |set, map| {
                let mut own = active_set(set);
                own.free = vec![free];
                assert_eq!(own.contradicted(set, &[x], map, 0.1), expected, "{x} {g}");
            });
        }
        with(Segment::bounds(vec![1.0], vec![1.0]), &[-3.0], |set, map| {
            assert!(!active_set(set).contradicted(set, &[1.0], map, 0.1));
        });
    }

    #[test]
    fn an_active_set_stays_where_no_block_would_change() {
        // x, gradient, free: stays?
        for (x, g, free, stays) in [
            (0.5, 0.1, true, true),
            (0.5, 0.6, true, false),
            (1.2, 0.5, true, false),
            (0.0, 0.5, false, true),
            // the map releases it
            (0.0, -0.5, false, false),
        ] {
            with(Segment::bounds(vec![0.0], vec![1.0]), &[g], |set, map| {
                let mut own = active_set(set);
                own.free = vec![free];
                assert_eq!(own.stays(set, &[x], map), stays, "{x} {g} {free}");
            });
        }
        let sliding = slides([1.0, 0.0], 1.0, 2.0, 1.0);
        for (state, x, g, stays) in [
            (Disc::Free, [1.0, 0.0], [0.1, 0.0], true),
            (Disc::Free, [1.0, 0.0], [-1.1, 0.0], false),
            (Disc::Free, [2.1, 0.0], [1.0, 0.0], false),
            (sliding, [2.0, 0.0], [-1.0, 0.0], false),
        ] {
            with(Segment::discs(vec![2.0]), &g, |set, map| {
                let mut own = active_set(set);
                own.discs = vec![state];
                assert_eq!(own.stays(set, &x, map), stays, "{state:?} {x:?} {g:?}");
            });
        }
    }

    /// What a balance has brought to a boundary is active next, whatever the residual says after it.
    #[test]
    fn moved_points_tell_what_is_active_next() {
        // moved to x, gradient before, free before, gradient after: free?
        for (x, before, free, after, expected) in [
            (0.0, 0.1, true, -9.0, false),
            (0.0, 0.1, false, -9.0, false),
            (0.0, -0.1, false, 9.0, true),
            (0.5, 0.9, true, 9.0, true),
        ] {
            let what = format!("{x} {before} {free} {after}");
            let segment = || Segment::bounds(vec![0.0], vec![1.0]);
            let own = with(segment(), &[before], |set, map| {
                let mut own = active_set(set);
                own.free = vec![free];
                own.foresee_moved(set, &[x], map);
                own.foreseen
            });
            with(segment(), &[after], |set, map| {
                let mut next = active_set(set);
                next.foreseen.clone_from(&own);
                next.classify(set, &[x], map);
                assert_eq!(next.free, [expected], "{what}");
            });
        }
        let sliding = slides([1.0, 0.0], 1.0, 2.0, 1.0);
        for (state, x, g, expected) in [
            (Disc::Free, [2.0, 0.0], [1.0, 0.0], true),
            (Disc::Free, [1.0, 0.0], [-9.0, 0.0], false),
            (sliding, [2.0, 0.0], [-1.0, 0.0], true),
            (sliding, [2.0, 0.0], [1.0, 0.0], false),
        ] {
            with(Segment::discs(vec![2.0]), &g, |set, map| {
                let mut own = active_set(set);
                own.discs = vec![state];
                own.foresee_moved(set, &x, map);
                assert_eq!(own.foreseen, [expected], "{state:?} {x:?} {g:?}");
            });
        }
    }

    #[test]
    fn bounds_are_settled_where_the_map_goes() {
        for (x, g, expected) in [
            (0.2, 0.5, 0.0),
            (0.8, -0.5, 1.0),
            (0.4, 0.1, 0.4),
            (1.5, 1.0, 1.0),
            (-0.5, -1.0, 0.0),
        ] {
            with(Segment::bounds(vec![0.0], vec![1.0]), &[g], |set, map| {
                let mut v = [x];
                settle_bounds(set, &mut v, map);
                assert_eq!(v, [expected], "{x} {g}");
            });
        }
    }

    #[test]
    fn discs_stick_inside_and_slide_on_the_circle() {
        let (n, radius) = ([0.6, 0.8], 2.0);
        let on = n.map(|c| radius * c);
        let state = |radius: f64, x: [f64; 2], g: [f64; 2]| {
            with(Segment::discs(vec![radius]), &g, |set, map| {
                let mut own = active_set(set);
                own.classify(set, &x, map);
                own.discs[0]
            })
        };
        assert_eq!(state(0.0, [0.0; 2], [1.0; 2]), Disc::Fixed);
        assert_eq!(state(radius, [0.6, 0.8], [-6.0, -8.0]), Disc::Free);
        // drawn inward
        assert_eq!(state(radius, on, [0.6, 0.8]), Disc::Free);
        // far beyond the other side: held for the move across, once
        let far = n.map(|c| 4.0 * ACROSS * radius * c);
        with(Segment::discs(vec![radius]), &far, |set, map| {
            let mut own = active_set(set);
            own.discs = vec![Disc::Free];
            for (expected, crossing) in [(Disc::Fixed, radius), (Disc::Free, 0.0), (Disc::Fixed, radius)] {
                own.classify(set, &on, map);
                assert_eq!((own.discs[0], own.crossing), (expected, crossing));
                assert!(!own.stays(set, &on, map));
            }
            let mut x = on;
            own.settle_discs(set, &mut x, map);
            assert!((x[0] + on[0]).abs() + (x[1] + on[1]).abs() < 1e-14, "{x:?}");
        });
        // pushed out with 3 N: curvature 3 / 2, scale 2
        let pushed = state(radius, on, [-1.8, -2.4]);
        let Disc::Sliding {
            tau,
            kappa,
            damp,
            own,
            slip,
        } = pushed
        else {
            panic!("{pushed:?}");
        };
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-14, "{pushed:?}");
        near(tau[0], -0.8);
        near(tau[1], 0.6);
        near(slip, 3.0);
        near(kappa, 1.5);
        near(damp, 0.25);
        near(own, 1.5 * (2.0 * 0.25_f64).powi(2));
    }

    #[test]
    fn discs_are_settled_on_their_circles() {
        let sliding = slides([1.0, 0.0], 1.0, 2.0, 1.0);
        for (state, x, g, radius, expected) in [
            // sliding points are drawn along the radius
            (sliding, [3.0, 4.0], [9.0, 9.0], 2.0, [1.2, 1.6]),
            (sliding, [0.3, 0.4], [9.0, 9.0], 2.0, [1.2, 1.6]),
            (sliding, [0.0, 0.0], [9.0, 9.0], 2.0, [0.0, 0.0]),
            // others where the map goes, if that is outside
            (Disc::Free, [0.0, 0.0], [-6.0, -8.0], 2.0, [1.2, 1.6]),
            (Disc::Free, [0.3, 0.4], [0.1, 0.1], 2.0, [0.3, 0.4]),
            (Disc::Free, [3.0, 4.0], [2.4, 3.2], 2.0, [1.2, 1.6]),
            (Disc::Fixed, [3.0, 4.0], [1.0, 1.0], 0.0, [0.0, 0.0]),
        ] {
            with(Segment::discs(vec![radius]), &g, |set, map| {
                let mut own = active_set(set);
                own.discs = vec![state];
                let mut v = x;
                own.settle_discs(set, &mut v, map);
                let off = (v[0] - expected[0]).hypot(v[1] - expected[1]);
                assert!(off < 1e-14, "{state:?} {x:?}: {v:?}");
            });
        }
    }
}
