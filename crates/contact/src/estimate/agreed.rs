//! What contact rows measure where ties hold exactly: the positions along the surface that friction hands on.
//!
//! Both sides of a tie may touch, and stick. The solver lets a tie err by its tolerance, and so would the positions at
//! which they stick: in the next step no displacement would be in both, and friction would work against the tie. So
//! what ties are off is taken out, by the smallest change in a norm weighted by stiffness.

use super::duality_gap::{Caches, Weights};
use super::shared::ties_meet_points;
use crate::model::Model;
use std::borrow::Cow;

impl Caches {
    /// From what all rows measure, and their offsets.
    pub(crate) fn agreed<'a>(&self, model: &Model, offset: &[f64], rows: &'a [f64]) -> Cow<'a, [f64]> {
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
        for row in model.tangential_start()..model.tangential_start() + model.tangential_rows() {
            out[row] += model
                .row(row)
                .map(|(node, c, coefficient)| coefficient * change[3 * node as usize + c])
                .sum::<f64>();
        }
        out.into()
    }
}
