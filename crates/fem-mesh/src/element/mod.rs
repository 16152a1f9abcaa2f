//! Elements, and integrals over them.
//!
//! `p1` is the linear tetrahedron: gradients of its shape functions, strain, blocks of stiffness; `p2` the quadratic
//! one, `columns` what assembly takes of both. `piece` has a displacement in a tetrahedron of either kind, and
//! integrals over a mesh.
//!
//! Uses: `material`, `mesh`, `quadrature`, `vec3`. In: the points of an element. Out: gradients, blocks of stiffness,
//! integrals.

mod columns;
mod p1;
mod p2;
mod piece;

pub use columns::TetNodes;
pub use p1::Element;
pub use piece::shape_gradients;

pub(crate) use p1::Block;
pub(crate) use p2::QuadraticElement;
pub(crate) use piece::{Piece, integral, over_quadratic};
