//! Sparse Cholesky factors. The only file that names the sparse part of the linear algebra library.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::mat::MatMut;
use faer::perm::PermRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky, supernodal::SupernodalLltRef,
};
use faer::sparse::linalg::{SupernodalThreshold, amd};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, Par, Side};
use std::ops::Range;
use std::sync::Arc;

/// Compressed columns of a symmetric matrix: both triangles or the lower one, rows ascending.
#[derive(Debug, Clone)]
pub(crate) struct Columns {
    pub(crate) dim: usize,
    pub(crate) pointers: Vec<usize>,
    pub(crate) rows: Vec<usize>,
    pub(crate) values: Vec<f64>,
}

impl Columns {
    /// A matrix to whose columns entries are to be added one after another.
    pub(crate) fn empty(dim: usize) -> Self {
        Self {
            dim,
            pointers: vec![0],
            rows: Vec::new(),
            values: Vec::new(),
        }
    }

    /// Copies a sparse matrix that is stored by columns (or is symmetric).
    pub(crate) fn from_symmetric(matrix: &sprs::CsMat<f64>) -> Self {
        Self {
            dim: matrix.cols(),
            pointers: matrix.proper_indptr().to_vec(),
            rows: matrix.indices().to_vec(),
            values: matrix.data().to_vec(),
        }
    }

    /// The pattern of full blocks of `unit` unknowns, all values zero, from the neighbours of each block, which are
    /// sorted.
    pub(crate) fn of_blocks(graph: &mut [Vec<u32>], unit: usize) -> Self {
        let (mut pointers, mut rows) = (vec![0], Vec::new());
        for list in &mut *graph {
            list.sort_unstable();
            list.dedup();
            for _ in 0..unit {
                let own = list.iter().flat_map(|&b| (0..unit).map(move |c| unit * b as usize + c));
                rows.extend(own);
                pointers.push(rows.len());
            }
        }
        let (dim, values) = (unit * graph.len(), vec![0.0; rows.len()]);
        Self {
            dim,
            pointers,
            rows,
            values,
        }
    }

    /// Position of an entry in `values`.
    pub(crate) fn find(&self, row: usize, column: usize) -> Option<usize> {
        let range = self.pointers[column]..self.pointers[column + 1];
        self.rows[range.clone()]
            .binary_search(&row)
            .ok()
            .map(|k| range.start + k)
    }

    /// Adds to the stored entries of the block of a node with itself, three unknowns a node.
    pub(crate) fn add_to_node(&mut self, node: usize, block: impl Fn(usize, usize) -> f64) {
        for i in 0..3 {
            for j in 0..3 {
                if let Some(k) = self.find(3 * node + i, 3 * node + j) {
                    self.values[k] += block(i, j);
                }
            }
        }
    }

    /// Diagonal entry; 0 if it is not stored.
    pub(crate) fn diagonal(&self, i: usize) -> f64 {
        self.find(i, i).map_or(0.0, |k| self.values[k])
    }

    pub(crate) fn column(&self, j: usize) -> (&[usize], &[f64]) {
        let range = self.pointers[j]..self.pointers[j + 1];
        (&self.rows[range.clone()], &self.values[range])
    }
}

/// A failure of the factorisation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FactorError {
    /// The pivot at this elimination step is not positive.
    Pivot(usize),
    /// The pattern could not be analysed (out of memory or index overflow).
    Pattern,
}

/// Ordering and pattern of a factor; may serve many matrices of one pattern.
#[derive(Debug, Clone)]
pub(crate) struct Symbolic(Arc<SymbolicCholesky<usize>>);

impl Symbolic {
    /// Analyses the lower triangle of a pattern of full blocks of `block` unknowns, ordered by approximate minimum
    /// degree of the blocks. The supernodal form is forced: it is the faster one from about 600 unknowns on, and the
    /// only one with half solves.
    pub(crate) fn new(pattern: &Columns, block: usize) -> Result<Self, FactorError> {
        debug_assert!(block > 0 && pattern.dim.is_multiple_of(block));
        let (pointers, rows) = quotient(pattern, block);
        let order = minimum_degree(&pointers, &rows)?;
        Self::in_order(
            pattern,
            order.into_iter().flat_map(|b| block * b..block * (b + 1)).collect(),
        )
    }

    /// The same of a lower triangle whose first unknowns come last, in their order.
    pub(crate) fn with_last(pattern: &Columns, last: usize) -> Result<Self, FactorError> {
        let start = pattern.pointers[last];
        let pointers: Vec<usize> = pattern.pointers[last..].iter().map(|p| p - start).collect();
        let rows: Vec<usize> = pattern.rows[start..].iter().map(|row| row - last).collect();
        let order = match pointers.len() {
            1 => Vec::new(),
            _ => minimum_degree(&pointers, &rows)?,
        };
        Self::in_order(pattern, order.into_iter().map(|k| k + last).chain(0..last).collect())
    }

    /// With the old number of each unknown.
    fn in_order(pattern: &Columns, forward: Vec<usize>) -> Result<Self, FactorError> {
        let mut inverse = vec![0; forward.len()];
        for (new, &old) in forward.iter().enumerate() {
            inverse[old] = new;
        }
        let dim = pattern.dim;
        let symbolic = SymbolicSparseColMatRef::new_checked(dim, dim, &pattern.pointers, None, &pattern.rows);
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let order = SymmetricOrdering::Custom(PermRef::new_checked(&forward, &inverse, dim));
        factorize_symbolic_cholesky(symbolic, Side::Lower, order, params)
            .map(|s| Self(Arc::new(s)))
            .map_err(|_| FactorError::Pattern)
    }

    /// Numbers stored for the factor.
    pub(crate) fn stored(&self) -> usize {
        self.0.len_val()
    }

    /// Old number of each unknown.
    pub(crate) fn order(&self) -> Vec<u32> {
        self.old().iter().map(|&k| k as u32).collect()
    }

    /// The same; there is one, for it was given.
    fn old(&self) -> &[usize] {
        self.0.perm().map_or(&[], |permutation| permutation.arrays().0)
    }
}

/// Graph of the blocks of a pattern of full blocks: pointers and neighbours.
pub(crate) fn quotient(pattern: &Columns, block: usize) -> (Vec<usize>, Vec<usize>) {
    let (mut pointers, mut rows) = (vec![0], Vec::new());
    for j in 0..pattern.dim / block {
        // Blocks are full: the first column of each shows all of its neighbours.
        let start = rows.len();
        let (entries, _) = pattern.column(block * j);
        for &i in entries {
            if rows.len() == start || rows[rows.len() - 1] != i / block {
                rows.push(i / block);
            }
        }
        pointers.push(rows.len());
    }
    (pointers, rows)
}

/// Order (new to old) of approximate minimum degree for a pattern given by pointers and rows.
pub(crate) fn minimum_degree(pointers: &[usize], rows: &[usize]) -> Result<Vec<usize>, FactorError> {
    let count = pointers.len() - 1;
    let pattern = SymbolicSparseColMatRef::new_checked(count, count, pointers, None, rows);
    let mut memory = MemBuffer::new(amd::order_maybe_unsorted_scratch::<usize>(count, rows.len()));
    let (mut forward, mut inverse) = (vec![0; count], vec![0; count]);
    amd::order_maybe_unsorted(
        &mut forward,
        &mut inverse,
        pattern,
        Default::default(),
        MemStack::new(&mut memory),
    )
    .map_err(|_| FactorError::Pattern)?;
    Ok(forward)
}

type EachSupernode<'a> = dyn FnMut(Range<usize>, &[usize], &dyn Fn(usize, usize) -> f64) + 'a;

/// A factor `P A P^T = L L^T`.
#[derive(Debug, Clone)]
pub(crate) struct SparseCholesky {
    symbolic: Symbolic,
    values: Vec<f64>,
}

/// Work memory of one thread for solves with a bounded number of columns.
pub(crate) struct SolveMemory {
    memory: MemBuffer,
    /// For packed factors.
    pub(crate) numbers: Vec<f64>,
}

impl std::fmt::Debug for SolveMemory {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let bytes = self.memory.len() + 8 * self.numbers.len();
        write!(f, "SolveMemory({bytes} bytes)")
    }
}

/// Size and alignment of a work memory.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MemoryNeed {
    memory: StackReq,
    numbers: usize,
}

impl MemoryNeed {
    pub(crate) const NONE: Self = Self {
        memory: StackReq::EMPTY,
        numbers: 0,
    };

    /// Memory of a packed factor.
    pub(crate) fn numbers(numbers: usize) -> Self {
        Self { numbers, ..Self::NONE }
    }

    /// Memory that serves both.
    pub(crate) fn or(self, other: Self) -> Self {
        Self {
            memory: self.memory.or(other.memory),
            numbers: self.numbers.max(other.numbers),
        }
    }
}

impl SolveMemory {
    pub(crate) fn new(need: MemoryNeed) -> Self {
        Self {
            memory: MemBuffer::new(need.memory),
            numbers: vec![0.0; need.numbers],
        }
    }

    /// This memory, made anew if it is too small.
    pub(crate) fn at_least(&mut self, need: MemoryNeed) -> &mut Self {
        if self.memory.len() < need.memory.size_bytes() || self.numbers.len() < need.numbers {
            *self = Self::new(need);
        }
        self
    }
}

impl SparseCholesky {
    /// Factorises a matrix with the pattern given to [`Symbolic::new`].
    pub(crate) fn new(symbolic: &Symbolic, matrix: &Columns) -> Result<Self, FactorError> {
        let mut values = vec![0.0; symbolic.0.len_val()];
        let mut memory = MemBuffer::new(
            symbolic
                .0
                .factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default()),
        );
        let pattern =
            SymbolicSparseColMatRef::new_checked(matrix.dim, matrix.dim, &matrix.pointers, None, &matrix.rows);
        symbolic
            .0
            .factorize_numeric_llt(
                &mut values,
                SparseColMatRef::new(pattern, &matrix.values),
                Side::Lower,
                Default::default(),
                Par::Seq,
                MemStack::new(&mut memory),
                Default::default(),
            )
            .map_err(|LltError::NonPositivePivot { index }| FactorError::Pivot(index))?;
        let factor = Self {
            symbolic: symbolic.clone(),
            values,
        };
        match factor.values.iter().position(|v| !v.is_finite()) {
            Some(position) => Err(FactorError::Pivot(position.min(matrix.dim))),
            None => Ok(factor),
        }
    }

    pub(crate) fn dim(&self) -> usize {
        self.symbolic.0.nrows()
    }

    pub(crate) fn stored(&self) -> usize {
        self.values.len()
    }

    pub(crate) fn order(&self) -> Vec<u32> {
        self.symbolic.order()
    }

    /// The groups of columns with one pattern.
    fn supernodes(&self) -> Option<(SupernodalLltRef<'_, usize, f64>, usize)> {
        match self.symbolic.0.raw() {
            SymbolicCholeskyRaw::Supernodal(symbolic) => {
                Some((SupernodalLltRef::new(symbolic, &self.values), symbolic.n_supernodes()))
            }
            SymbolicCholeskyRaw::Simplicial(_) => None,
        }
    }

    /// Smallest and largest squared pivot with the elimination step of the smallest.
    pub(crate) fn pivots(&self) -> (f64, usize, f64) {
        let (mut smallest, mut largest) = ((f64::INFINITY, 0), 0.0_f64);
        self.for_supernodes(&mut |columns, _, value| {
            for (j, column) in columns.enumerate() {
                let pivot = value(j, j) * value(j, j);
                if pivot < smallest.0 {
                    smallest = (pivot, column);
                }
                largest = largest.max(pivot);
            }
        });
        (smallest.0, smallest.1, largest)
    }

    /// Calls `each(columns, rows below them, value)` for every group of columns with one pattern; `value(i, j)` is an
    /// entry of the factor, both counted within the group, rows below the columns after them.
    pub(crate) fn for_supernodes(&self, each: &mut EachSupernode<'_>) {
        let Some((factor, count)) = self.supernodes() else {
            return;
        };
        for s in 0..count {
            let node = factor.supernode(s);
            let block = node.val();
            let columns = node.start()..node.start() + block.ncols();
            each(columns, node.pattern(), &|i, j| block[(i, j)]);
        }
    }

    /// The last `size` rows and columns, lower triangle, zeros above.
    pub(crate) fn corner(&self, size: usize) -> Vec<f64> {
        let (mut out, first) = (vec![0.0; size * size], self.dim() - size);
        self.for_supernodes(&mut |columns, below, value| {
            let rows = || columns.clone().chain(below.iter().copied()).enumerate();
            for (j, column) in columns.clone().enumerate().filter(|(_, column)| *column >= first) {
                for (i, row) in rows().skip(j) {
                    out[row - first + (column - first) * size] = value(i, j);
                }
            }
        });
        out
    }

    /// Work memory that solves with so many columns need.
    pub(crate) fn need(&self, columns: usize) -> MemoryNeed {
        let permuted = StackReq::new::<f64>(self.dim() * columns + 64);
        let solve = self.symbolic.0.solve_in_place_scratch::<f64>(columns, Par::Seq);
        MemoryNeed {
            memory: solve.and(permuted),
            numbers: 0,
        }
    }

    /// Solves `A X = B` in place, column-major, at most as many columns as the memory was made for.
    pub(crate) fn solve(&self, rhs: &mut [f64], columns: usize, memory: &mut SolveMemory) {
        let x = MatMut::from_column_major_slice_mut(rhs, self.dim(), columns);
        LltRef::new(&self.symbolic.0, &self.values).solve_in_place_with_conj(
            Conj::No,
            x,
            Par::Seq,
            MemStack::new(&mut memory.memory),
        );
    }

    /// `out = L^-1 P x`.
    pub(crate) fn half_solve(&self, x: &[f64], out: &mut [f64], memory: &mut SolveMemory) {
        out.iter_mut()
            .zip(self.symbolic.old())
            .for_each(|(o, &old)| *o = x[old]);
        let column = MatMut::from_column_major_slice_mut(out, self.dim(), 1);
        let memory = MemStack::new(&mut memory.memory);
        if let Some((factor, _)) = self.supernodes() {
            factor.l_solve_with_conj(Conj::No, column, Par::Seq, memory);
        }
    }

    /// `out = P^T L^-T y`; `y` is overwritten.
    pub(crate) fn half_solve_transpose(&self, y: &mut [f64], out: &mut [f64], memory: &mut SolveMemory) {
        let column = MatMut::from_column_major_slice_mut(&mut *y, self.dim(), 1);
        let memory = MemStack::new(&mut memory.memory);
        if let Some((factor, _)) = self.supernodes() {
            factor.l_transpose_solve_with_conj(Conj::No, column, Par::Seq, memory);
        }
        y.iter().zip(self.symbolic.old()).for_each(|(&v, &old)| out[old] = v);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn laplacian(n: usize) -> Columns {
        let mut matrix = Columns::empty(n);
        for j in 0..n {
            for i in j.saturating_sub(1)..(j + 2).min(n) {
                matrix.rows.push(i);
                matrix.values.push(if i == j { 2.5 } else { -1.0 });
            }
            matrix.pointers.push(matrix.rows.len());
        }
        matrix
    }

    #[test]
    fn half_solves_compose_to_the_inverse() {
        let a = laplacian(50);
        let factor = SparseCholesky::new(&Symbolic::new(&a, 1).unwrap(), &a).unwrap();
        let mut memory = SolveMemory::new(factor.need(1));
        let b: Vec<f64> = (0..50).map(|i| (i as f64).sin()).collect();
        let mut x = b.clone();
        factor.solve(&mut x, 1, &mut memory);
        let (mut half, mut y) = (vec![0.0; 50], vec![0.0; 50]);
        factor.half_solve(&b, &mut half, &mut memory);
        factor.half_solve_transpose(&mut half, &mut y, &mut memory);
        for j in 0..50 {
            assert!((x[j] - y[j]).abs() < 1e-14);
            let (rows, values) = a.column(j);
            let product: f64 = rows.iter().zip(values).map(|(&i, v)| v * x[i]).sum();
            assert!((product - b[j]).abs() < 1e-13);
        }
        let (small, _, large) = factor.pivots();
        assert!(small > 0.4 && large < 2.5 + 1e-12, "{small} {large}");
    }

    #[test]
    fn indefinite_matrix_is_refused() {
        let mut a = laplacian(5);
        let k = a.find(3, 3).unwrap();
        a.values[k] = -1.0;
        assert!(matches!(
            SparseCholesky::new(&Symbolic::new(&a, 1).unwrap(), &a),
            Err(FactorError::Pivot(_))
        ));
    }
}
