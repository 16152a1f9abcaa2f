//! The active-set method: conjugate gradients for a choice of active, free and sliding blocks, and a natural map that
//! predicts the next choice.
//!
//! From above: `solver` (the loop), `start`, `moves` and `run` (what happens between one active set and the next),
//! `path` and `compliance` (springs that lead to another set), `cg` and `weights` (the linear problem), `iterate` (the
//! point), `balance` (modes that constraints alone stop),
//! `coupling` (radii that depend on the solution), `natural_map`, `blocks` and `disc` (states); `problem`, `settings`,
//! `view`.
//!
//! Uses: `problem`, `report`, `vector`, `settings`, `error`, `tolerances`. In: operator, preconditioner, projector,
//! set, load, a start. Out: the minimiser and its product, a report.

mod balance;
mod blocks;
mod cg;
mod compliance;
mod coupling;
mod disc;
mod iterate;
mod moves;
mod natural_map;
mod path;
mod problem;
mod run;
mod settings;
mod solver;
mod start;
mod view;
mod weights;
mod workspace;

pub use coupling::RadiusSlope;
pub(crate) use coupling::slope_table;
pub use problem::{ActiveSetPoint, ActiveSetProblem};
pub use settings::{ActiveSetReport, ActiveSetSettings};
pub use solver::active_set;
pub use view::{ActiveSetPreconditioner, ActiveSetView, Freedom};
pub use workspace::ActiveSetWorkspace;
