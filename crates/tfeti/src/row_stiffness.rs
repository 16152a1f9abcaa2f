//! The stiffness that a single row of `B` feels.

use crate::system::Tfeti;
use std::ops::Range;

impl Tfeti {
    /// `out[k] = b K bᵀ` for the rows `b` of `B` in `rows`, in N/m: the diagonal of the lumped preconditioner without
    /// scaling. Its inverse is the scale on which displacements of that row turn into multipliers.
    ///
    /// `out` has the length of `rows`; rows beyond the last are 0.
    pub fn row_stiffness(&self, rows: Range<usize>, out: &mut [f64]) {
        let parts = &self.parts;
        for (row, target) in rows.zip(out) {
            let entries = if row < self.dual_dim() {
                self.gluing().row(row)
            } else {
                Vec::new()
            };
            *target = 0.0;
            for &(subdomain, dof, value) in &entries {
                let stiffness = &parts.bases[parts.classes.place(subdomain).0].stiffness;
                let (indices, values) = stiffness.column(dof);
                for &(other, other_dof, other_value) in entries.iter().filter(|e| e.0 == subdomain)
                {
                    debug_assert_eq!(other, subdomain);
                    if let Ok(at) = indices.binary_search(&other_dof) {
                        *target += value * values[at] * other_value;
                    }
                }
            }
        }
    }

    /// Weights of the rows for projectors that suit a body of several materials: `1 / sum_d b_d² / K_dd`, relative to the
    /// largest. A row between a stiff and a soft subdomain carries forces in proportion to the soft one. `None` where
    /// there is one material, as all weights are alike then.
    #[must_use]
    pub fn row_weights(&self) -> Option<Vec<f64>> {
        if !self.heterogeneous {
            return None;
        }
        let parts = &self.parts;
        let compliance = |(subdomain, dof, value): (usize, usize, f64)| {
            let stiffness = &parts.bases[parts.classes.place(subdomain).0].stiffness;
            let diagonal = stiffness
                .find(dof, dof)
                .map_or(0.0, |k| stiffness.values[k]);
            if diagonal > 0.0 {
                value * value / diagonal
            } else {
                0.0
            }
        };
        let mut weights: Vec<f64> = (0..self.dual_dim())
            .map(|row| {
                self.gluing()
                    .row(row)
                    .into_iter()
                    .map(compliance)
                    .sum::<f64>()
            })
            .map(|c| if c > 0.0 { 1.0 / c } else { 0.0 })
            .collect();
        let largest = weights.iter().fold(0.0_f64, |m, w| m.max(*w));
        for w in &mut weights {
            *w = if *w > 0.0 { *w / largest } else { 1.0 };
        }
        Some(weights)
    }
}
