//! A factor in which nothing changes, of equal regions once.
//!
//! Regions are equal if their own columns hold the same numbers, bit for bit, at the same places among what is around
//! them, and if the regions within are equal. In a grid of translates that is so for all but the few pieces at each
//! kind of border.

use crate::coarse::matrix::Entries;
use crate::linalg::supernodes::Supernodes;
use crate::linalg::zeros;
use crate::projector::split::front::{Front, extend, load_columns};
use crate::projector::split::tiles::Tiles;
use crate::projector::split::tree::{CoarseTree, TreeRegion};
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::Arc;

/// What a region leaves: its tiles, and for the later unknowns the update of each of its nodes.
type Grown = (Tiles, Vec<Vec<f64>>);

/// The tiles of each region, of which `first` is the first equal one; equal ones share theirs. `steady` are the
/// patterns of the regions. `Err(pivot)` if the matrix is not positive definite.
pub(super) fn shared_tiles(
    tree: &CoarseTree,
    steady: &[Arc<Supernodes>],
    entries: Entries<'_>,
    first: &[usize],
) -> Result<Vec<Arc<Tiles>>, usize> {
    // nodes of a region stand in the order of those of the equal one
    let mut node = vec![0; tree.nodes.len()];
    let mut heights = vec![0_usize; tree.regions.len()];
    for (r, region) in tree.regions.iter().enumerate() {
        let start = tree.regions[first[r]].first_node;
        for k in region.first_node..region.changing.end {
            node[k] = if first[r] == r && k >= region.steady.start {
                k
            } else {
                node[start + k - region.first_node]
            };
        }
        let children = region.children.into_iter().flatten();
        heights[r] = children.map(|c| heights[c] + 1).max().unwrap_or(0);
    }
    let own = |r: usize| tree.regions[r].steady.start..tree.regions[r].changing.end;
    let children = |r: usize| own(r).flat_map(|k| &tree.nodes[k].children).map(|&c| node[c]);
    let mut uses = vec![0_usize; tree.nodes.len()];
    let grown: Vec<usize> = (0..tree.regions.len()).filter(|&r| first[r] == r).collect();
    grown.iter().flat_map(|&r| children(r)).for_each(|c| uses[c] += 1);
    let mut updates: Vec<Vec<f64>> = vec![Vec::new(); tree.nodes.len()];
    let mut tiles: Vec<Arc<Tiles>> = vec![Arc::default(); tree.regions.len()];
    for height in 0..=heights.iter().copied().max().unwrap_or(0) {
        let now = || grown.iter().copied().filter(|&r| heights[r] == height);
        let load = |k: usize, columns: &mut [f64]| load_columns(entries, tree, k, columns);
        let grow = |r: usize| grow(tree, r, &steady[r], &node, &updates, &load);
        let all: Vec<Grown> = now()
            .collect::<Vec<_>>()
            .into_par_iter()
            .map(grow)
            .collect::<Result<_, _>>()?;
        for (r, (own_tiles, own_updates)) in now().zip(all) {
            tiles[r] = Arc::new(own_tiles);
            own(r).zip(own_updates).for_each(|(k, update)| updates[k] = update);
            for c in children(r) {
                uses[c] -= 1;
                if uses[c] == 0 {
                    updates[c] = Vec::new();
                }
            }
        }
    }
    Ok(first.iter().map(|&r| tiles[r].clone()).collect())
}

/// Eliminates the own nodes of a region; `node` tells whose update stands for that of a node.
fn grow(
    tree: &CoarseTree,
    r: usize,
    pattern: &Supernodes,
    node: &[usize],
    before: &[Vec<f64>],
    load: &(dyn Fn(usize, &mut [f64]) + Sync),
) -> Result<Grown, usize> {
    let own = tree.regions[r].steady.start..tree.regions[r].changing.end;
    let (mut tiles, mut updates) = (Tiles::default(), Vec::<Vec<f64>>::with_capacity(own.len()));
    tiles.exact.reserve_exact(pattern.tiles());
    let (mut columns, mut spare) = (Vec::new(), Vec::<Vec<f64>>::new());
    for k in own.clone() {
        let this = &tree.nodes[k];
        let (width, height) = (this.width(), this.height());
        let mut front = Front {
            columns: zeros(columns, width * height),
            update: zeros(spare.pop().unwrap_or_default(), (height - width) * (height - width)),
        };
        load(k, &mut front.columns);
        for &child in &this.children {
            let Some(inner) = child.checked_sub(own.start) else {
                extend(&before[node[child]], &tree.nodes[child].into, &mut front, width, height);
                continue;
            };
            let update = std::mem::take(&mut updates[inner]);
            extend(&update, &tree.nodes[child].into, &mut front, width, height);
            spare.push(update);
        }
        front.eliminate(this, 0.0)?;
        pattern.pack(k - own.start, &front.columns, &mut tiles.exact);
        updates.push(front.update);
        columns = front.columns;
    }
    updates.iter_mut().for_each(Vec::shrink_to_fit);
    tiles.round();
    Ok((tiles, updates))
}

/// Appends what tells the entries of two blocks from those of others.
pub(crate) type EntryBits<'a> = dyn Fn(u32, u32, &mut Vec<u64>) + 'a;

/// The bits of a matrix.
pub(super) fn bits(entries: Entries<'_>) -> impl Fn(u32, u32, &mut Vec<u64>) {
    move |a, b, key| {
        let (start, stride) = entries.matrix.place(a.max(b), a.min(b));
        for c in 0..6 {
            key.extend(entries.values[start + c * stride..][..6].iter().map(|v| v.to_bits()));
        }
    }
}

/// For each region the first one that is equal; one in which something changes equals itself only. The others' lists of
/// later blocks take its order.
pub(crate) fn share(tree: &mut CoarseTree, graph: &[Vec<u32>], write: &EntryBits<'_>) -> Vec<usize> {
    let mut known: HashMap<Vec<u64>, usize> = HashMap::new();
    let mut first: Vec<usize> = Vec::with_capacity(tree.regions.len());
    let mut ranks: Vec<Vec<u32>> = Vec::with_capacity(tree.regions.len());
    let mut place = vec![0; tree.blocks.len()];
    for r in 0..tree.regions.len() {
        let region = &tree.regions[r];
        // places that do not depend on the order of elimination: later blocks by their numbers
        let own = region.own.clone();
        let mut at: Vec<u32> = region.behind.clone();
        at.sort_unstable_by_key(|&p| tree.blocks[p as usize]);
        let all = || (own.start as u32..own.end as u32).chain(at.iter().copied());
        (0..).zip(all()).for_each(|(k, p)| place[p as usize] = k);
        let equal = if tree.region_changes(r) {
            r
        } else {
            let key = key(tree, region, &first, &place, graph, write);
            *known.entry(key).or_insert(r)
        };
        let rank = |p: &u32| place[*p as usize];
        ranks.push(region.behind.iter().map(rank).collect());
        if equal != r {
            let all: Vec<u32> = all().collect();
            let behind = ranks[equal].iter().map(|&k| all[k as usize]).collect();
            ranks[r] = ranks[equal].clone();
            follow(tree, r, equal, &ranks[equal], &all);
            tree.regions[r].behind = behind;
        }
        first.push(equal);
    }
    for (r, &equal) in first.iter().enumerate() {
        if equal == r { tree.place_children(r) } else { tree.copy_children(r, equal) }
    }
    first
}

/// Gives the borders of the own nodes of a region the order of an equal one; `all` are the positions of its places,
/// `ranks` the places of what is behind the equal one.
fn follow(tree: &mut CoarseTree, r: usize, equal: usize, ranks: &[u32], all: &[u32]) {
    let other = &tree.regions[equal];
    let nodes = other.steady.start..other.changing.end;
    let count = other.own.len() as u32;
    let place = |p: &u32| match other.local(*p) {
        k if k < count => k,
        k => ranks[(k - count) as usize],
    };
    let borders = tree.nodes[nodes].iter().map(|n| n.border.iter().map(place));
    let borders: Vec<Vec<u32>> = borders.map(|b| b.map(|k| all[k as usize]).collect()).collect();
    let start = tree.regions[r].steady.start;
    for (node, border) in tree.nodes[start..].iter_mut().zip(borders) {
        node.border = border;
    }
}

/// All that makes a region what it is: the regions within, the own columns and their borders, and the entries.
fn key(
    tree: &CoarseTree,
    region: &TreeRegion,
    first: &[usize],
    place: &[u32],
    graph: &[Vec<u32>],
    write: &EntryBits<'_>,
) -> Vec<u64> {
    let at = |p: &u32| u64::from(place[*p as usize]);
    let mut key = vec![region.behind.len() as u64];
    for child in region.children.into_iter().flatten() {
        let behind = &tree.regions[child].behind;
        key.extend([first[child] as u64, behind.len() as u64]);
        key.extend(behind.iter().map(at));
    }
    for node in &tree.nodes[region.steady.start..region.changing.end] {
        key.extend([node.columns.len() as u64, node.border.len() as u64]);
        let start = key.len();
        key.extend(node.border.iter().map(at));
        key[start..].sort_unstable();
    }
    for q in region.own.clone() {
        let a = tree.blocks[q];
        for &b in graph[a as usize].iter().chain([&a]) {
            let p = tree.place[b as usize];
            if (p as usize) < q {
                continue;
            }
            key.extend([at(&p), u64::from(a <= b)]);
            write(a, b, &mut key);
        }
    }
    key
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::projector::split::order::{grid_of, tests::grid};

    /// In a grid whose blocks are told by where they stand to each other, regions are equal if and only if their own
    /// blocks and those behind them form the same shape.
    #[test]
    fn regions_of_one_shape_are_equal() {
        let (graph, centres) = grid([40, 8, 9]);
        let layers = grid_of(&centres);
        let mut tree = CoarseTree::new(&graph, &centres, &vec![false; graph.len()], 0, layers.as_deref()).unwrap();
        let offset = |a: u32, b: u32| [0, 1, 2].map(|c| (centres[b as usize][c] - centres[a as usize][c]) as i64);
        let shape = |tree: &CoarseTree, r: usize| {
            let region = &tree.regions[r];
            let first = *tree.blocks[region.start..region.own.end].iter().min().unwrap();
            let list = |blocks: &mut dyn Iterator<Item = u32>| {
                let mut all: Vec<[i64; 3]> = blocks.map(|b| offset(first, b)).collect();
                all.sort_unstable();
                all
            };
            let own = tree.blocks[region.own.clone()].iter().copied();
            let within = tree.blocks[region.start..region.own.start].iter().copied();
            let behind = region.behind.iter().map(|&p| tree.blocks[p as usize]);
            [list(&mut { own }), list(&mut { within }), list(&mut { behind })]
        };
        let shapes: Vec<_> = (0..tree.regions.len()).map(|r| shape(&tree, r)).collect();
        let write = |a: u32, b: u32, key: &mut Vec<u64>| key.extend(offset(a, b).map(|v| v as u64));
        let first = share(&mut tree, &graph, &write);
        for (r, &equal) in first.iter().enumerate() {
            let same = shapes.iter().position(|other| *other == shapes[r]);
            assert_eq!(same, Some(equal), "region {r}");
        }
        let distinct = (0..first.len()).filter(|&r| first[r] == r).count();
        assert!(3 * distinct < 2 * first.len(), "{distinct} of {}", first.len());
    }
}
