//! The dual operator `F = B K+ B^T`, with what springs and compliant contact add.

use crate::dual::boundary::{BoundaryMap, Panel, PanelScratch};
use crate::dual::inverses::ClassInverse;
use crate::dual::part::RowPart;
use crate::linalg::dense;
use crate::linalg::sparse::MemoryNeed;
use crate::rows::gluing::Gluing;
use crate::subdomain::inverse::Inverse;
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
    pub(crate) gluing: Arc<Gluing>,
    parallel: bool,
    /// Where ranks keep parts of vectors.
    part: Option<Arc<RowPart>>,
}

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

/// Calls `f` for each place on the boundary of a panel of so many members with that in full columns.
fn for_places(nodes: &[u32], dim: usize, members: usize, mut f: impl FnMut(usize, usize)) {
    for (k, &node) in nodes.iter().enumerate() {
        for c in 0..3 {
            for m in 0..members {
                f((3 * k + c) * members + m, m * dim + 3 * node as usize + c);
            }
        }
    }
}

impl SymmetricOperator for DualOperator {
    type Scratch = PanelScratch;

    fn dim(&self) -> usize {
        self.map.rows()
    }

    fn scratch(&self) -> PanelScratch {
        self.map.scratch(|panel| match &self.inverses[panel.class] {
            Some(ClassInverse { full, boundary: None }) => {
                let columns = panel.columns.len();
                let dim = self.subdomains.bases[panel.class].diagonal.len();
                let numbers = if full.is_packed() { 0 } else { dim * columns };
                (numbers, full.need(columns))
            }
            _ => (0, MemoryNeed::NONE),
        })
    }

    fn apply(&self, x: &[f64], y: &mut [f64], s: &mut PanelScratch) {
        self.map
            .by_panels(x, y, self.parallel, s, &|panel, x, y, full, memory| {
                let (columns, class) = (panel.columns.len(), panel.class);
                let Some(inverse) = &self.inverses[class] else {
                    // rigid
                    return y.fill(0.0);
                };
                if let Some(matrix) = &inverse.boundary {
                    return multiply_members(y, x, matrix, columns, x.len() / columns);
                }
                let base = &self.subdomains.bases[class];
                let (nodes, dim) = (&self.map.classes[class].nodes, base.diagonal.len());
                if let Inverse::Packed(factor) = &inverse.full {
                    return factor.product(&base.kernel, nodes, x, y, &mut memory.numbers);
                }
                let full = &mut full[..dim * columns];
                full.fill(0.0);
                for_places(nodes, dim, columns, |own, at| full[at] = x[own]);
                inverse.full.apply(&base.kernel, full, columns, memory);
                for_places(nodes, dim, columns, |own, at| y[own] = full[at]);
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
}
