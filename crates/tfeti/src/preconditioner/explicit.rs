//! The inverse of `F` on an active set, for systems of so few contact rows that `F` can be formed.
//!
//! Each subdomain adds what it answers to its rows. `H = F + w Gᵀ G` is definite; with a large `w` its inverse is that
//! of `F` where `G x = 0`. Rows that share no subdomain have a zero in it: those that no active set takes away, most of
//! all the gluing, are eliminated once by a sparse factor. The Schur complement of the contact rows is factored on each
//! set. A body that bends far more easily than it is pressed in (a plate on a floor) leaves no other choice: on part of
//! its contact rows the stiffness of their nodes is nowhere near an inverse.

use crate::coarse::space::Coarse;
use crate::dual::part::RowPart;
use crate::linalg::dense;
use crate::linalg::sparse::{SolveMemory, SparseCholesky, Symbolic};
use crate::system::part::SystemPart;
use crate::system::tfeti::Tfeti;
use crate::tolerances::{
    BALANCED, BALANCES, EXPLICIT_SETS, EXPLICIT_WEIGHT, INTERIOR_FACTORS, LEFT_OF_ROW, ROW_OPERATIONS, SECANT, SHIFTS,
    STREAMED, UNBALANCED,
};
use signorini_qp::active_set::{ActiveSetPreconditioner, ActiveSetView, Freedom};
use signorini_qp::{DenseOperator, QpError, Status, SymmetricOperator, vector};
use std::sync::Arc;

/// A direction of a contact row, or of two that make a disc: rows and components.
type Direction = [(usize, f64); 2];

/// A preconditioner for `F` that is nearly its inverse on the kernel of `G`, on each active set.
#[derive(Debug)]
pub struct ExplicitInverse {
    /// Factor of `H` with a multiple of the identity in the contact rows, which come last.
    factor: SparseCholesky,
    /// Its rows and columns of these, lower triangle.
    corner: Vec<f64>,
    /// The Schur complement of the contact rows, lower triangle.
    schur: Vec<f64>,
    rows: usize,
    contact: usize,
    /// `w`.
    weight: f64,
    /// Where vectors are parts.
    part: Option<Arc<RowPart>>,
}

/// Work memory of an [`ExplicitInverse`].
#[derive(Debug)]
pub struct ExplicitScratch {
    /// Those of the contact rows that are free on the active set; before the first one all are.
    directions: Vec<Direction>,
    /// What the method adds to the diagonal.
    added: Vec<f64>,
    /// Factor of the Schur complement in them.
    factor: Vec<f64>,
    whole: Vec<f64>,
    reduced: Vec<f64>,
    others: OthersScratch,
}

/// Work memory for the rows behind the contact rows.
#[derive(Debug)]
struct OthersScratch {
    memory: SolveMemory,
    /// In the order of the factor.
    half: Vec<f64>,
    contact: Vec<f64>,
}

/// What steps with a formed `F` cost, in products of a solve; the same for any number of processes.
#[doc(hidden)]
#[derive(Debug, Clone, Copy)]
pub struct ExplicitCost {
    /// Of forming and factoring it.
    pub forming: usize,
    /// In memory at once.
    pub bytes: u64,
    solves: f64,
    /// Of a dense factor of a row.
    factor: f64,
}

impl ExplicitCost {
    /// Of a step in which so many contact rows carry something.
    #[must_use]
    pub fn step(&self, carrying: usize) -> usize {
        (self.solves + EXPLICIT_SETS * self.factor * (carrying as f64).powi(3)) as usize
    }

    /// Of interior points there.
    #[must_use]
    pub fn inside(&self, carrying: usize) -> usize {
        // with as many operations for the matrix
        (2.0 * INTERIOR_FACTORS * self.factor * (carrying as f64).powi(3)) as usize
    }
}

impl Tfeti {
    /// `None` where there are too many rows, or unknowns on the boundary of a subdomain.
    #[doc(hidden)]
    pub fn explicit_cost(&self) -> Option<ExplicitCost> {
        let (size, bytes) = self.dual().formed_size()?;
        let own: f64 = STREAMED * self.gather(self.dual().flops() as f64).ok()?.iter().sum::<f64>();
        let [n, parts] = [self.dual_dim(), self.subdomains().max(1)].map(|n| n as f64);
        // with what belongs to a product in a solve: projectors, preconditioner, sums
        let product = (own + ROW_OPERATIONS * n).max(1.0);
        // a column is what two subdomains answer
        let columns = 2.0 * n / parts * own;
        let solve = 4.0 * size.stored + 4.0 * size.contact.powi(2);
        Some(ExplicitCost {
            forming: ((columns + size.flops + size.contact.powi(3)) / product) as usize,
            bytes,
            // of active sets, with three solves each
            solves: EXPLICIT_SETS * 3.0 * solve / product,
            factor: 1.0 / (3.0 * product),
        })
    }

    /// Forms `F` and eliminates the rows behind the contact rows. `None` if rounding leaves it indefinite.
    pub fn explicit_inverse(&self) -> Option<ExplicitInverse> {
        let (rows, contact) = (self.dual_dim(), self.gluing().ranges().contact().end);
        let mut formed = self.dual().formed(EXPLICIT_WEIGHT);
        let size = formed.largest(0..rows);
        formed.shift(0..rows, SHIFTS[0] * size);
        // contact rows may depend on one another: for the time of the factor they do not
        let own = formed.largest(0..contact);
        formed.shift(0..contact, own);
        let symbolic = Symbolic::with_last(&formed.matrix, contact).ok()?;
        let factor = SparseCholesky::new(&symbolic, &formed.matrix).ok()?;
        let corner = factor.corner(contact);
        let mut schur = vec![0.0; contact * contact];
        dense::add_square(&mut schur, 1.0, &corner, contact, contact);
        schur.iter_mut().step_by(contact + 1).for_each(|v| *v -= own);
        Some(ExplicitInverse {
            factor,
            corner,
            schur,
            rows,
            contact,
            weight: formed.weight,
            part: None,
        })
    }
}

/// What was aimed at last, and what was lacking; changes of both, those of what was lacking orthonormal.
#[derive(Default)]
struct Secants {
    last: Option<[Vec<f64>; 2]>,
    changes: Vec<[Vec<f64>; 2]>,
}

impl Secants {
    /// Moves `aim` to where nothing is lacking as far as changes tell, and by the rest of what is.
    fn advance(&mut self, aim: &mut [f64], lacks: &[f64]) {
        let now = [aim.to_vec(), lacks.to_vec()];
        if let Some([mut aims, mut change]) = self.last.take() {
            vector::axpby(1.0, &now[0], -1.0, &mut aims);
            vector::axpby(1.0, &now[1], -1.0, &mut change);
            let whole = vector::norm(&change);
            self.take(&mut aims, &mut change);
            let length = vector::norm(&change);
            if length > SECANT * whole {
                vector::scale(length.recip(), &mut aims);
                vector::scale(length.recip(), &mut change);
                self.changes.push([aims, change]);
            }
        }
        self.last = Some(now);
        let mut rest = lacks.to_vec();
        self.take(aim, &mut rest);
        vector::axpy(1.0, &rest, aim);
    }

    /// Takes the part of the changes out of `lacks`, and what led to it from `aims`.
    fn take(&self, aims: &mut [f64], lacks: &mut [f64]) {
        for [aim, lack] in &self.changes {
            let part = vector::dot(lack, lacks);
            vector::axpy(-part, lack, lacks);
            vector::axpy(-part, aim, aims);
        }
    }
}

fn alone(row: usize) -> Direction {
    [(row, 1.0), (row, 0.0)]
}

fn largest_diagonal(matrix: &[f64], size: usize) -> f64 {
    matrix.iter().step_by(size + 1).copied().fold(0.0, f64::max)
}

/// Adds a multiple of the largest entry to the diagonal.
fn shift_diagonal(matrix: &mut [f64], size: usize, shift: f64) {
    let added = shift * largest_diagonal(matrix, size);
    matrix.iter_mut().step_by(size + 1).for_each(|v| *v += added);
}

impl ExplicitInverse {
    /// The same for vectors of which each rank keeps a part.
    #[doc(hidden)]
    #[must_use]
    pub fn of_part(self, part: &SystemPart) -> Self {
        let part = Some(part.rows.clone());
        Self { part, ..self }
    }

    /// Solves `F x = linear` with `G x = e` where a `solve` finds the contact rows from those of `x`: it has their
    /// matrix and load, all other rows eliminated. It is asked again, with another load, until `G x = e` holds, which
    /// the weight leaves to do (method of multipliers with secants: where all of a body's friction is spent, hardly
    /// anything but that load holds the body), a few times at most, from where the last time ended whether that was a
    /// solution or not. For whole vectors. `x` is that which lacks the least, a solution if there was one; its rigid
    /// amplitudes then.
    ///
    /// # Errors
    /// Those of `solve`, and [`QpError`] for a matrix that has overflowed.
    #[doc(hidden)]
    pub fn through_contact(
        &self,
        coarse: &Coarse,
        (linear, e): (&[f64], &[f64]),
        x: &mut [f64],
        mut solve: impl FnMut(&DenseOperator, &[f64], &mut [f64]) -> Result<Status, QpError>,
    ) -> Result<Option<Vec<f64>>, QpError> {
        let mut matrix = self.schur.clone();
        dense::mirror_lower(&mut matrix, self.contact);
        let matrix = DenseOperator::new(self.contact, matrix)?;
        let (mut aim, mut lacks) = (e.to_vec(), vec![0.0; e.len()]);
        let (mut load, mut scratch) = (vec![0.0; self.rows], (coarse.scratch(), self.others_scratch()));
        let mut secants = Secants::default();
        let (mut solved, mut best, mut least, mut waited) = (false, [Vec::new(), Vec::new()], f64::INFINITY, 0);
        for _ in 0..BALANCES {
            coarse.transpose_times(&aim, &mut load);
            for (load, linear) in load.iter_mut().zip(linear) {
                *load = linear + self.weight * *load;
            }
            self.forward(&mut load, &mut scratch.1);
            let own = &mut x[..self.contact];
            let found = solve(&matrix, &load[..self.contact], own)? == Status::Converged;
            if !vector::norm(own).is_finite() {
                break;
            }
            self.backward(x, &mut scratch.1);
            coarse.apply(x, &mut lacks, &mut scratch.0);
            lacks.iter_mut().zip(e).for_each(|(lacks, e)| *lacks = e - *lacks);
            let lack = vector::norm(&lacks) / vector::norm(x).max(f64::MIN_POSITIVE);
            waited += 1;
            let better = if found == solved { lack < least } else { found };
            if better {
                (solved, least, waited) = (found, lack, 0);
                // of `F x - linear + Gᵀ alpha`
                let alpha = lacks.iter().zip(e).zip(&aim);
                let alpha = alpha.map(|((lack, e), aim)| self.weight * (e - lack - aim)).collect();
                best = [x.to_vec(), alpha];
            }
            if lack <= BALANCED || waited == UNBALANCED {
                break;
            }
            secants.advance(&mut aim, &lacks);
        }
        let [best, alpha] = best;
        if !best.is_empty() {
            x.copy_from_slice(&best);
        }
        Ok(solved.then_some(alpha))
    }

    /// The Schur complement in some directions, lower triangle, with a multiple of its largest entry on the diagonal.
    fn reduce(&self, (directions, added): (&[Direction], &[f64]), shift: f64, out: &mut Vec<f64>) {
        let entry = |i: usize, j: usize| self.schur[i.max(j) + i.min(j) * self.contact];
        let size = directions.len();
        out.clear();
        out.resize(size * size, 0.0);
        for (j, b) in directions.iter().enumerate() {
            for (i, a) in directions.iter().enumerate().skip(j) {
                let products = a.iter().flat_map(|a| b.iter().map(move |b| (a, b)));
                out[i + j * size] = products.map(|(a, b)| a.1 * b.1 * entry(a.0, b.0)).sum();
            }
            out[j * (size + 1)] += b.iter().map(|b| b.1 * b.1 * added[b.0]).sum::<f64>();
        }
        shift_diagonal(out, size, shift);
    }

    /// The factor for the directions and what is added.
    fn factor(&self, s: &mut ExplicitScratch) {
        let size = s.directions.len();
        // rows may depend on one another
        for shift in SHIFTS {
            self.reduce((&s.directions, &s.added), shift, &mut s.factor);
            let least = LEFT_OF_ROW * largest_diagonal(&s.factor, size);
            if dense::cholesky(&mut s.factor, size, least).is_ok() {
                return;
            }
        }
        s.directions.clear();
        s.factor.clear();
    }

    fn others_scratch(&self) -> OthersScratch {
        OthersScratch {
            memory: SolveMemory::new(self.factor.need(1)),
            half: vec![0.0; self.rows],
            contact: vec![0.0; self.contact],
        }
    }

    /// Eliminates the rows behind the contact rows, whose load then takes in theirs.
    fn forward(&self, x: &mut [f64], s: &mut OthersScratch) {
        self.factor.half_solve(x, &mut s.half, &mut s.memory);
        let own = &s.half[self.rows - self.contact..];
        x[..self.contact].fill(0.0);
        for (j, value) in own.iter().enumerate() {
            let column = &self.corner[j * (self.contact + 1)..(j + 1) * self.contact];
            vector::axpy(*value, column, &mut x[j..self.contact]);
        }
    }

    /// The rows behind the contact rows from those, after [`forward`](Self::forward).
    fn backward(&self, x: &mut [f64], s: &mut OthersScratch) {
        s.contact.copy_from_slice(&x[..self.contact]);
        let contact = &s.contact;
        let own = &mut s.half[self.rows - self.contact..];
        for (j, value) in own.iter_mut().enumerate() {
            let column = &self.corner[j * (self.contact + 1)..(j + 1) * self.contact];
            *value = vector::dot(column, &contact[j..]);
        }
        self.factor.half_solve_transpose(&mut s.half, x, &mut s.memory);
        x[..self.contact].copy_from_slice(contact);
    }

    fn solve(&self, x: &mut [f64], s: &mut ExplicitScratch) {
        self.forward(x, &mut s.others);
        let (size, contact) = (s.directions.len(), &mut x[..self.contact]);
        let along = |direction: &Direction| direction.iter().map(|(row, v)| v * contact[*row]).sum::<f64>();
        s.reduced.clear();
        s.reduced.extend(s.directions.iter().map(along));
        dense::forward(&s.factor, size, size, &mut s.reduced);
        dense::backward(&s.factor, size, size, &mut s.reduced);
        contact.fill(0.0);
        for (direction, value) in s.directions.iter().zip(&s.reduced) {
            direction.iter().for_each(|(row, v)| contact[*row] += v * value);
        }
        self.backward(x, &mut s.others);
    }
}

impl SymmetricOperator for ExplicitInverse {
    type Scratch = ExplicitScratch;

    fn dim(&self) -> usize {
        self.part.as_ref().map_or(self.rows, |part| part.len())
    }

    fn scratch(&self) -> ExplicitScratch {
        let mut scratch = ExplicitScratch {
            directions: (0..self.contact).map(alone).collect(),
            added: vec![0.0; self.contact],
            factor: Vec::new(),
            whole: vec![0.0; if self.part.is_some() { self.rows } else { 0 }],
            reduced: Vec::new(),
            others: self.others_scratch(),
        };
        self.factor(&mut scratch);
        scratch
    }

    fn apply(&self, x: &[f64], y: &mut [f64], s: &mut ExplicitScratch) {
        let Some(part) = &self.part else {
            y.copy_from_slice(x);
            return self.solve(y, s);
        };
        let mut whole = std::mem::take(&mut s.whole);
        part.complete(x, &mut whole);
        self.solve(&mut whole, s);
        y.copy_from_slice(&part.take(&whole));
        s.whole = whole;
    }
}

impl ActiveSetPreconditioner for ExplicitInverse {
    fn knows_added(&self) -> bool {
        true
    }

    fn enter(&self, view: &ActiveSetView<'_>, s: &mut ExplicitScratch) {
        let (directions, mut next) = (&mut s.directions, 0);
        directions.clear();
        view.for_each(|row, count, freedom| {
            directions.extend((next..row).map(alone));
            next = row + count;
            match freedom {
                Freedom::Held => {}
                Freedom::Free => directions.extend((row..next).map(alone)),
                Freedom::Along(tau) => directions.push([(row, tau[0]), (row + 1, tau[1])]),
            }
        });
        directions.extend((next..self.contact).map(alone));
        s.added.fill(0.0);
        view.for_each_added(|row, value| s.added[row] += value);
        self.factor(s);
    }
}
