//! Triangular solves with groups of columns of one pattern.
//!
//! One right-hand side at a time, so the time is that of reading the factor once: four columns are worked on together.

use crate::sparse::SparseCholesky;
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// Some columns of a lower triangular factor. Their rows are numbered from the first of these columns on; rows beyond
/// the columns (*behind* them) belong to others.
#[derive(Debug)]
pub(crate) struct Supernodes {
    nodes: Vec<Supernode>,
    /// Rows below the triangle of each group.
    rows: Vec<u32>,
    /// Column-major, reciprocals on the diagonal.
    values: Vec<f64>,
}

#[derive(Debug)]
struct Supernode {
    columns: Range<usize>,
    rows: Range<usize>,
    values: usize,
}

impl Supernodes {
    /// The columns `range` of a factor. Rows from `tail` on follow those of the range; rows between must be empty.
    pub(crate) fn of_factor(factor: &SparseCholesky, range: Range<usize>, tail: usize) -> Self {
        let mut out = Self {
            nodes: Vec::new(),
            rows: Vec::new(),
            values: Vec::new(),
        };
        let local = |row: usize| {
            if row < range.end {
                Some((row - range.start) as u32)
            } else {
                (row >= tail).then(|| (row - tail + range.len()) as u32)
            }
        };
        factor.for_supernodes(&mut |columns, pattern, value| {
            let part = columns.start.max(range.start)..columns.end.min(range.end);
            if part.is_empty() {
                return;
            }
            let first = out.rows.len();
            let below = (part.end..columns.end).chain(pattern.iter().copied());
            // Position within the group of each row that counts; the others are zeros that merging has put there.
            let kept: Vec<usize> = below
                .enumerate()
                .filter_map(|(k, row)| {
                    local(row).map(|l| {
                        out.rows.push(l);
                        part.end - columns.start + k
                    })
                })
                .collect();
            out.nodes.push(Supernode {
                columns: part.start - range.start..part.end - range.start,
                rows: first..out.rows.len(),
                values: out.values.len(),
            });
            let offset = part.start - columns.start;
            for j in 0..part.len() {
                out.values.extend((0..part.len()).map(|i| match i.cmp(&j) {
                    std::cmp::Ordering::Less => 0.0,
                    std::cmp::Ordering::Equal => 1.0 / value(offset + i, offset + j),
                    std::cmp::Ordering::Greater => value(offset + i, offset + j),
                }));
                out.values
                    .extend(kept.iter().map(|&i| value(i, offset + j)));
            }
        });
        out
    }

    /// One group with a dense factor, lower triangle of a square.
    pub(crate) fn dense(dim: usize, mut values: Vec<f64>) -> Self {
        for j in 0..dim {
            values[j + j * dim] = 1.0 / values[j + j * dim];
        }
        let node = Supernode {
            columns: 0..dim,
            rows: 0..0,
            values: 0,
        };
        Self {
            nodes: vec![node],
            rows: Vec::new(),
            values,
        }
    }

    pub(crate) fn into_values(self) -> Vec<f64> {
        self.values
    }

    pub(crate) fn stored(&self) -> usize {
        self.values.len()
    }
}

/// `x = L^-1 x` for the columns' unknowns `x`; adds to `behind` what that does to the rows behind. `buffer` is as long as
/// the longest column.
pub(crate) fn forward(factor: &Supernodes, x: &mut [f64], behind: &mut [f64], buffer: &mut [f64]) {
    Arch::new().dispatch(Forward {
        factor,
        x,
        behind,
        buffer,
    });
}

/// `x = L^-T x` for the columns' unknowns, given those `behind`.
pub(crate) fn backward(factor: &Supernodes, x: &mut [f64], behind: &[f64], buffer: &mut [f64]) {
    Arch::new().dispatch(Backward {
        factor,
        x,
        behind,
        buffer,
    });
}

/// The arguments of [`forward`], for the dispatcher to vector instructions.
struct Forward<'a> {
    factor: &'a Supernodes,
    x: &'a mut [f64],
    behind: &'a mut [f64],
    buffer: &'a mut [f64],
}

impl WithSimd for Forward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let (factor, x) = (self.factor, self.x);
        for node in &factor.nodes {
            let rows = &factor.rows[node.rows.clone()];
            let (width, height) = (node.columns.len(), node.columns.len() + rows.len());
            let values = &factor.values[node.values..][..width * height];
            let t = &mut self.buffer[..height];
            t[..width].copy_from_slice(&x[node.columns.clone()]);
            t[width..].fill(0.0);
            eliminate(values, width, height, t);
            x[node.columns.clone()].copy_from_slice(&t[..width]);
            for (&row, sum) in rows.iter().zip(&t[width..]) {
                let row = row as usize;
                if row < x.len() {
                    x[row] += sum;
                } else {
                    self.behind[row - x.len()] += sum;
                }
            }
        }
    }
}

/// The arguments of [`backward`].
struct Backward<'a> {
    factor: &'a Supernodes,
    x: &'a mut [f64],
    behind: &'a [f64],
    buffer: &'a mut [f64],
}

impl WithSimd for Backward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let (factor, x) = (self.factor, self.x);
        for node in factor.nodes.iter().rev() {
            let rows = &factor.rows[node.rows.clone()];
            let (width, height) = (node.columns.len(), node.columns.len() + rows.len());
            let values = &factor.values[node.values..][..width * height];
            let t = &mut self.buffer[..height];
            t[..width].copy_from_slice(&x[node.columns.clone()]);
            for (&row, v) in rows.iter().zip(&mut t[width..]) {
                let row = row as usize;
                *v = if row < x.len() {
                    x[row]
                } else {
                    self.behind[row - x.len()]
                };
            }
            substitute(values, width, height, t);
            x[node.columns.clone()].copy_from_slice(&t[..width]);
        }
    }
}

/// Forward elimination of one group; `t` holds its unknowns and zeros for the rows below.
#[inline(always)]
fn eliminate(values: &[f64], width: usize, height: usize, t: &mut [f64]) {
    let mut j = 0;
    while j < width {
        let count = (width - j).min(4);
        for c in j..j + count {
            let column = &values[c * height..];
            let v = t[c] * column[c];
            t[c] = v;
            for r in c + 1..j + count {
                t[r] -= column[r] * v;
            }
        }
        let (done, rest) = t.split_at_mut(j + count);
        let (done, length) = (&done[j..], rest.len());
        let column = |k: usize| &values[(j + k) * height + j + count..][..length];
        if let [a, b, c, d] = *done {
            let (l0, l1, l2, l3) = (column(0), column(1), column(2), column(3));
            for i in 0..length {
                rest[i] -= (l0[i] * a + l1[i] * b) + (l2[i] * c + l3[i] * d);
            }
        } else {
            for (k, v) in done.iter().enumerate() {
                for (t, l) in rest.iter_mut().zip(column(k)) {
                    *t -= l * v;
                }
            }
        }
        j += count;
    }
}

/// Back substitution in one group; `t` holds its unknowns and those of the rows below.
#[inline(always)]
fn substitute(values: &[f64], width: usize, height: usize, t: &mut [f64]) {
    let mut j = width;
    while j > 0 {
        let count = if j.is_multiple_of(4) { 4 } else { j % 4 };
        j -= count;
        let (own, rest) = t.split_at_mut(j + count);
        let column = |k: usize| &values[(j + k) * height + j + count..][..rest.len()];
        let mut sums = [0.0; 4];
        if count == 4 {
            sums = dots([column(0), column(1), column(2), column(3)], rest);
        } else {
            for (k, sum) in sums.iter_mut().enumerate().take(count) {
                *sum = dots([column(k)], rest)[0];
            }
        }
        for c in (j..j + count).rev() {
            let column = &values[c * height..];
            let mut v = own[c] - sums[c - j];
            for r in c + 1..j + count {
                v -= column[r] * own[r];
            }
            own[c] = v * column[c];
        }
    }
}

/// Products of some columns with one vector, in eight interleaved sums each.
#[inline(always)]
fn dots<const N: usize>(columns: [&[f64]; N], x: &[f64]) -> [f64; N] {
    const LANES: usize = 8;
    let mut sums = [[0.0; LANES]; N];
    let whole = x.len() / LANES * LANES;
    for start in (0..whole).step_by(LANES) {
        let x = &x[start..start + LANES];
        for (sum, column) in sums.iter_mut().zip(&columns) {
            let column = &column[start..start + LANES];
            for k in 0..LANES {
                sum[k] += column[k] * x[k];
            }
        }
    }
    let mut out = [0.0; N];
    for ((out, s), column) in out.iter_mut().zip(&sums).zip(&columns) {
        let rest: f64 = column[whole..]
            .iter()
            .zip(&x[whole..])
            .map(|(a, b)| a * b)
            .sum();
        *out = ((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7])) + rest;
    }
    out
}
