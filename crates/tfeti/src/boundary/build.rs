//! Building the gather tables.

use super::{BoundaryClass, BoundaryMap, LANES, Lane, Panel, Place};
use crate::class::Classes;
use crate::cost::PANEL;
use crate::gluing::Gluing;
use signorini_fem_mesh::internal::buckets;

/// For each class: place of each node on the boundary, first panel, and first member of each panel.
struct Numbering<'a> {
    classes: &'a Classes,
    places: Vec<Vec<u32>>,
    panels: Vec<Vec<(usize, usize, usize)>>,
}

impl Numbering<'_> {
    /// Number of the copy and its place in boundary vectors.
    fn copy(&self, subdomain: u32, local: u32) -> (u32, Place) {
        let (class, member) = self.classes.place(subdomain as usize);
        let node = self.places[class][local as usize] as usize;
        let panels = &self.panels[class];
        let k = panels.partition_point(|&(first, _, _)| first <= member) - 1;
        let (first, width, start) = panels[k];
        let offset = node * width + (member - first);
        let place = Place {
            first: (3 * start + 2 * node * width + offset) as u32,
            stride: width as u32,
        };
        ((start + offset) as u32, place)
    }
}

impl BoundaryMap {
    pub(crate) fn new(classes: &Classes, gluing: &Gluing) -> Self {
        let mut map = Self::layout(classes, gluing);
        map.fill_panels();
        let copies = map.fill_collect(gluing, &map.numbering(classes));
        map.fill_spread(gluing, &copies);
        map.fill_specials();
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
        let list: Vec<BoundaryClass> = classes
            .classes()
            .iter()
            .zip(&touched)
            .map(|(class, touched)| {
                let nodes = (0..touched.len() as u32)
                    .filter(|&n| touched[n as usize])
                    .collect();
                BoundaryClass {
                    nodes,
                    members: class.members.clone(),
                }
            })
            .collect();
        Self {
            classes: list,
            panels: Vec::new(),
            lanes: Vec::new(),
            copies: 0,
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
            block_places: Vec::new(),
            block_weights: Vec::new(),
            row_pointers: vec![0],
            row_places: Vec::new(),
            row_vectors: Vec::new(),
        }
    }

    /// Cuts the members into panels of about equal width and the panels into lanes of about equal work. The cuts depend on
    /// the problem only, not on the number of threads.
    fn fill_panels(&mut self) {
        let mut work = Vec::new();
        for (class, boundary) in self
            .classes
            .iter()
            .enumerate()
            .filter(|(_, b)| !b.nodes.is_empty())
        {
            let (members, nodes) = (boundary.members.len(), boundary.nodes.len());
            let count = members.div_ceil(PANEL);
            for k in 0..count {
                let columns = members * k / count..members * (k + 1) / count;
                let copies = self.copies..self.copies + columns.len() * nodes;
                self.copies = copies.end;
                work.push((columns.len() * nodes * (nodes + 64)) as u64);
                self.panels.push(Panel {
                    class,
                    columns,
                    copies,
                    specials: 0..0,
                });
            }
        }
        let total: u64 = work.iter().sum();
        let lanes = LANES.min(self.panels.len()).max(1) as u64;
        let (mut done, mut start) = (0, 0);
        for k in 0..self.panels.len() {
            done += work[k];
            let full = done * lanes >= total * (self.lanes.len() as u64 + 1);
            if full || k + 1 == self.panels.len() {
                let first = &self.panels[start];
                self.lanes.push(Lane {
                    panels: start..k + 1,
                    copy: first.copies.start,
                });
                start = k + 1;
            }
        }
    }

    fn numbering<'a>(&self, classes: &'a Classes) -> Numbering<'a> {
        let places = (self.classes.iter().zip(classes.classes()))
            .map(|(boundary, class)| {
                let mut place = vec![u32::MAX; class.nodes];
                for (k, &node) in boundary.nodes.iter().enumerate() {
                    place[node as usize] = k as u32;
                }
                place
            })
            .collect();
        let mut panels = vec![Vec::new(); self.classes.len()];
        for panel in &self.panels {
            panels[panel.class].push((
                panel.columns.start,
                panel.columns.len(),
                panel.copies.start,
            ));
        }
        Numbering {
            classes,
            places,
            panels,
        }
    }

    /// Fills the tables by row; returns the copies of the blocks' entries and of the other rows' entries.
    fn fill_collect(&mut self, gluing: &Gluing, numbering: &Numbering<'_>) -> [Vec<u32>; 2] {
        let mut copies = [Vec::new(), Vec::new()];
        for block in 0..gluing.blocks() {
            for e in gluing.block(block) {
                let (copy, place) = numbering.copy(e.subdomain, e.local);
                copies[0].push(copy);
                self.block_places.push(place);
                self.block_weights.push(e.coefficient);
            }
            self.block_pointers.push(self.block_places.len() as u32);
        }
        for special in 0..gluing.specials() {
            for e in gluing.special(special) {
                let (copy, place) = numbering.copy(e.subdomain, e.local);
                copies[1].push(copy);
                self.row_places.push(place);
                self.row_vectors.push(e.vector);
            }
            self.row_pointers.push(self.row_places.len() as u32);
        }
        copies
    }

    /// Fills the tables by copy: the transposes of the tables by row.
    fn fill_spread(&mut self, gluing: &Gluing, copies: &[Vec<u32>; 2]) {
        let (pointers, order) = transpose(&self.block_pointers, &copies[0], self.copies);
        self.spread_pointers = pointers;
        self.spread_blocks = order.iter().map(|&(block, _)| block).collect();
        self.spread_weights = order
            .iter()
            .map(|&(_, entry)| self.block_weights[entry as usize])
            .collect();
        let (pointers, order) = transpose(&self.row_pointers, &copies[1], self.copies);
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

    fn fill_specials(&mut self) {
        let copies = &self.special_copies;
        let place = |copy: usize| copies.partition_point(|&c| (c as usize) < copy);
        for panel in &mut self.panels {
            panel.specials = place(panel.copies.start)..place(panel.copies.end);
        }
    }
}

/// Transposes a table of rows: pointers by column, and for each entry its row and its position.
fn transpose(pointers: &[u32], columns: &[u32], count: usize) -> (Vec<u32>, Vec<(u32, u32)>) {
    let mut row_of = Vec::with_capacity(columns.len());
    for (row, pair) in pointers.windows(2).enumerate() {
        row_of.extend((pair[0]..pair[1]).map(|_| row as u32));
    }
    let (starts, entries) = buckets(count, columns);
    let order = entries.into_iter().map(|e| (row_of[e as usize], e));
    (starts, order.collect())
}
