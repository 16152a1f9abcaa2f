//! Gather tables between dual vectors and the boundary unknowns of all subdomains.
//!
//! A *boundary vector* holds the components at the boundary nodes of all members of all classes, in panels of up to
//! `PANEL` members: component `c` of boundary node `b` of member `m` of a panel of `w` members stands at `(3 b + c) w +
//! m` of the panel. With the members next to one another, products with a small matrix run at full speed and loops over
//! nodes vectorise over members. `spread` is `B^T` restricted to the boundary, `collect` is `B`. Both only gather (each
//! result is summed by one task in a fixed order), so results do not depend on the number of threads.

use super::cut::{Cut, Place, Run};
use crate::linalg::both;
use crate::linalg::sparse::{MemoryNeed, SolveMemory};
use crate::processes::exchange::Exchange;
use crate::tolerances::{BLOCKS, LARGE, PARTS};
use rayon::prelude::*;
use signorini_fem_mesh::internal::Lists;
use std::ops::Range;
use std::sync::Arc;

/// Boundary of one class.
#[derive(Debug, Clone)]
pub(crate) struct BoundaryClass {
    /// Local numbers of the nodes that `B` touches in some member, ascending.
    pub(crate) nodes: Vec<u32>,
    /// Subdomains, in the order of the columns.
    pub(crate) members: Vec<u32>,
}

/// Some columns of one class, worked on together.
#[derive(Debug, Clone)]
pub(crate) struct Panel {
    pub(crate) class: usize,
    /// Columns, counted within the class.
    pub(crate) columns: Range<usize>,
    /// Node copies of these columns.
    pub(crate) copies: Range<usize>,
    /// Positions in the list of copies that carry contact or support rows.
    pub(crate) nodal: Range<usize>,
}

/// The tables.
#[derive(Debug, Default)]
pub(crate) struct BoundaryMap {
    pub(crate) classes: Vec<BoundaryClass>,
    pub(crate) panels: Vec<Panel>,
    /// Panels of this rank, in lanes: consecutive ones share a work memory.
    pub(super) lanes: Vec<Range<usize>>,
    pub(super) exchange: Arc<Exchange>,
    /// Parts of boundary vectors that the ranks set.
    pub(super) parts: Vec<Range<usize>>,
    pub(super) cut: Cut,
    pub(super) copies: usize,
    pub(crate) interface: Range<usize>,
    pub(super) rows: usize,
    /// Interface blocks of each copy.
    pub(super) spread_pointers: Vec<u32>,
    pub(super) spread_blocks: Vec<u32>,
    pub(super) spread_weights: Vec<f64>,
    /// Other rows, for the copies that have some.
    pub(crate) nodal_copies: Vec<u32>,
    pub(crate) nodal_pointers: Vec<u32>,
    pub(crate) nodal_rows: Vec<u32>,
    pub(crate) nodal_vectors: Vec<[f64; 3]>,
    /// Copies of each interface block.
    pub(super) blocks: Lists<(Place, f64)>,
    /// Copies of each other row.
    pub(super) others: Lists<(Place, [f64; 3])>,
}

/// Work memory of products by panels: a boundary vector, and what each lane needs.
#[derive(Debug)]
pub struct PanelScratch {
    boundary: Vec<f64>,
    /// To and from other ranks; empty without.
    message: Vec<f64>,
    lanes: Vec<LaneScratch>,
}

#[derive(Debug)]
struct LaneScratch {
    gathered: Vec<f64>,
    full: Vec<f64>,
    memory: SolveMemory,
}

/// What a product does to a panel.
pub(crate) type PanelWork<'a> = dyn Fn(&Panel, &mut [f64], &mut [f64], &mut [f64], &mut SolveMemory) + Sync + 'a;

impl BoundaryMap {
    /// Length of dual vectors.
    pub(crate) fn rows(&self) -> usize {
        self.rows
    }

    /// Panels of this rank.
    pub(crate) fn own_panels(&self) -> &[Panel] {
        match (self.lanes.first(), self.lanes.last()) {
            (Some(first), Some(last)) => &self.panels[first.start..last.end],
            _ => &[],
        }
    }

    pub(crate) fn exchange(&self) -> &Exchange {
        &self.exchange
    }

    pub(crate) fn bytes(&self) -> u64 {
        let blocks = self.blocks.items().len();
        let words = self.spread_pointers.len() + self.spread_blocks.len() + self.blocks.starts().len() + 2 * blocks;
        let numbers = self.spread_weights.len() + blocks;
        (4 * words + 8 * numbers + 56 * self.others.items().len() + self.cut.bytes()) as u64
    }

    /// A number for each boundary copy, from its subdomain and local node.
    pub(crate) fn copy_values(&self, value: impl Fn(usize, usize) -> f64) -> Vec<f64> {
        let mut out = Vec::with_capacity(self.copies);
        for panel in &self.panels {
            let class = &self.classes[panel.class];
            for &node in &class.nodes {
                let members = &class.members[panel.columns.clone()];
                out.extend(members.iter().map(|&s| value(s as usize, node as usize)));
            }
        }
        out
    }

    /// `B^T x` on the copies of a panel.
    fn spread(&self, x: &[f64], panel: &Panel, out: &mut [f64]) {
        let interface = &x[self.interface.clone()];
        let width = panel.columns.len();
        let pointers = &self.spread_pointers[panel.copies.start..=panel.copies.end];
        for (target, node) in out.chunks_exact_mut(3 * width).zip(0..) {
            let (first, rest) = target.split_at_mut(width);
            let (second, third) = rest.split_at_mut(width);
            let pointers = &pointers[node * width..=(node + 1) * width];
            for m in 0..width {
                let range = pointers[m] as usize..pointers[m + 1] as usize;
                let (mut a, mut b, mut c) = (0.0, 0.0, 0.0);
                let blocks = self.spread_blocks[range.clone()].iter();
                for (&block, &weight) in blocks.zip(&self.spread_weights[range]) {
                    let value = &interface[3 * block as usize..][..3];
                    a += weight * value[0];
                    b += weight * value[1];
                    c += weight * value[2];
                }
                first[m] = a;
                second[m] = b;
                third[m] = c;
            }
        }
        for k in panel.nodal.clone() {
            let copy = self.nodal_copies[k] as usize - panel.copies.start;
            let start = 2 * (copy / width) * width + copy;
            for e in self.nodal_pointers[k] as usize..self.nodal_pointers[k + 1] as usize {
                let value = x[self.nodal_rows[e] as usize];
                for c in 0..3 {
                    out[start + c * width] += self.nodal_vectors[e][c] * value;
                }
            }
        }
    }

    /// `out = B y` for a boundary vector.
    fn collect(&self, y: &[f64], out: &mut [f64]) {
        let (contact, rest) = out.split_at_mut(self.interface.start);
        let (interface, dirichlet) = rest.split_at_mut(self.interface.len());
        let blocks = || {
            if self.is_large() {
                interface
                    .par_chunks_mut(3 * BLOCKS)
                    .enumerate()
                    .for_each(|(k, part)| self.collect_blocks(y, k * BLOCKS, part))
            } else {
                self.collect_blocks(y, 0, interface)
            }
        };
        let others = || {
            self.collect_rows(y, 0, contact);
            self.collect_rows(y, self.interface.start, dirichlet);
        };
        both(self.is_large(), blocks, others);
    }

    /// `out = B y` for a boundary vector of which this rank has its part; one exchange.
    pub(super) fn collect_with_others(&self, y: &mut [f64], message: &mut [f64], out: &mut [f64]) {
        let (cut, rank) = (&self.cut, self.exchange.rank());
        let part = cut.parts[rank].clone();
        let (rows, copies) = message[part.clone()].split_at_mut(part.len() - 3 * cut.copies[rank].len());
        let offset = |run: &Run| run.at - part.start;
        over_tasks(&cut.runs[rank], rows, &offset, self.is_large(), &|run, out| {
            self.collect_some(y, run.rows.clone(), &mut out[..run.rows.len()]);
        });
        for (place, values) in cut.copies[rank].iter().zip(copies.as_chunks_mut().0) {
            *values = place.read(y);
        }
        let own = || self.collect_ranges(y, &cut.own, out);
        self.exchange.gather_while(message, &cut.parts, own);
        for (k, (runs, copies)) in cut.runs.iter().zip(&cut.copies).enumerate() {
            for run in runs {
                out[run.rows.clone()].copy_from_slice(&message[run.at..][..run.rows.len()]);
            }
            let values = &message[cut.parts[k].end - 3 * copies.len()..cut.parts[k].end];
            let others = copies.iter().filter(|_| k != rank);
            for (place, values) in others.zip(values.as_chunks().0) {
                place.write(*values, y);
            }
        }
        self.collect_ranges(y, &cut.shared, out);
    }

    fn collect_ranges(&self, y: &[f64], all: &[Range<usize>], out: &mut [f64]) {
        let first = all.first().map_or(0, |rows| rows.start);
        let start = |rows: &Range<usize>| rows.start;
        over_tasks(all, &mut out[first..], &start, self.is_large(), &|rows, out| {
            self.collect_some(y, rows.clone(), &mut out[..rows.len()]);
        });
    }

    /// Some consecutive rows of one kind of `B y`.
    pub(super) fn collect_some(&self, y: &[f64], rows: Range<usize>, out: &mut [f64]) {
        if self.interface.contains(&rows.start) {
            self.collect_blocks(y, (rows.start - self.interface.start) / 3, out);
        } else {
            let before = if rows.start < self.interface.start { 0 } else { self.interface.len() };
            self.collect_rows(y, rows.start - before, out);
        }
    }

    fn collect_blocks(&self, y: &[f64], first: usize, out: &mut [f64]) {
        for (block, target) in (first..).zip(out.chunks_exact_mut(3)) {
            let (mut a, mut b, mut c) = (0.0, 0.0, 0.0);
            for (place, weight) in self.blocks.of(block) {
                let value = place.read(y);
                a += weight * value[0];
                b += weight * value[1];
                c += weight * value[2];
            }
            target[0] = a;
            target[1] = b;
            target[2] = c;
        }
    }

    fn collect_rows(&self, y: &[f64], first: usize, out: &mut [f64]) {
        for (k, target) in out.iter_mut().enumerate() {
            let entry = |(place, v): &(Place, [f64; 3])| {
                let value = place.read(y);
                v[0] * value[0] + v[1] * value[1] + v[2] * value[2]
            };
            *target = self.others.of(first + k).iter().map(entry).sum();
        }
    }

    /// Work memory of [`by_panels`](Self::by_panels); `more` tells how many numbers a panel needs besides those on the
    /// boundary, and what memory of solves.
    pub(crate) fn scratch(&self, more: impl Fn(&Panel) -> (usize, MemoryNeed)) -> PanelScratch {
        let lane = |panels: &Range<usize>| {
            let (mut gathered, mut full, mut need) = (0, 0, MemoryNeed::NONE);
            for panel in &self.panels[panels.clone()] {
                gathered = gathered.max(3 * panel.copies.len());
                let (numbers, own) = more(panel);
                full = full.max(numbers);
                need = need.or(own);
            }
            LaneScratch {
                gathered: vec![0.0; gathered],
                full: vec![0.0; full],
                memory: SolveMemory::new(need),
            }
        };
        PanelScratch {
            boundary: vec![0.0; 3 * self.copies],
            message: vec![0.0; self.cut.message()],
            lanes: self.lanes.iter().map(lane).collect(),
        }
    }

    /// `y = B A B^T x`, where `work(panel, B^T x, A B^T x, numbers, memory)` does panel by panel what `A` does. Each
    /// rank does its panels, one exchange brings those of the others.
    pub(crate) fn by_panels(
        &self,
        x: &[f64],
        y: &mut [f64],
        parallel: bool,
        s: &mut PanelScratch,
        work: &PanelWork<'_>,
    ) {
        let task = |panels: &Range<usize>, s: &mut LaneScratch, part: &mut [f64]| {
            let mut rest = part;
            for panel in &self.panels[panels.clone()] {
                let (out, tail) = std::mem::take(&mut rest).split_at_mut(3 * panel.copies.len());
                rest = tail;
                let gathered = &mut s.gathered[..out.len()];
                self.spread(x, panel, gathered);
                work(panel, gathered, out, &mut s.full, &mut s.memory);
            }
        };
        let offset = |panels: &Range<usize>| 3 * self.panels[panels.start].copies.start;
        let own = self.parts[self.exchange.rank()].clone();
        over_lanes(
            &self.lanes,
            &mut s.lanes,
            &mut s.boundary[own],
            &offset,
            parallel,
            &task,
        );
        match self.exchange.ranks() {
            1 => self.collect(&s.boundary, y),
            _ => self.collect_with_others(&mut s.boundary, &mut s.message, y),
        }
    }

    /// Whether loops over all copies are worth several threads.
    pub(crate) fn is_large(&self) -> bool {
        self.copies >= LARGE
    }
}

fn over_lanes<L: Sync, W: Send, T: Send>(
    lanes: &[L],
    work: &mut [W],
    y: &mut [T],
    offset: &(impl Fn(&L) -> usize + Sync),
    parallel: bool,
    task: &(impl Fn(&L, &mut W, &mut [T]) + Sync),
) {
    match lanes {
        [] => {}
        [lane] => {
            if let Some(work) = work.first_mut() {
                task(lane, work, y);
            }
        }
        _ => {
            let middle = lanes.len() / 2;
            let (left, right) = lanes.split_at(middle);
            let (work_left, work_right) = work.split_at_mut(middle);
            let (y_left, y_right) = y.split_at_mut(offset(&right[0]) - offset(&left[0]));
            both(
                parallel,
                || over_lanes(left, work_left, y_left, offset, parallel, task),
                || over_lanes(right, work_right, y_right, offset, parallel, task),
            );
        }
    }
}

/// Runs `task` on every task with its part of `y`, which begins at its offset.
pub(crate) fn over_tasks<L: Sync, T: Send>(
    tasks: &[L],
    y: &mut [T],
    offset: &(impl Fn(&L) -> usize + Sync),
    parallel: bool,
    task: &(impl Fn(&L, &mut [T]) + Sync),
) {
    // takes no memory
    let mut work = vec![(); tasks.len()];
    over_lanes(tasks, &mut work, y, offset, parallel, &|one, (), y| task(one, y));
}

/// Consecutive items in ranges of about equal work, of which no one is below `least` and there are no more than `most`.
/// They depend on the problem only, not on the number of threads.
pub(crate) fn shares(work: &[u64], least: u64, most: usize) -> Vec<Range<usize>> {
    let total: u64 = work.iter().sum();
    let parts = (total / least).clamp(1, most.clamp(1, PARTS) as u64);
    let (mut out, mut done, mut start) = (Vec::new(), 0, 0);
    for (k, own) in work.iter().enumerate() {
        done += own;
        if done * parts >= total * (out.len() as u64 + 1) || k + 1 == work.len() {
            out.push(start..k + 1);
            start = k + 1;
        }
    }
    out
}
