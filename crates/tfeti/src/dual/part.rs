//! The part of dual vectors that a rank keeps where each works with its own rows.
//!
//! A rank keeps the contact rows, as all do, the rows of its subdomains, and what is missing of the chunks that it
//! sums: a dot product adds up chunks of consecutive rows, each on one rank, and the ranks tell one another these sums.
//! The order of additions so does not depend on the ranks. Rows of a glob are kept together.

use crate::processes::exchange::Exchange;
use crate::rows::gluing::{Glob, Gluing};
use signorini_fem_mesh::internal::distinct;
use signorini_qp::vector::{CHUNK, dot, join};
use std::ops::Range;
use std::sync::Arc;

/// Which rows the ranks keep.
#[derive(Debug)]
pub(crate) struct RowPart {
    exchange: Arc<Exchange>,
    /// Of each rank, ascending: rows, and the place of the first in the rank's part.
    kept: Vec<Vec<(Range<usize>, usize)>>,
    /// All rows once, and who gives them where a vector becomes whole.
    given: Vec<(usize, Range<usize>)>,
    /// Chunks of this rank: places of their sums in a message, and of their rows in the part.
    own: Vec<(usize, Range<usize>)>,
    /// Part of each rank in the message of sums, and where there the sum of each chunk stands.
    sums: Vec<Range<usize>>,
    order: Vec<usize>,
}

/// Rows that are kept together, and the ranks whose subdomains they touch, ascending.
struct Unit {
    rows: Range<usize>,
    ranks: Vec<usize>,
}

impl Unit {
    fn chunks(&self) -> Range<usize> {
        self.rows.start / CHUNK..self.rows.end.div_ceil(CHUNK)
    }

    fn within(&self, chunk: usize) -> usize {
        let [start, end] = [chunk, chunk + 1].map(|k| (k * CHUNK).clamp(self.rows.start, self.rows.end));
        end - start
    }
}

/// The contact rows, the globs and the other rows, in the order of the rows.
fn units(gluing: &Gluing, ranks: usize, rank_of: &dyn Fn(u32) -> usize) -> Vec<Unit> {
    let touched = |subdomains: &mut dyn Iterator<Item = u32>| distinct(subdomains.map(rank_of));
    let interface = gluing.ranges().interface.clone();
    let contact = Unit {
        rows: 0..interface.start,
        ranks: (0..ranks).collect(),
    };
    let globs = gluing.globs.iter().map(|glob: &Glob| {
        let [start, end] = [0, glob.runs as usize].map(|run| interface.start + 3 * glob.block(run, 0));
        let entries = gluing.copies(glob, 0).iter();
        Unit {
            rows: start..end,
            ranks: touched(&mut entries.map(|e| e.subdomain)),
        }
    });
    let others = (interface.start..gluing.nodal_rows()).map(|nodal| {
        let row = gluing.nodal_row(nodal);
        Unit {
            rows: row..row + 1,
            ranks: touched(&mut gluing.nodal(nodal).iter().map(|e| e.subdomain)),
        }
    });
    std::iter::once(contact).chain(globs).chain(others).collect()
}

impl RowPart {
    /// The parts of all ranks, and the rows of that of this one.
    pub(crate) fn new(gluing: &Gluing, exchange: Arc<Exchange>, rank_of: &dyn Fn(u32) -> usize) -> (Self, Gluing) {
        let (ranks, rank, contact) = (exchange.ranks(), exchange.rank(), gluing.ranges().interface.start);
        let units = units(gluing, ranks, rank_of);
        let chunks = gluing.ranges().total().div_ceil(CHUNK);
        let mut counts = vec![vec![0; ranks]; chunks];
        for unit in &units {
            for chunk in unit.chunks() {
                unit.ranks.iter().for_each(|&r| counts[chunk][r] += unit.within(chunk));
            }
        }
        // the last of those with most rows of a chunk: those of contact are on all, and the first have the contact
        let most = |counts: &Vec<usize>| (0..ranks).max_by_key(|&r| counts[r]).unwrap_or(0);
        let owner: Vec<usize> = counts.iter().map(most).collect();
        let (mut kept, mut lengths) = (vec![Vec::<(Range<usize>, usize)>::new(); ranks], vec![0; ranks]);
        let mut given: Vec<(usize, Range<usize>)> = Vec::new();
        let mut marks = Vec::with_capacity(units.len());
        for unit in &units {
            let keeps = |r: usize| unit.ranks.contains(&r) || unit.chunks().any(|chunk| owner[chunk] == r);
            for r in (0..ranks).filter(|&r| keeps(r)) {
                match kept[r].last_mut() {
                    Some((rows, _)) if rows.end == unit.rows.start => rows.end = unit.rows.end,
                    _ => kept[r].push((unit.rows.clone(), lengths[r])),
                }
                lengths[r] += unit.rows.len();
            }
            marks.push(keeps(rank));
            let first = unit.ranks.first().copied().unwrap_or(0);
            match given.last_mut() {
                Some((giver, rows)) if *giver == first => rows.end = unit.rows.end,
                _ => given.push((first, unit.rows.clone())),
            }
        }
        let globs = gluing.globs.len();
        let nodal = [&vec![true; contact][..], &marks[1 + globs..]].concat();
        let rows = gluing.part(&marks[1..=globs], &nodal);
        let mut out = Self {
            exchange,
            kept,
            given,
            own: Vec::new(),
            sums: Vec::new(),
            order: vec![0; chunks],
        };
        let mut at = 0;
        for r in 0..ranks {
            let start = at;
            for chunk in (0..chunks).filter(|&chunk| owner[chunk] == r) {
                out.order[chunk] = at;
                if r == rank {
                    let first = chunk * CHUNK;
                    let length = CHUNK.min(gluing.ranges().total() - first);
                    let place = out.place(first).unwrap_or(0);
                    out.own.push((at, place..place + length));
                }
                at += 1;
            }
            out.sums.push(start..at);
        }
        (out, rows)
    }

    pub(crate) fn rank(&self) -> usize {
        self.exchange.rank()
    }

    fn find(&self, rank: usize, row: usize) -> Option<usize> {
        let kept = &self.kept[rank];
        let (rows, place) = &kept[kept
            .partition_point(|(rows, _)| rows.end <= row)
            .min(kept.len().checked_sub(1)?)];
        rows.contains(&row).then(|| place + row - rows.start)
    }

    /// Where a row stands in the part of this rank.
    pub(super) fn place(&self, row: usize) -> Option<usize> {
        self.find(self.rank(), row)
    }

    /// Whether other ranks than this one keep a row.
    pub(super) fn is_wanted(&self, row: usize, rank: usize) -> bool {
        (0..self.kept.len()).any(|other| other != rank && self.find(other, row).is_some())
    }

    /// Numbers in the part of this rank.
    pub(crate) fn len(&self) -> usize {
        let last = self.kept[self.rank()].last();
        last.map_or(0, |(rows, place)| place + rows.len())
    }

    /// The part of a whole vector.
    pub(crate) fn take(&self, whole: &[f64]) -> Vec<f64> {
        let mut out = Vec::with_capacity(self.len());
        let kept = &self.kept[self.rank()];
        kept.iter()
            .for_each(|(rows, _)| out.extend_from_slice(&whole[rows.clone()]));
        out
    }

    /// The whole of a vector; one exchange.
    pub(crate) fn complete(&self, part: &[f64], whole: &mut [f64]) {
        for (rows, place) in &self.kept[self.rank()] {
            whole[rows.clone()].copy_from_slice(&part[*place..place + rows.len()]);
        }
        self.exchange.complete(whole, &self.given);
    }

    /// Dot products of vectors of which each rank has its part, with the bits of those of whole ones; one exchange.
    pub(crate) fn dots<const K: usize>(&self, pairs: [(&[f64], &[f64]); K]) -> [f64; K] {
        let mut sums = vec![0.0; K * self.order.len()];
        for (at, rows) in &self.own {
            for (sum, (x, y)) in sums[K * at..].iter_mut().zip(pairs) {
                *sum = dot(&x[rows.clone()], &y[rows.clone()]);
            }
        }
        let parts: Vec<Range<usize>> = self.sums.iter().map(|r| K * r.start..K * r.end).collect();
        self.exchange.gather(&mut sums, &parts);
        std::array::from_fn(|k| {
            let chunks: Vec<f64> = self.order.iter().map(|at| sums[K * at + k]).collect();
            join(&chunks)
        })
    }
}
