//! Pattern of the factor of the coarse matrix: groups of blocks that are eliminated together.

use crate::linalg::elimination::{grouped, patterns};
use crate::linalg::sparse::FactorError;
use crate::linalg::supernodes::Supernodes;
use crate::linalg::tiles::Tile;
use crate::projector::split::order::{Dissection, Region};
use crate::tolerances::{BORDER, CUTS, NODE, OPERATION, READ, SOLVES};
use signorini_fem_mesh::internal::distinct;
use std::ops::Range;

/// Groups of blocks (*nodes*) in the order of elimination, each with the later blocks (its *border*) that it changes.
///
/// Positions count blocks of six unknowns in the order of elimination.
#[derive(Debug)]
pub(crate) struct CoarseTree {
    /// Old number of the block at each position.
    pub(crate) blocks: Vec<u32>,
    /// Position of each block.
    pub(crate) place: Vec<u32>,
    pub(crate) nodes: Vec<Node>,
    pub(crate) regions: Vec<TreeRegion>,
}

#[derive(Debug)]
pub(crate) struct Node {
    pub(crate) columns: Range<usize>,
    /// Positions, ascending.
    pub(crate) border: Vec<u32>,
    /// The node that holds the first block of the border.
    pub(crate) parent: Option<usize>,
    /// Earlier nodes whose parent this is.
    pub(crate) children: Vec<usize>,
    /// Place of each border block in the parent.
    pub(crate) into: Vec<u32>,
    /// Whether it changes with the active set.
    pub(crate) changing: bool,
}

/// A region with its nodes. *Places* of a region count its own blocks, then the blocks behind it.
#[derive(Debug)]
pub(crate) struct TreeRegion {
    /// Position of the first block of the first region within.
    pub(crate) start: usize,
    /// Own blocks.
    pub(crate) own: Range<usize>,
    /// The regions on both sides of the cut.
    pub(crate) children: Option<[usize; 2]>,
    /// First of the regions within, or itself.
    pub(crate) first_region: usize,
    /// First node of the regions within, or its own.
    pub(crate) first_node: usize,
    /// Own nodes that stay.
    pub(crate) steady: Range<usize>,
    /// Own nodes that change.
    pub(crate) changing: Range<usize>,
    /// Positions of later blocks that own nodes or regions within change, ascending.
    pub(crate) behind: Vec<u32>,
    /// Place of each block behind in the region around.
    pub(crate) lift: Vec<u32>,
}

/// Place of a position among own columns, then among later ones.
fn place_among(own: &Range<usize>, later: &[u32], position: u32) -> u32 {
    if own.contains(&(position as usize)) {
        position - own.start as u32
    } else {
        (own.len() + later.partition_point(|&b| b < position)) as u32
    }
}

impl TreeRegion {
    /// Place of a position.
    pub(crate) fn local(&self, position: u32) -> u32 {
        place_among(&self.own, &self.behind, position)
    }
}

impl Node {
    pub(crate) fn width(&self) -> usize {
        6 * self.columns.len()
    }

    pub(crate) fn height(&self) -> usize {
        self.width() + 6 * self.border.len()
    }

    /// Place of a position.
    fn local(&self, position: u32) -> u32 {
        place_among(&self.columns, &self.border, position)
    }

    /// Where the block of the positions `row >= column`, its own, begins in its columns.
    pub(crate) fn place(&self, row: u32, column: u32) -> usize {
        let own = column as usize - self.columns.start;
        6 * own * self.height() + 6 * self.local(row) as usize
    }

    /// Operations of its elimination.
    pub(crate) fn operations(&self) -> f64 {
        let (w, b) = (self.width() as f64, 6.0 * self.border.len() as f64);
        w * w * w / 3.0 + w * w * b + w * b * b
    }

    /// Seconds of the solves between two changes, and of a change.
    fn cost(&self) -> f64 {
        let (w, h) = (self.width() as f64, self.height() as f64);
        let change = if self.changing { self.operations() } else { 0.0 };
        SOLVES * READ * (w * (h - 0.5 * w)) + OPERATION * change
    }
}

/// The cheapest tree for changes of the active set and the solves between them, by layers of a `grid` if there is one.
pub(crate) fn cheapest_tree(
    graph: &[Vec<u32>],
    centres: &[[f64; 3]],
    changing: &[bool],
    grid: Option<&[[u32; 3]]>,
) -> Option<CoarseTree> {
    let mut best = CoarseTree::new(graph, centres, changing, 0, grid).ok()?;
    for cuts in 1..=CUTS {
        let next = CoarseTree::new(graph, centres, changing, cuts, grid).ok()?;
        if next.cost() >= best.cost() {
            break;
        }
        best = next;
    }
    Some(best)
}

impl CoarseTree {
    /// For the `graph` of the blocks (neighbours without itself); blocks that are `changing` follow the active set.
    /// Where they stand in a `grid`, most regions are equal to others.
    pub(crate) fn new(
        graph: &[Vec<u32>],
        centres: &[[f64; 3]],
        changing: &[bool],
        cuts: usize,
        grid: Option<&[[u32; 3]]>,
    ) -> Result<Self, FactorError> {
        let Dissection { blocks, regions } = Dissection::new(graph, centres, changing, cuts, grid)?;
        let blocks = postorder(&blocks, &patterns(graph, &blocks), &regions, changing);
        let patterns = patterns(graph, &blocks);
        let mut place = vec![0; blocks.len()];
        for (position, &block) in blocks.iter().enumerate() {
            place[block as usize] = position as u32;
        }
        let (nodes, trees) = (Vec::new(), Vec::new());
        let mut out = Self {
            nodes,
            regions: trees,
            place,
            blocks,
        };
        for region in regions {
            out.group(region, &patterns, changing);
        }
        out.join();
        Ok(out)
    }

    /// Numbers that a factor stores: exact and rounded tiles, and what is steady in the columns that change. Steady
    /// columns count in regions with tiles of their `own`.
    pub(crate) fn stored(&self, own: impl Iterator<Item = bool>) -> usize {
        // a rounded tile is half a tile
        let tiles = |node: &Node| Tile::NUMBERS * Supernodes::tiles_of(node.width(), node.height()) * 3 / 2;
        let region = |(region, own): (&TreeRegion, bool)| {
            let steady = if own { region.steady.clone() } else { 0..0 };
            let changing = &self.nodes[region.changing.clone()];
            let columns: usize = changing.iter().map(|n| tiles(n) + n.width() * n.height()).sum();
            columns + self.nodes[steady].iter().map(tiles).sum::<usize>()
        };
        self.regions.iter().zip(own).map(region).sum()
    }

    /// Operations of an elimination; steady columns count in regions of their `own`.
    pub(crate) fn operations(&self, own: impl Iterator<Item = bool>) -> f64 {
        let region = |(region, own): (&TreeRegion, bool)| {
            let first = if own { region.steady.start } else { region.changing.start };
            let nodes = &self.nodes[first..region.changing.end];
            nodes.iter().map(Node::operations).sum::<f64>()
        };
        self.regions.iter().zip(own).map(region).sum()
    }

    /// Seconds on two threads: of the larger side only of the first cut.
    pub(crate) fn cost(&self) -> f64 {
        let Some(root) = self.regions.last() else {
            return 0.0;
        };
        let sum = |nodes: Range<usize>| self.nodes_cost(nodes);
        let own = root.steady.start..root.changing.end;
        let middle = (root.children).map_or(0, |[_, right]| self.regions[right].first_node);
        sum(own.clone()) + sum(0..middle).max(sum(middle..own.start))
    }

    /// The same of a region and those within, one after the other.
    pub(crate) fn branch_cost(&self, r: usize) -> f64 {
        self.nodes_cost(self.regions[r].first_node..self.regions[r].changing.end)
    }

    fn nodes_cost(&self, nodes: Range<usize>) -> f64 {
        self.nodes[nodes].iter().map(Node::cost).sum()
    }

    /// Whether anything changes.
    pub(crate) fn changes(&self) -> bool {
        self.nodes.iter().any(|n| n.changing)
    }

    /// Whether anything changes in a region or those within.
    pub(crate) fn region_changes(&self, r: usize) -> bool {
        let region = &self.regions[r];
        self.nodes[region.first_node..region.changing.end]
            .iter()
            .any(|n| n.changing)
    }

    /// Places in a region of what is behind the regions within and in the borders that lead to it, for lists in any
    /// order.
    pub(crate) fn place_children(&mut self, r: usize) {
        self.lift_children(r);
        for k in self.regions[r].steady.start..self.regions[r].changing.end {
            for child in self.nodes[k].children.clone() {
                let above = &self.nodes[k];
                self.nodes[child].into = self.nodes[child].border.iter().map(|&p| above.local(p)).collect();
            }
        }
    }

    /// Takes over the places of what is behind the regions within from an `equal` region.
    pub(crate) fn copy_children(&mut self, r: usize, equal: usize) {
        let children = |r: usize| self.regions[r].children.into_iter().flatten();
        for (child, other) in children(r).zip(children(equal)).collect::<Vec<_>>() {
            self.regions[child].lift = self.regions[other].lift.clone();
        }
    }

    fn lift_children(&mut self, r: usize) {
        for child in self.regions[r].children.into_iter().flatten() {
            let region = &self.regions[r];
            self.regions[child].lift = self.regions[child].behind.iter().map(|&p| region.local(p)).collect();
        }
    }

    /// The node that holds a position.
    pub(crate) fn node_of(&self, position: usize) -> usize {
        self.nodes.partition_point(|n| n.columns.end <= position)
    }

    /// The node and the place in its columns of the block of two blocks, if its row does not stand before its column.
    pub(crate) fn front(&self, row: u32, column: u32) -> Option<(usize, usize)> {
        let (p, q) = (self.place[row as usize], self.place[column as usize]);
        let k = self.node_of(q as usize);
        (p >= q).then(|| (k, self.nodes[k].place(p, q)))
    }

    /// Groups the own blocks of a region where that saves time.
    fn group(&mut self, region: Region, patterns: &[Vec<u32>], changing: &[bool]) {
        let first_own = self.nodes.len();
        let changes = |position: usize| changing[self.blocks[position] as usize];
        let cost = |width: usize, border: usize| {
            let w = 6 * width;
            NODE + BORDER * (border + width) + w * (6 * border) + w * w / 2
        };
        let alike = |a, b| changes(a) == changes(b);
        let groups = grouped(region.own.clone(), patterns, alike, cost)
            .into_iter()
            .map(|g| Node {
                changing: changes(g.columns.start),
                columns: g.columns,
                border: g.below,
                parent: None,
                children: Vec::new(),
                into: Vec::new(),
            });
        self.nodes.extend(groups);
        let within = region.children.map(|c| &self.regions[c[0]]);
        let first_node = within.map_or(first_own, |r| r.first_node);
        let first_region = within.map_or(self.regions.len(), |r| r.first_region);
        let end = self.nodes.len();
        let inner = region.children.iter().flatten().flat_map(|&k| &self.regions[k].behind);
        let borders = self.nodes[first_own..].iter().flat_map(|n| &n.border);
        let later = |p: &u32| *p as usize >= region.own.end;
        let behind = distinct(borders.chain(inner).copied().filter(later));
        let region = TreeRegion {
            first_region,
            first_node,
            steady: first_own..end,
            changing: end..end,
            behind,
            lift: Vec::new(),
            start: region.start,
            own: region.own,
            children: region.children,
        };
        self.regions.push(region);
        self.lift_children(self.regions.len() - 1);
    }

    /// Finds parents and what changes, and divides each region into what stays and what changes.
    fn join(&mut self) {
        for r in 0..self.regions.len() {
            let own = self.regions[r].steady.clone();
            let mut changes = false;
            for k in own.clone() {
                changes |= self.nodes[k].changing;
                self.nodes[k].changing = changes;
                let Some(&first) = self.nodes[k].border.first() else {
                    continue;
                };
                let parent = self.node_of(first as usize);
                let (node, above) = (&self.nodes[k], &self.nodes[parent]);
                let into = node.border.iter().map(|&p| above.local(p)).collect();
                self.nodes[k].parent = Some(parent);
                self.nodes[k].into = into;
                self.nodes[parent].changing |= changes;
                self.nodes[parent].children.push(k);
            }
            let steady = own.clone().take_while(|&k| !self.nodes[k].changing).count();
            self.regions[r].changing = own.start + steady..own.end;
            self.regions[r].steady = own.start..own.start + steady;
        }
    }
}

/// Reorders the own blocks of each region such that what leads to a block stands right before it: what stays first,
/// then the larger last.
fn postorder(blocks: &[u32], patterns: &[Vec<u32>], regions: &[Region], changing: &[bool]) -> Vec<u32> {
    let mut changes: Vec<bool> = blocks.iter().map(|&b| changing[b as usize]).collect();
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); blocks.len()];
    let mut out = blocks.to_vec();
    for region in regions {
        let own = region.own.clone();
        let mut roots = Vec::new();
        for position in own.clone() {
            match patterns[position].first() {
                Some(&p) if own.contains(&(p as usize)) => {
                    changes[p as usize] |= changes[position];
                    children[p as usize].push(position);
                }
                _ => roots.push(position),
            }
        }
        // From the back: parents before children, the last ones first.
        let mut stack = roots;
        stack.sort_by_key(|&c| (changes[c], c));
        let mut next = own.end;
        while let Some(position) = stack.pop() {
            next -= 1;
            out[next] = blocks[position];
            let list = &mut children[position];
            list.sort_by_key(|&c| (changes[c], patterns[c].len(), c));
            stack.append(list);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::projector::split::order::tests::grid;

    /// Places that elimination fills, block by block.
    fn filled(graph: &[Vec<u32>], tree: &CoarseTree) -> Vec<Vec<bool>> {
        let count = graph.len();
        let mut fill = vec![vec![false; count]; count];
        for (a, list) in graph.iter().enumerate() {
            for &b in list {
                fill[tree.place[a] as usize][tree.place[b as usize] as usize] = true;
            }
        }
        for k in 0..count {
            let below: Vec<usize> = (k + 1..count).filter(|&i| fill[i][k]).collect();
            for &i in &below {
                below.iter().for_each(|&j| fill[i][j] = true);
            }
        }
        fill
    }

    fn check(size: [usize; 3], changing: impl Fn(&[f64; 3]) -> bool, cuts: usize) {
        let (graph, centres) = grid(size);
        let changing: Vec<bool> = centres.iter().map(changing).collect();
        let tree = CoarseTree::new(&graph, &centres, &changing, cuts, None).unwrap();
        let fill = filled(&graph, &tree);
        let mut next = 0;
        for (k, node) in tree.nodes.iter().enumerate() {
            assert_eq!(node.columns.start, next);
            next = node.columns.end;
            for column in node.columns.clone() {
                let rows = (node.columns.end..graph.len()).filter(|&row| fill[row][column]);
                for row in rows {
                    assert!(node.border.contains(&(row as u32)), "{row} {column}");
                }
                assert!(node.changing || !changing[tree.blocks[column] as usize]);
            }
            let Some(parent) = node.parent else {
                assert!(node.border.is_empty());
                continue;
            };
            let above = &tree.nodes[parent];
            assert!(above.children.contains(&k) && (above.changing || !node.changing));
            let places: Vec<u32> = (above.columns.clone().map(|p| p as u32))
                .chain(above.border.iter().copied())
                .collect();
            let found = node.into.iter().map(|&k| places[k as usize]);
            assert!(found.eq(node.border.iter().copied()));
        }
        assert_eq!(next, graph.len());
        for region in &tree.regions {
            let nodes = &tree.nodes[region.steady.start..region.changing.end];
            let own = region.own.len();
            for &p in nodes.iter().flat_map(|n| &n.border) {
                let local = region.local(p) as usize;
                assert!(local < own || region.behind[local - own] == p);
            }
        }
    }

    #[test]
    fn borders_hold_the_fill_and_places_in_parents_agree() {
        for cuts in 0..3 {
            check([12, 4, 3], |c| c[2] == 0.0, cuts);
        }
        check([9, 3, 2], |_| true, 1);
        check([9, 3, 2], |_| false, 1);
        check([10, 4, 2], |c| c[0] > 6.0 || c[1] == 0.0, 2);
        check([1, 1, 1], |_| true, 0);
    }
}
