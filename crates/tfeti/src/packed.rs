//! A sparse factor stored for solves with one right-hand side.

use crate::sparse::{MemoryNeed, SparseCholesky};
use crate::supernodes::{Supernodes, Tile};

/// A factor `P A P^T = L L^T` in tiles.
#[derive(Debug, Clone)]
pub(crate) struct PackedFactor {
    /// Old number of each unknown.
    order: Vec<u32>,
    groups: Supernodes,
    tiles: Vec<Tile>,
}

impl PackedFactor {
    /// Copies a factor, whose unknowns come in nodes of three if possible.
    pub(crate) fn new(factor: &SparseCholesky) -> Self {
        let mut aligned = true;
        factor.for_supernodes(&mut |columns, below, _| {
            let three = |k: usize| k.is_multiple_of(3);
            let whole = |t: &[usize]| three(t[0]) && t[t.len() - 1] == t[0] + 2;
            aligned &= three(columns.start) && three(columns.len());
            aligned &= three(below.len()) && below.chunks(3).all(whole);
        });
        let unit = if aligned { 3 } else { 1 };
        let mut groups = Supernodes::new(unit);
        factor.for_supernodes(&mut |columns, below, _| {
            let units = below.iter().step_by(unit).map(|&row| (row / unit) as u32);
            groups.push(columns, units);
        });
        let mut tiles = Vec::with_capacity(groups.tiles());
        let (mut columns_of, mut k) = (Vec::new(), 0);
        factor.for_supernodes(&mut |columns, below, value| {
            let height = columns.len() + below.len();
            columns_of.clear();
            for j in 0..columns.len() {
                columns_of.extend((0..height).map(|i| if i < j { 0.0 } else { value(i, j) }));
            }
            groups.pack(k, &columns_of, &mut tiles);
            k += 1;
        });
        Self {
            order: factor.order(),
            groups,
            tiles,
        }
    }

    pub(crate) fn need(&self) -> MemoryNeed {
        MemoryNeed::numbers(self.order.len() + self.groups.buffer())
    }

    /// Numbers stored.
    pub(crate) fn stored(&self) -> usize {
        Tile::NUMBERS * self.tiles.len()
    }

    /// Solves `A X = B` in place, column by column; `memory` as [`PackedFactor::need`] says.
    pub(crate) fn solve(&self, rhs: &mut [f64], memory: &mut [f64]) {
        let dim = self.order.len();
        if dim == 0 {
            return;
        }
        let (x, buffer) = memory.split_at_mut(dim);
        for column in rhs.chunks_exact_mut(dim) {
            for (x, &old) in x.iter_mut().zip(&self.order) {
                *x = column[old as usize];
            }
            self.groups.forward(&self.tiles, x, &mut [], buffer);
            self.groups.backward(&self.tiles, x, &[], buffer);
            for (&x, &old) in x.iter().zip(&self.order) {
                column[old as usize] = x;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sparse::{Columns, Symbolic};

    /// A chain of nodes of `block` unknowns, fully coupled with their neighbours.
    fn chain(nodes: usize, block: usize) -> Columns {
        let dim = nodes * block;
        let mut matrix = Columns {
            dim,
            pointers: vec![0],
            rows: vec![],
            values: vec![],
        };
        for j in 0..dim {
            let node = j / block;
            for i in node.saturating_sub(1) * block..((node + 2) * block).min(dim) {
                let value = if i == j { 20.0 } else { ((i + j) as f64).cos() };
                matrix.rows.push(i);
                matrix.values.push(value);
            }
            matrix.pointers.push(matrix.rows.len());
        }
        matrix
    }

    #[test]
    fn packed_solves_are_those_of_the_factor() {
        for (nodes, block) in [(30, 3), (40, 1), (1, 1), (7, 5)] {
            let matrix = chain(nodes, block);
            let factor =
                SparseCholesky::new(&Symbolic::new(&matrix, block).unwrap(), &matrix).unwrap();
            let packed = PackedFactor::new(&factor);
            let mut x: Vec<f64> = (0..2 * matrix.dim).map(|i| (i as f64).sin()).collect();
            let mut y = x.clone();
            factor.solve(&mut x, 2, &mut factor.memory(2));
            let mut memory = vec![f64::NAN; matrix.dim + packed.groups.buffer()];
            packed.solve(&mut y, &mut memory);
            for (x, y) in x.iter().zip(&y) {
                assert!((x - y).abs() < 1e-14, "{x} {y}");
            }
        }
    }
}
