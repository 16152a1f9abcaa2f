//! MPRGP on an obstacle string, with the products of the best known code as a limit.

use signorini_qp::kprgp::{Expansion, KprgpReport, KprgpWorkspace};
use signorini_qp::problem::BlockState;
use signorini_qp::{
    ConvexSet, KprgpSettings, ProductSet, QuadraticCost, Segment, SymmetricOperator, kkt, kprgp, vector,
};
use std::f64::consts::PI;

const N: usize = 100;
const OPTIMUM: f64 = -0.291_767_320_525_8;

/// Tridiagonal (-1, 2, -1) with unit rows at both ends.
struct DirichletString;

impl SymmetricOperator for DirichletString {
    type Scratch = ();
    fn dim(&self) -> usize {
        N
    }
    fn scratch(&self) -> Self::Scratch {}
    fn apply(&self, x: &[f64], y: &mut [f64], _s: &mut ()) {
        y[0] = x[0];
        y[N - 1] = x[N - 1];
        for i in 1..N - 1 {
            let left = if i > 1 { x[i - 1] } else { 0.0 };
            let right = if i < N - 2 { x[i + 1] } else { 0.0 };
            y[i] = 2.0 * x[i] - left - right;
        }
    }
}

/// Largest eigenvalue: 98 inner nodes.
fn largest() -> f64 {
    2.0 + 2.0 * (PI / 99.0).cos()
}

fn problem() -> (Vec<f64>, ProductSet) {
    let h = 1.0 / (N as f64 - 1.0);
    let mut b = vec![-30.0 * h * h; N];
    b[0] = 0.0;
    b[N - 1] = 0.0;
    let mut lower: Vec<f64> = (0..N)
        .map(|i| (4.0 * PI * i as f64 * h - PI / 6.0).sin() / 2.0 - 2.0)
        .collect();
    lower[0] = 0.0;
    lower[N - 1] = 0.0;
    (b, ProductSet::new(vec![Segment::lower(lower)]).expect("set"))
}

fn solve(settings: &KprgpSettings, norm: f64, tolerance: f64) -> (KprgpReport, Vec<f64>) {
    let (b, set) = problem();
    let mut x = vec![0.0; N];
    let mut work = KprgpWorkspace::new(&DirichletString);
    let report = kprgp(
        &QuadraticCost::new(&DirichletString, &b, norm),
        &set,
        tolerance,
        settings,
        &mut x,
        &mut work,
    )
    .expect("solve");
    assert!(report.status.converged(), "{report:?}");
    assert!(report.projected_gradient <= tolerance * vector::norm(&b));
    (report, x)
}

fn cost(x: &[f64]) -> f64 {
    let (b, _) = problem();
    let mut y = vec![0.0; N];
    DirichletString.apply(x, &mut y, &mut ());
    0.5 * vector::dot(x, &y) - vector::dot(x, &b)
}

fn at_bound(x: &[f64]) -> usize {
    let (_, set) = problem();
    let mut count = 0;
    set.for_each_block(x, &mut |block| count += usize::from(block.state == BlockState::AtLower));
    count
}

/// Step 2 / norm and Gamma 1, as in the reference count.
fn classical(expansion: Expansion) -> KprgpSettings {
    KprgpSettings::default().with_step_length(2.0).with_expansion(expansion)
}

#[test]
fn projected_cg_needs_no_more_than_the_best_known_code() {
    let (report, x) = solve(&classical(Expansion::ProjectedCg), largest(), 1e-5);
    assert!(
        report.products.total() <= 175,
        "{:?} {:?}",
        report.products,
        report.steps
    );
    assert!((cost(&x) - OPTIMUM).abs() <= 1e-9 * OPTIMUM.abs());
    assert_eq!(at_bound(&x), 14);
    assert_eq!(
        report.steps.total(),
        report.steps.cg + report.steps.expansion + report.steps.proportioning
    );
}

/// The reference count belongs to an estimate of the largest eigenvalue that is half a per cent low (a
/// power method does that); with it every step is the same as there.
#[test]
fn the_standard_expansion_repeats_the_reference_step_by_step() {
    let (report, x) = solve(&classical(Expansion::FixedStep), 0.995 * largest(), 1e-5);
    assert_eq!(
        (report.steps.cg, report.steps.expansion, report.steps.proportioning),
        (156, 18, 7)
    );
    assert_eq!(report.products.total(), 200);
    assert_eq!(at_bound(&x), 14);
}

/// With the exact eigenvalue the default step 1.9 stays below the reference; 2.0 is within noise of it.
#[test]
fn the_standard_expansion_with_the_exact_eigenvalue() {
    let standard = KprgpSettings::default().with_expansion(Expansion::FixedStep);
    let (report, x) = solve(&standard, largest(), 1e-5);
    assert!(
        report.products.total() <= 200,
        "{:?} {:?}",
        report.products,
        report.steps
    );
    assert!((cost(&x) - OPTIMUM).abs() <= 1e-9 * OPTIMUM.abs());
    assert_eq!(at_bound(&x), 14);
    let (report, _) = solve(&classical(Expansion::FixedStep), largest(), 1e-5);
    assert!(
        report.products.total() <= 206,
        "{:?} {:?}",
        report.products,
        report.steps
    );
}

#[test]
fn a_tight_tolerance_is_met_on_the_true_gradient() {
    let (b, set) = problem();
    let (report, x) = solve(&KprgpSettings::default(), largest(), 1e-12);
    let kkt = kkt::check(&QuadraticCost::new(&DirichletString, &b, largest()), &set, &x).expect("lengths");
    assert!(kkt.stationarity <= 2e-12 * kkt.b_norm, "{kkt:?}");
    assert!((cost(&x) - OPTIMUM).abs() <= 1e-12, "{:e}", cost(&x) - OPTIMUM);
    assert!((report.cost - cost(&x)).abs() <= 1e-12);
    assert_eq!(at_bound(&x), 14);
}

#[test]
fn units_change_nothing() {
    let (b, set) = problem();
    let Some(Segment::Bounds { lower, .. }) = set.segments().first() else {
        panic!("bounds")
    };
    let (reference, x) = solve(&KprgpSettings::default(), largest(), 1e-5);
    // lengths in other units, a power of two so that rounding is the same
    let unit = (2.0_f64).powi(30);
    let small = ProductSet::new(vec![Segment::lower(lower.iter().map(|v| v / unit).collect())]).expect("set");
    let b: Vec<f64> = b.iter().map(|v| v / unit).collect();
    let mut y = vec![0.0; N];
    let mut work = KprgpWorkspace::new(&DirichletString);
    let (t, s) = (1e-5, KprgpSettings::default());
    let report = kprgp(
        &QuadraticCost::new(&DirichletString, &b, largest()),
        &small,
        t,
        &s,
        &mut y,
        &mut work,
    )
    .expect("solve");
    assert_eq!(report.products, reference.products);
    assert!(x.iter().zip(&y).all(|(u, v)| *u == v * unit));
}
