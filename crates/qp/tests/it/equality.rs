//! Equalities alone, by the active-set method, against the saddle point conditions.

use crate::common::{self, Random, from_zero};
use signorini_qp::active_set::{ActiveSetPoint, ActiveSetProblem, ActiveSetWorkspace};
use signorini_qp::problem::Diagonal;
use signorini_qp::{ActiveSetSettings, DenseOperator, DenseProjector, MovingSet, ProductSet, active_set, vector};

fn times(g: &[f64], x: &[f64]) -> Vec<f64> {
    g.chunks_exact(x.len()).map(|row| vector::dot(row, x)).collect()
}

#[test]
fn satisfies_the_saddle_point_system_and_a_preconditioner_helps() {
    let mut r = Random::new(21);
    let n = 40;
    let (dense, _) = common::spd(n, 1.0, &mut r);
    // a badly scaled operator, and its diagonal as preconditioner
    let s: Vec<f64> = (0..n).map(|i| 10f64.powf(3.0 * i as f64 / n as f64)).collect();
    let entries = (0..n * n).map(|k| dense.entries()[k] * s[k / n] * s[k % n]).collect();
    let a = DenseOperator::new(n, entries).expect("symmetric");
    let (g, e, b) = (r.vector(4 * n), r.vector(4), r.vector(n));
    let inverse = (0..n).map(|k| 1.0 / a.entries()[k * (n + 1)]).collect();
    let products = [vec![1.0; n], inverse].map(|diagonal| {
        let m = Diagonal::new(diagonal).expect("finite");
        let mut projector = DenseProjector::new(4, n, g.clone()).expect("rows");
        let mut work = ActiveSetWorkspace::new(&a, &m);
        let problem = ActiveSetProblem {
            operator: &a,
            preconditioner: &m,
            scale: m.entries(),
            linear: &b,
            rhs: &e,
        };
        let (mut x, mut ax) = (vec![0.0; n], vec![0.0; n]);
        let settings = ActiveSetSettings::default().with_tolerance(1e-9);
        let mut set = ProductSet::free(n);
        let (set, point) = (
            MovingSet::fixed(&mut set),
            ActiveSetPoint {
                x: &mut x,
                ax: &mut ax,
                known: false,
            },
        );
        let report = active_set(&problem, &mut projector, set, point, &settings, &mut work);
        let report = report.expect("solve");
        assert!(report.status.converged());
        assert!(vector::distance(&times(&g, &x), &e) < 1e-12);
        // A x - b + G' mu
        let mut gradient = common::product(&a, &x);
        vector::subtract(&b, &mut gradient);
        let mut left = work.residual().to_vec();
        assert!(vector::norm(&left) < 1e-6 * vector::norm(&gradient).max(1.0));
        vector::subtract(&gradient, &mut left);
        // what the residual leaves of it is in the image of G'
        let mut orthogonal = r.vector(n);
        let mut equality = DenseProjector::new(4, n, g.clone()).expect("rows");
        signorini_qp::EqualityProjector::project(&mut equality, &mut orthogonal);
        assert!(vector::dot(&orthogonal, &left).abs() < 1e-9 * vector::norm(&gradient));
        report.products()
    });
    assert!(2 * products[1] < products[0], "{products:?}");
}

/// A load that the equality takes alone: the solution is zero, and what the projector leaves is rounding.
#[test]
fn a_load_in_the_equality_is_solved_at_once() {
    let mut r = Random::new(5);
    let n = 60;
    let (a, _) = common::spd(n, 2.0, &mut r);
    let (g, y) = (r.vector(6 * n), r.vector(6));
    let b: Vec<f64> = (0..n).map(|k| (0..6).map(|i| g[i * n + k] * y[i]).sum()).collect();
    let mut projector = DenseProjector::new(6, n, g).expect("rows");
    let settings = ActiveSetSettings::default().with_tolerance(1e-12).with_error_floor(1.0);
    let (data, start) = ((&b[..], &[0.0; 6][..]), (false, &[][..]));
    let set = &mut ProductSet::free(n);
    let solved = from_zero(&a, &mut projector, MovingSet::fixed(set), data, &settings, start).expect("solve");
    assert!(solved.report.status.converged() && solved.report.products() <= 2);
    assert!(vector::norm(&solved.x) < 1e-13);
}

/// Rows of different units, as balances of forces and of moments are, in any order.
#[test]
fn rows_of_any_size_are_independent() {
    for [first, second] in [[1e7, 1.0], [1.0, 1e7]] {
        let mut projector = DenseProjector::new(2, 2, vec![first, 0.0, 0.0, second]).expect("rows");
        let mut x = [1.0, 2.0];
        signorini_qp::EqualityProjector::project(&mut projector, &mut x);
        assert_eq!(x, [0.0; 2]);
    }
    let same = DenseProjector::new(2, 2, vec![1.0, 1.0, 1e7, 1e7]).err();
    assert!(
        matches!(same, Some(signorini_qp::QpError::CoarseDeficient { .. })),
        "{same:?}"
    );
}
