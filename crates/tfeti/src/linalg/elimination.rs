//! Symbolic elimination: which columns of a factor couple to which, and which are worked on together.

use std::ops::Range;

/// Consecutive columns eliminated together, and the later ones that this changes, ascending.
#[derive(Debug)]
pub(crate) struct Group {
    pub(crate) columns: Range<usize>,
    pub(crate) below: Vec<u32>,
}

/// Positions below the diagonal in each column of the factor of a matrix with this graph (neighbours of each block), in
/// the order of elimination `blocks`.
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
        graph[block as usize].iter().for_each(|&b| add(place[b as usize]));
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

/// Groups columns, each of which takes in the groups before it that end at it and lead to it, where that costs less and
/// the columns are `alike`. `cost` is that of a group from its columns and the number below them.
pub(crate) fn grouped(
    columns: Range<usize>,
    patterns: &[Vec<u32>],
    alike: impl Fn(usize, usize) -> bool,
    cost: impl Fn(usize, usize) -> usize,
) -> Vec<Group> {
    let cost = |g: &Group| cost(g.columns.len(), g.below.len());
    let mut groups: Vec<Group> = Vec::new();
    for column in columns {
        let below = patterns[column].clone();
        let mut next = Group {
            columns: column..column + 1,
            below,
        };
        while let Some(last) = groups.last() {
            let leads = last
                .below
                .first()
                .is_some_and(|&p| next.columns.contains(&(p as usize)));
            let separate = cost(last) + cost(&next);
            let before = std::mem::replace(&mut next.columns.start, last.columns.start);
            if !leads || !alike(last.columns.start, column) || cost(&next) > separate {
                next.columns.start = before;
                break;
            }
            groups.pop();
        }
        groups.push(next);
    }
    groups
}
