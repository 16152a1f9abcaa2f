//! Which rank works on which subdomains.

use crate::processes::exchange::Exchange;
use crate::subdomain::class::Classes;
use crate::tolerances::PANEL;
use std::ops::Range;
use std::sync::Arc;

/// Members of classes in panels, and the panels in ranges, one a rank, of about equal work. A rank holds the matrices of
/// the classes in its range. Panels are the same for any number of ranks, and so are the bits of what is done to them.
#[derive(Debug)]
pub(crate) struct Ownership {
    pub(crate) exchange: Arc<Exchange>,
    /// Class and columns, counted within the class.
    pub(crate) panels: Vec<(usize, Range<usize>)>,
    /// Panels of each rank.
    pub(crate) shares: Vec<Range<usize>>,
    /// First panel of each class, and the end.
    first: Vec<usize>,
}

impl Ownership {
    pub(crate) fn new(classes: &Classes, exchange: Arc<Exchange>) -> Self {
        let (mut panels, mut work, mut first) = (Vec::new(), Vec::new(), vec![0]);
        for (k, class) in classes.classes().iter().enumerate() {
            let (members, nodes) = (class.members.len(), class.nodes as u64);
            let count = members.div_ceil(PANEL);
            for panel in 0..count {
                let columns = members * panel / count..members * (panel + 1) / count;
                work.push(columns.len() as u64 * nodes * (nodes + 64));
                panels.push((k, columns));
            }
            first.push(panels.len());
        }
        let (ranks, total) = (exchange.ranks() as u64, work.iter().sum::<u64>());
        // a panel belongs to the rank in whose share of the work its middle lies
        let mut before = 0;
        let owner = work.iter().map(|own| {
            let middle = 2 * before + own;
            before += own;
            (u128::from(middle) * u128::from(ranks) / u128::from(2 * total.max(1))) as u64
        });
        let owner: Vec<u64> = owner.collect();
        let start = |rank: u64| owner.partition_point(|o| *o < rank);
        Self {
            shares: (0..ranks).map(|rank| start(rank)..start(rank + 1)).collect(),
            exchange,
            panels,
            first,
        }
    }

    /// Whether this rank holds the matrices of a class.
    pub(crate) fn holds(&self, class: usize) -> bool {
        let (own, all) = (
            &self.shares[self.exchange.rank()],
            self.first[class]..self.first[class + 1],
        );
        own.start.max(all.start) < own.end.min(all.end)
    }

    /// The rank of a member of a class, by its place in the class.
    pub(crate) fn rank_of(&self, class: usize, member: usize) -> usize {
        let own = &self.panels[self.first[class]..self.first[class + 1]];
        let panel = self.first[class] + own.partition_point(|(_, columns)| columns.end <= member);
        self.shares.partition_point(|share| share.end <= panel)
    }
}
