//! One front: its beginning from the matrix, and what earlier fronts add to it.

use crate::coarse::matrix::Entries;
use crate::linalg::dense;
use crate::projector::split::tree::{CoarseTree, Node};
use crate::tolerances::{LARGE_FRONT, LARGE_UPDATE, PART};
use rayon::prelude::*;

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
        let of_matrix = |pivot| 6 * node.columns.start + pivot;
        if node.operations() >= LARGE_FRONT {
            let size = [height, width];
            return dense::eliminate_in_parts(&mut self.columns, &mut self.update, size, threshold).map_err(of_matrix);
        }
        dense::cholesky_columns(&mut self.columns, height, width, threshold).map_err(of_matrix)?;
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
    let behind = height - width;
    let child = Child {
        update,
        into,
        is_ascending: into.is_sorted(),
    };
    let parts = |own: &mut Vec<f64>, first: usize, rows: usize| {
        if update.len() < LARGE_UPDATE {
            return child.add_to(own, first, first, rows);
        }
        let parts = own.par_chunks_mut((PART * rows).max(1)).enumerate();
        parts.for_each(|(k, part)| child.add_to(part, first + k * PART, first, rows));
    };
    parts(&mut front.columns, 0, height);
    parts(&mut front.update, width, behind);
}

/// A child of a front, whose border need not stand in the order of the front's.
struct Child<'a> {
    update: &'a [f64],
    into: &'a [u32],
    is_ascending: bool,
}

impl Child<'_> {
    /// Adds to columns of a front with so many `rows`, both counted from their firsts on.
    fn add_to(&self, columns: &mut [f64], first_column: usize, first_row: usize, rows: usize) {
        let Self { update, into, .. } = *self;
        let here = first_column..first_column + columns.len().checked_div(rows).unwrap_or(0);
        let size = 6 * into.len();
        for (j, &column) in into.iter().enumerate() {
            let is_here = here.contains(&(6 * column as usize));
            if !is_here && self.is_ascending {
                continue;
            }
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
                    let source = &source[6 * first..6 * i];
                    let row = 6 * into[first] as usize;
                    if into[first] < column {
                        // rows that stand before the column: the other triangle
                        let targets = (row..).zip(source).filter(|(t, _)| here.contains(t));
                        targets.for_each(|(t, s)| columns[(t - first_column) * rows + start - first_row] += s);
                    } else if is_here {
                        let target = &mut columns[(start - first_column) * rows + row - first_row..];
                        target.iter_mut().zip(source).for_each(|(t, s)| *t += s);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The border of a child in any order: each entry of its lower triangle is added once, to the lower triangle of the
    /// front.
    #[test]
    fn parts_take_what_belongs_to_their_columns() {
        let (width, height) = (18, 48);
        for into in [[5, 0, 3, 4, 7], [0, 1, 3, 4, 7]] {
            let size = 6 * into.len();
            let update: Vec<f64> = (0..size * size).map(|k| (k as f64).sin()).collect();
            let mut expected = vec![0.0; height * height];
            let at = |i: usize| 6 * into[i / 6] as usize + i % 6;
            for j in 0..size {
                for i in j..size {
                    let (row, column) = (at(i).max(at(j)), at(i).min(at(j)));
                    expected[row + column * height] = update[i + j * size];
                }
            }
            let child = Child {
                update: &update,
                into: &into,
                is_ascending: into.is_sorted(),
            };
            let behind = height - width;
            let (mut columns, mut rest) = (vec![0.0; width * height], vec![0.0; behind * behind]);
            for (k, part) in columns.chunks_mut(6 * height).enumerate() {
                child.add_to(part, 6 * k, 0, height);
            }
            for (k, part) in rest.chunks_mut(12 * behind).enumerate() {
                child.add_to(part, width + 12 * k, width, behind);
            }
            let mut whole = Front {
                columns: vec![0.0; width * height],
                update: vec![0.0; behind * behind],
            };
            extend(&update, &into, &mut whole, width, height);
            for j in 0..height {
                for i in j..height {
                    let found = |columns: &[f64], rest: &[f64]| {
                        if j < width { columns[i + j * height] } else { rest[i - width + (j - width) * behind] }
                    };
                    let expected = expected[i + j * height];
                    assert_eq!(found(&columns, &rest), expected, "{into:?} {i} {j}");
                    assert_eq!(found(&whole.columns, &whole.update), expected, "{into:?} {i} {j}");
                }
            }
        }
    }
}
