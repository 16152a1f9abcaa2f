//! What belongs to a single subdomain, or to all translates of it.
//!
//! Uses `linalg` and `processes`. In go mesh, decomposition and materials. Out come classes of translates (`class`),
//! stiffness matrix and rigid motions of each (`matrices`, `kernel`), who of several ranks holds them (`ownership`), a
//! generalised inverse (`inverse`; `held` where supports hold slices, `packed` for one right-hand side), the choice
//! between a dense and a sparse one (`cost`), the stiffness of the copies of a node (`copy_stiffness`) and the sizes
//! that a set-up will have (`forecast`), with the speed of the machine (`rate`).

pub(crate) mod class;
pub(crate) mod copy_stiffness;
pub(crate) mod cost;
pub(crate) mod forecast;
pub(crate) mod held;
pub(crate) mod inverse;
pub(crate) mod kernel;
pub(crate) mod matrices;
pub(crate) mod ownership;
pub(crate) mod packed;
pub(crate) mod rate;
