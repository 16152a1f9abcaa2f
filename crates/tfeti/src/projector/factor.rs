//! Factors of `G W G^T` and their projectors.

use crate::coarse::matrix::ModeTable;
use crate::coarse::mobility::FreeMotion;
use crate::coarse::products::Wrench;
use crate::coarse::space::{Coarse, CoarseScratch};
use crate::coarse::weights::{RowWeights, along};
use crate::error::TfetiError;
use crate::linalg::both;
use crate::linalg::sparse::{FactorError, SolveMemory, SparseCholesky};
use crate::linalg::tiles::Digits;
use crate::projector::model::{Model, ModelFactor};
use crate::projector::split::factor::{SplitBase, SplitFactor};
use signorini_qp::internal::LineWeight;
use std::sync::Arc;

/// A Cholesky factor of `G W G^T` and the projectors that belong to it.
///
/// With `W = I` (no weights): `P = I - G^T (G G^T)^-1 G` and `Q = I - P` are the paper's orthogonal projectors. With
/// weights the projector `I - W G^T (G W G^T)^-1 G` maps to the kernel of `G` by changing only rows of positive weight.
///
/// All methods panic if a vector does not have the length that belongs to it.
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
pub(super) enum Factor {
    Sparse(Arc<SparseCholesky>),
    Split(Arc<SplitBase>, SplitFactor),
    /// An approximation, and the factor of the rows that are always free: with it projectors are
    /// [exact](super::levels).
    Model(Arc<Model>, ModelFactor, CoarseFactor),
}

impl Coarse {
    /// Factor of `G G^T`.
    ///
    /// # Errors
    /// [`TfetiError::CoarseSingular`] if a pivot is not positive, [`TfetiError::TooLarge`].
    pub fn factor(&self) -> Result<CoarseFactor, TfetiError> {
        self.factor_with(None, self.0.free_motions(None))
    }

    /// Factor of `G W G^T`.
    ///
    /// If some rigid motions of bodies escape all rows of positive weight (see [`CoarseFactor::free_motions`]), the
    /// matrix is singular; it is then regularised such that solves apply a generalised inverse, exact for right-hand
    /// sides that do no work on the free motions.
    ///
    /// # Errors
    /// [`TfetiError::Setting`] and [`TfetiError::Length`] for unusable weights, and those of [`factor`](Self::factor).
    pub fn factor_weighted(&self, weights: RowWeights) -> Result<CoarseFactor, TfetiError> {
        weights.validate(self.0.gluing.ranges())?;
        let free = self.0.free_motions(Some(&weights));
        self.factor_with(Some(weights), free)
    }

    /// The same with the free motions.
    pub(super) fn factor_with(
        &self,
        weights: Option<RowWeights>,
        free: Vec<FreeMotion>,
    ) -> Result<CoarseFactor, TfetiError> {
        let data = &self.0;
        let modes = ModeTable::new(&data.subdomains);
        let mut matrix = data.matrix.assemble(&data.gluing, &modes, weights.as_ref());
        if weights.is_none()
            && free.is_empty()
            && let Some(factor) = self.shared_factor(&matrix.values)
        {
            return Ok(CoarseFactor::new(self.clone(), factor, None, free));
        }
        data.hold(&free, &mut matrix.values);
        let (what, count) = ("coarse unknowns", matrix.dim);
        let factor = SparseCholesky::new(data.symbolic()?, &matrix).map_err(|error| match error {
            FactorError::Pivot(pivot) => TfetiError::CoarseSingular { pivot },
            FactorError::Pattern => TfetiError::TooLarge { what, count },
        })?;
        let factor = Factor::Sparse(Arc::new(factor));
        Ok(CoarseFactor::new(self.clone(), factor, weights, free))
    }
}

impl CoarseFactor {
    pub(super) fn new(coarse: Coarse, factor: Factor, mut weights: Option<RowWeights>, free: Vec<FreeMotion>) -> Self {
        let ranges = coarse.0.gluing.ranges();
        if let Some(RowWeights { diagonal, lines }) = &mut weights {
            // products count these rows in full and are corrected by what the lines leave out
            lines.iter().for_each(|l| diagonal[l.row..l.row + 2].fill(1.0));
        }
        let plain = weights.as_ref().is_none_or(|w| w.are_one(ranges.interface.clone()));
        let zero = |w: &RowWeights| w.diagonal[ranges.contact()].iter().all(|w| *w == 0.0);
        let contact = weights.as_ref().is_none_or(|w| !zero(w));
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
    pub(super) fn into_split(self) -> Option<SplitFactor> {
        match Arc::into_inner(self.0).map(|data| data.factor) {
            Some(Factor::Split(_, factor)) => Some(factor),
            Some(Factor::Model(_, factor, _)) => Some(factor.clusters),
            _ => None,
        }
    }

    /// Numbers stored, by all processes together.
    pub fn stored(&self) -> usize {
        match &self.0.factor {
            Factor::Sparse(factor) => factor.stored(),
            Factor::Split(base, _) => base.stored(),
            Factor::Model(model, ..) => model.stored(),
        }
    }

    /// Numbers that this process holds: of several each holds its branches and what is around them.
    #[doc(hidden)]
    pub fn held(&self) -> usize {
        match &self.0.factor {
            Factor::Split(base, factor) => base.held(factor),
            _ => self.stored(),
        }
    }

    /// The coarse space.
    pub fn coarse(&self) -> &Coarse {
        &self.0.coarse
    }

    /// Rigid motions that the rows of positive weight do not stop. Empty if `G W G^T` is regular.
    pub fn free_motions(&self) -> &[FreeMotion] {
        &self.0.free
    }

    /// The weights; `None` for `W = I`.
    pub fn weights(&self) -> Option<&RowWeights> {
        self.0.weights.as_ref()
    }

    /// Creates the work memory.
    pub fn scratch(&self) -> CoarseScratch {
        let mut scratch = self.0.coarse.scratch();
        let work = match &self.0.factor {
            Factor::Sparse(factor) => {
                scratch.memory = SolveMemory::new(factor.need(1));
                0
            }
            Factor::Split(base, _) => base.work(),
            Factor::Model(model, ..) => model.work(),
        };
        scratch.split.resize(work, 0.0);
        scratch
    }

    /// `y = (G W G^T)^-1 y`.
    pub fn solve(&self, y: &mut [f64], s: &mut CoarseScratch) {
        self.solve_some(y, s, false);
    }

    /// The same; `y` may be told to be zero but for blocks that a change of contact rows reaches.
    fn solve_some(&self, y: &mut [f64], s: &mut CoarseScratch, changing: bool) {
        match &self.0.factor {
            Factor::Sparse(factor) => factor.solve(y, 1, s.memory.at_least(factor.need(1))),
            Factor::Split(base, factor) => {
                if s.split.len() < base.work() {
                    s.split.resize(base.work(), 0.0);
                }
                base.solve(factor, y, &mut s.split, changing, s.digits);
            }
            Factor::Model(model, factors, _) => {
                if s.split.len() < model.work() {
                    s.split.resize(model.work(), 0.0);
                }
                model.solve(factors, y, &mut s.split, s.digits);
            }
        }
    }

    /// Replaces the side in the memory by the solution for it.
    pub(super) fn solve_side(&self, s: &mut CoarseScratch, changing: bool) {
        let mut side = std::mem::take(&mut s.side);
        self.solve_some(&mut side, s, changing);
        s.side = side;
    }

    /// The factor of the rows that are always free, if this one is a model.
    pub(super) fn always(&self) -> Option<&Self> {
        match &self.0.factor {
            Factor::Model(.., always) => Some(always),
            _ => None,
        }
    }

    /// Whether the factor is stored in single precision, too.
    pub(super) fn has_short(&self) -> bool {
        matches!(self.0.factor, Factor::Split(..))
    }

    /// How far `G W G^T` times a solve in single precision is from the right side, relative, for one in which all
    /// motions are: what steps do to the equality.
    pub(super) fn single_error(&self, s: &mut CoarseScratch) -> f64 {
        let data = &self.0.coarse.0;
        let rows = 0..self.0.coarse.rows();
        let side: Vec<f64> = rows.map(|k| ((k * k + 1) as f64).sin()).collect();
        let (mut x, mut found) = (vec![0.0; self.0.coarse.dim()], side.clone());
        s.digits = Digits::Single;
        self.particular(&side, &mut x, s);
        s.digits = Digits::Double;
        data.product(&x, None, &mut found, &mut s.sides);
        signorini_qp::vector::distance(&found, &side) / signorini_qp::vector::norm(&side)
    }

    /// `out = G W x` for a solve: what is here of it where that completes the rest.
    fn product(&self, x: &[f64], weights: Option<&[f64]>, out: &mut [f64], sides: &mut [Wrench]) {
        let data = &self.0.coarse.0;
        match &self.0.factor {
            Factor::Split(base, _) if base.completes() => data.product_here(x, weights, out, sides),
            _ => data.product(x, weights, out, sides),
        }
    }

    fn lines(&self) -> &[LineWeight] {
        self.0.weights.as_ref().map_or(&[], |w| &w.lines)
    }

    pub(super) fn weigh(&self, x: &mut [f64]) {
        if let Some(weights) = &self.0.weights {
            weights.apply(x);
        }
    }

    /// `x = x - W G^T (G W G^T)^-1 (G x - e)`: the closest point (in the metric of `W`) with `G x = e`; `e = 0` if
    /// `None`.
    pub fn project(&self, x: &mut [f64], e: Option<&[f64]>, s: &mut CoarseScratch) {
        self.product(x, None, &mut s.side, &mut s.sides);
        if let Some(e) = e {
            s.side.iter_mut().zip(e).for_each(|(v, e)| *v -= e);
        }
        if self.always().is_some() {
            self.take_by_contact(x, s);
        }
        let exact = self.always().unwrap_or(self);
        exact.solve_side(s, false);
        exact.subtract_weighted(x, s);
    }

    /// `to = from + c - W G^T (G W G^T)^-1 G c`, `c` a vector that is zero behind the leading entries `change`. Cheaper
    /// than [`project`](Self::project) where these are the contact rows.
    pub fn compensate(&self, from: &[f64], change: &[f64], to: &mut [f64], s: &mut CoarseScratch) {
        let data = &self.0.coarse.0;
        let contact = change.len() == data.gluing.ranges().contact().end;
        if contact {
            let side = &mut s.side;
            both(
                data.is_large(),
                || data.contact_product(change, side),
                || signorini_qp::vector::copy(from, to),
            );
        } else {
            s.dual.fill(0.0);
            s.dual[..change.len()].copy_from_slice(change);
            data.product(&s.dual, None, &mut s.side, &mut s.sides);
            signorini_qp::vector::copy(from, to);
        }
        to.iter_mut().zip(change).for_each(|(t, c)| *t += c);
        let reaches = |base: &SplitBase| contact && base.rows() >= change.len();
        let changing = matches!(&self.0.factor, Factor::Split(base, _) if reaches(base));
        self.solve_side(s, changing);
        self.subtract_weighted(to, s);
    }

    /// `x = x - W G^T y`, `y` the side in the memory.
    pub(super) fn subtract_weighted(&self, x: &mut [f64], s: &mut CoarseScratch) {
        let data = &self.0.coarse.0;
        if !self.0.plain {
            data.product_transpose(&s.side, &mut s.dual, &mut s.motions);
            self.weigh(&mut s.dual);
            signorini_qp::vector::subtract(&s.dual, x);
            return;
        }
        keep(self.lines(), x, &mut s.pairs);
        let weight = |row: usize| self.0.weights.as_ref().map_or(1.0, |w| w.of(row));
        data.with_transpose(
            &s.side,
            x,
            self.0.contact,
            &mut s.motions,
            |x, v| *x -= v,
            |row, x, v| *x -= weight(row) * v,
        );
        for (line, old) in self.lines().iter().zip(&s.pairs) {
            let (k, l) = (line.row, line.row + 1);
            let change = along(line, [old[0] - x[k], old[1] - x[l]]);
            (x[k], x[l]) = (old[0] - change[0], old[1] - change[1]);
        }
    }

    /// `r = r - G^T (G W G^T)^-1 G W r`: the transpose of [`CoarseFactor::project`] with `e = 0`. Returns in `alpha`
    /// the amplitudes `-(G W G^T)^-1 G W r`, so that the result is `r + G^T alpha`.
    pub fn project_transpose(&self, r: &mut [f64], alpha: &mut [f64], s: &mut CoarseScratch) {
        if self.0.plain && self.always().is_none() {
            keep(self.lines(), r, &mut s.pairs);
            for (line, old) in self.lines().iter().zip(&s.pairs) {
                r[line.row..line.row + 2].copy_from_slice(&along(line, *old));
            }
            self.plain_amplitudes(r, alpha, s);
            for (line, old) in self.lines().iter().zip(&s.pairs) {
                r[line.row..line.row + 2].copy_from_slice(old);
            }
        } else {
            self.amplitudes(r, alpha, s);
        }
        self.0.coarse.0.add_transpose(alpha, r, &mut s.motions);
    }

    /// Rigid amplitudes that make the residual of the rows `r + G^T alpha` smallest in the metric of `W`:
    /// `alpha = -(G W G^T)^-1 G W r` with `r = F lambda - d`. Give weight zero to the rows that are not satisfied with
    /// equality (open contact, sliding).
    pub fn amplitudes(&self, r: &[f64], alpha: &mut [f64], s: &mut CoarseScratch) {
        if let Some(always) = self.always() {
            always.amplitudes(r, alpha, s);
            return self.take_from(r, alpha, s);
        }
        if self.0.plain && self.lines().is_empty() {
            return self.plain_amplitudes(r, alpha, s);
        }
        s.dual.copy_from_slice(r);
        self.weigh(&mut s.dual);
        self.product(&s.dual, None, alpha, &mut s.sides);
        self.solve(alpha, s);
        alpha.iter_mut().for_each(|a| *a = -*a);
    }

    /// The same for interface rows of weight one and rows in lines that are weighted already.
    fn plain_amplitudes(&self, r: &[f64], alpha: &mut [f64], s: &mut CoarseScratch) {
        let weights = self.0.weights.as_ref().map(|w| &w.diagonal[..]);
        self.product(r, weights, alpha, &mut s.sides);
        self.solve(alpha, s);
        alpha.iter_mut().for_each(|a| *a = -*a);
    }

    /// `x = W G^T (G W G^T)^-1 e`: a solution of `G x = e`; the paper's `lambda_Im` for `W = I`.
    pub fn particular(&self, e: &[f64], x: &mut [f64], s: &mut CoarseScratch) {
        s.side.copy_from_slice(e);
        self.solve_side(s, false);
        self.0.coarse.0.product_transpose(&s.side, x, &mut s.motions);
        self.weigh(x);
    }

    /// Whether it is one of a regular `G G^T`, of which halves can be applied.
    pub(super) fn has_halves(&self) -> bool {
        let halves = match &self.0.factor {
            Factor::Sparse(_) => true,
            Factor::Split(base, _) => base.has_halves(),
            Factor::Model(..) => false,
        };
        halves && self.0.weights.is_none() && self.0.free.is_empty()
    }

    /// `out = L^-1 P` of the side in the memory.
    pub(super) fn half_solve_side(&self, out: &mut [f64], s: &mut CoarseScratch) {
        match &self.0.factor {
            Factor::Sparse(factor) => factor.half_solve(&s.side, out, s.memory.at_least(factor.need(1))),
            Factor::Split(base, factor) => base.half_solve(factor, &mut s.side, out, &mut s.split),
            Factor::Model(..) => {}
        }
    }

    /// `out = P^T L^-T` of the side in the memory, which is overwritten.
    pub(super) fn half_solve_side_transpose(&self, out: &mut [f64], s: &mut CoarseScratch) {
        match &self.0.factor {
            Factor::Sparse(factor) => {
                factor.half_solve_transpose(&mut s.side, out, s.memory.at_least(factor.need(1)));
            }
            Factor::Split(base, factor) => base.half_solve_transpose(factor, &s.side, out, &mut s.split),
            Factor::Model(..) => {}
        }
    }
}

/// Remembers the entries of the rows in lines.
fn keep(lines: &[LineWeight], x: &[f64], pairs: &mut Vec<[f64; 2]>) {
    pairs.clear();
    pairs.extend(lines.iter().map(|l| [x[l.row], x[l.row + 1]]));
}
