//! Which rank works on which subdomains.

use crate::processes::exchange::Exchange;
use crate::subdomain::class::Classes;
use crate::tolerances::PANEL;
use std::ops::Range;
use std::sync::Arc;

/// Members of classes in panels, and panels spread over ranks: neighbours in the order of the subdomains together, each
/// rank with about equal work. A rank holds the matrices of the classes of its panels. Panels are the same for any
/// number of ranks, and so are the bits of what is done to them.
#[derive(Debug)]
pub(crate) struct Ownership {
    pub(crate) exchange: Arc<Exchange>,
    /// Panels of each rank, by class: class and columns, counted within the class.
    pub(crate) panels: Vec<Vec<(usize, Range<usize>)>>,
    /// Panels of each class: rank and end of the columns.
    ranks: Vec<Vec<(usize, usize)>>,
}

/// The ranks of consecutive numbers, so many for each subdomain, from the rank of each subdomain.
pub(crate) fn pieces(ranks: &[u32], numbers: usize) -> Vec<(usize, Range<usize>)> {
    let mut at = 0;
    let piece = |same: &[u32]| {
        let start = at;
        at += numbers * same.len();
        (same[0] as usize, start..at)
    };
    ranks.chunk_by(|a, b| a == b).map(piece).collect()
}

impl Ownership {
    pub(crate) fn new(classes: &Classes, exchange: Arc<Exchange>) -> Self {
        let mut panels = Vec::new();
        for (k, class) in classes.classes().iter().enumerate() {
            let (members, nodes) = (class.members.len(), class.nodes as u64);
            let count = members.div_ceil(PANEL);
            for panel in 0..count {
                let columns = members * panel / count..members * (panel + 1) / count;
                let each = if class.is_rigid { nodes } else { nodes * (nodes + 64) };
                let work = columns.len() as u64 * each;
                let middle = class.members[(columns.start + columns.end) / 2];
                panels.push((k, columns, work, middle));
            }
        }
        let ranks = exchange.ranks();
        let total = panels.iter().map(|p| p.2).sum::<u64>().max(1);
        let mut order: Vec<usize> = (0..panels.len()).collect();
        order.sort_by_key(|&k| panels[k].3);
        // a panel belongs to the rank in whose share of the work its middle lies
        let (mut owner, mut before) = (vec![0; panels.len()], 0);
        for k in order {
            let twice = u128::from(2 * before + panels[k].2) * ranks as u128;
            // what is no work at the end belongs to the last
            owner[k] = ((twice / u128::from(2 * total)) as usize).min(ranks - 1);
            before += panels[k].2;
        }
        let mut out = Self {
            exchange,
            panels: vec![Vec::new(); ranks],
            ranks: vec![Vec::new(); classes.classes().len()],
        };
        for ((class, columns, ..), rank) in panels.into_iter().zip(owner) {
            out.ranks[class].push((rank, columns.end));
            out.panels[rank].push((class, columns));
        }
        out
    }

    /// Whether this rank holds the matrices of a class.
    pub(crate) fn holds(&self, class: usize) -> bool {
        self.ranks[class].iter().any(|(rank, _)| *rank == self.exchange.rank())
    }

    /// The rank of a member of a class, by its place in the class.
    pub(crate) fn rank_of(&self, class: usize, member: usize) -> usize {
        let panels = &self.ranks[class];
        panels[panels.partition_point(|(_, end)| *end <= member)].0
    }

    /// Brings a number of each class to all ranks.
    pub(crate) fn complete(&self, values: &mut [f64]) {
        let pieces = (0..values.len()).map(|class| (self.rank_of(class, 0), class..class + 1));
        self.exchange.complete(values, &pieces.collect::<Vec<_>>());
    }
}
