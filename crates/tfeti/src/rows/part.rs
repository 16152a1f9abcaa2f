//! Some of the rows of a gluing, for tables of a part of dual vectors.

use super::gluing::{Glob, Gluing};
use super::ranges::RowRanges;

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
        let end = contact + 3 * out.blocks();
        let kept = |rows: std::ops::Range<usize>| nodal[rows].iter().filter(|kept| **kept).count();
        let tied = end..end + kept(contact..contact + own.tied.len());
        let behind = contact + own.tied.len();
        let equations = tied.end..tied.end + kept(behind..behind + own.equations.len());
        let behind = behind + own.equations.len();
        let rigid = equations.end..equations.end + kept(behind..behind + own.rigid.len());
        out.ranges = RowRanges {
            interface: contact..end,
            dirichlet: rigid.end..end + out.nodal_rows() - contact,
            tied,
            equations,
            rigid,
            ..own.clone()
        };
        out
    }
}
