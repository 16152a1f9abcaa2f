//! Total FETI for elasticity with contact: the body is torn into subdomains that all float, and everything that
//! holds them (gluing, supports, contact, friction) becomes a row of one matrix `B` with a Lagrange multiplier.
//!
//! For `K u = f + B^T lambda` and row offsets `c` this crate builds, once,
//!
//! | symbol | here | meaning |
//! |---|---|---|
//! | `B = (N, T, B_int, B_Dir)` | [`Gluing`] | rows and their names; dependent rows are removed and reported, or kept where contact needs them |
//! | `R` | [`Kernel`] | six orthonormal rigid motions of a subdomain, without eigenvalue computation |
//! | `F = B K+ B^T` | [`DualOperator`] | the dual operator, a [`SymmetricOperator`](signorini_qp::SymmetricOperator) |
//! | `G = R^T B^T`, `e = -R^T f` | [`Coarse`], [`LoadResponse::coarse`] | equilibrium of the subdomains, `G lambda = e` |
//! | `P`, `Q`, `lambda_Im` | [`CoarseFactor`] | projectors and particular solution, with row weights if wanted |
//! | `C`, `C C^T = I` | [`OrthonormalCoarse`] | orthonormal rows that span those of `G`, an [`Equality`](signorini_qp::Equality) |
//! | `alpha` | [`CoarseFactor::amplitudes`] | rigid amplitudes in `u = K+ (f + B^T lambda) + R alpha` (5.27) |
//!
//! and two preconditioners ([`Tfeti::lumped`], [`Tfeti::dirichlet`]). The dual problem is: minimise
//! `1/2 lambda^T F lambda - lambda^T d`, `d = c - B K+ f`, subject to `G lambda = e` and the bounds of the contact rows.
//! Multipliers are forces on the body; a normal multiplier is at most zero. The residual of the rows is
//! `B u - c = F lambda - d + G^T alpha`.
//!
//! Subdomains that are translations of one another share one matrix and are applied together ([`Classes`]); for others a
//! cost model chooses between dense blocks and sparse factors ([`InverseSettings`]). Everything is immutable once built and
//! applied without allocation with work memory that the caller owns; results have the same bits for any number of threads.
//! Products run in parallel on the current rayon pool. An iteration is best run on one of its threads (`rayon::scope`): called from
//! outside of it, each parallel part changes threads twice.
//!
//! ```
//! use signorini_fem_mesh::{Decomposition, Hooke, LoadDensity, Materials, assemble_load, brick};
//! use signorini_qp::SymmetricOperator;
//! use signorini_tfeti::{NodeSupport, TfetiBuilder};
//!
//! let mesh = brick::Brick::new([3.0, 1.0, 1.0], [6, 2, 2]).build()?;
//! let decomposition = Decomposition::boxes(&mesh, [3, 1, 1])?;
//! let materials = Materials::uniform(Hooke::isotropic(211.9e9, 0.277)?);
//! let supports = [NodeSupport::fixed(mesh.nodes_on(brick::X_MIN))];
//! let system = TfetiBuilder::new(&mesh, &decomposition, &materials).with_supports(&supports).build()?;
//!
//! let load = LoadDensity::traction(brick::Z_MAX, [0.0, 0.0, -1.0e6]);
//! let response = system.load_response(&assemble_load(&mesh, &decomposition, &load)?)?;
//! let factor = system.coarse_factor();
//! let mut scratch = factor.scratch();
//! let mut lambda = vec![0.0; system.dual_dim()];
//! factor.particular(&response.coarse, &mut lambda, &mut scratch);
//!
//! let (f, mut product) = (system.dual(), vec![0.0; system.dual_dim()]);
//! f.apply(&lambda, &mut product, &mut f.scratch());
//! println!("{}", system.report());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod block_rows;
mod boundary;
mod class;
mod coarse;
mod coarse_factor;
mod coarse_matrix;
mod coarse_order;
mod coarse_tree;
mod contact;
mod contact_fronts;
mod copy_stiffness;
mod cost;
mod dense;
mod dependencies;
mod dual;
mod error;
mod face_space;
mod forecast;
mod gluing;
mod inverse;
mod joints;
mod kernel;
mod matrices;
mod mobility;
mod packed;
mod panels;
mod preconditioner;
mod recovery;
mod report;
mod row_stiffness;
mod row_weights;
mod rows;
mod scaling;
mod sparse;
mod split_factor;
mod split_solve;
mod supernodes;
mod supports;
mod system;
mod torn;

pub use class::{Class, Classes, Sharing};
pub use coarse::{Coarse, CoarseScratch};
pub use coarse_factor::{CoarseFactor, OrthonormalCoarse};
pub use contact::{ContactConstraint, ContactConstraints, PrescribedPoint, prescribed_points};
pub use copy_stiffness::CopyStiffness;
pub use cost::{InverseKind, InverseSettings};
pub use dependencies::Dependency;
pub use dual::{DualOperator, DualScratch};
pub use error::TfetiError;
pub use face_space::{ActiveSetFactor, ActiveSetProjector};
pub use forecast::{ClassForecast, Forecast, Rate};
pub use gluing::{ContactRows, Gluing, TangentialRows};
pub use kernel::Kernel;
pub use mobility::{BodyMotion, FreeMotion};
pub use preconditioner::{DualPreconditioner, DualPreconditionerScratch};
pub use recovery::{Jump, LoadResponse};
pub use report::{ClassReport, SetupReport};
pub use row_weights::{LineWeight, RowWeights};
pub use rows::{RemovalReason, RemovedRow, RowKind, RowRanges, RowScaling, count_removed};
pub use supports::{Directions, Motion, NodeSupport, PrescribedDirection, prescribed_directions};
pub use system::{Tfeti, TfetiBuilder};
