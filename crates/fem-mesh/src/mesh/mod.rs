//! Meshes of tetrahedra with tagged boundary facets, and the surfaces that contact needs of them.
//!
//! `tet_mesh` is the mesh, `check` what its tables must pass, `faces` which tetrahedra meet at which face, `quadratic`
//! mid-nodes, `curved` the geometry of tetrahedra and facets that have them, `cylindrical` directions about an axis,
//! `edit` meshes made from meshes, `cut` opens them, `cells` are hexahedra, prisms and pyramids, `division` makes
//! tetrahedra of them, `brick` a box of cells, `surface` nodal normals, frames, areas and means, `error` what can be
//! wrong.
//!
//! Uses: `tables`, `tolerances`, `vec3`. In: tables of points, tetrahedra and facets. Out: a mesh that has passed all
//! checks.

pub mod brick;
mod cells;
mod check;
mod curved;
mod cut;
mod cylindrical;
mod division;
mod edit;
mod error;
mod faces;
mod quadratic;
mod surface;
mod tet_mesh;

pub use cells::{Cell, CellShape};
#[doc(hidden)]
pub use cells::{EDGES, TET_FACES};
pub use division::{Division, divide_face};
pub use edit::{drop_unused_nodes, merge_nodes, orient_tets};
pub use error::MeshError;
pub use surface::{Surface, SurfaceError, SurfaceFrame};
pub use tet_mesh::{BoundaryFacet, Facet, FacetTag, TetMesh};

pub(crate) use check::extent;
pub(crate) use curved::{NODES, curved_facet, shape, tangents};
#[doc(hidden)]
pub use curved::{facet_area_shares, facet_normals, facet_shape, facet_shares};
#[doc(hidden)]
pub use cylindrical::cylindrical;
pub(crate) use faces::{NONE, connected_sets, face_each_other, face_nodes};
pub(crate) use quadratic::quadratic_tets;
pub(crate) use tet_mesh::facet_area_vector;
#[doc(hidden)]
pub use tet_mesh::tag_list;
