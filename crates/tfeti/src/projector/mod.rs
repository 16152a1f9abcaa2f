//! Factors of `G W G^T` and what is made of them: projectors, orthonormal rows, the projector of active sets.
//!
//! Uses `coarse` and what it uses. In go the coarse space and weights of the rows; out come the projectors `P`, `Q` and
//! particular solutions (`factor`), rows with `C C^T = I` (`orthonormal`), and projectors for weights that change at
//! every active set (`active_set`), with a factor of which only a part is done anew (`split`), or with one that stays
//! and a small model that follows (`levels`, `model`). `forecast` counts what these store before there is a matrix.

pub(crate) mod active_set;
pub(crate) mod factor;
pub(crate) mod forecast;
pub(crate) mod levels;
pub(crate) mod model;
pub(crate) mod orthonormal;
pub(crate) mod split;
