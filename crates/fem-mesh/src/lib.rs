//! Tetrahedral meshes and linear elasticity for domain decomposition with contact.
//!
//! This crate discretises a body: meshes of linear or quadratic tetrahedra with tagged boundary facets,
//! stiffness matrices, consistent loads, subdomains, and the normals, tangents and areas of contact surfaces. It
//! contains no solver. It is the lowest layer of [`signorini`](https://github.com/signorini-rs/signorini) and can be
//! used on its own.
//!
//! | you want | you use |
//! |---|---|
//! | a mesh | [`Brick`], [`TetMesh::new`], [`mesh::Division`] (of hexahedra, prisms, pyramids), [`gmsh::read_gmsh`](gmsh) (feature `gmsh`) |
//! | a modified mesh | [`TetMesh::raise_order`], [`TetMesh::map_points`], [`TetMesh::append`], [`TetMesh::tag_boundary`] |
//! | a material | [`Hooke`] (general or isotropic), [`Materials`] by region |
//! | a stiffness | [`assemble_stiffness`], [`Element`] |
//! | a load | [`LoadDensity`] and [`assemble_load`]; [`Eigenstrain`] (temperature, pretension); [`History`] for its factor in time |
//! | subdomains | [`Decomposition`]: boxes, given parts, or the whole mesh; [`decomposition`] makes parts |
//! | a contact surface | [`Surface`] with a [`SurfaceFrame`] and an area at each node |
//! | stresses, energy, errors | [`fields`] |
//! | an estimate of the discretisation error | [`recovery::discretisation_error`], [`recovery::StrainRecovery`] |
//! | the difference of results on two meshes | [`fields::energy_of_difference`] |
//! | files for pictures | [`output`] (feature `vtu`): VTU files and PVD series for ParaView |
//!
//! # Example
//!
//! A block of 3 m x 1 m x 1 m, cut into three cubes and pressed from above:
//!
//! ```
//! use signorini_fem_mesh::brick::{Brick, Z_MAX, Z_MIN};
//! use signorini_fem_mesh::{Decomposition, Hooke, LoadDensity, Surface, assemble_load, assemble_stiffness};
//!
//! let mesh = Brick::new([3.0, 1.0, 1.0], [15, 5, 5]).build()?;
//! let steel = Hooke::isotropic(211.9e9, 0.277)?;
//!
//! let parts = Decomposition::boxes(&mesh, [3, 1, 1])?;
//! assert_eq!(parts.torn_dofs(), 1944);
//! let first = &parts.subdomains()[0];
//! let stiffness = assemble_stiffness(&first.points(&mesh), &first.tets, |_| &steel)?;
//! assert_eq!(stiffness.shape(), (648, 648));
//!
//! let pressure = LoadDensity::Pressure(Z_MAX, 1e6);
//! let forces = assemble_load(&mesh, &parts, &pressure)?;
//! let resultant: f64 = forces.iter().flatten().sum();
//! assert!((resultant + 3e6).abs() < 1e-6);
//!
//! let foundation = Surface::new(&mesh, &[Z_MIN])?;
//! assert_eq!(foundation.frames()[0].normal, [0.0, 0.0, -1.0]);
//! assert!((foundation.total_area() - 3.0).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Conventions
//!
//! - Points are `[f64; 3]`. A vector of displacements or forces holds component i of node n at
//!   3 n + i. Tables store node, tetrahedron and subdomain numbers as `u32`.
//! - A tetrahedron is positive if det(p1 - p0, p2 - p0, p3 - p0) > 0; facets are counter-clockwise
//!   seen from outside.
//! - Six-component strains and stresses are in the order xx, yy, zz, yz, xz, xy; strains carry
//!   the engineering shear (twice the tensor component).
//! - Any consistent units will do. All tolerances are relative, so that results do not depend on the choice.
//!
//! # What can go wrong
//!
//! Every type checks its input on construction and returns a typed error that names the place and a remedy:
//! [`MeshError`], [`brick::BrickError`], [`HookeError`], [`MaterialError`], [`DecompositionError`],
//! [`SurfaceError`], [`LoadError`], [`HistoryError`], [`FieldError`]. `{:?}` prints the same message as `{}`, so that a
//! `main` that returns an error shows it. Later operations rely on these checks and do not repeat them. Accessors
//! panic if an index is out of range, like slices.
//!
//! # Parallelism
//!
//! Loops over nodes, elements and subdomains run on the current [`rayon`] pool. Sums have a fixed
//! order, so results are bit-identical for any number of threads.
//!
//! # Features
//!
//! None is on by default. `vtu` adds [`output`] (crate flate2), `gmsh` adds [`gmsh`], `serde` lets
//! [`FacetTag`], [`Facet`], [`SurfaceFrame`] and [`Brick`] be serialised (crate serde).

#![cfg_attr(not(all(feature = "vtu", feature = "gmsh")), allow(rustdoc::broken_intra_doc_links))]

#[macro_use]
mod errors;

mod assembly;
pub mod decomposition;
mod element;
pub mod fields;
mod files;
pub mod loads;
mod material;
pub mod mesh;
mod quadrature;
pub mod recovery;
mod tables;
mod tolerances;
#[doc(hidden)]
pub mod vec3;

pub use assembly::assemble_stiffness;
pub use decomposition::{Decomposition, DecompositionError};
pub use element::Element;
#[doc(hidden)]
pub use errors::with_sources;
pub use fields::FieldError;
#[cfg(feature = "gmsh")]
pub use files::gmsh;
#[cfg(feature = "vtu")]
pub use files::output;
pub use loads::{History, HistoryError, LoadDensity, LoadError, assemble_eigenstrain, assemble_load};
pub use material::{Eigenstrain, Hooke, HookeError, MaterialError, Materials};
pub use mesh::brick::Brick;
pub use mesh::{Facet, FacetTag, MeshError, Surface, SurfaceError, SurfaceFrame, TetMesh, brick};

/// What the crates of this workspace share beyond the interface.
#[doc(hidden)]
pub mod internal {
    pub use crate::element::{TetNodes, shape_gradients};
    pub use crate::errors::{number, place};
    pub use crate::files::replace_file;
    pub use crate::loads::interpolate;
    pub use crate::loads::tet_forces;
    pub use crate::mesh::{
        EDGES, TET_FACES, cylindrical, facet_area_shares, facet_normals, facet_shape, facet_shares, tag_list,
    };
    pub use crate::quadrature::triangle;
    pub use crate::tables::{DisjointSets, Lists, ascending, count_of, distinct};
}
