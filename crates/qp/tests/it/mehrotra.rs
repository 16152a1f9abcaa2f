//! Interior points: the same answers as by other methods, also where radii follow, in few steps whatever bends.

use crate::common::{self, Random};
use signorini_qp::active_set::RadiusSlope;
use signorini_qp::kprgp::KprgpWorkspace;
use signorini_qp::{
    ConvexSet, DenseOperator, KprgpSettings, ProductSet, QpError, QuadraticCost, Segment, Status, SymmetricOperator,
    interior_point, kprgp, norm_estimate, vector,
};

const TARGET: f64 = 1e-12;

#[test]
fn random_problems_have_the_answer_of_kprgp() {
    let mut r = Random::new(5);
    for case in 0..60 {
        let set = common::set(&mut r);
        let n = set.dim();
        let (a, norm) = common::spd(n, 2.0, &mut r);
        let b: Vec<f64> = (0..n).map(|_| 3.0 * r.real()).collect();
        let mut x = r.vector(n);
        let report = interior_point(&a, &b, &set, &[], TARGET, &mut x).expect("valid");
        assert_eq!(report.status, Status::Converged, "{case}");
        assert!(report.steps <= 30, "{case}: {}", report.steps);
        assert!(set.violation(&x) <= 1e-12 * vector::norm(&x), "{case}");
        let (mut other, mut work) = (vec![0.0; n], KprgpWorkspace::new(&a));
        let cost = QuadraticCost::new(&a, &b, norm);
        let solved = kprgp(&cost, &set, 1e-10, &KprgpSettings::default(), &mut other, &mut work).expect("valid");
        assert!(solved.status.converged(), "{case}");
        let off = vector::distance(&x, &other) / vector::norm(&other);
        assert!(off < 1e-4, "{case}: {off:e}");
    }
}

/// A beam held at one end that lies on points and is pushed sideways along them: `A` is the compliance of its nodes, up
/// and sideways. Radii are a coefficient times the pressing forces; discs, or intervals where only one way is open.
fn beam(n: usize, width: usize) -> (DenseOperator, Vec<f64>, ProductSet, Vec<RadiusSlope>) {
    let compliance = |i: usize, j: usize| {
        let [short, long] = [i.min(j), i.max(j)].map(|k| (k + 1) as f64 / n as f64);
        short * short * (3.0 * long - short) / 6.0 + if i == j { 1e-5 } else { 0.0 }
    };
    let size = n * (1 + width);
    let mut a = vec![0.0; size * size];
    for i in 0..n {
        for j in 0..n {
            a[i * size + j] = compliance(i, j);
            for k in 0..width {
                a[(n + width * i + k) * size + n + width * j + k] = 0.3 * compliance(i, j);
            }
        }
    }
    let mut b = vec![0.0; size];
    for i in 0..n {
        let at = (i + 1) as f64 / n as f64;
        // pressed down in the middle, up at the end
        b[i] = -1e-3 * (at * at) * (1.1 - at);
        b[n + width * i] = 4e-5 * at;
    }
    let tangential = match width {
        1 => Segment::bounds(vec![0.0; n], vec![0.0; n]),
        _ => Segment::discs(vec![0.0; n]),
    };
    let set = ProductSet::new(vec![Segment::upper(vec![0.0; n]), tangential]).expect("a set");
    let slope = |i| RadiusSlope {
        disc: n + width * i,
        component: i,
        slope: -0.3,
    };
    let a = DenseOperator::new(size, a).expect("symmetric");
    (a, b, set, (0..n).map(slope).collect())
}

/// What a point lacks to Coulomb's law: each violation over the largest force or displacement.
fn violation(a: &DenseOperator, b: &[f64], x: &[f64], n: usize, width: usize) -> f64 {
    let mut g = common::product(a, x);
    vector::subtract(b, &mut g);
    let [force, way] = [vector::max_abs(x), vector::max_abs(b)];
    (0..n).fold(0.0, |worst: f64, i| {
        let own = n + width * i..n + width * (i + 1);
        let (pressed, gap) = ((-x[i]).max(0.0), -g[i]);
        let radius = 0.3 * pressed;
        let (held, slip) = (vector::norm(&x[own.clone()]), vector::norm(&g[own.clone()]));
        let against = vector::dot(&x[own.clone()], &g[own]) + radius * slip;
        let all = [
            x[i] / force,
            -gap / way,
            pressed / force * (gap / way).abs(),
            (held - radius) / force,
            against / force / way,
        ];
        all.into_iter().fold(worst, f64::max)
    })
}

#[test]
fn radii_follow_in_few_steps_whatever_bends() {
    for n in [10, 40, 120] {
        for width in [1, 2] {
            let (a, b, set, slopes) = beam(n, width);
            let mut x = vec![0.0; a.dim()];
            let report = interior_point(&a, &b, &set, &slopes, TARGET, &mut x).expect("valid");
            let open = x[..n].iter().filter(|x| **x == 0.0).count();
            let off = violation(&a, &b, &x, n, width);
            println!("{n} x {width}: {report:?}, {open} open, {off:e}");
            assert_eq!(report.status, Status::Converged);
            assert!(report.steps <= 60 && 0 < open && open < n);
            assert!(off < 1e-5, "{off:e}");
        }
    }
}

/// Which bounds a start is on decides nothing but the cost.
#[test]
fn what_rests_at_the_start_is_let_go() {
    let n = 40;
    let (a, b, set, slopes) = beam(n, 2);
    let mut x = vec![0.0; a.dim()];
    let all = interior_point(&a, &b, &set, &slopes, TARGET, &mut x).expect("valid");
    for pressed in [0..3, 20..21, 5..30] {
        let mut other = vec![0.0; a.dim()];
        pressed.clone().for_each(|i| other[i] = -1e-3);
        let radii = other[..n].iter().map(|x| -0.3 * x).collect();
        let set = ProductSet::new(vec![Segment::upper(vec![0.0; n]), Segment::discs(radii)]).expect("a set");
        let report = interior_point(&a, &b, &set, &slopes, TARGET, &mut other).expect("valid");
        assert_eq!([all.status, report.status], [Status::Converged; 2], "{pressed:?}");
        let off = vector::distance(&x, &other) / vector::norm(&x);
        assert!(off < 1e-6, "{pressed:?}: {off:e}");
    }
}

/// What forces balance anyway, with a large weight: its parts cancel, and their rounding works more than a solution may
/// lack otherwise.
#[test]
fn an_equality_with_a_large_weight_leaves_rounding() {
    let n = 40;
    let (a, b, set, slopes) = beam(n, 2);
    let mut x = vec![0.0; a.dim()];
    let _ = interior_point(&a, &b, &set, &slopes, TARGET, &mut x).expect("valid");
    let size = a.dim();
    let [even, odd] = [0, 1].map(|first| x[first..n].iter().step_by(2).sum::<f64>());
    let balance = |i: usize| if i.is_multiple_of(2) { 1.0 } else { -even / odd };
    for weight in [1e1, 1e2, 1e3, 1e4, 3e4, 1e5, 3e5, 1e6, 3e6] {
        let mut entries = a.entries().to_vec();
        for i in 0..n {
            for j in 0..n {
                entries[i * size + j] += weight * balance(i) * balance(j);
            }
        }
        let a = DenseOperator::new(size, entries).expect("symmetric");
        let mut other = vec![0.0; size];
        let report = interior_point(&a, &b, &set, &slopes, 1e-18, &mut other).expect("valid");
        let off = vector::distance(&x, &other) / vector::norm(&x);
        assert_eq!(report.status, Status::Converged, "{weight:e}");
        assert!(off < 1e-4, "{weight:e}: {off:e}");
    }
}

#[test]
fn sets_without_inequalities_take_one_step() {
    let mut r = Random::new(3);
    let (a, _) = common::spd(8, 2.0, &mut r);
    let b = r.vector(8);
    let fixed = Segment::bounds(vec![0.5], vec![0.5]);
    let set = ProductSet::new(vec![Segment::Free(5), fixed, Segment::discs(vec![0.0])]).expect("a set");
    let mut x = vec![0.0; 8];
    let report = interior_point(&a, &b, &set, &[], TARGET, &mut x).expect("valid");
    assert_eq!((report.status, report.steps), (Status::Converged, 1));
    assert_eq!(x[5..], [0.5, 0.0, 0.0]);
    let mut g = common::product(&a, &x);
    vector::subtract(&b, &mut g);
    assert!(vector::max_abs(&g[..5]) < 1e-12);
    assert!(norm_estimate(&a).expect("a norm").upper > 0.0);
}

#[test]
fn wrong_input_is_refused() {
    let (a, b, set, slopes) = beam(3, 2);
    let solve = |b: &[f64], x: &mut [f64]| interior_point(&a, b, &set, &slopes, TARGET, x).map(|_| ());
    assert!(matches!(
        solve(&b, &mut [0.0; 2]),
        Err(QpError::Length { what: "x", .. })
    ));
    assert!(matches!(solve(&b[1..], &mut [0.0; 9]), Err(QpError::Length { .. })));
    assert!(matches!(
        solve(&[f64::NAN; 9], &mut [0.0; 9]),
        Err(QpError::Input { .. })
    ));
    let other = ProductSet::free(4);
    let refused = interior_point(&a, &b, &other, &slopes, TARGET, &mut [0.0; 9]);
    assert!(matches!(refused, Err(QpError::Length { what: "the set", .. })));
    // not finite, out of range, twice, to the second component of a disc, to what has no radius
    let wrong = [
        (3, 0, f64::NAN),
        (3, 9, -0.3),
        (9, 0, -0.3),
        (3, 1, -0.3),
        (4, 0, -0.3),
        (1, 0, -0.3),
    ];
    for (disc, component, slope) in wrong {
        let slopes = [slopes[0], RadiusSlope { disc, component, slope }];
        let refused = interior_point(&a, &b, &set, &slopes, TARGET, &mut [0.0; 9]);
        assert!(
            matches!(refused, Err(QpError::Slope { .. })),
            "{disc} {component} {slope}"
        );
    }
    let refused = interior_point(&a, &b, &set, &slopes, f64::NAN, &mut [0.0; 9]);
    assert!(matches!(refused, Err(QpError::Setting { .. })));
}

fn diagonal(d: &[f64]) -> DenseOperator {
    let n = d.len();
    let mut a = vec![0.0; n * n];
    d.iter().enumerate().for_each(|(i, d)| a[i * (n + 1)] = *d);
    DenseOperator::new(n, a).expect("a matrix")
}

/// Steel beside rubber: what pushes off a bound is a matter of each component's own stiffness.
#[test]
fn stiff_components_beside_soft_ones_are_let_go() {
    for soft in [1e-5, 1e-6, 1e-8] {
        let a = diagonal(&[1.0, 1.0, soft]);
        let set = ProductSet::new(vec![Segment::upper(vec![0.0; 3])]).expect("a set");
        for start in [[-1.0; 3], [-1.0, 0.0, 0.0]] {
            let mut x = start;
            let report = interior_point(&a, &[-1.0, 1.0, -soft], &set, &[], TARGET, &mut x).expect("valid");
            assert_eq!(report.status, Status::Converged, "{soft:e} {start:?}");
            let off = vector::distance(&x, &[-1.0, 0.0, -1.0]);
            assert!(off < 1e-5, "{soft:e} {start:?}: {x:?}");
        }
    }
}

/// A chain in which each component pushes the next one off its bound.
#[test]
fn letting_go_takes_few_rounds() {
    let n = 200;
    let mut a = vec![0.0; n * n];
    for i in 0..n {
        a[i * (n + 1)] = 2.0;
        if i > 0 {
            a[i * n + i - 1] = -1.0;
            a[(i - 1) * n + i] = -1.0;
        }
    }
    let a = DenseOperator::new(n, a).expect("a matrix");
    let mut b = vec![0.0; n];
    b[0] = 1.0;
    let set = ProductSet::new(vec![Segment::lower(vec![0.0; n])]).expect("a set");
    let mut x = vec![0.0; n];
    x[0] = 1.0;
    let report = interior_point(&a, &b, &set, &[], TARGET, &mut x).expect("valid");
    assert_eq!(report.status, Status::Converged);
    assert!(report.steps < 100, "{}", report.steps);
    let last = n as f64 / (n + 1) as f64;
    assert!((x[0] - last).abs() < 1e-6, "{}", x[0]);
}

/// A disc that follows nothing beside one that does; components that are held; nothing to do; nothing that answers.
#[test]
fn corners_have_answers() {
    let follows = |disc, component, slope| [RadiusSlope { disc, component, slope }];
    let ones = [1.0; 5];
    let free = || vec![Segment::Free(1), Segment::discs(vec![0.0, 0.5])];
    let held = |at| {
        vec![
            Segment::bounds(vec![at], vec![at]),
            Segment::discs(vec![0.0]),
            Segment::upper(vec![0.0, 0.5]),
        ]
    };
    let cases = [
        (free(), &follows(1, 0, 0.5)[..], [2.0, 3.0, 0.0, 1.0, 0.0]),
        (held(0.0), &follows(1, 0, -0.3), [-1.0, 2.0, 0.0, -1.0, 5.0]),
        (held(-1.0), &follows(1, 0, -0.3), [-1.0, 2.0, 0.0, -1.0, 5.0]),
        (held(0.0), &[], [0.0; 5]),
        (vec![Segment::lower(vec![1.0; 5])], &[], [0.0; 5]),
    ];
    let answers = [
        [2.0, 1.0, 0.0, 0.5, 0.0],
        [0.0, 0.0, 0.0, -1.0, 0.5],
        [-1.0, 0.3, 0.0, -1.0, 0.5],
        [0.0; 5],
        [1.0; 5],
    ];
    for (k, ((set, slopes, b), answer)) in cases.into_iter().zip(answers).enumerate() {
        let set = ProductSet::new(set).expect("a set");
        let mut x = vec![0.0; 5];
        let report = interior_point(&diagonal(&ones), &b, &set, slopes, TARGET, &mut x).expect("valid");
        assert_eq!(report.status, Status::Converged, "{k}: {report:?}");
        assert!(vector::distance(&x, &answer) < 1e-5, "{k}: {x:?}");
    }
    let singular = DenseOperator::new(2, vec![1.0; 4]).expect("a matrix");
    let set = ProductSet::new(vec![Segment::Free(2)]).expect("a set");
    let report = interior_point(&singular, &[1.0, 0.0], &set, &[], TARGET, &mut [0.0; 2]).expect("valid");
    assert_eq!(report.status, Status::Stagnated);
}
