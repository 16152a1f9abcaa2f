//! Where each kind of row stands in `B`, and which rows were left out.

use std::ops::Range;

/// Why a row that the paper counts is not in `B`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum RemovalReason {
    /// The support (its number) repeats a direction that is fixed already, with the same prescribed value.
    DoubledSupport {
        /// Position in the list of supports.
        support: usize,
    },
    /// The normal direction of a contact point is fixed by supports: the point cannot open or close.
    NormalFixed,
    /// A tangential direction of a contact point is fixed by supports.
    TangentFixed,
    /// Friction cannot act where there is no contact row.
    NoNormalRow,
}

/// A row that would make `B` lose rank and was therefore left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RemovedRow {
    /// Mesh node.
    pub node: u32,
    /// Why it was left out.
    pub reason: RemovalReason,
}

/// Where each kind of row stands in a dual vector, in this order.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct RowRanges {
    /// Normal rows.
    pub normal: Range<usize>,
    /// Tangential rows of the points with two tangential directions: pairs `t1, t2`.
    pub discs: Range<usize>,
    /// Tangential rows of the points with one tangential direction.
    pub intervals: Range<usize>,
    /// Interface rows: triples (x, y, z) of one node.
    pub interface: Range<usize>,
    /// Rows of tied constraints.
    pub tied: Range<usize>,
    /// Support rows.
    pub dirichlet: Range<usize>,
}

impl RowRanges {
    /// All tangential rows.
    pub fn tangential(&self) -> Range<usize> {
        self.discs.start..self.intervals.end
    }

    /// All contact rows: normal and tangential.
    pub fn contact(&self) -> Range<usize> {
        self.normal.start..self.intervals.end
    }

    /// Number of rows of `B`: the length of dual vectors.
    pub fn total(&self) -> usize {
        self.dirichlet.end
    }
}
