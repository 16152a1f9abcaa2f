//! One front: its beginning from the matrix, and what earlier fronts add to it.

use crate::coarse::matrix::Entries;
use crate::linalg::dense;
use crate::projector::split::tree::{CoarseTree, Node};

/// Columns of a node, and what is subtracted from the later unknowns of its border: lower triangles.
#[derive(Debug, Clone, Default)]
pub(crate) struct Front {
    pub(crate) columns: Vec<f64>,
    pub(crate) update: Vec<f64>,
}

impl Front {
    /// Factors the columns of a `node` and takes what that does to later unknowns from the update. `Err(pivot)` if a
    /// pivot is not larger than `threshold`.
    pub(crate) fn eliminate(&mut self, node: &Node, threshold: f64) -> Result<(), usize> {
        let (width, height) = (node.width(), node.height());
        dense::cholesky_columns(&mut self.columns, height, width, threshold)
            .map_err(|pivot| 6 * node.columns.start + pivot)?;
        dense::subtract_columns(&mut self.update, &self.columns, height, width);
        Ok(())
    }
}

/// Adds the entries of the columns of node `k` of a tree of the graph.
pub(crate) fn load_columns(entries: Entries<'_>, tree: &CoarseTree, k: usize, columns: &mut [f64]) {
    let Entries { matrix, graph, values } = entries;
    let node = &tree.nodes[k];
    for q in node.columns.clone() {
        let a = tree.blocks[q];
        for &b in graph[a as usize].iter().chain([&a]) {
            let p = tree.place[b as usize];
            if (p as usize) < q {
                continue;
            }
            let target = &mut columns[node.place(p, q as u32)..];
            let (start, stride) = matrix.place(a.max(b), a.min(b));
            for c in 0..6 {
                for r in 0..6 {
                    let (row, column) = if a <= b { (r, c) } else { (c, r) };
                    target[c * node.height() + r] += values[start + column * stride + row];
                }
            }
        }
    }
}

/// Adds the update of a child, whose border blocks stand at the places `into`, to a front.
pub(crate) fn extend(update: &[f64], into: &[u32], front: &mut Front, width: usize, height: usize) {
    let (size, behind) = (6 * into.len(), height - width);
    for (j, &column) in into.iter().enumerate() {
        for c in 0..6 {
            let source = &update[(6 * j + c) * size..][..size];
            let start = 6 * column as usize + c;
            let mut i = j;
            while i < into.len() {
                let first = i;
                i += 1;
                while i < into.len() && into[i] == into[i - 1] + 1 {
                    i += 1;
                }
                if into[first] < column {
                    add_above(&source[6 * first..6 * i], into[first], start, front, width, height);
                    continue;
                }
                let row = 6 * into[first] as usize;
                let target = match start < width {
                    true => &mut front.columns[start * height + row..],
                    false => &mut front.update[(start - width) * behind + row - width..],
                };
                for (t, s) in target.iter_mut().zip(&source[6 * first..6 * i]) {
                    *t += s;
                }
            }
        }
    }
}

/// Adds entries of one column whose rows, from block `first` on, stand before it: to these as columns.
fn add_above(source: &[f64], first: u32, row: usize, front: &mut Front, width: usize, height: usize) {
    let behind = height - width;
    for (column, s) in (6 * first as usize..).zip(source) {
        match column < width {
            true => front.columns[column * height + row] += s,
            false => front.update[(column - width) * behind + row - width] += s,
        }
    }
}
