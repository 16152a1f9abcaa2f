//! Products with a matrix of 6x6 blocks, of which those with the same numbers are stored once.

use crate::coarse::matrix::CoarseMatrix;
use crate::linalg::tiles::LANES;
use crate::subdomain::kernel::{Block, transposed};
use crate::tolerances::BLOCKS;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;
use std::collections::HashMap;
use std::ops::Range;

/// Numbers of a block: six columns, each as long as a register.
pub(crate) const BLOCK: usize = 6 * LANES;

/// Where the blocks of a matrix stand: by rows, in a list of numbers.
#[derive(Debug, Default)]
pub(crate) struct BlockTable {
    pointers: Vec<u32>,
    columns: Vec<u32>,
    /// Number of the block in the list.
    places: Vec<u32>,
}

/// Of a symmetric matrix with these values, and its numbers.
pub(crate) fn table_of(matrix: &CoarseMatrix, count: usize, values: &[f64]) -> (BlockTable, Vec<f64>) {
    let mut known: HashMap<[[u64; 6]; 6], u32> = HashMap::new();
    let mut numbers = Vec::new();
    let mut rows: Vec<Vec<(u32, u32)>> = vec![Vec::new(); count];
    let mut enter = |i: u32, j: u32, block: &Block| {
        let next = known.len() as u32;
        let place = *known.entry(block.map(|row| row.map(f64::to_bits))).or_insert_with(|| {
            for c in 0..6 {
                numbers.extend((0..6).map(|r| block[r][c]).chain([0.0; LANES - 6]));
            }
            next
        });
        rows[i as usize].push((j, place));
    };
    matrix.for_blocks(values, |i, j, block| {
        enter(i, j, block);
        if i != j {
            enter(j, i, &transposed(block));
        }
    });
    (BlockTable::new(rows.iter().map(|row| row.iter().copied())), numbers)
}

impl BlockTable {
    /// From the column and the place of each block of each row.
    pub(crate) fn new<R: IntoIterator<Item = (u32, u32)>>(rows: impl Iterator<Item = R>) -> Self {
        let mut out = Self {
            pointers: vec![0],
            ..Self::default()
        };
        for row in rows {
            for (column, place) in row {
                out.columns.push(column);
                out.places.push(place);
            }
            out.pointers.push(out.columns.len() as u32);
        }
        out
    }

    /// Blocks of all rows.
    pub(crate) fn blocks(&self) -> usize {
        self.columns.len()
    }

    /// Columns of the blocks of some rows.
    pub(crate) fn columns(&self, rows: Range<usize>) -> &[u32] {
        &self.columns[self.pointers[rows.start] as usize..self.pointers[rows.end] as usize]
    }

    /// `y = y - A x` on some rows of blocks.
    pub(crate) fn subtract(&self, numbers: &[f64], rows: Range<usize>, x: &[f64], y: &mut [f64]) {
        let size = (BLOCKS * rows.len() / self.columns(rows.clone()).len().max(1)).max(1);
        let chunks = y[6 * rows.start..6 * rows.end].par_chunks_mut(6 * size).enumerate();
        chunks.for_each(|(k, y)| {
            let pointers = &self.pointers[rows.start + k * size..][..=y.len() / 6];
            Arch::new().dispatch(Subtract {
                table: self,
                pointers,
                numbers,
                x,
                y,
            });
        });
    }
}

struct Subtract<'a> {
    table: &'a BlockTable,
    pointers: &'a [u32],
    numbers: &'a [f64],
    x: &'a [f64],
    y: &'a mut [f64],
}

impl WithSimd for Subtract<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let (blocks, _) = self.numbers.as_chunks::<BLOCK>();
        let (x, _) = self.x.as_chunks::<6>();
        for (pair, y) in self.pointers.windows(2).zip(self.y.as_chunks_mut::<6>().0) {
            let range = pair[0] as usize..pair[1] as usize;
            let mut sum = [0.0; LANES];
            for (&column, &place) in self.table.columns[range.clone()].iter().zip(&self.table.places[range]) {
                let block = blocks[place as usize].as_chunks::<LANES>().0;
                let x = &x[column as usize];
                for c in 0..6 {
                    for r in 0..LANES {
                        sum[r] += block[c][r] * x[c];
                    }
                }
            }
            for r in 0..6 {
                y[r] -= sum[r];
            }
        }
    }
}
