//! Tetrahedral meshes, linear elasticity elements, loads, decomposition and surface frames.

pub mod brick;

mod assembly;
mod decomposition;
mod element;
mod history;
mod hooke;
mod load;
mod materials;
mod mesh;
mod quadrature;
mod surface;
mod vec3;

pub use assembly::{AssemblyError, assemble_stiffness, subdomain_stiffness};
pub use brick::{Brick, BrickError};
pub use decomposition::{
    Decomposition, DecompositionError, NodeCopy, Subdomain, split_disconnected,
};
pub use element::{Element, element_stiffness};
pub use history::{History, HistoryError};
pub use hooke::{Hooke, HookeError};
pub use load::{LoadDensity, LoadError, PointField, SurfaceField, assemble_load};
pub use materials::{MaterialError, Materials};
pub use mesh::{
    BoundaryFacet, Facet, FacetTag, MeshError, TetMesh, drop_unused_nodes, orient_tets,
};
pub use surface::{Frame, Surface, SurfaceError};
