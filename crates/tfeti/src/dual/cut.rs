//! Which rows of `B` a rank computes alone, and what it tells the others.

use super::part::RowPart;
use crate::tolerances::BLOCKS;
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
/// several ranks share, which are computed after the exchange. Where ranks keep parts of vectors, only rows that others
/// keep are told; the rank's `own` ones are told to nobody. Empty with one rank.
#[derive(Debug, Default)]
pub(crate) struct Cut {
    /// By rank: its runs, and the copies.
    pub(super) runs: Vec<Vec<Run>>,
    pub(super) copies: Vec<Vec<Place>>,
    /// Part of each rank in the message of all.
    pub(super) parts: Vec<Range<usize>>,
    pub(super) own: Vec<Range<usize>>,
    pub(super) shared: Vec<Range<usize>>,
}

/// Rows and copies of the ranks as they are found.
#[derive(Debug)]
pub(super) struct CutBuilder<'a> {
    part: Option<&'a RowPart>,
    /// By rank: consecutive rows, and where the first one stands here, if it does.
    rows: Vec<Vec<(Range<usize>, Option<usize>)>>,
    copies: Vec<BTreeMap<u32, Place>>,
    own: Vec<Range<usize>>,
    shared: Vec<Range<usize>>,
}

impl<'a> CutBuilder<'a> {
    pub(super) fn new(ranks: usize, part: Option<&'a RowPart>) -> Self {
        Self {
            part,
            rows: vec![Vec::new(); ranks],
            copies: vec![BTreeMap::new(); ranks],
            own: Vec::new(),
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
        let place = self.part.map_or(Some(rows.start), |part| part.place(rows.start));
        let told = alone && self.part.is_none_or(|part| part.is_wanted(rows.start, rank));
        if told {
            let list = &mut self.rows[rank];
            match list.last_mut() {
                Some((last, first)) if last.end == rows.start && first.map(|first| first + last.len()) == place => {
                    last.end = rows.end;
                }
                _ => list.push((rows, place)),
            }
        } else if let Some(place) = place.filter(|_| !alone || self.part.is_some_and(|part| part.rank() == rank)) {
            let rows = place..place + rows.len();
            let list = if alone { &mut self.own } else { &mut self.shared };
            match list.last_mut() {
                Some(last) if last.end == rows.start => last.end = rows.end,
                _ => list.push(rows),
            }
        }
    }

    /// Runs have rows of one kind, those of the `interface` or others.
    pub(super) fn build(self, interface: &Range<usize>) -> Cut {
        let ends = [interface.start, interface.end];
        let split = |rows: Range<usize>| {
            let [a, b] = ends.map(|end| end.clamp(rows.start, rows.end));
            [rows.start..a, a..b, b..rows.end]
                .into_iter()
                .filter(|rows| !rows.is_empty())
        };
        let sorted = |list: Vec<Range<usize>>| {
            let mut rows: Vec<_> = list.into_iter().flat_map(split).flat_map(pieces).collect();
            rows.sort_by_key(|rows| rows.start);
            rows
        };
        let mut out = Cut {
            own: sorted(self.own),
            shared: sorted(self.shared),
            ..Cut::default()
        };
        let mut at = 0;
        for (rows, copies) in self.rows.into_iter().zip(self.copies) {
            let (start, mut runs) = (at, Vec::new());
            for (rows, place) in rows {
                let first = place.unwrap_or(0);
                let kept = place.map(|_| split(first..first + rows.len())).into_iter().flatten();
                runs.extend(kept.map(|rows| Run {
                    at: at + rows.start - first,
                    rows,
                }));
                at += rows.len();
            }
            out.runs.push(runs);
            out.copies.push(copies.into_values().collect());
            at += 3 * out.copies.last().map_or(0, Vec::len);
            out.parts.push(start..at);
        }
        out
    }
}

/// Rows in lengths that threads can share.
fn pieces(rows: Range<usize>) -> impl Iterator<Item = Range<usize>> {
    let end = rows.end;
    rows.step_by(3 * BLOCKS)
        .map(move |start| start..(start + 3 * BLOCKS).min(end))
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
        24 * runs + 8 * copies + 16 * (self.own.len() + self.shared.len())
    }
}
