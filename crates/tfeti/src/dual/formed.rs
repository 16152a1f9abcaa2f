//! `F + w Gᵀ G` as a matrix: each subdomain answers for the rows that touch it, so rows that share none have a zero.

use std::borrow::Cow;

use crate::dual::operator::DualOperator;
use crate::linalg::sparse::Columns;
use crate::subdomain::kernel::{Kernel, add_wrench};
use signorini_fem_mesh::internal::distinct;
use std::ops::Range;

/// Coefficients of rows at one subdomain, by row: its number, unknown, coefficient.
type Rows = Vec<(usize, usize, f64)>;

/// `F + w Gᵀ G`, lower triangle, and `w`.
#[derive(Debug)]
pub(crate) struct Formed {
    pub(crate) matrix: Columns,
    pub(crate) weight: f64,
}

impl DualOperator {
    /// `F`, and `Gᵀ G` with so many times its trace. The same on all ranks.
    pub(crate) fn formed(&self, times: f64) -> Formed {
        let rows = self.gluing.ranges().total();
        let mut touching: Vec<Rows> = vec![Vec::new(); self.subdomains.count()];
        for row in 0..rows {
            for (subdomain, unknown, coefficient) in self.gluing.row(row) {
                touching[subdomain].push((row, unknown, coefficient));
            }
        }
        let (matrix, weight) = (self.pattern(&touching), 0.0);
        let mut formed = Formed { matrix, weight };
        for (class, own) in self.subdomains.classes.classes().iter().enumerate() {
            if own.is_rigid {
                continue;
            }
            let inverse = self.boundary_inverse(class);
            for &member in &own.members {
                self.add_member(class, &inverse, touching[member as usize].clone(), &mut formed);
            }
        }
        for (row, compliance) in self.gluing.compliance() {
            formed.shift(row..row + 1, compliance);
        }
        let motions = touching.iter().enumerate();
        let motions: Vec<_> = motions
            .map(|(s, rows)| motions_of(self.subdomains.kernel(s), rows))
            .collect();
        let square: f64 = motions.iter().flatten().flat_map(|(_, g)| g).map(|v| v * v).sum();
        if square > 0.0 {
            formed.weight = times * formed.diagonal(0..rows).sum::<f64>() / square;
        }
        for rows in &motions {
            for (k, (row, g)) in rows.iter().enumerate() {
                let product = |h: &[f64; 6]| g.iter().zip(h).map(|(a, b)| a * b).sum::<f64>();
                let weight = formed.weight;
                formed.add(*row, rows[k..].iter().map(|(other, h)| (*other, weight * product(h))));
            }
        }
        formed
    }

    /// Zeros where rows share a subdomain.
    fn pattern(&self, touching: &[Rows]) -> Columns {
        let mut out = Columns::empty(self.gluing.ranges().total());
        for row in 0..out.dim {
            let subdomains = distinct(self.gluing.row(row).into_iter().map(|entry| entry.0));
            let from = |s: usize| touching[s].partition_point(|other| other.0 < row);
            let near = subdomains.into_iter().flat_map(|s| &touching[s][from(s)..]);
            out.rows.extend(distinct(near.map(|other| other.0)));
            out.pointers.push(out.rows.len());
        }
        out.values = vec![0.0; out.rows.len()];
        out
    }

    /// The inverse of a class on its boundary, from a rank that holds it.
    fn boundary_inverse(&self, class: usize) -> Cow<'_, [f64]> {
        let (nodes, ownership) = (&self.map.classes[class].nodes, &self.subdomains.ownership);
        let size = (3 * nodes.len()).pow(2);
        let (from, exchange) = (ownership.rank_of(class, 0), &ownership.exchange);
        let mut matrix = match &self.inverses[class] {
            Some(own) if from == exchange.rank() => match &own.boundary {
                Some(matrix) => Cow::from(matrix),
                None => Cow::from(own.full.boundary_block(&self.subdomains.bases[class].kernel, nodes)),
            },
            _ => Cow::from(vec![0.0; size]),
        };
        if exchange.ranks() > 1 {
            exchange.complete(matrix.to_mut(), &[(from, 0..size)]);
        }
        matrix
    }

    /// Adds `B A Bᵀ` of a subdomain.
    fn add_member(&self, class: usize, inverse: &[f64], mut rows: Rows, out: &mut Formed) {
        let nodes = &self.map.classes[class].nodes;
        let size = 3 * nodes.len();
        for (_, unknown, _) in &mut rows {
            let node = nodes.partition_point(|node| (*node as usize) < *unknown / 3);
            *unknown = 3 * node + *unknown % 3;
        }
        let (mut answer, mut start) = (vec![0.0; size], 0);
        for row in rows.chunk_by(|a, b| a.0 == b.0) {
            answer.fill(0.0);
            for (_, unknown, coefficient) in row {
                let column = &inverse[unknown * size..(unknown + 1) * size];
                answer.iter_mut().zip(column).for_each(|(y, a)| *y += coefficient * a);
            }
            let entries = rows[start..].iter();
            out.add(row[0].0, entries.map(|(row, unknown, c)| (*row, c * answer[*unknown])));
            start += row.len();
        }
    }
}

/// What each row at a subdomain does to its six motions.
fn motions_of(kernel: &Kernel, rows: &Rows) -> Vec<(usize, [f64; 6])> {
    let of = |row: &[(usize, usize, f64)]| {
        let mut wrench = [0.0; 6];
        for (_, unknown, coefficient) in row {
            let mut force = [0.0; 3];
            force[unknown % 3] = *coefficient;
            add_wrench(&mut wrench, kernel.arm(unknown / 3), force);
        }
        (row[0].0, kernel.project_wrench(&wrench))
    };
    rows.chunk_by(|a, b| a.0 == b.0).map(of).collect()
}

impl Formed {
    /// Adds to a column, which the pattern has, at rows that ascend from its own.
    fn add(&mut self, column: usize, entries: impl Iterator<Item = (usize, f64)>) {
        let matrix = &mut self.matrix;
        let mut at = matrix.pointers[column];
        for (row, value) in entries {
            while matrix.rows[at] < row {
                at += 1;
            }
            matrix.values[at] += value;
        }
    }

    /// Entries of the diagonal: each is the first of its column.
    fn diagonal(&self, rows: Range<usize>) -> impl Iterator<Item = f64> {
        rows.map(|row| self.matrix.values[self.matrix.pointers[row]])
    }

    /// The largest of them.
    pub(crate) fn largest(&self, rows: Range<usize>) -> f64 {
        self.diagonal(rows).fold(0.0, f64::max)
    }

    /// Adds to them.
    pub(crate) fn shift(&mut self, rows: Range<usize>, value: f64) {
        rows.for_each(|row| self.matrix.values[self.matrix.pointers[row]] += value);
    }
}
