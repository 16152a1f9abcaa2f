//! Files: Gmsh meshes in, VTU files and PVD series out, and atomic replacement of files.
//!
//! Uses: `mesh`. In: bytes, or a mesh with fields. Out: a mesh, or files.

#[cfg(feature = "gmsh")]
pub mod gmsh;
#[cfg(feature = "vtu")]
pub mod output;
mod replace;

pub use replace::replace_file;
