//! SMALSE on random problems with equalities, by the independent optimality check.

use crate::common::{self, Quadratic, Random};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use signorini_qp::kkt::check_with;
use signorini_qp::{
    ConvexSet, DenseEquality, DenseOperator, Equality, KprgpSettings, ProductSet, QuadraticCost, Segment,
    SmalseSettings, Status, vector,
};

fn config() -> ProptestConfig {
    ProptestConfig {
        cases: 120,
        rng_seed: RngSeed::Fixed(9),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

fn problem(seed: u64) -> Quadratic {
    let mut r = Random::new(seed);
    let set = common::set(&mut r);
    let n = set.dim();
    let (a, _) = common::spd(n, 2.0, &mut r);
    let rows = if n == 0 { 0 } else { r.below(1 + n / 3) };
    let equality = common::equality(n, rows, &set, &mut r);
    Quadratic::new(a, r.vector(n), equality, set)
}

fn tight() -> SmalseSettings {
    SmalseSettings::default()
        .with_tolerance(1e-8)
        .with_equality(1e-8)
        .with_max_outer(5_000)
        .with_inner(KprgpSettings::default().with_max_products(200_000))
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn finds_the_minimiser(seed in any::<u64>()) {
        let mut p = problem(seed);
        let n = p.set.dim();
        let (mut x, mut beta) = (vec![0.0; n], vec![0.0; p.c.rows()]);
        let (report, residual, mu) = p.smalse(&tight(), &mut |_, _| false, &mut x, &mut beta);
        prop_assert!(report.status.converged(), "{report:?} {:?}", p.set);
        let cost = QuadraticCost::new(&p.a, &p.b, p.norm).with_equality(&p.c, &p.e);
        let check = check_with(&cost, &p.set, &x, &mu).expect("lengths");
        let size = check.b_norm.max(p.norm * check.x_norm);
        prop_assert!(check.infeasibility <= 1e-15 * check.x_norm, "{check:?}");
        prop_assert!(check.equality <= 1.1e-8 * check.x_norm.max(vector::norm(&p.e)), "{check:?}");
        prop_assert!(check.stationarity <= 1e-7 * size, "{check:?} {report:?}");
        // the residual kept by recurrence is A y - b at y = x - C'(C x - e)
        let mut y = x.clone();
        let mut cx = vec![0.0; p.c.rows()];
        p.c.apply(&x, &mut cx, &mut ());
        vector::subtract(&p.e, &mut cx);
        let mut back = vec![0.0; n];
        p.c.apply_transpose(&cx, &mut back, &mut ());
        vector::subtract(&back, &mut y);
        let mut fresh = common::product(&p.a, &y);
        vector::subtract(&p.b, &mut fresh);
        let off = vector::distance(&fresh, &residual);
        prop_assert!(off <= 1e-9 * size.max(1e-300), "{off}");
    }

    #[test]
    fn a_warm_start_from_the_solution_needs_two_products(seed in any::<u64>()) {
        let mut p = problem(seed);
        let (mut x, mut beta) = (vec![0.0; p.set.dim()], vec![0.0; p.c.rows()]);
        let (first, ..) = p.smalse(&tight(), &mut |_, _| false, &mut x, &mut beta);
        prop_assert!(first.status.converged());
        let loose = tight().with_tolerance(2e-8).with_equality(2e-8);
        let (again, ..) = p.smalse(&loose, &mut |_, _| false, &mut x, &mut beta);
        prop_assert!(again.status.converged());
        prop_assert!(again.products.total() <= 2 && again.outer == 1, "{again:?}");
    }
}

/// The set does not know the equality: without rows SMALSE is KPRGP.
#[test]
fn no_rows_no_outer_loop() {
    let mut r = Random::new(1);
    let (a, _) = common::spd(8, 2.0, &mut r);
    let c = DenseEquality::orthonormal(0, 8, &[]).expect("empty");
    let set = ProductSet::new(vec![Segment::lower(vec![0.0; 8])]).expect("set");
    let mut p = Quadratic::new(a, r.vector(8), (c, vec![]), set);
    let (report, ..) = p.smalse(&SmalseSettings::default(), &mut |_, _| false, &mut [0.0; 8], &mut []);
    assert!(report.status.converged() && report.outer == 1);
}

/// Without inequalities the answer is that of the saddle point system.
#[test]
fn equalities_alone() {
    let mut r = Random::new(2);
    let n = 10;
    let (a, _) = common::spd(n, 1.0, &mut r);
    let set = ProductSet::free(n);
    let equality = common::equality(n, 3, &set, &mut r);
    let mut p = Quadratic::new(a, r.vector(n), equality, set);
    let (mut x, mut beta) = (vec![0.0; n], vec![0.0; 3]);
    let (report, _, mu) = p.smalse(&tight(), &mut |_, _| false, &mut x, &mut beta);
    assert!(report.status.converged());
    // A x - b + C' mu = 0
    let mut g = common::product(&p.a, &x);
    vector::subtract(&p.b, &mut g);
    let mut t = vec![0.0; n];
    p.c.apply_transpose(&mu, &mut t, &mut ());
    vector::axpy(1.0, &t, &mut g);
    assert!(vector::norm(&g) < 1e-7);
}

/// Radii that follow another unknown at every outer step reach the fixed point of the outer map.
#[test]
fn the_hook_may_change_radii() {
    let mut r = Random::new(6);
    let (n, m) = (18, 4);
    let (a, _) = common::spd(n, 1.0, &mut r);
    let start = || {
        ProductSet::new(vec![
            Segment::upper(vec![0.0; m]),
            Segment::discs(vec![0.0; m]),
            Segment::Free(n - 3 * m),
        ])
        .expect("set")
    };
    let (c, _) = common::equality(n, 2, &start(), &mut r);
    let mut p = Quadratic::new(a, r.vector(n), (c, vec![0.1, -0.2]), start());
    let friction = 0.3;
    let mut changes = 0;
    let mut hook = |x: &[f64], set: &mut ProductSet| {
        let radii = set.radii_mut(1).expect("discs");
        let mut change: f64 = 0.0;
        for i in 0..m {
            let new = -friction * x[i];
            change = change.max((new - radii[i]).abs());
            radii[i] = new;
        }
        if change > 1e-9 {
            changes += 1;
        }
        change > 1e-9
    };
    let (mut x, mut beta) = (vec![0.0; n], vec![0.0; 2]);
    let (report, ..) = p.smalse(&tight(), &mut hook, &mut x, &mut beta);
    assert!(report.status.converged() && changes > 1, "{report:?}");
    // the same by successive approximations with complete solves
    p.set = start();
    let mut y = vec![0.0; n];
    let mut gamma = vec![0.0; 2];
    for _ in 0..60 {
        for i in 0..m {
            p.set.radii_mut(1).expect("discs")[i] = -friction * y[i];
        }
        let _ = p.smalse(&tight(), &mut |_, _| false, &mut y, &mut gamma);
    }
    assert!(vector::distance(&x, &y) <= 1e-6, "{}", vector::distance(&x, &y));
}

#[test]
fn outer_steps_cost_no_product() {
    let mut p = problem(77);
    let (mut x, mut beta) = (vec![0.0; p.set.dim()], vec![0.0; p.c.rows()]);
    let (report, ..) = p.smalse(&tight(), &mut |_, _| false, &mut x, &mut beta);
    assert!(report.outer > 2, "{report:?}");
    let q = report.products;
    assert_eq!(q.initial, 1);
    assert!(q.restart <= 1 && q.reference <= 1, "{report:?}");
    assert_eq!(q.cg, report.steps.cg + report.steps.expansion);
}

#[test]
fn infeasible_equalities_do_not_converge_and_do_not_hang() {
    let a = DenseOperator::new(1, vec![1.0]).expect("symmetric");
    let c = DenseEquality::orthonormal(1, 1, &[1.0]).expect("row");
    let set = ProductSet::new(vec![Segment::lower(vec![0.0])]).expect("set");
    let mut p = Quadratic {
        norm: 1.0,
        ..Quadratic::new(a, vec![1.0], (c, vec![-1.0]), set)
    };
    let settings = SmalseSettings::default().with_max_outer(50);
    let (report, ..) = p.smalse(&settings, &mut |_, _| false, &mut [0.0], &mut [0.0]);
    assert_eq!(report.status, Status::IterationLimit);
}

/// Products a well-conditioned dual problem with sliding discs needs, within a band.
#[test]
fn products_stay_within_a_band() {
    let (n, rows, m) = (240, 30, 30);
    let mut r = Random::new(1);
    let (a, _) = common::spd(n, 1.7, &mut r);
    let c = DenseEquality::orthonormal(rows, n, &r.vector(rows * n)).expect("independent");
    let mut inside = r.vector(n);
    for i in 0..m {
        inside[i] = -inside[i].abs() - 0.2;
    }
    for v in &mut inside[m..3 * m] {
        *v *= 0.1;
    }
    let mut e = vec![0.0; rows];
    c.apply(&inside, &mut e, &mut ());
    let radii = (0..m)
        .map(|i| 0.3 * inside[i].abs() * if i % 5 == 0 { 0.01 } else { 1.0 })
        .collect();
    let b: Vec<f64> = r.vector(n).iter().map(|v| 0.5 * v).collect();
    let set = ProductSet::new(vec![
        Segment::upper(vec![0.0; m]),
        Segment::discs(radii),
        Segment::Free(n - 3 * m),
    ])
    .expect("set");
    let mut p = Quadratic::new(a, b, (c, e), set);
    let (mut x, mut beta) = (vec![0.0; n], vec![0.0; rows]);
    let (report, ..) = p.smalse(&SmalseSettings::default(), &mut |_, _| false, &mut x, &mut beta);
    assert!(report.status.converged(), "{report:?}");
    let products = report.products.total();
    assert!((90..=135).contains(&products), "{products}");
}

/// Two products with `C` and two with its transpose for one with `A`.
#[test]
fn two_projections_a_product() {
    let mut p = problem(77);
    let (mut x, mut beta) = (vec![0.0; p.set.dim()], vec![0.0; p.c.rows()]);
    let (report, ..) = p.smalse(&tight(), &mut |_, _| false, &mut x, &mut beta);
    assert!(report.projections <= 2 * report.products.total());
}

/// What a hook leaves is looked at whatever it answers.
#[test]
fn a_hook_that_spoils_the_set_is_refused() {
    let p = || problem(4);
    for answer in [true, false] {
        let mut p = p();
        let n = p.set.dim();
        let larger = ProductSet::new(vec![Segment::Free(n + 1)]).expect("set");
        let mut hook = |_: &[f64], set: &mut ProductSet| {
            set.clone_from(&larger);
            answer
        };
        let (mut x, mut beta) = (vec![0.0; n], vec![0.0; p.c.rows()]);
        let cost = QuadraticCost::new(&p.a, &p.b, p.norm).with_equality(&p.c, &p.e);
        let mut work = signorini_qp::smalse::SmalseWorkspace::new(&p.a, &p.c);
        let set = signorini_qp::MovingSet::new(&mut p.set, &mut hook);
        let error = signorini_qp::smalse(&cost, set, &mut x, &mut beta, &tight(), &mut work);
        let text = error.expect_err("another length").to_string();
        assert!(text.contains("the set after the hook"), "{text}");
    }
}
