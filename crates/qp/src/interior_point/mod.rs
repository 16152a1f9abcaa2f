//! An interior point method for small dense problems whose active sets are hard to predict.
//!
//! From above: `solver` (the loop), `system` (the linear equations of a step), `cones` (blocks as inequalities).
//!
//! Uses: `problem`, `report`, `vector`, `error`, `tolerances`; of `active_set` the radius slopes. In: a matrix, a load,
//! a set, slopes of its radii. Out: a point next to the solution, a report.

mod cones;
mod solver;
mod system;

pub use solver::{InteriorPointReport, interior_point};
