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
/// Right sides that take half of the time of so many.
pub(crate) const HALF: usize = LANES / 2;
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
    ($($name:ident)::+, $simd:ident, $count:ident, $unit:ident, $work:expr) => {
        match $count {
            1 => panel!(@ $($name)::+, $simd, 1, $unit, $work),
            2 => panel!(@ $($name)::+, $simd, 2, $unit, $work),
            3 => panel!(@ $($name)::+, $simd, 3, $unit, $work),
            4 => panel!(@ $($name)::+, $simd, 4, $unit, $work),
            5 => panel!(@ $($name)::+, $simd, 5, $unit, $work),
            _ => panel!(@ $($name)::+, $simd, PANEL, $unit, $work),
        }
    };
    (@ $($name:ident)::+, $simd:ident, $count:expr, $unit:ident, $work:expr) => {
        match S::F64_LANES {
            8 => $($name)::+::<S, _, { $count }, 1, $unit>($simd, $work),
            4 => $($name)::+::<S, _, { $count }, 2, $unit>($simd, $work),
            2 => $($name)::+::<S, _, { $count }, 4, $unit>($simd, $work),
            _ => $($name)::+::<S, _, { $count }, 8, $unit>($simd, $work),
        }
    };
}
pub(crate) use panel;

/// Copies a few units; a call to the library would take longer.
#[inline(always)]
pub(crate) fn copy<X: Copy, const U: usize>(from: &[X], to: &mut [X]) {
    for (to, from) in to.chunks_exact_mut(U).zip(from.chunks_exact(U)) {
        to.copy_from_slice(from);
    }
}

/// The unit of rows `row` among the unknowns `x`, of which there are `first`, and those behind them.
#[inline(always)]
pub(crate) fn unit<'a, X, const U: usize>(x: &'a [X], behind: &'a [X], row: u32) -> &'a [X] {
    let (row, first) = (row as usize, x.len() / U);
    if row < first { &x[U * row..][..U] } else { &behind[U * (row - first)..][..U] }
}

/// Adds to the unit of rows `row`.
#[inline(always)]
pub(crate) fn add_unit<X: Unknown, const U: usize>(x: &mut [X], behind: &mut [X], row: u32, sum: &[X]) {
    let (row, first) = (row as usize, x.len() / U);
    let target = if row < first { &mut x[U * row..][..U] } else { &mut behind[U * (row - first)..][..U] };
    for k in 0..U {
        target[k].add(&sum[k]);
    }
}

/// `t = A z`, added to `t` if `KEEP`, for the columns `A` of a panel.
#[inline(always)]
fn product<S: Simd, T: Stored, const N: usize, const V: usize, const KEEP: bool>(
    simd: S,
    tiles: &[T],
    z: &[S::f64s; N],
    t: &mut [f64],
) {
    for (chunk, t) in tiles.chunks_exact(N).zip(t.chunks_exact_mut(LANES)) {
        let (t, _) = S::as_mut_simd_f64s(t);
        let start = |v: usize| if KEEP { t[v] } else { simd.splat_f64s(0.0) };
        let mut sum: [S::f64s; V] = std::array::from_fn(start);
        for k in 0..N {
            let numbers = chunk[k].numbers();
            let (column, _) = S::as_simd_f64s(&numbers);
            for v in 0..V {
                sum[v] = simd.mul_add_e_f64s(column[v], z[k], sum[v]);
            }
        }
        t.copy_from_slice(&sum);
    }
}

/// `A^T t` for the columns `A` of a panel.
#[inline(always)]
fn transposed<S: Simd, T: Stored, const N: usize, const V: usize>(simd: S, tiles: &[T], t: &[f64]) -> [f64; N] {
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
    std::array::from_fn(|k| {
        let mut sum = sums[k][0];
        for v in 1..V {
            sum = simd.add_f64s(sum, sums[k][v]);
        }
        simd.reduce_sum_f64s(sum)
    })
}

/// Tiles, rows, number of units of rows in each group, first column, unknowns, those behind, and a buffer.
pub(crate) type Alike<'a, T, X> = (&'a [T], &'a [u32], usize, usize, &'a mut [X], &'a mut [X], &'a mut [X]);

/// What a solve is for: a number, or [several](super::lanes) side by side.
pub(crate) trait Unknown: Copy {
    const ZERO: Self;
    /// Whether there are kernels for groups of one panel and one shape.
    const IN_RUNS: bool = false;

    fn add(&mut self, other: &Self);

    /// Forward elimination of one panel with its tiles; behind its unknowns stand those of the rows below.
    fn eliminate<S: Simd, T: Stored, const N: usize, const V: usize, const U: usize>(
        simd: S,
        work: (&[T], &mut [Self]),
    );

    /// Back substitution of one panel.
    fn substitute<S: Simd, T: Stored, const N: usize, const V: usize, const U: usize>(
        simd: S,
        work: (&[T], &mut [Self]),
    );

    /// Forward elimination of groups of one panel and one shape.
    fn eliminate_alike<S: Simd, T: Stored, const N: usize, const V: usize, const U: usize>(
        _: S,
        _: Alike<'_, T, Self>,
    ) {
    }

    /// Back substitution of groups of one panel and one shape.
    fn substitute_alike<S: Simd, T: Stored, const N: usize, const V: usize, const U: usize>(
        _: S,
        _: Alike<'_, T, Self>,
    ) {
    }
}

impl Unknown for f64 {
    const ZERO: Self = 0.0;
    const IN_RUNS: bool = true;

    #[inline(always)]
    fn add(&mut self, other: &Self) {
        *self += other;
    }

    #[inline(always)]
    fn eliminate<S: Simd, T: Stored, const N: usize, const V: usize, const U: usize>(
        simd: S,
        (tiles, t): (&[T], &mut [Self]),
    ) {
        let z: [S::f64s; N] = std::array::from_fn(|k| simd.splat_f64s(t[k]));
        t[..N].fill(0.0);
        product::<S, T, N, V, true>(simd, tiles, &z, t);
    }

    #[inline(always)]
    fn substitute<S: Simd, T: Stored, const N: usize, const V: usize, const U: usize>(
        simd: S,
        (tiles, t): (&[T], &mut [Self]),
    ) {
        let own: [f64; N] = std::array::from_fn(|k| t[k]);
        t[..N].fill(0.0);
        let sums = transposed::<S, T, N, V>(simd, tiles, t);
        for k in 0..N {
            t[k] = own[k] + sums[k];
        }
    }

    #[inline(always)]
    fn eliminate_alike<S: Simd, T: Stored, const N: usize, const V: usize, const U: usize>(
        simd: S,
        (tiles, rows, units, mut start, x, behind, t): Alike<'_, T, Self>,
    ) {
        let length = N * (N + U * units).div_ceil(LANES);
        for (tiles, rows) in tiles.chunks_exact(length).zip(rows.chunks_exact(units)) {
            let own = &mut x[start..][..N];
            let z: [S::f64s; N] = std::array::from_fn(|k| simd.splat_f64s(own[k]));
            product::<S, T, N, V, false>(simd, tiles, &z, t);
            own.copy_from_slice(&t[..N]);
            start += N;
            for (&row, sum) in rows.iter().zip(t[N..].chunks_exact(U)) {
                add_unit::<f64, U>(x, behind, row, sum);
            }
        }
    }

    #[inline(always)]
    fn substitute_alike<S: Simd, T: Stored, const N: usize, const V: usize, const U: usize>(
        simd: S,
        (tiles, rows, units, start, x, behind, buffer): Alike<'_, T, Self>,
    ) {
        let height = N + U * units;
        let length = N * height.div_ceil(LANES);
        let t = &mut buffer[..height + LANES];
        t[..N].fill(0.0);
        t[height..].fill(0.0);
        let groups = tiles.chunks_exact(length).zip(rows.chunks_exact(units));
        for (g, (tiles, rows)) in groups.enumerate().rev() {
            for (&row, target) in rows.iter().zip(t[N..].chunks_exact_mut(U)) {
                target.copy_from_slice(unit::<f64, U>(x, behind, row));
            }
            let sums = transposed::<S, T, N, V>(simd, tiles, t);
            let own = &mut x[start + N * g..][..N];
            for k in 0..N {
                own[k] += sums[k];
            }
        }
    }
}
