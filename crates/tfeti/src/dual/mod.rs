//! The dual operator `F = B K+ B^T`.
//!
//! Uses `linalg`, `processes`, `subdomain` and `rows`. In go gluing and classes, out come gather tables between dual
//! vectors and boundary vectors (`boundary`, filled by `build`; `cut` for several ranks, of which each keeps a `part`
//! of the dual vectors), the inverses of all classes (`inverses`), the product with `F` (`operator`) and `F` as a
//! matrix (`formed`; `formed_size` tells beforehand what that takes).

pub(crate) mod boundary;
pub(crate) mod build;
pub(crate) mod cut;
pub(crate) mod formed;
pub(crate) mod formed_size;
pub(crate) mod inverses;
pub(crate) mod operator;
pub(crate) mod part;
