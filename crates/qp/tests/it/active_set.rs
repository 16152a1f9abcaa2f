//! The active-set method against the independent optimality check, SMALSE, and its own promises.

use crate::common::{Random, from_zero, product, spd};
use proptest::prelude::*;
use signorini_qp::active_set::{ActiveSetPoint, ActiveSetProblem, ActiveSetReport, ActiveSetWorkspace};
use signorini_qp::problem::Diagonal;
use signorini_qp::{
    ActiveSetSettings, ConvexSet, DenseOperator, DenseProjector, MovingSet, ProductSet, QpError, Segment, Status,
    SymmetricOperator, active_set, vector,
};

/// Natural residual `x - P(x - (A x - b + Gᵀ mu))`, in its own loop.
fn natural_residual(a: &DenseOperator, b: &[f64], set: &ProductSet, x: &[f64], force: &[f64]) -> f64 {
    let mut g = vec![0.0; x.len()];
    a.apply(x, &mut g, &mut a.scratch());
    let mut y: Vec<f64> = (0..x.len()).map(|i| x[i] - (g[i] - b[i] + force[i])).collect();
    set.project(&mut y);
    vector::distance(x, &y)
}

/// No rows.
fn no_equality(n: usize) -> DenseProjector {
    DenseProjector::new(0, n, Vec::new()).expect("nothing to depend on")
}

struct Problem {
    a: DenseOperator,
    b: Vec<f64>,
    set: ProductSet,
    g: Vec<f64>,
    e: Vec<f64>,
    rows: usize,
}

/// Diagonally dominant (like the compliance of a contact surface), with bounds, discs and free components.
fn problem(seed: u64) -> Problem {
    let mut r = Random::new(seed);
    let (bounds, discs, free) = (3 + r.below(12), r.below(6), 6 + r.below(10));
    let n = bounds + 2 * discs + free;
    let mut m = vec![0.0; n * n];
    for i in 0..n {
        for j in 0..i {
            let v = -0.8 * r.real().abs() / n as f64;
            m[i * n + j] = v;
            m[j * n + i] = v;
        }
        m[i * n + i] = 1.0 + 0.5 * r.real().abs();
    }
    let a = DenseOperator::new(n, m).expect("symmetric");
    let b = r.vector(n);
    let radii = (0..discs)
        .map(|k| if k % 3 == 2 { 0.0 } else { 0.6 * r.real().abs() })
        .collect();
    let set = ProductSet::new(vec![
        Segment::upper(vec![0.0; bounds]),
        Segment::discs(radii),
        Segment::Free(free),
    ])
    .expect("a set");
    let rows = r.below(3);
    let mut g = r.vector(rows * n);
    // every row also reaches the free components strongly
    for i in 0..rows {
        g[i * n + n - 1 - i] += 3.0;
    }
    let e = r.vector(rows);
    Problem { a, b, set, g, e, rows }
}

fn solve(p: &Problem, settings: &ActiveSetSettings) -> Result<(Vec<f64>, Vec<f64>, ActiveSetReport), QpError> {
    let n = p.b.len();
    let mut projector = DenseProjector::new(p.rows, n, p.g.clone())?;
    let (mut set, data) = (p.set.clone(), (&p.b[..], &p.e[..]));
    let start = (true, &[][..]);
    let solved = from_zero(&p.a, &mut projector, MovingSet::fixed(&mut set), data, settings, start)?;
    let force = (0..n).map(|i| solved.residual[i] - (solved.ax[i] - p.b[i]));
    Ok((solved.x, force.collect(), solved.report))
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 200,
        failure_persistence: None,
        rng_seed: proptest::test_runner::RngSeed::Fixed(7),
        ..ProptestConfig::default()
    })]

    #[test]
    fn a_converged_set_is_the_minimiser(seed in 0u64..100_000) {
        let p = problem(seed);
        let (x, force, report) = solve(&p, &ActiveSetSettings::default().with_tolerance(1e-9)).expect("no breakdown");
        prop_assert_eq!(report.status, Status::Converged);
        prop_assert!(p.set.violation(&x) <= 1e-12);
        for i in 0..p.rows {
            let row = &p.g[i * x.len()..(i + 1) * x.len()];
            prop_assert!((vector::dot(row, &x) - p.e[i]).abs() <= 1e-10);
        }
        prop_assert!(natural_residual(&p.a, &p.b, &p.set, &x, &force) <= 1e-7 * (1.0 + vector::norm(&x)));
        prop_assert_eq!(report.products(), report.cg_steps + report.corrections);
    }
}

#[test]
fn a_problem_without_constraints_is_one_active_set_and_no_correction() {
    let mut r = Random::new(3);
    let (a, _) = spd(30, 1.0, &mut r);
    let n = 30;
    let p = Problem {
        a,
        b: r.vector(n),
        set: ProductSet::free(n),
        g: vec![],
        e: vec![],
        rows: 0,
    };
    let settings = ActiveSetSettings::default().with_forcing(1e-9).with_tolerance(1e-9);
    let (_, _, report) = solve(&p, &settings).expect("no breakdown");
    assert_eq!(
        (report.status, report.active_sets, report.hook_calls),
        (Status::Converged, 1, 1)
    );
    assert_eq!(report.corrections, 0);
    assert!(report.cg_steps <= n + 5);
}

/// An interval that the hook opens after the first set, which solved the problem with the closed one.
#[test]
fn an_interval_that_opens_is_entered() {
    let a = DenseOperator::new(2, vec![2.0, 0.0, 0.0, 2.0]).expect("symmetric");
    let mut set = ProductSet::new(vec![Segment::bounds(vec![0.0], vec![0.0]), Segment::Free(1)]).expect("a set");
    let mut hook = |_: &[f64], set: &mut ProductSet| {
        if let Ok((lower, upper)) = set.bounds_mut(0) {
            (lower[0], upper[0]) = (-1.0, 1.0);
        }
        true
    };
    let settings = ActiveSetSettings::default().with_tolerance(1e-10);
    for (pull, expected) in [(5.0, 1.0), (-5.0, -1.0), (1.0, 0.5)] {
        let data = (&[pull, 0.0][..], &[][..]);
        let solved = from_zero(
            &a,
            &mut no_equality(2),
            MovingSet::new(&mut set, &mut hook),
            data,
            &settings,
            (true, &[]),
        );
        let solved = solved.expect("no breakdown");
        assert_eq!(solved.report.status, Status::Converged);
        assert!((solved.x[0] - expected).abs() < 1e-10, "{pull}: {:?}", solved.x);
        if let Ok((lower, upper)) = set.bounds_mut(0) {
            (lower[0], upper[0]) = (0.0, 0.0);
        }
    }
}

#[test]
fn the_hook_follows_a_coupled_radius() {
    // one bound, one disc whose radius is half the bounded component: a scalar Coulomb law
    let a = DenseOperator::new(3, vec![2.0, 0.3, 0.0, 0.3, 2.0, 0.0, 0.0, 0.0, 2.0]).expect("symmetric");
    let mut set = ProductSet::new(vec![Segment::upper(vec![0.0]), Segment::discs(vec![0.0])]).expect("a set");
    let mut hook = |x: &[f64], set: &mut ProductSet| {
        if let Ok(radii) = set.radii_mut(1) {
            radii[0] = -0.5 * x[0];
        }
        true
    };
    let settings = ActiveSetSettings::default().with_tolerance(1e-10);
    let (mut projector, data) = (no_equality(3), (&[-2.0, 3.0, 0.0][..], &[][..]));
    let start = (true, &[][..]);
    let solved = from_zero(
        &a,
        &mut projector,
        MovingSet::new(&mut set, &mut hook),
        data,
        &settings,
        start,
    )
    .expect("no breakdown");
    let (x, report) = (solved.x, solved.report);
    assert_eq!(report.status, Status::Converged);
    // sliding: 2 x0 + 0.3 x1 = -2 and x1 = -x0 / 2
    let exact = -2.0 / (2.0 - 0.15);
    assert!(
        (x[0] - exact).abs() < 1e-8 && (x[1] + 0.5 * exact).abs() < 1e-8 && x[2].abs() < 1e-12,
        "{x:?}"
    );
}

#[test]
fn wrong_input_is_refused() {
    let p = problem(1);
    for settings in [
        ActiveSetSettings::default().with_tolerance(0.0),
        ActiveSetSettings::default().with_forcing(1.0),
        ActiveSetSettings::default().with_max_active_sets(0),
        ActiveSetSettings::default().with_max_products(0),
    ] {
        assert!(
            matches!(solve(&p, &settings), Err(QpError::Setting { .. })),
            "{settings:?}"
        );
    }
    let mut nan = problem(1);
    nan.b[0] = f64::NAN;
    assert!(matches!(
        solve(&nan, &ActiveSetSettings::default()),
        Err(QpError::Input { .. })
    ));
    let mut negative = problem(2);
    let n = negative.b.len();
    let entries = (0..n * n).map(|k| if k % (n + 1) == 0 { -1.0 } else { 0.0 }).collect();
    negative.a = DenseOperator::new(n, entries).expect("symmetric");
    assert!(matches!(
        solve(&negative, &ActiveSetSettings::default()),
        Err(QpError::Indefinite { .. })
    ));
}

/// The error names the scale, not the products that it spoils.
#[test]
fn a_scale_that_is_not_positive_is_refused() {
    let (a, identity) = (crate::common::pair(), Diagonal::new(vec![1.0; 2]).unwrap());
    for bad in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
        let problem = ActiveSetProblem {
            operator: &a,
            preconditioner: &identity,
            scale: &[1.0, bad],
            linear: &[1.0, -3.0],
            rhs: &[],
        };
        let mut set = ProductSet::new(vec![Segment::lower(vec![0.0; 2])]).expect("a set");
        let (mut x, mut ax) = ([0.0; 2], [0.0; 2]);
        let (mut projector, settings) = (no_equality(2), ActiveSetSettings::default());
        let mut work = ActiveSetWorkspace::new(&a, &identity);
        let (x, ax, known) = (&mut x[..], &mut ax[..], true);
        let (set, point) = (MovingSet::fixed(&mut set), ActiveSetPoint { x, ax, known });
        let found = active_set(&problem, &mut projector, set, point, &settings, &mut work);
        let what = "the scale";
        let expected = if bad.is_finite() {
            QpError::Scale { entry: 1, value: bad }
        } else {
            QpError::Input { what, entry: 1 }
        };
        assert_eq!(found.err(), Some(expected));
    }
}

/// A product that is known of other constrained components than those of the start needs one more, which a step shares.
#[test]
fn a_start_that_left_the_point_of_its_product_costs_one() {
    let mut products = [0; 2];
    for seed in 0..50 {
        let p = problem(seed);
        let n = p.b.len();
        let constrained = n - p.set.segments()[2].len();
        let identity = Diagonal::new(vec![1.0; n]).unwrap();
        let mut r = Random::new(seed);
        let settings = ActiveSetSettings::default().with_tolerance(1e-9);
        let (solution, _, _) = solve(&p, &settings).expect("no breakdown");
        let from: Vec<f64> = solution.iter().map(|x| x + 0.01 * r.real()).collect();
        for (known, products) in [true, false].into_iter().zip(&mut products) {
            let mut projector = DenseProjector::new(p.rows, n, p.g.clone()).expect("rows");
            let mut work = ActiveSetWorkspace::new(&p.a, &identity);
            let (mut x, mut ax) = (from.clone(), product(&p.a, &from));
            x[..constrained].copy_from_slice(&solution[..constrained]);
            if known {
                work.set_start(&from[..constrained], 0.5);
            }
            let dual = ActiveSetProblem {
                operator: &p.a,
                preconditioner: &identity,
                scale: &vec![1.0; n],
                linear: &p.b,
                rhs: &p.e,
            };
            let (mut set, point) = (
                p.set.clone(),
                ActiveSetPoint {
                    x: &mut x,
                    ax: &mut ax,
                    known,
                },
            );
            let set = MovingSet::fixed(&mut set);
            let report = active_set(&dual, &mut projector, set, point, &settings, &mut work);
            let report = report.expect("no breakdown");
            assert_eq!(report.status, Status::Converged);
            assert!(vector::distance(&x, &solution) < 1e-7, "{seed}");
            assert!(vector::distance(&ax, &product(&p.a, &x)) < 1e-9, "{seed}");
            *products += report.products();
        }
    }
    assert!(products[0] < products[1], "{products:?}");
}

#[test]
fn known_components_of_another_length_or_not_finite_are_refused() {
    let (a, identity) = (crate::common::pair(), Diagonal::new(vec![1.0; 2]).unwrap());
    let problem = ActiveSetProblem {
        operator: &a,
        preconditioner: &identity,
        scale: &[1.0; 2],
        linear: &[1.0, -3.0],
        rhs: &[],
    };
    for bad in [&[0.0; 3][..], &[0.0, f64::NAN]] {
        let mut set = ProductSet::new(vec![Segment::lower(vec![0.0; 2])]).expect("a set");
        let (mut x, mut ax) = ([0.0; 2], [0.0; 2]);
        let (mut projector, settings) = (no_equality(2), ActiveSetSettings::default());
        let mut work = ActiveSetWorkspace::new(&a, &identity);
        work.set_start(bad, 0.5);
        let (x, ax, known) = (&mut x[..], &mut ax[..], true);
        let (set, point) = (MovingSet::fixed(&mut set), ActiveSetPoint { x, ax, known });
        let found = active_set(&problem, &mut projector, set, point, &settings, &mut work);
        let found = found.expect_err("refused").to_string();
        assert!(found.contains("the known components"), "{found}");
    }
}

#[test]
fn a_limit_of_products_is_a_status() {
    let p = problem(5);
    let (_, _, report) = solve(&p, &ActiveSetSettings::default().with_max_products(2)).expect("no breakdown");
    assert_eq!(report.status, Status::IterationLimit);
}

/// `x0 + x1 = 3` in the unit square: no point, and no convergence.
#[test]
fn a_point_outside_the_set_is_no_solution() {
    let a = DenseOperator::new(2, vec![1.0, 0.0, 0.0, 1.0]).expect("operator");
    let mut projector = DenseProjector::new(1, 2, vec![1.0, 1.0]).expect("G");
    let mut set = ProductSet::new(vec![Segment::bounds(vec![0.0; 2], vec![1.0; 2])]).expect("set");
    let data = (&[0.0; 2][..], &[3.0][..]);
    let (settings, start) = (ActiveSetSettings::default(), (false, &[][..]));
    let solved = from_zero(&a, &mut projector, MovingSet::fixed(&mut set), data, &settings, start);
    assert!(solved.is_err() || solved.is_ok_and(|s| s.report.status != Status::Converged));
}

/// Radii that are 0.3 times other components, none of which is known at the start.
#[test]
fn the_set_has_followed_before_convergence() {
    let a = DenseOperator::new(9, (0..81).map(|k| f64::from(u8::from(k % 10 == 0))).collect()).expect("operator");
    let bounds = Segment::upper(vec![0.0; 3]);
    let mut set = ProductSet::new(vec![bounds, Segment::discs(vec![0.0; 3])]).expect("set");
    let linear = [-1.0, -2.0, -3.0, 1.0, 0.0, 2.0, 0.0, 3.0, 0.0];
    let mut hook = |x: &[f64], set: &mut ProductSet| {
        let radii = [0, 1, 2].map(|k: usize| 0.3 * x[k].abs());
        *set = ProductSet::new(vec![Segment::upper(vec![0.0; 3]), Segment::discs(radii.to_vec())]).expect("set");
        true
    };
    let (settings, start) = (ActiveSetSettings::default(), (false, &[][..]));
    let data = (&linear[..], &[][..]);
    let solved = from_zero(
        &a,
        &mut no_equality(9),
        MovingSet::new(&mut set, &mut hook),
        data,
        &settings,
        start,
    )
    .expect("a report");
    let (x, report) = (solved.x, solved.report);
    assert_eq!(report.status, Status::Converged);
    assert!(report.hook_calls > 0);
    for k in 0..3 {
        let friction = x[3 + 2 * k].hypot(x[4 + 2 * k]);
        assert!((friction - 0.3 * x[k].abs()).abs() < 1e-5, "{x:?}");
    }
}
