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
}
