//! A small dense equality `G x = e` for the active-set method.

use crate::error::{QpError, expect_finite, expect_length};
use crate::settings::expect_setting;
use crate::tolerances::SINGULAR_PIVOT;

use super::dense::solve_cholesky;
use super::projector::EqualityProjector;

/// [`EqualityProjector`] of a dense matrix with few rows: `G W Gᵀ` is factored by Cholesky at every change of weights.
///
/// Unconstrained components ([`Segment::Free`](crate::Segment)) should determine the multiplier, so that `G` has full
/// rank on them alone: of 6,296 random problems all are solved then. Where constrained components have to, one in five
/// ends as [`Status::Stagnated`](crate::Status::Stagnated), and [`smalse`](crate::smalse()) is the better method.
///
/// ```
/// use signorini_qp::{EqualityProjector, DenseProjector};
///
/// let mut projector = DenseProjector::new(1, 3, vec![1.0, 1.0, 1.0])?;
/// let mut x = vec![1.0, 2.0, 6.0];
/// projector.set_weights(&[1.0, 1.0, 0.0])?; // the last component is active
/// projector.project(&mut x);
/// assert_eq!(x, [-3.5, -2.5, 6.0]);
/// # Ok::<(), signorini_qp::QpError>(())
/// ```
#[derive(Debug, Clone)]
pub struct DenseProjector {
    rows: usize,
    dim: usize,
    /// By rows.
    g: Vec<f64>,
    w: Vec<f64>,
    /// Lower triangle of the factor of `G W Gᵀ`, by rows.
    factor: Vec<f64>,
    /// Takes the next factor, which takes the place of the last one once it is whole.
    next: Vec<f64>,
    small: Vec<f64>,
}

/// A row that depends on those before it.
fn deficient(row: usize) -> QpError {
    QpError::CoarseDeficient {
        motion: format!("row {row} of G"),
    }
}

impl DenseProjector {
    /// From the rows of `G`, one after another; all weights are one.
    ///
    /// # Errors
    /// [`QpError::Length`], [`QpError::Input`] for NaN, [`QpError::CoarseDeficient`] for dependent rows,
    /// [`QpError::Setting`] for a dimension that is too large, and later for negative weights.
    pub fn new(rows: usize, dim: usize, g: Vec<f64>) -> Result<Self, QpError> {
        expect_length("the matrix G", g.len(), rows.saturating_mul(dim))?;
        expect_finite("the matrix G", &g)?;
        if dim < rows {
            return Err(deficient(dim));
        }
        let mut ones = Vec::new();
        if ones.try_reserve_exact(dim).is_err() {
            let (name, value, range) = ("dimension", dim as f64, "of vectors that fit into the memory");
            return Err(QpError::Setting { name, value, range });
        }
        ones.resize(dim, 1.0);
        let mut own = Self {
            rows,
            dim,
            g,
            w: Vec::new(),
            factor: vec![0.0; rows * rows],
            next: vec![0.0; rows * rows],
            small: vec![0.0; rows],
        };
        own.set_weights(&ones)?;
        Ok(own)
    }

    fn row(&self, i: usize) -> &[f64] {
        &self.g[i * self.dim..(i + 1) * self.dim]
    }

    /// `out += s * W Gᵀ y` or without `W`.
    fn add_transpose(&self, s: f64, y: &[f64], weighted: bool, out: &mut [f64]) {
        for (i, yi) in y.iter().enumerate() {
            for ((o, g), w) in out.iter_mut().zip(self.row(i)).zip(&self.w) {
                *o += s * yi * g * if weighted { *w } else { 1.0 };
            }
        }
    }

    fn times(&self, x: &[f64], weighted: bool, out: &mut [f64]) {
        for (i, o) in out.iter_mut().enumerate() {
            let terms = self.row(i).iter().zip(x).zip(&self.w);
            *o = terms.map(|((g, x), w)| g * x * if weighted { *w } else { 1.0 }).sum();
        }
    }

    /// `x -= W Gᵀ (G W Gᵀ)⁻¹ defect(x)`, or without the first `W`.
    fn subtract(&mut self, weighted: bool, x: &mut [f64], defect: impl FnOnce(&Self, &[f64], &mut [f64])) {
        let mut small = std::mem::take(&mut self.small);
        defect(self, x, &mut small);
        solve_cholesky(self.rows, &self.factor, &mut small);
        self.add_transpose(-1.0, &small, weighted, x);
        self.small = small;
    }
}

impl EqualityProjector for DenseProjector {
    fn dim(&self) -> usize {
        self.dim
    }

    fn rows(&self) -> usize {
        self.rows
    }

    fn set_weights(&mut self, w: &[f64]) -> Result<bool, QpError> {
        expect_length("the weights", w.len(), self.dim)?;
        expect_finite("the weights", w)?;
        let least = w.iter().copied().fold(0.0, f64::min);
        expect_setting("weight", least, "[0, inf)")?;
        if self.w == w {
            return Ok(false);
        }
        let n = self.rows;
        for i in 0..n {
            for j in 0..=i {
                let products = self.row(i).iter().zip(self.row(j)).zip(w);
                let value: f64 = products.map(|((a, b), w)| a * b * w).sum();
                let known: f64 = (0..j).map(|k| self.next[i * n + k] * self.next[j * n + k]).sum();
                if i == j {
                    let pivot = value - known;
                    // beside its own square: rows may have different units
                    if pivot <= SINGULAR_PIVOT * value {
                        return Err(deficient(i));
                    }
                    self.next[i * n + i] = pivot.sqrt();
                } else {
                    self.next[i * n + j] = (value - known) / self.next[j * n + j];
                }
            }
        }
        self.w = w.to_vec();
        std::mem::swap(&mut self.factor, &mut self.next);
        Ok(true)
    }

    fn project(&mut self, x: &mut [f64]) {
        self.subtract(true, x, |own, x, defect| own.times(x, false, defect));
    }

    fn project_transpose(&mut self, g: &mut [f64]) {
        self.subtract(false, g, |own, g, defect| own.times(g, true, defect));
    }

    fn compensate(&mut self, from: &[f64], change: &[f64], to: &mut [f64]) {
        to.copy_from_slice(from);
        to.iter_mut().zip(change).for_each(|(t, c)| *t += c);
        self.subtract(true, to, |own, _, defect| own.times(change, false, defect));
    }

    fn repair(&mut self, x: &mut [f64], e: &[f64]) {
        self.subtract(true, x, |own, x, defect| {
            own.times(x, false, defect);
            defect.iter_mut().zip(e).for_each(|(s, e)| *s -= e);
        });
    }
}
