//! Products of a sparse symmetric matrix of 3x3 blocks with panels of members.

use crate::linalg::sparse::Columns;
use pulp::{Arch, Simd, WithSimd};

/// A sparse symmetric matrix by rows of 3x3 blocks.
///
/// Products multiply one block with the members of a panel at a time, which stand next to one another, with the vector
/// instructions that the processor has. The operations and their order do not depend on these instructions.
#[derive(Debug)]
pub(crate) struct BlockRows {
    pointers: Vec<u32>,
    columns: Vec<u32>,
    /// By columns.
    blocks: Vec<[f64; 9]>,
}

impl BlockRows {
    /// Blocks of a symmetric matrix of which both triangles are stored and whose dimension is a multiple of three.
    pub(crate) fn new(matrix: &Columns) -> Self {
        debug_assert!(matrix.dim.is_multiple_of(3));
        let mut out = Self {
            pointers: vec![0],
            columns: Vec::new(),
            blocks: Vec::new(),
        };
        let mut place = vec![usize::MAX; matrix.dim / 3];
        for node in 0..matrix.dim / 3 {
            let first = out.columns.len();
            for r in 0..3 {
                // Symmetric: column 3 node + r is row 3 node + r.
                let (rows, values) = matrix.column(3 * node + r);
                for (&j, &value) in rows.iter().zip(values) {
                    let at = &mut place[j / 3];
                    if *at == usize::MAX {
                        *at = out.columns.len();
                        out.columns.push((j / 3) as u32);
                        out.blocks.push([0.0; 9]);
                    }
                    out.blocks[*at][3 * (j % 3) + r] = value;
                }
            }
            out.columns[first..]
                .iter()
                .for_each(|&c| place[c as usize] = usize::MAX);
            out.pointers.push(out.columns.len() as u32);
        }
        out
    }

    /// Unknowns.
    pub(crate) fn dim(&self) -> usize {
        3 * (self.pointers.len() - 1)
    }

    pub(crate) fn scale(&mut self, factor: f64) {
        self.blocks.iter_mut().flatten().for_each(|v| *v *= factor);
    }

    /// `y = A x` for all members of a panel.
    pub(crate) fn apply(&self, x: &[f64], y: &mut [f64], members: usize) {
        Arch::new().dispatch(Product {
            matrix: self,
            x,
            y,
            members,
        });
    }

    #[inline(always)]
    fn apply_panel(&self, x: &[f64], y: &mut [f64], members: usize) {
        // The last members are done together with some that are done already: they get the same numbers again.
        let mut first = 0;
        while first < members {
            let left = members - first;
            if left > 4 && members >= 8 {
                let at = first.min(members - 8);
                self.chunk::<8>(x, y, members, at);
                first = at + 8;
            } else if left > 1 && members >= 4 {
                let at = first.min(members - 4);
                self.chunk::<4>(x, y, members, at);
                first = at + 4;
            } else {
                self.chunk::<1>(x, y, members, first);
                first += 1;
            }
        }
    }

    /// The product for `N` members from `first` on.
    #[inline(always)]
    fn chunk<const N: usize>(&self, x: &[f64], y: &mut [f64], members: usize, first: usize) {
        for (row, target) in y.chunks_exact_mut(3 * members).enumerate() {
            let range = self.pointers[row] as usize..self.pointers[row + 1] as usize;
            let mut sums = [[0.0; N]; 3];
            for (&column, block) in self.columns[range.clone()].iter().zip(&self.blocks[range]) {
                let source = &x[3 * members * column as usize..][..3 * members];
                for c in 0..3 {
                    let Some(value) = source[c * members + first..].first_chunk::<N>() else {
                        return;
                    };
                    for r in 0..3 {
                        let factor = block[3 * c + r];
                        for m in 0..N {
                            sums[r][m] += factor * value[m];
                        }
                    }
                }
            }
            for (r, sum) in sums.iter().enumerate() {
                target[r * members + first..][..N].copy_from_slice(sum);
            }
        }
    }
}

/// A product as the dispatcher wants it: compiled anew for each set of vector instructions.
struct Product<'a> {
    matrix: &'a BlockRows,
    x: &'a [f64],
    y: &'a mut [f64],
    members: usize,
}

impl WithSimd for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.matrix.apply_panel(self.x, self.y, self.members);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_of_every_width_agree_with_the_matrix() {
        // A chain of five nodes with full blocks between neighbours.
        let dim = 15;
        let entry = |i: usize, j: usize| {
            let (a, b) = (i.min(j) as f64, i.max(j) as f64);
            1.0 / (1.0 + a + 0.3 * b * b)
        };
        let mut matrix = Columns::empty(dim);
        for j in 0..dim {
            for i in (0..dim).filter(|i| (i / 3).abs_diff(j / 3) <= 1) {
                matrix.rows.push(i);
                matrix.values.push(entry(i, j));
            }
            matrix.pointers.push(matrix.rows.len());
        }
        let blocks = BlockRows::new(&matrix);
        assert_eq!(blocks.dim(), dim);
        for members in 1..=26 {
            let x: Vec<f64> = (0..dim * members).map(|k| (k as f64).sin()).collect();
            let mut y = vec![f64::NAN; dim * members];
            blocks.apply(&x, &mut y, members);
            for i in 0..dim {
                for m in 0..members {
                    let (rows, values) = matrix.column(i);
                    let expected: f64 = rows.iter().zip(values).map(|(&j, v)| v * x[j * members + m]).sum();
                    assert!((y[i * members + m] - expected).abs() < 1e-13);
                }
            }
        }
    }
}
