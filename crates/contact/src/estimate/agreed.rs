//! What contact rows measure where ties and other contact hold exactly: the positions along the surface that friction
//! hands on.
//!
//! Both sides of a tie may touch, and stick; so may a node in an edge between two contacts. The solver lets ties,
//! supports and gaps err by its tolerance, and so would the positions at which friction sticks: in the next step no
//! displacement would be in all of them, and friction would work against the rest. So what they are off is taken out:
//! of ties by the smallest change in a norm weighted by stiffness, of rows that depend on one another by that of the
//! positions themselves.

use super::dependent::Agreement;
use super::duality_gap::{Caches, Weights};
use super::shared::ties_meet_points;
use crate::model::Model;
use crate::result::{ContactState, Recovered};
use crate::step::entry_or_zero;
use nalgebra::DVector;
use std::borrow::Cow;

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
            let change = &agreement.change * (&agreement.null * values);
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
        let missing: Vec<f64> = tied.clone().map(|row| offset[row] - rows[row]).collect();
        let change = shared.change_of_ties(tied.start, &missing);
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
