//! Kernels for panels of columns: the inner loops of triangular solves with one right-hand side.

use pulp::Simd;

/// Digits of the factor that a solve reads. Single precision costs half of the time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Digits {
    Double,
    Single,
}

/// Rows of a tile.
pub(crate) const LANES: usize = 8;
/// Columns of a panel: two nodes of three unknowns, or one block of six.
pub(crate) const PANEL: usize = 6;

/// Consecutive rows of one column.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct Tile(pub(crate) [f64; LANES]);

impl Tile {
    pub(crate) const ZERO: Self = Self([0.0; LANES]);
    /// Numbers of a tile.
    pub(crate) const NUMBERS: usize = LANES;
}

/// A tile rounded to single precision: half of the bytes. All arithmetic is in double precision.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(crate) struct ShortTile([f32; LANES]);

impl From<&Tile> for ShortTile {
    fn from(tile: &Tile) -> Self {
        Self(tile.0.map(|v| v as f32))
    }
}

/// What the kernels read.
pub(crate) trait Stored: Copy + Sync {
    /// The numbers in double precision.
    fn numbers(&self) -> [f64; LANES];
}

impl Stored for Tile {
    #[inline(always)]
    fn numbers(&self) -> [f64; LANES] {
        self.0
    }
}

impl Stored for ShortTile {
    #[inline(always)]
    fn numbers(&self) -> [f64; LANES] {
        self.0.map(f64::from)
    }
}

/// Calls `$name` for the number of columns of a panel and the number of vectors in a tile.
macro_rules! panel {
    ($name:ident, $simd:ident, $count:ident, $unit:ident, $work:expr) => {
        match $count {
            1 => panel!(@ $name, $simd, 1, $unit, $work),
            2 => panel!(@ $name, $simd, 2, $unit, $work),
            3 => panel!(@ $name, $simd, 3, $unit, $work),
            4 => panel!(@ $name, $simd, 4, $unit, $work),
            5 => panel!(@ $name, $simd, 5, $unit, $work),
            _ => panel!(@ $name, $simd, PANEL, $unit, $work),
        }
    };
    (@ $name:ident, $simd:ident, $count:expr, $unit:ident, $work:expr) => {
        match S::F64_LANES {
            8 => $name::<S, _, { $count }, 1, $unit>($simd, $work),
            4 => $name::<S, _, { $count }, 2, $unit>($simd, $work),
            2 => $name::<S, _, { $count }, 4, $unit>($simd, $work),
            _ => $name::<S, _, { $count }, 8, $unit>($simd, $work),
        }
    };
}
pub(crate) use panel;

/// Copies a few units; a call to the library would take longer.
#[inline(always)]
pub(crate) fn copy<const U: usize>(from: &[f64], to: &mut [f64]) {
    for (to, from) in to.chunks_exact_mut(U).zip(from.chunks_exact(U)) {
        to.copy_from_slice(from);
    }
}

/// Forward elimination of one panel; `t` holds its unknowns and the rows below.
#[inline(always)]
pub(crate) fn eliminate<S: Simd, T: Stored, const N: usize, const V: usize, const U: usize>(
    simd: S,
    (tiles, t): (&[T], &mut [f64]),
) {
    let x: [S::f64s; N] = std::array::from_fn(|k| simd.splat_f64s(t[k]));
    t[..N].fill(0.0);
    for (chunk, t) in tiles.chunks_exact(N).zip(t.chunks_exact_mut(LANES)) {
        let (t, _) = S::as_mut_simd_f64s(t);
        let mut sum: [S::f64s; V] = std::array::from_fn(|v| t[v]);
        for k in 0..N {
            let numbers = chunk[k].numbers();
            let (column, _) = S::as_simd_f64s(&numbers);
            for v in 0..V {
                sum[v] = simd.mul_add_e_f64s(column[v], x[k], sum[v]);
            }
        }
        t.copy_from_slice(&sum);
    }
}

/// Back substitution of one panel; `t` holds its unknowns and those of the rows below.
#[inline(always)]
pub(crate) fn substitute<S: Simd, T: Stored, const N: usize, const V: usize, const U: usize>(
    simd: S,
    (tiles, t): (&[T], &mut [f64]),
) {
    let own: [f64; N] = std::array::from_fn(|k| t[k]);
    t[..N].fill(0.0);
    let mut sums = [[simd.splat_f64s(0.0); V]; N];
    for (chunk, t) in tiles.chunks_exact(N).zip(t.chunks_exact(LANES)) {
        let (t, _) = S::as_simd_f64s(t);
        let t: [S::f64s; V] = std::array::from_fn(|v| t[v]);
        for k in 0..N {
            let numbers = chunk[k].numbers();
            let (column, _) = S::as_simd_f64s(&numbers);
            for v in 0..V {
                sums[k][v] = simd.mul_add_e_f64s(column[v], t[v], sums[k][v]);
            }
        }
    }
    for k in 0..N {
        let mut sum = sums[k][0];
        for v in 1..V {
            sum = simd.add_f64s(sum, sums[k][v]);
        }
        t[k] = own[k] + simd.reduce_sum_f64s(sum);
    }
}

/// Tiles, rows, number of units of rows in each group, first column, unknowns, those behind, and a buffer.
pub(crate) type Alike<'a, T, B> = (
    &'a [T],
    &'a [u32],
    usize,
    usize,
    &'a mut [f64],
    B,
    &'a mut [f64],
);

/// Forward elimination of groups of one panel and one shape.
#[inline(always)]
pub(crate) fn eliminate_alike<
    S: Simd,
    T: Stored,
    const N: usize,
    const V: usize,
    const U: usize,
>(
    simd: S,
    (tiles, rows, units, mut start, x, behind, buffer): Alike<'_, T, &mut [f64]>,
) {
    let first = x.len() / U;
    let length = N * (N + U * units).div_ceil(LANES);
    for (tiles, rows) in tiles.chunks_exact(length).zip(rows.chunks_exact(units)) {
        let own = &mut x[start..][..N];
        let z: [S::f64s; N] = std::array::from_fn(|k| simd.splat_f64s(own[k]));
        let t = &mut buffer[..];
        for (chunk, t) in tiles.chunks_exact(N).zip(t.chunks_exact_mut(LANES)) {
            let (t, _) = S::as_mut_simd_f64s(t);
            let mut sum = [simd.splat_f64s(0.0); V];
            for k in 0..N {
                let numbers = chunk[k].numbers();
                let (column, _) = S::as_simd_f64s(&numbers);
                for v in 0..V {
                    sum[v] = simd.mul_add_e_f64s(column[v], z[k], sum[v]);
                }
            }
            t.copy_from_slice(&sum);
        }
        own.copy_from_slice(&t[..N]);
        start += N;
        for (&row, sum) in rows.iter().zip(t[N..].chunks_exact(U)) {
            let row = row as usize;
            let target = if row < first {
                &mut x[U * row..][..U]
            } else {
                &mut behind[U * (row - first)..][..U]
            };
            for k in 0..U {
                target[k] += sum[k];
            }
        }
    }
}

/// Back substitution of groups of one panel and one shape.
#[inline(always)]
pub(crate) fn substitute_alike<
    S: Simd,
    T: Stored,
    const N: usize,
    const V: usize,
    const U: usize,
>(
    simd: S,
    (tiles, rows, units, start, x, behind, buffer): Alike<'_, T, &[f64]>,
) {
    let first = x.len() / U;
    let height = N + U * units;
    let length = N * height.div_ceil(LANES);
    let t = &mut buffer[..height + LANES];
    t[..N].fill(0.0);
    t[height..].fill(0.0);
    let groups = tiles.chunks_exact(length).zip(rows.chunks_exact(units));
    for (g, (tiles, rows)) in groups.enumerate().rev() {
        for (&row, target) in rows.iter().zip(t[N..].chunks_exact_mut(U)) {
            let row = row as usize;
            let source = if row < first {
                &x[U * row..][..U]
            } else {
                &behind[U * (row - first)..][..U]
            };
            target[..U].copy_from_slice(source);
        }
        let mut sums = [[simd.splat_f64s(0.0); V]; N];
        for (chunk, t) in tiles.chunks_exact(N).zip(t.chunks_exact(LANES)) {
            let (t, _) = S::as_simd_f64s(t);
            for k in 0..N {
                let numbers = chunk[k].numbers();
                let (column, _) = S::as_simd_f64s(&numbers);
                for v in 0..V {
                    sums[k][v] = simd.mul_add_e_f64s(column[v], t[v], sums[k][v]);
                }
            }
        }
        let own = &mut x[start + N * g..][..N];
        for k in 0..N {
            let mut sum = sums[k][0];
            for v in 1..V {
                sum = simd.add_f64s(sum, sums[k][v]);
            }
            own[k] += simd.reduce_sum_f64s(sum);
        }
    }
}
