//! The gluing matrix `B = (N, T, B_int, B_Dir)` of the torn body.
//!
//! It is stored by what its rows do: an *interface block* is three rows (x, y, z) that combine the copies of one node
//! with the same coefficients; every other row, a *nodal row*, is a list of (copy, vector). Supports and contact act on
//! the mean of the copies, the interface rows on its complement, so the rows are independent by construction, except at
//! [dependent nodes](Gluing::dependent_nodes); what else would depend is left out.

use crate::rows::ranges::RowRanges;
use crate::rows::side::ContactConstraint;
use crate::tolerances::RIGID;
use signorini_fem_mesh::internal::{DisjointSets, Lists};
use std::ops::Range;

/// Tangential rows of a contact point.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum TangentialRows {
    /// None: no friction, or supports hold the point along the surface.
    None,
    /// One row; the friction force is bounded by an interval.
    Interval {
        /// The row.
        row: usize,
        /// Its unit direction in space.
        direction: [f64; 3],
        /// The row is `scale` times the displacement along the direction.
        scale: f64,
    },
    /// Two rows `row, row + 1` along the frame's tangents; the friction force is bounded by a disc.
    Disc {
        /// The first row.
        row: usize,
        /// The rows are `scale` times the displacements along the tangents.
        scale: f64,
    },
}

/// The rows of a contact point that has a normal row.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactRows {
    /// Position in the list of contact points given.
    pub point: usize,
    /// The normal row.
    pub row: usize,
    /// The normal row is `scale` times the normal displacement; the force of the point is `scale * lambda`, the offset
    /// of the row `scale * gap`. The square root of the number of copies at an unsupported node.
    pub scale: f64,
    /// The tangential rows.
    pub tangential: TangentialRows,
}

/// The row of a spring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpringRow {
    /// `B u = -compliance * lambda`, in row units, m/N.
    pub compliance: f64,
    /// Length of the row.
    pub scale: f64,
    /// Where the stiffness `k` of the node preconditions, `factor² scale² k` inverts `scale² / k` and the compliance
    /// together: one over the scale, less for the softest.
    pub factor: f64,
}

/// The rows of a tied constraint.
#[derive(Debug, Clone, PartialEq)]
pub struct TiedRows {
    /// Position in the list of contact points given.
    pub point: usize,
    /// Its rows: one for each direction that supports leave free.
    pub rows: std::ops::Range<usize>,
    /// Their directions with their lengths: a row is the length times what the first side moves along the direction
    /// against the other.
    pub directions: Vec<([f64; 3], f64)>,
}

/// The row of a linear equation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EquationRow {
    /// Position in the list of equations given.
    pub equation: usize,
    /// Its row.
    pub row: usize,
    /// The row is `scale` times the equation, without what supports prescribe.
    pub scale: f64,
}

/// An entry of a row that is no interface row: a copy and the vector that multiplies its displacement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CopyEntry {
    pub(crate) subdomain: u32,
    pub(crate) local: u32,
    pub(crate) vector: [f64; 3],
}

/// An entry of an interface block: a copy and the coefficient that multiplies its displacement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BlockEntry {
    pub(crate) subdomain: u32,
    pub(crate) local: u32,
    pub(crate) coefficient: f64,
}

/// A *glob*: nodes that the same subdomains share, such as those inside a face or an edge of a subdomain.
///
/// Its interface blocks stand together: one run of `nodes` blocks after the other, each of the same coefficients.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Glob {
    pub(crate) first_block: u32,
    pub(crate) nodes: u32,
    pub(crate) runs: u32,
}

impl Glob {
    /// Block of a node in a run.
    pub(crate) fn block(&self, run: usize, node: usize) -> usize {
        self.first_block as usize + run * self.nodes as usize + node
    }
}

/// The rows of `B`, their names and their counts.
#[derive(Debug, Clone, Default)]
pub struct Gluing {
    pub(super) ranges: RowRanges,
    pub(super) blocks: Lists<BlockEntry>,
    pub(super) block_nodes: Vec<u32>,
    /// In the order of their blocks.
    pub(crate) globs: Vec<Glob>,
    /// Rows that are no interface rows.
    pub(super) nodal: Lists<CopyEntry>,
    pub(super) row_nodes: Vec<u32>,
    pub(super) contact: Vec<ContactRows>,
    pub(super) tied: Vec<TiedRows>,
    pub(super) equations: Vec<EquationRow>,
    pub(super) prescribed: Vec<Vec<(u32, f64)>>,
    /// The rows of springs, which are the last ones.
    pub(super) springs: Vec<SpringRow>,
    /// Of each contact row, in row units, m/N; empty where none gives way.
    pub(super) contact_compliance: Vec<f64>,
    /// Mesh nodes that contact points and equations join.
    pub(crate) groups: NodeGroups,
    pub(super) paper_rows: usize,
    /// Whether `B B^T` is the identity, but for rows of dependent nodes.
    pub(crate) is_aligned: bool,
    /// Nodes whose rows may depend on one another, ascending.
    pub(super) dependent: Vec<u32>,
    /// Those of them whose rows may depend on one another.
    pub(super) exchanging: NodeGroups,
}

impl Gluing {
    /// Where each kind of row stands.
    pub fn ranges(&self) -> &RowRanges {
        &self.ranges
    }

    /// Number of rows as the paper counts them, with those that are left out: three for each additional copy of a node,
    /// three for each supported node and three (without friction one) for each contact point, supported or not.
    pub fn rows_as_paper(&self) -> usize {
        self.paper_rows
    }

    /// The tied constraints that have rows, in the order given.
    pub fn tied(&self) -> &[TiedRows] {
        &self.tied
    }

    /// The equations that have rows, in the order given: others say what these and the supports say, too.
    pub fn equations(&self) -> &[EquationRow] {
        &self.equations
    }

    /// Nodes whose rows may depend on one another, ascending: those with several contact points, and those that a
    /// support drags along an obstacle with friction, where the friction force is wanted although the support takes it.
    pub fn dependent_nodes(&self) -> &[u32] {
        &self.dependent
    }

    /// Whether a node is one of the [dependent nodes](Self::dependent_nodes).
    pub fn is_dependent(&self, node: u32) -> bool {
        self.dependent.binary_search(&node).is_ok()
    }

    /// The contact points that have a normal row, in the order of the normal rows.
    pub fn contact(&self) -> &[ContactRows] {
        &self.contact
    }

    /// Row offsets `(row, value)` of displacement case `case` with factor one, rows ascending.
    ///
    /// They belong to support rows and, where a support also moves a contact point, to contact rows: the offset of a
    /// contact row is `scale * (gap or slip) + sum factor * value`, and the physical displacement is
    /// `(B u - sum factor * value) / scale`. Empty for a case that does not exist.
    pub fn prescribed(&self, case: usize) -> &[(u32, f64)] {
        self.prescribed.get(case).map_or(&[], Vec::as_slice)
    }

    /// Mesh node to which a row belongs (for a contact row the first of its side). `None` beyond the last row.
    pub fn node(&self, row: usize) -> Option<u32> {
        let range = &self.ranges.interface;
        if range.contains(&row) {
            self.block_nodes.get((row - range.start) / 3).copied()
        } else {
            self.row_nodes.get(self.nodal_of(row)).copied()
        }
    }

    /// What the rows of springs are, in their order.
    pub fn springs(&self) -> &[SpringRow] {
        &self.springs
    }

    /// The rows of springs, which are the last ones.
    pub fn spring_rows(&self) -> Range<usize> {
        let total = self.ranges.total();
        total - self.springs.len()..total
    }

    /// The spring of a row; `None` if it is another one.
    pub fn spring(&self, row: usize) -> Option<&SpringRow> {
        row.checked_sub(self.spring_rows().start)
            .and_then(|spring| self.springs.get(spring))
    }

    /// Length of a row that is no contact row: those that hold rigid subdomains are longer than one, those of springs
    /// may be shorter.
    pub fn length(&self, row: usize) -> f64 {
        match self.spring(row) {
            Some(spring) => spring.scale,
            None if self.ranges.rigid.contains(&row) => RIGID.sqrt(),
            None => 1.0,
        }
    }

    /// How much contact rows give way under their multipliers, in row units, m/N; empty where none does.
    pub fn contact_compliance(&self) -> &[f64] {
        &self.contact_compliance
    }

    /// Whether springs or contact rows give way.
    pub fn is_compliant(&self) -> bool {
        !(self.springs.is_empty() && self.contact_compliance.is_empty())
    }

    /// Rows that give way, contact rows and springs, with `C` of them in row units, m/N.
    pub(crate) fn compliance(&self) -> impl Iterator<Item = (usize, f64)> {
        let contact = self.contact_compliance.iter().copied().enumerate();
        contact.chain(self.spring_rows().zip(self.springs.iter().map(|s| s.compliance)))
    }

    /// Adds what springs and contact rows give way to `B u`: `y += C x`, for whole dual vectors.
    pub fn add_compliance(&self, x: &[f64], y: &mut [f64]) {
        self.compliance().for_each(|(row, c)| y[row] += c * x[row]);
    }

    /// Entries `(subdomain, local degree of freedom, coefficient)` of a row; empty beyond the last row.
    pub fn row(&self, row: usize) -> Vec<(usize, usize, f64)> {
        let (range, mut out) = (&self.ranges.interface, Vec::new());
        let mut push = |subdomain: u32, local: u32, c: usize, value: f64| {
            out.push((subdomain as usize, 3 * local as usize + c, value));
        };
        if range.contains(&row) {
            let (block, c) = ((row - range.start) / 3, (row - range.start) % 3);
            for e in self.block(block) {
                push(e.subdomain, e.local, c, e.coefficient);
            }
        } else if row < self.ranges.total() {
            for e in self.nodal(self.nodal_of(row)) {
                let nonzero = (0..3).filter(|&c| e.vector[c] != 0.0);
                nonzero.for_each(|c| push(e.subdomain, e.local, c, e.vector[c]));
            }
        }
        out
    }

    /// What a row does to a displacement that is the same everywhere: the sum of its coefficients by component. For a
    /// support row, and a contact row against a rigid obstacle, that is its direction in space times its scale; a
    /// contact row between two sides, and an interface row, give zero.
    pub fn direction(&self, row: usize) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (_, dof, coefficient) in self.row(row) {
            sum[dof % 3] += coefficient;
        }
        sum
    }

    pub(crate) fn blocks(&self) -> usize {
        self.blocks.count()
    }

    pub(crate) fn block(&self, block: usize) -> &[BlockEntry] {
        self.blocks.of(block)
    }

    /// The copies of a node of a glob: its last run combines all of them.
    pub(crate) fn copies(&self, glob: &Glob, node: usize) -> &[BlockEntry] {
        self.block(glob.block(glob.runs as usize - 1, node))
    }

    /// Number of rows that are not interface rows: contact rows, then support rows.
    pub(crate) fn nodal_rows(&self) -> usize {
        self.nodal.count()
    }

    /// Entries of one of these; of a contact row by its number as a row.
    pub(crate) fn nodal(&self, nodal: usize) -> &[CopyEntry] {
        self.nodal.of(nodal)
    }

    pub(crate) fn nodal_row(&self, nodal: usize) -> usize {
        if nodal < self.ranges.interface.start {
            nodal
        } else {
            nodal + self.ranges.interface.len()
        }
    }

    fn nodal_of(&self, row: usize) -> usize {
        if row < self.ranges.interface.start { row } else { row - self.ranges.interface.len() }
    }
}

/// For each mesh node the first of those that contact points and equations join with it.
#[derive(Debug, Clone, Default)]
pub(crate) struct NodeGroups(Vec<u32>);

impl NodeGroups {
    /// Of points, and of equations with these nodes.
    pub(super) fn new<'a>(
        points: impl Iterator<Item = &'a ContactConstraint>,
        equations: impl Iterator<Item = Vec<u32>>,
    ) -> Self {
        let points = points
            .filter(|p| !p.is_single())
            .map(|p| p.nodes().map(|n| n.0).collect());
        let joined: Vec<Vec<u32>> = points.chain(equations).collect();
        let count = joined.iter().flatten().max().map_or(0, |most| most + 1);
        let mut sets = DisjointSets::new(count as usize);
        for nodes in joined {
            sets.join_all(nodes.into_iter().map(|n| n as usize));
        }
        Self((0..count).map(|n| sets.first(n as usize) as u32).collect())
    }

    pub(crate) fn of(&self, node: u32) -> u32 {
        self.0.get(node as usize).copied().unwrap_or(node)
    }
}
