//! SMALSE: minimise `1/2 x·Ax - b·x` over a separable convex set with `C x = e`. Algorithm 4.1 of the paper.
//!
//! `solver` has the outer Steps 1 to 4, `penalised` the augmented Lagrangian that KPRGP minimises in Step 1,
//! `settings` the settings, report and work memory.
//!
//! Uses: `kprgp`, `problem`, `report`, `vector`, `settings`, `error`, `tolerances`. In: operator, equality with
//! orthonormal rows, set, load, norm. Out: the minimiser and the multiplier of the equality, a report.

mod penalised;
mod settings;
mod solver;

pub use settings::{SmalseReport, SmalseSettings, SmalseWorkspace};
pub use solver::smalse;
