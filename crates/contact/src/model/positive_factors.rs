//! The round of least squares with non-negative factors (Lawson and Hanson) after a column has come in.

use crate::tolerances::{WRENCH_APART, WRENCH_FACTOR, WRENCH_RANK};
use nalgebra::{DMatrix, DVector};

/// Least squares over the columns in use with positive factors; columns that would get negative ones leave.
pub(super) fn improve(used: &mut Vec<Vec<f64>>, factors: &mut Vec<f64>, b: &[f64]) -> bool {
    loop {
        let count = used.len();
        if count == 0 {
            return false;
        }
        let a = DMatrix::from_fn(b.len(), count, |i, j| used[j][i]);
        let Some(solution) = least_squares(a, DVector::from_column_slice(b)) else {
            return false;
        };
        let mut step = 1.0_f64;
        for (new, old) in solution.iter().zip(factors.iter()) {
            if *new < 0.0 {
                step = step.min(old / (old - new));
            }
        }
        for (new, old) in solution.iter().zip(factors.iter_mut()) {
            *old += step * (new - *old);
        }
        if step >= 1.0 {
            return true;
        }
        let size = factors.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let keep: Vec<bool> = factors
            .iter()
            .zip(solution.iter())
            .map(|(f, new)| *new >= 0.0 || *f > WRENCH_FACTOR * size)
            .collect();
        if keep.iter().all(|k| *k) {
            return true;
        }
        let mut kept = keep.iter();
        used.retain(|_| kept.next() == Some(&true));
        let mut kept = keep.iter();
        factors.retain(|_| kept.next() == Some(&true));
    }
}

/// The `x` that makes `a x - b` least, the least one where columns depend on one another.
fn least_squares(a: DMatrix<f64>, mut b: DVector<f64>) -> Option<DVector<f64>> {
    // columns hardly ever depend on one another, and singular values take many times longer
    let n = a.ncols();
    if n <= a.nrows() {
        let qr = a.clone().qr();
        let r = qr.r();
        let sizes = r.diagonal().abs();
        if sizes.min() > WRENCH_APART * sizes.max() {
            qr.q_tr_mul(&mut b);
            let mut x = b.rows(0, n).into_owned();
            return r.solve_upper_triangular_mut(&mut x).then_some(x);
        }
    }
    let svd = a.svd(true, true);
    let cut = WRENCH_RANK * svd.singular_values.max();
    svd.solve(&b, cut).ok()
}
