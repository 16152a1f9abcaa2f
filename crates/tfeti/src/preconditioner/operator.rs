//! The lumped and the Dirichlet preconditioner.
//!
//! Both are `B_D S B_D^T` with a stiffness `S` on the boundary nodes: the block `K_bb` (lumped) or the Schur complement
//! `K_bb - K_bi K_ii^-1 K_ib` (Dirichlet), with the directions of boundary nodes that no row touches in the interior.
//! Thin bodies between two planes, whose supports touch most nodes in one direction, have the Schur complement always:
//! the block alone is stiffer than them by the square of length over thickness. With orthonormal rows and copies that
//! are alike `B_D = B`; otherwise `B_D` distributes forces by stiffness, see [`Scaling`].

use crate::dual::boundary::{BoundaryClass, BoundaryMap, PanelScratch};
use crate::dual::operator::multiply_members;
use crate::error::TfetiError;
use crate::linalg::block_rows::BlockRows;
use crate::linalg::dense;
use crate::linalg::sparse::{Columns, FactorError, MemoryNeed, SolveMemory, SparseCholesky, Symbolic};
use crate::preconditioner::evened::even_out;
use crate::preconditioner::released::Released;
use crate::preconditioner::scaling::{Scaling, ScalingScratch};
use crate::preconditioner::split::{ClassRows, Eliminated, Split, is_thin};
use crate::preconditioner::springs::Springs;
use crate::subdomain::matrices::ClassMatrices;
use crate::system::part::SystemPart;
use crate::system::tfeti::Tfeti;
use crate::tolerances::{PANEL, PIVOT, SHARED};
use rayon::prelude::*;
use signorini_qp::SymmetricOperator;
use signorini_qp::active_set::{ActiveSetPreconditioner, ActiveSetView};
use std::collections::HashMap;
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
        /// `K_ib`.
        coupling: Columns,
        factor: SparseCholesky,
        released: Option<Box<Released>>,
    },
}

/// Factors of classes on an active set.
type Factors = HashMap<usize, SparseCholesky>;

/// Work memory of a preconditioner.
#[derive(Debug)]
pub struct DualPreconditionerScratch {
    panels: PanelScratch,
    dual: Vec<f64>,
    /// What springs leave of a vector; empty without.
    scaled: Vec<f64>,
    scaling: Option<ScalingScratch>,
    /// By class: its factor on an active set.
    factors: Factors,
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
        let map = system.dual.map.clone();
        let touched = ClassRows::of_classes(system);
        let mut classes: Vec<Option<BoundaryStiffness>> = (0..map.classes.len())
            .into_par_iter()
            .map(|k| {
                let held = system.dual.subdomains.held(k);
                let class = (&map.classes[k], &touched[k]);
                held.map(|own| BoundaryStiffness::new(own, class, kind)).transpose()
            })
            .collect::<Result<_, _>>()?;
        if kind == Kind::Lumped {
            let lumped = classes.iter_mut().map(|class| match class {
                Some(BoundaryStiffness::Lumped(block)) => Some(block),
                _ => None,
            });
            even_out(system, &map, lumped.collect());
        }
        // where only rows of single nodes depend on one another, none is better: measured on blocks in grooves
        let gluing = system.gluing();
        let plain = gluing.is_aligned && gluing.contact_compliance().is_empty();
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

    fn stiffness_product(&self, x: &[f64], y: &mut [f64], (s, factors): (&mut PanelScratch, &Factors)) {
        let divide = self.scaling.as_ref().map(|scaling| &scaling.weights[..]);
        self.map
            .by_panels(x, y, self.map.is_large(), s, &|panel, x, y, interior, memory| {
                let columns = panel.columns.len();
                let weights = divide.map(|w| &w[panel.copies.clone()]);
                scale_nodes(weights, x, columns);
                match &self.classes[panel.class] {
                    Some(class) => class.apply(x, y, columns, factors.get(&panel.class), (interior, memory)),
                    // rigid: a force without displacement
                    None => y.fill(0.0),
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
        let panels = self.map.scratch(|panel| match &self.classes[panel.class] {
            Some(class) => class.need(panel.columns.len()),
            None => (0, MemoryNeed::NONE),
        });
        let dual = if self.scaling.is_some() { self.dim() } else { 0 };
        DualPreconditionerScratch {
            panels,
            dual: vec![0.0; dual],
            scaled: vec![0.0; if self.springs.factors.is_empty() { 0 } else { self.dim() }],
            scaling: self.scaling.as_ref().map(Scaling::scratch),
            factors: HashMap::new(),
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
            self.stiffness_product(x, y, (&mut s.panels, &s.factors));
            return;
        };
        scaling.solve(x, y, scratch);
        self.stiffness_product(y, &mut s.dual, (&mut s.panels, &s.factors));
        scaling.add_compliance(y, &mut s.dual);
        scaling.solve(&s.dual, y, scratch);
    }
}

impl ActiveSetPreconditioner for DualPreconditioner {
    fn enter(&self, view: &ActiveSetView<'_>, s: &mut DualPreconditionerScratch) {
        if let (Some(scaling), Some(scratch)) = (&self.scaling, &mut s.scaling) {
            scaling.on_active_set(view, scratch);
        }
        for (k, class) in self.classes.iter().enumerate() {
            if let Some(BoundaryStiffness::Schur {
                released: Some(released),
                ..
            }) = class
            {
                s.factors.remove(&k);
                s.factors.extend(released.on_active_set(view).map(|factor| (k, factor)));
            }
        }
    }
}

impl BoundaryStiffness {
    fn new(base: &ClassMatrices, class: (&BoundaryClass, &ClassRows), kind: Kind) -> Result<Self, TfetiError> {
        let (layout, rows) = class;
        let shared = layout.members.len() >= SHARED;
        let touched = rows.all();
        let thin = is_thin(&touched);
        let eliminated = match kind {
            _ if thin && !shared && !rows.contact.is_empty() => Eliminated::Contact,
            Kind::Lumped if !thin => Eliminated::Nodes,
            _ => Eliminated::Directions,
        };
        let stiffness = base.preconditioning();
        let split = Split::new(&stiffness, (touched, &rows.always), eliminated);
        let lumped = || Self::Lumped(BlockRows::new(&split.boundary));
        if kind == Kind::Lumped && !thin || split.interior.dim == 0 {
            // Sparse also for shared classes: a tenth of the operations of a dense product.
            return Ok(lumped());
        }
        let error = |error| TfetiError::pattern(error, layout.members.first().map_or(0, |&s| s as usize));
        let released = match eliminated {
            Eliminated::Contact => Some(Box::new(Released::new(&split, &rows.contact).map_err(error)?)),
            _ => None,
        };
        let factor = match &released {
            Some(released) => released.with_all(),
            None => Self::factor(&split).map_err(error)?,
        };
        let Some(factor) = factor else {
            return Ok(lumped());
        };
        let sparse = Self::Schur {
            boundary: BlockRows::new(&split.boundary),
            coupling: split.coupling,
            factor,
            released,
        };
        Ok(if shared { Self::Dense(sparse.dense()) } else { sparse })
    }

    /// The factor of the interior; `None` where the boundary does not hold it.
    fn factor(split: &Split) -> Result<Option<SparseCholesky>, FactorError> {
        let symbolic = Symbolic::new(&split.interior, split.block)?;
        match SparseCholesky::new(&symbolic, &split.interior) {
            Ok(factor) => {
                let (smallest, _, largest) = factor.pivots();
                Ok((smallest > PIVOT * largest).then_some(factor))
            }
            Err(FactorError::Pivot(_)) => Ok(None),
            Err(error) => Err(error),
        }
    }

    fn dim(&self) -> usize {
        match self {
            Self::Dense(values) => values.len().isqrt(),
            Self::Lumped(matrix) | Self::Schur { boundary: matrix, .. } => matrix.dim(),
        }
    }

    /// Numbers and memory of solves that products with so many members need.
    fn need(&self, members: usize) -> (usize, MemoryNeed) {
        match self {
            Self::Schur { factor, .. } => (factor.dim() * members, factor.need(members)),
            _ => (0, MemoryNeed::NONE),
        }
    }

    /// The matrix in full, some columns at a time.
    fn dense(&self) -> Vec<f64> {
        let dim = self.dim();
        let (mut out, mut x, mut y) = (vec![0.0; dim * dim], vec![0.0; dim * PANEL], vec![0.0; dim * PANEL]);
        let (interior, need) = self.need(PANEL);
        let (mut interior, mut memory) = (vec![0.0; interior], SolveMemory::new(need));
        for start in (0..dim).step_by(PANEL) {
            let columns = PANEL.min(dim - start);
            let (x, y) = (&mut x[..dim * columns], &mut y[..dim * columns]);
            x.fill(0.0);
            (0..columns).for_each(|j| x[(start + j) * columns + j] = 1.0);
            self.apply(x, y, columns, None, (&mut interior, &mut memory));
            for (i, row) in y.chunks_exact(columns).enumerate() {
                row.iter()
                    .enumerate()
                    .for_each(|(j, v)| out[i + (start + j) * dim] = *v);
            }
        }
        dense::mirror_lower(&mut out, dim);
        out
    }

    /// `y = S x` for the members of a panel, which are next to one another, with the `other` factor if there is one.
    fn apply(
        &self,
        x: &[f64],
        y: &mut [f64],
        members: usize,
        other: Option<&SparseCholesky>,
        (interior, memory): (&mut [f64], &mut SolveMemory),
    ) {
        match self {
            Self::Dense(values) => multiply_members(y, x, values, members, y.len() / members),
            Self::Lumped(matrix) => matrix.apply(x, y, members),
            Self::Schur {
                boundary,
                coupling,
                factor,
                ..
            } => {
                let factor = other.unwrap_or(factor);
                boundary.apply(x, y, members);
                let dim = factor.dim();
                let interior = &mut interior[..dim * members];
                interior.fill(0.0);
                for (j, x) in x.chunks_exact(members).enumerate() {
                    let (rows, values) = coupling.column(j);
                    for (&i, v) in rows.iter().zip(values) {
                        x.iter().enumerate().for_each(|(m, x)| interior[m * dim + i] += v * x);
                    }
                }
                factor.solve(interior, members, memory);
                for (j, y) in y.chunks_exact_mut(members).enumerate() {
                    let (rows, values) = coupling.column(j);
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
