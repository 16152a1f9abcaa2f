//! A projector that rounds the projections of steps: the equality holds at the end all the same.

use crate::common::{self, Random, Solved, from_zero};
use signorini_qp::active_set::ActiveSetReport;
use signorini_qp::{
    ActiveSetSettings, DenseProjector, EqualityProjector, MovingSet, ProductSet, QpError, Segment, vector,
};

/// Projections of steps are off by a share of their lengths.
struct Rounding {
    inner: DenseProjector,
    off: f64,
    random: Random,
}

impl Rounding {
    fn disturb(&mut self, x: &mut [f64]) {
        let size = self.off * vector::norm(x) / (x.len() as f64).sqrt();
        x.iter_mut().for_each(|v| *v += size * self.random.real());
    }
}

impl EqualityProjector for Rounding {
    fn dim(&self) -> usize {
        self.inner.dim()
    }
    fn rows(&self) -> usize {
        self.inner.rows()
    }
    fn set_weights(&mut self, w: &[f64]) -> Result<bool, QpError> {
        self.inner.set_weights(w)
    }
    fn project(&mut self, x: &mut [f64]) {
        self.inner.project(x);
    }
    fn project_transpose(&mut self, g: &mut [f64]) {
        self.inner.project_transpose(g);
    }
    fn repair(&mut self, x: &mut [f64], e: &[f64]) {
        self.inner.repair(x, e);
    }
    fn rounds_steps(&self) -> bool {
        self.off > 0.0
    }
    fn project_step(&mut self, x: &mut [f64]) {
        self.inner.project(x);
        // active components stay where they are
        let free: Vec<bool> = x.iter().map(|v| *v != 0.0).collect();
        self.disturb(x);
        x.iter_mut()
            .zip(free)
            .for_each(|(x, free)| *x *= f64::from(u8::from(free)));
    }
}

/// Few bounds or none: where no active set changes, nothing else restores the equality.
fn solve(seed: u64, bounds: usize, off: f64) -> (ActiveSetReport, f64, f64) {
    let mut random = Random::new(seed);
    let (free, rows) = (30, 3);
    let n = bounds + free;
    let (a, _) = common::spd(n, 2.0, &mut random);
    let b = random.vector(n);
    let mut g = random.vector(rows * n);
    (0..rows).for_each(|i| g[i * n + n - 1 - i] += 3.0);
    let e = random.vector(rows);
    let mut set = ProductSet::new(vec![Segment::upper(vec![0.0; bounds]), Segment::Free(free)]).expect("set");
    let mut projector = Rounding {
        inner: DenseProjector::new(rows, n, g.clone()).expect("projector"),
        off,
        random: Random::new(seed + 1),
    };
    let settings = ActiveSetSettings::default().with_tolerance(1e-10);
    let (data, start) = ((&b[..], &e[..]), (false, &[][..]));
    let solved = from_zero(&a, &mut projector, MovingSet::fixed(&mut set), data, &settings, start);
    let Solved { x, ax, report, .. } = solved.expect("a report");
    let row = |i: usize| (0..n).map(|j| g[i * n + j] * x[j]).sum::<f64>() - e[i];
    let off = (0..rows).map(|i| row(i).powi(2)).sum::<f64>().sqrt();
    let exact = common::product(&a, &x);
    let product = vector::distance(&exact, &ax);
    (report, off / vector::norm(&x), product / vector::norm(&exact))
}

#[test]
fn the_equality_holds_after_steps_that_round() {
    for (seed, bounds) in (0..20).map(|seed| (seed, 4 * (seed as usize % 2))) {
        let (exact, ..) = solve(seed, bounds, 0.0);
        let (report, off, product) = solve(seed, bounds, 1e-6);
        assert!(report.status.converged(), "seed {seed}: {report:?}");
        assert!(off < 1e-10, "seed {seed}: {off:e}");
        assert!(product < 1e-12, "seed {seed}: the product is {product:e} off");
        let (few, many) = (exact.products(), report.products());
        // an exact run goes on with its directions to the end; 76 to 120 where each decade began anew
        assert!(few <= 80 && many <= 95, "seed {seed}: {many}, exactly {few} products");
    }
}
