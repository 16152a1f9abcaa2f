//! The natural coarse space: `G = R^T B^T`, its matrix `G W G^T`, and the motions that rows leave free.
//!
//! Uses `linalg`, `subdomain`, `rows` and the tables of `dual`. In go gluing and rigid motions, out come products with
//! `G` (`space`, by `products`), the values of `G W G^T` for row weights (`matrix`, `weights`) and rigid motions of
//! bodies that rows do not stop (`mobility`; `joints` finds the bodies), the matrix of `clusters` of subdomains, and
//! products with these matrices (`blocks`). What factors this matrix lives in `projector`.

pub(crate) mod blocks;
pub(crate) mod clusters;
pub(crate) mod joints;
pub(crate) mod matrix;
pub(crate) mod mobility;
pub(crate) mod products;
pub(crate) mod space;
pub(crate) mod weights;
