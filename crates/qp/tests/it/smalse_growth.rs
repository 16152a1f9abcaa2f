//! Step 4 of SMALSE: how often the precision shrinks, against the Lagrangian computed anew.

use crate::common::{self, Quadratic, Random};
use signorini_qp::smalse::SmalseReport;
use signorini_qp::{ConvexSet, Equality, KprgpSettings, ProductSet, SmalseSettings, vector};

impl Quadratic {
    fn residual(&self, x: &[f64]) -> Vec<f64> {
        let mut cx = vec![0.0; self.c.rows()];
        self.c.apply(x, &mut cx, &mut ());
        vector::subtract(&self.e, &mut cx);
        cx
    }

    /// `1/2 y·Ay - b·y + beta·(Cx - e) + rho/2 |Cx - e|²` at `y = x - Cᵀ(Cx - e)`, the unshifted Lagrangian up to a
    /// constant.
    fn lagrangian(&self, x: &[f64], beta: &[f64], rho: f64) -> f64 {
        let cx = self.residual(x);
        let mut y = vec![0.0; x.len()];
        self.c.apply_transpose(&cx, &mut y, &mut ());
        vector::xpby(x, -1.0, &mut y);
        let ay = common::product(&self.a, &y);
        0.5 * vector::dot(&y, &ay) - vector::dot(&self.b, &y)
            + vector::dot(beta, &cx)
            + 0.5 * rho * vector::dot(&cx, &cx)
    }

    /// The report, and the iterates at the end of Step 1.
    fn iterates(&mut self, precision: f64) -> (SmalseReport, Vec<Vec<f64>>) {
        let settings = SmalseSettings::default()
            .with_penalty(PENALTY)
            .with_precision(precision)
            .with_shrink(SHRINK)
            .with_tolerance(1e-6)
            .with_equality(1e-6)
            .with_max_outer(300)
            .with_inner(KprgpSettings::default().with_max_products(100_000));
        let (mut x, mut beta) = (vec![0.0; self.b.len()], vec![0.0; self.c.rows()]);
        let mut iterates = Vec::new();
        let mut hook = |x: &[f64], _: &mut ProductSet| {
            iterates.push(x.to_vec());
            false
        };
        let (report, ..) = self.smalse(&settings, &mut hook, &mut x, &mut beta);
        (report, iterates)
    }
}

const PENALTY: f64 = 0.3;
const SHRINK: f64 = 0.5;

/// Each Step 4 whose Lagrangian has grown by less than `rho/2 |Cx - e|²` shrinks the precision, and no other one.
#[test]
fn the_precision_shrinks_where_the_lagrangian_grows_too_little() {
    let (mut shrunk, mut kept) = (0, 0);
    for (seed, precision) in (0..40).flat_map(|seed| [4.0, 0.02].map(|p| (seed, p))) {
        let mut r = Random::new(seed);
        let set = common::set(&mut r);
        let n = set.dim();
        if n < 6 {
            continue;
        }
        let (a, norm) = common::spd(n, 2.0, &mut r);
        let (c, e) = common::equality(n, 1 + n / 4, &set, &mut r);
        let b = r.vector(n);
        let mut problem = Quadratic { a, b, c, e, set, norm };
        let (report, iterates) = problem.iterates(precision);
        let rho = PENALTY * norm;
        let mut beta = vec![0.0; problem.e.len()];
        let (mut before, mut count, mut near) = (None, 0, false);
        // nothing follows on the last step
        for x in &iterates[..iterates.len() - 1] {
            let value = problem.lagrangian(x, &beta, rho);
            let cx = problem.residual(x);
            let least = 0.5 * rho * vector::dot(&cx, &cx);
            if let Some(before) = before {
                let growth: f64 = value - before;
                count += usize::from(growth < least);
                // rounding must not decide
                near |= (growth - least).abs() <= 1e-9 * value.abs().max(1.0);
            }
            before = Some(value);
            vector::axpy(rho, &cx, &mut beta);
        }
        if near {
            continue;
        }
        let expected = precision * SHRINK.powi(count as i32);
        assert!(
            (report.precision - expected).abs() <= 1e-12 * expected,
            "seed {seed}: {count} steps, {report:?}"
        );
        shrunk += usize::from(count > 0);
        kept += usize::from(count == 0);
    }
    assert!(shrunk >= 5 && kept >= 5, "{shrunk} shrunk, {kept} kept");
}
