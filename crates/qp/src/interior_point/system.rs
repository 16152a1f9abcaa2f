//! The linear equations of one step: the matrix of the problem and what the inequalities add to it.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_unit_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::mat::{MatMut, MatRef};
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{Accum, Par};
use rayon::prelude::*;

/// Columns of a panel, which one thread factors and all threads take from the columns behind it.
const PANEL: usize = 64;

/// A square matrix in some of the components, by columns, then its factors. Not symmetric where radii follow. The same
/// bits on any number of threads: each panel is the work of one at a time.
pub(crate) struct System {
    /// Its components, and the place of each among them.
    components: Vec<usize>,
    places: Vec<Option<usize>>,
    matrix: Vec<f64>,
    /// For each panel the rows that it moves, to and from. Panels before it keep theirs.
    moved: Vec<Vec<[usize; 2]>>,
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
        let need = lu_in_place_scratch::<usize, f64>(n, PANEL.min(n), Par::Seq, Default::default());
        Self {
            components,
            places,
            matrix: vec![0.0; n * n],
            moved: vec![Vec::new(); n.div_ceil(PANEL)],
            rows: [vec![0; n], vec![0; n]],
            memory: MemBuffer::new(need),
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
        let mut behind = &mut self.matrix[..];
        for (k, moved) in self.moved.iter_mut().enumerate() {
            let first = k * PANEL;
            let width = PANEL.min(n - first);
            let (panel, rest) = behind.split_at_mut(width * n);
            behind = rest;
            let [rows, back] = self.rows.each_mut().map(|rows| &mut rows[first..]);
            lu_in_place(
                MatMut::from_column_major_slice_mut(panel, n, width).subrows_mut(first, n - first),
                rows,
                back,
                Par::Seq,
                MemStack::new(&mut self.memory),
                Default::default(),
            );
            let at = |(to, from): (usize, &usize)| [first + to, first + from];
            moved.clear();
            moved.extend(rows.iter().enumerate().map(at).filter(|[to, from]| to != from));
            let panel = Panel::new(panel, n, first, moved);
            behind
                .par_chunks_mut(PANEL * n)
                .for_each(|columns| panel.take_from(columns));
        }
    }

    /// Zero where fixed.
    pub(crate) fn solve(&mut self, x: &mut [f64]) {
        let n = self.components.len();
        self.x
            .iter_mut()
            .zip(&self.components)
            .for_each(|(own, &i)| *own = x[i]);
        let columns = self.matrix.chunks(PANEL * n.max(1)).zip(&self.moved).enumerate();
        let panels: Vec<Panel<'_>> = columns
            .map(|(k, (columns, moved))| Panel::new(columns, n, k * PANEL, moved))
            .collect();
        panels.iter().for_each(|panel| panel.take_from(&mut self.x));
        panels.iter().rev().for_each(|panel| panel.substitute(&mut self.x));
        x.fill(0.0);
        self.x.iter().zip(&self.components).for_each(|(own, &i)| x[i] = *own);
    }
}

/// Factored columns from the `first` one on.
struct Panel<'a> {
    columns: MatRef<'a, f64>,
    first: usize,
    moved: &'a [[usize; 2]],
}

impl<'a> Panel<'a> {
    fn new(columns: &'a [f64], n: usize, first: usize, moved: &'a [[usize; 2]]) -> Self {
        let columns = MatRef::from_column_major_slice(columns, n, columns.len() / n);
        Self { columns, first, moved }
    }

    /// The square on the diagonal, with what is above and below it.
    fn parts(&self) -> [MatRef<'a, f64>; 3] {
        let (above, rest) = self.columns.split_at_row(self.first);
        let (square, below) = rest.split_at_row(self.columns.ncols());
        [above, square, below]
    }

    /// A step of elimination in other columns.
    fn take_from(&self, columns: &mut [f64]) {
        let n = self.columns.nrows();
        let mut held = Vec::with_capacity(self.moved.len());
        for column in columns.chunks_exact_mut(n) {
            held.clear();
            held.extend(self.moved.iter().map(|[_, from]| column[*from]));
            for (held, [to, _]) in held.iter().zip(self.moved) {
                column[*to] = *held;
            }
        }
        let width = columns.len() / n;
        let [_, square, below] = self.parts();
        let columns = MatMut::from_column_major_slice_mut(columns, n, width);
        let (mut at, below_it) = columns
            .subrows_mut(self.first, n - self.first)
            .split_at_row_mut(square.ncols());
        solve_unit_lower_triangular_in_place(square, at.rb_mut(), Par::Seq);
        matmul(below_it, Accum::Add, below, at.rb(), -1.0, Par::Seq);
    }

    /// A step back, in one column.
    fn substitute(&self, x: &mut [f64]) {
        let n = x.len();
        let [above, square, _] = self.parts();
        let (above_it, rest) = MatMut::from_column_major_slice_mut(x, n, 1).split_at_row_mut(self.first);
        let mut at = rest.subrows_mut(0, square.ncols());
        solve_upper_triangular_in_place(square, at.rb_mut(), Par::Seq);
        matmul(above_it, Accum::Add, above, at.rb(), -1.0, Par::Seq);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three panels with a component left out, whose first pivots vanish; the same bits on one and more threads.
    #[test]
    fn systems_of_several_panels_are_solved() {
        let n = 2 * PANEL + 20;
        let entry = |i: usize, j: usize| {
            let wave = ((1 + i * n + j) as f64 * 0.7).sin();
            if i == j { 0.0 } else { wave }
        };
        let whole: Vec<f64> = (0..n * n).map(|k| entry(k % n, k / n)).collect();
        let fixed: Vec<bool> = (0..n).map(|i| i == 3).collect();
        let exact: Vec<f64> = (0..n).map(|i| if fixed[i] { 0.0 } else { (i as f64).cos() }).collect();
        let load: Vec<f64> = (0..n).map(|i| (0..n).map(|j| entry(i, j) * exact[j]).sum()).collect();
        let solved = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .expect("a pool");
            pool.install(|| {
                let mut system = System::new(&fixed);
                system.set(&whole);
                system.factor();
                let mut x = load.clone();
                system.solve(&mut x);
                x
            })
        };
        let x = solved(1);
        assert_eq!(x, solved(3));
        let off = x.iter().zip(&exact).fold(0.0_f64, |off, (x, e)| off.max((x - e).abs()));
        assert!(off < 1e-9, "{off}");
    }
}
