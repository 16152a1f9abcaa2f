//! The lumped and the Dirichlet preconditioner.
//!
//! Both are `B_D S B_D^T` with a stiffness `S` on the boundary nodes: the block `K_bb` (lumped) or the Schur complement
//! `K_bb - K_bi K_ii^-1 K_ib` (Dirichlet). With orthonormal rows and copies that are alike `B_D = B`; otherwise `B_D`
//! distributes forces by stiffness, see [`Scaling`].

use crate::dual::boundary::{BoundaryMap, PanelScratch};
use crate::dual::operator::multiply_members;
use crate::error::TfetiError;
use crate::linalg::block_rows::BlockRows;
use crate::linalg::dense;
use crate::linalg::sparse::{Columns, FactorError, MemoryNeed, SolveMemory, SparseCholesky, Symbolic};
use crate::preconditioner::scaling::{Scaling, ScalingScratch};
use crate::preconditioner::springs::Springs;
use crate::subdomain::matrices::ClassMatrices;
use crate::system::part::SystemPart;
use crate::system::tfeti::Tfeti;
use crate::tolerances::{PANEL, PIVOT, SHARED};
use rayon::prelude::*;
use signorini_qp::SymmetricOperator;
use signorini_qp::active_set::{ActiveSetPreconditioner, ActiveSetView};
use std::sync::Arc;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Lumped,
    Dirichlet,
}

/// A preconditioner for `F`: symmetric, positive semidefinite, close to the inverse of `F` on the kernel of `G`.
#[derive(Debug)]
pub struct DualPreconditioner {
    map: Arc<BoundaryMap>,
    /// `None` where another rank holds the class.
    classes: Vec<Option<BoundaryStiffness>>,
    scaling: Option<Scaling>,
    springs: Springs,
}

/// Stiffness on the boundary nodes of a class.
#[derive(Debug)]
enum BoundaryStiffness {
    Dense(Vec<f64>),
    Lumped(BlockRows),
    Schur {
        boundary: BlockRows,
        coupling: Coupling,
        factor: SparseCholesky,
    },
}

/// `K_ib` by columns.
#[derive(Debug)]
struct Coupling {
    interior: usize,
    columns: Columns,
}

/// Work memory of a preconditioner.
#[derive(Debug)]
pub struct DualPreconditionerScratch {
    panels: PanelScratch,
    dual: Vec<f64>,
    /// What springs leave of a vector; empty without.
    scaled: Vec<f64>,
    scaling: Option<ScalingScratch>,
}

impl Tfeti {
    /// The lumped preconditioner `B_D K_bb B_D^T`: cheap, no further factorisation.
    ///
    /// # Errors
    /// [`TfetiError::DependentRows`] for rows of nodes that cannot be scaled.
    pub fn lumped(&self) -> Result<DualPreconditioner, TfetiError> {
        DualPreconditioner::new(self, Kind::Lumped)
    }

    /// The Dirichlet preconditioner `B_D S B_D^T` with the Schur complement on the boundary nodes: fewer iterations, as
    /// costly as a product with `F`. Classes whose interior is not held by their boundary use the lumped block.
    ///
    /// # Errors
    /// As [`lumped`](Self::lumped), and [`TfetiError::FactorPattern`] if a factor is too large.
    pub fn dirichlet(&self) -> Result<DualPreconditioner, TfetiError> {
        DualPreconditioner::new(self, Kind::Dirichlet)
    }
}

impl DualPreconditioner {
    fn new(system: &Tfeti, kind: Kind) -> Result<Self, TfetiError> {
        let map = system.parts.map.clone();
        let classes = (0..map.classes.len())
            .into_par_iter()
            .map(|k| {
                let held = system.parts.subdomains.held(k);
                held.map(|own| BoundaryStiffness::new(own, &map, k, kind)).transpose()
            })
            .collect::<Result<_, _>>()?;
        // where only rows of single nodes depend on one another, none is better: measured on blocks in grooves
        let gluing = system.gluing();
        let plain = gluing.is_aligned() && gluing.contact_compliance().is_empty();
        let needs_scaling = !plain || !system.copy_stiffness().is_plain();
        let scaling = needs_scaling.then(|| Scaling::new(system)).transpose()?;
        let springs = Springs::new(system, needs_scaling);
        Ok(Self {
            map,
            classes,
            scaling,
            springs,
        })
    }

    /// The same for vectors of which each rank keeps a part.
    #[doc(hidden)]
    #[must_use]
    pub fn of_part(self, part: &SystemPart) -> Self {
        let map = part.map.clone();
        Self { map, ..self }
    }

    fn stiffness_product(&self, x: &[f64], y: &mut [f64], s: &mut PanelScratch) {
        let divide = self.scaling.as_ref().map(Scaling::weights);
        self.map
            .by_panels(x, y, self.map.is_large(), s, &|panel, x, y, interior, memory| {
                let columns = panel.columns.len();
                let weights = divide.map(|w| &w[panel.copies.clone()]);
                scale_nodes(weights, x, columns);
                if let Some(class) = &self.classes[panel.class] {
                    class.apply(x, y, columns, interior, memory);
                }
                scale_nodes(weights, y, columns);
            });
    }
}

fn scale_nodes(weights: Option<&[f64]>, values: &mut [f64], width: usize) {
    let Some(weights) = weights else { return };
    for (weights, value) in weights.chunks_exact(width).zip(values.chunks_exact_mut(3 * width)) {
        for component in value.chunks_exact_mut(width) {
            component.iter_mut().zip(weights).for_each(|(v, w)| *v *= w);
        }
    }
}

impl SymmetricOperator for DualPreconditioner {
    type Scratch = DualPreconditionerScratch;

    fn dim(&self) -> usize {
        self.map.rows()
    }

    fn scratch(&self) -> DualPreconditionerScratch {
        let panels = self
            .map
            .scratch(|panel| self.classes[panel.class].as_ref()?.need(panel.columns.len()));
        let dual = if self.scaling.is_some() { self.dim() } else { 0 };
        DualPreconditionerScratch {
            panels,
            dual: vec![0.0; dual],
            scaled: vec![0.0; if self.springs.factors.is_empty() { 0 } else { self.dim() }],
            scaling: self.scaling.as_ref().map(Scaling::scratch),
        }
    }

    fn apply(&self, x: &[f64], y: &mut [f64], s: &mut DualPreconditionerScratch) {
        if self.springs.factors.is_empty() {
            return self.apply_without_springs(x, y, s);
        }
        let mut scaled = std::mem::take(&mut s.scaled);
        scaled.copy_from_slice(x);
        self.springs.scale(&mut scaled);
        self.apply_without_springs(&scaled, y, s);
        self.springs.scale(y);
        self.springs.add_alone(x, y);
        s.scaled = scaled;
    }
}

impl DualPreconditioner {
    fn apply_without_springs(&self, x: &[f64], y: &mut [f64], s: &mut DualPreconditionerScratch) {
        let (Some(scaling), Some(scratch)) = (&self.scaling, &mut s.scaling) else {
            self.stiffness_product(x, y, &mut s.panels);
            return;
        };
        scaling.solve(x, y, scratch);
        self.stiffness_product(y, &mut s.dual, &mut s.panels);
        scaling.add_compliance(y, &mut s.dual);
        scaling.solve(&s.dual, y, scratch);
    }
}

impl ActiveSetPreconditioner for DualPreconditioner {
    fn enter(&self, view: &ActiveSetView<'_>, s: &mut DualPreconditionerScratch) {
        if let (Some(scaling), Some(scratch)) = (&self.scaling, &mut s.scaling) {
            scaling.on_active_set(view, scratch);
        }
    }
}

impl BoundaryStiffness {
    fn new(base: &ClassMatrices, map: &BoundaryMap, class: usize, kind: Kind) -> Result<Self, TfetiError> {
        let layout = &map.classes[class];
        let split = Split::new(base.preconditioning(), &layout.nodes);
        let shared = layout.members.len() >= SHARED;
        if kind == Kind::Lumped || split.coupling.interior == 0 {
            // Sparse also for shared classes: a tenth of the operations of a dense product.
            return Ok(Self::Lumped(BlockRows::new(&split.boundary)));
        }
        let subdomain = layout.members.first().map_or(0, |&s| s as usize);
        let factor = match Symbolic::new(&split.interior, 3).and_then(|s| SparseCholesky::new(&s, &split.interior)) {
            Ok(factor) => factor,
            Err(FactorError::Pivot(_)) => return Ok(Self::Lumped(BlockRows::new(&split.boundary))),
            Err(error) => return Err(TfetiError::pattern(error, subdomain)),
        };
        let (smallest, _, largest) = factor.pivots();
        if smallest <= PIVOT * largest {
            return Ok(Self::Lumped(BlockRows::new(&split.boundary)));
        }
        let sparse = Self::Schur {
            boundary: BlockRows::new(&split.boundary),
            coupling: split.coupling,
            factor,
        };
        Ok(if shared { Self::Dense(sparse.dense()) } else { sparse })
    }

    fn dim(&self) -> usize {
        match self {
            Self::Dense(values) => values.len().isqrt(),
            Self::Lumped(matrix) | Self::Schur { boundary: matrix, .. } => matrix.dim(),
        }
    }

    /// Numbers and memory of solves that products with so many members need.
    fn need(&self, members: usize) -> Option<(usize, MemoryNeed)> {
        match self {
            Self::Schur { coupling, factor, .. } => Some((coupling.interior * members, factor.need(members))),
            _ => None,
        }
    }

    /// The matrix in full, some columns at a time.
    fn dense(&self) -> Vec<f64> {
        let dim = self.dim();
        let (mut out, mut x, mut y) = (vec![0.0; dim * dim], vec![0.0; dim * PANEL], vec![0.0; dim * PANEL]);
        let (interior, need) = self.need(PANEL).unzip();
        let mut interior = vec![0.0; interior.unwrap_or(0)];
        let mut memory = need.map(SolveMemory::new);
        for start in (0..dim).step_by(PANEL) {
            let columns = PANEL.min(dim - start);
            let (x, y) = (&mut x[..dim * columns], &mut y[..dim * columns]);
            x.fill(0.0);
            (0..columns).for_each(|j| x[(start + j) * columns + j] = 1.0);
            self.apply(x, y, columns, &mut interior, memory.as_mut());
            for (i, row) in y.chunks_exact(columns).enumerate() {
                row.iter()
                    .enumerate()
                    .for_each(|(j, v)| out[i + (start + j) * dim] = *v);
            }
        }
        dense::mirror_lower(&mut out, dim);
        out
    }

    /// `y = S x` for the members of a panel, which are next to one another.
    fn apply(&self, x: &[f64], y: &mut [f64], members: usize, interior: &mut [f64], memory: Option<&mut SolveMemory>) {
        match self {
            Self::Dense(values) => multiply_members(y, x, values, members, y.len() / members),
            Self::Lumped(matrix) => matrix.apply(x, y, members),
            Self::Schur {
                boundary,
                coupling,
                factor,
            } => {
                boundary.apply(x, y, members);
                let dim = coupling.interior;
                let interior = &mut interior[..dim * members];
                interior.fill(0.0);
                for (j, x) in x.chunks_exact(members).enumerate() {
                    let (rows, values) = coupling.columns.column(j);
                    for (&i, v) in rows.iter().zip(values) {
                        x.iter().enumerate().for_each(|(m, x)| interior[m * dim + i] += v * x);
                    }
                }
                if let Some(memory) = memory {
                    factor.solve(interior, members, memory);
                }
                for (j, y) in y.chunks_exact_mut(members).enumerate() {
                    let (rows, values) = coupling.columns.column(j);
                    for (&i, v) in rows.iter().zip(values) {
                        y.iter_mut()
                            .enumerate()
                            .for_each(|(m, y)| *y -= v * interior[m * dim + i]);
                    }
                }
            }
        }
    }
}

/// The blocks of a stiffness matrix by boundary and interior.
struct Split {
    boundary: Columns,
    interior: Columns,
    coupling: Coupling,
}

impl Split {
    fn new(stiffness: &Columns, nodes: &[u32]) -> Self {
        let dim = stiffness.dim;
        // Place of each unknown: boundary ones first, with the interior ones counted on their own.
        let mut on_boundary = vec![false; dim];
        for &node in nodes {
            on_boundary[3 * node as usize..3 * node as usize + 3].fill(true);
        }
        let mut place = vec![0; dim];
        let (mut boundary, mut interior) = (0, 0);
        for i in 0..dim {
            let counter = if on_boundary[i] { &mut boundary } else { &mut interior };
            place[i] = *counter;
            *counter += 1;
        }
        let [mut bb, mut ii, mut ib] = [boundary, interior, boundary].map(Columns::empty);
        for j in 0..dim {
            let (rows, values) = stiffness.column(j);
            for (&i, &v) in rows.iter().zip(values) {
                let target = match (on_boundary[i], on_boundary[j]) {
                    (true, true) => &mut bb,
                    (false, false) => &mut ii,
                    (false, true) => &mut ib,
                    (true, false) => continue,
                };
                target.rows.push(place[i]);
                target.values.push(v);
            }
            if on_boundary[j] {
                bb.pointers.push(bb.rows.len());
                ib.pointers.push(ib.rows.len());
            } else {
                ii.pointers.push(ii.rows.len());
            }
        }
        Self {
            boundary: bb,
            interior: ii,
            coupling: Coupling { interior, columns: ib },
        }
    }
}
