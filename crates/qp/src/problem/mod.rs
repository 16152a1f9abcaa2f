//! The parts of a problem: operator, set, equality; minimise `1/2 x·Ax - b·x` over `x` in a set with `C x = e`.
//!
//! `operator` has the two traits that every solver needs, `dense` matrices that implement them, `projected` the
//! operator `P A P`, `cost` what is minimised. `set` is what a solver asks of a convex set, `moving_set` one that
//! follows the solution, `product` the one set here: segments of blocks, of which `block` has one shape each (interval,
//! disc). `projector` is the equality as the active-set method sees it, `dense_projector` one of a matrix.
//!
//! Uses: `vector`, `error`, `tolerances`. In: what a caller owns. Out: products, projections, steps to the boundary.
//! Solvers are above.

mod block;
mod cost;
mod dense;
mod dense_projector;
mod moving_set;
mod operator;
mod product;
mod projected;
mod projector;
mod set;

pub use cost::{ConstrainedCost, QuadraticCost};
pub(crate) use dense::solve_cholesky;
pub use dense::{DenseEquality, DenseOperator, Diagonal};
pub use dense_projector::DenseProjector;
pub(crate) use moving_set::Hook;
pub use moving_set::MovingSet;
pub use operator::{Equality, SymmetricOperator};
pub use product::{ProductSet, Segment};
pub use projected::Projected;
pub use projector::EqualityProjector;
#[doc(hidden)]
pub use projector::{LineWeight, LooseMode};
pub use set::{Block, BlockState, ConvexSet, GradientNorms};

pub(crate) use product::{Constrained, for_bounds, for_constrained, for_discs};
