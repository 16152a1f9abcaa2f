//! The linear equations of one step: the matrix of the problem and what the inequalities add to it.

use faer::Par;
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::mat::{MatMut, MatRef};
use faer::perm::PermRef;

/// A square matrix by columns, then its factors. Not symmetric where radii follow.
pub(crate) struct System {
    n: usize,
    matrix: Vec<f64>,
    rows: [Vec<usize>; 2],
    memory: MemBuffer,
}

impl System {
    pub(crate) fn new(n: usize) -> Self {
        let need = [
            factor::lu_in_place_scratch::<usize, f64>(n, n, Par::Seq, Default::default()),
            solve::solve_in_place_scratch::<usize, f64>(n, 1, Par::Seq),
        ];
        Self {
            n,
            matrix: vec![0.0; n * n],
            rows: [vec![0; n], vec![0; n]],
            memory: MemBuffer::new(StackReq::any_of(&need)),
        }
    }

    /// Sets the matrix to a symmetric one.
    pub(crate) fn set(&mut self, matrix: &[f64]) {
        self.matrix.copy_from_slice(matrix);
    }

    pub(crate) fn add(&mut self, row: usize, column: usize, value: f64) {
        self.matrix[row + column * self.n] += value;
    }

    /// Leaves of a row and its column the diagonal only.
    pub(crate) fn decouple(&mut self, at: usize) {
        for other in 0..self.n {
            if other != at {
                self.matrix[at + other * self.n] = 0.0;
                self.matrix[other + at * self.n] = 0.0;
            }
        }
    }

    pub(crate) fn factor(&mut self) {
        let n = self.n;
        let [rows, back] = &mut self.rows;
        factor::lu_in_place(
            MatMut::from_column_major_slice_mut(&mut self.matrix, n, n),
            rows,
            back,
            Par::Seq,
            MemStack::new(&mut self.memory),
            Default::default(),
        );
    }

    pub(crate) fn solve(&mut self, x: &mut [f64]) {
        let n = self.n;
        let factors = MatRef::from_column_major_slice(&self.matrix, n, n);
        let [rows, back] = &self.rows;
        solve::solve_in_place(
            factors,
            factors,
            PermRef::new_checked(rows, back, n),
            MatMut::from_column_major_slice_mut(x, n, 1),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
    }
}
