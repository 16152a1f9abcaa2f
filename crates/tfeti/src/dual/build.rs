//! Building the gather tables.

use super::boundary::{BoundaryClass, BoundaryMap, Panel, shares};
use super::cut::{Cut, CutBuilder, Place};
use super::part::RowPart;
use crate::rows::gluing::Gluing;
use crate::subdomain::class::{Class, Classes};
use crate::subdomain::ownership::Ownership;
use signorini_fem_mesh::internal::Lists;
use std::ops::Range;

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
    pub(crate) fn new(classes: &Classes, gluing: &Gluing, ownership: &Ownership) -> Self {
        let mut map = Self {
            classes: boundaries(classes, gluing),
            interface: gluing.ranges().interface.clone(),
            rows: gluing.ranges().total(),
            nodal_pointers: vec![0],
            exchange: ownership.exchange.clone(),
            ..Self::default()
        };
        map.fill_panels(ownership);
        let numbering = map.numbering(classes);
        map.cut = map.fill_cut(gluing, &numbering, None);
        let computed = map.cut.computed(map.exchange.rank(), &map.interface);
        map.fill_tables(gluing, &numbering, (map.exchange.ranks() > 1).then_some(computed));
        map
    }

    /// The same panels for vectors of which each rank keeps a part; `own` are the rows of this one.
    pub(crate) fn of_part(&self, classes: &Classes, gluing: &Gluing, (part, own): (&RowPart, &Gluing)) -> Self {
        let mut map = Self {
            classes: self.classes.clone(),
            panels: self.panels.clone(),
            lanes: self.lanes.clone(),
            parts: self.parts.clone(),
            copies: self.copies,
            interface: own.ranges().interface.clone(),
            rows: own.ranges().total(),
            nodal_pointers: vec![0],
            exchange: self.exchange.clone(),
            ..Self::default()
        };
        let numbering = map.numbering(classes);
        map.cut = map.fill_cut(gluing, &numbering, Some(part));
        map.fill_tables(own, &numbering, None);
        map
    }

    fn fill_tables(&mut self, gluing: &Gluing, numbering: &Numbering<'_>, computed: Option<Vec<Range<usize>>>) {
        let copies = self.fill_collect(gluing, numbering, computed);
        self.fill_spread(gluing, &copies);
        let nodal = &self.nodal_copies;
        let place = |copy: usize| nodal.partition_point(|&c| (c as usize) < copy);
        for panel in &mut self.panels {
            panel.nodal = place(panel.copies.start)..place(panel.copies.end);
        }
    }

    /// Takes the panels of the ranks, and cuts those of this one into lanes of about equal work.
    fn fill_panels(&mut self, ownership: &Ownership) {
        let mut work = Vec::new();
        for (rank, panels) in ownership.panels.iter().enumerate() {
            let first = (self.panels.len(), self.copies);
            for (class, columns) in panels.iter().cloned() {
                let nodes = self.classes[class].nodes.len();
                if nodes == 0 {
                    continue;
                }
                let copies = self.copies..self.copies + columns.len() * nodes;
                self.copies = copies.end;
                if rank == ownership.exchange.rank() {
                    work.push((columns.len() * nodes * (nodes + 64)) as u64);
                }
                let nodal = 0..0;
                self.panels.push(Panel {
                    class,
                    columns,
                    copies,
                    nodal,
                });
            }
            self.parts.push(3 * first.1..3 * self.copies);
            if rank == ownership.exchange.rank() {
                let lane = |own: Range<usize>| first.0 + own.start..first.0 + own.end;
                self.lanes = shares(&work, 1, work.len()).into_iter().map(lane).collect();
            }
        }
    }

    fn numbering<'a>(&self, classes: &'a Classes) -> Numbering<'a> {
        let places = self.classes.iter().zip(classes.classes()).map(|(boundary, class)| {
            let mut place = vec![u32::MAX; class.nodes];
            for (k, &node) in boundary.nodes.iter().enumerate() {
                place[node as usize] = k as u32;
            }
            place
        });
        let mut panels = vec![Vec::new(); self.classes.len()];
        for p in &self.panels {
            panels[p.class].push((p.columns.start, p.columns.len(), p.copies.start));
        }
        let places = places.collect();
        Numbering {
            classes,
            places,
            panels,
        }
    }

    /// Fills the tables by row; returns the copies of the blocks' entries and of the other rows' entries.
    /// Of blocks only those that are `computed`, if that is given.
    fn fill_collect(
        &mut self,
        gluing: &Gluing,
        numbering: &Numbering<'_>,
        computed: Option<Vec<Range<usize>>>,
    ) -> [Vec<u32>; 2] {
        let mut copies = [Vec::new(), Vec::new()];
        let all = computed.is_none();
        let mut mine = computed.into_iter().flatten().peekable();
        for block in 0..gluing.blocks() {
            let row = self.interface.start + 3 * block;
            while mine.next_if(|rows| rows.end <= row).is_some() {}
            let is_computed = all || mine.peek().is_some_and(|rows| rows.contains(&row));
            let entries = gluing.block(block).iter().filter(|_| is_computed);
            self.blocks.push(entries.map(|e| {
                let (copy, place) = numbering.copy(e.subdomain, e.local);
                copies[0].push(copy);
                (place, e.coefficient)
            }));
        }
        for nodal in 0..gluing.nodal_rows() {
            self.others.push(gluing.nodal(nodal).iter().map(|e| {
                let (copy, place) = numbering.copy(e.subdomain, e.local);
                copies[1].push(copy);
                (place, e.vector)
            }));
        }
        copies
    }

    /// What the ranks compute alone and tell one another.
    fn fill_cut(&self, gluing: &Gluing, numbering: &Numbering<'_>, part: Option<&RowPart>) -> Cut {
        let ranks = self.exchange.ranks();
        if ranks == 1 {
            return Cut::default();
        }
        let mut cut = CutBuilder::new(ranks, part);
        let copy = |subdomain: u32, local: u32| {
            let (copy, place) = numbering.copy(subdomain, local);
            let rank = self.parts.partition_point(|part| part.end <= 3 * copy as usize);
            (rank, copy, place)
        };
        for nodal in 0..gluing.nodal_rows() {
            let copies = gluing.nodal(nodal).iter().map(|e| copy(e.subdomain, e.local));
            let row = gluing.nodal_row(nodal);
            cut.enter(row..row + 1, &copies.collect::<Vec<_>>());
        }
        for block in 0..gluing.blocks() {
            let copies = gluing.block(block).iter().map(|e| copy(e.subdomain, e.local));
            let row = gluing.ranges().interface.start + 3 * block;
            cut.enter(row..row + 3, &copies.collect::<Vec<_>>());
        }
        // of the rows here
        cut.build(&self.interface)
    }

    /// Fills the tables by copy: the transposes of the tables by row.
    fn fill_spread(&mut self, gluing: &Gluing, copies: &[Vec<u32>; 2]) {
        let order = transpose(self.blocks.starts(), &copies[0], self.copies);
        self.spread_pointers = order.starts().to_vec();
        self.spread_blocks = order.items().iter().map(|&(block, _)| block).collect();
        let weights = order.items().iter().map(|e| self.blocks.items()[e.1 as usize].1);
        self.spread_weights = weights.collect();
        let order = transpose(self.others.starts(), &copies[1], self.copies);
        for copy in (0..self.copies).filter(|&copy| !order.of(copy).is_empty()) {
            self.nodal_copies.push(copy as u32);
            for &(nodal, entry) in order.of(copy) {
                self.nodal_rows.push(gluing.nodal_row(nodal as usize) as u32);
                self.nodal_vectors.push(self.others.items()[entry as usize].1);
            }
            self.nodal_pointers.push(self.nodal_rows.len() as u32);
        }
    }
}

/// Boundary nodes of each class: those touched in any member.
fn boundaries(classes: &Classes, gluing: &Gluing) -> Vec<BoundaryClass> {
    let list = classes.classes();
    let mut touched: Vec<Vec<bool>> = list.iter().map(|c| vec![false; c.nodes]).collect();
    let mut touch = |subdomain: u32, local: u32| {
        touched[classes.place(subdomain as usize).0][local as usize] = true;
    };
    let blocks = (0..gluing.blocks()).flat_map(|block| gluing.block(block));
    blocks.for_each(|e| touch(e.subdomain, e.local));
    let nodal = (0..gluing.nodal_rows()).flat_map(|nodal| gluing.nodal(nodal));
    nodal.for_each(|e| touch(e.subdomain, e.local));
    let boundary = |(class, touched): (&Class, Vec<bool>)| BoundaryClass {
        nodes: (0..class.nodes as u32).filter(|&n| touched[n as usize]).collect(),
        members: class.members.clone(),
    };
    list.iter().zip(touched).map(boundary).collect()
}

/// Transposes a table of rows: for each column the row and the position of each entry.
fn transpose(pointers: &[u32], columns: &[u32], count: usize) -> Lists<(u32, u32)> {
    let mut row_of = Vec::with_capacity(columns.len());
    for (row, pair) in pointers.windows(2).enumerate() {
        row_of.extend((pair[0]..pair[1]).map(|_| row as u32));
    }
    Lists::by_key(count, columns).map(|e| (row_of[e as usize], e))
}
