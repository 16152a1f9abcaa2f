//! A factor of `G W G^T` of which only the part that follows the weights of the contact rows is done anew.
//!
//! Uses `linalg`, the matrix of `coarse`, and what `dual` and `processes` know of ranks. `order` cuts the subdomains apart, `tree` groups blocks that are
//! eliminated together, `fronts` knows what contact rows add, `factor` eliminates (a `front` at a time), `shared`
//! eliminates equal regions once, `tiles` stores and `solve` solves, with equal regions together in `alike`. Several
//! processes have a branch of the tree each, in `branches`.
//!
//! Why not faer's: with faer's factor of the whole matrix, made anew at each change (8.9 times the time at n = 10), an
//! iteration of the benchmark (F, lumped, both projectors, a sixth of a change of the active set) takes 1.13, 1.46 and
//! 2.30 times as long at n = 3, 5 and 10. With faer's solves in unshared subdomains, too, it takes 2.8 times as long at
//! n = 4 (F: 3.1 times); loops over groups of one shape are 10 to 15 % of that F. Ratios in one process, one thread.

pub(crate) mod alike;
pub(crate) mod branches;
pub(crate) mod factor;
pub(crate) mod front;
pub(crate) mod fronts;
pub(crate) mod order;
pub(crate) mod shared;
pub(crate) mod solve;
pub(crate) mod tiles;
pub(crate) mod tree;
