//! Strain, stress and energy of a displacement of the mesh, and its distance from others.
//!
//! A displacement holds component i of node n at 3 n + i. Strains and stresses are constant in each linear tetrahedron,
//! linear in a quadratic one; they are in Voigt order xx, yy, zz, yz, xz, xy, strains with engineering shear. `strain`
//! has these, `norms` integrals for errors against a known displacement, `difference` the energy between displacements
//! of two meshes.
//!
//! Uses: `element`, `material`, `mesh`, `vec3`. In: a mesh and a displacement. Out: values a tetrahedron or node,
//! norms.

mod difference;
mod norms;
mod strain;

pub use difference::energy_of_difference;
pub use norms::integrate;
pub use strain::{FieldError, nodal_average, nodal_stresses, principal, strain_energy, strains, stresses, von_mises};

pub(crate) use strain::{expect_entries, nodal_vectors};
