//! Projected conjugate gradients against the saddle point conditions.

use crate::common::{self, Random};
use signorini_qp::problem::Identity;
use signorini_qp::{
    CgWorkspace, ConvexSet, DenseEquality, DenseOperator, Equality, ProductSet, QpError, Status, Tolerance,
    projected_cg, vector,
};

#[test]
fn satisfies_the_saddle_point_system_and_a_preconditioner_helps() {
    let mut r = Random::new(21);
    let n = 40;
    let (dense, _) = common::spd(n, 1.0, &mut r);
    // a badly scaled operator, and its diagonal as preconditioner
    let s: Vec<f64> = (0..n).map(|i| 10f64.powf(3.0 * i as f64 / n as f64)).collect();
    let entries = (0..n * n).map(|k| dense.entries()[k] * s[k / n] * s[k % n]).collect();
    let a = DenseOperator::new(n, entries).expect("symmetric");
    let diagonal = (0..n * n)
        .map(|k| if k / n == k % n { 1.0 / a.entries()[k] } else { 0.0 })
        .collect();
    let m = DenseOperator::new(n, diagonal).expect("symmetric");
    let (c, e) = common::equality(n, 4, &ProductSet::free(n), &mut r);
    let b = r.vector(n);
    let check = |x: &[f64], mu: &[f64], residual: &[f64]| {
        let mut cx = vec![0.0; 4];
        c.apply(x, &mut cx, &mut ());
        assert!(vector::distance(&cx, &e) < 1e-12);
        let mut g = common::product(&a, x);
        vector::subtract(&b, &mut g);
        assert!(vector::distance(&g, residual) < 1e-8);
        let mut t = vec![0.0; n];
        c.apply_transpose(mu, &mut t, &mut ());
        vector::axpy(1.0, &t, &mut g);
        assert!(vector::norm(&g) < 1e-7);
    };
    let t = Tolerance::Relative(1e-8);
    let mut x = r.vector(n);
    let mut y = x.clone();
    let mut plain = CgWorkspace::new(&a, &c, &Identity(n));
    let first = projected_cg(&a, &b, &c, &e, &Identity(n), t, 10_000, &mut x, &mut plain).expect("solve");
    let mut work = CgWorkspace::new(&a, &c, &m);
    let second = projected_cg(&a, &b, &c, &e, &m, t, 10_000, &mut y, &mut work).expect("solve");
    assert!(first.status.converged() && second.status.converged());
    check(&x, plain.equality_multiplier(), plain.residual());
    check(&y, work.equality_multiplier(), work.residual());
    assert!(
        2 * second.products < first.products,
        "{} {}",
        second.products,
        first.products
    );
    let limit = projected_cg(&a, &b, &c, &e, &Identity(n), t, 3, &mut [0.0; 40], &mut plain).expect("solve");
    assert_eq!((limit.status, limit.products), (Status::IterationLimit, 3));
}

#[test]
fn indefinite_and_misfitting_input_is_named() {
    let a = DenseOperator::new(2, vec![-1.0, 0.0, 0.0, -1.0]).expect("symmetric");
    let c = DenseEquality::orthonormal(1, 2, &[1.0, 0.0]).expect("row");
    let m = Identity(2);
    let mut work = CgWorkspace::new(&a, &c, &m);
    let t = Tolerance::Relative(1e-8);
    let run = |e: &[f64], work: &mut _| projected_cg(&a, &[1.0; 2], &c, e, &m, t, 10, &mut [0.0; 2], work);
    assert!(matches!(run(&[0.0], &mut work), Err(QpError::Indefinite { .. })));
    assert!(matches!(run(&[], &mut work), Err(QpError::Length { .. })));
    assert_eq!(ProductSet::free(2).dim(), 2);
}

/// A load that the equality takes alone, with `e = 0`: the solution is zero, and what the projector leaves is rounding.
#[test]
fn a_load_in_the_equality_is_solved_at_once() {
    let mut r = Random::new(5);
    let n = 60;
    let (a, _) = common::spd(n, 2.0, &mut r);
    let (c, _) = common::equality(n, 6, &ProductSet::free(n), &mut r);
    let (mut b, e) = (vec![0.0; n], vec![0.0; 6]);
    c.apply_transpose(&r.vector(6), &mut b, &mut ());
    let mut work = CgWorkspace::new(&a, &c, &Identity(n));
    let mut solve = |tolerance| {
        let mut x = vec![0.0; n];
        let m = Identity(n);
        let report = projected_cg(&a, &b, &c, &e, &m, tolerance, 100, &mut x, &mut work);
        (report.expect("solve"), vector::norm(&x))
    };
    let (report, size) = solve(Tolerance::Relative(1e-12));
    assert!(report.status.converged() && report.products <= 2, "{report:?}");
    assert!(size < 1e-13, "{size:e}");
    // who names a size gets it
    let (report, _) = solve(Tolerance::Absolute(1e-300));
    assert_eq!(report.tolerance, 1e-300);
}
