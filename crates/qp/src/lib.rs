//! Quadratic programming with bounds, discs and linear equalities (in construction).

pub mod operator;
pub mod vector;

pub use operator::{Equality, SymmetricOperator};
