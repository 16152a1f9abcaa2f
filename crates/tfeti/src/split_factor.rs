//! Factor of `G W G^T` whose last block is dense and follows the weights of the contact rows.
//!
//! Weights of contact rows change with every face, and only the blocks of the subdomains that carry them (`C`) change
//! with them. Eliminating the other subdomains (`O`) first, once, leaves the Schur complement
//! `S(W) = S(0) + sum_r w_r g_r g_r^T` over the contact rows `r`, which is factored anew for each face as a dense matrix.
//! `O` is cut by a layer of subdomains into two halves that do not touch, so that solves run on two threads.

use crate::coarse_matrix::{CoarseMatrix, ModeTable};
use crate::coarse_order::CoarseOrder;
use crate::dense;
use crate::gluing::Gluing;
use crate::sparse::{Columns, FactorError, SparseCholesky, Symbolic};
use crate::supernodes::{Supernodes, backward, forward};
use std::ops::Range;

/// What does not depend on the weights of contact rows.
#[derive(Debug)]
pub(crate) struct SplitBase {
    /// Old number of each unknown.
    order: Vec<u32>,
    /// Parts of `O` that do not touch, each with the rows of the separator and of `C` behind its own.
    parts: Vec<Part>,
    /// The layer between the parts, with the rows of `C` behind its own.
    separator: Part,
    /// First unknown of `C`.
    last: usize,
    /// `S(0)`, lower triangle.
    schur: Vec<f64>,
    contact: ContactRows,
}

#[derive(Debug)]
struct Part {
    range: Range<usize>,
    supernodes: Supernodes,
}

/// `g_r` of the contact rows: blocks of six counted within `C`.
#[derive(Debug)]
struct ContactRows {
    pointers: Vec<u32>,
    entries: Vec<(u32, [f64; 6])>,
}

/// A factor for certain weights of the contact rows.
#[derive(Debug)]
pub(crate) struct SplitFactor {
    /// Factor of `S(W)`, with the reciprocals of its diagonal.
    dense: Supernodes,
}

/// Pivots of `S(W)` below this share of its largest diagonal entry count as zero.
const SINGULAR: f64 = 1e-14;

/// Unknowns below which a part is not worth a second thread.
const SMALL: usize = 600;

impl SplitBase {
    /// From `matrix`, which is `G W G^T` with `weights` on the first `weights.len()` rows.
    pub(crate) fn new(
        coarse: &CoarseMatrix,
        matrix: &Columns,
        order: &CoarseOrder,
        gluing: &Gluing,
        modes: &ModeTable<'_>,
        weights: &[f64],
    ) -> Result<Self, FactorError> {
        let symbolic = Symbolic::ordered(coarse.pattern(), &order.blocks, 6)?;
        let factor = SparseCholesky::new(&symbolic, matrix)?;
        let unknowns: Vec<u32> = (order.blocks.iter())
            .flat_map(|&b| (0..6).map(move |k| 6 * b + k))
            .collect();
        let (dim, last) = (unknowns.len(), 6 * order.last);
        let separator = 6 * order.separator..last;
        let part = |range: Range<usize>, tail: usize| Part {
            supernodes: Supernodes::of_factor(&factor, range.clone(), tail),
            range,
        };
        let parts: Vec<Part> = (order.parts.iter())
            .map(|p| part(6 * p.start..6 * p.end, separator.start))
            .collect();
        let separator = part(separator, last);
        let dense_dim = dim - last;
        let mut triangle = vec![0.0; dense_dim * dense_dim];
        factor.for_supernodes(&mut |columns, pattern, value| {
            for j in columns.start.max(last)..columns.end {
                let rows = (columns.start..columns.end).chain(pattern.iter().copied());
                for (i, row) in rows.enumerate().filter(|&(_, row)| row >= j) {
                    triangle[row - last + (j - last) * dense_dim] = value(i, j - columns.start);
                }
            }
        });
        let mut schur = vec![0.0; dense_dim * dense_dim];
        dense::add_product_transposed(
            &mut schur, 1.0, &triangle, &triangle, dense_dim, dense_dim, dense_dim,
        );
        let mut place = vec![u32::MAX; order.blocks.len()];
        for (k, &block) in order.blocks[order.last..].iter().enumerate() {
            place[block as usize] = k as u32;
        }
        let contact = ContactRows::new(gluing, modes, &place, weights.len());
        let negative: Vec<f64> = weights.iter().map(|w| -w).collect();
        contact.add(&negative, &mut schur, dense_dim);
        Ok(Self {
            order: unknowns,
            parts,
            separator,
            last,
            schur,
            contact,
        })
    }

    fn dense_dim(&self) -> usize {
        self.order.len() - self.last
    }

    /// Length of the work memory of a solve.
    pub(crate) fn work(&self) -> usize {
        let dim = self.order.len();
        let part = |p: &Part| p.range.len() + 2 * dim;
        dim + self.parts.iter().map(part).sum::<usize>() + dim
    }

    /// Numbers stored.
    pub(crate) fn stored(&self) -> usize {
        let part = |p: &Part| p.supernodes.stored();
        self.parts.iter().map(part).sum::<usize>() + part(&self.separator) + 2 * self.schur.len()
    }

    /// Whether a split factor is cheaper than a sparse factor of the whole matrix with `stored` numbers for `rows` unknowns,
    /// counted for one change of the face and the solves until the next.
    pub(crate) fn pays(&self, rows: usize, stored: usize) -> bool {
        const SOLVES: f64 = 12.0;
        // Seconds for a number that a solve reads, and for an operation of a sparse and of a dense factorisation.
        const READ: f64 = 0.6e-9;
        const SPARSE: f64 = 0.1e-9;
        const DENSE: f64 = 0.025e-9;
        let (dim, whole) = (self.dense_dim() as f64, stored as f64);
        // A triangle of the dense factor is read in each direction, all of the other numbers are read twice.
        let own = self.stored() as f64 - 1.5 * dim * dim;
        let split = SOLVES * READ * own + DENSE * dim * dim * dim / 3.0;
        let sparse = SOLVES * READ * whole + SPARSE * whole * whole / rows.max(1) as f64;
        split < sparse
    }

    /// Factor for other weights of the contact rows; reuses the memory of `old`.
    pub(crate) fn factor(
        &self,
        weights: &[f64],
        old: Option<SplitFactor>,
    ) -> Result<SplitFactor, usize> {
        let dim = self.dense_dim();
        let mut values = match old {
            Some(old) => old.dense.into_values(),
            None => Vec::new(),
        };
        values.clear();
        values.extend_from_slice(&self.schur);
        self.contact.add(weights, &mut values, dim);
        let largest = (0..dim).fold(0.0_f64, |m, j| m.max(values[j + j * dim]));
        dense::cholesky(&mut values, dim, SINGULAR * largest)?;
        Ok(SplitFactor {
            dense: Supernodes::dense(dim, values),
        })
    }

    /// `y = (G W G^T)^-1 y`; `work` has the length [`SplitBase::work`] at least.
    pub(crate) fn solve(&self, factor: &SplitFactor, y: &mut [f64], work: &mut [f64]) {
        let dim = self.order.len();
        let (first, last) = (self.separator.range.start, self.last);
        let (x, rest) = work.split_at_mut(dim);
        for (v, &old) in x.iter_mut().zip(&self.order) {
            *v = y[old as usize];
        }
        let (own, shared) = x.split_at_mut(first);
        let tail = dim - first;
        // Elimination: each part sums what it does to the unknowns behind it in its own memory.
        self.for_parts(own, rest, &|part, own, memory| {
            let (behind, buffer) = memory.split_at_mut(tail);
            behind.fill(0.0);
            forward(&part.supernodes, own, behind, buffer);
        });
        let mut memory = &mut *rest;
        for part in &self.parts {
            let (used, next) = memory.split_at_mut(part.range.len() + 2 * dim);
            for (v, sum) in shared.iter_mut().zip(&used[..tail]) {
                *v += sum;
            }
            memory = next;
        }
        let (middle, end) = shared.split_at_mut(last - first);
        let buffer = &mut memory[..dim];
        forward(&self.separator.supernodes, middle, end, buffer);
        forward(&factor.dense, end, &mut [], buffer);
        backward(&factor.dense, end, &[], buffer);
        backward(&self.separator.supernodes, middle, end, buffer);
        let shared = &*shared;
        self.for_parts(own, rest, &|part, own, memory| {
            backward(&part.supernodes, own, shared, memory);
        });
        for (&v, &old) in x.iter().zip(&self.order) {
            y[old as usize] = v;
        }
    }

    /// Runs `task` on every part with its unknowns and its memory, two parts at a time.
    fn for_parts(
        &self,
        own: &mut [f64],
        memory: &mut [f64],
        task: &(impl Fn(&Part, &mut [f64], &mut [f64]) + Sync),
    ) {
        let dim = self.order.len();
        let mut own = own;
        let mut memory = memory;
        for pair in self.parts.chunks(2) {
            let (x, rest) = std::mem::take(&mut own).split_at_mut(pair[0].range.len());
            let (m, behind) = std::mem::take(&mut memory).split_at_mut(x.len() + 2 * dim);
            (own, memory) = (rest, behind);
            match pair {
                [a, b] => {
                    let (y, rest) = std::mem::take(&mut own).split_at_mut(b.range.len());
                    let (n, behind) = std::mem::take(&mut memory).split_at_mut(y.len() + 2 * dim);
                    (own, memory) = (rest, behind);
                    if x.len().min(y.len()) >= SMALL {
                        rayon::join(|| task(a, x, m), || task(b, y, n));
                    } else {
                        task(a, x, m);
                        task(b, y, n);
                    }
                }
                single => task(&single[0], x, m),
            }
        }
    }
}

impl ContactRows {
    fn new(gluing: &Gluing, modes: &ModeTable<'_>, place: &[u32], count: usize) -> Self {
        let mut out = Self {
            pointers: vec![0],
            entries: Vec::new(),
        };
        let mut row = Vec::new();
        for special in 0..count {
            row.clear();
            modes.row(gluing, special, 1.0, &mut row);
            let entries = row.iter().map(|&(s, g)| (place[s as usize], g));
            out.entries.extend(entries);
            out.pointers.push(out.entries.len() as u32);
        }
        out
    }

    /// Adds `sum w_r g_r g_r^T` to the lower triangle of `schur`.
    fn add(&self, weights: &[f64], schur: &mut [f64], dim: usize) {
        for (pair, &weight) in self.pointers.windows(2).zip(weights) {
            if weight == 0.0 {
                continue;
            }
            let row = &self.entries[pair[0] as usize..pair[1] as usize];
            for (i, gi) in row {
                for (j, gj) in row.iter().filter(|(j, _)| i >= j) {
                    let (i, j) = (6 * *i as usize, 6 * *j as usize);
                    for c in 0..6 {
                        let factor = weight * gj[c];
                        let column = &mut schur[i + (j + c) * dim..][..6];
                        for r in 0..6 {
                            column[r] += factor * gi[r];
                        }
                    }
                }
            }
        }
    }
}
