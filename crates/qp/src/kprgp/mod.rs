//! KPRGP: minimise `1/2 x·Ax - b·x` over a separable convex set, by projected gradients with conjugate directions.
//!
//! `solver` is the iteration (the step that expands is `expand`), `objective` the cost that it sees, `settings` its
//! settings, report and work memory.
//!
//! Uses: `problem`, `report`, `vector`, `settings`, `error`, `tolerances`. In: operator, set, load, norm. Out: the
//! minimiser, a report. SMALSE runs the same iteration on its augmented Lagrangian.

mod objective;
mod settings;
mod solver;

pub use settings::{Expansion, KprgpReport, KprgpSettings, KprgpWorkspace};
pub use solver::kprgp;

pub(crate) use objective::Objective;
pub(crate) use settings::Vectors;
pub(crate) use solver::{drifted, iterate};
