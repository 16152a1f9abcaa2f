//! Bodies that nothing joins, and sizes of their own.
//!
//! Bodies that may touch each other count as one here, and so do parts that hinges join. An obstacle is rigid, so the others know
//! nothing of each other: a scene with several is several problems in one. Norms over
//! all of them would let the heaviest alone decide when the others are done. Every body therefore gets a unit of force: the
//! problem of a level is solved with forces and displacements of each body divided by it. The conditions are homogeneous,
//! so that only data change (`d`, `e`, given slip bounds), operators do not; units are powers of two, so that no digit changes.

use crate::discrete::ContactPoint;
use signorini_fem_mesh::{Decomposition, DisjointSets};
use signorini_tfeti::Tfeti;

/// To which body rows and subdomains belong. With one body there are no tables.
#[derive(Debug, Default)]
pub(crate) struct Bodies {
    count: usize,
    rows: Vec<u32>,
    subdomains: Vec<u32>,
    /// Number here of each body of the coarse space.
    numbers: Vec<u32>,
}

impl Bodies {
    pub(crate) fn new(
        tfeti: &Tfeti,
        decomposition: &Decomposition,
        candidates: &[ContactPoint],
    ) -> Self {
        let (coarse, gluing) = (tfeti.coarse(), tfeti.gluing());
        let numbers = joined(tfeti, decomposition, candidates);
        let count = numbers.iter().max().map_or(0, |last| *last as usize + 1);
        if count <= 1 {
            return Self {
                count,
                ..Self::default()
            };
        }
        let number = |body: &u32| numbers[*body as usize];
        let subdomains: Vec<u32> = coarse.body_of().iter().map(number).collect();
        let body = |row| {
            let entries = gluing.row(row);
            entries.first().map_or(0, |entry| subdomains[entry.0])
        };
        Self {
            count,
            rows: (0..tfeti.dual_dim()).map(body).collect(),
            subdomains,
            numbers,
        }
    }

    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// Body of a row.
    pub(crate) fn of_row(&self, row: usize) -> usize {
        self.rows.get(row).map_or(0, |b| *b as usize)
    }

    /// Body of a subdomain.
    pub(crate) fn of_subdomain(&self, subdomain: usize) -> usize {
        self.subdomains.get(subdomain).map_or(0, |b| *b as usize)
    }

    /// Number here of a body of the coarse space.
    pub(crate) fn of_body(&self, body: usize) -> usize {
        self.numbers.get(body).map_or(0, |b| *b as usize)
    }

    /// Adds the squares of the rows in a range to those of their bodies.
    pub(crate) fn add_squares(&self, x: &[f64], rows: std::ops::Range<usize>, out: &mut [f64]) {
        for row in rows {
            out[self.of_row(row)] += x[row] * x[row];
        }
    }
}

/// A number for each body of the coarse space: the same for those that may touch each other.
fn joined(tfeti: &Tfeti, decomposition: &Decomposition, candidates: &[ContactPoint]) -> Vec<u32> {
    let coarse = tfeti.coarse();
    let mut sets = DisjointSets::new(coarse.bodies());
    let body = |node: u32| {
        let copy = decomposition.copies(node as usize)[0];
        coarse.body_of()[copy.subdomain as usize] as usize
    };
    for (node, partner) in candidates.iter().filter_map(|c| Some((c.node, c.partner?))) {
        sets.join(body(node), body(partner));
    }
    sets.numbers()
}
