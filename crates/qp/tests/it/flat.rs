//! Operators without curvature along some directions: what runs away along them is told as unbounded, not as solved.

use signorini_qp::{
    ActiveSetSettings, DenseEquality, DenseOperator, DenseProjector, MovingSet, ProductSet, QpError, QuadraticCost,
    Segment, SmalseSettings, Status, kkt, vector,
};

use crate::common::{Quadratic, Random, Solved, from_zero, product};

/// Of this rank and a norm of about one, with a load that is no product of the operator.
fn singular(n: usize, rank: usize, r: &mut Random) -> (DenseOperator, Vec<f64>) {
    let mut a = vec![0.0; n * n];
    for k in 0..rank {
        let v = r.vector(n);
        for i in 0..n {
            for j in 0..n {
                a[i * n + j] += v[i] * v[j] / (n as f64 * (1.0 + k as f64));
            }
        }
    }
    (DenseOperator::new(n, a).expect("symmetric"), r.vector(n))
}

fn solve(a: &DenseOperator, b: &[f64], set: ProductSet) -> Result<Solved, QpError> {
    solve_on(a, b, set, (0, Vec::new()))
}

/// With `G x = 0`.
fn solve_on(
    a: &DenseOperator,
    b: &[f64],
    mut set: ProductSet,
    (rows, g): (usize, Vec<f64>),
) -> Result<Solved, QpError> {
    let mut projector = DenseProjector::new(rows, b.len(), g)?;
    let e = vec![0.0; rows];
    let (data, start) = ((b, &e[..]), (false, &[][..]));
    let settings = ActiveSetSettings::default();
    from_zero(a, &mut projector, MovingSet::fixed(&mut set), data, &settings, start)
}

#[test]
fn a_load_that_works_along_the_kernel_is_told() {
    for seed in 0..60 {
        let mut r = Random::new(seed);
        let (n, rows) = (3 + r.below(6), r.below(2));
        let (a, b) = singular(n, n - 1 - rows - r.below(2), &mut r);
        let g = r.vector(rows * n);
        let on = |b: &[f64]| solve_on(&a, b, ProductSet::free(n), (rows, g.clone()));
        let solved = on(&b);
        assert!(matches!(solved, Err(QpError::Unbounded { .. })), "seed {seed}");
        // a load that is a product has solutions
        let solved = on(&product(&a, &r.vector(n))).expect("solve");
        assert_eq!(solved.report.status, Status::Converged, "seed {seed}");
    }
}

#[test]
fn active_sets_tell_it_and_find_the_boundary_where_there_is_one() {
    let mut unbounded = 0;
    for seed in 0..120 {
        let mut r = Random::new(seed);
        let n = 1 + r.below(8);
        let (a, b) = singular(n, r.below(n), &mut r);
        let boxed = ProductSet::new(vec![Segment::bounds(vec![-1.0; n], vec![1.0; n])]).expect("set");
        let Solved { x, report, .. } = solve(&a, &b, boxed.clone()).expect("solve");
        assert_eq!(report.status, Status::Converged, "seed {seed}");
        let left = kkt::check(&QuadraticCost::new(&a, &b, 1.0), &boxed, &x)
            .expect("check")
            .relative();
        assert!(left < 1e-4, "seed {seed}: {left:e}");
        let open = ProductSet::new(vec![Segment::lower(vec![-1.0; n])]).expect("set");
        match solve(&a, &b, open.clone()) {
            Ok(Solved { x, report, .. }) => match report.status {
                Status::Converged => {
                    let left = kkt::check(&QuadraticCost::new(&a, &b, 1.0), &open, &x)
                        .expect("check")
                        .relative();
                    assert!(left < 1e-2, "seed {seed}: {left:e}, {x:?}");
                }
                Status::Stagnated | Status::IterationLimit => {}
                other => panic!("seed {seed}: {other:?}"),
            },
            Err(QpError::Unbounded { .. }) => unbounded += 1,
            Err(other) => panic!("seed {seed}: {other}"),
        }
    }
    assert!(unbounded > 30, "{unbounded}");
}

/// Neither a load nor an equality: the set alone moves `x` from zero.
#[test]
fn smalse_needs_no_load() {
    let mut r = Random::new(3);
    let (n, set) = (
        6,
        ProductSet::new(vec![Segment::lower(vec![0.5; 3]), Segment::Free(3)]).expect("set"),
    );
    let (a, _) = crate::common::spd(n, 1.5, &mut r);
    let c = DenseEquality::orthonormal(0, n, &[]).expect("no rows");
    let mut problem = Quadratic::new(a, vec![0.0; n], (c, Vec::new()), set);
    let (mut x, settings) = (vec![0.0; n], SmalseSettings::default());
    let (report, ..) = problem.smalse(&settings, &mut |_, _| false, &mut x, &mut []);
    assert!(report.status.converged(), "{report:?}");
    assert!(vector::norm(&x) > 0.8, "{x:?}");
}
