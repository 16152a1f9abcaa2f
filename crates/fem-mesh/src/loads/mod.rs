//! Loads: in space, in time, and as nodal forces of the subdomains.
//!
//! `density` says where a load acts, `history` how it changes in time, `function` wraps what a user gives for either,
//! `assemble` makes consistent nodal forces, `moment` the traction of a moment, `eigenstrain` the forces of
//! stress-free strain.
//!
//! Uses: `decomposition`, `element`, `material`, `mesh`, `vec3`. In: a mesh, a decomposition, a load. Out: a force
//! vector per subdomain.

mod assemble;
mod density;
mod eigenstrain;
mod function;
mod history;
mod moment;

pub use assemble::{assemble_load, tet_forces};
pub use density::{LoadDensity, LoadError};
pub use eigenstrain::assemble_eigenstrain;
pub use function::Function;
#[doc(hidden)]
pub use history::interpolate;
pub use history::{History, HistoryError};
