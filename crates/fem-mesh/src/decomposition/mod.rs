//! Subdomains of a mesh, and where each node went.
//!
//! `subdomains` is the decomposition; `boxes` cuts it by a grid, `parts` takes numbers of a partitioner, `compact`
//! makes ragged parts round, and `even` cuts a mesh that comes without parts.
//!
//! Uses: `mesh`, `tables`, `vec3`. In: a mesh, and a grid or part numbers. Out: subdomains connected through faces.

mod boxes;
mod compact;
mod even;
mod parts;
mod subdomains;

pub use compact::compact_parts;
pub use even::{PartCount, even_parts, is_strongly_graded};
pub use parts::split_disconnected;
pub use subdomains::{Decomposition, DecompositionError, NodeCopy, Subdomain};
