//! The natural coarse space: `G = R^T B^T`, its products and factors of `G W G^T`.

use crate::coarse::matrix::{CoarseMatrix, ModeTable};
use crate::coarse::mobility::{FreeMotion, Mobility};
use crate::coarse::products::{RigidTables, Wrench};
use crate::coarse::weights::RowWeights;
use crate::dual::boundary::BoundaryMap;
use crate::error::TfetiError;
use crate::linalg::sparse::{MemoryNeed, SolveMemory, Symbolic};
use crate::linalg::tiles::Digits;
use crate::rows::gluing::Gluing;
use crate::subdomain::matrices::Subdomains;
use crate::tolerances::{MOVING, SUPPORTED};
use signorini_qp::internal::LooseMode;
use std::sync::{Arc, OnceLock};

/// `G = R^T B^T`: six rows per subdomain, in the order of the subdomains.
#[derive(Debug, Clone)]
pub struct Coarse(pub(crate) Arc<CoarseData>);

#[derive(Debug)]
pub(crate) struct CoarseData {
    map: Arc<BoundaryMap>,
    tables: RigidTables,
    pub(crate) subdomains: Arc<Subdomains>,
    /// All rows, also where vectors are parts.
    pub(crate) gluing: Arc<Gluing>,
    pub(crate) matrix: Arc<CoarseMatrix>,
    /// Of a factor of the whole matrix, made when it is first asked for.
    symbolic: Arc<OnceLock<Symbolic>>,
    pub(crate) mobility: Arc<Mobility>,
    /// Whether what is no contact row holds all bodies.
    supports_suffice: bool,
}

/// Work memory of all operations with `G` and its factors.
#[derive(Debug)]
pub struct CoarseScratch {
    /// Wrenches by glob and subdomain.
    pub(crate) sides: Vec<Wrench>,
    /// Motions by subdomain.
    pub(crate) motions: Vec<[f64; 6]>,
    /// The right side of a solve, then what solves it.
    pub(crate) side: Vec<f64>,
    /// A right side, or amplitudes, that another solve leaves alone.
    pub(crate) kept: Vec<f64>,
    /// A vector of rows.
    pub(crate) dual: Vec<f64>,
    /// For sparse factors.
    pub(crate) memory: SolveMemory,
    /// What split factors are read with.
    pub(crate) digits: Digits,
    /// For split factors.
    pub(crate) split: Vec<f64>,
    /// Entries of the rows that stand in lines.
    pub(crate) pairs: Vec<[f64; 2]>,
}

impl Coarse {
    /// With the pattern of a factor of the whole matrix if that is known to be `wanted`.
    pub(crate) fn new(
        map: Arc<BoundaryMap>,
        subdomains: Arc<Subdomains>,
        gluing: Arc<Gluing>,
        centres: Vec<[f64; 3]>,
        wanted: bool,
    ) -> Result<Self, TfetiError> {
        let modes = ModeTable::new(&subdomains);
        let matrix = CoarseMatrix::new(&gluing, &modes);
        drop(modes);
        let (symbolic, (mobility, tables)) = rayon::join(
            || wanted.then(|| analyse(&matrix)).transpose(),
            || {
                let mobility = Mobility::new(subdomains.clone(), &gluing, centres);
                (
                    mobility,
                    RigidTables::new(&map, subdomains.clone(), &gluing, Vec::new()),
                )
            },
        );
        let symbolic = symbolic?.map_or_else(OnceLock::new, OnceLock::from);
        let mut data = CoarseData {
            tables,
            map,
            subdomains,
            gluing,
            matrix: Arc::new(matrix),
            symbolic: Arc::new(symbolic),
            mobility: Arc::new(mobility),
            supports_suffice: false,
        };
        let mut supports = RowWeights::diagonal(vec![1.0; data.map.rows()]);
        supports.diagonal[data.gluing.ranges().contact()].fill(0.0);
        data.supports_suffice = data.free_motions(Some(&supports)).is_empty();
        Ok(Self(Arc::new(data)))
    }

    /// The same space for vectors of which each rank keeps a part, with the `rows` of this one.
    pub(crate) fn of_part(&self, map: Arc<BoundaryMap>, rows: &Gluing) -> Self {
        let data = &self.0;
        let rank = |s: usize| data.subdomains.rank_of(s) as u32;
        let ranks = (0..data.subdomains.count()).map(rank).collect();
        Self(Arc::new(CoarseData {
            tables: RigidTables::new(&map, data.subdomains.clone(), rows, ranks),
            map,
            subdomains: data.subdomains.clone(),
            gluing: data.gluing.clone(),
            matrix: data.matrix.clone(),
            symbolic: data.symbolic.clone(),
            mobility: data.mobility.clone(),
            supports_suffice: data.supports_suffice,
        }))
    }

    /// Number of rows of `G`: six per subdomain.
    pub fn rows(&self) -> usize {
        6 * self.0.subdomains.count()
    }

    /// Length of dual vectors.
    pub fn dim(&self) -> usize {
        self.0.map.rows()
    }

    /// Mean of the nodes of a subdomain.
    pub(crate) fn centre(&self, subdomain: usize) -> [f64; 3] {
        self.0.mobility.centres()[subdomain]
    }

    /// Number of bodies: sets of subdomains that interface rows join, be it by a hinge.
    pub fn bodies(&self) -> usize {
        self.0.mobility.bodies()
    }

    /// The body of each subdomain; bodies are numbered by their first subdomains.
    #[doc(hidden)]
    pub fn body_of(&self) -> &[u32] {
        &self.0.mobility.body_of
    }

    /// Numbers stored for a factor of the whole matrix `G W G^T`; `usize::MAX` if there can be none.
    pub fn factor_size(&self) -> usize {
        self.0.symbolic().map_or(usize::MAX, Symbolic::stored)
    }

    /// Creates the work memory.
    pub fn scratch(&self) -> CoarseScratch {
        let rows = self.rows();
        CoarseScratch {
            sides: vec![Wrench::default(); self.0.tables.work()],
            motions: vec![[0.0; 6]; rows / 6],
            side: vec![0.0; rows],
            kept: vec![0.0; rows],
            dual: vec![0.0; self.dim()],
            memory: SolveMemory::new(MemoryNeed::NONE),
            digits: Digits::Double,
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

    /// The same with work memory of its own.
    #[doc(hidden)]
    pub fn transpose_times(&self, y: &[f64], out: &mut [f64]) {
        self.0.product_transpose(y, out, &mut vec![[0.0; 6]; self.rows() / 6]);
    }

    /// A motion of bodies as a mode of the leading `contact` rows, with those of these `springs` that it stretches.
    pub(crate) fn loose_mode(&self, amplitudes: &[f64], contact: usize, springs: &[usize]) -> LooseMode {
        let mut row = vec![0.0; self.dim()];
        self.transpose_times(amplitudes, &mut row);
        let mut mode = LooseMode::new(amplitudes.to_vec(), &row[..contact]);
        let stretched = |&i: &usize| {
            let spring = self.0.gluing.spring(i)?;
            (row[i].abs() > MOVING * spring.scale).then(|| (i, row[i], spring.compliance.recip()))
        };
        mode.springs = springs.iter().filter_map(stretched).collect();
        mode
    }

    /// Rigid motions of bodies that rows of positive weight leave free; all rows count if there are no weights.
    ///
    /// # Errors
    /// [`TfetiError::Setting`] and [`TfetiError::Length`] for weights that cannot be used.
    pub fn free_motions(&self, weights: Option<&RowWeights>) -> Result<Vec<FreeMotion>, TfetiError> {
        if let Some(weights) = weights {
            weights.validate(self.0.gluing.ranges())?;
        }
        Ok(self.0.free_motions(weights))
    }
}

/// Order and pattern of a factor of the whole matrix.
fn analyse(matrix: &CoarseMatrix) -> Result<Symbolic, TfetiError> {
    let (what, count) = ("coarse unknowns", matrix.pattern().dim);
    Symbolic::new(matrix.pattern(), 6).map_err(|_| TfetiError::TooLarge { what, count })
}

impl CoarseData {
    /// Order and pattern of a factor of the whole matrix.
    pub(crate) fn symbolic(&self) -> Result<&Symbolic, TfetiError> {
        if let Some(symbolic) = self.symbolic.get() {
            return Ok(symbolic);
        }
        let symbolic = analyse(&self.matrix)?;
        Ok(self.symbolic.get_or_init(|| symbolic))
    }

    /// `out = G W x`; `W` is one on interface rows and given by `weights` on the others.
    pub(crate) fn product(&self, x: &[f64], weights: Option<&[f64]>, out: &mut [f64], sides: &mut [Wrench]) {
        self.product_here(x, weights, out, sides);
        self.tables.complete(&self.map, out);
    }

    /// The same on the subdomains of this process, where each has its part of vectors.
    pub(crate) fn product_here(&self, x: &[f64], weights: Option<&[f64]>, out: &mut [f64], sides: &mut [Wrench]) {
        self.tables.wrenches(&self.map, x, weights, out, sides);
    }

    /// `out = G x` for a vector of which `contact` are the leading entries, the contact rows, and the others are zero.
    pub(crate) fn contact_product(&self, contact: &[f64], out: &mut [f64]) {
        self.tables.contact_wrenches(contact, out);
    }

    /// `out = G^T y` on the contact rows alone.
    pub(crate) fn contact_transpose(&self, y: &[f64], out: &mut [f64], motions: &mut [[f64; 6]]) {
        self.motions(y, motions);
        self.tables.contact_motions(motions, out);
    }

    /// Whether work on all interface rows is worth several threads.
    pub(crate) fn is_large(&self) -> bool {
        self.map.is_large()
    }

    /// Motions of the subdomains from amplitudes.
    fn motions(&self, y: &[f64], motions: &mut [[f64; 6]]) {
        let both = y.chunks_exact(6).zip(motions);
        for (s, (amplitudes, target)) in both.enumerate() {
            let kernel = self.subdomains.kernel(s);
            *target = kernel.motion(amplitudes);
            target[3..].iter_mut().for_each(|w| *w /= kernel.radius());
        }
    }

    /// `out = G^T y`.
    pub(crate) fn product_transpose(&self, y: &[f64], out: &mut [f64], motions: &mut [[f64; 6]]) {
        self.with_transpose(y, out, true, motions, |x, v| *x = v, |_, x, v| *x = v);
    }

    /// `x = x + G^T y`.
    pub(crate) fn add_transpose(&self, y: &[f64], x: &mut [f64], motions: &mut [[f64; 6]]) {
        self.with_transpose(y, x, true, motions, |x, v| *x += v, |_, x, v| *x += v);
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
        self.tables
            .for_motions(&self.map, motions, x, contact, interface, other);
    }

    /// Adds springs that stop free motions to the values of the matrix, as stiff as its mean diagonal entry.
    pub(crate) fn hold(&self, free: &[FreeMotion], values: &mut [f64]) {
        if free.is_empty() {
            return;
        }
        let mean = self.matrix.diagonal(values).sum::<f64>() / self.matrix.pattern().dim.max(1) as f64;
        let strength = if mean > 0.0 { mean } else { 1.0 };
        for (subdomain, spring) in self.mobility.springs(free) {
            let row = [(subdomain as u32, spring)];
            self.matrix.add_row(&row, strength, values);
        }
    }

    pub(crate) fn free_motions(&self, weights: Option<&RowWeights>) -> Vec<FreeMotion> {
        let gluing = &self.gluing;
        // The usual case needs no look at the contact rows.
        let supported = |w: &RowWeights| {
            let ranges = gluing.ranges();
            let mut rows = ranges.rigid.start..ranges.dirichlet.end;
            rows.all(|row| w.of(row) >= SUPPORTED)
        };
        if self.supports_suffice && weights.is_none_or(supported) {
            return Vec::new();
        }
        let weight = |row: usize| weights.map_or(1.0, |w| w.of(row));
        let lines = weights.map_or(&[][..], |w| &w.lines);
        let plain = (0..gluing.nodal_rows()).filter_map(|nodal| {
            let row = gluing.nodal_row(nodal);
            if weight(row) == 0.0 || weights.is_some_and(|w| w.in_line(row)) {
                return None;
            }
            let mut out = Vec::new();
            self.mobility.act(gluing.nodal(nodal), weight(row).sqrt(), &mut out);
            Some(out)
        });
        let combined = lines.iter().filter(|l| l.weight > 0.0).map(|line| {
            let mut out = Vec::new();
            for k in 0..2 {
                self.mobility.act(
                    gluing.nodal(line.row + k),
                    line.weight.sqrt() * line.direction[k],
                    &mut out,
                );
            }
            out
        });
        self.mobility.free(plain.chain(combined))
    }
}
