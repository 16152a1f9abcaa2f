//! Dense kernels. The only file that names the dense part of the linear algebra library.
//!
//! Matrices are column-major slices without padding. Everything but the elimination of large fronts runs on the calling
//! thread; these are split by their size alone, so that results do not depend on the number of threads.

use crate::tolerances::PART;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt;
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::mat::{MatMut, MatRef};
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{Accum, Par};
use rayon::prelude::*;

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
    let columns = MatMut::from_column_major_slice_mut(&mut a[..height * width], height, width);
    let (mut triangle, below) = columns.split_at_row_mut(width);
    factor(triangle.rb_mut(), threshold)?;
    if height > width {
        solve_lower_triangular_in_place(triangle.rb(), below.transpose_mut(), Par::Seq);
    }
    Ok(())
}

/// Cholesky's factor in place of a lower triangle.
fn factor(mut triangle: MatMut<'_, f64>, threshold: f64) -> Result<(), usize> {
    let (size, params) = (triangle.nrows(), Default::default());
    let mut memory = MemBuffer::new(llt::factor::cholesky_in_place_scratch::<f64>(size, Par::Seq, params));
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
    let pivots = (0..size).map(|j| triangle[(j, j)] * triangle[(j, j)]);
    match pivots
        .enumerate()
        .find(|(_, pivot)| pivot.is_nan() || *pivot <= threshold)
    {
        Some((j, _)) => Err(j),
        None => Ok(()),
    }
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

/// [`cholesky_columns`] and [`subtract_columns`] for large matrices: parts of columns on several threads. Above the
/// diagonal of a part there may be anything.
pub(crate) fn eliminate_in_parts(
    a: &mut [f64],
    out: &mut [f64],
    [height, width]: [usize; 2],
    threshold: f64,
) -> Result<(), usize> {
    let behind = height - width;
    for start in (0..width).step_by(PART) {
        let count = PART.min(width - start);
        let (own, later) = a[start * height..width * height].split_at_mut(count * height);
        let columns = MatMut::from_column_major_slice_mut(own, height, count)
            .split_at_row_mut(start)
            .1;
        let (mut triangle, below) = columns.split_at_row_mut(count);
        factor(triangle.rb_mut(), threshold).map_err(|pivot| start + pivot)?;
        solve_rows(triangle.rb(), below);
        let own = MatRef::from_column_major_slice(own, height, count);
        let parts = later.par_chunks_mut(PART * height).enumerate();
        parts.for_each(|(k, part)| add_part(part, -1.0, own, height, start + count + k * PART));
    }
    let all = MatRef::from_column_major_slice(&a[..height * width], height, width);
    add_square_in_parts(&mut out[..behind * behind], -1.0, all.split_at_row(width).1);
    Ok(())
}

/// Adds `factor a a^T` to the lower triangle of `out`, on several threads, for `a` of shape `n x k`.
pub(crate) fn add_square(out: &mut [f64], factor: f64, a: &[f64], n: usize, k: usize) {
    add_square_in_parts(
        &mut out[..n * n],
        factor,
        MatRef::from_column_major_slice(&a[..n * k], n, k),
    );
}

fn add_square_in_parts(out: &mut [f64], factor: f64, a: MatRef<'_, f64>) {
    let parts = out.par_chunks_mut((PART * a.nrows()).max(1)).enumerate();
    parts.for_each(|(k, part)| add_part(part, factor, a, a.nrows(), k * PART));
}

/// Adds `factor a a^T` to some of its columns, from row `first` on, which is that of the first of them.
fn add_part(columns: &mut [f64], factor: f64, a: MatRef<'_, f64>, height: usize, first: usize) {
    let count = columns.len() / height;
    let out = MatMut::from_column_major_slice_mut(columns, height, count)
        .split_at_row_mut(first)
        .1;
    let rows = a.split_at_row(first).1;
    matmul(
        out,
        Accum::Add,
        rows,
        rows.split_at_row(count).0.transpose(),
        factor,
        Par::Seq,
    );
}

/// `below L^-T`, rows in parts.
fn solve_rows(triangle: MatRef<'_, f64>, below: MatMut<'_, f64>) {
    if below.nrows() <= PART {
        if below.nrows() > 0 {
            solve_lower_triangular_in_place(triangle, below.transpose_mut(), Par::Seq);
        }
        return;
    }
    let half = PART * (below.nrows().div_ceil(PART) / 2);
    let (first, second) = below.split_at_row_mut(half);
    rayon::join(|| solve_rows(triangle, first), || solve_rows(triangle, second));
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

    /// Elimination in parts is that of the whole, and its numbers are the same on any number of threads.
    #[test]
    fn parts_of_a_front_make_the_whole() {
        for (height, width) in [(700, 500), (450, 450), (900, 193), (130, 100)] {
            let behind = height - width;
            let entry = |i: usize, j: usize| ((i * j) as f64).sin() + if i == j { 2.0 * height as f64 } else { 0.0 };
            let symmetric = |i: usize, j: usize| entry(i.max(j), i.min(j));
            let matrix = |rows: usize, columns: usize, first: usize| -> Vec<f64> {
                let places = (0..columns).flat_map(|j| (0..rows).map(move |i| (i, j)));
                places.map(|(i, j)| symmetric(first + i, first + j)).collect()
            };
            let (mut a, mut out) = (matrix(height, width, 0), matrix(behind, behind, width));
            cholesky_columns(&mut a, height, width, 0.0).unwrap();
            subtract_columns(&mut out, &a, height, width);
            let lower = |v: &[f64], rows: usize, columns: usize| -> Vec<f64> {
                (0..columns)
                    .flat_map(|j| v[j * rows + j..(j + 1) * rows].to_vec())
                    .collect()
            };
            let in_parts = |threads: usize| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let (mut a, mut out) = (matrix(height, width, 0), matrix(behind, behind, width));
                pool.install(|| eliminate_in_parts(&mut a, &mut out, [height, width], 0.0))
                    .unwrap();
                [lower(&a, height, width), lower(&out, behind, behind)].concat()
            };
            let expected = [lower(&a, height, width), lower(&out, behind, behind)].concat();
            let parts = in_parts(1);
            for (e, p) in expected.iter().zip(&parts) {
                assert!((e - p).abs() < 1e-12 * height as f64, "{e} {p}");
            }
            assert_eq!(parts, in_parts(3));
        }
        let mut a = vec![1.0; 600 * 600];
        assert_eq!(eliminate_in_parts(&mut a, &mut [], [600, 600], 1e-9), Err(1));
        for j in 0..400 {
            a[601 * j] = 1e4;
        }
        a[601 * 400] = -1.0;
        assert_eq!(eliminate_in_parts(&mut a, &mut [], [600, 600], 1e-9), Err(400));
    }

    #[test]
    fn singular_matrix_names_its_pivot() {
        let a = vec![1.0, 1.0, 1.0, 1.0];
        assert_eq!(inverse(a, 2, 1e-13), Err(1));
    }
}
