//! Gather tables between dual vectors and the boundary unknowns of all subdomains.
//!
//! A *boundary vector* holds, class by class and member by member, the three components at each boundary node of the
//! class: a column-major matrix for each class. `spread` is `B^T` restricted to it, `collect` is `B`. Both only gather
//! (each result is summed by one task in a fixed order), so results do not depend on the number of threads.

use crate::class::Classes;
use crate::cost::PANEL;
use crate::gluing::Gluing;
use rayon::prelude::*;
use std::ops::Range;

/// Boundary of one class.
#[derive(Debug, Clone)]
pub(crate) struct BoundaryClass {
    /// Local numbers of the nodes that `B` touches in some member, ascending.
    pub(crate) nodes: Vec<u32>,
    /// Subdomains, in the order of the columns.
    pub(crate) members: Vec<u32>,
    /// First node copy of the first member.
    start: usize,
    /// First column among the columns of all classes.
    pub(crate) column: usize,
}

/// Some columns of one class, worked on together.
#[derive(Debug, Clone)]
pub(crate) struct Panel {
    pub(crate) class: usize,
    /// Columns, counted within the class.
    pub(crate) columns: Range<usize>,
    /// Node copies of these columns.
    copies: Range<usize>,
    /// Positions in the list of copies that carry contact or support rows.
    specials: Range<usize>,
}

/// Consecutive panels that share one work memory.
#[derive(Debug, Clone)]
pub(crate) struct Lane {
    pub(crate) panels: Range<usize>,
    copy: usize,
    column: usize,
}

/// The tables.
#[derive(Debug)]
pub(crate) struct BoundaryMap {
    pub(crate) classes: Vec<BoundaryClass>,
    pub(crate) panels: Vec<Panel>,
    pub(crate) lanes: Vec<Lane>,
    /// Column of each subdomain.
    pub(crate) column_of: Vec<u32>,
    copies: usize,
    interface: Range<usize>,
    rows: usize,
    /// Interface blocks of each copy.
    spread_pointers: Vec<u32>,
    spread_blocks: Vec<u32>,
    spread_weights: Vec<f64>,
    /// Other rows, for the copies that have some.
    special_copies: Vec<u32>,
    special_pointers: Vec<u32>,
    special_rows: Vec<u32>,
    special_vectors: Vec<[f64; 3]>,
    /// Copies of each interface block.
    block_pointers: Vec<u32>,
    block_copies: Vec<u32>,
    block_weights: Vec<f64>,
    /// Copies of each other row.
    row_pointers: Vec<u32>,
    row_copies: Vec<u32>,
    row_vectors: Vec<[f64; 3]>,
}

/// Largest number of lanes: bounds the work memory and the useful number of threads.
const LANES: usize = 64;
/// Interface blocks a task collects.
const BLOCKS: usize = 2048;
/// Below this number of copies a loop over them is not worth a second thread.
const SMALL: usize = 8000;

impl BoundaryMap {
    pub(crate) fn new(classes: &Classes, gluing: &Gluing) -> Self {
        let mut map = Self::layout(classes, gluing);
        let position = map.positions(classes);
        map.fill_collect(gluing, &position);
        map.fill_spread(gluing);
        map.fill_panels();
        map
    }

    /// Boundary nodes of each class: those touched in any member.
    fn layout(classes: &Classes, gluing: &Gluing) -> Self {
        let mut touched: Vec<Vec<bool>> = classes
            .classes()
            .iter()
            .map(|c| vec![false; c.nodes])
            .collect();
        let mut touch = |subdomain: u32, local: u32| {
            touched[classes.place(subdomain as usize).0][local as usize] = true;
        };
        for block in 0..gluing.blocks() {
            gluing
                .block(block)
                .iter()
                .for_each(|e| touch(e.subdomain, e.local));
        }
        for special in 0..gluing.specials() {
            gluing
                .special(special)
                .iter()
                .for_each(|e| touch(e.subdomain, e.local));
        }
        let (mut copies, mut columns) = (0, 0);
        let mut list = Vec::with_capacity(touched.len());
        let mut column_of = vec![0; classes.subdomains()];
        for (class, touched) in classes.classes().iter().zip(&touched) {
            let nodes: Vec<u32> = (0..touched.len() as u32)
                .filter(|&n| touched[n as usize])
                .collect();
            for (k, &member) in class.members.iter().enumerate() {
                column_of[member as usize] = (columns + k) as u32;
            }
            let next = copies + nodes.len() * class.members.len();
            list.push(BoundaryClass {
                nodes,
                members: class.members.clone(),
                start: copies,
                column: columns,
            });
            copies = next;
            columns += class.members.len();
        }
        Self {
            classes: list,
            panels: Vec::new(),
            lanes: Vec::new(),
            column_of,
            copies,
            interface: gluing.ranges().interface.clone(),
            rows: gluing.ranges().total(),
            spread_pointers: Vec::new(),
            spread_blocks: Vec::new(),
            spread_weights: Vec::new(),
            special_copies: Vec::new(),
            special_pointers: vec![0],
            special_rows: Vec::new(),
            special_vectors: Vec::new(),
            block_pointers: vec![0],
            block_copies: Vec::new(),
            block_weights: Vec::new(),
            row_pointers: vec![0],
            row_copies: Vec::new(),
            row_vectors: Vec::new(),
        }
    }

    /// A function from (subdomain, local node) to the number of the copy.
    fn positions<'a>(&self, classes: &'a Classes) -> impl Fn(u32, u32) -> u32 + use<'a> {
        let tables: Vec<(Vec<u32>, usize, usize)> = (self.classes.iter().zip(classes.classes()))
            .map(|(boundary, class)| {
                let mut place = vec![u32::MAX; class.nodes];
                for (k, &node) in boundary.nodes.iter().enumerate() {
                    place[node as usize] = k as u32;
                }
                (place, boundary.start, boundary.nodes.len())
            })
            .collect();
        move |subdomain, local| {
            let (class, member) = classes.place(subdomain as usize);
            let (place, start, nodes) = &tables[class];
            (start + member * nodes) as u32 + place[local as usize]
        }
    }

    fn fill_collect(&mut self, gluing: &Gluing, position: &impl Fn(u32, u32) -> u32) {
        for block in 0..gluing.blocks() {
            for e in gluing.block(block) {
                self.block_copies.push(position(e.subdomain, e.local));
                self.block_weights.push(e.coefficient);
            }
            self.block_pointers.push(self.block_copies.len() as u32);
        }
        for special in 0..gluing.specials() {
            for e in gluing.special(special) {
                self.row_copies.push(position(e.subdomain, e.local));
                self.row_vectors.push(e.vector);
            }
            self.row_pointers.push(self.row_copies.len() as u32);
        }
    }

    /// Transposes the collecting tables.
    fn fill_spread(&mut self, gluing: &Gluing) {
        let (pointers, order) = transpose(&self.block_pointers, &self.block_copies, self.copies);
        self.spread_pointers = pointers;
        self.spread_blocks = order.iter().map(|&(block, _)| block).collect();
        self.spread_weights = order
            .iter()
            .map(|&(_, entry)| self.block_weights[entry as usize])
            .collect();
        let (pointers, order) = transpose(&self.row_pointers, &self.row_copies, self.copies);
        for copy in 0..self.copies {
            let range = pointers[copy] as usize..pointers[copy + 1] as usize;
            if range.is_empty() {
                continue;
            }
            self.special_copies.push(copy as u32);
            for &(special, entry) in &order[range] {
                self.special_rows
                    .push(gluing.special_row(special as usize) as u32);
                self.special_vectors.push(self.row_vectors[entry as usize]);
            }
            self.special_pointers.push(self.special_rows.len() as u32);
        }
    }

    fn fill_panels(&mut self) {
        let mut work = Vec::new();
        for (class, boundary) in self.classes.iter().enumerate() {
            let members = boundary.members.len();
            let count = members.div_ceil(PANEL);
            for k in 0..count {
                let columns = members * k / count..members * (k + 1) / count;
                let nodes = boundary.nodes.len();
                let copies =
                    boundary.start + columns.start * nodes..boundary.start + columns.end * nodes;
                let special = |copy: usize| {
                    self.special_copies
                        .partition_point(|&c| (c as usize) < copy)
                };
                let specials = special(copies.start)..special(copies.end);
                work.push((columns.len() * nodes * (nodes + 64)) as u64);
                self.panels.push(Panel {
                    class,
                    columns,
                    copies,
                    specials,
                });
            }
        }
        // Lanes of about equal work; the split depends on the problem only.
        let total: u64 = work.iter().sum();
        let lanes = LANES.min(self.panels.len()).max(1) as u64;
        let (mut done, mut start) = (0, 0);
        for k in 0..self.panels.len() {
            done += work[k];
            let full = done * lanes >= total * (self.lanes.len() as u64 + 1);
            if full || k + 1 == self.panels.len() {
                let first = &self.panels[start];
                let column = self.classes[first.class].column + first.columns.start;
                self.lanes.push(Lane {
                    panels: start..k + 1,
                    copy: first.copies.start,
                    column,
                });
                start = k + 1;
            }
        }
    }

    /// Length of dual vectors.
    pub(crate) fn rows(&self) -> usize {
        self.rows
    }

    /// Length of boundary vectors.
    pub(crate) fn len(&self) -> usize {
        3 * self.copies
    }

    pub(crate) fn bytes(&self) -> u64 {
        let words = self.spread_pointers.len()
            + self.spread_blocks.len()
            + self.block_pointers.len()
            + self.block_copies.len();
        let numbers = self.spread_weights.len() + self.block_weights.len();
        (4 * words + 8 * numbers + 56 * self.row_copies.len()) as u64
    }

    /// Where a panel stands in boundary vectors.
    pub(crate) fn range_of(&self, panel: &Panel) -> Range<usize> {
        3 * panel.copies.start..3 * panel.copies.end
    }

    /// Node copies of a panel.
    pub(crate) fn copies_of(&self, panel: &Panel) -> Range<usize> {
        panel.copies.clone()
    }

    /// A number for each boundary copy, from its subdomain and local node.
    pub(crate) fn copy_values(&self, value: impl Fn(usize, usize) -> f64) -> Vec<f64> {
        let mut out = Vec::with_capacity(self.copies);
        for class in &self.classes {
            for &member in &class.members {
                out.extend(
                    class
                        .nodes
                        .iter()
                        .map(|&n| value(member as usize, n as usize)),
                );
            }
        }
        out
    }

    /// Panels of a lane with the part of the lane's boundary vector that belongs to each.
    pub(crate) fn panels_of<'a>(
        &'a self,
        lane: &Lane,
        y: &'a mut [f64],
    ) -> impl Iterator<Item = (&'a Panel, &'a mut [f64])> {
        let mut rest = y;
        self.panels[lane.panels.clone()].iter().map(move |panel| {
            let (part, tail) = std::mem::take(&mut rest).split_at_mut(3 * panel.copies.len());
            rest = tail;
            (panel, part)
        })
    }

    /// `B^T x` on the copies of a panel, column-major.
    pub(crate) fn spread(&self, x: &[f64], panel: &Panel, out: &mut [f64]) {
        let interface = &x[self.interface.clone()];
        let pointers = &self.spread_pointers[panel.copies.start..=panel.copies.end];
        for (pair, target) in pointers.windows(2).zip(out.chunks_exact_mut(3)) {
            let range = pair[0] as usize..pair[1] as usize;
            let (mut a, mut b, mut c) = (0.0, 0.0, 0.0);
            for (&block, &weight) in self.spread_blocks[range.clone()]
                .iter()
                .zip(&self.spread_weights[range])
            {
                let value = &interface[3 * block as usize..][..3];
                a += weight * value[0];
                b += weight * value[1];
                c += weight * value[2];
            }
            target[0] = a;
            target[1] = b;
            target[2] = c;
        }
        for k in panel.specials.clone() {
            let copy = self.special_copies[k] as usize - panel.copies.start;
            let target = &mut out[3 * copy..3 * copy + 3];
            for e in self.special_pointers[k] as usize..self.special_pointers[k + 1] as usize {
                let value = x[self.special_rows[e] as usize];
                for c in 0..3 {
                    target[c] += self.special_vectors[e][c] * value;
                }
            }
        }
    }

    /// `out = B y` for a boundary vector.
    pub(crate) fn collect(&self, y: &[f64], out: &mut [f64]) {
        let (contact, rest) = out.split_at_mut(self.interface.start);
        let (interface, dirichlet) = rest.split_at_mut(self.interface.len());
        let mut blocks = || {
            if self.copies < SMALL {
                self.collect_blocks(y, 0, interface);
            } else {
                interface
                    .par_chunks_mut(3 * BLOCKS)
                    .enumerate()
                    .for_each(|(k, part)| self.collect_blocks(y, k * BLOCKS, part));
            }
        };
        let mut others = || {
            self.collect_rows(y, 0, contact);
            self.collect_rows(y, self.interface.start, dirichlet);
        };
        if self.copies < SMALL {
            blocks();
            others();
        } else {
            rayon::join(blocks, others);
        }
    }

    fn collect_blocks(&self, y: &[f64], first: usize, out: &mut [f64]) {
        let pointers = &self.block_pointers[first..=first + out.len() / 3];
        for (pair, target) in pointers.windows(2).zip(out.chunks_exact_mut(3)) {
            let range = pair[0] as usize..pair[1] as usize;
            let (mut a, mut b, mut c) = (0.0, 0.0, 0.0);
            for (&copy, &weight) in self.block_copies[range.clone()]
                .iter()
                .zip(&self.block_weights[range])
            {
                let value = &y[3 * copy as usize..][..3];
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
            let range =
                self.row_pointers[first + k] as usize..self.row_pointers[first + k + 1] as usize;
            let entry = |e: usize| {
                let value = &y[3 * self.row_copies[e] as usize..][..3];
                let v = &self.row_vectors[e];
                v[0] * value[0] + v[1] * value[1] + v[2] * value[2]
            };
            *target = range.map(entry).sum();
        }
    }

    /// `out = B y` on the contact rows only.
    pub(crate) fn collect_contact(&self, y: &[f64], out: &mut [f64]) {
        self.collect_rows(y, 0, &mut out[..self.interface.start]);
    }

    /// Runs `task` on every lane with its work memory and its part of a boundary vector.
    pub(crate) fn for_lanes<W: Send>(
        &self,
        work: &mut [W],
        y: &mut [f64],
        parallel: bool,
        task: &(impl Fn(&Lane, &mut W, &mut [f64]) + Sync),
    ) {
        over_lanes(&self.lanes, work, y, &|lane| 3 * lane.copy, parallel, task);
    }

    /// Runs `task` on every lane with its part of a vector of six numbers per column.
    pub(crate) fn for_columns(
        &self,
        amplitudes: &mut [f64],
        task: &(impl Fn(&Lane, &mut [f64]) + Sync),
    ) {
        let mut none = [(); LANES];
        let parallel = self.copies >= SMALL;
        let count = self.lanes.len();
        over_lanes(
            &self.lanes,
            &mut none[..count],
            amplitudes,
            &|lane| 6 * lane.column,
            parallel,
            &|lane, (), part| {
                task(lane, part);
            },
        );
    }

    /// Whether loops over all copies are worth several threads.
    pub(crate) fn is_large(&self) -> bool {
        self.copies >= SMALL
    }

    /// A work memory without content for [`BoundaryMap::for_lanes`].
    pub(crate) fn no_work(&self) -> [(); LANES] {
        [(); LANES]
    }
}

fn over_lanes<W: Send>(
    lanes: &[Lane],
    work: &mut [W],
    y: &mut [f64],
    offset: &(impl Fn(&Lane) -> usize + Sync),
    parallel: bool,
    task: &(impl Fn(&Lane, &mut W, &mut [f64]) + Sync),
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
            if parallel {
                rayon::join(
                    || over_lanes(left, work_left, y_left, offset, parallel, task),
                    || over_lanes(right, work_right, y_right, offset, parallel, task),
                );
            } else {
                over_lanes(left, work_left, y_left, offset, parallel, task);
                over_lanes(right, work_right, y_right, offset, parallel, task);
            }
        }
    }
}

/// Transposes a table of rows: pointers by column, and for each entry its row and its position.
fn transpose(pointers: &[u32], columns: &[u32], count: usize) -> (Vec<u32>, Vec<(u32, u32)>) {
    let mut starts = vec![0_u32; count + 1];
    for &column in columns {
        starts[column as usize + 1] += 1;
    }
    for k in 0..count {
        starts[k + 1] += starts[k];
    }
    let mut next = starts.clone();
    let mut order = vec![(0, 0); columns.len()];
    for (row, pair) in pointers.windows(2).enumerate() {
        for entry in pair[0]..pair[1] {
            let at = &mut next[columns[entry as usize] as usize];
            order[*at as usize] = (row as u32, entry);
            *at += 1;
        }
    }
    (starts, order)
}
