//! Checks that share no code with the solvers, and the estimate of a norm.
//!
//! `kkt` measures how far a point is from optimality, `laws` whether operators, equalities and sets keep the laws
//! that solvers rely on, `norm` bounds the norm of an operator from above.
//!
//! Uses: `problem`, `vector`, `settings`, `error`, `tolerances`. In: a problem and a point, or an implementation.
//! Out: figures.

pub mod kkt;
pub mod laws;
mod norm;

pub use norm::{NormEstimate, norm_estimate};
