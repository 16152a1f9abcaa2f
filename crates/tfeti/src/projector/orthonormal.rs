//! Orthonormal rows that span those of `G`.

use crate::coarse::space::CoarseScratch;
use crate::projector::factor::CoarseFactor;
use signorini_qp::Equality;

/// The constraint `G x = e` with orthonormal rows: `C x = L^-1 P e` with `C = L^-1 P G`, `C C^T = I`,
/// where `P G G^T P^T = L L^T`.
#[derive(Debug, Clone)]
pub struct OrthonormalCoarse(CoarseFactor);

impl CoarseFactor {
    /// The orthonormal basis of the row space of `G`. `None` if there are weights or free motions.
    pub fn orthonormal(&self) -> Option<OrthonormalCoarse> {
        self.has_halves().then(|| OrthonormalCoarse(self.clone()))
    }
}

impl OrthonormalCoarse {
    /// Right-hand side of the orthonormal rows: `out = L^-1 P e`.
    pub fn rhs(&self, e: &[f64], out: &mut [f64], s: &mut CoarseScratch) {
        s.side.copy_from_slice(e);
        self.0.half_solve_side(out, s);
    }

    /// Rigid amplitudes of a multiplier `beta` of the orthonormal rows: `alpha = P^T L^-T beta`, so that
    /// `G^T alpha = C^T beta`.
    ///
    /// # Panics
    /// If `beta` or `alpha` does not have one entry for each row.
    pub fn amplitudes(&self, beta: &[f64], alpha: &mut [f64], s: &mut CoarseScratch) {
        s.side.copy_from_slice(beta);
        self.0.half_solve_side_transpose(alpha, s);
    }

    /// The factor.
    pub fn factor(&self) -> &CoarseFactor {
        &self.0
    }
}

impl Equality for OrthonormalCoarse {
    type Scratch = CoarseScratch;

    fn dim(&self) -> usize {
        self.0.coarse().dim()
    }

    fn rows(&self) -> usize {
        self.0.coarse().rows()
    }

    fn scratch(&self) -> CoarseScratch {
        self.0.scratch()
    }

    fn apply(&self, x: &[f64], y: &mut [f64], s: &mut CoarseScratch) {
        let data = &self.0.coarse().0;
        data.product(x, None, &mut s.side, &mut s.sides);
        self.0.half_solve_side(y, s);
    }

    fn apply_transpose(&self, y: &[f64], x: &mut [f64], s: &mut CoarseScratch) {
        s.side.copy_from_slice(y);
        let mut motions = std::mem::take(&mut s.kept);
        self.0.half_solve_side_transpose(&mut motions, s);
        s.kept = motions;
        let data = &self.0.coarse().0;
        data.product_transpose(&s.kept, x, &mut s.motions);
    }
}
