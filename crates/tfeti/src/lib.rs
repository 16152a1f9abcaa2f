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

mod coarse;
mod dual;
mod error;
mod linalg;
mod preconditioner;
mod projector;
mod rows;
mod subdomain;
mod system;
mod tolerances;

pub use coarse::mobility::{BodyMotion, FreeMotion};
pub use coarse::space::{Coarse, CoarseScratch};
pub use coarse::weights::RowWeights;
pub use dual::operator::{DualOperator, DualScratch};
pub use error::TfetiError;
pub use preconditioner::operator::{DualPreconditioner, DualPreconditionerScratch};
pub use projector::active_set::{ActiveSetFactor, ActiveSetProjector};
pub use projector::factor::CoarseFactor;
pub use projector::orthonormal::OrthonormalCoarse;
pub use rows::contact::{PrescribedPoint, prescribed_points};
pub use rows::dependencies::Dependency;
pub use rows::gluing::{ContactRows, Gluing, TangentialRows};
pub use rows::kinds::{RemovalReason, RemovedRow, RowKind, RowRanges};
pub use rows::side::{ContactConstraint, ContactConstraints, Side};
pub use rows::supports::{
    Directions, Motion, NodeSupport, PrescribedDirection, prescribed_directions,
};
pub use subdomain::class::{Class, Classes};
pub use subdomain::copy_stiffness::CopyStiffness;
pub use subdomain::cost::{InverseKind, InverseSettings};
pub use subdomain::forecast::{ClassForecast, Forecast, Rate};
pub use subdomain::kernel::Kernel;
pub use system::builder::TfetiBuilder;
pub use system::recovery::{Jump, LoadResponse};
pub use system::report::{ClassReport, SetupReport};
pub use system::tfeti::Tfeti;
