//! Estimate of the discretisation error from a recovered strain (Zienkiewicz and Zhu, 1992).
//!
//! `patches` fits a linear polynomial to the strains around each node, which is better than the constant strain of each
//! tetrahedron where the solution is smooth; `quadratic` does so in a mesh of order 2; `estimate` takes the energy of
//! the difference for the error. It is no bound: at re-entrant corners, at the rim of a contact zone and between
//! regions it is off by some tens of per cent. Errors of contact forces, friction and time steps are not in it. `sizes`
//! asks for the mesh with a smaller one.
//!
//! Uses: `fields`, `element`, `material`, `mesh`, `tables`, `vec3`. In: a mesh and a displacement. Out: an energy a
//! tetrahedron.

mod estimate;
mod patches;
mod quadratic;
mod sizes;

pub use estimate::{DiscretisationError, discretisation_error};
pub use patches::StrainRecovery;
