//! Forces at a node that may replace one another, where the rows of the node contradict each other.
//!
//! At a node with more rows than displacements ([`Dependency`]) an active set may ask for what cannot be: a point
//! sticks where a support or another obstacle moves it. The solution on such a set leaves a slip or a gap `r` in the
//! null space of `Bᵀ` that no displacement can change. Then the dual cost falls without end along `-r`, and `B^T
//! lambda` does not change on the way: multipliers are moved there until a point slides at its bound or lets go, which
//! ends the contradiction. Slip bounds follow the normal forces on the way.
//!
//! | local | meaning |
//! |---|---|
//! | `a`, `r` | multipliers and residual of the rows of one dependency |
//! | `d` | direction in the null space along which `a` moves |
//! | `held` | rows that stay: those at their bound that `d` would take across it |

use super::iterate::Task;
use crate::model::{ConstrainedPoint, Model};
use crate::tolerances::{AT_BOUND, NULL_RANK};
use nalgebra::{DMatrix, DVector};
use signorini_tfeti::internal::Dependency;

/// The dependencies of a model, with the points whose rows they hold.
#[derive(Debug)]
pub(crate) struct Exchanges(Vec<Exchange>);

#[derive(Debug)]
struct Exchange {
    rows: Vec<usize>,
    /// One column a vector.
    null: DMatrix<f64>,
    points: Vec<Place>,
}

/// A contact point, as places among the rows of its dependency.
#[derive(Debug)]
struct Place {
    /// Position among the points of the model.
    point: usize,
    normal: usize,
    tangential: Vec<usize>,
    /// Force over multiplier of the tangential rows.
    scale: f64,
}

impl Exchanges {
    pub(crate) fn new(model: &Model) -> Self {
        let dependencies = model.dependencies().iter();
        Self(dependencies.map(|d| Exchange::new(model, d)).collect())
    }

    /// Ends what the rows of a solved active set contradict; whether there was anything. `residual` is that of all
    /// rows, `scale` the stiffness of contact rows; what would move a force by less than `limit` is left.
    pub(crate) fn settle(
        &self,
        task: Task<'_>,
        residual: &[f64],
        (scale, limit): (&[f64], f64),
        lambda: &mut [f64],
    ) -> bool {
        let mut any = false;
        for exchange in &self.0 {
            let rows = exchange.rows.iter().map(|k| residual[*k]);
            let r = DVector::from_iterator(exchange.rows.len(), rows);
            let stiffness = scale[exchange.rows[0]];
            any |= Contradiction { exchange, task, r }.settle(stiffness, limit, lambda);
        }
        any
    }
}

impl Exchange {
    fn new(model: &Model, dependency: &Dependency) -> Self {
        let rows = dependency.rows.clone();
        let of = |row: usize| rows.binary_search(&row).ok();
        let place = |(k, point): (usize, &ConstrainedPoint)| {
            let normal = of(point.row)?;
            let (first, count, scale) = point.tangential_rows().unwrap_or((0, 0, 1.0));
            let tangential = (first..first + count).map(of).collect::<Option<_>>()?;
            Some(Place {
                point: k,
                normal,
                tangential,
                scale,
            })
        };
        let points = model.points.iter().enumerate().filter_map(place).collect();
        let vectors = &dependency.vectors;
        let null = DMatrix::from_fn(rows.len(), vectors.len(), |i, k| vectors[k][i]);
        Self { rows, null, points }
    }
}

/// The rows of one dependency and what is left of their conditions.
struct Contradiction<'a> {
    exchange: &'a Exchange,
    task: Task<'a>,
    /// Residual of the rows.
    r: DVector<f64>,
}

impl Contradiction<'_> {
    fn settle(&self, stiffness: f64, limit: f64, lambda: &mut [f64]) -> bool {
        let (Exchange { rows, points, .. }, Task { model, problem, .. }) = (self.exchange, self.task);
        let mut any = false;
        // slips are in units of their body
        let unit = points.first().and_then(|place| problem.units.get(place.point));
        let rounding = model.discrete.rounding / unit.copied().unwrap_or(1.0);
        // each step ends at a bound
        for _ in 0..2 * rows.len() {
            let mut found = self.way(lambda, true);
            if found.1.is_infinite() {
                // slip bounds outgrow friction: with those of now
                found = self.way(lambda, false);
            }
            let (d, length) = found;
            let small = d.norm() <= rounding || d.norm() * stiffness <= limit;
            if small || !length.is_finite() {
                break;
            }
            for (k, d) in rows.iter().zip(d.iter()) {
                lambda[*k] += length * d;
            }
            any |= length > 0.0;
        }
        any
    }

    /// Rows that the active set does not leave free: those of open and of sliding points.
    fn held(&self, lambda: &[f64]) -> Vec<bool> {
        let (Exchange { rows, points, .. }, r) = (self.exchange, &self.r);
        let mut held = vec![false; rows.len()];
        for place in points {
            let normal = place.normal;
            held[normal] = lambda[rows[normal]] >= 0.0 && r[normal] <= 0.0;
            let radius = self.radius(place, lambda);
            let (mut square, mut along) = (0.0, 0.0);
            for k in &place.tangential {
                let a = lambda[rows[*k]];
                square += a * a;
                along += a * r[*k];
            }
            if square >= (AT_BOUND * radius).powi(2) && along <= 0.0 {
                place.tangential.iter().for_each(|k| held[*k] = true);
            }
        }
        held
    }

    /// The direction in which the multipliers move, and how far to the next bound.
    fn way(&self, lambda: &[f64], follow: bool) -> (DVector<f64>, f64) {
        let Exchange { rows: own, points, .. } = self.exchange;
        let mut held = self.held(lambda);
        loop {
            let d = self.descent(&held);
            let mut length = f64::INFINITY;
            let mut stopped = false;
            for place in points {
                let along = d[place.normal];
                let opens = if along > 0.0 { (-lambda[own[place.normal]] / along).max(0.0) } else { f64::INFINITY };
                let mut stops = vec![(std::slice::from_ref(&place.normal), opens)];
                // friction of a point that slides follows its bound afterwards
                if place.tangential.iter().any(|k| !held[*k]) {
                    let slides = self.slides(place, lambda, &d, follow);
                    stops.push((&place.tangential, slides));
                }
                for (rows, to) in stops {
                    length = length.min(to);
                    if to <= 0.0 {
                        rows.iter().for_each(|k| held[*k] = true);
                        stopped = true;
                    }
                }
            }
            if !stopped {
                return (d, length);
            }
        }
    }

    /// `-r` in the part of the null space that leaves `held` rows alone.
    fn descent(&self, held: &[bool]) -> DVector<f64> {
        let (null, r) = (&self.exchange.null, &self.r);
        let free = |k: usize| if held[k] { 0.0 } else { -r[k] };
        let w = null.tr_mul(&DVector::from_fn(held.len(), |k, _| free(k)));
        let rows: Vec<usize> = (0..held.len()).filter(|k| held[*k]).collect();
        if rows.is_empty() {
            return null * w;
        }
        let fixed = null.select_rows(&rows);
        let off = &fixed * &w;
        let correction = fixed.svd(true, true).solve(&off, NULL_RANK);
        let mut d = null * (w - correction.unwrap_or_else(|_| DVector::zeros(null.ncols())));
        // what is held does not move by rounding either
        rows.iter().for_each(|k| d[*k] = 0.0);
        d
    }

    /// How far along `d` friction reaches its bound, which follows the normal force; 0 where it is there and would
    /// cross it.
    fn slides(&self, place: &Place, lambda: &[f64], d: &DVector<f64>, follow: bool) -> f64 {
        let Task { model, problem, .. } = self.task;
        let rows = &self.exchange.rows;
        let (point, radius) = (&model.points[place.point], self.radius(place, lambda));
        let normal = rows[place.normal];
        let slope = if follow && (lambda[normal] < 0.0 || d[place.normal] < 0.0) {
            problem.coefficients[place.point] * point.scale / place.scale
        } else {
            0.0
        };
        let growth = -slope * d[place.normal];
        let (mut aa, mut ad, mut dd) = (-radius * radius, -radius * growth, -growth * growth);
        for k in &place.tangential {
            let a = lambda[rows[*k]];
            aa += a * a;
            ad += a * d[*k];
            dd += d[*k] * d[*k];
        }
        // |a + t d|² = (radius + t growth)²
        if aa >= -(1.0 - AT_BOUND * AT_BOUND) * radius * radius && ad > 0.0 {
            return 0.0;
        }
        let root = ad * ad - dd * aa.min(0.0);
        match root >= 0.0 {
            true if dd > 0.0 => (root.sqrt() - ad) / dd,
            true if ad > 0.0 => aa.min(0.0) / -(ad + root.sqrt()),
            _ => f64::INFINITY,
        }
    }

    /// Slip bound of a point, as a multiplier.
    fn radius(&self, place: &Place, lambda: &[f64]) -> f64 {
        let Task { model, problem, .. } = self.task;
        problem.slip_bound(place.point, &model.points[place.point], lambda) / place.scale
    }
}
