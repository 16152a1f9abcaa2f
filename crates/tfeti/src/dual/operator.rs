//! The dual operator `F = B K+ B^T`.

use crate::dual::boundary::BoundaryMap;
use crate::dual::inverses::ClassInverse;
use crate::linalg::dense;
use crate::linalg::sparse::{MemoryNeed, SolveMemory};
use crate::subdomain::matrices::Subdomains;
use crate::tolerances::PRODUCT;
use signorini_qp::SymmetricOperator;
use std::sync::Arc;

/// `F = B K+ B^T`, applied without forming it.
///
/// Each product gathers the multipliers of every subdomain into the columns of one matrix per class, multiplies it by
/// the class's boundary inverse (or solves with its sparse factor) and gathers the rows of `B` from the result.
#[derive(Debug, Clone)]
pub struct DualOperator {
    pub(crate) map: Arc<BoundaryMap>,
    pub(crate) subdomains: Arc<Subdomains>,
    pub(crate) inverses: Arc<Vec<ClassInverse>>,
    parallel: bool,
}

/// Work memory of a product with `F`.
#[derive(Debug)]
pub struct DualScratch {
    boundary: Vec<f64>,
    lanes: Vec<LaneScratch>,
}

#[derive(Debug)]
struct LaneScratch {
    gathered: Vec<f64>,
    full: Vec<f64>,
    memory: Option<SolveMemory>,
}

impl DualOperator {
    pub(crate) fn new(
        map: Arc<BoundaryMap>,
        subdomains: Arc<Subdomains>,
        inverses: Arc<Vec<ClassInverse>>,
    ) -> Self {
        let parallel = product_flops(&map, &inverses) > PRODUCT;
        Self {
            map,
            subdomains,
            inverses,
            parallel,
        }
    }

    /// Floating-point operations of one product (multiplications and additions) in the dense or sparse kernels.
    pub fn flops(&self) -> u64 {
        product_flops(&self.map, &self.inverses)
    }

    fn lane_scratch(&self, lane: usize) -> LaneScratch {
        let panels = &self.map.panels[self.map.lanes[lane].panels.clone()];
        let (mut gathered, mut full) = (0, 0);
        let mut need: Option<MemoryNeed> = None;
        for panel in panels {
            let columns = panel.columns.len();
            gathered = gathered.max(3 * self.map.classes[panel.class].nodes.len() * columns);
            if self.inverses[panel.class].boundary.is_none() {
                if !self.inverses[panel.class].full.is_packed() {
                    full = full.max(self.subdomains.bases[panel.class].stiffness.dim * columns);
                }
                let own = self.inverses[panel.class].full.need(columns);
                need = Some(need.map_or(own, |n| n.or(own)));
            }
        }
        let memory = need.map(SolveMemory::new);
        LaneScratch {
            gathered: vec![0.0; gathered],
            full: vec![0.0; full],
            memory,
        }
    }

    /// `K+ B^T x` as a boundary vector.
    fn boundary_product(&self, x: &[f64], s: &mut DualScratch) {
        self.map.for_lanes(
            &mut s.lanes,
            &mut s.boundary,
            self.parallel,
            &|lane, scratch, part| {
                for (panel, out) in self.map.panels_of(lane, part) {
                    let columns = panel.columns.len();
                    let gathered = &mut scratch.gathered[..out.len()];
                    self.map.spread(x, panel, gathered);
                    let size = out.len() / columns;
                    let inverse = &self.inverses[panel.class];
                    if let Some(matrix) = &inverse.boundary {
                        multiply_members(out, gathered, matrix, columns, size);
                    } else if let Some(memory) = &mut scratch.memory {
                        let base = &self.subdomains.bases[panel.class];
                        let nodes = &self.map.classes[panel.class].nodes;
                        let dim = base.stiffness.dim;
                        let full_inverse = &inverse.full;
                        if full_inverse.apply_at(&base.kernel, nodes, gathered, out, memory) {
                            continue;
                        }
                        let full = &mut scratch.full[..dim * columns];
                        full.fill(0.0);
                        expand(nodes, gathered, full, dim);
                        full_inverse.apply(&base.kernel, full, columns, memory);
                        restrict(nodes, full, out, dim);
                    }
                }
            },
        );
    }
}

/// Floating-point operations in the dense or sparse kernels.
fn product_flops(map: &BoundaryMap, inverses: &[ClassInverse]) -> u64 {
    let class = |k: usize| {
        let size = 3 * map.classes[k].nodes.len();
        let dense = inverses[k].boundary.is_some();
        let per_member = if dense {
            2 * size * size
        } else {
            4 * inverses[k].full.stored()
        };
        (per_member * map.classes[k].members.len()) as u64
    };
    (0..inverses.len()).map(class).sum()
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
        let lanes = (0..self.map.lanes.len())
            .map(|lane| self.lane_scratch(lane))
            .collect();
        DualScratch {
            boundary: vec![0.0; self.map.len()],
            lanes,
        }
    }

    fn apply(&self, x: &[f64], y: &mut [f64], s: &mut DualScratch) {
        self.boundary_product(x, s);
        self.map.collect(&s.boundary, y);
    }
}
