//! What springs change in a preconditioner of `F + C`.
//!
//! The product with the stiffness `k` of its node makes `s² k` of the row of a spring, of length `s`; its
//! `factor` makes the inverse of `F + C` of it. Where contact may take the place of a spring its row
//! depends on others, on which that product vanishes: there `1 / c` is added. The scaling of copies knows springs by
//! itself.

use crate::system::tfeti::Tfeti;
use std::collections::HashSet;

/// The rows of springs, which are the last ones.
#[derive(Debug)]
pub(super) struct Springs {
    first: usize,
    /// By row; empty without springs.
    pub(super) factors: Vec<f64>,
    /// Rows at contact nodes, with the inverse of their compliance, N/m.
    alone: Vec<(usize, f64)>,
}

impl Springs {
    /// None where rows are `scaled` by what copies of a node are worth.
    pub(super) fn new(system: &Tfeti, scaled: bool) -> Self {
        let gluing = system.gluing();
        let springs = if scaled { &[] } else { gluing.springs() };
        let copies = |row: usize| gluing.row(row).into_iter().map(|(s, dof, _)| (s, dof / 3));
        let touching: HashSet<(usize, usize)> = match springs {
            [] => HashSet::new(),
            _ => gluing.ranges().contact().flat_map(copies).collect(),
        };
        let rows = gluing.spring_rows().zip(springs);
        let alone = rows.filter(|(row, _)| copies(*row).any(|copy| touching.contains(&copy)));
        Self {
            first: gluing.spring_rows().start,
            factors: springs.iter().map(|spring| spring.factor).collect(),
            alone: alone.map(|(row, spring)| (row, 1.0 / spring.compliance)).collect(),
        }
    }

    pub(super) fn scale(&self, x: &mut [f64]) {
        let rows = x[self.first..].iter_mut().zip(&self.factors);
        rows.for_each(|(x, factor)| *x *= factor);
    }

    pub(super) fn add_alone(&self, x: &[f64], y: &mut [f64]) {
        self.alone.iter().for_each(|&(row, k)| y[row] += k * x[row]);
    }
}
