//! Mortar coupling of two surfaces whose meshes do not match.
//!
//! Facets of both sides are intersected in the plane of a facet of the first side (`search`, `pieces`), distances
//! measured at its nodes (`distances`), and integrals taken over the covered part of that facet (`cover`). With dual
//! shape functions each node of the first side has one point, whose other side is a list of nodes with weights
//! (`nodes`); on quadratic facets they are blended with hat functions, but where a gap opens from the rim (`opening`).
//! Across a distance, tied sides extrapolate displacements from the tetrahedra behind, others rotate
//! (`discrete::side`).
//!
//! Uses: `tolerances`, `vec3`. In: two surfaces. Out: a [`MortarNode`] for each node that the other side faces.

mod cover;
mod distances;
mod nodes;
mod opening;
mod pieces;
mod search;

pub(crate) use nodes::{MortarNode, mortar_nodes};
pub(crate) use opening::Rim;
pub(crate) use search::Arcs;
