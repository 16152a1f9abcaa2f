//! Tetrahedral meshes, linear elasticity elements, loads, decomposition and surface frames.

pub mod brick;
pub mod fields;
#[cfg(feature = "gmsh")]
pub mod gmsh;
#[cfg(feature = "vtu")]
pub mod output;

mod assembly;
mod decomposition;
mod element;
mod history;
mod hooke;
mod load;
mod materials;
mod mesh;
mod norms;
mod quadrature;
mod surface;
mod vec3;

pub use assembly::{AssemblyError, assemble_stiffness, subdomain_stiffness};
pub use brick::{Brick, BrickError};
pub use decomposition::{
    Decomposition, DecompositionError, NodeCopy, Subdomain, split_disconnected,
};
pub use element::{Element, element_stiffness};
pub use fields::FieldError;
pub use history::{History, HistoryError};
pub use hooke::{Hooke, HookeError};
pub use load::{LoadDensity, LoadError, PointField, SurfaceField, assemble_load};
pub use materials::{MaterialError, Materials};
pub use mesh::{
    BoundaryFacet, Facet, FacetTag, MeshError, TetMesh, drop_unused_nodes, orient_tets,
};
pub use norms::{h1_seminorm_error, l2_error};
pub use surface::{Frame, Surface, SurfaceError};
