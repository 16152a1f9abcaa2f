//! Small dense operators, for problems that are given as matrices and for tests.

use crate::error::{QpError, expect_finite, expect_length};
use crate::tolerances::{ASYMMETRY, DEPENDENT_ROW};
use crate::vector;

use super::operator::{Equality, SymmetricOperator};

/// A symmetric matrix stored in full, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct DenseOperator {
    n: usize,
    a: Vec<f64>,
}

impl DenseOperator {
    /// The symmetric `n` by `n` matrix with entries `a[n * row + col]`.
    ///
    /// # Errors
    /// [`QpError`] for a wrong length, NaN, or entries that differ from their transposes by more than
    /// 1e-12 of the largest entry.
    pub fn new(n: usize, a: Vec<f64>) -> Result<Self, QpError> {
        expect_length("the matrix", a.len(), n.saturating_mul(n))?;
        expect_finite("the matrix", &a)?;
        let largest = vector::max_abs(&a);
        for row in 0..n {
            for col in 0..row {
                let difference = (a[n * row + col] - a[n * col + row]).abs();
                if difference > ASYMMETRY * largest {
                    return Err(QpError::NotSymmetric { row, col, difference });
                }
            }
        }
        Ok(Self { n, a })
    }

    /// Entries, row by row.
    #[must_use]
    pub fn entries(&self) -> &[f64] {
        &self.a
    }
}

impl SymmetricOperator for DenseOperator {
    type Scratch = ();
    fn dim(&self) -> usize {
        self.n
    }
    fn scratch(&self) -> Self::Scratch {}
    fn apply(&self, x: &[f64], y: &mut [f64], _s: &mut ()) {
        for (i, yi) in y.iter_mut().enumerate() {
            *yi = vector::dot(&self.a[i * self.n..(i + 1) * self.n], x);
        }
    }
}

/// A diagonal operator. With the inverses of the diagonal of `A` it is the simplest preconditioner, and its entries are
/// the [scale](crate::active_set::ActiveSetProblem::scale) of the active-set method.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagonal(Vec<f64>);

impl Diagonal {
    /// With these entries.
    ///
    /// # Errors
    /// [`QpError::Input`] for an entry that is not finite.
    pub fn new(entries: Vec<f64>) -> Result<Self, QpError> {
        expect_finite("the diagonal", &entries)?;
        Ok(Self(entries))
    }

    /// Its entries.
    #[must_use]
    pub fn entries(&self) -> &[f64] {
        &self.0
    }
}

impl SymmetricOperator for Diagonal {
    type Scratch = ();
    fn dim(&self) -> usize {
        self.0.len()
    }
    fn scratch(&self) -> Self::Scratch {}
    fn apply(&self, x: &[f64], y: &mut [f64], _s: &mut ()) {
        for (i, yi) in y.iter_mut().enumerate() {
            *yi = self.0[i] * x[i];
        }
    }
}

/// Equality constraints `G x = e` brought to orthonormal rows: `G = L C` with `L` lower triangular.
///
/// ```
/// use signorini_qp::{DenseEquality, Equality};
///
/// let g = DenseEquality::orthonormal(2, 3, &[1.0, 1.0, 1.0, 0.0, 2.0, 0.0])?;
/// // G x = (6, 4) has the same solutions as C x = right_side
/// let right_side = g.right_side(&[6.0, 4.0])?;
/// let mut cx = [0.0; 2];
/// g.apply(&[1.0, 2.0, 3.0], &mut cx, &mut ());
/// assert!((cx[0] - right_side[0]).abs() < 1e-14 && (cx[1] - right_side[1]).abs() < 1e-14);
/// # Ok::<(), signorini_qp::QpError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct DenseEquality {
    rows: usize,
    n: usize,
    c: Vec<f64>,
    l: Vec<f64>,
}

impl DenseEquality {
    /// Makes the rows of `G` (entries `g[n * row + col]`) orthonormal by Gram-Schmidt, done twice.
    ///
    /// # Errors
    /// [`QpError::DependentRow`] naming the first row that depends on those before it (a zero row
    /// included); wrong length; NaN.
    pub fn orthonormal(rows: usize, n: usize, g: &[f64]) -> Result<Self, QpError> {
        expect_length("the equality matrix", g.len(), rows.saturating_mul(n))?;
        expect_finite("the equality matrix", g)?;
        if n < rows {
            return Err(QpError::DependentRow { row: n, remainder: 0.0 });
        }
        let mut c = g.to_vec();
        let mut l = vec![0.0; rows * rows];
        for row in 0..rows {
            let (before, rest) = c.split_at_mut(row * n);
            let current = &mut rest[..n];
            let length = vector::norm(current);
            for _ in 0..2 {
                for k in 0..row {
                    let q = &before[k * n..(k + 1) * n];
                    let s = vector::dot(q, current);
                    vector::axpy(-s, q, current);
                    l[row * rows + k] += s;
                }
            }
            let left = vector::norm(current);
            if left <= DEPENDENT_ROW * length {
                let remainder = if length > 0.0 { left / length } else { 0.0 };
                return Err(QpError::DependentRow { row, remainder });
            }
            vector::scale(1.0 / left, current);
            l[row * rows + row] = left;
        }
        Ok(Self { rows, n, c, l })
    }

    /// Right side of the orthonormal rows: `L⁻¹ e`.
    ///
    /// # Errors
    /// [`QpError::Length`] if `e` has not one entry a row.
    pub fn right_side(&self, e: &[f64]) -> Result<Vec<f64>, QpError> {
        expect_length("the right side e", e.len(), self.rows)?;
        let mut y = e.to_vec();
        for i in 0..self.rows {
            let row = &self.l[i * self.rows..];
            let known = vector::dot(&row[..i], &y[..i]);
            y[i] = (y[i] - known) / row[i];
        }
        Ok(y)
    }

    /// Multiplier of the original rows from that of the orthonormal ones: `L⁻ᵀ mu`.
    ///
    /// # Errors
    /// [`QpError::Length`] if `mu` has not one entry a row.
    pub fn original_multiplier(&self, mu: &[f64]) -> Result<Vec<f64>, QpError> {
        expect_length("the multiplier", mu.len(), self.rows)?;
        let mut y = mu.to_vec();
        for i in (0..self.rows).rev() {
            for k in i + 1..self.rows {
                y[i] -= self.l[k * self.rows + i] * y[k];
            }
            y[i] /= self.l[i * self.rows + i];
        }
        Ok(y)
    }
}

impl Equality for DenseEquality {
    type Scratch = ();
    fn dim(&self) -> usize {
        self.n
    }
    fn rows(&self) -> usize {
        self.rows
    }
    fn scratch(&self) -> Self::Scratch {}
    fn apply(&self, x: &[f64], y: &mut [f64], _s: &mut ()) {
        for (i, yi) in y.iter_mut().enumerate() {
            *yi = vector::dot(&self.c[i * self.n..(i + 1) * self.n], x);
        }
    }
    fn apply_transpose(&self, y: &[f64], x: &mut [f64], _s: &mut ()) {
        vector::fill(0.0, x);
        for (i, &yi) in y.iter().enumerate() {
            vector::axpy(yi, &self.c[i * self.n..(i + 1) * self.n], x);
        }
    }
}

/// `y = (L Lᵀ)⁻¹ y`, the lower triangle `l` by rows of length `n`.
pub(crate) fn solve_cholesky(n: usize, l: &[f64], y: &mut [f64]) {
    for i in 0..n {
        let sum: f64 = (0..i).map(|j| l[i * n + j] * y[j]).sum();
        y[i] = (y[i] - sum) / l[i * n + i];
    }
    for i in (0..n).rev() {
        let sum: f64 = (i + 1..n).map(|j| l[j * n + i] * y[j]).sum();
        y[i] = (y[i] - sum) / l[i * n + i];
    }
}
