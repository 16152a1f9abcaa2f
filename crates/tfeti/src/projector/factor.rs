//! Factors of `G W G^T`, projectors and orthonormal rows.

use crate::coarse::mobility::FreeMotion;
use crate::coarse::space::{Coarse, CoarseScratch};
use crate::coarse::weights::{LineWeight, RowWeights};
use crate::linalg::sparse::{SolveMemory, SparseCholesky};
use crate::projector::split::factor::{SplitBase, SplitFactor};
use crate::projector::split::solve::Digits;
use signorini_qp::Equality;
use std::sync::Arc;

/// A Cholesky factor of `G W G^T` and the projectors that belong to it.
///
/// With `W = I` (no weights): `P = I - G^T (G G^T)^-1 G` and `Q = I - P` are the paper's orthogonal projectors. With
/// weights the projector `I - W G^T (G W G^T)^-1 G` maps to the kernel of `G` by changing only rows of positive weight.
#[derive(Debug, Clone)]
pub struct CoarseFactor(Arc<FactorData>);

#[derive(Debug)]
struct FactorData {
    coarse: Coarse,
    factor: Factor,
    weights: Option<RowWeights>,
    /// Whether interface rows have weight one.
    plain: bool,
    /// Whether contact rows have weights.
    contact: bool,
    free: Vec<FreeMotion>,
}

#[derive(Debug)]
pub(crate) enum Factor {
    Sparse(SparseCholesky),
    Split(Arc<SplitBase>, SplitFactor),
}

impl CoarseFactor {
    pub(crate) fn new(
        coarse: Coarse,
        factor: Factor,
        weights: Option<RowWeights>,
        free: Vec<FreeMotion>,
    ) -> Self {
        let ranges = coarse.0.gluing.ranges();
        let mut weights = weights;
        if let Some(RowWeights { diagonal, lines }) = &mut weights {
            // products count these rows in full and are corrected by what the lines leave out
            lines
                .iter()
                .for_each(|l| diagonal[l.row..l.row + 2].fill(1.0));
        }
        let plain = weights.as_ref().is_none_or(|w| w.is_plain(ranges));
        let contact = |w: &RowWeights| w.diagonal[ranges.contact()].iter().any(|w| *w != 0.0);
        let contact = weights.as_ref().is_none_or(contact);
        Self(Arc::new(FactorData {
            coarse,
            factor,
            weights,
            plain,
            contact,
            free,
        }))
    }

    /// The memory of a split factor that nobody else uses.
    pub(crate) fn into_split(self) -> Option<SplitFactor> {
        match Arc::into_inner(self.0)?.factor {
            Factor::Split(_, factor) => Some(factor),
            Factor::Sparse(_) => None,
        }
    }

    /// Numbers stored.
    #[must_use]
    pub fn stored(&self) -> usize {
        match &self.0.factor {
            Factor::Sparse(factor) => factor.stored(),
            Factor::Split(base, _) => base.stored(),
        }
    }

    /// The coarse space.
    #[must_use]
    pub fn coarse(&self) -> &Coarse {
        &self.0.coarse
    }

    /// Rigid motions that the rows of positive weight do not stop. Empty if `G W G^T` is regular.
    #[must_use]
    pub fn free_motions(&self) -> &[FreeMotion] {
        &self.0.free
    }

    /// The weights; `None` for `W = I`.
    #[must_use]
    pub fn weights(&self) -> Option<&RowWeights> {
        self.0.weights.as_ref()
    }

    /// Creates the work memory.
    #[must_use]
    pub fn scratch(&self) -> CoarseScratch {
        let mut scratch = self.0.coarse.scratch();
        if let Factor::Split(base, _) = &self.0.factor {
            scratch.split.resize(base.work(), 0.0);
        }
        scratch
    }

    /// `y = (G W G^T)^-1 y`.
    pub fn solve(&self, y: &mut [f64], s: &mut CoarseScratch) {
        self.solve_with(Digits::Double, y, &mut s.memory, &mut s.split);
    }

    fn solve_with(
        &self,
        digits: Digits,
        y: &mut [f64],
        memory: &mut SolveMemory,
        split: &mut Vec<f64>,
    ) {
        match &self.0.factor {
            Factor::Sparse(factor) => factor.solve(y, 1, memory),
            Factor::Split(base, factor) => {
                base.solve(factor, y, reserved(base, split), false, digits);
            }
        }
    }

    /// Whether the factor is stored in single precision, too.
    pub(crate) fn has_short(&self) -> bool {
        matches!(self.0.factor, Factor::Split(..))
    }

    /// How far `G W G^T` times a solve in single precision is from the right side, relative, for one in which all motions
    /// are: what steps do to the equality.
    pub(crate) fn single_error(&self, s: &mut CoarseScratch) -> f64 {
        let data = &self.0.coarse.0;
        let rows = 0..self.0.coarse.rows();
        let side: Vec<f64> = rows.map(|k| ((k * k + 1) as f64).sin()).collect();
        s.first.copy_from_slice(&side);
        self.solve_with(Digits::Single, &mut s.first, &mut s.memory, &mut s.split);
        let (mut x, mut found) = (vec![0.0; self.0.coarse.dim()], side.clone());
        data.product_transpose(&s.first, &mut x, &mut s.motions);
        self.weigh(&mut x);
        data.product(&x, None, &mut found, &mut s.sides);
        signorini_qp::vector::distance(&found, &side) / signorini_qp::vector::norm(&side)
    }

    /// Weights of the rows that are no interface rows, if the interface rows have weight one.
    fn diagonal(&self) -> Option<&[f64]> {
        self.0.weights.as_ref().map(|w| &w.diagonal[..])
    }

    fn lines(&self) -> &[LineWeight] {
        self.0.weights.as_ref().map_or(&[], |w| &w.lines)
    }

    fn weigh(&self, x: &mut [f64]) {
        if let Some(weights) = &self.0.weights {
            weights.apply(x);
        }
    }

    /// `x = x - W G^T (G W G^T)^-1 (G x - e)`: the closest point (in the metric of `W`) with `G x = e`; `e = 0` if `None`.
    ///
    /// # Panics
    /// If a vector does not have the length that belongs to it.
    pub fn project(&self, x: &mut [f64], e: Option<&[f64]>, s: &mut CoarseScratch) {
        self.project_to(Digits::Double, x, e, s);
    }

    pub(crate) fn project_to(
        &self,
        digits: Digits,
        x: &mut [f64],
        e: Option<&[f64]>,
        s: &mut CoarseScratch,
    ) {
        let data = &self.0.coarse.0;
        data.product(x, None, &mut s.first, &mut s.sides);
        if let Some(e) = e {
            s.first.iter_mut().zip(e).for_each(|(v, e)| *v -= e);
        }
        self.solve_with(digits, &mut s.first, &mut s.memory, &mut s.split);
        self.subtract_weighted(x, s);
    }

    /// `to = from + c - W G^T (G W G^T)^-1 G c`, `c` a vector that is zero behind the leading entries `change`. Cheaper than
    /// [`project`](Self::project) where these are the contact rows.
    ///
    /// # Panics
    /// If `change` is too long, or another vector does not have the length of dual vectors.
    pub fn compensate(&self, from: &[f64], change: &[f64], to: &mut [f64], s: &mut CoarseScratch) {
        self.compensate_to(Digits::Double, from, change, to, s);
    }

    pub(crate) fn compensate_to(
        &self,
        digits: Digits,
        from: &[f64],
        change: &[f64],
        to: &mut [f64],
        s: &mut CoarseScratch,
    ) {
        let data = &self.0.coarse.0;
        let contact = change.len() == data.gluing.ranges().contact().end;
        if contact {
            let first = &mut s.first;
            both(
                data.is_large(),
                || data.contact_product(change, first),
                || signorini_qp::vector::copy(from, to),
            );
        } else {
            s.dual.fill(0.0);
            s.dual[..change.len()].copy_from_slice(change);
            data.product(&s.dual, None, &mut s.first, &mut s.sides);
            signorini_qp::vector::copy(from, to);
        }
        to.iter_mut().zip(change).for_each(|(t, c)| *t += c);
        match &self.0.factor {
            Factor::Split(base, factor) if contact && base.rows() >= change.len() => {
                let work = reserved(base, &mut s.split);
                base.solve(factor, &mut s.first, work, true, digits);
            }
            _ => self.solve_with(digits, &mut s.first, &mut s.memory, &mut s.split),
        }
        self.subtract_weighted(to, s);
    }

    /// `x = x - W G^T y`, `y` the first vector of the memory.
    fn subtract_weighted(&self, x: &mut [f64], s: &mut CoarseScratch) {
        let data = &self.0.coarse.0;
        if self.0.plain {
            keep(self.lines(), x, &mut s.pairs);
            let weight = |row: usize| self.diagonal().map_or(1.0, |w| w[row]);
            data.with_transpose(
                &s.first,
                x,
                self.0.contact,
                &mut s.motions,
                |x, v| *x -= v,
                |row, x, v| *x -= weight(row) * v,
            );
            for (line, old) in self.lines().iter().zip(&s.pairs) {
                let along = line.along([old[0] - x[line.row], old[1] - x[line.row + 1]]);
                x[line.row] = old[0] - along[0];
                x[line.row + 1] = old[1] - along[1];
            }
        } else {
            data.product_transpose(&s.first, &mut s.dual, &mut s.motions);
            self.weigh(&mut s.dual);
            signorini_qp::vector::subtract(&s.dual, x);
        }
    }

    /// `r = r - G^T (G W G^T)^-1 G W r`: the transpose of [`CoarseFactor::project`] with `e = 0`. Returns in `alpha` the
    /// amplitudes `-(G W G^T)^-1 G W r`, so that the result is `r + G^T alpha`.
    ///
    /// # Panics
    /// If a vector does not have the length that belongs to it.
    pub fn project_transpose(&self, r: &mut [f64], alpha: &mut [f64], s: &mut CoarseScratch) {
        self.project_transpose_to(Digits::Double, r, alpha, s);
    }

    pub(crate) fn project_transpose_to(
        &self,
        digits: Digits,
        r: &mut [f64],
        alpha: &mut [f64],
        s: &mut CoarseScratch,
    ) {
        if self.0.plain {
            keep(self.lines(), r, &mut s.pairs);
            for (line, old) in self.lines().iter().zip(&s.pairs) {
                r[line.row..line.row + 2].copy_from_slice(&line.along(*old));
            }
            self.plain_amplitudes(digits, r, alpha, s);
            for (line, old) in self.lines().iter().zip(&s.pairs) {
                r[line.row..line.row + 2].copy_from_slice(old);
            }
        } else {
            self.amplitudes_to(digits, r, alpha, s);
        }
        let data = &self.0.coarse.0;
        data.with_transpose(
            alpha,
            r,
            true,
            &mut s.motions,
            |r, v| *r += v,
            |_, r, v| *r += v,
        );
    }

    /// Rigid amplitudes that make the rows residual `r + G^T alpha` smallest in the metric of `W`:
    /// `alpha = -(G W G^T)^-1 G W r` with `r = F lambda - d`. Give weight zero to the rows that are not satisfied with
    /// equality (open contact, sliding).
    ///
    /// # Panics
    /// If a vector does not have the length that belongs to it.
    pub fn amplitudes(&self, r: &[f64], alpha: &mut [f64], s: &mut CoarseScratch) {
        self.amplitudes_to(Digits::Double, r, alpha, s);
    }

    fn amplitudes_to(&self, digits: Digits, r: &[f64], alpha: &mut [f64], s: &mut CoarseScratch) {
        if self.0.plain && self.lines().is_empty() {
            self.plain_amplitudes(digits, r, alpha, s);
            return;
        }
        s.dual.copy_from_slice(r);
        self.weigh(&mut s.dual);
        let data = &self.0.coarse.0;
        data.product(&s.dual, None, alpha, &mut s.sides);
        self.solve_with(digits, alpha, &mut s.memory, &mut s.split);
        alpha.iter_mut().for_each(|a| *a = -*a);
    }

    /// The same for interface rows of weight one and rows in lines that are weighted already.
    fn plain_amplitudes(
        &self,
        digits: Digits,
        r: &[f64],
        alpha: &mut [f64],
        s: &mut CoarseScratch,
    ) {
        let data = &self.0.coarse.0;
        data.product(r, self.diagonal(), alpha, &mut s.sides);
        self.solve_with(digits, alpha, &mut s.memory, &mut s.split);
        alpha.iter_mut().for_each(|a| *a = -*a);
    }

    /// `x = W G^T (G W G^T)^-1 e`: a solution of `G x = e`; the paper's `lambda_Im` for `W = I`.
    ///
    /// # Panics
    /// If a vector does not have the length that belongs to it.
    pub fn particular(&self, e: &[f64], x: &mut [f64], s: &mut CoarseScratch) {
        let data = &self.0.coarse.0;
        s.first.copy_from_slice(e);
        self.solve_with(Digits::Double, &mut s.first, &mut s.memory, &mut s.split);
        data.product_transpose(&s.first, x, &mut s.motions);
        self.weigh(x);
    }

    fn sparse(&self) -> Option<&SparseCholesky> {
        match &self.0.factor {
            Factor::Sparse(factor) => Some(factor),
            Factor::Split(..) => None,
        }
    }

    /// The orthonormal basis `C = L^-1 P G` of the row space of `G`, where `P G G^T P^T = L L^T`. `None` if there are
    /// weights or free motions.
    #[must_use]
    pub fn orthonormal(&self) -> Option<OrthonormalCoarse> {
        (self.0.weights.is_none() && self.0.free.is_empty() && self.sparse().is_some())
            .then(|| OrthonormalCoarse(self.clone()))
    }
}

/// The work memory, long enough.
fn reserved<'m>(base: &SplitBase, memory: &'m mut Vec<f64>) -> &'m mut [f64] {
    if memory.len() < base.work() {
        memory.resize(base.work(), 0.0);
    }
    memory
}

/// Both, at the same time if that is `worth` it.
fn both(worth: bool, a: impl FnOnce() + Send, b: impl FnOnce() + Send) {
    if worth {
        rayon::join(a, b);
    } else {
        a();
        b();
    }
}

/// Remembers the entries of the rows in lines.
fn keep(lines: &[LineWeight], x: &[f64], pairs: &mut Vec<[f64; 2]>) {
    pairs.clear();
    pairs.extend(lines.iter().map(|l| [x[l.row], x[l.row + 1]]));
}

/// The constraint `G x = e` with orthonormal rows: `C x = L^-1 P e` with `C = L^-1 P G`, `C C^T = I`.
#[derive(Debug, Clone)]
pub struct OrthonormalCoarse(CoarseFactor);

impl OrthonormalCoarse {
    fn half_solve(&self, x: &[f64], out: &mut [f64], memory: &mut SolveMemory) {
        if let Some(factor) = self.0.sparse() {
            factor.half_solve(x, out, memory);
        }
    }

    fn half_solve_transpose(&self, y: &mut [f64], out: &mut [f64], memory: &mut SolveMemory) {
        if let Some(factor) = self.0.sparse() {
            factor.half_solve_transpose(y, out, memory);
        }
    }

    /// Right-hand side of the orthonormal rows: `out = L^-1 P e`.
    pub fn rhs(&self, e: &[f64], out: &mut [f64], s: &mut CoarseScratch) {
        self.half_solve(e, out, &mut s.memory);
    }

    /// Rigid amplitudes of a multiplier `beta` of the orthonormal rows: `alpha = P^T L^-T beta`, so that
    /// `G^T alpha = C^T beta`.
    ///
    /// # Panics
    /// If `beta` or `alpha` does not have one entry for each row.
    pub fn amplitudes(&self, beta: &[f64], alpha: &mut [f64], s: &mut CoarseScratch) {
        s.first.copy_from_slice(beta);
        self.half_solve_transpose(&mut s.first, alpha, &mut s.memory);
    }

    /// The factor.
    #[must_use]
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
        data.product(x, None, &mut s.first, &mut s.sides);
        self.half_solve(&s.first, y, &mut s.memory);
    }

    fn apply_transpose(&self, y: &[f64], x: &mut [f64], s: &mut CoarseScratch) {
        let data = &self.0.coarse().0;
        s.first.copy_from_slice(y);
        self.half_solve_transpose(&mut s.first, &mut s.second, &mut s.memory);
        data.product_transpose(&s.second, x, &mut s.motions);
    }
}
