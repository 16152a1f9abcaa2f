//! A factor of `G W G^T` of which only the part that follows the weights of the contact rows is done anew.
//!
//! Uses `linalg` and the matrix of `coarse`. `order` cuts the subdomains apart, `tree` groups blocks that are
//! eliminated together, `fronts` knows what contact rows add, `factor` eliminates, `tiles` stores and `solve` solves.
//!
//! Why not faer's: an iteration of the benchmark (F, lumped, both projectors, a sixth of a change of the active set)
//! takes 1.13, 1.46, 2.30 times as long at n = 3, 5, 10 with faer's factor of the whole matrix, made anew at each change
//! (727 instead of 82 ms at n = 10). With faer's solves in unshared subdomains, too, it takes 2.8 times as long at n = 4
//! (F: 25.8 instead of 8.3 ms). One thread, both in one process. Loops over groups of one shape save 10 to 15 % of that F.

pub(crate) mod factor;
pub(crate) mod fronts;
pub(crate) mod order;
pub(crate) mod solve;
pub(crate) mod tiles;
pub(crate) mod tree;
