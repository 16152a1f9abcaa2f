//! Triangular solves with groups of columns for several right sides at once.
//!
//! The right sides stand next to one another, as many as a tile has rows, or half of them; those that are missing are
//! told to be zero. Each number of the factor is read once for all of them, so that the time is that of the arithmetic.

use crate::linalg::tiles::{LANES, Stored, Unknown};
use pulp::Simd;

/// The registers that `W` right sides fill, of those for a tile.
#[inline(always)]
fn load<S: Simd, const W: usize, const V: usize>(simd: S, row: &[f64; W]) -> [S::f64s; V] {
    let (whole, rest) = S::as_simd_f64s(row);
    std::array::from_fn(|v| match whole.get(v) {
        Some(&register) => register,
        None if v == whole.len() && !rest.is_empty() => simd.partial_load_f64s(rest),
        None => simd.splat_f64s(0.0),
    })
}

#[inline(always)]
fn store<S: Simd, const W: usize>(simd: S, row: &mut [f64; W], registers: &[S::f64s]) {
    let (whole, rest) = S::as_mut_simd_f64s(row);
    whole.iter_mut().zip(registers).for_each(|(to, from)| *to = *from);
    if !rest.is_empty() {
        simd.partial_store_f64s(rest, registers[whole.len()]);
    }
}

/// One unknown of each right side.
impl<const W: usize> Unknown for [f64; W] {
    const ZERO: Self = [0.0; W];

    #[inline(always)]
    fn add(&mut self, other: &Self) {
        (0..W).for_each(|l| self[l] += other[l]);
    }

    #[inline(always)]
    fn eliminate<S: Simd, T: Stored, const N: usize, const V: usize, const U: usize>(
        simd: S,
        (tiles, t): (&[T], &mut [Self]),
    ) {
        let used = W.div_ceil(S::F64_LANES);
        let z: [[S::f64s; V]; N] = std::array::from_fn(|k| load(simd, &t[k]));
        t[..N].fill(Self::ZERO);
        for (chunk, rows) in tiles.chunks_exact(N).zip(t.chunks_exact_mut(LANES)) {
            let numbers: [[f64; LANES]; N] = std::array::from_fn(|k| chunk[k].numbers());
            for (r, row) in rows.iter_mut().enumerate() {
                let mut sum: [S::f64s; V] = load(simd, row);
                for k in 0..N {
                    let number = simd.splat_f64s(numbers[k][r]);
                    for v in 0..used {
                        sum[v] = simd.mul_add_e_f64s(number, z[k][v], sum[v]);
                    }
                }
                store(simd, row, &sum);
            }
        }
    }

    #[inline(always)]
    fn substitute<S: Simd, T: Stored, const N: usize, const V: usize, const U: usize>(
        simd: S,
        (tiles, t): (&[T], &mut [Self]),
    ) {
        let used = W.div_ceil(S::F64_LANES);
        let mut sums: [[S::f64s; V]; N] = std::array::from_fn(|k| load(simd, &t[k]));
        t[..N].fill(Self::ZERO);
        for (chunk, rows) in tiles.chunks_exact(N).zip(t.chunks_exact(LANES)) {
            let numbers: [[f64; LANES]; N] = std::array::from_fn(|k| chunk[k].numbers());
            for (r, row) in rows.iter().enumerate() {
                let row: [S::f64s; V] = load(simd, row);
                for k in 0..N {
                    let number = simd.splat_f64s(numbers[k][r]);
                    for v in 0..used {
                        sums[k][v] = simd.mul_add_e_f64s(number, row[v], sums[k][v]);
                    }
                }
            }
        }
        for (t, sum) in t.iter_mut().zip(&sums) {
            store(simd, t, sum);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::tiles::{HALF, PANEL, Tile, panel};
    use pulp::{Scalar, Scalar128b, Scalar256b, Scalar512b};

    fn run<S: Simd, X: Unknown>(simd: S, forward: bool, tiles: &[Tile], t: &mut [X]) {
        const UNIT: usize = 6;
        let (count, work) = (PANEL, (tiles, t));
        if forward {
            panel!(X::eliminate, simd, count, UNIT, work)
        } else {
            panel!(X::substitute, simd, count, UNIT, work)
        }
    }

    /// A panel on `W` right sides, in registers of any length, next to one right side at a time.
    fn check<S: Simd, const W: usize>(simd: S) {
        let tile = |k: usize| Tile(std::array::from_fn(|l| ((7 * k + l) as f64).sin()));
        let tiles: Vec<Tile> = (0..3 * PANEL).map(tile).collect();
        let row = |k: usize| std::array::from_fn(|l| ((k + 5 * l) as f64).cos());
        let start: Vec<[f64; W]> = (0..3 * LANES).map(row).collect();
        for forward in [true, false] {
            let mut all = start.clone();
            run(simd, forward, &tiles, &mut all);
            for l in 0..W {
                let mut one: Vec<f64> = start.iter().map(|row| row[l]).collect();
                run(simd, forward, &tiles, &mut one);
                for (row, one) in all.iter().zip(&one) {
                    assert!((row[l] - one).abs() < 1e-13, "right side {l} of {W}: {} {one}", row[l]);
                }
            }
        }
    }

    #[test]
    fn any_registers_solve_for_several_right_sides() {
        check::<_, LANES>(Scalar);
        check::<_, HALF>(Scalar);
        check::<_, HALF>(Scalar128b);
        check::<_, HALF>(Scalar256b);
        check::<_, LANES>(Scalar512b);
        check::<_, HALF>(Scalar512b);
    }
}
