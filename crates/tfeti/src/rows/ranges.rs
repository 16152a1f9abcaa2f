//! Where each kind of row stands in `B`.

use std::ops::Range;

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
    /// Rows of linear equations.
    pub equations: Range<usize>,
    /// Rows that hold rigid subdomains.
    pub rigid: Range<usize>,
    /// Support rows, and behind them those of springs.
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
