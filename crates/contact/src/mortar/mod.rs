//! Two surfaces whose meshes do not match: what each node of the first side sees of the other one.
//!
//! Facets of both sides are laid over one another in the plane of a facet of the first side (`search`), and the covered
//! part of that facet is integrated (`cover`). With dual shape functions a node of the first side keeps one point,
//! whose other side is a list of nodes with weights (`nodes`). Tied sides that are apart take displacements from the
//! tetrahedra behind, on the way to the facet; others turn over it (`discrete::side`).
//!
//! Uses: nothing of this crate but `tolerances`. In: two surfaces. Out: a [`MortarNode`] for each node that the other
//! side faces.

mod cover;
mod nodes;
mod search;

pub(crate) use nodes::{MortarNode, mortar_nodes};
