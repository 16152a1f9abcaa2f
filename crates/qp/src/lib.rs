//! Quadratic programming with bounds, discs and linear equalities.
//!
//! Minimise `1/2 x·Ax - b·x` subject to `x` in a product of free components, intervals and discs, and `C x = e` with
//! orthonormal rows of `C`.
//!
//! `A` is only needed in products with vectors. The dual problems of T-FETI with contact and friction have this form
//! (bounds for normal forces, discs for tangential forces, equilibrium as equality), but the crate contains no
//! mechanics.
//!
//! # Methods
//!
//! | function | constraints | reference | vectors besides `x` and `b` |
//! |---|---|---|---|
//! | [`kprgp()`] | set | Kucera 2007, 2008; MPRGP of Dostal and Schoeberl 2005 for bounds | 4 |
//! | [`smalse()`] | set and equality | Algorithm 4.1 of Haslinger, Kucera, Vlach, Baniotopoulos; Dostal 2009 | 6 |
//! | [`active_set()`] | set, equality | projected, preconditioned CG on predicted active sets; no penalty | 6 |
//! | [`interior_point()`] | set | Mehrotra 1992; Kucera, Machalova, Netuka, Zencak 2013; a dense matrix, few steps | a matrix |
//! | [`norm_estimate`] | none | Lanczos with a safe upper bound | 3, for the call |
//! | [`kkt::check`] | set, equality | independent check, shares no code with the solvers | 2, for the call |
//!
//! Solvers take the start in `x` and return the result there. They report counts by cause, and keep all vectors in a
//! workspace that is created once: iterations of conjugate gradients allocate nothing. A tolerance that is not reached
//! is a [`Status`] in an `Ok` report; errors are invalid input or a breakdown ([`QpError`]).
//! [`successive_approximations`] solves problems whose set depends on the solution.
//!
//! # Parts of a problem
//!
//! - The operator: any [`SymmetricOperator`]; [`DenseOperator`] for small matrices. With `b` and a bound of its norm it is a
//!   [`QuadraticCost`], with an equality a [`ConstrainedCost`].
//! - The set: a [`ProductSet`] of [`Segment`]s, or any [`ConvexSet`]; a [`MovingSet`] may follow the solution.
//! - The equality: any [`Equality`], for [`active_set()`] any [`EqualityProjector`]; [`DenseEquality`] and
//!   [`DenseProjector`] for small matrices.
//! - [`laws`] has checkers for your own implementations of the three traits.
//!
//! # Example: a string over an obstacle
//!
//! ```
//! use signorini_qp::{
//!     ConvexSet, KprgpSettings, ProductSet, QuadraticCost, Segment, SymmetricOperator, kkt, kprgp, norm_estimate,
//! };
//! use signorini_qp::kprgp::KprgpWorkspace;
//! use signorini_qp::problem::BlockState;
//!
//! /// Stiffness of a string of `n` inner nodes, held at both ends.
//! struct Stiffness(usize);
//!
//! impl SymmetricOperator for Stiffness {
//!     type Scratch = ();
//!     fn dim(&self) -> usize {
//!         self.0
//!     }
//!     fn scratch(&self) {}
//!     fn apply(&self, x: &[f64], y: &mut [f64], _: &mut ()) {
//!         for i in 0..self.0 {
//!             let left = if i > 0 { x[i - 1] } else { 0.0 };
//!             let right = if i + 1 < self.0 { x[i + 1] } else { 0.0 };
//!             y[i] = 2.0 * x[i] - left - right;
//!         }
//!     }
//! }
//!
//! let n = 49;
//! let stiffness = Stiffness(n);
//! let load = vec![-0.01; n];
//! let obstacle = ProductSet::new(vec![Segment::lower(vec![-1.0; n])])?;
//! let norm = norm_estimate(&stiffness)?.upper;
//! let mut x = vec![0.0; n];
//! let mut work = KprgpWorkspace::new(&stiffness);
//! let settings = KprgpSettings::default();
//! let cost = QuadraticCost::new(&stiffness, &load, norm);
//! let report = kprgp(&cost, &obstacle, 1e-8, &settings, &mut x, &mut work)?;
//! assert!(report.status.converged());
//!
//! let mut resting = 0;
//! obstacle.for_each_block(&x, &mut |block| resting += usize::from(block.state == BlockState::AtLower));
//! assert!(resting > 10);
//! assert!(kkt::check(&cost, &obstacle, &x)?.relative() < 1e-7);
//! # Ok::<(), signorini_qp::QpError>(())
//! ```
//!
//! # Settings
//!
//! Each setter of [`ActiveSetSettings`], [`KprgpSettings`] and [`SmalseSettings`] documents meaning, scale, range,
//! default and the symbol in the paper. All are dimensionless except [`SmalseSettings`]' `least` and the floors of
//! [`ActiveSetSettings`], which have the unit of `x`: a change of units does not change the iteration.
//!
//! # Determinism
//!
//! Every dot product and norm goes through [`vector`], whose sums have a fixed tree, so results are bit-identical for
//! any number of threads. Loops over the set are serial.

pub mod active_set;
pub mod check;
mod error;
mod fixed_point;
pub mod interior_point;
pub mod kprgp;
pub mod problem;
mod report;
#[doc(hidden)]
pub mod settings;
pub mod smalse;
mod tolerances;
pub mod vector;

pub use active_set::{ActiveSetSettings, active_set};
pub use check::{kkt, laws, norm_estimate};
pub use error::{QpError, SetError};
pub use fixed_point::{FixedPointReport, Verdict, successive_approximations};
pub use interior_point::interior_point;
pub use kprgp::{KprgpSettings, kprgp};
pub use problem::{
    ConstrainedCost, ConvexSet, DenseEquality, DenseOperator, DenseProjector, Equality, EqualityProjector, MovingSet,
    ProductSet, Projected, QuadraticCost, Segment, SymmetricOperator,
};
pub use report::{Products, Status, Steps};
pub use smalse::{SmalseSettings, smalse};

/// What the crates of this workspace share beyond the interface.
#[doc(hidden)]
pub mod internal {
    pub use crate::fixed_point::Contraction;
    pub use crate::problem::{LineWeight, LooseMode};
}
