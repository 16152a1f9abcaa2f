//! Units of force: a step is solved with forces and displacements of each body divided by a power of two of its own.

use super::iterate::Iterate;
use crate::discrete::power_of_two;
use crate::model::Model;
use crate::step::StepProblem;

/// The units of force of all bodies, N: the nearest powers of two to the sizes of their multipliers, or of their loads
/// or of what moved supports would do to their nodes if these are larger.
fn units(model: &Model, problem: &StepProblem, start: &[f64]) -> Vec<f64> {
    let bodies = &model.bodies;
    let mut squares = vec![0.0; bodies.count()];
    bodies.add_squares(start, 0..start.len(), &mut squares);
    let loads = bodies.torn_squares(&model.tfeti, &problem.forces(model));
    // where supports move a body, warm starts may be rounding errors
    let prescribed = |b: usize| problem.prescribed_force.get(b).copied().unwrap_or(0.0);
    let known = |b: usize| squares[b].max(loads[b]).sqrt().max(problem.rest(b));
    (0..bodies.count())
        .map(|b| power_of_two(known(b).max(prescribed(b))))
        .collect()
}

/// The data of a step and the iterate in units of the bodies, and the units of all rows; `None` for one body.
pub(super) fn scaled(model: &Model, problem: &StepProblem, iterate: &mut Iterate) -> Option<(StepProblem, Units)> {
    let bodies = &model.bodies;
    if bodies.count() <= 1 {
        return None;
    }
    let own = units(model, problem, &iterate.lambda);
    let rows = 0..model.tfeti.dual_dim();
    let subdomains = 0..model.tfeti.subdomains();
    let units = Units {
        rows: rows.map(|row| own[bodies.of_row(row)]).collect(),
        coarse: subdomains.flat_map(|s| [own[bodies.of_subdomain(s)]; 6]).collect(),
    };
    let mut scaled = problem.clone();
    divide(&mut scaled.linear, &units.rows);
    divide(&mut scaled.rhs, &units.coarse);
    divide(&mut scaled.balancing, &units.rows);
    for (peak, unit) in scaled.peaks.iter_mut().zip(&own) {
        peak.multipliers /= unit;
        peak.force /= unit;
    }
    divide(&mut scaled.prescribed_force, &own);
    scaled.units = model.points.iter().map(|p| units.rows[p.row]).collect();
    divide(&mut iterate.lambda, &units.rows);
    divide(&mut iterate.f_lambda, &units.rows);
    divide(&mut iterate.known_rows, &units.rows);
    // its rows are not those of single bodies
    iterate.multiplier.clear();
    Some((scaled, units))
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
