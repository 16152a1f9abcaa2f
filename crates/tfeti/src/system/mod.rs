//! The whole system of a body: built once, immutable.
//!
//! Uses all folders but `preconditioner`. In go mesh, decomposition, materials, supports and contact constraints
//! (`builder`); out comes [`Tfeti`](crate::Tfeti) with its operators and a `report`. `recovery` goes between loads,
//! displacements and dual vectors, `torn` applies stiffness and inverse subdomain by subdomain, `row_stiffness` tells
//! what single rows feel, `part` is a system whose vectors are spread over ranks.

pub(crate) mod builder;
pub(crate) mod part;
pub(crate) mod recovery;
pub(crate) mod report;
pub(crate) mod row_stiffness;
pub(crate) mod tfeti;
pub(crate) mod torn;
