//! What contact rows measure where ties and other contact hold exactly: the positions along the surface that friction
//! hands on.
//!
//! Both sides of a tie may touch, and stick; so may a node in an edge between two contacts. The solver lets ties,
//! supports and gaps err by its tolerance, and so would the positions at which friction sticks: in the next step no
//! displacement would be in all of them, and friction would work against the rest. So what they are off is taken out:
//! of ties by the smallest change in a norm weighted by stiffness, of rows that depend on one another by that of the
//! positions themselves.

use super::duality_gap::{Caches, Weights};
use super::shared::ties_meet_points;
use crate::model::Model;
use crate::result::{ContactState, Recovered};
use crate::step::entry_or_zero;
use crate::tolerances::NULL_RANK;
use nalgebra::{DMatrix, DVector};
use signorini_tfeti::internal::Dependency;
use std::borrow::Cow;
use std::ops::Range;

/// A dependency with rows along surfaces.
#[derive(Debug)]
pub(super) struct Agreement {
    rows: Vec<usize>,
    /// Changes of the rows along surfaces, zero of others, by what all rows measure.
    change: DMatrix<f64>,
}

impl Agreement {
    /// `None` where nothing that depends on others is along a surface.
    fn new(along: &Range<usize>, dependency: &Dependency) -> Option<Self> {
        let (rows, vectors) = (dependency.rows.clone(), &dependency.vectors);
        let null = DMatrix::from_fn(vectors.len(), rows.len(), |i, k| vectors[i][k]);
        let own = |i, k| if along.contains(&rows[k]) { null[(i, k)] } else { 0.0 };
        let own = DMatrix::from_fn(null.nrows(), null.ncols(), own);
        let change = own.pseudo_inverse(NULL_RANK).ok()?;
        let change = (change.amax() > 0.0).then(|| change * null)?;
        Some(Self { rows, change })
    }
}

impl Caches {
    /// From what all rows measure, and their offsets.
    pub(crate) fn agreed<'a>(&self, model: &Model, offset: &[f64], recovered: &'a Recovered) -> Cow<'a, [f64]> {
        let mut rows = self.with_ties(model, offset, &recovered.rows);
        let along = model.tangential_rows();
        let agreements = self.agreements.get_or_init(|| {
            let dependencies = model.dependencies().iter();
            dependencies.filter_map(|d| Agreement::new(&along, d)).collect()
        });
        if agreements.is_empty() {
            return rows;
        }
        // rows that hold in the next step whatever friction does
        let mut holds = vec![true; rows.len()];
        holds[model.contact_rows()].fill(false);
        for (point, state) in model.points.iter().zip(&recovered.points) {
            holds[point.row] = state.state != ContactState::Open;
        }
        for agreement in agreements {
            let value = |&row: &usize| {
                let value = if holds[row] { offset[row] } else { rows[row] };
                value - entry_or_zero(&recovered.gives_way, row)
            };
            let values = agreement.rows.iter().map(value);
            let values = DVector::from_iterator(agreement.rows.len(), values);
            let change = &agreement.change * values;
            let rows = rows.to_mut();
            for (row, change) in agreement.rows.iter().zip(change.iter()) {
                rows[*row] -= change;
            }
        }
        rows
    }

    /// The same where ties alone hold exactly.
    fn with_ties<'a>(&self, model: &Model, offset: &[f64], rows: &'a [f64]) -> Cow<'a, [f64]> {
        let tied = model.tfeti.gluing().ranges().tied.clone();
        if !*self.ties_meet_points.get_or_init(|| ties_meet_points(model)) {
            return rows.into();
        }
        let weights = self.weights.get_or_init(|| Weights::new(model));
        let Some(shared) = &weights.shared else {
            return rows.into();
        };
        let missing = tied.map(|row| offset[row] - rows[row]).collect();
        let change = shared.change_of_ties(missing);
        let mut out = rows.to_vec();
        for row in model.tangential_rows() {
            out[row] += model
                .row(row)
                .map(|(node, c, coefficient)| coefficient * change[3 * node as usize + c])
                .sum::<f64>();
        }
        out.into()
    }
}
