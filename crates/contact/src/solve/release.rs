//! Forces at a node that may replace one another, where the rows of the node contradict each other.
//!
//! At a node with more rows than displacements ([`Dependency`]) a face may ask for what cannot be: a point sticks where a
//! support or another obstacle moves it. The solution of such a face leaves a slip or a gap `r` in the null space of `Bᵀ`
//! that no displacement can change. Then the dual cost falls without end along `-r`, and `B^T lambda` does not change on the
//! way: multipliers are moved there until a point slides at its bound or lets go, which ends the contradiction. Slip bounds follow the normal
//! forces on the way.
//!
//! | local | meaning |
//! |---|---|
//! | `a`, `r` | multipliers and residual of the rows of one dependency |
//! | `d` | direction in the null space along which `a` moves |
//! | `held` | rows that stay: those at their bound that `d` would take across it |

use crate::model::{ConstrainedPoint, Model, Tangential};
use crate::step::StepProblem;
use nalgebra::{DMatrix, DVector};
use signorini_tfeti::Dependency;

/// A point within rounding of its bound.
const AT_BOUND: f64 = 1.0 - 1e-9;

/// Singular values below this part of one count as zero.
const ZERO: f64 = 1e-9;

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
        let dependencies = model.tfeti.gluing().dependencies();
        Self(
            dependencies
                .into_iter()
                .map(|d| Exchange::new(model, &d))
                .collect(),
        )
    }

    /// Ends what the rows of a solved face contradict; whether there was anything. `residual` is that of all rows, `scale`
    /// the stiffness of contact rows; what would move a force by less than `limit` is left.
    pub(crate) fn settle(
        &self,
        model: &Model,
        level: &StepProblem,
        residual: &[f64],
        (scale, limit): (&[f64], f64),
        lambda: &mut [f64],
    ) -> bool {
        let mut any = false;
        for exchange in &self.0 {
            any |= exchange.settle(model, level, residual, (scale, limit), lambda);
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
            let (tangential, scale) = match point.tangential {
                Tangential::None => (Vec::new(), 1.0),
                Tangential::Line { row, scale, .. } => (vec![of(row)?], scale),
                Tangential::Plane { row, scale } => (vec![of(row)?, of(row + 1)?], scale),
            };
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

    fn settle(
        &self,
        model: &Model,
        level: &StepProblem,
        residual: &[f64],
        (scale, limit): (&[f64], f64),
        lambda: &mut [f64],
    ) -> bool {
        let r = DVector::from_iterator(self.rows.len(), self.rows.iter().map(|k| residual[*k]));
        let stiffness = scale[self.rows[0]];
        let mut any = false;
        // each step ends at a bound
        for _ in 0..2 * self.rows.len() {
            let mut found = self.way(model, level, &r, lambda, true);
            if found.1.is_infinite() {
                // slip bounds outgrow friction: with those of now
                found = self.way(model, level, &r, lambda, false);
            }
            let (d, length) = found;
            let small = d.norm() <= model.found.rounding || d.norm() * stiffness <= limit;
            if small || !length.is_finite() {
                break;
            }
            for (k, d) in self.rows.iter().zip(d.iter()) {
                lambda[*k] += length * d;
            }
            any |= length > 0.0;
        }
        any
    }

    /// Rows that the face does not leave free: those of open and of sliding points.
    fn held(
        &self,
        model: &Model,
        level: &StepProblem,
        r: &DVector<f64>,
        lambda: &[f64],
    ) -> Vec<bool> {
        let mut held = vec![false; self.rows.len()];
        for place in &self.points {
            let normal = place.normal;
            held[normal] = lambda[self.rows[normal]] >= 0.0 && r[normal] <= 0.0;
            let point = &model.points[place.point];
            let radius = level.bound(place.point, point, lambda) / place.scale;
            let (mut square, mut along) = (0.0, 0.0);
            for k in &place.tangential {
                let a = lambda[self.rows[*k]];
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
    fn way(
        &self,
        model: &Model,
        level: &StepProblem,
        r: &DVector<f64>,
        lambda: &[f64],
        follow: bool,
    ) -> (DVector<f64>, f64) {
        let mut held = self.held(model, level, r, lambda);
        loop {
            let d = self.descent(r, &held);
            let mut length = f64::INFINITY;
            let mut stopped = false;
            for place in &self.points {
                let along = d[place.normal];
                let opens = match along > 0.0 {
                    true => (-lambda[self.rows[place.normal]] / along).max(0.0),
                    false => f64::INFINITY,
                };
                let mut stops = vec![(std::slice::from_ref(&place.normal), opens)];
                // friction of a point that slides follows its bound afterwards
                if place.tangential.iter().any(|k| !held[*k]) {
                    let slides = self.slides(model, level, place, lambda, (&d, follow));
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
    fn descent(&self, r: &DVector<f64>, held: &[bool]) -> DVector<f64> {
        let free = |k: usize| if held[k] { 0.0 } else { -r[k] };
        let w = self
            .null
            .tr_mul(&DVector::from_fn(held.len(), |k, _| free(k)));
        let rows: Vec<usize> = (0..held.len()).filter(|k| held[*k]).collect();
        if rows.is_empty() {
            return &self.null * w;
        }
        let fixed = self.null.select_rows(&rows);
        let off = &fixed * &w;
        let correction = fixed.svd(true, true).solve(&off, ZERO);
        let mut d =
            &self.null * (w - correction.unwrap_or_else(|_| DVector::zeros(self.null.ncols())));
        // what is held does not move by rounding either
        rows.iter().for_each(|k| d[*k] = 0.0);
        d
    }

    /// How far along `d` friction reaches its bound, which follows the normal force; 0 where it is there and would cross it.
    fn slides(
        &self,
        model: &Model,
        level: &StepProblem,
        place: &Place,
        lambda: &[f64],
        (d, follow): (&DVector<f64>, bool),
    ) -> f64 {
        let point = &model.points[place.point];
        let radius = level.bound(place.point, point, lambda) / place.scale;
        let normal = self.rows[place.normal];
        let slope = match follow && (lambda[normal] < 0.0 || d[place.normal] < 0.0) {
            true => level.coefficients[place.point] * point.scale / place.scale,
            false => 0.0,
        };
        let growth = -slope * d[place.normal];
        let (mut aa, mut ad, mut dd) = (-radius * radius, -radius * growth, -growth * growth);
        for k in &place.tangential {
            let a = lambda[self.rows[*k]];
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
}
