//! Laws of products of free components, bounds and discs.

use crate::common::{self, Random};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use signorini_qp::laws::{check_equality_laws, check_operator_laws, check_set_laws};
use signorini_qp::problem::BlockState;
use signorini_qp::{ConvexSet, DenseEquality, ProductSet, Segment, SetError, vector};

fn config() -> ProptestConfig {
    ProptestConfig {
        cases: 300,
        rng_seed: RngSeed::Fixed(11),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn products_obey_the_laws(seed in any::<u64>(), decade in -9_i32..9) {
        let set = common::set(&mut Random::new(seed));
        let verdict = check_set_laws(&set, 1.0, 6);
        prop_assert!(verdict.is_ok(), "{verdict:?} {set:?}");
        // the same at any scale
        let s = 10f64.powi(decade);
        let scaled = set.segments().iter().map(|g| match g {
            Segment::Bounds { lower, upper } => Segment::bounds(
                lower.iter().map(|v| s * v).collect(), upper.iter().map(|v| s * v).collect()),
            Segment::Discs { radii } => Segment::discs(radii.iter().map(|v| s * v).collect()),
            other => other.clone(),
        });
        let scaled = ProductSet::new(scaled.collect()).expect("valid");
        let verdict = check_set_laws(&scaled, s, 6);
        prop_assert!(verdict.is_ok(), "{verdict:?} {scaled:?}");
    }

    #[test]
    fn a_step_to_the_boundary_is_seen_as_active(
        x in -1.0..1.0f64, y in -1.0..1.0f64, p in -1.0..1.0f64, q in -1.0..1.0f64, e in -12_i32..12,
    ) {
        let s = 10f64.powi(e);
        let set = ProductSet::new(vec![Segment::discs(vec![1.5 * s])]).expect("valid");
        let mut z = [s * x, s * y];
        let p = [p, q];
        prop_assume!(p[0].abs() + p[1].abs() > 1e-3);
        let t = set.feasible_step(&z, &p);
        set.advance(&mut z, &p, t);
        let mut state = BlockState::Free;
        set.for_each_block(&z, &mut |b| state = b.state);
        prop_assert_eq!(state, BlockState::Boundary);
        prop_assert!(z[0].hypot(z[1]) <= 1.5 * s);
    }

    #[test]
    fn a_bound_that_stops_a_step_is_met_exactly(l in -1.0..0.0f64, x in 0.0..1.0f64, p in 1e-6..10.0f64) {
        let set = ProductSet::new(vec![Segment::lower(vec![l])]).expect("valid");
        let mut z = [x];
        let t = set.feasible_step(&z, &[p]);
        set.advance(&mut z, &[p], t);
        prop_assert_eq!(z[0], l);
    }

    #[test]
    fn operators_obey_the_laws(seed in any::<u64>(), n in 1_usize..20) {
        let mut r = Random::new(seed);
        let (a, _) = common::spd(n, 4.0, &mut r);
        prop_assert!(check_operator_laws(&a, 3, 1e-12).is_ok());
        let rows = r.below(n);
        let c = DenseEquality::orthonormal(rows, n, &r.vector(rows * n)).expect("independent");
        let verdict = check_equality_laws(&c, 3, 1e-12);
        prop_assert!(verdict.is_ok(), "{verdict:?}");
    }
}

#[test]
fn states_name_what_they_are() {
    let inf = f64::INFINITY;
    let set = ProductSet::new(vec![
        Segment::Free(2),
        Segment::bounds(vec![0.0, 0.0, 1.0, -inf, 0.0], vec![1.0, 1.0, 1.0, inf, 1.0]),
        Segment::Free(0),
        Segment::discs(vec![0.0, 5.0, 5.0]),
    ])
    .expect("valid");
    assert_eq!(set.dim(), 13);
    let x = [9.0, 9.0, 0.0, 1.0, 1.0, 7.0, 0.5, 0.0, 0.0, 3.0, 4.0, 3.0, 3.0];
    let mut blocks = Vec::new();
    set.for_each_block(&x, &mut |b| blocks.push((b.start, b.len, b.state)));
    use BlockState::{AtLower, AtUpper, Boundary, Fixed, Free, Interior};
    let expected = [
        (0, 2, Free),
        (2, 1, AtLower),
        (3, 1, AtUpper),
        (4, 1, Fixed),
        (5, 1, Free),
        (6, 1, Free),
        (7, 2, Fixed),
        (9, 2, Boundary),
        (11, 2, Interior),
    ];
    assert_eq!(blocks, expected);
}

#[test]
fn slip_bounds_can_be_written_in_place() {
    let mut set = ProductSet::new(vec![Segment::upper(vec![0.0]), Segment::discs(vec![1.0])]).expect("valid");
    set.radii_mut(1).expect("discs")[0] = 2.0;
    let mut x = vec![1.0, 3.0, 0.0];
    set.project(&mut x);
    assert_eq!(x, [0.0, 2.0, 0.0]);
    assert!(matches!(set.radii_mut(0), Err(SetError::Kind { segment: 0, .. })));
    assert!(set.bounds_mut(0).is_ok() && set.bounds_mut(1).is_err());
    set.radii_mut(1).expect("discs")[0] = -1.0;
    assert!(matches!(
        set.validate(),
        Err(SetError::Radius {
            segment: 1,
            entry: 0,
            ..
        })
    ));
}

#[test]
fn original_multipliers_are_recovered() {
    use signorini_qp::Equality;
    let g = [1.0, 2.0, 0.5, -1.0, 0.3, 4.0];
    let c = DenseEquality::orthonormal(2, 3, &g).expect("independent");
    // C' mu = G' nu
    let mu = [0.7, -1.3];
    let nu = c.original_multiplier(&mu).expect("length");
    let mut left = [0.0; 3];
    c.apply_transpose(&mu, &mut left, &mut ());
    let right: Vec<f64> = (0..3).map(|j| g[j] * nu[0] + g[3 + j] * nu[1]).collect();
    assert!(vector::distance(&left, &right) < 1e-14);
}

#[test]
fn segments_know_how_many_components_they_have() {
    for (segment, len) in [
        (Segment::Free(3), 3),
        (Segment::lower(vec![0.0; 2]), 2),
        (Segment::discs(vec![1.0; 2]), 4),
        (Segment::Free(0), 0),
        (Segment::discs(vec![]), 0),
    ] {
        assert_eq!((segment.len(), segment.is_empty()), (len, len == 0));
    }
}
