//! Elements, and integrals over them.
//!
//! `p1` is the linear tetrahedron: gradients of its shape functions, strain, blocks of stiffness; `p2` the quadratic
//! one. `piece` has a displacement in a tetrahedron of either kind, and integrals over a mesh.
//!
//! Uses: `mesh`, `quadrature`, `vec3`. In: the points of an element. Out: gradients, blocks of stiffness, integrals.

mod p1;
mod p2;
mod piece;

pub use p1::Element;

pub(crate) use p1::{nodal_stress, stiffness_block, strain_of};
pub(crate) use p2::QuadraticElement;
pub(crate) use piece::{Piece, integral, over_quadratic};
