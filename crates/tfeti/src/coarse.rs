//! The natural coarse space: `G = R^T B^T`, its products and factors of `G W G^T`.

use crate::boundary::{BoundaryMap, RigidTables, Wrench};
use crate::class::Classes;
use crate::coarse_factor::{CoarseFactor, Factor};
use crate::coarse_matrix::{CoarseMatrix, ModeTable};
use crate::error::TfetiError;
use crate::gluing::Gluing;
use crate::kernel::Kernel;
use crate::matrices::ClassBase;
use crate::mobility::{FreeMotion, Mobility};
use crate::row_weights::RowWeights;
use crate::sparse::{FactorError, SolveMemory, SparseCholesky, Symbolic};
use crate::split_factor::{SplitBase, cheapest_tree};
use signorini_qp::internal::LooseMode;
use std::sync::Arc;

/// `G = R^T B^T`: six rows per subdomain, in the order of the subdomains.
#[derive(Debug, Clone)]
pub struct Coarse(pub(crate) Arc<CoarseData>);

#[derive(Debug)]
pub(crate) struct CoarseData {
    map: Arc<BoundaryMap>,
    tables: RigidTables,
    bases: Arc<Vec<ClassBase>>,
    classes: Arc<Classes>,
    pub(crate) gluing: Arc<Gluing>,
    matrix: CoarseMatrix,
    symbolic: Symbolic,
    mobility: Mobility,
    /// Whether the support rows alone hold all bodies.
    held: bool,
}

/// Work memory of all operations with `G` and its factors.
#[derive(Debug)]
pub struct CoarseScratch {
    /// Wrenches by glob and subdomain.
    pub(crate) sides: Vec<Wrench>,
    /// Motions by subdomain.
    pub(crate) motions: Vec<[f64; 6]>,
    pub(crate) first: Vec<f64>,
    pub(crate) second: Vec<f64>,
    pub(crate) dual: Vec<f64>,
    pub(crate) memory: SolveMemory,
    /// For split factors.
    pub(crate) split: Vec<f64>,
    /// Entries of the rows that stand in lines.
    pub(crate) pairs: Vec<[f64; 2]>,
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
        let (symbolic, (mobility, tables)) = rayon::join(
            || Symbolic::new(matrix.pattern(), 6).map_err(too_large),
            || {
                let mobility = Mobility::new(classes.clone(), bases.clone(), &gluing, centres);
                (mobility, RigidTables::new(&map, &bases, &classes, &gluing))
            },
        );
        let symbolic = symbolic?;
        let mut data = CoarseData {
            tables,
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

    /// Number of bodies: sets of subdomains that interface rows join, be it by a hinge.
    #[must_use]
    pub fn bodies(&self) -> usize {
        self.0.mobility.bodies()
    }

    /// The body of each subdomain; bodies are numbered by their first subdomains.
    #[must_use]
    pub fn body_of(&self) -> &[u32] {
        self.0.mobility.body_of()
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
            sides: vec![Wrench::default(); self.0.tables.work()],
            motions: vec![[0.0; 6]; rows / 6],
            first: vec![0.0; rows],
            second: vec![0.0; rows],
            dual: vec![0.0; self.dim()],
            memory: SolveMemory::new(SparseCholesky::need_of(&self.0.symbolic, 1)),
            split: Vec::new(),
            pairs: Vec::with_capacity(self.0.gluing.ranges().discs.len() / 2),
        }
    }

    /// `out = G x`: the wrenches of the multipliers on the subdomains.
    pub fn apply(&self, x: &[f64], out: &mut [f64], s: &mut CoarseScratch) {
        self.0.product(x, None, out, &mut s.sides);
    }

    /// `out = G^T y`.
    pub fn apply_transpose(&self, y: &[f64], out: &mut [f64], s: &mut CoarseScratch) {
        self.0.product_transpose(y, out, &mut s.motions);
    }

    /// Row `row` of `G^T`, for inspection: `(subdomain, six coefficients)`.
    ///
    /// # Panics
    /// If there is no such row.
    #[must_use]
    pub fn column(&self, row: usize) -> Vec<(usize, [f64; 6])> {
        let mut out: Vec<(usize, [f64; 6])> = Vec::new();
        for (subdomain, dof, value) in self.0.gluing.row(row) {
            let kernel = self.0.kernel(subdomain);
            let modes = kernel.node_modes(dof / 3)[dof % 3].map(|m| value * m);
            match out.iter_mut().find(|v| v.0 == subdomain) {
                Some(v) => (0..6).for_each(|k| v.1[k] += modes[k]),
                None => out.push((subdomain, modes)),
            }
        }
        out
    }

    /// A motion of bodies as a mode of the leading `contact` rows.
    pub(crate) fn loose_mode(&self, amplitudes: &[f64], contact: usize) -> LooseMode {
        let mut row = vec![0.0; self.dim()];
        let mut scratch = self.scratch();
        self.0
            .product_transpose(amplitudes, &mut row, &mut scratch.motions);
        row.truncate(contact);
        LooseMode::new(amplitudes.to_vec(), row)
    }

    /// Rigid motions of bodies that rows of positive weight leave free; all rows count if there are no weights.
    ///
    /// # Errors
    /// [`TfetiError::Setting`] and [`TfetiError::Length`] for weights that cannot be used.
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
    ///
    /// # Errors
    /// [`TfetiError::CoarseSingular`] if a pivot is not positive, [`TfetiError::TooLarge`].
    pub fn factor(&self) -> Result<CoarseFactor, TfetiError> {
        self.factor_with(None)
    }

    /// Factor of `G W G^T`.
    ///
    /// If some rigid motions of bodies escape all rows of positive weight (see [`CoarseFactor::free_motions`]), the matrix
    /// is singular; it is then regularised such that solves apply a generalised inverse, exact for right-hand sides that
    /// do no work on the free motions.
    ///
    /// # Errors
    /// As [`free_motions`](Self::free_motions) and [`factor`](Self::factor).
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
            let diagonal = (0..matrix.dim).map(|i| matrix.diagonal(i));
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
        Ok(CoarseFactor::new(
            self.clone(),
            Factor::Sparse(factor),
            weights,
            free,
        ))
    }

    /// What factors for changing weights of the first `rows` rows have in common, if these are contact rows and the
    /// factor can be split. `metric` is the weight of each row where it counts, one if `None`.
    pub(crate) fn split(&self, rows: usize, metric: Option<&[f64]>) -> Option<SplitBase> {
        let data = &self.0;
        let gluing = &data.gluing;
        let weights = metric.map(|m| RowWeights::diagonal(m.to_vec()));
        if rows > gluing.ranges().interface.start || !data.free_motions(weights.as_ref()).is_empty()
        {
            return None;
        }
        let mut changing = vec![false; data.classes.subdomains()];
        for e in (0..rows).flat_map(|row| gluing.special(row)) {
            changing[e.subdomain as usize] = true;
        }
        let graph = data.matrix.graph();
        let tree = cheapest_tree(&graph, data.mobility.centres(), &changing)?;
        let modes = ModeTable::new(&data.bases, &data.classes);
        let mut diagonal = match metric {
            Some(metric) => metric.to_vec(),
            None => vec![1.0; self.dim()],
        };
        diagonal[..rows].fill(0.0);
        let weights = RowWeights::diagonal(diagonal);
        let matrix = data.matrix.assemble(gluing, &modes, Some(&weights));
        SplitBase::new(
            tree,
            &data.matrix,
            &graph,
            &matrix.values,
            gluing,
            &modes,
            rows,
        )
        .ok()
    }
}

impl CoarseData {
    fn kernel(&self, subdomain: usize) -> &Kernel {
        &self.bases[self.classes.place(subdomain).0].kernel
    }

    /// `out = G W x`; `W` is one on interface rows and given by `weights` on the others.
    pub(crate) fn product(
        &self,
        x: &[f64],
        weights: Option<&[f64]>,
        out: &mut [f64],
        sides: &mut [Wrench],
    ) {
        self.map
            .wrenches(&self.tables, |s| self.kernel(s), x, weights, out, sides);
    }

    /// `out = G x` for a vector of which `contact` are the leading entries, the contact rows, and the others are zero.
    pub(crate) fn contact_product(&self, contact: &[f64], out: &mut [f64]) {
        self.map
            .contact_wrenches(&self.tables, |s| self.kernel(s), contact, out);
    }

    /// Whether work on all interface rows is worth several threads.
    pub(crate) fn is_large(&self) -> bool {
        self.map.is_large()
    }

    /// Motions of the subdomains from amplitudes.
    fn motions(&self, y: &[f64], motions: &mut [[f64; 6]]) {
        let both = y.chunks_exact(6).zip(motions);
        for (s, (amplitudes, target)) in both.enumerate() {
            let kernel = self.kernel(s);
            *target = kernel.motion(amplitudes);
            target[3..].iter_mut().for_each(|w| *w /= kernel.radius());
        }
    }

    /// `out = G^T y`.
    pub(crate) fn product_transpose(&self, y: &[f64], out: &mut [f64], motions: &mut [[f64; 6]]) {
        self.with_transpose(y, out, true, motions, |x, v| *x = v, |_, x, v| *x = v);
    }

    /// Hands `G^T y` to `interface(x, value)` and, on other rows, `other(row, x, value)`; to the latter without contact
    /// rows if there is no need of them.
    pub(crate) fn with_transpose(
        &self,
        y: &[f64],
        x: &mut [f64],
        contact: bool,
        motions: &mut [[f64; 6]],
        interface: impl Fn(&mut f64, f64) + Sync,
        other: impl Fn(usize, &mut f64, f64) + Sync,
    ) {
        self.motions(y, motions);
        self.map
            .for_motions(&self.tables, motions, x, contact, interface, other);
    }

    pub(crate) fn free_motions(&self, weights: Option<&RowWeights>) -> Vec<FreeMotion> {
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
