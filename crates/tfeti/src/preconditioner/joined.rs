//! Groups of many rows in the scaling of preconditioners: contact points whose sides share nodes, as where meshes do
//! not match, join all rows of a surface.
//!
//! Their matrix `B D^-1 B^T` is like a mass matrix of the surface: sparse, and cheap to factor anew for each active
//! set. Rows that the set holds leave it by a large weight on their diagonal, so that its pattern stays.

use crate::error::TfetiError;
use crate::linalg::sparse::{Columns, FactorError, SolveMemory, SparseCholesky, Symbolic};
use crate::rows::gluing::TangentialRows;
use crate::system::tfeti::Tfeti;
use crate::tolerances::{DEPENDENT_JOINED, HELD_ROWS};
use signorini_qp::active_set::{ActiveSetView, Freedom};
use std::collections::HashMap;

/// The rows of all such groups and their matrix.
#[derive(Debug)]
pub(super) struct JoinedGroups {
    rows: Vec<u32>,
    /// Place of each contact row.
    places: HashMap<u32, usize>,
    matrix: Columns,
    factor: SparseCholesky,
    symbolic: Symbolic,
}

/// The factor for an active set, and work memory.
#[derive(Debug)]
pub(super) struct JoinedScratch {
    /// `None` for the factor of all rows.
    factor: Option<SparseCholesky>,
    /// What that holds.
    held: Vec<(usize, Freedom)>,
    memory: SolveMemory,
    column: Vec<f64>,
}

/// A row of `B` by places in the torn displacement.
pub(super) fn torn_entries(system: &Tfeti, row: usize) -> Vec<(usize, f64)> {
    let entries = system.gluing().row(row).into_iter();
    entries
        .map(|(s, dof, v)| (system.torn_range(s).start + dof, v))
        .collect()
}

impl JoinedGroups {
    /// The matrix of these rows with `compliance` of each torn node, and what contact rows give way.
    pub(super) fn new(
        system: &Tfeti,
        rows: Vec<u32>,
        compliance: &[f64],
        gives_way: &HashMap<usize, f64>,
    ) -> Result<Self, TfetiError> {
        let gluing = system.gluing();
        let places: HashMap<u32, usize> = rows.iter().enumerate().map(|(k, &row)| (row, k)).collect();
        let entries: Vec<_> = rows.iter().map(|&row| torn_entries(system, row as usize)).collect();
        let mut pairs = HashMap::new();
        for contact in gluing.contact() {
            if let TangentialRows::Disc { row, .. } = contact.tangential
                && let [Some(&a), Some(&b)] = [row, row + 1].map(|r| places.get(&(r as u32)))
            {
                pairs.extend([(a, b), (b, a)]);
            }
        }
        // the other row of a disc, even where they do not meet: an active set couples them
        let mut matrix = Columns::gram(&entries, |dof| compliance[dof / 3], |k| pairs.get(&k).copied());
        for (k, &row) in rows.iter().enumerate() {
            let dependent = gluing.node(row as usize).is_some_and(|n| gluing.is_dependent(n));
            if let Some(diagonal) = matrix.find(k, k).filter(|_| dependent) {
                matrix.values[diagonal] *= 1.0 + DEPENDENT_JOINED;
            }
            if let (Some(own), Some(diagonal)) = (gives_way.get(&(row as usize)), matrix.find(k, k)) {
                matrix.values[diagonal] += own;
            }
        }
        let node = |k: usize| gluing.node(rows[k.min(rows.len() - 1)] as usize).unwrap_or_default();
        let dependent = |error| match error {
            FactorError::Pivot(k) => TfetiError::DependentRows { node: node(k) },
            FactorError::Pattern => TfetiError::TooLarge {
                what: "rows of contact points that share nodes",
                count: rows.len(),
            },
        };
        let symbolic = Symbolic::new(&matrix, 1).map_err(dependent)?;
        let factor = SparseCholesky::new(&symbolic, &matrix).map_err(dependent)?;
        Ok(Self {
            rows,
            places,
            matrix,
            factor,
            symbolic,
        })
    }

    pub(super) fn scratch(&self) -> JoinedScratch {
        JoinedScratch {
            factor: None,
            held: Vec::new(),
            memory: SolveMemory::new(self.factor.need(1)),
            column: vec![0.0; self.rows.len()],
        }
    }

    /// Factors the matrix without the directions that an active set holds.
    pub(super) fn on_active_set(&self, view: &ActiveSetView<'_>, s: &mut JoinedScratch) {
        let place = |row: usize| self.places.get(&(row as u32)).copied();
        let mut held = Vec::new();
        view.for_each(|row, count, freedom| match freedom {
            Freedom::Free => {}
            Freedom::Held => held.extend((row..row + count).map(|row| (row, freedom))),
            Freedom::Along(_) => held.push((row, freedom)),
        });
        if held == s.held {
            return;
        }
        let mut matrix = self.matrix.clone();
        let mut hold = |direction: &[(usize, f64)]| {
            let size = direction.iter().map(|d| self.matrix.diagonal(d.0)).fold(0.0, f64::max);
            for &(i, a) in direction {
                for &(j, b) in direction {
                    if let Some(k) = matrix.find(i, j) {
                        matrix.values[k] += HELD_ROWS * size * a * b;
                    }
                }
            }
        };
        for &(row, freedom) in &held {
            match (freedom, place(row)) {
                (Freedom::Held, Some(k)) => hold(&[(k, 1.0)]),
                (Freedom::Along(tau), Some(i)) => {
                    if let Some(j) = place(row + 1) {
                        hold(&[(i, -tau[1]), (j, tau[0])]);
                    }
                }
                _ => {}
            }
        }
        s.held = held;
        // adding to the diagonal cannot make the matrix singular
        s.factor = SparseCholesky::new(&self.symbolic, &matrix).ok();
    }

    /// Writes the rows of `y = N x`.
    pub(super) fn solve(&self, x: &[f64], y: &mut [f64], s: &mut JoinedScratch) {
        for (value, &row) in s.column.iter_mut().zip(&self.rows) {
            *value = x[row as usize];
        }
        let factor = s.factor.as_ref().unwrap_or(&self.factor);
        factor.solve(&mut s.column, 1, &mut s.memory);
        for (value, &row) in s.column.iter().zip(&self.rows) {
            y[row as usize] = *value;
        }
    }
}
