//! Elements and their quadrature.
//!
//! `p1` is the linear tetrahedron: gradients of its shape functions, strain, blocks of stiffness. A quadratic one has
//! its place beside it. `quadrature` has rules of degree 5 on tetrahedron and triangle.
//!
//! Uses: `mesh`, `vec3`. In: the points of an element. Out: gradients, blocks of stiffness, integrals.

mod p1;
pub(crate) mod quadrature;

pub use p1::Element;

pub(crate) use p1::{nodal_stress, stiffness_block, strain_of};
