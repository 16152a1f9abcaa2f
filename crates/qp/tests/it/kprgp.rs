//! KPRGP on random problems, by the independent optimality check.

use crate::common::{self, Random, pair, run};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use signorini_qp::kprgp::{Expansion, KprgpWorkspace};
use signorini_qp::{
    ConvexSet, DenseOperator, KprgpSettings, ProductSet, QpError, QuadraticCost, Segment, Status, kkt, kprgp, vector,
};

const EXPANSIONS: [Expansion; 2] = [Expansion::FixedStep, Expansion::ProjectedCg];

fn config() -> ProptestConfig {
    ProptestConfig {
        cases: 150,
        rng_seed: RngSeed::Fixed(5),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn finds_the_minimiser(seed in any::<u64>(), expansion in 0_usize..2, scale in -8_i32..8) {
        let mut r = Random::new(seed);
        let set = common::set(&mut r);
        let n = set.dim();
        let (a, norm) = common::spd(n, 3.0, &mut r);
        let b: Vec<f64> = r.vector(n);
        let mut x: Vec<f64> = r.vector(n).iter().map(|v| 3.0 * v).collect();
        // another unit for the gradient
        let s = 10f64.powi(scale);
        let a = DenseOperator::new(n, a.entries().iter().map(|v| s * v).collect()).expect("symmetric");
        let b: Vec<f64> = b.iter().map(|v| s * v).collect();
        let settings = KprgpSettings::default()
            .with_expansion(EXPANSIONS[expansion])
            .with_max_products(60_000);
        let mut work = KprgpWorkspace::new(&a);
        let report = kprgp(&QuadraticCost::new(&a, &b, s * norm), &set, 1e-9, &settings, &mut x, &mut work)
            .expect("solve");
        prop_assert!(report.status.converged(), "{report:?} {set:?}");
        let check = kkt::check(&QuadraticCost::new(&a, &b, s * norm), &set, &x).expect("lengths");
        prop_assert!(check.infeasibility <= 1e-15 * check.x_norm, "{check:?}");
        prop_assert!(check.stationarity <= 1.01e-9 * check.b_norm, "{check:?}");
        prop_assert!(check.dual <= 1e-6 * check.b_norm, "{check:?}");
        let fresh = { let mut y = common::product(&a, &x); vector::subtract(&b, &mut y); y };
        prop_assert!(vector::distance(&fresh, work.gradient()) <= 1e-10 * check.b_norm);
    }

    #[test]
    fn everything_active_at_the_start(seed in any::<u64>()) {
        let mut r = Random::new(seed);
        let n = 12;
        let (a, norm) = common::spd(n, 2.0, &mut r);
        let set = ProductSet::new(vec![Segment::lower(vec![0.0; 6]), Segment::discs(vec![0.2; 3])]).expect("set");
        let b = r.vector(n);
        let mut x = vec![0.0; n];
        for i in 0..3 { x[6 + 2 * i] = 0.2; }
        let mut work = KprgpWorkspace::new(&a);
        let settings = KprgpSettings::default();
        let t = 1e-10;
        let report = kprgp(&QuadraticCost::new(&a, &b, norm), &set, t, &settings, &mut x, &mut work).expect("solve");
        prop_assert!(report.status.converged(), "{report:?}");
        prop_assert!(kkt::check(&QuadraticCost::new(&a, &b, norm), &set, &x).expect("lengths").relative() <= 1e-9);
    }
}

#[test]
fn empty_and_fixed_problems_need_one_product() {
    let a = DenseOperator::new(0, vec![]).expect("empty");
    let settings = KprgpSettings::default();
    assert_eq!(
        run(&a, &[], &ProductSet::free(0), &mut [], &settings),
        Ok(Status::Converged)
    );
    let fixed = ProductSet::new(vec![Segment::bounds(vec![1.0, 2.0], vec![1.0, 2.0])]).expect("set");
    let mut x = [0.0; 2];
    let a = pair();
    let mut work = KprgpWorkspace::new(&a);
    let t = 1e-10;
    let report = kprgp(
        &QuadraticCost::new(&a, &[1.0, 1.0], 3.0),
        &fixed,
        t,
        &settings,
        &mut x,
        &mut work,
    )
    .expect("solve");
    assert_eq!(
        (report.status, report.products.total(), x),
        (Status::Converged, 1, [1.0, 2.0])
    );
}

#[test]
fn a_zero_right_side_and_a_solved_start_need_one_product() {
    let a = pair();
    let mut work = KprgpWorkspace::new(&a);
    let settings = KprgpSettings::default();
    let t = 1e-10;
    let mut x = [0.0; 2];
    let report = kprgp(
        &QuadraticCost::new(&a, &[0.0; 2], 3.0),
        &ProductSet::free(2),
        t,
        &settings,
        &mut x,
        &mut work,
    )
    .expect("solve");
    assert_eq!((report.status, report.products.total()), (Status::Converged, 1));
}

#[test]
fn conjugate_gradients_without_constraints_end_after_n_steps() {
    let mut r = Random::new(3);
    let (a, norm) = common::spd(10, 1.0, &mut r);
    let b = r.vector(10);
    let mut x = vec![0.0; 10];
    let mut work = KprgpWorkspace::new(&a);
    let t = 1e-9;
    let report = kprgp(
        &QuadraticCost::new(&a, &b, norm),
        &ProductSet::free(10),
        t,
        &KprgpSettings::default(),
        &mut x,
        &mut work,
    )
    .expect("solve");
    assert!(report.status.converged() && report.steps.cg <= 11 && report.steps.expansion == 0);
}

#[test]
fn limits_and_rounding_are_statuses() {
    let mut r = Random::new(4);
    let (a, norm) = common::spd(30, 6.0, &mut r);
    let set = ProductSet::new(vec![Segment::lower(vec![-0.1; 30])]).expect("set");
    let b = r.vector(30);
    let mut work = KprgpWorkspace::new(&a);
    let few = KprgpSettings::default().with_max_products(7);
    let mut x = vec![0.0; 30];
    let t = 1e-9;
    let report = kprgp(&QuadraticCost::new(&a, &b, norm), &set, t, &few, &mut x, &mut work).expect("solve");
    assert_eq!(report.status, Status::IterationLimit);
    assert!(report.products.total() <= 9 && set.violation(&x) == 0.0);
    // a tolerance below rounding
    let mut x = vec![0.0; 30];
    let tight = 1e-30;
    let settings = KprgpSettings::default();
    let report = kprgp(
        &QuadraticCost::new(&a, &b, norm),
        &set,
        tight,
        &settings,
        &mut x,
        &mut work,
    )
    .expect("solve");
    assert_eq!(report.status, Status::Stagnated, "{report:?}");
    assert!(report.products.total() < 5_000, "{report:?}");
}

/// A direction so small that its curvature underflows, beside a disc so small that the gradient on it cannot be
/// lowered.
#[test]
fn curvature_that_underflows_is_no_descent_for_ever() {
    let a = DenseOperator::new(3, vec![1e-9, 0.0, 0.0, 0.0, 1e-9, 0.0, 0.0, 0.0, 1e-9]);
    let a = a.expect("symmetric");
    let set = ProductSet::new(vec![Segment::Free(1), Segment::discs(vec![1e-170])]).expect("set");
    let mut work = KprgpWorkspace::new(&a);
    let settings = KprgpSettings::default().with_max_products(500);
    let mut x = [1e-150, 1e-170, 0.0];
    let t = 1e-10;
    let b = [0.0, 0.0, 1.0];
    let report = kprgp(&QuadraticCost::new(&a, &b, 1e-9), &set, t, &settings, &mut x, &mut work).expect("solve");
    assert!(x.iter().all(|v| v.is_finite()) && set.violation(&x) == 0.0);
    assert!(!report.status.converged(), "{report:?}");
}

#[test]
fn breakdowns_are_errors() {
    let settings = KprgpSettings::default();
    let indefinite = DenseOperator::new(2, vec![1.0, 0.0, 0.0, -1.0]).expect("symmetric");
    let free = ProductSet::free(2);
    assert!(matches!(
        run(&indefinite, &[0.0, 1.0], &free, &mut [0.0; 2], &settings),
        Err(QpError::Indefinite { .. })
    ));
    let singular = DenseOperator::new(2, vec![1.0, 0.0, 0.0, 0.0]).expect("symmetric");
    assert!(matches!(
        run(&singular, &[0.0, 1.0], &free, &mut [0.0; 2], &settings),
        Err(QpError::Unbounded { .. })
    ));
    // a slope that is nothing but rounding of what was subtracted is no descent
    let residue = [1e20, 1e3];
    let mut x = [1e20, 0.0];
    let status = run(&singular, &residue, &free, &mut x, &settings);
    assert!(status.is_ok(), "{status:?}");
    // a bound in the way makes it solvable
    let set = ProductSet::new(vec![Segment::upper(vec![5.0, 4.0])]).expect("set");
    let mut x = [0.0; 2];
    assert_eq!(
        run(&singular, &[1.0, 1.0], &set, &mut x, &settings),
        Ok(Status::Converged)
    );
    assert!((x[0] - 1.0).abs() < 1e-9 && x[1] == 4.0);
}

/// An operator that fails after some products.
struct Failing(std::sync::atomic::AtomicUsize);

impl signorini_qp::SymmetricOperator for Failing {
    type Scratch = ();
    fn dim(&self) -> usize {
        2
    }
    fn scratch(&self) {}
    fn apply(&self, x: &[f64], y: &mut [f64], _: &mut ()) {
        let count = self.0.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        y[0] = 2.0 * x[0] + x[1];
        y[1] = if count == 1 { f64::NAN } else { x[0] + 2.0 * x[1] };
    }
}

#[test]
fn not_a_number_is_noticed_where_it_appears() {
    let settings = KprgpSettings::default();
    for first in [0, 1] {
        for bound in [-5.0, 0.0] {
            let a = Failing(first.into());
            let set = ProductSet::new(vec![Segment::lower(vec![-5.0, bound])]).expect("set");
            let mut work = KprgpWorkspace::new(&a);
            let t = 1e-9;
            let result = kprgp(
                &QuadraticCost::new(&a, &[1.0, -1.0], 3.0),
                &set,
                t,
                &settings,
                &mut [0.0; 2],
                &mut work,
            );
            assert!(matches!(result, Err(QpError::NotFinite { .. })), "{result:?}");
        }
    }
}

#[test]
fn a_zero_load_is_measured_by_the_first_gradient() {
    let a = pair();
    let set = ProductSet::new(vec![Segment::bounds(vec![1.0, -9.0], vec![2.0, 9.0])]).expect("set");
    let mut x = [2.0, 3.0];
    assert_eq!(
        run(&a, &[0.0; 2], &set, &mut x, &KprgpSettings::default()),
        Ok(Status::Converged)
    );
    assert!(x[0] == 1.0 && (x[1] - 0.5).abs() < 1e-9);
}

#[test]
fn a_norm_that_is_too_small_is_survived_and_reported() {
    let mut halved = 0;
    for seed in 0..20 {
        let mut r = Random::new(seed);
        let set = ProductSet::new(vec![Segment::lower(vec![-0.2; 10]), Segment::discs(vec![0.1; 10])]).expect("set");
        let (a, norm) = common::spd(30, 2.0, &mut r);
        let b = r.vector(30);
        let mut x = vec![0.0; 30];
        let mut work = KprgpWorkspace::new(&a);
        let settings = KprgpSettings::default().with_expansion(Expansion::FixedStep);
        let t = 1e-8;
        let report = kprgp(
            &QuadraticCost::new(&a, &b, 0.05 * norm),
            &set,
            t,
            &settings,
            &mut x,
            &mut work,
        )
        .expect("solve");
        assert!(report.status.converged(), "{report:?}");
        assert!(
            kkt::check(&QuadraticCost::new(&a, &b, norm), &set, &x)
                .expect("lengths")
                .relative()
                <= 1e-7
        );
        halved += report.halvings;
    }
    assert!(halved > 0);
}
