//! Which bodies can touch each other, and to which of them rows and subdomains belong.
//!
//! Bodies that may touch each other count as one here, and so do parts that hinges or equations join. An obstacle is
//! rigid, so the others know nothing of each other: a scene with several is several problems in one, and norms over all
//! of them would let the heaviest alone decide when the others are done.

use crate::discrete::DiscreteScene;
use signorini_fem_mesh::internal::{DisjointSets, count_of};
use signorini_qp::vector;
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
    pub(super) fn new(tfeti: &Tfeti, discrete: &DiscreteScene) -> Self {
        let (coarse, gluing) = (tfeti.coarse(), tfeti.gluing());
        let numbers = joined(tfeti, discrete);
        let count = count_of(&numbers);
        if count <= 1 {
            return Self {
                count,
                ..Self::default()
            };
        }
        let number = |body: &u32| numbers[*body as usize];
        let subdomains: Vec<u32> = coarse.body_of().iter().map(number).collect();
        let body = |row| gluing.row(row).first().map_or(0, |entry| subdomains[entry.0]);
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

    /// The squares of a torn vector, summed over the subdomains of each body.
    pub(crate) fn torn_squares(&self, tfeti: &Tfeti, x: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.count.max(1)];
        for subdomain in 0..tfeti.subdomains() {
            let own = &x[tfeti.torn_range(subdomain)];
            out[self.of_subdomain(subdomain)] += vector::dot(own, own);
        }
        out
    }
}

/// A number for each body of the coarse space: the same for those that know of each other.
fn joined(tfeti: &Tfeti, discrete: &DiscreteScene) -> Vec<u32> {
    let coarse = tfeti.coarse();
    let mut sets = DisjointSets::new(coarse.bodies());
    let body = |(node, _): (u32, f64)| {
        let copy = discrete.decomposition.copies(node as usize)[0];
        coarse.body_of()[copy.subdomain as usize] as usize
    };
    let pairs = discrete.points.iter().filter(|p| p.sides.partner.is_some());
    for point in pairs.chain(&discrete.ties) {
        let relative = discrete.couplings.relative(point.surface);
        let relative = relative.map(|subdomain| coarse.body_of()[subdomain as usize] as usize);
        sets.join_all(point.sides.nodes().map(body).chain(relative));
    }
    for equation in &discrete.equations {
        let places = equation.places.iter().map(|p| coarse.body_of()[p.0 as usize] as usize);
        sets.join_all(equation.terms.iter().map(|t| body((t.0, 0.0))).chain(places));
    }
    sets.numbers()
}
