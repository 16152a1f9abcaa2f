//! Pattern of the factor of the coarse matrix: groups of blocks that are eliminated together.

use crate::linalg::sparse::FactorError;
use crate::projector::split::order::{Dissection, Region};
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
    /// Place of each border block in the parent: among its columns, then among its border.
    pub(crate) into: Vec<u32>,
    /// Whether it changes with the face.
    pub(crate) changing: bool,
}

/// A region with its nodes. *Places* of a region count its own blocks, then the blocks behind it.
#[derive(Debug)]
pub(crate) struct TreeRegion {
    pub(crate) region: Region,
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

impl TreeRegion {
    /// Place of a position.
    pub(crate) fn local(&self, position: u32) -> u32 {
        let own = &self.region.own;
        if own.contains(&(position as usize)) {
            position - own.start as u32
        } else {
            (own.len() + self.behind.partition_point(|&b| b < position)) as u32
        }
    }
}

impl Node {
    pub(crate) fn width(&self) -> usize {
        6 * self.columns.len()
    }

    pub(crate) fn height(&self) -> usize {
        self.width() + 6 * self.border.len()
    }

    /// Numbers of its columns.
    pub(crate) fn stored(&self) -> f64 {
        let (w, h) = (self.width() as f64, self.height() as f64);
        w * (h - 0.5 * w)
    }

    /// Operations of its elimination.
    pub(crate) fn operations(&self) -> f64 {
        let (w, b) = (self.width() as f64, 6.0 * self.border.len() as f64);
        w * w * w / 3.0 + w * w * b + w * b * b
    }
}

/// What a node costs a solve besides its numbers, in numbers: the node itself, and a block of its border.
const NODE: usize = 90;
const BORDER: usize = 12;

impl CoarseTree {
    /// For the `graph` of the blocks (neighbours without itself); blocks that are `changing` follow the face.
    pub(crate) fn new(
        graph: &[Vec<u32>],
        centres: &[[f64; 3]],
        changing: &[bool],
        cuts: usize,
    ) -> Result<Self, FactorError> {
        let Dissection { blocks, regions } = Dissection::new(graph, centres, changing, cuts)?;
        let blocks = postorder(&blocks, &patterns(graph, &blocks), &regions, changing);
        let patterns = patterns(graph, &blocks);
        let mut place = vec![0; blocks.len()];
        for (position, &block) in blocks.iter().enumerate() {
            place[block as usize] = position as u32;
        }
        let mut out = Self {
            nodes: Vec::new(),
            regions: Vec::new(),
            place,
            blocks,
        };
        for region in regions {
            out.group(region, &patterns, changing);
        }
        out.join();
        Ok(out)
    }

    /// Unknowns.
    pub(crate) fn dim(&self) -> usize {
        6 * self.blocks.len()
    }

    /// Sum of a size of all nodes, of the larger side only of the first cut.
    pub(crate) fn longest(&self, size: impl Fn(&Node) -> f64) -> f64 {
        let Some(root) = self.regions.last() else {
            return 0.0;
        };
        let sum = |nodes: Range<usize>| self.nodes[nodes].iter().map(&size).sum::<f64>();
        let own = root.steady.start..root.changing.end;
        let middle = (root.region.children).map_or(0, |[_, right]| self.regions[right].first_node);
        sum(own.clone()) + sum(0..middle).max(sum(middle..own.start))
    }

    /// The node that holds a position.
    pub(crate) fn node_of(&self, position: usize) -> usize {
        self.nodes.partition_point(|n| n.columns.end <= position)
    }

    /// Where the block of the positions `row >= column` begins in the columns of `node`, which holds `column`.
    pub(crate) fn place_in(&self, node: usize, row: u32, column: u32) -> usize {
        let node = &self.nodes[node];
        let own = node.columns.start as u32..node.columns.end as u32;
        let place = match own.contains(&row) {
            true => row - own.start,
            false => (own.len() + node.border.partition_point(|&b| b < row)) as u32,
        };
        6 * (column - own.start) as usize * node.height() + 6 * place as usize
    }

    /// Groups the own blocks of a region where that saves time.
    fn group(&mut self, region: Region, patterns: &[Vec<u32>], changing: &[bool]) {
        let first_own = self.nodes.len();
        let cost = |width: usize, border: usize| {
            let w = 6 * width;
            NODE + BORDER * (border + width) + w * (6 * border) + w * w / 2
        };
        for position in region.own.clone() {
            let mut node = Node {
                columns: position..position + 1,
                border: patterns[position].clone(),
                parent: None,
                children: Vec::new(),
                into: Vec::new(),
                changing: changing[self.blocks[position] as usize],
            };
            // Earlier groups that end here and lead here are taken in if that costs less.
            while self.nodes.len() > first_own {
                let last = &self.nodes[self.nodes.len() - 1];
                let leads =
                    (last.border.first()).is_some_and(|&p| node.columns.contains(&(p as usize)));
                let separate = cost(last.columns.len(), last.border.len())
                    + cost(node.columns.len(), node.border.len());
                let width = last.columns.len() + node.columns.len();
                if !leads
                    || last.changing != node.changing
                    || cost(width, node.border.len()) > separate
                {
                    break;
                }
                node.columns.start = last.columns.start;
                self.nodes.pop();
            }
            self.nodes.push(node);
        }
        let within = region.children.map(|c| &self.regions[c[0]]);
        let first_node = within.map_or(first_own, |r| r.first_node);
        let first_region = within.map_or(self.regions.len(), |r| r.first_region);
        let end = self.nodes.len();
        let mut behind: Vec<u32> = (self.nodes[first_own..].iter())
            .flat_map(|n| &n.border)
            .chain(
                region
                    .children
                    .iter()
                    .flatten()
                    .flat_map(|&k| &self.regions[k].behind),
            )
            .copied()
            .filter(|&p| p as usize >= region.own.end)
            .collect();
        behind.sort_unstable();
        behind.dedup();
        let region = TreeRegion {
            first_region,
            first_node,
            steady: first_own..end,
            changing: end..end,
            behind,
            lift: Vec::new(),
            region,
        };
        for k in region.region.children.into_iter().flatten() {
            let lift = |&p: &u32| region.local(p);
            self.regions[k].lift = self.regions[k].behind.iter().map(lift).collect();
        }
        self.regions.push(region);
    }

    /// Finds parents and what changes, and divides each region into what stays and what changes.
    fn join(&mut self) {
        for region in &mut self.regions {
            let own = region.steady.clone();
            let mut changes = false;
            for k in own.clone() {
                changes |= self.nodes[k].changing;
                self.nodes[k].changing = changes;
                let first = self.nodes[k].border.first().copied();
                let parent =
                    first.map(|p| self.nodes.partition_point(|n| n.columns.end <= p as usize));
                self.nodes[k].parent = parent;
                if let Some(parent) = parent {
                    let above = &self.nodes[parent];
                    let width = above.columns.len();
                    let into = |&p: &u32| match above.columns.contains(&(p as usize)) {
                        true => p - above.columns.start as u32,
                        false => (width + above.border.partition_point(|&b| b < p)) as u32,
                    };
                    self.nodes[k].into = self.nodes[k].border.iter().map(into).collect();
                    self.nodes[parent].changing |= changes;
                    self.nodes[parent].children.push(k);
                }
            }
            let steady = own.clone().take_while(|&k| !self.nodes[k].changing).count();
            region.changing = own.start + steady..own.end;
            region.steady = own.start..own.start + steady;
        }
    }
}

/// Positions below the diagonal in each column of the factor.
pub(crate) fn patterns(graph: &[Vec<u32>], blocks: &[u32]) -> Vec<Vec<u32>> {
    let count = blocks.len();
    let mut place = vec![0_u32; count];
    for (position, &block) in blocks.iter().enumerate() {
        place[block as usize] = position as u32;
    }
    let mut patterns: Vec<Vec<u32>> = Vec::with_capacity(count);
    let mut children: Vec<Vec<u32>> = vec![Vec::new(); count];
    let mut seen = vec![u32::MAX; count];
    for (position, &block) in blocks.iter().enumerate() {
        let mark = position as u32;
        seen[position] = mark;
        let mut own = Vec::new();
        let mut add = |p: u32| {
            if p > mark && seen[p as usize] != mark {
                seen[p as usize] = mark;
                own.push(p);
            }
        };
        graph[block as usize]
            .iter()
            .for_each(|&b| add(place[b as usize]));
        for &child in &children[position] {
            patterns[child as usize].iter().for_each(|&p| add(p));
        }
        own.sort_unstable();
        if let Some(&first) = own.first() {
            children[first as usize].push(mark);
        }
        patterns.push(own);
    }
    patterns
}

/// Reorders the own blocks of each region such that what leads to a block stands right before it: what stays first, then
/// the larger last.
fn postorder(
    blocks: &[u32],
    patterns: &[Vec<u32>],
    regions: &[Region],
    changing: &[bool],
) -> Vec<u32> {
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
        let tree = CoarseTree::new(&graph, &centres, &changing, cuts).unwrap();
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
            let own = region.region.own.len();
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
