//! Products with `G` straight from tables: one wrench or motion for many rows.
//!
//! `globs` does the interface rows of all nodes that the same subdomains share, `points` nodal rows by node, `rigid`
//! both. Rows of `G` are formed once more in `coarse::matrix`, which needs them as numbers.

mod globs;
mod points;
mod rigid;

pub(crate) use globs::Wrench;
pub(crate) use rigid::RigidTables;
