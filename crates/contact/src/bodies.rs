//! Bodies that nothing joins, and sizes of their own.
//!
//! Bodies that may touch each other count as one here, and so do parts that hinges join. An obstacle is rigid, so the others know
//! nothing of each other: a scene with several is several problems in one. Norms over
//! all of them would let the heaviest alone decide when the others are done. Every body therefore gets a unit of force: the
//! problem of a level is solved with forces and displacements of each body divided by it. The conditions are homogeneous,
//! so that only data change (`d`, `e`, given slip bounds), operators do not; units are powers of two, so that no digit changes.

use crate::candidates::ContactPoint;
use crate::level::StepProblem;
use crate::model::Model;
use crate::solver::Iterate;
use signorini_fem_mesh::Decomposition;
use signorini_fem_mesh::internal::DisjointSets;
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

    /// The units of force of all bodies, N: the nearest powers of two to the sizes of their multipliers, or of their loads
    /// or of what moved supports would do to their nodes if these are larger; empty for one body, which needs none.
    fn units(&self, model: &Model, level: &StepProblem, start: &[f64]) -> Vec<f64> {
        if self.count <= 1 {
            return Vec::new();
        }
        let mut squares = vec![0.0; self.count];
        self.add_squares(start, 0..start.len(), &mut squares);
        let force = level.forces(model);
        let mut loads = vec![0.0; self.count];
        for subdomain in 0..model.tfeti.subdomains() {
            let own = &force[model.tfeti.torn_range(subdomain)];
            loads[self.of_subdomain(subdomain)] += signorini_qp::vector::dot(own, own);
        }
        // where supports move a body, warm starts may be rounding errors
        let driven = |b: usize| level.driven.get(b).copied().unwrap_or(0.0);
        let known = |b: usize| squares[b].max(loads[b]).sqrt().max(level.rest(b));
        (0..self.count)
            .map(|b| power_of_two(known(b).max(driven(b))))
            .collect()
    }

    /// The level and the iterate in units of the bodies, and the units of all rows; `None` for one body.
    pub(crate) fn scaled(
        &self,
        model: &Model,
        level: &StepProblem,
        iterate: &mut Iterate,
    ) -> Option<(StepProblem, Units)> {
        let own = self.units(model, level, &iterate.lambda);
        if own.is_empty() {
            return None;
        }
        let subdomains = self.subdomains.iter();
        let units = Units {
            rows: self.rows.iter().map(|b| own[*b as usize]).collect(),
            coarse: subdomains.flat_map(|b| [own[*b as usize]; 6]).collect(),
        };
        let mut scaled = level.clone();
        divide(&mut scaled.linear, &units.rows);
        divide(&mut scaled.rhs, &units.coarse);
        for (peak, unit) in scaled.peaks.iter_mut().zip(&own) {
            peak.multipliers /= unit;
            peak.force /= unit;
        }
        divide(&mut scaled.driven, &own);
        scaled.units = model.points.iter().map(|p| units.rows[p.row]).collect();
        divide(&mut iterate.lambda, &units.rows);
        divide(&mut iterate.f_lambda, &units.rows);
        // its rows are not those of single bodies
        iterate.multiplier.clear();
        Some((scaled, units))
    }
}

/// A number for each body of the coarse space: the same for those that may touch each other, whether the points that may are in
/// the dual problem or not.
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

/// The unit of force of each row and of each rigid amplitude.
pub(crate) struct Units {
    rows: Vec<f64>,
    coarse: Vec<f64>,
}

impl Units {
    /// The iterate in newtons and metres again.
    pub(crate) fn restore(&self, iterate: &mut Iterate) {
        multiply(&mut iterate.lambda, &self.rows);
        multiply(&mut iterate.f_lambda, &self.rows);
        multiply(&mut iterate.alpha, &self.coarse);
        iterate.multiplier.clear();
    }
}

fn divide(x: &mut [f64], units: &[f64]) {
    x.iter_mut().zip(units).for_each(|(x, u)| *x /= u);
}

fn multiply(x: &mut [f64], units: &[f64]) {
    x.iter_mut().zip(units).for_each(|(x, u)| *x *= u);
}

/// The power of two next to a size; 1 for what has none.
fn power_of_two(size: f64) -> f64 {
    if size > 0.0 && size.is_finite() {
        size.log2().round().clamp(-900.0, 900.0).exp2()
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_powers_of_two() {
        for (size, unit) in [
            (0.0, 1.0),
            (f64::NAN, 1.0),
            (3.1, 4.0),
            (1e-3, 0.5f64.powi(10)),
        ] {
            assert_eq!(power_of_two(size), unit);
        }
    }
}
