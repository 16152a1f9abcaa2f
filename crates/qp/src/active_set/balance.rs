//! The point of the set next to a given one that balances.
//!
//! Where constraints alone stop a mode, a point that is projected on the set leaves `G x = e`, and one that is put
//! back to `G x = e` leaves the set. The closest point that satisfies both has few unknowns, one amplitude for each
//! mode that no unconstrained component stops. With the rows `c` of these modes it is
//!
//! ```text
//! x(b) = P(y - a c b),     cᵀ x(b) = f
//! ```
//!
//! `P` projects on the set, `a >= 0` are lengths of steps; bounded components of length zero stay. Springs are
//! components without bounds. `f - cᵀ x(b)` is the gradient of a convex function of `b`, whose minimum Newton's method
//! with a line search finds without operator products.
//!
//! A contact touches few of many bodies: rows of modes are lists of what is not zero, and so is what modes make of a
//! constrained block.
//!
//! | local | meaning |
//! |---|---|
//! | `b` | amplitudes |
//! | `c`, `f` | rows of the modes on constrained components, and their right sides |
//! | `s` | `y - a c b` |

use crate::problem::{Constrained, LooseMode, ProductSet, for_constrained, for_discs, solve_cholesky};
use crate::tolerances::{BALANCED, HALVINGS, NEWTON_DECREASE, NEWTON_STEPS, NO_IMBALANCE, ROUNDED_WORK, SHIFT};
use std::collections::BTreeMap;

/// The search for the amplitudes.
pub(crate) struct Search<'a> {
    modes: &'a [LooseMode],
    set: &'a ProductSet,
    /// `y` on constrained components.
    y: &'a [f64],
    /// `a`, one value for both components of a disc.
    a: Vec<f64>,
    f: Vec<f64>,
    /// `cᵀ a c` of the springs, by rows; empty without.
    springs: Vec<f64>,
    b: Vec<f64>,
    /// `P(s)`.
    x: Vec<f64>,
    value: f64,
    gradient: Vec<f64>,
    /// Largest imbalance, over the absolute values of its terms.
    imbalance: f64,
    /// For each block, at its first component, the modes that move it and how.
    moved: Vec<Vec<(usize, [f64; 2])>>,
    /// Lower triangle of the second derivatives, by rows.
    second: Vec<f64>,
    /// For each row of it, the first column that may not be zero: that of its factor is the same.
    first: Vec<usize>,
}

impl<'a> Search<'a> {
    /// `x` has the values of springs, which stay unless these `give`.
    pub(crate) fn new(
        modes: &'a [LooseMode],
        set: &'a ProductSet,
        (e, x): (&[f64], &[f64]),
        (y, a): (&'a [f64], &[f64]),
        give: bool,
    ) -> Self {
        // what no component holds cannot be balanced, and need not: projectors refuse a right side that works on it;
        // nor can rounding be that pulls
        let side = |m: &LooseMode| {
            let terms = || m.amplitudes.iter().zip(e).filter(|(a, _)| **a != 0.0);
            let squares = terms().fold([0.0, 0.0], |[aa, ee], (a, e)| [aa + a * a, ee + e * e]);
            let (work, size) = (
                terms().map(|(a, e)| a * e).sum::<f64>(),
                (squares[0] * squares[1]).sqrt(),
            );
            let springs: f64 = m.springs.iter().map(|&(i, c, _)| c * x[i]).sum();
            let harmless = m.row.is_empty() && m.springs.is_empty() || work.abs() <= ROUNDED_WORK * size;
            let work = if harmless { 0.0 } else { work };
            work - springs
        };
        let count = if give { modes.len() } else { 0 };
        let mut springs = vec![0.0; count * count];
        let mut by_spring: BTreeMap<usize, Vec<(usize, f64, f64)>> = BTreeMap::new();
        for (r, mode) in modes.iter().enumerate().take(count) {
            for &(i, c, a) in &mode.springs {
                by_spring.entry(i).or_default().push((r, c, a));
            }
        }
        for own in by_spring.values() {
            for &(r, c, a) in own {
                own.iter()
                    .for_each(|&(s, other, _)| springs[r * count + s] += a * c * other);
            }
        }
        let mut a = a.to_vec();
        let mut start: Vec<usize> = (0..a.len()).collect();
        for_discs(set, |i, _, _| {
            a[i + 1] = a[i];
            start[i + 1] = i;
        });
        let mut moved: Vec<Vec<(usize, [f64; 2])>> = vec![Vec::new(); a.len()];
        let mut first: Vec<usize> = (0..modes.len()).collect();
        for (r, mode) in modes.iter().enumerate() {
            for &(i, c) in &mode.row {
                let block = &mut moved[start[i]];
                if block.last().is_none_or(|last| last.0 < r) {
                    block.push((r, [0.0; 2]));
                    first[r] = first[r].min(block[0].0);
                }
                if let Some(last) = block.last_mut() {
                    last.1[i - start[i]] = c;
                }
            }
        }
        for (r, first) in first.iter_mut().enumerate().take(count) {
            let row = springs[r * count..].iter().take(*first);
            *first = row.take_while(|k| **k == 0.0).count();
        }
        Self {
            springs,
            modes,
            set,
            y,
            a,
            f: modes.iter().map(side).collect(),
            b: vec![0.0; modes.len()],
            x: y.to_vec(),
            value: 0.0,
            gradient: vec![0.0; modes.len()],
            imbalance: f64::INFINITY,
            moved,
            second: vec![0.0; modes.len() * modes.len()],
            first,
        }
    }

    /// The point, whether it balances (if not, the set holds no point that does), and the amplitudes.
    pub(crate) fn run(mut self) -> (Vec<f64>, bool, Vec<f64>) {
        self.evaluate();
        for _ in 0..NEWTON_STEPS {
            if self.imbalance <= NO_IMBALANCE {
                break;
            }
            self.differentiate(false);
            if self.is_loose() {
                // nothing gives way along some mode: towards where all would
                self.differentiate(true);
            }
            let Some(step) = self.newton_step() else {
                break;
            };
            if !self.advance(&step) {
                break;
            }
        }
        (self.x, self.imbalance <= BALANCED, self.b)
    }

    /// Point, value, gradient and imbalance at `b`.
    fn evaluate(&mut self) {
        let Self {
            modes,
            set,
            y,
            a,
            f,
            springs,
            b,
            x,
            ..
        } = self;
        // of no springs, nothing
        let taken = |r: usize| -> f64 {
            let row = springs.chunks_exact(b.len().max(1)).nth(r).into_iter().flatten();
            row.zip(&*b).map(|(k, b)| k * b).sum()
        };
        x.copy_from_slice(y);
        for (mode, b) in modes.iter().zip(&*b) {
            mode.row.iter().for_each(|&(i, c)| x[i] -= a[i] * c * b);
        }
        let mut value: f64 = (b.iter().zip(&*f).enumerate())
            .map(|(r, (b, f))| b * (f + 0.5 * taken(r)))
            .sum();
        for_constrained(set, |block| match block {
            Constrained::Bound { i, lower, upper, .. } => {
                let s = x[i];
                x[i] = s.max(lower).min(upper);
                if a[i] > 0.0 {
                    value += x[i] * (2.0 * s - x[i]) / (2.0 * a[i]);
                }
            }
            Constrained::Disc { i, radius, .. } => {
                let length = x[i].hypot(x[i + 1]);
                let kept = length.min(radius);
                let share = if length > radius { radius / length } else { 1.0 };
                x[i] *= share;
                x[i + 1] *= share;
                value += kept * (2.0 * length - kept) / (2.0 * a[i]);
            }
        });
        self.value = value;
        self.imbalance = 0.0;
        for (r, ((mode, f), g)) in modes.iter().zip(&*f).zip(&mut self.gradient).enumerate() {
            let held = taken(r);
            let (mut sum, mut size) = (*f + held, f.abs() + held.abs());
            for &(i, c) in &mode.row {
                sum -= c * x[i];
                size += (c * x[i]).abs();
            }
            *g = sum;
            let share = if size == 0.0 { 0.0 } else { sum.abs() / size };
            // `max` drops what is not a number
            if share > self.imbalance || share.is_nan() {
                self.imbalance = share;
            }
        }
    }

    /// Second derivatives at the point of the last evaluation: `cᵀ P' a c`.
    fn differentiate(&mut self, all: bool) {
        let Self {
            modes,
            set,
            y,
            a,
            b,
            moved,
            springs,
            second,
            ..
        } = self;
        let k = modes.len();
        second.fill(0.0);
        second.iter_mut().zip(&*springs).for_each(|(all, own)| *all = *own);
        let mut add = |weight: f64, c: &[(usize, f64)]| {
            for (n, (r, cr)) in c.iter().enumerate() {
                let row = &mut second[r * k..(r + 1) * k];
                c[..=n].iter().for_each(|(s, cs)| row[*s] += weight * cr * cs);
            }
        };
        let s = |i: usize, part: usize| {
            let moves: f64 = moved[i].iter().map(|(m, c)| c[part] * b[*m]).sum();
            y[i + part] - a[i] * moves
        };
        let (mut along, mut across) = (Vec::new(), Vec::new());
        for_constrained(set, |block| match block {
            Constrained::Bound { i, lower, upper, .. } => {
                let s = s(i, 0);
                if all || s > lower && s < upper {
                    along.clear();
                    along.extend(moved[i].iter().map(|(m, c)| (*m, c[0])));
                    add(a[i], &along);
                }
            }
            Constrained::Disc { i, radius, .. } => {
                let s = [s(i, 0), s(i, 1)];
                let length = s[0].hypot(s[1]);
                let n = if length > 0.0 { [s[0] / length, s[1] / length] } else { [1.0, 0.0] };
                along.clear();
                across.clear();
                for (m, c) in &moved[i] {
                    along.push((*m, c[0] * n[0] + c[1] * n[1]));
                    across.push((*m, c[1] * n[0] - c[0] * n[1]));
                }
                if length > radius {
                    add(a[i] * radius / length, &across);
                } else if radius > 0.0 {
                    add(a[i], &across);
                    add(a[i], &along);
                }
            }
        });
    }

    /// Whether the point is off its constraints along some mode that they can hold at all.
    fn is_loose(&self) -> bool {
        let k = self.modes.len();
        self.modes.iter().enumerate().any(|(r, mode)| {
            let all: f64 = mode.row.iter().map(|&(i, c)| self.a[i] * c * c).sum();
            all > 0.0 && self.second[r * (k + 1)] <= SHIFT * all
        })
    }

    /// Minus the shifted second derivatives' inverse times the gradient, by Cholesky; `None` if nothing holds any mode.
    fn newton_step(&mut self) -> Option<Vec<f64>> {
        let k = self.modes.len();
        let largest = (0..k).map(|r| self.second[r * k + r]).fold(0.0, f64::max);
        if !(largest > 0.0 && largest.is_finite()) {
            return None;
        }
        let (l, first) = (&mut self.second, &self.first);
        for r in 0..k {
            l[r * k + r] += SHIFT * largest;
            for s in first[r]..=r {
                let both = first[r].max(first[s])..s;
                let known: f64 = both.map(|j| l[r * k + j] * l[s * k + j]).sum();
                let value = l[r * k + s] - known;
                l[r * k + s] = if r == s { value.max(SHIFT * largest).sqrt() } else { value / l[s * k + s] };
            }
        }
        let mut step: Vec<f64> = self.gradient.iter().map(|g| -g).collect();
        solve_cholesky(k, l, &mut step);
        step.iter().all(|s| s.is_finite()).then_some(step)
    }

    /// The longest of the halved steps that descends, or halves the imbalance; false if none does.
    fn advance(&mut self, step: &[f64]) -> bool {
        let slope: f64 = self.gradient.iter().zip(step).map(|(g, s)| g * s).sum();
        let (start, value, imbalance) = (self.b.clone(), self.value, self.imbalance);
        let mut t = 1.0;
        for _ in 0..HALVINGS {
            let both = start.iter().zip(step);
            self.b = both.map(|(b, s)| b + t * s).collect();
            self.evaluate();
            let descends = self.value <= value + NEWTON_DECREASE * t * slope;
            if self.imbalance.is_finite() && (descends || self.imbalance <= 0.5 * imbalance) {
                return true;
            }
            t *= 0.5;
        }
        self.b = start;
        self.evaluate();
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::{ConvexSet, Segment};

    /// Bounds and discs with modes that are sums of components, as translations are.
    fn set() -> ProductSet {
        ProductSet::new(vec![Segment::upper(vec![0.0; 4]), Segment::discs(vec![1.0, 2.0, 0.5])]).expect("a set")
    }

    fn modes() -> Vec<LooseMode> {
        let sums = [
            [1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0],
            [1.0, -1.0, 0.5, -0.5, 0.3, -0.2, 0.1, 0.6, -0.4, 0.2],
        ];
        let unit = |k: usize| (0..4).map(|j| f64::from(u8::from(j == k))).collect();
        let mode = |(k, row): (usize, [f64; 10])| LooseMode::new(unit(k), &row);
        sums.into_iter().enumerate().map(mode).collect()
    }

    fn project(y: &[f64; 10], e: &[f64; 4]) -> (Vec<f64>, bool) {
        // of the lengths of a disc the first one counts
        let a: Vec<f64> = (0..10)
            .map(|k| 0.5 + 0.1 * f64::from(k / 2) + f64::from(k % 2) * f64::from(u8::from(k > 3)))
            .collect();
        let (x, balances, _) = Search::new(&modes(), &set(), (e, &[]), (y, &a), false).run();
        (x, balances)
    }

    #[test]
    fn finds_the_closest_point_that_balances() {
        let y = [-1.0, 0.5, -2.0, 0.3, 3.0, 0.5, -0.2, 0.1, 0.6, 0.6];
        let e = [-4.0, 2.5, 0.6, 0.2];
        let (x, balances) = project(&y, &e);
        assert!(balances && set().violation(&x) <= 1e-15);
        for (mode, e) in modes().iter().zip(e) {
            let sum: f64 = mode.row.iter().map(|&(i, c)| c * x[i]).sum();
            assert!((sum - e).abs() < 1e-12);
        }
        // no other feasible point that balances is closer: it is where alternating projections in this metric end
        let distance = |p: &[f64]| -> f64 {
            let term = |k: usize| (p[k] - y[k]).powi(2) / (0.5 + 0.1 * (k / 2) as f64);
            (0..10).map(term).sum()
        };
        let best = distance(&x);
        for k in 0..200_u32 {
            let other: [f64; 10] = std::array::from_fn(|j| {
                let angle = f64::from(k) * 0.37 + j as f64 * 1.3;
                y[j] + 0.8 * (angle.sin() + (1.7 * angle).cos())
            });
            let (other, balances) = project(&other, &e);
            assert!(balances && distance(&other) >= best * (1.0 - 1e-12));
        }
    }

    /// Springs with gaps: nothing gives way before the first is closed.
    #[test]
    fn bounds_that_nothing_touches_yet_are_reached() {
        let set = ProductSet::new(vec![Segment::upper(vec![0.0; 3]), Segment::discs(vec![1.0])]).expect("a set");
        let modes = [LooseMode::new(vec![1.0], &[1.0, 1.0, 1.0, 0.0, 0.0])];
        // gaps 1, 2 and 4: two springs carry 1 at a depth of 2
        let search = |e: f64| {
            Search::new(
                &modes,
                &set,
                (&[e], &[]),
                (&[1.0, 2.0, 4.0, 0.0, 0.0], &[1.0; 5]),
                false,
            )
            .run()
        };
        let (x, balances, _) = search(-1.0);
        let off = x
            .iter()
            .zip([-1.0, 0.0, 0.0, 0.0, 0.0])
            .map(|(x, y): (&f64, f64)| (x - y).abs());
        assert!(balances && off.fold(0.0, f64::max) < 1e-12, "{x:?}");
        let (x, balances, _) = search(-4.0);
        let off = x
            .iter()
            .zip([-2.5, -1.5, 0.0, 0.0, 0.0])
            .map(|(x, y): (&f64, f64)| (x - y).abs());
        assert!(balances && off.fold(0.0, f64::max) < 1e-12, "{x:?}");
    }

    /// What friction does not hold goes to a spring, behind what the spring has already.
    #[test]
    fn springs_take_what_the_set_does_not() {
        let set = ProductSet::new(vec![Segment::discs(vec![1.0])]).expect("a set");
        let mut mode = LooseMode::new(vec![1.0], &[1.0, 0.0, 0.0]);
        mode.springs = vec![(2, 0.5, 1e-3)];
        let (modes, e) = ([mode], [3.0]);
        let search = |give| Search::new(&modes, &set, (&e, &[0.0, 0.0, 0.4]), (&[0.0; 2], &[1.0; 2]), give).run();
        assert!(!search(false).1);
        let (x, balances, b) = search(true);
        let spring = 0.4 - 1e-3 * 0.5 * b[0];
        assert!(
            balances && (x[0] - 1.0).abs() < 1e-12 && (0.5 * spring - 2.0).abs() < 1e-9,
            "{x:?} {b:?}"
        );
    }

    #[test]
    fn says_when_the_set_holds_no_balance() {
        let far = [-4.0, 9.0, 0.0, 0.0];
        let (x, balances) = project(&[0.0; 10], &far);
        assert!(!balances && set().violation(&x) <= 1e-15);
        assert!(x.iter().all(|x| x.is_finite()));
    }

    /// A mode that nothing holds, as a plate without friction has in its plane, leaves Newton's method its steps.
    #[test]
    fn a_mode_without_rows_slows_nothing_down() {
        let mut all = modes();
        all.push(LooseMode::new(vec![0.0; 4], &[]));
        let (y, e) = (
            [-1.0, 0.5, -2.0, 0.3, 3.0, 0.5, -0.2, 0.1, 0.6, 0.6],
            [-4.0, 2.5, 0.6, 0.2],
        );
        let a = [0.5, 0.6, 0.7, 0.8, 0.9, 0.9, 1.0, 1.0, 1.1, 1.1];
        let (set, modes) = (set(), modes());
        let (alone, balances, _) = Search::new(&modes, &set, (&e, &[]), (&y, &a), false).run();
        let found = Search::new(&all, &set, (&e, &[]), (&y, &a), false).run();
        assert_eq!((found.0, found.1), (alone, balances));
        assert!(balances);
    }

    #[test]
    fn held_components_stay_and_modes_that_nothing_holds_do_no_harm() {
        let set = ProductSet::new(vec![Segment::upper(vec![0.0; 2])]).expect("a set");
        let modes = [
            LooseMode::new(vec![1.0, 0.0], &[1.0, 1.0]),
            LooseMode::new(vec![0.0, 1.0], &[0.0, 0.0]),
        ];
        // the second right side is what loads leave by rounding
        let search = Search::new(&modes, &set, (&[-3.0, 1e-13], &[]), (&[0.0, -1.0], &[0.0, 1.0]), false);
        let (x, balances, _) = search.run();
        assert_eq!((x, balances), (vec![0.0, -3.0], true));
    }
}
