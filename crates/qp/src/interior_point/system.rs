//! The linear equations of one step: the matrix of the problem and what the inequalities add to it.

use faer::Par;
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::mat::{MatMut, MatRef};
use faer::perm::PermRef;

/// A square matrix in some of the components, by columns, then its factors. Not symmetric where radii follow.
pub(crate) struct System {
    /// Its components, and the place of each among them.
    components: Vec<usize>,
    places: Vec<Option<usize>>,
    matrix: Vec<f64>,
    rows: [Vec<usize>; 2],
    memory: MemBuffer,
    x: Vec<f64>,
}

impl System {
    /// Without the fixed components.
    pub(crate) fn new(fixed: &[bool]) -> Self {
        let components: Vec<usize> = (0..fixed.len()).filter(|i| !fixed[*i]).collect();
        let mut places = vec![None; fixed.len()];
        for (place, &i) in components.iter().enumerate() {
            places[i] = Some(place);
        }
        let n = components.len();
        let need = [
            factor::lu_in_place_scratch::<usize, f64>(n, n, Par::Seq, Default::default()),
            solve::solve_in_place_scratch::<usize, f64>(n, 1, Par::Seq),
        ];
        Self {
            components,
            places,
            matrix: vec![0.0; n * n],
            rows: [vec![0; n], vec![0; n]],
            memory: MemBuffer::new(StackReq::any_of(&need)),
            x: vec![0.0; n],
        }
    }

    /// Sets the matrix to that of all components.
    pub(crate) fn set(&mut self, matrix: &[f64]) {
        let n = self.places.len();
        let columns = self.matrix.chunks_exact_mut(self.components.len().max(1));
        for (column, &j) in columns.zip(&self.components) {
            let whole = &matrix[j * n..(j + 1) * n];
            column
                .iter_mut()
                .zip(&self.components)
                .for_each(|(a, &i)| *a = whole[i]);
        }
    }

    pub(crate) fn add(&mut self, row: usize, column: usize, value: f64) {
        if let (Some(row), Some(column)) = (self.places[row], self.places[column]) {
            self.matrix[row + column * self.components.len()] += value;
        }
    }

    pub(crate) fn factor(&mut self) {
        let n = self.components.len();
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

    /// Zero where fixed.
    pub(crate) fn solve(&mut self, x: &mut [f64]) {
        let n = self.components.len();
        self.x
            .iter_mut()
            .zip(&self.components)
            .for_each(|(own, &i)| *own = x[i]);
        let factors = MatRef::from_column_major_slice(&self.matrix, n, n);
        let [rows, back] = &self.rows;
        solve::solve_in_place(
            factors,
            factors,
            PermRef::new_checked(rows, back, n),
            MatMut::from_column_major_slice_mut(&mut self.x, n, 1),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
        x.fill(0.0);
        self.x.iter().zip(&self.components).for_each(|(own, &i)| x[i] = *own);
    }
}
