//! The natural coarse space: `G = R^T B^T`, its products and factors of `G W G^T`.

use crate::boundary::BoundaryMap;
use crate::class::Classes;
use crate::coarse_matrix::{CoarseMatrix, ModeTable, RowWeights};
use crate::error::TfetiError;
use crate::gluing::Gluing;
use crate::matrices::ClassBase;
use crate::mobility::{FreeMotion, Mobility};
use crate::motions::{amplitudes_of_forces, motions_of_amplitudes, to_columns, to_subdomains};
use crate::sparse::{FactorError, SolveMemory, SparseCholesky, Symbolic};
use signorini_qp::Equality;
use std::sync::Arc;

/// `G = R^T B^T`: six rows per subdomain, in the order of the subdomains.
#[derive(Debug, Clone)]
pub struct Coarse(Arc<CoarseData>);

#[derive(Debug)]
struct CoarseData {
    map: Arc<BoundaryMap>,
    bases: Arc<Vec<ClassBase>>,
    classes: Arc<Classes>,
    gluing: Arc<Gluing>,
    matrix: CoarseMatrix,
    symbolic: Symbolic,
    mobility: Mobility,
    /// Whether the support rows alone hold all bodies.
    held: bool,
}

/// Work memory of all operations with `G` and its factors.
#[derive(Debug)]
pub struct CoarseScratch {
    boundary: Vec<f64>,
    columns: Vec<f64>,
    first: Vec<f64>,
    second: Vec<f64>,
    dual: Vec<f64>,
    memory: SolveMemory,
}

impl Coarse {
    pub(crate) fn new(
        map: Arc<BoundaryMap>,
        bases: Arc<Vec<ClassBase>>,
        classes: Arc<Classes>,
        gluing: Arc<Gluing>,
        centres: Vec<[f64; 3]>,
    ) -> Result<Self, TfetiError> {
        let modes = ModeTable::new(&bases, &classes);
        let matrix = CoarseMatrix::new(&gluing, &modes, classes.subdomains());
        drop(modes);
        let count = 6 * classes.subdomains();
        let too_large = |_| TfetiError::TooLarge {
            what: "coarse unknowns",
            count,
        };
        let symbolic = Symbolic::new(matrix.pattern(), 6).map_err(too_large)?;
        let mobility = Mobility::new(classes.clone(), bases.clone(), &gluing, centres);
        let mut data = CoarseData {
            map,
            bases,
            classes,
            gluing,
            matrix,
            symbolic,
            mobility,
            held: false,
        };
        let mut supports = RowWeights::diagonal(vec![1.0; data.map.rows()]);
        supports.diagonal[data.gluing.ranges().contact()].fill(0.0);
        data.held = data.free_motions(Some(&supports)).is_empty();
        Ok(Self(Arc::new(data)))
    }

    /// Number of rows of `G`: six per subdomain.
    #[must_use]
    pub fn rows(&self) -> usize {
        6 * self.0.classes.subdomains()
    }

    /// Length of dual vectors.
    #[must_use]
    pub fn dim(&self) -> usize {
        self.0.map.rows()
    }

    /// Number of bodies: sets of subdomains that interface rows join.
    #[must_use]
    pub fn bodies(&self) -> usize {
        self.0.mobility.bodies()
    }

    /// Numbers stored for a factor of `G W G^T`.
    #[must_use]
    pub fn factor_size(&self) -> usize {
        self.0.symbolic.stored()
    }

    /// Creates the work memory.
    #[must_use]
    pub fn scratch(&self) -> CoarseScratch {
        let rows = self.rows();
        CoarseScratch {
            boundary: vec![0.0; self.0.map.len()],
            columns: vec![0.0; rows],
            first: vec![0.0; rows],
            second: vec![0.0; rows],
            dual: vec![0.0; self.dim()],
            memory: SolveMemory::new(SparseCholesky::need_of(&self.0.symbolic, 1)),
        }
    }

    /// `out = G x`: the wrenches of the multipliers on the subdomains.
    pub fn apply(&self, x: &[f64], out: &mut [f64], s: &mut CoarseScratch) {
        self.0.product(x, out, &mut s.boundary, &mut s.columns);
    }

    /// `out = G^T y`.
    pub fn apply_transpose(&self, y: &[f64], out: &mut [f64], s: &mut CoarseScratch) {
        self.0
            .product_transpose(y, out, &mut s.boundary, &mut s.columns);
    }

    /// `out = G^T y` on the contact rows only (the leading part of `out`).
    pub fn apply_transpose_contact(&self, y: &[f64], out: &mut [f64], s: &mut CoarseScratch) {
        self.0.motions(y, &mut s.boundary, &mut s.columns);
        self.0.map.collect_contact(&s.boundary, out);
    }

    /// Row `row` of `G^T`, for inspection: `(subdomain, six coefficients)`.
    #[must_use]
    pub fn column(&self, row: usize) -> Vec<(usize, [f64; 6])> {
        let mut out: Vec<(usize, [f64; 6])> = Vec::new();
        for (subdomain, dof, value) in self.0.gluing.row(row) {
            let kernel = &self.0.bases[self.0.classes.place(subdomain).0].kernel;
            let modes = kernel.node_modes(dof / 3)[dof % 3].map(|m| value * m);
            match out.iter_mut().find(|v| v.0 == subdomain) {
                Some(v) => (0..6).for_each(|k| v.1[k] += modes[k]),
                None => out.push((subdomain, modes)),
            }
        }
        out
    }

    /// Rigid motions of bodies that rows of positive weight leave free; all rows count if there are no weights.
    pub fn free_motions(
        &self,
        weights: Option<&RowWeights>,
    ) -> Result<Vec<FreeMotion>, TfetiError> {
        if let Some(weights) = weights {
            weights.validate(self.0.gluing.ranges())?;
        }
        Ok(self.0.free_motions(weights))
    }

    /// Factor of `G G^T`.
    pub fn factor(&self) -> Result<CoarseFactor, TfetiError> {
        self.factor_with(None)
    }

    /// Factor of `G W G^T`.
    ///
    /// If some rigid motions of bodies escape all rows of positive weight (see [`CoarseFactor::free_motions`]), the matrix
    /// is singular; it is then regularised such that solves apply a generalised inverse, exact for right-hand sides that
    /// do no work on the free motions.
    pub fn factor_weighted(&self, weights: RowWeights) -> Result<CoarseFactor, TfetiError> {
        weights.validate(self.0.gluing.ranges())?;
        self.factor_with(Some(weights))
    }

    fn factor_with(&self, weights: Option<RowWeights>) -> Result<CoarseFactor, TfetiError> {
        let data = &self.0;
        let modes = ModeTable::new(&data.bases, &data.classes);
        let mut matrix = data.matrix.assemble(&data.gluing, &modes, weights.as_ref());
        let free = data.free_motions(weights.as_ref());
        if !free.is_empty() {
            let diagonal = (0..matrix.dim)
                .filter_map(|i| matrix.find(i, i))
                .map(|k| matrix.values[k]);
            let strength = diagonal.sum::<f64>() / matrix.dim.max(1) as f64;
            let strength = if strength > 0.0 { strength } else { 1.0 };
            for (subdomain, spring) in data.mobility.springs(&free) {
                data.matrix
                    .add_row(&[(subdomain as u32, spring)], strength, &mut matrix.values);
            }
        }
        let factor = SparseCholesky::new(&data.symbolic, &matrix).map_err(|error| match error {
            FactorError::Pivot(pivot) => TfetiError::CoarseSingular { pivot },
            FactorError::Pattern => TfetiError::TooLarge {
                what: "coarse unknowns",
                count: matrix.dim,
            },
        })?;
        Ok(CoarseFactor(Arc::new(FactorData {
            coarse: self.clone(),
            factor,
            weights,
            free,
        })))
    }
}

impl CoarseData {
    fn product(&self, x: &[f64], out: &mut [f64], boundary: &mut [f64], columns: &mut [f64]) {
        let map = &self.map;
        let (work, large) = (&mut map.no_work(), map.is_large());
        map.for_lanes(
            &mut work[..map.lanes.len()],
            boundary,
            large,
            &|lane, (), part| {
                for (panel, forces) in map.panels_of(lane, part) {
                    map.spread(x, panel, forces);
                }
            },
        );
        let boundary = &*boundary;
        map.for_columns(columns, &|lane, part| {
            let mut rest = part;
            for panel in &map.panels[lane.panels.clone()] {
                let (own, tail) = std::mem::take(&mut rest).split_at_mut(6 * panel.columns.len());
                rest = tail;
                let forces = &boundary[map.range_of(panel)];
                amplitudes_of_forces(
                    &self.bases[panel.class].kernel,
                    &map.classes[panel.class].nodes,
                    forces,
                    own,
                );
            }
        });
        to_subdomains(map, columns, out);
    }

    fn motions(&self, y: &[f64], boundary: &mut [f64], columns: &mut [f64]) {
        let map = &self.map;
        to_columns(map, y, columns);
        let (work, large) = (&mut map.no_work(), map.is_large());
        let columns = &*columns;
        map.for_lanes(
            &mut work[..map.lanes.len()],
            boundary,
            large,
            &|lane, (), part| {
                for (panel, motion) in map.panels_of(lane, part) {
                    let class = &map.classes[panel.class];
                    let alpha = &columns[6 * (class.column + panel.columns.start)
                        ..6 * (class.column + panel.columns.end)];
                    motions_of_amplitudes(
                        &self.bases[panel.class].kernel,
                        &class.nodes,
                        alpha,
                        motion,
                    );
                }
            },
        );
    }

    fn product_transpose(
        &self,
        y: &[f64],
        out: &mut [f64],
        boundary: &mut [f64],
        columns: &mut [f64],
    ) {
        self.motions(y, boundary, columns);
        self.map.collect(boundary, out);
    }

    fn free_motions(&self, weights: Option<&RowWeights>) -> Vec<FreeMotion> {
        let gluing = &self.gluing;
        // The usual case needs no look at the contact rows.
        let supported = |w: &RowWeights| {
            w.diagonal[gluing.ranges().dirichlet.clone()]
                .iter()
                .all(|w| *w >= 0.01)
        };
        if self.held && weights.is_none_or(supported) {
            return Vec::new();
        }
        let weight = |row: usize| weights.map_or(1.0, |w| w.diagonal[row]);
        let lines = weights.map_or(&[][..], |w| &w.lines);
        let plain = (0..gluing.specials()).filter_map(|special| {
            let row = gluing.special_row(special);
            if weight(row) == 0.0 || weights.is_some_and(|w| w.in_line(row)) {
                return None;
            }
            let mut out = Vec::new();
            self.mobility
                .act(gluing.special(special), weight(row).sqrt(), &mut out);
            Some(out)
        });
        let combined = lines.iter().filter(|l| l.weight > 0.0).map(|line| {
            let mut out = Vec::new();
            for k in 0..2 {
                self.mobility.act(
                    gluing.special(line.row + k),
                    line.weight.sqrt() * line.direction[k],
                    &mut out,
                );
            }
            out
        });
        self.mobility.free(plain.chain(combined))
    }
}

/// A Cholesky factor of `G W G^T` and the projectors that belong to it.
///
/// With `W = I` (no weights): `P = I - G^T (G G^T)^-1 G` and `Q = I - P` are the paper's orthogonal projectors. With
/// weights the projector `I - W G^T (G W G^T)^-1 G` maps to the kernel of `G` by changing only rows of positive weight.
#[derive(Debug, Clone)]
pub struct CoarseFactor(Arc<FactorData>);

#[derive(Debug)]
struct FactorData {
    coarse: Coarse,
    factor: SparseCholesky,
    weights: Option<RowWeights>,
    free: Vec<FreeMotion>,
}

impl CoarseFactor {
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
        self.0.coarse.scratch()
    }

    /// `y = (G W G^T)^-1 y`.
    pub fn solve(&self, y: &mut [f64], s: &mut CoarseScratch) {
        self.0.factor.solve(y, 1, &mut s.memory);
    }

    fn weigh(&self, x: &mut [f64]) {
        if let Some(weights) = &self.0.weights {
            weights.apply(x);
        }
    }

    /// `x = x - W G^T (G W G^T)^-1 (G x - e)`: the closest point (in the metric of `W`) with `G x = e`; `e = 0` if `None`.
    pub fn project(&self, x: &mut [f64], e: Option<&[f64]>, s: &mut CoarseScratch) {
        let data = &self.0.coarse.0;
        data.product(x, &mut s.first, &mut s.boundary, &mut s.columns);
        if let Some(e) = e {
            s.first.iter_mut().zip(e).for_each(|(v, e)| *v -= e);
        }
        self.0.factor.solve(&mut s.first, 1, &mut s.memory);
        data.product_transpose(&s.first, &mut s.dual, &mut s.boundary, &mut s.columns);
        self.weigh(&mut s.dual);
        signorini_qp::vector::subtract(&s.dual, x);
    }

    /// `r = r - G^T (G W G^T)^-1 G W r`: the transpose of [`CoarseFactor::project`] with `e = 0`. Returns in `alpha` the
    /// amplitudes `-(G W G^T)^-1 G W r`, so that the result is `r + G^T alpha`.
    pub fn project_transpose(&self, r: &mut [f64], alpha: &mut [f64], s: &mut CoarseScratch) {
        self.amplitudes(r, alpha, s);
        let data = &self.0.coarse.0;
        data.product_transpose(alpha, &mut s.dual, &mut s.boundary, &mut s.columns);
        for (r, g) in r.iter_mut().zip(&s.dual) {
            *r += g;
        }
    }

    /// Rigid amplitudes that make the rows residual `r + G^T alpha` smallest in the metric of `W`:
    /// `alpha = -(G W G^T)^-1 G W r` with `r = F lambda - d`. Give weight zero to the rows that are not satisfied with
    /// equality (open contact, sliding).
    pub fn amplitudes(&self, r: &[f64], alpha: &mut [f64], s: &mut CoarseScratch) {
        let data = &self.0.coarse.0;
        s.dual.copy_from_slice(r);
        self.weigh(&mut s.dual);
        data.product(&s.dual, alpha, &mut s.boundary, &mut s.columns);
        self.0.factor.solve(alpha, 1, &mut s.memory);
        alpha.iter_mut().for_each(|a| *a = -*a);
    }

    /// `x = W G^T (G W G^T)^-1 e`: a solution of `G x = e`; the paper's `lambda_Im` for `W = I`.
    pub fn particular(&self, e: &[f64], x: &mut [f64], s: &mut CoarseScratch) {
        let data = &self.0.coarse.0;
        s.first.copy_from_slice(e);
        self.0.factor.solve(&mut s.first, 1, &mut s.memory);
        data.product_transpose(&s.first, x, &mut s.boundary, &mut s.columns);
        self.weigh(x);
    }

    /// The orthonormal basis `C = L^-1 P G` of the row space of `G`, where `P G G^T P^T = L L^T`. `None` if there are
    /// weights or free motions.
    #[must_use]
    pub fn orthonormal(&self) -> Option<OrthonormalCoarse> {
        (self.0.weights.is_none() && self.0.free.is_empty())
            .then(|| OrthonormalCoarse(self.clone()))
    }
}

/// The constraint `G x = e` with orthonormal rows: `C x = L^-1 P e` with `C = L^-1 P G`, `C C^T = I`.
#[derive(Debug, Clone)]
pub struct OrthonormalCoarse(CoarseFactor);

impl OrthonormalCoarse {
    /// Right-hand side of the orthonormal rows: `out = L^-1 P e`.
    pub fn rhs(&self, e: &[f64], out: &mut [f64], s: &mut CoarseScratch) {
        self.0.0.factor.half_solve(e, out, &mut s.memory);
    }

    /// Rigid amplitudes of a multiplier `beta` of the orthonormal rows: `alpha = P^T L^-T beta`, so that
    /// `G^T alpha = C^T beta`.
    pub fn amplitudes(&self, beta: &[f64], alpha: &mut [f64], s: &mut CoarseScratch) {
        s.first.copy_from_slice(beta);
        self.0
            .0
            .factor
            .half_solve_transpose(&mut s.first, alpha, &mut s.memory);
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
        data.product(x, &mut s.first, &mut s.boundary, &mut s.columns);
        self.0.0.factor.half_solve(&s.first, y, &mut s.memory);
    }

    fn apply_transpose(&self, y: &[f64], x: &mut [f64], s: &mut CoarseScratch) {
        let data = &self.0.coarse().0;
        s.first.copy_from_slice(y);
        self.0
            .0
            .factor
            .half_solve_transpose(&mut s.first, &mut s.second, &mut s.memory);
        data.product_transpose(&s.second, x, &mut s.boundary, &mut s.columns);
    }
}
