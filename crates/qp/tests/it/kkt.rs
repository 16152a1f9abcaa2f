//! The independent check measures what it says: single blocks with known distances from optimality.

use signorini_qp::kkt::{Kkt, check, check_with};
use signorini_qp::{DenseEquality, DenseOperator, ProductSet, QuadraticCost, Segment};

/// Turns gradients into steps.
const SCALE: f64 = 2.0;

fn identity(n: usize) -> DenseOperator {
    let entry = |k: usize| if k.is_multiple_of(n + 1) { 1.0 } else { 0.0 };
    DenseOperator::new(n, (0..n * n).map(entry).collect()).expect("symmetric")
}

/// At `x` with gradient `r`.
fn at(segments: Vec<Segment>, x: &[f64], r: &[f64]) -> Kkt {
    let b: Vec<f64> = x.iter().zip(r).map(|(x, r)| x - r).collect();
    let set = ProductSet::new(segments).expect("set");
    check(&QuadraticCost::new(&identity(x.len()), &b, SCALE), &set, x).expect("lengths")
}

#[track_caller]
fn near(found: f64, expected: f64, what: &str) {
    assert!((found - expected).abs() < 1e-14, "{what}: {found}, not {expected}");
}

/// Infeasibility, stationarity, distance from the normal cone, wrong signs.
#[track_caller]
fn distances(kkt: &Kkt, expected: [f64; 4]) {
    let found = [kkt.infeasibility, kkt.stationarity, kkt.dual, kkt.sign];
    for (k, (found, expected)) in found.into_iter().zip(expected).enumerate() {
        near(found, expected, &format!("{k} of {kkt:?}"));
    }
}

#[test]
fn intervals() {
    for (lo, hi, x, r, expected) in [
        // inside; a step that a bound cuts short
        (0.0, 1.0, 0.5, 0.3, [0.0, 0.3, 0.3, 0.0]),
        (0.0, 1.0, 0.5, 3.0, [0.0, 1.0, 3.0, 0.0]),
        (0.0, 1.0, 0.5, -3.0, [0.0, 1.0, 3.0, 0.0]),
        // on a bound, pushed outward and inward
        (0.0, 1.0, 0.0, 0.4, [0.0; 4]),
        (0.0, 1.0, 0.0, -0.4, [0.0, 0.4, 0.4, 0.4]),
        (0.0, 1.0, 1.0, -0.4, [0.0; 4]),
        (0.0, 1.0, 1.0, 0.4, [0.0, 0.4, 0.4, 0.4]),
        // next to a bound, but not on it
        (0.0, 1.0, 1e-3, 0.4, [0.0, 2e-3, 0.4, 0.0]),
        // outside
        (0.0, 1.0, 1.5, 0.0, [0.5, 1.0, 0.0, 0.0]),
        (0.0, 1.0, -0.25, 0.0, [0.25, 0.5, 0.0, 0.0]),
        // one point
        (1.0, 1.0, 1.0, 7.0, [0.0; 4]),
    ] {
        let bounds = Segment::bounds(vec![lo], vec![hi]);
        let kkt = at(vec![bounds], &[x], &[r]);
        distances(&kkt, expected);
        near(kkt.x_norm, x.abs(), "x");
        near(kkt.b_norm, (x - r).abs(), "b");
        near(kkt.primal_size, x.abs().max(x.clamp(lo, hi).abs()), "primal");
    }
}

#[test]
fn discs() {
    // a step along the circle from (1.2, 1.6), drawn back to it
    let (y0, y1) = (1.2 + 0.2, 1.6 - 0.15);
    let back = 2.0 / f64::hypot(y0, y1);
    let along = SCALE * f64::hypot(1.2 - back * y0, 1.6 - back * y1);
    for (radius, x, r, expected) in [
        (2.0, [0.3, 0.4], [0.3, -0.4], [0.0, 0.5, 0.5, 0.0]),
        // on the circle: outward, inward, along it
        (2.0, [2.0, 0.0], [-1.0, 0.0], [0.0; 4]),
        (2.0, [1.2, 1.6], [0.3, 0.4], [0.0, 0.5, 0.5, 0.5]),
        (2.0, [1.2, 1.6], [-0.4, 0.3], [0.0, along, 0.5, 0.0]),
        // outside, at rest
        (2.0, [3.0, 4.0], [0.0, 0.0], [3.0, 6.0, 0.0, 0.0]),
        (2.0, [1.8, 2.4], [0.0, 0.0], [1.0, 2.0, 0.0, 0.0]),
        // one point
        (0.0, [0.0, 0.0], [1.0, 2.0], [0.0; 4]),
    ] {
        let kkt = at(vec![Segment::discs(vec![radius])], &x, &r);
        distances(&kkt, expected);
        let size = f64::hypot(x[0], x[1]);
        near(kkt.primal_size, size.max(size.min(radius)), "primal");
    }
    // both parts of what a mixed gradient does: along the circle 0.3, inward 0.4
    let (n, t) = ([0.6, 0.8], [-0.8, 0.6]);
    for (inward, expected) in [(0.4, [0.5, 0.4]), (-0.4, [0.3, 0.0])] {
        let r = [0, 1].map(|c| inward * n[c] + 0.3 * t[c]);
        let kkt = at(vec![Segment::discs(vec![2.0])], &[1.2, 1.6], &r);
        near(kkt.dual, expected[0], "dual");
        near(kkt.sign, expected[1], "sign");
    }
}

/// Sums of several blocks, the worst of them, and sizes.
#[test]
fn blocks_and_equalities_together() {
    let segments = || {
        vec![
            Segment::lower(vec![0.0, 0.0]),
            Segment::discs(vec![1.0]),
            Segment::Free(1),
        ]
    };
    let (x, r) = ([-3.0, 0.0, 0.0, 0.0, 2.0], [0.0, -1.0, 0.0, 2.0, 0.5]);
    let kkt = at(segments(), &x, &r);
    // outside 3; natural: 6, 1, min(2, 2 radius) = 2, 0.5
    distances(
        &kkt,
        [
            3.0,
            (36.0 + 1.0 + 4.0 + 0.25_f64).sqrt(),
            (1.0 + 4.0 + 0.25_f64).sqrt(),
            1.0,
        ],
    );
    assert_eq!(kkt.worst, 0);
    let other = at(segments(), &[0.0, 0.0, 0.0, 0.0, 2.0], &r);
    assert_eq!(other.worst, 2);
    near(other.primal_size, 2.0, "primal");

    // the projection is farther from zero than the point: bounds 3 beside a disc of 4
    let beside = vec![Segment::lower(vec![3.0]), Segment::discs(vec![9.0])];
    near(at(beside, &[0.0, 4.0, 0.0], &[0.0; 3]).primal_size, 5.0, "projection");
    // what is near a bound, against the largest component, is on it
    for (off, dual) in [(5e-5, 0.0), (2e-4, 0.4)] {
        let two = vec![Segment::lower(vec![0.0; 2])];
        near(at(two, &[1e6, off], &[0.0, 0.4]).dual, dual, "near a bound");
    }

    // x0 + x1 = 5 with rows of length one, by a multiplier
    let half = 0.5_f64.sqrt();
    let c = DenseEquality::orthonormal(1, 2, &[1.0, 1.0]).expect("row");
    let set = ProductSet::new(vec![Segment::Free(2)]).expect("set");
    let (e, multiplier) = ([5.0 * half], [3.0]);
    let check = |b: &[f64], x: &[f64]| {
        let a = identity(2);
        let cost = QuadraticCost::new(&a, b, SCALE).with_equality(&c, &e);
        check_with(&cost, &set, x, &multiplier).expect("lengths")
    };
    let kkt = check(&[1.0, 2.0], &[1.0, 2.0]);
    near(kkt.equality, 2.0 * half, "equality");
    near(kkt.stationarity, 3.0, "stationarity");
    near(kkt.dual_size, 5.0_f64.sqrt(), "b");
    near(kkt.primal_size, 5.0 * half, "e");
    near(kkt.relative(), (3.0 / 5.0_f64.sqrt()).max(0.4), "relative");
    let kkt = check(&[0.0; 2], &[0.5, 0.0]);
    near(kkt.dual_size, 3.0, "multiplier");
    let kkt = check(&[0.0; 2], &[30.0, 40.0]);
    near(kkt.dual_size, 50.0, "A x");
    near(kkt.primal_size, 50.0, "x");
}

#[test]
fn what_is_not_a_number_is_no_optimum() {
    let a = DenseOperator::new(1, vec![1.0]).expect("operator");
    let (set, cost) = (ProductSet::free(1), QuadraticCost::new(&a, &[1.0], 1.0));
    assert!(check(&cost, &set, &[f64::NAN]).is_err());
    assert!(check(&QuadraticCost::new(&a, &[f64::INFINITY], 1.0), &set, &[1.0]).is_err());
    assert!(check(&QuadraticCost::new(&a, &[1.0], 0.0), &set, &[1.0]).is_err());
    let mut found = check(&cost, &set, &[1.0]).expect("figures");
    assert_eq!(found.relative(), 0.0);
    found.stationarity = f64::NAN;
    assert!(found.relative().is_nan());
    // a product that is infinity less infinity, on bounds that would take any gradient
    let a = DenseOperator::new(2, vec![1e308, -1e308, -1e308, 1e308]).expect("operator");
    let bounds = Segment::bounds(vec![1e10; 2], vec![f64::INFINITY; 2]);
    let set = ProductSet::new(vec![bounds]).expect("set");
    let found = check(&QuadraticCost::new(&a, &[1.0; 2], 1.0), &set, &[1e10; 2]).expect("figures");
    assert!(found.relative().is_nan(), "{found:?}");
}

#[test]
fn relative_figures_have_no_units() {
    // lengths in another unit: x and e times `unit`, the operator as it is
    let found = |unit: f64| {
        let a = DenseOperator::new(2, vec![2e9, 1e9, 1e9, 3e9]).expect("operator");
        let b = [0.0; 2];
        let cost = QuadraticCost::new(&a, &b, 3e9);
        let at_least =
            |low: f64| ProductSet::new(vec![Segment::bounds(vec![low; 2], vec![f64::INFINITY; 2])]).expect("set");
        // no load, but pushed by a bound: 1e-3 off the bound, outside of it, and at zero
        let away = check(&cost, &at_least(unit), &[1.001 * unit, unit]).expect("figures");
        let outside = check(&cost, &at_least(unit), &[0.9 * unit, unit]).expect("figures");
        let zero = check(&cost, &at_least(unit), &[0.0; 2]).expect("figures");
        let right = check(&cost, &at_least(unit), &[unit; 2]).expect("figures");
        let rest = check(&cost, &at_least(-unit), &[0.0; 2]).expect("figures");
        assert_eq!((right.relative(), rest.relative()), (0.0, 0.0));
        // by an equality that the point misses
        let c = DenseEquality::orthonormal(1, 2, &[1.0, 0.0]).expect("equality");
        let (e, free) = ([unit], ProductSet::free(2));
        let missed = check_with(&cost.with_equality(&c, &e), &free, &[0.0; 2], &[0.0]).expect("figures");
        [away, outside, zero, missed].map(|k| k.relative())
    };
    let figures = found(1.0);
    assert!(figures[0] > 1e-4 && figures[0] < 1e-2, "{figures:?}");
    assert!(figures[1] > 0.01 && figures[1] < 1.0, "{figures:?}");
    assert_eq!(figures[2..], [1.0, 1.0]);
    for unit in [1e3, 1e-3, 1e-9] {
        for (own, other) in figures.iter().zip(found(unit)) {
            assert!((own / other - 1.0).abs() < 1e-9, "{unit:e}: {own} {other}");
        }
    }
}
