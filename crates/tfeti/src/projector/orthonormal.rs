//! Orthonormal rows that span those of `G`.

use crate::coarse::space::CoarseScratch;
use crate::linalg::sparse::SparseCholesky;
use crate::projector::factor::CoarseFactor;
use signorini_qp::Equality;
use std::sync::Arc;

/// The constraint `G x = e` with orthonormal rows: `C x = L^-1 P e` with `C = L^-1 P G`, `C C^T = I`,
/// where `P G G^T P^T = L L^T`.
#[derive(Debug, Clone)]
pub struct OrthonormalCoarse {
    factor: CoarseFactor,
    cholesky: Arc<SparseCholesky>,
}

impl CoarseFactor {
    /// The orthonormal basis of the row space of `G`. `None` if there are weights or free motions.
    pub fn orthonormal(&self) -> Option<OrthonormalCoarse> {
        let (factor, cholesky) = (self.clone(), self.unweighted()?.clone());
        Some(OrthonormalCoarse { factor, cholesky })
    }
}

impl OrthonormalCoarse {
    /// Right-hand side of the orthonormal rows: `out = L^-1 P e`.
    pub fn rhs(&self, e: &[f64], out: &mut [f64], s: &mut CoarseScratch) {
        self.cholesky.half_solve(e, out, &mut s.memory);
    }

    /// Rigid amplitudes of a multiplier `beta` of the orthonormal rows: `alpha = P^T L^-T beta`, so that
    /// `G^T alpha = C^T beta`.
    ///
    /// # Panics
    /// If `beta` or `alpha` does not have one entry for each row.
    pub fn amplitudes(&self, beta: &[f64], alpha: &mut [f64], s: &mut CoarseScratch) {
        s.first.copy_from_slice(beta);
        self.cholesky.half_solve_transpose(&mut s.first, alpha, &mut s.memory);
    }

    /// The factor.
    pub fn factor(&self) -> &CoarseFactor {
        &self.factor
    }
}

impl Equality for OrthonormalCoarse {
    type Scratch = CoarseScratch;

    fn dim(&self) -> usize {
        self.factor.coarse().dim()
    }

    fn rows(&self) -> usize {
        self.factor.coarse().rows()
    }

    fn scratch(&self) -> CoarseScratch {
        self.factor.scratch()
    }

    fn apply(&self, x: &[f64], y: &mut [f64], s: &mut CoarseScratch) {
        let data = &self.factor.coarse().0;
        data.product(x, None, &mut s.first, &mut s.sides);
        self.cholesky.half_solve(&s.first, y, &mut s.memory);
    }

    fn apply_transpose(&self, y: &[f64], x: &mut [f64], s: &mut CoarseScratch) {
        s.first.copy_from_slice(y);
        self.cholesky
            .half_solve_transpose(&mut s.first, &mut s.second, &mut s.memory);
        let data = &self.factor.coarse().0;
        data.product_transpose(&s.second, x, &mut s.motions);
    }
}
