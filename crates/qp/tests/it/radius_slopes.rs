//! The active-set method where radii follow other components, inside conjugate gradients or between active sets.

use crate::common::{Random, from_zero};
use signorini_qp::active_set::{ActiveSetReport, RadiusSlope};
use signorini_qp::{
    ActiveSetSettings, DenseOperator, DenseProjector, MovingSet, ProductSet, QpError, Segment, Status, vector,
};

/// Normals that press, a disc each whose radius is a coefficient times its normal, and free components; `G` acts on the
/// latter only. All discs slide.
fn sliding(seed: u64, coefficient: f64, slopes: bool, forcing: f64) -> (Vec<f64>, ActiveSetReport) {
    let mut r = Random::new(seed);
    let (points, free) = (12, 10);
    let n = 3 * points + free;
    let mut m = vec![0.0; n * n];
    for i in 0..n {
        for j in 0..i {
            let v = 0.6 * r.real() / (n as f64).sqrt();
            m[i * n + j] = v;
            m[j * n + i] = v;
        }
        m[i * n + i] = 2.0 + r.real().abs();
    }
    let a = DenseOperator::new(n, m).expect("symmetric");
    let mut linear: Vec<f64> = (0..n).map(|_| 0.3 * r.real()).collect();
    for k in 0..points {
        linear[k] = -3.0;
        // slips from a hundredth to a hundred: small and large curvatures
        linear[points + 2 * k] = 10f64.powf(2.0 * (k as f64 / 5.5 - 1.0)) + 2.0;
    }
    let mut g = vec![0.0; 2 * n];
    for i in 0..n {
        g[i] = if i % 2 == 0 { 1.0 } else { 0.3 };
        g[n + i] = if i % 3 == 0 { 1.0 } else { -0.4 };
    }
    let mut projector = DenseProjector::new(2, n, g).expect("rows");
    let mut set = ProductSet::new(vec![
        Segment::upper(vec![0.0; points]),
        Segment::discs(vec![0.0; points]),
        Segment::Free(free),
    ])
    .expect("a set");
    let slope = |k| RadiusSlope {
        disc: points + 2 * k,
        component: k,
        slope: -coefficient,
    };
    let slopes: Vec<_> = (0..points).filter(|_| slopes).map(slope).collect();
    let mut hook = |x: &[f64], set: &mut ProductSet| {
        if let Ok(radii) = set.radii_mut(1) {
            for (radius, x) in radii.iter_mut().zip(x) {
                *radius = coefficient * (-x).max(0.0);
            }
        }
        true
    };
    let settings = ActiveSetSettings::default().with_tolerance(1e-11).with_forcing(forcing);
    let (data, start) = ((&linear[..], &[0.5, -0.2][..]), (true, &slopes[..]));
    let solved = from_zero(
        &a,
        &mut projector,
        MovingSet::new(&mut set, &mut hook),
        data,
        &settings,
        start,
    );
    let solved = solved.expect("no breakdown");
    (solved.x, solved.report)
}

#[test]
fn slopes_change_the_way_and_not_the_solution() {
    let (mut with, mut without) = (0, 0);
    for seed in 0..20 {
        let (x, report) = sliding(seed, 0.4, false, 0.4);
        let (y, coupled) = sliding(seed, 0.4, true, 0.4);
        assert_eq!(
            (report.status, coupled.status),
            (Status::Converged, Status::Converged),
            "seed {seed}"
        );
        assert!(vector::distance(&x, &y) <= 1e-9 * vector::norm(&x), "seed {seed}");
        without += report.products();
        with += coupled.products();
    }
    // the gain is measured on the benchmark; here it must not cost much
    assert!(with as f64 <= 1.1 * without as f64, "{with} {without}");
}

#[test]
fn a_strong_coupling_is_left_to_the_hook() {
    for seed in 0..20 {
        let (x, report) = sliding(seed, 3.0, false, 0.4);
        let (y, coupled) = sliding(seed, 3.0, true, 0.4);
        assert!(report.status.converged() && coupled.status.converged(), "seed {seed}");
        assert!(vector::distance(&x, &y) <= 1e-8 * vector::norm(&x), "seed {seed}");
    }
}

#[test]
fn a_set_that_slides_is_solved_to_any_accuracy() {
    // curvature is part of the fit of the multiplier of G, else conjugate gradients stop at it
    for seed in 0..20 {
        let (_, report) = sliding(seed, 0.3, false, 1e-9);
        assert_eq!(report.status, Status::Converged, "seed {seed}");
        assert!(report.products() <= 15 * report.active_sets, "seed {seed}");
    }
}

/// What cannot follow is refused, and not left out.
#[test]
fn bad_slopes_are_refused() {
    let a = DenseOperator::new(3, vec![2.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 2.0]).expect("a matrix");
    let solve = |disc, component, slope| {
        let segments = vec![Segment::upper(vec![0.0]), Segment::discs(vec![1.0])];
        let mut set = ProductSet::new(segments).expect("a set");
        let mut projector = DenseProjector::new(0, 3, Vec::new()).expect("no rows");
        let slopes = [RadiusSlope { disc, component, slope }];
        let settings = ActiveSetSettings::default();
        let moving = MovingSet::fixed(&mut set);
        from_zero(&a, &mut projector, moving, (&[1.0; 3], &[]), &settings, (true, &slopes)).map(|_| ())
    };
    assert!(solve(1, 0, -0.3).is_ok());
    for (disc, component, slope) in [(0, 0, -0.3), (2, 0, -0.3), (9, 0, -0.3), (1, 3, -0.3), (1, 0, f64::NAN)] {
        assert!(
            matches!(solve(disc, component, slope), Err(QpError::Slope { .. })),
            "{disc} {component} {slope}"
        );
    }
}
