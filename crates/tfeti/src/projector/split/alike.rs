//! Equal regions of a factor are solved together; those in which something changes are solved alone.
//!
//! The unknowns of up to eight equal regions stand next to one another in a *bunch*, their own first, then those behind
//! them. A bunch takes what the bunches of the regions within leave to it, and on the way back what the regions around
//! know of the unknowns behind. Bunches of one height do not touch one another and run on different threads; which
//! regions stand together depends on the matrix only.

use crate::dual::boundary::over_tasks;
use crate::linalg::tiles::{HALF, LANES};
use crate::projector::split::tree::CoarseTree;
use crate::tolerances::{ALIKE_REGIONS, SOLVE_READS};
use std::ops::Range;

/// Which regions are solved together, from the innermost to the outermost.
#[derive(Debug, Default)]
pub(crate) struct Bunches {
    pub(super) all: Vec<Bunch>,
    /// Bunches of each height.
    pub(super) heights: Vec<Range<usize>>,
    /// Bunch and column of each region.
    pub(super) of: Vec<[u32; 2]>,
    /// The region around each region; the whole has none.
    pub(super) around: Vec<Option<u32>>,
}

#[derive(Debug)]
pub(super) struct Bunch {
    /// Equal regions.
    pub(super) regions: Vec<u32>,
    /// The process whose branch they belong to; `None` if all work on them.
    pub(super) rank: Option<u32>,
    /// Columns: those of a tile, half of them, or one.
    pub(super) width: usize,
    /// Rows: own unknowns, and those behind.
    pub(super) own: usize,
    pub(super) behind: usize,
    /// Its numbers in the work memory, with a buffer of the kernels.
    pub(super) numbers: Range<usize>,
    /// Products of a number of the factor with an unknown in one direction of a solve.
    reads: usize,
}

impl Bunch {
    pub(super) fn rows(&self) -> usize {
        self.own + self.behind
    }

    /// The own unknowns among its numbers, those behind them, and the buffer.
    pub(super) fn divide<'a>(&self, numbers: &'a mut [f64]) -> [&'a mut [f64]; 3] {
        let (own, rest) = numbers.split_at_mut(self.own * self.width);
        let (behind, buffer) = rest.split_at_mut(self.behind * self.width);
        [own, behind, buffer]
    }
}

impl Bunches {
    /// For a tree whose region `r` equals the region `first[r]`; `need` are the length of the buffer of a region's
    /// kernels and the numbers that they read, `rank` the process of a region.
    pub(crate) fn new(
        tree: &CoarseTree,
        first: &[usize],
        need: impl Fn(usize) -> [usize; 2],
        rank: impl Fn(usize) -> Option<u32>,
    ) -> Self {
        let count = tree.regions.len();
        let (mut height, mut around) = (vec![0_usize; count], vec![None; count]);
        let mut families: Vec<Vec<u32>> = vec![Vec::new(); count];
        for (r, region) in tree.regions.iter().enumerate() {
            for child in region.children.into_iter().flatten() {
                height[r] = height[r].max(height[child] + 1);
                around[child] = Some(r as u32);
            }
            families[first[r]].push(r as u32);
        }
        let (mut all, mut heights, mut of) = (Vec::new(), Vec::new(), vec![[0; 2]; count]);
        let mut next = 0;
        for h in 0..=height.iter().copied().max().unwrap_or(0) {
            let start = all.len();
            for (r, family) in families
                .iter()
                .enumerate()
                .filter(|(r, f)| height[*r] == h && !f.is_empty())
            {
                let together = family.len() >= ALIKE_REGIONS;
                let (own, behind) = (6 * tree.regions[r].own.len(), 6 * tree.regions[r].behind.len());
                let mut sorted = family.clone();
                sorted.sort_by_key(|&r| rank(r as usize));
                for family in sorted.chunk_by(|a, b| rank(*a as usize) == rank(*b as usize)) {
                    for regions in family.chunks(if together { LANES } else { 1 }) {
                        let regions = regions.to_vec();
                        (0..)
                            .zip(&regions)
                            .for_each(|(c, &r)| of[r as usize] = [all.len() as u32, c]);
                        let width = match regions.len() {
                            _ if !together => 1,
                            count if count <= HALF => HALF,
                            _ => LANES,
                        };
                        let [buffer, reads] = need(r);
                        let length = (own + behind + buffer) * width;
                        all.push(Bunch {
                            rank: rank(regions[0] as usize),
                            reads: reads * regions.len(),
                            regions,
                            width,
                            own,
                            behind,
                            numbers: next..next + length,
                        });
                        next += length;
                    }
                }
            }
            heights.push(start..all.len());
        }
        Self {
            all,
            heights,
            of,
            around,
        }
    }

    /// Length of the work memory.
    pub(crate) fn work(&self) -> usize {
        self.all.last().map_or(0, |b| b.numbers.end)
    }

    /// Runs `task` on the bunches of a height, with their numbers and all below (`up`), or all above.
    pub(super) fn over_height(
        &self,
        height: &Range<usize>,
        work: &mut [f64],
        up: bool,
        task: &(impl Fn(&Bunch, &mut [f64], &[f64]) + Sync),
    ) {
        let bunches = &self.all[height.clone()];
        let (Some(first), Some(last)) = (bunches.first(), bunches.last()) else {
            return;
        };
        let (start, end) = (first.numbers.start, last.numbers.end);
        let (below, rest) = work.split_at_mut(start);
        let (own, above) = rest.split_at_mut(end - start);
        let others = if up { &*below } else { &*above };
        let offset = |bunch: &Bunch| bunch.numbers.start;
        // the outermost regions have few unknowns and most numbers
        let reads: usize = bunches.iter().map(|bunch| bunch.reads).sum();
        over_tasks(bunches, own, &offset, reads >= SOLVE_READS, &|bunch, part| {
            task(bunch, &mut part[..bunch.numbers.len()], others);
        });
    }
}
