//! The dual operator `F = B K+ B^T`, with what springs and compliant contact add.

use crate::dual::boundary::{BoundaryMap, Panel, PanelScratch};
use crate::dual::inverses::ClassInverse;
use crate::dual::part::RowPart;
use crate::linalg::dense;
use crate::rows::gluing::Gluing;
use crate::subdomain::matrices::Subdomains;
use crate::tolerances::PRODUCT;
use signorini_qp::{SymmetricOperator, vector};
use std::sync::Arc;

/// `F = B K+ B^T`, applied without forming it; where springs or contact rows give way, with their compliance on the
/// diagonal.
///
/// Each product gathers the multipliers of every subdomain into the columns of one matrix per class, multiplies it by
/// the class's boundary inverse (or solves with its sparse factor) and gathers the rows of `B` from the result.
#[derive(Debug, Clone)]
pub struct DualOperator {
    pub(crate) map: Arc<BoundaryMap>,
    pub(crate) subdomains: Arc<Subdomains>,
    pub(crate) inverses: Arc<Vec<Option<ClassInverse>>>,
    gluing: Arc<Gluing>,
    parallel: bool,
    /// Where ranks keep parts of vectors.
    part: Option<Arc<RowPart>>,
}

/// Work memory of a product with `F`.
#[derive(Debug)]
pub struct DualScratch(PanelScratch);

impl DualOperator {
    pub(crate) fn new(
        map: Arc<BoundaryMap>,
        subdomains: Arc<Subdomains>,
        inverses: Arc<Vec<Option<ClassInverse>>>,
        gluing: Arc<Gluing>,
    ) -> Self {
        let parallel = product_flops(&map, &inverses) > PRODUCT;
        Self {
            map,
            subdomains,
            inverses,
            gluing,
            parallel,
            part: None,
        }
    }

    /// The same for vectors of which each rank keeps a part; rows must not give way.
    pub(crate) fn of_part(&self, map: Arc<BoundaryMap>, part: Arc<RowPart>) -> Self {
        Self {
            map,
            part: Some(part),
            ..self.clone()
        }
    }

    /// Floating-point operations of one product (multiplications and additions) in the dense or sparse kernels of this
    /// rank.
    pub fn flops(&self) -> u64 {
        product_flops(&self.map, &self.inverses)
    }
}

/// Floating-point operations in the dense or sparse kernels.
fn product_flops(map: &BoundaryMap, inverses: &[Option<ClassInverse>]) -> u64 {
    let panel = |panel: &Panel| {
        let size = 3 * map.classes[panel.class].nodes.len();
        let per_member = |inverse: &ClassInverse| match inverse.boundary {
            Some(_) => 2 * size * size,
            None => 4 * inverse.full.stored(),
        };
        (inverses[panel.class].as_ref().map_or(0, per_member) * panel.columns.len()) as u64
    };
    map.own_panels().iter().map(panel).sum()
}

/// `out = a x` for each member of a panel: `a` is symmetric, members are rows.
pub(crate) fn multiply_members(out: &mut [f64], x: &[f64], a: &[f64], members: usize, size: usize) {
    if members == 1 {
        dense::multiply(out, a, x, size, size, 1);
    } else {
        dense::multiply(out, x, a, members, size, size);
    }
}

/// Writes the boundary rows of a panel into full columns.
fn expand(nodes: &[u32], boundary: &[f64], full: &mut [f64], dim: usize) {
    let width = full.len() / dim;
    for (&node, values) in nodes.iter().zip(boundary.chunks_exact(3 * width)) {
        for (k, value) in values.iter().enumerate() {
            full[(k % width) * dim + 3 * node as usize + k / width] = *value;
        }
    }
}

/// Reads the boundary rows of full columns.
fn restrict(nodes: &[u32], full: &[f64], boundary: &mut [f64], dim: usize) {
    let width = full.len() / dim;
    for (&node, values) in nodes.iter().zip(boundary.chunks_exact_mut(3 * width)) {
        for (k, value) in values.iter_mut().enumerate() {
            *value = full[(k % width) * dim + 3 * node as usize + k / width];
        }
    }
}

impl SymmetricOperator for DualOperator {
    type Scratch = DualScratch;

    fn dim(&self) -> usize {
        self.map.rows()
    }

    fn scratch(&self) -> DualScratch {
        DualScratch(self.map.scratch(|panel| {
            let (inverse, columns) = (self.inverses[panel.class].as_ref()?, panel.columns.len());
            let dim = self.subdomains.bases[panel.class].diagonal.len();
            let full = if inverse.full.is_packed() { 0 } else { dim * columns };
            inverse.boundary.is_none().then(|| (full, inverse.full.need(columns)))
        }))
    }

    fn apply(&self, x: &[f64], y: &mut [f64], s: &mut DualScratch) {
        self.map
            .by_panels(x, y, self.parallel, &mut s.0, &|panel, x, y, full, memory| {
                let (columns, class) = (panel.columns.len(), panel.class);
                let Some(inverse) = &self.inverses[class] else {
                    return;
                };
                if let Some(matrix) = &inverse.boundary {
                    multiply_members(y, x, matrix, columns, x.len() / columns);
                } else if let Some(memory) = memory {
                    let base = &self.subdomains.bases[class];
                    let (nodes, dim) = (&self.map.classes[class].nodes, base.diagonal.len());
                    if inverse.full.apply_at(&base.kernel, nodes, x, y, memory) {
                        return;
                    }
                    let full = &mut full[..dim * columns];
                    full.fill(0.0);
                    expand(nodes, x, full, dim);
                    inverse.full.apply(&base.kernel, full, columns, memory);
                    restrict(nodes, full, y, dim);
                }
            });
        self.gluing.add_compliance(x, y);
    }

    fn dot(&self, x: &[f64], y: &[f64]) -> f64 {
        match &self.part {
            Some(part) => part.dots([(x, y)])[0],
            None => vector::dot(x, y),
        }
    }

    fn dots<const K: usize>(&self, pairs: [(&[f64], &[f64]); K]) -> [f64; K] {
        match &self.part {
            Some(part) => part.dots(pairs),
            None => vector::dots(pairs),
        }
    }

    fn sum(&self, x: &[f64]) -> f64 {
        let Some(part) = &self.part else {
            return x.iter().sum();
        };
        let mut whole = vec![0.0; self.gluing.rows_full_rank()];
        part.complete(x, &mut whole);
        whole.iter().sum()
    }
}
