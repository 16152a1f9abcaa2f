//! The gluing matrix `B = (N, T, B_int, B_Dir)` of the torn body.
//!
//! `B` acts on the displacements of all subdomains, node copies included. It is stored by what its rows do: an
//! *interface block* is three rows (x, y, z) that combine the copies of one node with the same coefficients, every other
//! row is a list of (copy, vector). Supports and contact act on the mean of the copies, the interface rows on its
//! complement, so the rows are independent by construction, except at [dependent nodes](Gluing::dependent_nodes) (edges, and nodes that a support drags
//! along an obstacle); what else would depend is reported in [`Gluing::removed`].

mod build;

use self::build::Builder;
use crate::contact::{ContactConstraints, contact_rows};
use crate::copy_stiffness::CopyStiffness;
use crate::error::TfetiError;
use crate::rows::{RemovedRow, RowRanges, RowScaling};
use crate::supports::{MergedSupports, NodeSupport};
use signorini_fem_mesh::internal::DisjointSets;
use signorini_fem_mesh::{Decomposition, SurfaceFrame};

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

/// A contact point that has a normal row.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactRows {
    /// Position in the list of contact points given.
    pub point: usize,
    /// Mesh node.
    pub node: u32,
    /// Node of the other body, if any.
    pub partner: Option<u32>,
    /// Outward normal and tangents.
    pub frame: SurfaceFrame,
    /// The normal row.
    pub row: usize,
    /// The normal row is `scale` times the normal displacement; the nodal force is `scale * lambda`, the offset of
    /// the row `scale * gap`. The square root of the number of copies for orthonormal rows at an unsupported node.
    pub scale: f64,
    /// The tangential rows.
    pub tangential: TangentialRows,
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
#[derive(Debug, Clone)]
pub struct Gluing {
    rule: RowScaling,
    ranges: RowRanges,
    block_pointers: Vec<u32>,
    block_entries: Vec<BlockEntry>,
    block_nodes: Vec<u32>,
    globs: Vec<Glob>,
    row_pointers: Vec<u32>,
    row_entries: Vec<CopyEntry>,
    row_nodes: Vec<u32>,
    contact: Vec<ContactRows>,
    removed: Vec<RemovedRow>,
    prescribed: Vec<Vec<(u32, f64)>>,
    paper_rows: usize,
    orthonormal: bool,
    /// The same without rows that depend on others of their node.
    aligned: bool,
    /// Nodes whose rows may depend on one another, ascending.
    dependent: Vec<u32>,
}

impl Gluing {
    /// Builds the rows. `contact` is `None` for a body without obstacle; `stiffness` weighs the copies of a node in
    /// orthonormal contact and support rows, its default all alike. `nodes` is the number of mesh nodes.
    ///
    /// # Errors
    /// [`TfetiError`] for bad supports or contact points, and where `nodes` or `stiffness` belong to another decomposition.
    pub fn new(
        decomposition: &Decomposition,
        nodes: usize,
        supports: &[NodeSupport],
        contact: Option<&ContactConstraints>,
        rule: RowScaling,
        stiffness: &CopyStiffness,
    ) -> Result<Self, TfetiError> {
        if decomposition.nodes() != nodes {
            return Err(TfetiError::DecompositionMismatch {
                what: "nodes",
                found: decomposition.nodes(),
                expected: nodes,
            });
        }
        stiffness.check(decomposition)?;
        let merged = MergedSupports::new(supports, nodes)?;
        let none = ContactConstraints::default();
        let contact_nodes = contact.unwrap_or(&none);
        let squares = |node: u32| stiffness.squares(decomposition.copies(node as usize));
        let found = contact_rows(contact_nodes, &merged, rule, nodes, squares)?;
        let mut builder = Builder {
            decomposition,
            rule,
            stiffness,
            shares: Vec::new(),
            gluing: Self::empty(rule, merged.cases, stiffness.is_plain()),
        };
        builder.gluing.removed = found
            .removed
            .into_iter()
            .chain(merged.removed.iter().copied())
            .collect();
        builder.contact(contact_nodes, &found.rows);
        builder.interface(nodes);
        builder.dirichlet(&merged);
        let mut gluing = builder.gluing;
        gluing.ranges.interface.end = gluing.ranges.interface.start + 3 * gluing.blocks();
        let supported = gluing.row_pointers.len() - 1 - gluing.ranges.contact().len();
        gluing.ranges.dirichlet =
            gluing.ranges.interface.end..gluing.ranges.interface.end + supported;
        for case in &mut gluing.prescribed {
            for (row, _) in case.iter_mut() {
                if *row as usize >= gluing.ranges.interface.start {
                    *row += gluing.ranges.interface.len() as u32;
                }
            }
            case.sort_by_key(|v| v.0);
        }
        let torn: usize = decomposition
            .subdomains()
            .iter()
            .map(|s| s.nodes.len())
            .sum();
        let contact_rows = contact_nodes
            .points
            .iter()
            .map(|p| if p.friction { 3 } else { 1 });
        gluing.paper_rows =
            3 * (torn - nodes.min(torn)) + 3 * merged.nodes.len() + contact_rows.sum::<usize>();
        let entries = gluing.block_entries.len().max(gluing.row_entries.len());
        if entries.max(gluing.ranges.total()).max(3 * torn) >= u32::MAX as usize {
            return Err(TfetiError::TooLarge {
                what: "entries of B",
                count: entries,
            });
        }
        Ok(gluing)
    }

    fn empty(rule: RowScaling, cases: usize, plain: bool) -> Self {
        Self {
            rule,
            ranges: RowRanges {
                normal: 0..0,
                discs: 0..0,
                intervals: 0..0,
                interface: 0..0,
                dirichlet: 0..0,
            },
            block_pointers: vec![0],
            block_entries: Vec::new(),
            block_nodes: Vec::new(),
            globs: Vec::new(),
            row_pointers: vec![0],
            row_entries: Vec::new(),
            row_nodes: Vec::new(),
            contact: Vec::new(),
            removed: Vec::new(),
            prescribed: vec![Vec::new(); cases],
            paper_rows: 0,
            orthonormal: rule == RowScaling::Orthonormal && plain,
            aligned: rule == RowScaling::Orthonormal && plain,
            dependent: Vec::new(),
        }
    }

    /// How the rows were built.
    #[must_use]
    pub fn rule(&self) -> RowScaling {
        self.rule
    }

    /// Where each kind of row stands.
    #[must_use]
    pub fn ranges(&self) -> &RowRanges {
        &self.ranges
    }

    /// Number of rows of `B`: the length of dual vectors. `B` has full rank, except at [dependent
    /// nodes](Self::dependent_nodes).
    #[must_use]
    pub fn rows_full_rank(&self) -> usize {
        self.ranges.total()
    }

    /// Number of rows as the paper counts them: three for each additional copy of a node, three for each supported node
    /// and three (without friction one) for each contact point, supported or not.
    #[must_use]
    pub fn rows_as_paper(&self) -> usize {
        self.paper_rows
    }

    /// Whether `B B^T = I`.
    #[must_use]
    pub fn is_orthonormal(&self) -> bool {
        self.orthonormal
    }

    /// Nodes whose rows may depend on one another, ascending: those with several contact points, and those that a support
    /// drags along an obstacle with friction, where the friction force is wanted although the support takes it.
    #[must_use]
    pub fn dependent_nodes(&self) -> &[u32] {
        &self.dependent
    }

    /// Whether a node is one of the [dependent nodes](Self::dependent_nodes).
    #[must_use]
    pub fn is_dependent(&self, node: u32) -> bool {
        self.dependent.binary_search(&node).is_ok()
    }

    /// Mesh nodes that contact points join.
    pub(crate) fn node_groups(&self) -> NodeGroups {
        let pairs = || {
            self.contact
                .iter()
                .filter_map(|c| Some((c.node, c.partner?)))
        };
        let most = pairs().map(|(a, b)| a.max(b)).max();
        let mut sets = DisjointSets::new(most.map_or(0, |most| most as usize + 1));
        pairs().for_each(|(a, b)| sets.join(a as usize, b as usize));
        NodeGroups(
            (0..most.map_or(0, |m| m + 1))
                .map(|n| sets.first(n as usize) as u32)
                .collect(),
        )
    }

    /// Whether `B B^T` is the identity, but for rows of dependent nodes.
    pub(crate) fn is_aligned(&self) -> bool {
        self.aligned
    }

    /// The contact points that have a normal row, in the order of the normal rows.
    #[must_use]
    pub fn contact(&self) -> &[ContactRows] {
        &self.contact
    }

    /// Rows left out because they would depend on others, with the reason.
    #[must_use]
    pub fn removed(&self) -> &[RemovedRow] {
        &self.removed
    }

    /// Number of displacement cases of the supports.
    #[must_use]
    pub fn prescribed_cases(&self) -> usize {
        self.prescribed.len()
    }

    /// Row offsets `(row, value)` of displacement case `case` with factor one, rows ascending.
    ///
    /// They belong to support rows and, where a support also moves a contact point, to contact rows: the offset of a
    /// contact row is `scale * (gap or slip) + sum factor * value`, and the physical displacement is
    /// `(B u - sum factor * value) / scale`. Empty for a case that does not exist.
    #[must_use]
    pub fn prescribed(&self, case: usize) -> &[(u32, f64)] {
        self.prescribed.get(case).map_or(&[], Vec::as_slice)
    }

    /// Mesh node to which a row belongs (for a contact row the first of a pair). `None` beyond the last row.
    #[must_use]
    pub fn node(&self, row: usize) -> Option<u32> {
        let range = &self.ranges.interface;
        if range.contains(&row) {
            self.block_nodes.get((row - range.start) / 3).copied()
        } else {
            self.row_nodes.get(self.special_of(row)).copied()
        }
    }

    /// Entries `(subdomain, local degree of freedom, coefficient)` of a row; empty beyond the last row.
    #[must_use]
    pub fn row(&self, row: usize) -> Vec<(usize, usize, f64)> {
        let range = &self.ranges.interface;
        let mut out = Vec::new();
        if row >= self.ranges.total() {
            return out;
        }
        if range.contains(&row) {
            let (block, component) = ((row - range.start) / 3, (row - range.start) % 3);
            out.extend(self.block(block).iter().map(|e| {
                (
                    e.subdomain as usize,
                    3 * e.local as usize + component,
                    e.coefficient,
                )
            }));
        } else {
            for e in self.special(self.special_of(row)) {
                for (c, &v) in e.vector.iter().enumerate() {
                    if v != 0.0 {
                        out.push((e.subdomain as usize, 3 * e.local as usize + c, v));
                    }
                }
            }
        }
        out
    }

    /// Number of interface blocks.
    pub(crate) fn blocks(&self) -> usize {
        self.block_pointers.len() - 1
    }

    pub(crate) fn block(&self, block: usize) -> &[BlockEntry] {
        &self.block_entries
            [self.block_pointers[block] as usize..self.block_pointers[block + 1] as usize]
    }

    /// The globs, in the order of their blocks.
    pub(crate) fn globs(&self) -> &[Glob] {
        &self.globs
    }

    /// Number of rows that are not interface rows: contact rows, then support rows.
    pub(crate) fn specials(&self) -> usize {
        self.row_pointers.len() - 1
    }

    pub(crate) fn special(&self, special: usize) -> &[CopyEntry] {
        &self.row_entries
            [self.row_pointers[special] as usize..self.row_pointers[special + 1] as usize]
    }

    /// Row number of a special row.
    pub(crate) fn special_row(&self, special: usize) -> usize {
        if special < self.ranges.interface.start {
            special
        } else {
            special + self.ranges.interface.len()
        }
    }

    fn special_of(&self, row: usize) -> usize {
        if row < self.ranges.interface.start {
            row
        } else {
            row - self.ranges.interface.len()
        }
    }
}

/// For each mesh node the first of those that contact points join with it.
pub(crate) struct NodeGroups(Vec<u32>);

impl NodeGroups {
    pub(crate) fn of(&self, node: u32) -> u32 {
        self.0.get(node as usize).copied().unwrap_or(node)
    }
}
