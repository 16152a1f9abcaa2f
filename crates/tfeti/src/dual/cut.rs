//! Which rows of `B` a rank computes alone, and what it tells the others.

use std::collections::BTreeMap;
use std::ops::Range;

/// Where the three components of a copy stand in a boundary vector.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) first: u32,
    pub(super) stride: u32,
}

impl Place {
    #[inline]
    pub(super) fn read(self, y: &[f64]) -> [f64; 3] {
        let (first, stride) = (self.first as usize, self.stride as usize);
        [y[first], y[first + stride], y[first + 2 * stride]]
    }

    pub(super) fn write(self, values: [f64; 3], y: &mut [f64]) {
        let (first, stride) = (self.first as usize, self.stride as usize);
        (0..3).for_each(|c| y[first + c * stride] = values[c]);
    }
}

/// Consecutive rows that a rank computes alone, and where they stand in a message.
#[derive(Debug)]
pub(super) struct Run {
    pub(super) rows: Range<usize>,
    pub(super) at: usize,
}

/// A message of a rank: the rows whose copies are all its own, then three components at each of its copies in rows that
/// several ranks share. The latter are computed by all. Empty with one rank.
#[derive(Debug, Default)]
pub(crate) struct Cut {
    /// By rank: its runs, and the copies.
    pub(super) runs: Vec<Vec<Run>>,
    pub(super) copies: Vec<Vec<Place>>,
    /// Part of each rank in the message of all.
    pub(super) parts: Vec<Range<usize>>,
    pub(super) shared: Vec<Range<usize>>,
}

/// Rows and copies of the ranks as they are found.
#[derive(Debug)]
pub(super) struct CutBuilder {
    rows: Vec<Vec<Range<usize>>>,
    copies: Vec<BTreeMap<u32, Place>>,
    shared: Vec<Range<usize>>,
}

impl CutBuilder {
    pub(super) fn new(ranks: usize) -> Self {
        Self {
            rows: vec![Vec::new(); ranks],
            copies: vec![BTreeMap::new(); ranks],
            shared: Vec::new(),
        }
    }

    /// Enters rows with all their copies: rank, number and place of each.
    pub(super) fn enter(&mut self, rows: Range<usize>, copies: &[(usize, u32, Place)]) {
        let rank = copies.first().map_or(0, |c| c.0);
        let alone = copies.iter().all(|c| c.0 == rank);
        if !alone {
            for &(rank, copy, place) in copies {
                self.copies[rank].insert(copy, place);
            }
        }
        let list = if alone { &mut self.rows[rank] } else { &mut self.shared };
        match list.last_mut() {
            Some(last) if last.end == rows.start => last.end = rows.end,
            _ => list.push(rows),
        }
    }

    /// Runs have rows of one kind, those of the `interface` or others.
    pub(super) fn build(self, interface: &Range<usize>) -> Cut {
        let ends = [interface.start, interface.end];
        let split = |list: Vec<Range<usize>>| -> Vec<Range<usize>> {
            let pieces = |rows: Range<usize>| {
                let [a, b] = ends.map(|end| end.clamp(rows.start, rows.end));
                [rows.start..a, a..b, b..rows.end]
            };
            list.into_iter()
                .flat_map(pieces)
                .filter(|rows| !rows.is_empty())
                .collect()
        };
        let mut out = Cut {
            shared: split(self.shared),
            ..Cut::default()
        };
        let mut at = 0;
        for (rows, copies) in self.rows.into_iter().zip(self.copies) {
            let start = at;
            let run = |rows: Range<usize>| {
                let run = Run { at, rows };
                at += run.rows.len();
                run
            };
            out.runs.push(split(rows).into_iter().map(run).collect());
            out.copies.push(copies.into_values().collect());
            at += 3 * out.copies.last().map_or(0, Vec::len);
            out.parts.push(start..at);
        }
        out
    }
}

impl Cut {
    /// Interface rows that a rank computes, alone or with others, ascending.
    pub(super) fn computed(&self, rank: usize, interface: &Range<usize>) -> Vec<Range<usize>> {
        let alone = self.runs.get(rank).into_iter().flatten().map(|run| run.rows.clone());
        let mut all: Vec<_> = alone.chain(self.shared.iter().cloned()).collect();
        all.retain(|rows| interface.contains(&rows.start));
        all.sort_by_key(|rows| rows.start);
        all
    }

    /// Length of the message of all.
    pub(super) fn message(&self) -> usize {
        self.parts.last().map_or(0, |part| part.end)
    }

    pub(super) fn bytes(&self) -> usize {
        let runs: usize = self.runs.iter().map(Vec::len).sum();
        let copies: usize = self.copies.iter().map(Vec::len).sum();
        24 * runs + 8 * copies + 16 * self.shared.len()
    }
}
