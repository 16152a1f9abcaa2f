//! Vector kernels: the one place of every dot product and norm of a solver.
//!
//! A sum is taken over chunks of 8192 entries, each with eight interleaved partial sums, and the
//! chunks are added along a fixed binary tree. The tree depends only on the length, so a result has
//! the same bits for any number of threads. Vectors shorter than [`PARALLEL`] are handled by the
//! calling thread; nothing here allocates.
//!
//! All functions work on the common length of their arguments; solvers check lengths at their entry.

use rayon::prelude::*;
use std::ops::Range;

/// Entries summed by one leaf of the reduction tree: for those who keep parts of a vector.
#[doc(hidden)]
pub const CHUNK: usize = 8192;

/// Length from which kernels use the rayon pool.
pub const PARALLEL: usize = 8 * CHUNK;

const LANES: usize = 8;

/// `x · y`.
#[must_use]
pub fn dot(x: &[f64], y: &[f64]) -> f64 {
    dots([(x, y)])[0]
}

/// `x · y` of each pair in one pass.
#[must_use]
pub fn dots<const K: usize>(pairs: [(&[f64], &[f64]); K]) -> [f64; K] {
    let n = pairs.iter().map(|(x, y)| x.len().min(y.len())).min().unwrap_or(0);
    let sums = reduce(0..n, n >= PARALLEL, &|r| {
        Sums(pairs.map(|(x, y)| leaf(&x[r.clone()], &y[r.clone()], |a, b| a * b)))
    });
    sums.0
}

/// The dot product of vectors from those of their chunks, with the same bits as [`dot`].
#[doc(hidden)]
#[must_use]
pub fn join(chunks: &[f64]) -> f64 {
    match chunks {
        [] => 0.0,
        [one] => *one,
        _ => {
            let (low, high) = chunks.split_at(chunks.len().div_ceil(2));
            join(low) + join(high)
        }
    }
}

/// Euclidean norm `|x|`.
#[must_use]
pub fn norm(x: &[f64]) -> f64 {
    dot(x, x).sqrt()
}

/// `|x - y|²` without a temporary.
pub(crate) fn distance_squared(x: &[f64], y: &[f64]) -> f64 {
    let n = x.len().min(y.len());
    reduce(0..n, n >= PARALLEL, &|r| {
        leaf(&x[r.clone()], &y[r], |a, b| (a - b) * (a - b))
    })
}

/// Decrease of a quadratic cost between two points from their gradients, free of cancellation:
/// `q(x0) - q(x1) = (x0 - x1) · (g0 + g1) / 2`.
pub(crate) fn decrease(x0: &[f64], g0: &[f64], x1: &[f64], g1: &[f64]) -> f64 {
    let n = x0.len().min(g0.len()).min(x1.len()).min(g1.len());
    let sum = reduce(0..n, n >= PARALLEL, &|r| {
        let mut acc = [0.0; LANES];
        for (k, i) in r.enumerate() {
            acc[k % LANES] += (x0[i] - x1[i]) * (g0[i] + g1[i]);
        }
        folded(acc)
    });
    0.5 * sum
}

/// Euclidean distance `|x - y|`.
#[must_use]
pub fn distance(x: &[f64], y: &[f64]) -> f64 {
    distance_squared(x, y).sqrt()
}

/// Largest absolute entry; NaN if any entry is NaN.
#[must_use]
pub fn max_abs(x: &[f64]) -> f64 {
    let mut m = 0.0_f64;
    for &v in x {
        if v.is_nan() {
            return f64::NAN;
        }
        m = m.max(v.abs());
    }
    m
}

/// `y += a x`.
pub fn axpy(a: f64, x: &[f64], y: &mut [f64]) {
    zip(x, y, move |xi, yi| *yi += a * xi);
}

/// `y = x + b y`.
pub fn xpby(x: &[f64], b: f64, y: &mut [f64]) {
    zip(x, y, move |xi, yi| *yi = xi + b * *yi);
}

/// `y = a x + b y`.
pub fn axpby(a: f64, x: &[f64], b: f64, y: &mut [f64]) {
    zip(x, y, move |xi, yi| *yi = a * xi + b * *yi);
}

/// `y = x`.
pub fn copy(x: &[f64], y: &mut [f64]) {
    zip(x, y, |xi, yi| *yi = xi);
}

/// `z = x - y`.
pub fn difference(x: &[f64], y: &[f64], z: &mut [f64]) {
    let part = |((z, x), y): ((&mut [f64], &[f64]), &[f64])| {
        z.iter_mut().zip(x).zip(y).for_each(|((z, x), y)| *z = x - y);
    };
    if z.len() < PARALLEL {
        part(((z, x), y))
    } else {
        z.par_chunks_mut(CHUNK)
            .zip(x.par_chunks(CHUNK))
            .zip(y.par_chunks(CHUNK))
            .for_each(part)
    }
}

/// `y -= x`.
pub fn subtract(x: &[f64], y: &mut [f64]) {
    zip(x, y, |xi, yi| *yi -= xi);
}

/// `y *= a`.
pub fn scale(a: f64, y: &mut [f64]) {
    each(y, move |yi| *yi *= a);
}

/// `y = a` in every entry.
pub(crate) fn fill(a: f64, y: &mut [f64]) {
    each(y, move |yi| *yi = a);
}

/// Linear extrapolation for a warm start: `out = last + ratio (last - before)`.
///
/// `ratio` is the new step length divided by the last one; 1 for equal steps, 0 for none.
pub fn extrapolate(last: &[f64], before: &[f64], ratio: f64, out: &mut [f64]) {
    copy(last, out);
    axpy(ratio, last, out);
    axpy(-ratio, before, out);
}

fn zip(x: &[f64], y: &mut [f64], f: impl Fn(f64, &mut f64) + Sync + Send) {
    if y.len() < PARALLEL {
        for (yi, &xi) in y.iter_mut().zip(x) {
            f(xi, yi);
        }
    } else {
        y.par_chunks_mut(CHUNK).zip(x.par_chunks(CHUNK)).for_each(|(yc, xc)| {
            for (yi, &xi) in yc.iter_mut().zip(xc) {
                f(xi, yi);
            }
        });
    }
}

fn each(y: &mut [f64], f: impl Fn(&mut f64) + Sync + Send) {
    if y.len() < PARALLEL {
        y.iter_mut().for_each(f);
    } else {
        y.par_chunks_mut(CHUNK).for_each(|c| c.iter_mut().for_each(&f));
    }
}

/// Where the tree over `n > CHUNK` entries is cut: a multiple of the chunk length.
fn cut(n: usize) -> usize {
    n.div_ceil(CHUNK).div_ceil(2) * CHUNK
}

/// Several sums.
struct Sums<const K: usize>([f64; K]);

impl<const K: usize> std::ops::Add for Sums<K> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] + other.0[k]))
    }
}

/// Sum over `range` along the fixed tree.
fn reduce<T: Send + std::ops::Add<Output = T>>(
    range: Range<usize>,
    parallel: bool,
    f: &(impl Fn(Range<usize>) -> T + Sync),
) -> T {
    let n = range.len();
    if n <= CHUNK {
        return f(range);
    }
    let c = range.start + cut(n);
    let (lo, hi) = (range.start..c, c..range.end);
    let (a, b) = if parallel {
        rayon::join(|| reduce(lo, true, f), || reduce(hi, true, f))
    } else {
        (reduce(lo, false, f), reduce(hi, false, f))
    };
    a + b
}

/// One leaf: interleaved partial sums of `f(x, y)`.
#[inline]
fn leaf(x: &[f64], y: &[f64], f: impl Fn(f64, f64) -> f64) -> f64 {
    let mut acc = [0.0; LANES];
    let (xc, yc) = (x.chunks_exact(LANES), y.chunks_exact(LANES));
    let (xr, yr) = (xc.remainder(), yc.remainder());
    for (xs, ys) in xc.zip(yc) {
        for k in 0..LANES {
            acc[k] += f(xs[k], ys[k]);
        }
    }
    for (k, (&a, &b)) in xr.iter().zip(yr).enumerate() {
        acc[k] += f(a, b);
    }
    folded(acc)
}

/// The partial sums of a leaf together.
fn folded(acc: [f64; LANES]) -> f64 {
    ((acc[0] + acc[4]) + (acc[2] + acc[6])) + ((acc[1] + acc[5]) + (acc[3] + acc[7]))
}

/// `(p, x) = (x, x - t p)`: the step, with the point before it left in `p`.
pub(crate) fn step_keeping_start(p: &mut [f64], x: &mut [f64], t: f64) {
    for (pi, xi) in p.iter_mut().zip(x) {
        let before = *xi;
        *xi -= t * *pi;
        *pi = before;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(n: usize, f: f64) -> Vec<f64> {
        (0..n).map(|i| (f * i as f64).sin()).collect()
    }

    #[test]
    fn sums_agree_with_plain_loops() {
        for n in [0, 1, 7, 8, 9, CHUNK, CHUNK + 1, 3 * CHUNK + 5, PARALLEL + 3] {
            let (x, y) = (wave(n, 0.37), wave(n, 0.11));
            let plain: f64 = x.iter().zip(&y).map(|(a, b)| a * b).sum();
            assert!((dot(&x, &y) - plain).abs() <= 1e-12 * (1.0 + n as f64));
            let plain: f64 = x.iter().zip(&y).map(|(a, b)| (a - b).powi(2)).sum();
            assert!((distance_squared(&x, &y) - plain).abs() <= 1e-12 * (1.0 + n as f64));
            assert_eq!(dots([(&x, &y), (&y, &y)]), [dot(&x, &y), dot(&y, &y)]);
            let mut z = vec![0.0; n];
            difference(&x, &y, &mut z);
            assert!((0..n).all(|i| z[i] == x[i] - y[i]));
        }
    }

    #[test]
    fn chunks_joined_have_the_bits_of_the_whole_on_any_number_of_threads() {
        for n in [0, 9, CHUNK, 3 * CHUNK + 5, 6 * CHUNK, 20 * CHUNK + 17] {
            let (x, y) = (wave(n, 0.37), wave(n, 0.11));
            let sums: Vec<f64> = x.chunks(CHUNK).zip(y.chunks(CHUNK)).map(|(x, y)| dot(x, y)).collect();
            for threads in [1, 2, 5] {
                let pool = rayon::ThreadPoolBuilder::new()
                    .num_threads(threads)
                    .build()
                    .expect("pool");
                let whole = pool.install(|| dot(&x, &y));
                assert_eq!(join(&sums).to_bits(), whole.to_bits());
            }
        }
    }

    #[test]
    fn elementwise_kernels() {
        let x = [1.0, 2.0, 3.0];
        let mut y = [1.0, 1.0, 1.0];
        axpy(2.0, &x, &mut y);
        assert_eq!(y, [3.0, 5.0, 7.0]);
        xpby(&x, -1.0, &mut y);
        assert_eq!(y, [-2.0, -3.0, -4.0]);
        axpby(2.0, &x, 1.0, &mut y);
        assert_eq!(y, [0.0, 1.0, 2.0]);
        extrapolate(&x, &[0.0, 1.0, 2.0], 1.0, &mut y);
        assert_eq!(y, [2.0, 3.0, 4.0]);
        assert_eq!(max_abs(&[-5.0, 2.0]), 5.0);
        assert!(max_abs(&[1.0, f64::NAN]).is_nan());
    }
}
