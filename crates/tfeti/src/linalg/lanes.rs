//! Triangular solves with groups of columns for several right sides at once.
//!
//! The right sides stand next to one another, as many as fill a register or are told to be zero. Each number of the
//! factor is read once for all of them, so that the time is that of the arithmetic.

use crate::linalg::supernodes::Supernodes;
use crate::linalg::tiles::{LANES, PANEL, Stored, panel};
use pulp::{Arch, Simd, WithSimd};

/// One unknown of each right side.
pub(crate) type Lanes = [f64; LANES];

impl Supernodes {
    /// [`forward`](Self::forward) or [`backward`](Self::backward) for all right sides.
    pub(crate) fn solve_lanes<T: Stored>(
        &self,
        tiles: &[T],
        x: &mut [Lanes],
        behind: &mut [Lanes],
        buffer: &mut [Lanes],
        forward: bool,
    ) {
        Arch::new().dispatch(SolveLanes {
            factor: self,
            tiles,
            x,
            behind,
            buffer,
            forward,
        });
    }
}

struct SolveLanes<'a, T> {
    factor: &'a Supernodes,
    tiles: &'a [T],
    x: &'a mut [Lanes],
    behind: &'a mut [Lanes],
    buffer: &'a mut [Lanes],
    forward: bool,
}

impl<T: Stored> WithSimd for SolveLanes<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        match self.forward {
            true => self.forward(simd),
            false => self.backward(simd),
        }
    }
}

impl<T: Stored> SolveLanes<'_, T> {
    #[inline(always)]
    fn forward<S: Simd>(self, simd: S) {
        let (factor, x) = (self.factor, self.x);
        let unit = factor.unit;
        for node in &factor.nodes {
            let rows = &factor.rows[node.rows.clone()];
            let (width, height) = (node.columns.len(), node.columns.len() + unit * rows.len());
            let t = &mut self.buffer[..height + LANES];
            t[..width].copy_from_slice(&x[node.columns.clone()]);
            t[width..].fill([0.0; LANES]);
            let mut tiles = &self.tiles[node.tiles.clone()];
            for start in (0..width).step_by(PANEL) {
                let count = PANEL.min(width - start);
                let (own, rest) = tiles.split_at(count * (height - start).div_ceil(LANES));
                tiles = rest;
                let t = &mut t[start..];
                panel!(eliminate, simd, count, PANEL, (own, t));
            }
            x[node.columns.clone()].copy_from_slice(&t[..width]);
            for (&row, sum) in rows.iter().zip(t[width..].chunks_exact(unit)) {
                let first = unit * row as usize;
                let target = match first.checked_sub(x.len()) {
                    None => &mut x[first..][..unit],
                    Some(first) => &mut self.behind[first..][..unit],
                };
                for (target, sum) in target.iter_mut().zip(sum) {
                    (0..LANES).for_each(|l| target[l] += sum[l]);
                }
            }
        }
    }

    #[inline(always)]
    fn backward<S: Simd>(self, simd: S) {
        let (factor, x) = (self.factor, self.x);
        let unit = factor.unit;
        for node in factor.nodes.iter().rev() {
            let rows = &factor.rows[node.rows.clone()];
            let (width, height) = (node.columns.len(), node.columns.len() + unit * rows.len());
            let t = &mut self.buffer[..height + LANES];
            t[..width].copy_from_slice(&x[node.columns.clone()]);
            for (&row, target) in rows.iter().zip(t[width..].chunks_exact_mut(unit)) {
                let first = unit * row as usize;
                target.copy_from_slice(match first.checked_sub(x.len()) {
                    None => &x[first..][..unit],
                    Some(first) => &self.behind[first..][..unit],
                });
            }
            t[height..].fill([0.0; LANES]);
            let mut tiles = &self.tiles[node.tiles.clone()];
            let mut end = width;
            while end > 0 {
                let count = if end.is_multiple_of(PANEL) { PANEL } else { end % PANEL };
                let start = end - count;
                let length = count * (height - start).div_ceil(LANES);
                let (rest, own) = tiles.split_at(tiles.len() - length);
                (tiles, end) = (rest, start);
                let t = &mut t[start..];
                panel!(substitute, simd, count, PANEL, (own, t));
            }
            x[node.columns.clone()].copy_from_slice(&t[..width]);
        }
    }
}

/// Forward elimination of one panel; `t` holds its unknowns and the rows below.
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

/// Back substitution of one panel; `t` holds its unknowns and those of the rows below.
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
