//! Some of the rows of a gluing, for tables of a part of dual vectors.

use super::gluing::{Glob, Gluing};
use super::ranges::RowRanges;
use std::ops::Range;

impl Gluing {
    /// The rows of the globs and of the other rows that are marked, in their order; all contact rows have to be. Only
    /// copies and coefficients come along, no names and no springs.
    pub(crate) fn part(&self, globs: &[bool], nodal: &[bool]) -> Self {
        let mut out = Self::default();
        for (k, _) in nodal.iter().enumerate().filter(|(_, kept)| **kept) {
            out.nodal.push(self.nodal(k).iter().copied());
        }
        for (glob, _) in self.globs.iter().zip(globs).filter(|(_, kept)| **kept) {
            let first_block = out.blocks() as u32;
            for block in glob.block(0, 0)..glob.block(glob.runs as usize, 0) {
                out.blocks.push(self.block(block).iter().copied());
            }
            out.globs.push(Glob { first_block, ..*glob });
        }
        let (own, contact) = (&self.ranges, self.ranges.interface.start);
        let (mut marks, mut end) = (nodal[contact..].iter(), contact + 3 * out.blocks());
        let interface = contact..end;
        let mut kept = |rows: &Range<usize>| {
            let start = end;
            end += marks.by_ref().take(rows.len()).filter(|kept| **kept).count();
            start..end
        };
        out.ranges = RowRanges {
            interface,
            tied: kept(&own.tied),
            equations: kept(&own.equations),
            rigid: kept(&own.rigid),
            dirichlet: kept(&own.dirichlet),
            ..own.clone()
        };
        out
    }
}
