//! Branches of a tree on the ranks of several processes.
//!
//! Each rank eliminates its branches, the regions outside of all branches (the *top*) every rank does. A region is
//! worked on by the same operations wherever that is, and takes what the regions within leave in the same order, so
//! bits do not depend on ranks. A factorisation tells once what branches do to the top, a solve likewise, and its
//! result. Where all blocks of branches belong to their ranks, a solve begins with what each rank has of the right
//! side.

use crate::processes::exchange::Exchange;
use crate::projector::split::front::Front;
use crate::projector::split::tree::CoarseTree;
use crate::tolerances::BRANCHES;
use std::ops::Range;
use std::sync::Arc;

/// The processes, and the rank of each block.
pub(crate) type Processes<'a> = (&'a Arc<Exchange>, &'a dyn Fn(u32) -> usize);

/// Which regions are worked on: those of branches, or the top. Without branches all are of the first pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Pass {
    Branches,
    Top,
}

/// The branches of all ranks.
#[derive(Debug)]
pub(crate) struct Branches {
    pub(super) exchange: Arc<Exchange>,
    /// The rank of each region; `None` at the top.
    ranks: Vec<Option<u32>>,
    /// By rank and place.
    all: Vec<Branch>,
    /// Parts of the ranks in messages of unknowns, and of sums and blocks of the top.
    pub(super) unknowns: Vec<Range<usize>>,
    sums: Vec<Range<usize>>,
    /// Whether all blocks of branches belong to their ranks; then the blocks of the top, by rank.
    is_within: bool,
    top: Vec<Vec<u32>>,
}

#[derive(Debug)]
pub(super) struct Branch {
    rank: usize,
    /// Its outermost region.
    pub(super) root: usize,
    /// Its blocks in the order of elimination, and its unknowns in a message.
    pub(super) blocks: Range<usize>,
    pub(super) unknowns: Range<usize>,
    /// Sums for what is behind it in a message.
    pub(super) sums: Range<usize>,
    /// Its nodes whose parents are at the top.
    crossing: Vec<usize>,
}

impl Branches {
    /// For several ranks, with about equal work; `None` of one rank, or if cuts do not pay.
    pub(super) fn new(tree: &CoarseTree, (exchange, rank_of): Processes<'_>) -> Option<Self> {
        let divided = match exchange.ranks() {
            1 => return None,
            ranks => divided(tree, ranks),
        };
        if divided.iter().filter(|roots| !roots.is_empty()).count() < 2 {
            return None;
        }
        let mut ranks = vec![None; tree.regions.len()];
        let mut is_within = true;
        for (rank, roots) in divided.iter().enumerate() {
            for &root in roots {
                let region = &tree.regions[root];
                ranks[region.first_region..=root].fill(Some(rank as u32));
                let mut blocks = tree.blocks[region.start..region.own.end].iter();
                is_within &= blocks.all(|&block| rank_of(block) == rank);
            }
        }
        let mut top = vec![Vec::new(); divided.len()];
        let outside = tree.regions.iter().zip(&ranks).filter(|(_, rank)| rank.is_none());
        for (region, _) in outside.filter(|_| is_within) {
            let blocks = tree.blocks[region.own.clone()].iter();
            blocks.for_each(|&block| top[rank_of(block)].push(block));
        }
        let mut out = Self {
            exchange: exchange.clone(),
            ranks,
            all: Vec::new(),
            unknowns: Vec::new(),
            sums: Vec::new(),
            is_within,
            top,
        };
        let (mut unknowns, mut sums) = (0, 0);
        for (rank, mut roots) in divided.into_iter().enumerate() {
            let starts = (unknowns, sums);
            roots.sort_unstable();
            for root in roots {
                let region = &tree.regions[root];
                let end = region.changing.end;
                let crosses = |k: &usize| tree.nodes[*k].parent.is_some_and(|parent| parent >= end);
                let branch = Branch {
                    rank,
                    root,
                    blocks: region.start..region.own.end,
                    unknowns: unknowns..unknowns + 6 * (region.own.end - region.start),
                    sums: sums..sums + 6 * region.behind.len(),
                    crossing: (region.first_node..end).filter(crosses).collect(),
                };
                (unknowns, sums) = (branch.unknowns.end, branch.sums.end);
                out.all.push(branch);
            }
            sums += 6 * out.top[rank].len();
            out.unknowns.push(starts.0..unknowns);
            out.sums.push(starts.1..sums);
        }
        Some(out)
    }

    /// The rank of a region; `None` at the top.
    pub(super) fn rank_of(&self, region: usize) -> Option<u32> {
        self.ranks[region]
    }

    /// Whether what belongs to a rank, `None` at the top, is worked on here in a pass.
    pub(super) fn is_done(&self, rank: Option<u32>, pass: Pass) -> bool {
        match pass {
            Pass::Branches => rank == Some(self.exchange.rank() as u32),
            Pass::Top => rank.is_none(),
        }
    }

    /// Whether regions of a pass are within a region, or it is one.
    pub(super) fn is_entered(&self, region: usize, pass: Pass) -> bool {
        let rank = self.ranks[region];
        rank.is_none() || self.is_done(rank, pass)
    }

    /// Whether a region is worked on here at all.
    pub(super) fn is_here(&self, region: usize) -> bool {
        self.is_entered(region, Pass::Branches)
    }

    /// Length of the longer message.
    pub(super) fn message(&self) -> usize {
        let last = |parts: &[Range<usize>]| parts.last().map_or(0, |part| part.end);
        last(&self.unknowns).max(last(&self.sums))
    }

    /// The branches of this rank, or of the others.
    pub(super) fn of(&self, own: bool) -> impl Iterator<Item = &Branch> {
        let rank = self.exchange.rank();
        self.all.iter().filter(move |branch| (branch.rank == rank) == own)
    }

    /// Whether a solve completes its right side, of which each rank has what belongs to it.
    pub(super) fn completes(&self) -> bool {
        self.is_within
    }

    /// Completes the sums of all branches, and blocks of the right side `y` at the top.
    pub(super) fn gather_sums(&self, y: &mut [f64], message: &mut [f64]) {
        let places = |rank: usize| {
            let (top, end) = (&self.top[rank], self.sums[rank].end);
            (end - 6 * top.len()..)
                .step_by(6)
                .zip(top.iter().map(|&block| 6 * block as usize))
        };
        let rank = self.exchange.rank();
        places(rank).for_each(|(k, start)| message[k..k + 6].copy_from_slice(&y[start..start + 6]));
        self.exchange.gather(message, &self.sums);
        let others = (0..self.top.len()).filter(|&other| other != rank);
        for (k, start) in others.flat_map(places) {
            y[start..start + 6].copy_from_slice(&message[k..k + 6]);
        }
    }

    /// Brings what the branches do to the top to all ranks, only of nodes that change if `changing`; an error of one
    /// rank is one of all.
    pub(super) fn gather_updates(
        &self,
        own: Result<(), usize>,
        tree: &CoarseTree,
        changing: bool,
        fronts: &mut [Front],
    ) -> Result<(), usize> {
        let rank = self.exchange.rank();
        let size = |k: usize| 6 * tree.nodes[k].border.len();
        // columns from the block on the diagonal on
        let columns = |k: usize| (0..size(k)).map(move |c| c * size(k) + c / 6 * 6..(c + 1) * size(k));
        let told = |branch: &Branch| -> Vec<usize> {
            let nodes = branch.crossing.iter().copied();
            nodes.filter(|&k| tree.nodes[k].changing || !changing).collect()
        };
        let (mut message, mut parts) = (Vec::new(), Vec::new());
        for r in 0..self.exchange.ranks() {
            let start = message.len();
            message.push(if r == rank && own.is_err() { 1.0 } else { 0.0 });
            for k in self.all.iter().filter(|b| b.rank == r).flat_map(told) {
                for rows in columns(k) {
                    if r == rank && own.is_ok() {
                        message.extend_from_slice(&fronts[k].update[rows])
                    } else {
                        message.resize(message.len() + rows.len(), 0.0)
                    }
                }
            }
            parts.push(start..message.len());
        }
        self.exchange.gather(&mut message, &parts);
        own?;
        for (r, part) in parts.into_iter().enumerate().filter(|(r, _)| *r != rank) {
            // what a process that is lost sends is not a number
            if message[part.start] != 0.0 {
                return Err(0);
            }
            let mut rest = &message[part.start + 1..part.end];
            for k in self.all.iter().filter(|b| b.rank == r).flat_map(told) {
                let update = &mut fronts[k].update;
                update.clear();
                update.resize(size(k) * size(k), 0.0);
                for rows in columns(k) {
                    let (column, tail) = rest.split_at(rows.len());
                    update[rows].copy_from_slice(column);
                    rest = tail;
                }
            }
        }
        Ok(())
    }
}

/// Outermost regions by rank: the largest branch is cut as long as that pays, for what is cut off is done by all.
fn divided(tree: &CoarseTree, ranks: usize) -> Vec<Vec<usize>> {
    let cost = |r: usize| tree.branch_cost(r);
    let (mut branches, mut top) = (Vec::from_iter(tree.regions.len().checked_sub(1)), 0.0);
    let (mut best, mut least) = (Vec::new(), f64::INFINITY);
    while branches.len() <= BRANCHES * ranks {
        branches.sort_by(|&a, &b| cost(b).total_cmp(&cost(a)).then(a.cmp(&b)));
        // the largest to the rank with least
        let mut loads = vec![(0.0, Vec::new()); ranks];
        for &branch in &branches {
            let all = loads.iter_mut();
            if let Some(load) = all.reduce(|a, b| if b.0 < a.0 { b } else { a }) {
                load.0 += cost(branch);
                load.1.push(branch);
            }
        }
        let longest = top + loads.iter().map(|load| load.0).fold(0.0, f64::max);
        if longest < least {
            least = longest;
            best = loads.into_iter().map(|load| load.1).collect();
        }
        let Some(at) = branches.iter().position(|&r| tree.regions[r].children.is_some()) else {
            break;
        };
        let cut = branches.remove(at);
        let children: Vec<usize> = tree.regions[cut].children.into_iter().flatten().collect();
        top += cost(cut) - children.iter().map(|&r| cost(r)).sum::<f64>();
        branches.extend(children);
    }
    best
}
