//! Triangular solves with groups of columns of one pattern.
//!
//! One right-hand side at a time, so the time is that of reading the factor once in each direction. The columns of a
//! group are stored in panels of up to [`PANEL`], each a run of tiles in the order in which both directions read it.
//! The factor is `L D L^T` with unit diagonal blocks: the first rows of a panel's tiles are `D^-1`, the others are
//! `-L`. Elimination then is one product with all tiles, substitution one with their transposes, and no tile is left
//! half empty in between.

use crate::linalg::tiles::{Alike, LANES, PANEL, Stored, Tile, Unknown, add_unit, copy, panel, unit};
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// Pattern of groups of columns. Rows are counted from the first of these columns on; rows beyond them (*behind*)
/// belong to others. Rows below a group come in units of `unit` consecutive ones, three or six.
#[derive(Debug, Clone)]
pub(crate) struct Supernodes {
    pub(super) unit: usize,
    pub(super) nodes: Vec<Supernode>,
    /// First rows of the units below the triangle of each group, over the unit.
    pub(super) rows: Vec<u32>,
    tiles: usize,
    height: usize,
}

/// The two halves of a solve.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Way {
    /// `x = D^-1 L^-1 x`; adds to what is behind what that does to the rows there.
    Forward,
    /// `x = L^-T x`, given what is behind, which stays.
    Backward,
}

#[derive(Debug, Clone)]
pub(super) struct Supernode {
    pub(super) columns: Range<usize>,
    pub(super) rows: Range<usize>,
    pub(super) tiles: Range<usize>,
    /// How many groups of one panel and one shape end here, one after another; they are worked on in one loop.
    alike: usize,
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
        let start = self.tiles;
        self.tiles += Self::tiles_of(width, height);
        let single = width <= PANEL && !rows.is_empty();
        let before = self.nodes.last().filter(|last| {
            last.columns.end == columns.start && last.columns.len() == width && last.rows.len() == rows.len()
        });
        let alike = match (single, before) {
            (false, _) => 0,
            (true, None) => 1,
            (true, Some(before)) => before.alike + 1,
        };
        self.height = self.height.max(height);
        self.nodes.push(Supernode {
            columns,
            rows,
            tiles: start..self.tiles,
            alike,
        });
    }

    /// Tiles of a group.
    pub(crate) fn tiles_of(width: usize, height: usize) -> usize {
        let panel = |c: usize| PANEL.min(width - c) * (height - c).div_ceil(LANES);
        (0..width).step_by(PANEL).map(panel).sum()
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

    /// [`Forward`](Way::Forward) or [`Backward`](Way::Backward) for the columns' unknowns `x` and those `behind`.
    pub(crate) fn solve<T: Stored, X: Unknown>(&self, way: Way, tiles: &[T], [x, behind, buffer]: [&mut [X]; 3]) {
        Arch::new().dispatch(Solve {
            way,
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
            let (own, rest) = tiles.split_at_mut(count * length.div_ceil(LANES));
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
            for (k, chunk) in own.chunks_exact_mut(count).enumerate() {
                let start = LANES * k;
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
                            sum[l] -= read[i][l] * inverse[j][i];
                        }
                    }
                    for i in start..count.min(start + LANES) {
                        let terms = (i.max(j)..count).map(|k| inverse[i][k] * inverse[j][k]);
                        sum[i - start] = terms.sum();
                    }
                    tile.0 = sum;
                }
            }
        }
    }
}

/// The arguments of [`Supernodes::solve`], likewise.
struct Solve<'a, T, X> {
    way: Way,
    factor: &'a Supernodes,
    tiles: &'a [T],
    x: &'a mut [X],
    behind: &'a mut [X],
    buffer: &'a mut [X],
}

impl<T: Stored, X: Unknown> WithSimd for Solve<'_, T, X> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        match (self.way, self.factor.unit) {
            (Way::Forward, 6) => self.forward::<S, 6>(simd),
            (Way::Forward, _) => self.forward::<S, 3>(simd),
            (Way::Backward, 6) => self.backward::<S, 6>(simd),
            (Way::Backward, _) => self.backward::<S, 3>(simd),
        }
    }
}

impl<T: Stored, X: Unknown> Solve<'_, T, X> {
    #[inline(always)]
    fn forward<S: Simd, const U: usize>(mut self, simd: S) {
        let mut nodes = &self.factor.nodes[..];
        while let Some(node) = nodes.first() {
            let run = nodes.iter().zip(1..);
            let alike = run.take_while(|(n, k)| X::IN_RUNS && n.alike == *k).count();
            if alike > 0 {
                let (run, rest) = nodes.split_at(alike);
                nodes = rest;
                let (count, alike) = (node.columns.len(), self.alike(run));
                panel!(X::eliminate_alike, simd, count, U, alike);
            } else {
                nodes = &nodes[1..];
                self.eliminate::<S, U>(simd, node);
            }
        }
    }

    #[inline(always)]
    fn backward<S: Simd, const U: usize>(mut self, simd: S) {
        let mut nodes = &self.factor.nodes[..];
        while let Some((node, before)) = nodes.split_last() {
            if X::IN_RUNS && node.alike > 0 {
                let (rest, run) = nodes.split_at(nodes.len() - node.alike);
                nodes = rest;
                let (count, alike) = (node.columns.len(), self.alike(run));
                panel!(X::substitute_alike, simd, count, U, alike);
            } else {
                nodes = before;
                self.substitute::<S, U>(simd, node);
            }
        }
    }

    /// What kernels take of groups of one panel and one shape.
    #[inline(always)]
    fn alike(&mut self, run: &[Supernode]) -> Alike<'_, T, X> {
        let (first, last) = (&run[0], &run[run.len() - 1]);
        let tiles = &self.tiles[first.tiles.start..last.tiles.end];
        let rows = &self.factor.rows[first.rows.start..last.rows.end];
        let (units, start) = (first.rows.len(), first.columns.start);
        (tiles, rows, units, start, self.x, self.behind, self.buffer)
    }

    /// Forward elimination of one group.
    #[inline(always)]
    fn eliminate<S: Simd, const U: usize>(&mut self, simd: S, node: &Supernode) {
        let rows = &self.factor.rows[node.rows.clone()];
        let (width, height) = (node.columns.len(), node.columns.len() + U * rows.len());
        let t = &mut self.buffer[..height + LANES];
        copy::<X, U>(&self.x[node.columns.clone()], &mut t[..width]);
        t[width..].fill(X::ZERO);
        let mut tiles = &self.tiles[node.tiles.clone()];
        for start in (0..width).step_by(PANEL) {
            let count = PANEL.min(width - start);
            let (own, rest) = tiles.split_at(count * (height - start).div_ceil(LANES));
            tiles = rest;
            let t = &mut t[start..];
            panel!(X::eliminate, simd, count, U, (own, t));
        }
        copy::<X, U>(&t[..width], &mut self.x[node.columns.clone()]);
        for (&row, sum) in rows.iter().zip(t[width..].chunks_exact(U)) {
            add_unit::<X, U>(self.x, self.behind, row, sum);
        }
    }

    /// Back substitution of one group.
    #[inline(always)]
    fn substitute<S: Simd, const U: usize>(&mut self, simd: S, node: &Supernode) {
        let rows = &self.factor.rows[node.rows.clone()];
        let (width, height) = (node.columns.len(), node.columns.len() + U * rows.len());
        let t = &mut self.buffer[..height + LANES];
        copy::<X, U>(&self.x[node.columns.clone()], &mut t[..width]);
        for (&row, target) in rows.iter().zip(t[width..].chunks_exact_mut(U)) {
            target.copy_from_slice(unit::<X, U>(self.x, self.behind, row));
        }
        t[height..].fill(X::ZERO);
        let mut tiles = &self.tiles[node.tiles.clone()];
        let mut end = width;
        while end > 0 {
            let count = if end.is_multiple_of(PANEL) { PANEL } else { end % PANEL };
            let start = end - count;
            let length = count * (height - start).div_ceil(LANES);
            let (rest, own) = tiles.split_at(tiles.len() - length);
            (tiles, end) = (rest, start);
            let t = &mut t[start..];
            panel!(X::substitute, simd, count, U, (own, t));
        }
        copy::<X, U>(&t[..width], &mut self.x[node.columns.clone()]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A factor in two groups whose rows below lie within and behind.
    #[test]
    fn both_directions_solve_with_the_product_of_the_factor() {
        for unit in [3, 6] {
            let (widths, units) = ([4 * unit, 2 * unit], [vec![4, 6, 8], vec![6, 8]]);
            let (own, all) = (6 * unit, 9 * unit);
            let mut supernodes = Supernodes::new(unit);
            let (mut tiles, mut dense) = (Vec::new(), vec![0.0; own * all]);
            let mut first = 0;
            for (k, (&width, rows)) in widths.iter().zip(&units).enumerate() {
                supernodes.push(first..first + width, rows.iter().copied());
                let below = rows.iter().flat_map(|&r| (0..unit).map(move |k| unit * r as usize + k));
                let places: Vec<usize> = (first..first + width).chain(below).collect();
                let height = places.len();
                let mut factor = vec![0.0; width * height];
                for j in 0..width {
                    for i in j..height {
                        let value = ((3 * i + 7 * j + k) as f64).sin() + if i == j { 9.0 } else { 0.0 };
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
            supernodes.solve(Way::Forward, &tiles, [&mut z, &mut behind, &mut buffer]);
            for (sum, b) in behind.iter().zip(&b[own..]) {
                assert!((sum + b).abs() < 1e-9, "unit {unit}: {sum} {b}");
            }
            supernodes.solve(Way::Backward, &tiles, [&mut z, &mut x[own..].to_vec(), &mut buffer]);
            for (z, x) in z.iter().zip(&x) {
                assert!((z - x).abs() < 1e-12, "unit {unit}: {z} {x}");
            }
        }
    }
}
