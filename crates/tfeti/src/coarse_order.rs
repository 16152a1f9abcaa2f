//! Order of elimination of the coarse unknowns for [`SplitBase`](crate::split_factor::SplitBase).

use crate::sparse::{FactorError, minimum_degree};
use std::ops::Range;

/// Blocks in the order of elimination: parts that do not touch, the layer between them, and the blocks that come last.
#[derive(Debug)]
pub(crate) struct CoarseOrder {
    pub(crate) blocks: Vec<u32>,
    pub(crate) parts: Vec<Range<usize>>,
    /// Position of the first block of the layer.
    pub(crate) separator: usize,
    /// Position of the first of the last blocks.
    pub(crate) last: usize,
}

/// Fewest blocks worth a cut.
const CUT: usize = 100;

impl CoarseOrder {
    /// For the graph of the blocks (`lower` neighbours of each, itself included) at `centres`.
    pub(crate) fn new(
        lower: &[Vec<u32>],
        centres: &[[f64; 3]],
        is_last: &[bool],
    ) -> Result<Self, FactorError> {
        let mut graph: Vec<Vec<u32>> = vec![Vec::new(); lower.len()];
        for (a, list) in lower.iter().enumerate() {
            for &b in list.iter().filter(|&&b| b as usize != a) {
                graph[a].push(b);
                graph[b as usize].push(a as u32);
            }
        }
        let inner: Vec<u32> = (0..graph.len() as u32)
            .filter(|&b| !is_last[b as usize])
            .collect();
        let [left, middle, right] = cut(&graph, centres, &inner);
        let mut blocks = Vec::with_capacity(graph.len());
        let mut parts = Vec::new();
        for part in [&left, &right] {
            let start = blocks.len();
            blocks.extend(order_part(&graph, part)?);
            if blocks.len() > start {
                parts.push(start..blocks.len());
            }
        }
        let separator = blocks.len();
        blocks.extend(order_part(&graph, &middle)?);
        let last = blocks.len();
        blocks.extend((0..graph.len() as u32).filter(|&b| is_last[b as usize]));
        Ok(Self {
            blocks,
            parts,
            separator,
            last,
        })
    }
}

/// Two halves and the layer between them; everything in the first half if a cut is not worth it.
fn cut(graph: &[Vec<u32>], centres: &[[f64; 3]], inner: &[u32]) -> [Vec<u32>; 3] {
    let whole = || [inner.to_vec(), Vec::new(), Vec::new()];
    if inner.len() < CUT {
        return whole();
    }
    let along = |axis: usize| {
        let mut values: Vec<f64> = inner.iter().map(|&b| centres[b as usize][axis]).collect();
        values.sort_by(f64::total_cmp);
        values
    };
    let axes: Vec<Vec<f64>> = (0..3).map(along).collect();
    let extent = |v: &Vec<f64>| v[v.len() - 1] - v[0];
    let axis = (0..3).fold(0, |best, k| {
        if extent(&axes[k]) > 1.001 * extent(&axes[best]) {
            k
        } else {
            best
        }
    });
    let values = &axes[axis];
    let limit = values[values.len() / 2] - 1e-9 * extent(values);
    // 0: left, 1: layer, 2: right, 3: not inner.
    let mut side = vec![3; graph.len()];
    for &b in inner {
        side[b as usize] = if centres[b as usize][axis] < limit {
            0
        } else {
            2
        };
    }
    for &b in inner {
        let touches = |n: &u32| side[*n as usize] == 0;
        if side[b as usize] == 2 && graph[b as usize].iter().any(touches) {
            side[b as usize] = 1;
        }
    }
    let of = |k: i32| {
        let part = inner.iter().copied();
        part.filter(|&b| side[b as usize] == k)
            .collect::<Vec<u32>>()
    };
    let [left, middle, right] = [of(0), of(1), of(2)];
    if left.len().min(right.len()) * 4 < inner.len() {
        return whole();
    }
    [left, middle, right]
}

/// Order of a part: minimum degree among the part and the blocks around it, which come later and are then all coupled.
fn order_part(graph: &[Vec<u32>], part: &[u32]) -> Result<Vec<u32>, FactorError> {
    const OUTSIDE: u32 = u32::MAX;
    let mut place = vec![OUTSIDE; graph.len()];
    for (k, &b) in part.iter().enumerate() {
        place[b as usize] = k as u32;
    }
    let mut around: Vec<u32> = Vec::new();
    for &b in part {
        for &n in &graph[b as usize] {
            if place[n as usize] == OUTSIDE {
                place[n as usize] = (part.len() + around.len()) as u32;
                around.push(n);
            }
        }
    }
    let count = part.len() + around.len();
    let mut lists: Vec<Vec<usize>> = vec![Vec::new(); count];
    for (k, &b) in part.iter().enumerate() {
        lists[k].push(k);
        for &n in &graph[b as usize] {
            let n = place[n as usize] as usize;
            lists[k].push(n);
            if n >= part.len() {
                lists[n].push(k);
            }
        }
    }
    for k in part.len()..count {
        lists[k].extend(part.len()..count);
    }
    let (mut pointers, mut rows) = (vec![0], Vec::new());
    for mut list in lists {
        list.sort_unstable();
        rows.extend(list);
        pointers.push(rows.len());
    }
    let order = minimum_degree(&pointers, &rows)?;
    let inside = order.into_iter().filter(|&k| k < part.len());
    Ok(inside.map(|k| part[k]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_halves_of_a_bar_do_not_touch() {
        // 40 x 2 x 2 blocks, neighbours across faces; those at the bottom come last.
        let at = |i: usize, j: usize, k: usize| (i * 2 + j) * 2 + k;
        let (mut lower, mut centres) = (vec![Vec::new(); 160], vec![[0.0; 3]; 160]);
        for (i, j, k) in (0..160).map(|b| (b / 4, b / 2 % 2, b % 2)) {
            let own = &mut lower[at(i, j, k)];
            own.push(at(i, j, k) as u32);
            if i + 1 < 40 {
                own.push(at(i + 1, j, k) as u32);
            }
            if j == 0 {
                own.push(at(i, 1, k) as u32);
            }
            if k == 0 {
                own.push(at(i, j, 1) as u32);
            }
            centres[at(i, j, k)] = [i as f64, j as f64, k as f64];
        }
        let last: Vec<bool> = centres.iter().map(|c| c[2] == 0.0).collect();
        let small = CoarseOrder::new(&lower, &centres, &last).unwrap();
        assert_eq!((small.parts.len(), small.parts[0].len()), (1, 80));
        let none = vec![false; 160];
        for (order, count) in [
            (small, 80),
            (CoarseOrder::new(&lower, &centres, &none).unwrap(), 160),
        ] {
            assert_eq!(order.last, count);
            let mut sorted = order.blocks.clone();
            sorted.sort_unstable();
            assert!(sorted.into_iter().eq(0..160), "a permutation");
            if let [left, right] = &order.parts[..] {
                let x = |b: &u32| centres[*b as usize][0];
                let end = order.blocks[left.clone()].iter().map(x).fold(0.0, f64::max);
                let start = order.blocks[right.clone()]
                    .iter()
                    .map(x)
                    .fold(99.0, f64::min);
                assert!(end + 2.0 == start, "one layer between");
                assert_eq!(order.last - order.separator, 4);
            } else {
                assert_eq!(count, 80, "too small to cut");
            }
        }
    }
}
