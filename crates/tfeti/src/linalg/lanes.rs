//! Triangular solves with groups of columns for several right sides at once.
//!
//! The right sides stand next to one another, as many as fill a register or are told to be zero. Each number of the
//! factor is read once for all of them, so that the time is that of the arithmetic.

use crate::linalg::tiles::{LANES, Stored, Unknown};
use pulp::Simd;

/// One unknown of each right side.
pub(crate) type Lanes = [f64; LANES];

impl Unknown for Lanes {
    const ZERO: Self = [0.0; LANES];

    #[inline(always)]
    fn add(&mut self, other: &Self) {
        (0..LANES).for_each(|l| self[l] += other[l]);
    }

    #[inline(always)]
    fn eliminate<S: Simd, T: Stored, const N: usize, const V: usize, const U: usize>(
        simd: S,
        (tiles, t): (&[T], &mut [Lanes]),
    ) {
        let z: [[S::f64s; V]; N] = std::array::from_fn(|k| {
            let (z, _) = S::as_simd_f64s(&t[k]);
            std::array::from_fn(|v| z[v])
        });
        t[..N].fill([0.0; LANES]);
        for (chunk, rows) in tiles.chunks_exact(N).zip(t.chunks_exact_mut(LANES)) {
            let numbers: [Lanes; N] = std::array::from_fn(|k| chunk[k].numbers());
            for (r, row) in rows.iter_mut().enumerate() {
                let (row, _) = S::as_mut_simd_f64s(row);
                let mut sum: [S::f64s; V] = std::array::from_fn(|v| row[v]);
                for k in 0..N {
                    let number = simd.splat_f64s(numbers[k][r]);
                    for v in 0..V {
                        sum[v] = simd.mul_add_e_f64s(number, z[k][v], sum[v]);
                    }
                }
                row.copy_from_slice(&sum);
            }
        }
    }

    #[inline(always)]
    fn substitute<S: Simd, T: Stored, const N: usize, const V: usize, const U: usize>(
        simd: S,
        (tiles, t): (&[T], &mut [Lanes]),
    ) {
        let mut sums: [[S::f64s; V]; N] = std::array::from_fn(|k| {
            let (own, _) = S::as_simd_f64s(&t[k]);
            std::array::from_fn(|v| own[v])
        });
        t[..N].fill([0.0; LANES]);
        for (chunk, rows) in tiles.chunks_exact(N).zip(t.chunks_exact(LANES)) {
            let numbers: [Lanes; N] = std::array::from_fn(|k| chunk[k].numbers());
            for (r, row) in rows.iter().enumerate() {
                let (row, _) = S::as_simd_f64s(row);
                for k in 0..N {
                    let number = simd.splat_f64s(numbers[k][r]);
                    for v in 0..V {
                        sums[k][v] = simd.mul_add_e_f64s(number, row[v], sums[k][v]);
                    }
                }
            }
        }
        for (t, sum) in t.iter_mut().zip(&sums) {
            S::as_mut_simd_f64s(t).0.copy_from_slice(sum);
        }
    }
}
