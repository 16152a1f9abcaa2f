//! The promises of this crate, one module each.

mod cells;
mod compact;
mod cut;
mod decomposition;
mod even_parts;
mod fields;
#[cfg(feature = "gmsh")]
mod gmsh;
#[cfg(feature = "gmsh")]
mod gmsh_quadratic;
mod grid;
mod loads;
mod merge;
mod mesh;
mod norms;
#[cfg(feature = "vtu")]
mod output;
#[cfg(feature = "vtu")]
mod output_together;
mod quadratic;
mod recovery;
mod refusals;
mod stiffness;
mod surface;

// for the grid of cells
use signorini_fem_mesh::mesh::CellShape;
