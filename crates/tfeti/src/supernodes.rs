//! Triangular solves with groups of columns of one pattern.
//!
//! One right-hand side at a time, so the time is that of reading the factor once in each direction. The columns of a group
//! are stored in panels of up to [`PANEL`], each a run of tiles in the order in which both directions read it. The factor
//! is `L D L^T` with unit diagonal blocks: `D^-1` of each panel comes first, then the tiles of the rows below.

use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// Rows of a tile.
const LANES: usize = 8;
/// Columns of a panel: two nodes of three unknowns, or one block of six.
const PANEL: usize = 6;

/// Consecutive rows of one column.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct Tile([f64; LANES]);

impl Tile {
    const ZERO: Self = Self([0.0; LANES]);
    /// Numbers of a tile.
    pub(crate) const NUMBERS: usize = LANES;
}

/// Pattern of groups of columns. Rows are counted from the first of these columns on; rows beyond them (*behind*) belong
/// to others. Rows below a group come in units of `unit` consecutive ones.
#[derive(Debug, Clone)]
pub(crate) struct Supernodes {
    unit: usize,
    nodes: Vec<Supernode>,
    /// First rows of the units below the triangle of each group, over the unit.
    rows: Vec<u32>,
    tiles: usize,
    height: usize,
}

#[derive(Debug, Clone)]
struct Supernode {
    columns: Range<usize>,
    rows: Range<usize>,
    tiles: Range<usize>,
}

impl Supernodes {
    pub(crate) fn new(unit: usize) -> Self {
        Self {
            unit,
            nodes: Vec::new(),
            rows: Vec::new(),
            tiles: 0,
            height: 0,
        }
    }

    /// Appends a group with the given units of rows below it.
    pub(crate) fn push(&mut self, columns: Range<usize>, rows: impl IntoIterator<Item = u32>) {
        let first = self.rows.len();
        self.rows.extend(rows);
        let rows = first..self.rows.len();
        let (width, height) = (columns.len(), columns.len() + self.unit * rows.len());
        let panels = (0..width).step_by(PANEL);
        let count = panels.map(|c| {
            let panel = PANEL.min(width - c);
            panel * (1 + (height - c - panel).div_ceil(LANES))
        });
        let start = self.tiles;
        self.tiles += count.sum::<usize>();
        self.height = self.height.max(height);
        self.nodes.push(Supernode {
            columns,
            rows,
            tiles: start..self.tiles,
        });
    }

    /// Tiles of all groups.
    pub(crate) fn tiles(&self) -> usize {
        self.tiles
    }

    /// Length of the buffer of a solve.
    pub(crate) fn buffer(&self) -> usize {
        self.height + LANES
    }

    /// Appends the tiles of group `node`, whose Cholesky factor is given by columns: the triangle, then the rows below.
    pub(crate) fn pack(&self, node: usize, factor: &[f64], tiles: &mut Vec<Tile>) {
        let node = &self.nodes[node];
        let start = tiles.len();
        tiles.resize(start + node.tiles.len(), Tile::ZERO);
        Arch::new().dispatch(Pack {
            width: node.columns.len(),
            height: node.columns.len() + self.unit * node.rows.len(),
            factor,
            tiles: &mut tiles[start..],
        });
    }

    /// `x = D L^-1 x` for the columns' unknowns `x`; adds to `behind` what that does to the rows behind.
    pub(crate) fn forward(
        &self,
        tiles: &[Tile],
        x: &mut [f64],
        behind: &mut [f64],
        buffer: &mut [f64],
    ) {
        Arch::new().dispatch(Forward {
            factor: self,
            tiles,
            x,
            behind,
            buffer,
        });
    }

    /// `x = L^-T D^-1 x` for the columns' unknowns, given those `behind`.
    pub(crate) fn backward(
        &self,
        tiles: &[Tile],
        x: &mut [f64],
        behind: &[f64],
        buffer: &mut [f64],
    ) {
        Arch::new().dispatch(Backward {
            factor: self,
            tiles,
            x,
            behind,
            buffer,
        });
    }
}

/// The arguments of [`Supernodes::pack`], for the dispatcher to vector instructions.
struct Pack<'a> {
    width: usize,
    height: usize,
    factor: &'a [f64],
    tiles: &'a mut [Tile],
}

impl WithSimd for Pack<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let (width, height) = (self.width, self.height);
        let mut tiles = self.tiles;
        for first in (0..width).step_by(PANEL) {
            let columns = &self.factor[first * height..];
            let (count, length) = (PANEL.min(width - first), height - first);
            let below = length - count;
            let (own, rest) = tiles.split_at_mut(count * (1 + below.div_ceil(LANES)));
            tiles = rest;
            let at = |i: usize, j: usize| columns[j * height + first + i];
            // Inverse of the triangle.
            let mut inverse = [[0.0; PANEL]; PANEL];
            for j in 0..count {
                inverse[j][j] = 1.0 / at(j, j);
                for i in j + 1..count {
                    let sum: f64 = (j..i).map(|k| at(i, k) * inverse[j][k]).sum();
                    inverse[j][i] = -sum / at(i, i);
                }
            }
            for j in 0..count {
                for i in 0..count {
                    let sum = (i.max(j)..count).map(|k| inverse[i][k] * inverse[j][k]);
                    own[j].0[i] = sum.sum();
                }
            }
            for (k, chunk) in own[count..].chunks_exact_mut(count).enumerate() {
                let start = count + LANES * k;
                let rows = LANES.min(length - start);
                let mut read = [[0.0; LANES]; PANEL];
                for (j, read) in read.iter_mut().take(count).enumerate() {
                    let column = &columns[j * height + first + start..][..rows];
                    match <&[f64; LANES]>::try_from(column) {
                        Ok(column) => *read = *column,
                        Err(_) => read[..rows].copy_from_slice(column),
                    }
                }
                for (j, tile) in chunk.iter_mut().enumerate() {
                    let mut sum = [0.0; LANES];
                    for i in j..count {
                        for l in 0..LANES {
                            sum[l] += read[i][l] * inverse[j][i];
                        }
                    }
                    tile.0 = sum;
                }
            }
        }
    }
}

/// The arguments of [`Supernodes::forward`].
struct Forward<'a> {
    factor: &'a Supernodes,
    tiles: &'a [Tile],
    x: &'a mut [f64],
    behind: &'a mut [f64],
    buffer: &'a mut [f64],
}

impl WithSimd for Forward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        match self.factor.unit {
            6 => self.run::<6>(),
            3 => self.run::<3>(),
            _ => self.run::<1>(),
        }
    }
}

impl Forward<'_> {
    #[inline(always)]
    fn run<const U: usize>(self) {
        let (factor, x) = (self.factor, self.x);
        let first = x.len() / U;
        for node in &factor.nodes {
            let rows = &factor.rows[node.rows.clone()];
            let (width, height) = (node.columns.len(), node.columns.len() + U * rows.len());
            let t = &mut self.buffer[..height + LANES];
            t[..width].copy_from_slice(&x[node.columns.clone()]);
            t[width..].fill(0.0);
            let mut tiles = &self.tiles[node.tiles.clone()];
            for start in (0..width).step_by(PANEL) {
                let count = PANEL.min(width - start);
                let chunks = (height - start - count).div_ceil(LANES);
                let (own, rest) = tiles.split_at(count * (1 + chunks));
                tiles = rest;
                let t = &mut t[start..];
                match count {
                    1 => eliminate::<1>(own, t),
                    2 => eliminate::<2>(own, t),
                    3 => eliminate::<3>(own, t),
                    4 => eliminate::<4>(own, t),
                    5 => eliminate::<5>(own, t),
                    _ => eliminate::<PANEL>(own, t),
                }
            }
            x[node.columns.clone()].copy_from_slice(&t[..width]);
            for (&row, sum) in rows.iter().zip(t[width..].chunks_exact(U)) {
                let row = row as usize;
                let target = if row < first {
                    &mut x[U * row..][..U]
                } else {
                    &mut self.behind[U * (row - first)..][..U]
                };
                for k in 0..U {
                    target[k] += sum[k];
                }
            }
        }
    }
}

/// The arguments of [`Supernodes::backward`].
struct Backward<'a> {
    factor: &'a Supernodes,
    tiles: &'a [Tile],
    x: &'a mut [f64],
    behind: &'a [f64],
    buffer: &'a mut [f64],
}

impl WithSimd for Backward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        match self.factor.unit {
            6 => self.run::<6>(),
            3 => self.run::<3>(),
            _ => self.run::<1>(),
        }
    }
}

impl Backward<'_> {
    #[inline(always)]
    fn run<const U: usize>(self) {
        let (factor, x) = (self.factor, self.x);
        let first = x.len() / U;
        for node in factor.nodes.iter().rev() {
            let rows = &factor.rows[node.rows.clone()];
            let (width, height) = (node.columns.len(), node.columns.len() + U * rows.len());
            let t = &mut self.buffer[..height + LANES];
            t[..width].copy_from_slice(&x[node.columns.clone()]);
            for (&row, target) in rows.iter().zip(t[width..].chunks_exact_mut(U)) {
                let row = row as usize;
                let source = if row < first {
                    &x[U * row..][..U]
                } else {
                    &self.behind[U * (row - first)..][..U]
                };
                target[..U].copy_from_slice(source);
            }
            t[height..].fill(0.0);
            let mut tiles = &self.tiles[node.tiles.clone()];
            let mut end = width;
            while end > 0 {
                let count = if end.is_multiple_of(PANEL) {
                    PANEL
                } else {
                    end % PANEL
                };
                let start = end - count;
                let chunks = (height - end).div_ceil(LANES);
                let (rest, own) = tiles.split_at(tiles.len() - count * (1 + chunks));
                (tiles, end) = (rest, start);
                let t = &mut t[start..];
                match count {
                    1 => substitute::<1>(own, t),
                    2 => substitute::<2>(own, t),
                    3 => substitute::<3>(own, t),
                    4 => substitute::<4>(own, t),
                    5 => substitute::<5>(own, t),
                    _ => substitute::<PANEL>(own, t),
                }
            }
            x[node.columns.clone()].copy_from_slice(&t[..width]);
        }
    }
}

/// Forward elimination of one panel; `t` holds its unknowns and the rows below.
#[inline(always)]
fn eliminate<const N: usize>(tiles: &[Tile], t: &mut [f64]) {
    let (own, rest) = t.split_at_mut(N);
    let x: [f64; N] = std::array::from_fn(|k| own[k]);
    let chunks = tiles[N..].chunks_exact(N);
    for (chunk, t) in chunks.zip(rest.chunks_exact_mut(LANES)) {
        let mut sum = [0.0; LANES];
        for k in 0..N {
            for l in 0..LANES {
                sum[l] += chunk[k].0[l] * x[k];
            }
        }
        for l in 0..LANES {
            t[l] -= sum[l];
        }
    }
}

/// Back substitution of one panel; `t` holds its unknowns and those of the rows below.
#[inline(always)]
fn substitute<const N: usize>(tiles: &[Tile], t: &mut [f64]) {
    let (own, rest) = t.split_at_mut(N);
    let mut value = [0.0; LANES];
    for k in 0..N {
        for l in 0..LANES {
            value[l] += tiles[k].0[l] * own[k];
        }
    }
    let mut sums = [[0.0; LANES]; N];
    let chunks = tiles[N..].chunks_exact(N);
    for (chunk, t) in chunks.zip(rest.chunks_exact(LANES)) {
        for k in 0..N {
            for l in 0..LANES {
                sums[k][l] += chunk[k].0[l] * t[l];
            }
        }
    }
    for k in 0..N {
        let s = &sums[k];
        own[k] = value[k] - (((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7])));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A factor in two groups whose rows below lie within and behind.
    #[test]
    fn both_directions_solve_with_the_product_of_the_factor() {
        for unit in [1, 3, 6] {
            let (widths, units) = ([4 * unit, 2 * unit], [vec![4, 6, 8], vec![6, 8]]);
            let (own, all) = (6 * unit, 9 * unit);
            let mut supernodes = Supernodes::new(unit);
            let (mut tiles, mut dense) = (Vec::new(), vec![0.0; own * all]);
            let mut first = 0;
            for (k, (&width, rows)) in widths.iter().zip(&units).enumerate() {
                supernodes.push(first..first + width, rows.iter().copied());
                let below = rows
                    .iter()
                    .flat_map(|&r| (0..unit).map(move |k| unit * r as usize + k));
                let places: Vec<usize> = (first..first + width).chain(below).collect();
                let height = places.len();
                let mut factor = vec![0.0; width * height];
                for j in 0..width {
                    for i in j..height {
                        let value =
                            ((3 * i + 7 * j + k) as f64).sin() + if i == j { 9.0 } else { 0.0 };
                        factor[i + j * height] = value;
                        dense[places[i] + (first + j) * all] = value;
                    }
                }
                supernodes.pack(k, &factor, &mut tiles);
                first += width;
            }
            assert_eq!(tiles.len(), supernodes.tiles());
            // A x = b with A = L L^T of the own unknowns, given those behind.
            let x: Vec<f64> = (0..all).map(|i| (i as f64).cos()).collect();
            let y: Vec<f64> = (0..own)
                .map(|j| (j..all).map(|i| dense[i + j * all] * x[i]).sum())
                .collect();
            let product = |i: usize| (0..own.min(i + 1)).map(|j| dense[i + j * all] * y[j]).sum();
            let b: Vec<f64> = (0..all).map(product).collect();
            let mut buffer = vec![f64::NAN; supernodes.buffer()];
            let mut z = b[..own].to_vec();
            let mut behind = vec![0.0; all - own];
            supernodes.forward(&tiles, &mut z, &mut behind, &mut buffer);
            for (sum, b) in behind.iter().zip(&b[own..]) {
                assert!((sum + b).abs() < 1e-9, "unit {unit}: {sum} {b}");
            }
            supernodes.backward(&tiles, &mut z, &x[own..], &mut buffer);
            for (z, x) in z.iter().zip(&x) {
                assert!((z - x).abs() < 1e-12, "unit {unit}: {z} {x}");
            }
        }
    }
}
