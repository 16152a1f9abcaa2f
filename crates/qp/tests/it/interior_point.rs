//! The same problems by an interior point method that shares no code with this crate.

use crate::common::{self, Quadratic, Random};
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};
use signorini_qp::kprgp::KprgpWorkspace;
use signorini_qp::{
    ConvexSet, DenseEquality, DenseOperator, Equality, KprgpSettings, ProductSet, QuadraticCost, Segment,
    SmalseSettings, kprgp, vector,
};

/// Row-by-row matrix `rows x n` in compressed columns.
fn csc(rows: &[Vec<f64>], n: usize) -> CscMatrix<f64> {
    let (mut colptr, mut rowval, mut nzval) = (vec![0], vec![], vec![]);
    for j in 0..n {
        for (i, row) in rows.iter().enumerate() {
            if row[j] != 0.0 {
                rowval.push(i);
                nzval.push(row[j]);
            }
        }
        colptr.push(rowval.len());
    }
    CscMatrix::new(rows.len(), n, colptr, rowval, nzval)
}

fn reference(a: &DenseOperator, b: &[f64], set: &ProductSet, equality: Option<(&DenseEquality, &[f64])>) -> Vec<f64> {
    let n = b.len();
    let unit = |i: usize, v: f64| {
        let mut row = vec![0.0; n];
        row[i] = v;
        row
    };
    let (mut rows, mut right, mut cones) = (Vec::new(), Vec::new(), Vec::new());
    if let Some((c, e)) = equality {
        for k in 0..c.rows() {
            let mut y = vec![0.0; c.rows()];
            y[k] = 1.0;
            let mut row = vec![0.0; n];
            c.apply_transpose(&y, &mut row, &mut ());
            rows.push(row);
            right.push(e[k]);
            cones.push(SupportedConeT::ZeroConeT(1));
        }
    }
    let mut at = 0;
    for segment in set.segments() {
        match segment {
            Segment::Bounds { lower, upper } => {
                for i in 0..lower.len() {
                    for (sign, bound) in [(-1.0, lower[i]), (1.0, upper[i])] {
                        if bound.is_finite() {
                            rows.push(unit(at + i, sign));
                            right.push(sign * bound);
                            cones.push(SupportedConeT::NonnegativeConeT(1));
                        }
                    }
                }
            }
            Segment::Discs { radii } => {
                for (i, &r) in radii.iter().enumerate() {
                    rows.push(vec![0.0; n]);
                    rows.push(unit(at + 2 * i, -1.0));
                    rows.push(unit(at + 2 * i + 1, -1.0));
                    right.extend([r, 0.0, 0.0]);
                    cones.push(SupportedConeT::SecondOrderConeT(3));
                }
            }
            _ => {}
        }
        at += segment.len();
    }
    let upper: Vec<Vec<f64>> = (0..n)
        .map(|i| {
            (0..n)
                .map(|j| if j >= i { a.entries()[i * n + j] } else { 0.0 })
                .collect()
        })
        .collect();
    let q: Vec<f64> = b.iter().map(|v| -v).collect();
    let settings = DefaultSettings {
        verbose: false,
        tol_gap_abs: 1e-11,
        tol_gap_rel: 1e-11,
        tol_feas: 1e-11,
        ..DefaultSettings::default()
    };
    let mut solver =
        DefaultSolver::new(&csc(&upper, n), &q, &csc(&rows, n), &right, &cones, settings).expect("clarabel");
    solver.solve();
    assert!(matches!(
        solver.solution.status,
        SolverStatus::Solved | SolverStatus::AlmostSolved
    ));
    solver.solution.x.clone()
}

fn nonempty_set(r: &mut Random) -> ProductSet {
    loop {
        let set = common::set(r);
        let constrained = set
            .segments()
            .iter()
            .any(|s| !matches!(s, Segment::Free(_)) && !s.is_empty());
        if set.dim() >= 6 && constrained {
            return set;
        }
    }
}

#[test]
fn bounds_and_discs_agree_with_clarabel() {
    for seed in 0..12 {
        let mut r = Random::new(seed);
        let set = nonempty_set(&mut r);
        let n = set.dim();
        let (a, norm) = common::spd(n, 1.5, &mut r);
        let b = r.vector(n);
        let mut x = vec![0.0; n];
        let mut work = KprgpWorkspace::new(&a);
        let t = 1e-10;
        let report = kprgp(
            &QuadraticCost::new(&a, &b, norm),
            &set,
            t,
            &KprgpSettings::default(),
            &mut x,
            &mut work,
        )
        .expect("solve");
        assert!(report.status.converged());
        let y = reference(&a, &b, &set, None);
        let gap = vector::distance(&x, &y) / vector::norm(&x).max(1.0);
        assert!(gap <= 1e-6, "seed {seed}: {gap:e}");
    }
}

#[test]
fn equalities_agree_with_clarabel() {
    for seed in 100..112 {
        let mut r = Random::new(seed);
        let set = nonempty_set(&mut r);
        let n = set.dim();
        let (a, _) = common::spd(n, 1.5, &mut r);
        let (c, e) = common::equality(n, 1 + n / 6, &set, &mut r);
        let mut p = Quadratic::new(a, r.vector(n), (c, e), set);
        let (mut x, mut beta) = (vec![0.0; n], vec![0.0; p.e.len()]);
        let settings = SmalseSettings::default()
            .with_tolerance(1e-10)
            .with_equality(1e-10)
            .with_max_outer(20_000)
            .with_inner(KprgpSettings::default().with_max_products(500_000));
        let (report, ..) = p.smalse(&settings, &mut |_, _| false, &mut x, &mut beta);
        assert!(report.status.converged(), "seed {seed}: {report:?}");
        let y = reference(&p.a, &p.b, &p.set, Some((&p.c, &p.e)));
        let gap = vector::distance(&x, &y) / vector::norm(&x).max(1.0);
        assert!(gap <= 1e-6, "seed {seed}: {gap:e}");
    }
}
