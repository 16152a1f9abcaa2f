//! Dense kernels. The only file that names the dense part of the linear algebra library.
//!
//! Matrices are column-major slices without padding. Everything runs on the calling thread; parallel loops are the
//! caller's, so that results do not depend on the number of threads.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt;
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::mat::{MatMut, MatRef};
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{Accum, Par};

/// `out = a b` for `a` of shape `m x k` and `b` of shape `k x n`.
pub(crate) fn multiply(out: &mut [f64], a: &[f64], b: &[f64], m: usize, k: usize, n: usize) {
    if m == 0 || n == 0 {
        return;
    }
    if k == 0 {
        out[..m * n].fill(0.0);
        return;
    }
    matmul(
        MatMut::from_column_major_slice_mut(&mut out[..m * n], m, n),
        Accum::Replace,
        MatRef::from_column_major_slice(&a[..m * k], m, k),
        MatRef::from_column_major_slice(&b[..k * n], k, n),
        1.0,
        Par::Seq,
    );
}

/// `out += factor a b^T` for `a` of shape `m x k` and `b` of shape `n x k`.
pub(crate) fn add_product_transposed(out: &mut [f64], factor: f64, a: &[f64], b: &[f64], m: usize, k: usize, n: usize) {
    if m == 0 || n == 0 || k == 0 {
        return;
    }
    matmul(
        MatMut::from_column_major_slice_mut(&mut out[..m * n], m, n),
        Accum::Add,
        MatRef::from_column_major_slice(&a[..m * k], m, k),
        MatRef::from_column_major_slice(&b[..k * n], n, k).transpose(),
        factor,
        Par::Seq,
    );
}

/// Replaces the lower triangle of the symmetric `a` by its Cholesky factor. `Err(pivot)` if `a` is not positive
/// definite to working precision: a pivot at or below `threshold`.
pub(crate) fn cholesky(a: &mut [f64], n: usize, threshold: f64) -> Result<(), usize> {
    cholesky_columns(a, n, n, threshold)
}

/// Replaces the first `width` columns of a symmetric matrix of `height` rows, lower triangle, by those of its Cholesky
/// factor. `Err(pivot)` as in [`cholesky`].
pub(crate) fn cholesky_columns(a: &mut [f64], height: usize, width: usize, threshold: f64) -> Result<(), usize> {
    if width == 0 {
        return Ok(());
    }
    let params = Default::default();
    let mut memory = MemBuffer::new(llt::factor::cholesky_in_place_scratch::<f64>(width, Par::Seq, params));
    let columns = MatMut::from_column_major_slice_mut(&mut a[..height * width], height, width);
    let (mut triangle, below) = columns.split_at_row_mut(width);
    llt::factor::cholesky_in_place(
        triangle.rb_mut(),
        Default::default(),
        Par::Seq,
        MemStack::new(&mut memory),
        params,
    )
    .map_err(|error| match error {
        llt::factor::LltError::NonPositivePivot { index } => index,
    })?;
    for j in 0..width {
        let pivot = triangle[(j, j)] * triangle[(j, j)];
        if pivot.is_nan() || pivot <= threshold {
            return Err(j);
        }
    }
    if height > width {
        solve_lower_triangular_in_place(triangle.rb(), below.transpose_mut(), Par::Seq);
    }
    Ok(())
}

/// Subtracts from the lower triangle of `out` what the elimination of the columns of [`cholesky_columns`] does to the
/// unknowns behind them.
pub(crate) fn subtract_columns(out: &mut [f64], a: &[f64], height: usize, width: usize) {
    let behind = height - width;
    if behind == 0 || width == 0 {
        return;
    }
    let columns = MatRef::from_column_major_slice(&a[..height * width], height, width);
    let below = columns.split_at_row(width).1;
    triangular::matmul(
        MatMut::from_column_major_slice_mut(&mut out[..behind * behind], behind, behind),
        BlockStructure::TriangularLower,
        Accum::Add,
        below,
        BlockStructure::Rectangular,
        below.transpose(),
        BlockStructure::Rectangular,
        -1.0,
        Par::Seq,
    );
}

/// `L^-1 x` in the rows of the columns that [`cholesky_columns`] left of `L`, less what they do to those behind.
pub(crate) fn forward(a: &[f64], height: usize, width: usize, x: &mut [f64]) {
    let (triangle, below) = MatRef::from_column_major_slice(&a[..height * width], height, width).split_at_row(width);
    let (mut own, behind) = MatMut::from_column_major_slice_mut(&mut x[..height], height, 1).split_at_row_mut(width);
    solve_lower_triangular_in_place(triangle, own.rb_mut(), Par::Seq);
    matmul(behind, Accum::Add, below, own.rb(), -1.0, Par::Seq);
}

/// `L^-T x` likewise, from what is known in the rows behind.
pub(crate) fn backward(a: &[f64], height: usize, width: usize, x: &mut [f64]) {
    let (triangle, below) = MatRef::from_column_major_slice(&a[..height * width], height, width).split_at_row(width);
    let (mut own, behind) = MatMut::from_column_major_slice_mut(&mut x[..height], height, 1).split_at_row_mut(width);
    matmul(own.rb_mut(), Accum::Add, below.transpose(), behind.rb(), -1.0, Par::Seq);
    solve_upper_triangular_in_place(triangle.transpose(), own, Par::Seq);
}

/// Inverse of a symmetric positive definite matrix in both triangles. `Err(pivot)` as in [`cholesky`].
pub(crate) fn inverse(mut a: Vec<f64>, n: usize, threshold: f64) -> Result<Vec<f64>, usize> {
    cholesky(&mut a, n, threshold)?;
    let mut out = vec![0.0; n * n];
    if n == 0 {
        return Ok(out);
    }
    let mut memory = MemBuffer::new(llt::inverse::inverse_scratch::<f64>(n, Par::Seq));
    llt::inverse::inverse(
        MatMut::from_column_major_slice_mut(&mut out, n, n),
        MatRef::from_column_major_slice(&a, n, n),
        Par::Seq,
        MemStack::new(&mut memory),
    );
    mirror_lower(&mut out, n);
    Ok(out)
}

/// Copies the lower triangle to the upper one, in tiles that stay in cache.
pub(crate) fn mirror_lower(a: &mut [f64], n: usize) {
    const TILE: usize = 32;
    for column in (0..n).step_by(TILE) {
        for row in (column..n).step_by(TILE) {
            for j in column..(column + TILE).min(n) {
                for i in row.max(j + 1)..(row + TILE).min(n) {
                    a[j + i * n] = a[i + j * n];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_times_matrix_is_identity() {
        let n = 37;
        let mut a = vec![0.0; n * n];
        for i in 0..n {
            for j in 0..n {
                a[i + j * n] = 1.0 / (1.0 + i.abs_diff(j) as f64) + if i == j { 2.0 } else { 0.0 };
            }
        }
        let inverse = inverse(a.clone(), n, 0.0).unwrap();
        let mut product = vec![0.0; n * n];
        multiply(&mut product, &a, &inverse, n, n, n);
        for i in 0..n {
            for j in 0..n {
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((product[i + j * n] - expected).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn singular_matrix_names_its_pivot() {
        let a = vec![1.0, 1.0, 1.0, 1.0];
        assert_eq!(inverse(a, 2, 1e-13), Err(1));
    }
}
