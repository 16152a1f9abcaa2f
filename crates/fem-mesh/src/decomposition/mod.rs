//! Subdomains of a mesh, and the copies of each node in them.
//!
//! `subdomains` is the decomposition; `boxes` cuts it by a grid, `parts` takes the part numbers of a partitioner,
//! `compact` makes ragged parts compact, `cracks` splits those on both sides of one, and `even` makes parts for a mesh
//! without any, along the axes of `frame` where bodies lie obliquely.
//!
//! Uses: `mesh`, `tables`, `vec3`. In: a mesh, and a grid or part numbers. Out: subdomains connected through faces.

mod boxes;
mod compact;
mod cracks;
mod even;
mod frame;
mod parts;
mod subdomains;

pub use compact::compact_parts;
pub use even::{PartCount, even_parts, is_strongly_graded};
pub use parts::{split_disconnected, volumes_and_surfaces};
pub use subdomains::{Decomposition, DecompositionError, NodeCopy, Rigid, Subdomain};
