//! Total FETI for elasticity with contact: the body is torn into floating subdomains, and everything that holds them
//! (gluing, supports, contact, friction) becomes a row of one matrix `B` with a Lagrange multiplier.
//!
//! For `K u = f + B^T lambda` and row offsets `c` this crate builds, once,
//!
//! | symbol | here | meaning |
//! |---|---|---|
//! | `B = (N, T, B_int, B_Dir)` | [`Gluing`] | rows and their meaning; dependent ones can be left out or kept |
//! | `F = B K+ B^T` | [`DualOperator`] | a [`SymmetricOperator`](signorini_qp::SymmetricOperator) |
//! | `G = R^T B^T`, `e = -R^T f` | [`Coarse`], [`LoadResponse::coarse`] | equilibrium: `G lambda = e` |
//! | `P`, `Q`, `lambda_Im` | [`CoarseFactor`] | projectors and particular solution, optionally with row weights |
//! | `C`, `C C^T = I` | [`OrthonormalCoarse`] | rows that span those of `G`, an [`Equality`](signorini_qp::Equality) |
//! | `alpha` | [`CoarseFactor::amplitudes`] | rigid amplitudes in `u = K+ (f + B^T lambda) + R alpha` (5.27) |
//!
//! and two preconditioners ([`Tfeti::lumped`], [`Tfeti::dirichlet`]). The dual problem is: minimise `1/2 lambda^T F
//! lambda - lambda^T d`, `d = c - B K+ f`, subject to `G lambda = e` and the bounds of the contact rows. Multipliers
//! are forces on the body; a normal multiplier is at most zero. The residual of the rows is `B u - c = F lambda - d +
//! G^T alpha`.
//!
//! Everything is immutable once built; the work memory of operators belongs to the caller, and they allocate nothing
//! but messages to other processes. Products
//! run in parallel on the current rayon pool (best called from one of its threads) and are bit-identical for any number
//! of threads.
//! Functions that take an index or a vector panic, like slices, if it is out of range or too short.
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
//! let load = LoadDensity::Traction(brick::Z_MAX, [0.0, 0.0, -1.0e6]);
//! let response = system.load_response(&assemble_load(&mesh, &decomposition, &load)?)?;
//! let factor = system.coarse_factor()?;
//! let mut scratch = factor.scratch();
//! let mut lambda = vec![0.0; system.dual_dim()];
//! factor.particular(&response.coarse, &mut lambda, &mut scratch);
//!
//! let (f, mut product) = (system.dual(), vec![0.0; system.dual_dim()]);
//! f.apply(&lambda, &mut product, &mut f.scratch());
//! println!("{} bytes", system.report().inverse_bytes);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Several processes build one system together, each with the matrices of its subdomains: see [`Communicator`].
//!
//! Modules, each of which uses only those before it: `processes`, `linalg`, `subdomain`, `rows`, `dual`, `coarse`,
//! `projector`, `system`, `preconditioner`.

mod coarse;
mod dual;
mod error;
mod linalg;
mod preconditioner;
mod processes;
mod projector;
mod rows;
mod subdomain;
mod system;
mod tolerances;

pub use coarse::mobility::{BodyMotion, FreeMotion};
pub use coarse::space::Coarse;
pub use coarse::weights::RowWeights;
pub use dual::operator::DualOperator;
pub use error::TfetiError;
pub use preconditioner::explicit::ExplicitInverse;
pub use preconditioner::operator::DualPreconditioner;
pub use processes::communicator::{Alone, CommunicationError, Communicator};
pub use processes::exchange::Traffic;
pub use projector::active_set::ActiveSetProjector;
pub use projector::factor::CoarseFactor;
pub use projector::orthonormal::OrthonormalCoarse;
pub use rows::equations::NodalEquation;
pub use rows::gluing::{ContactRows, EquationRow, Gluing, SpringRow, TangentialRows, TiedRows};
pub use rows::ranges::RowRanges;
pub use rows::rigid::RigidSupport;
pub use rows::side::{ContactConstraint, Side};
pub use rows::supports::{Directions, Motion, NodalSpring, NodeSupport};
pub use subdomain::cost::InverseSettings;
pub use system::builder::TfetiBuilder;
pub use system::recovery::LoadResponse;
pub use system::report::SetupReport;
pub use system::tfeti::Tfeti;

/// Plumbing for the other crates of the workspace, without promises.
#[doc(hidden)]
pub mod internal {
    pub use crate::coarse::space::CoarseScratch;
    pub use crate::dual::boundary::PanelScratch;
    pub use crate::dual::formed_size::{RowGroups, may_be_formed};
    pub use crate::linalg::{of_length, zeros};
    pub use crate::preconditioner::explicit::{ExplicitCost, ExplicitScratch};
    pub use crate::preconditioner::operator::DualPreconditionerScratch;
    pub use crate::processes::threads::on_ranks;
    pub use crate::projector::active_set::ActiveSetFactor;
    pub use crate::projector::forecast::forecast_levels;
    pub use crate::rows::contact::{HeldTie, PrescribedPoint, held_ties, prescribed_points};
    pub use crate::rows::dependencies::Dependency;
    pub use crate::rows::equations::independent_equations;
    pub use crate::rows::rigid::forces_at_three;
    pub use crate::rows::supports::{FixedDirection, MergedSupports};
    pub use crate::subdomain::class::{Class, Classes};
    pub use crate::subdomain::copy_stiffness::CopyStiffness;
    pub use crate::subdomain::cost::{ClassReport, InverseKind};
    pub use crate::subdomain::forecast::{CoarseForecast, Forecast};
    pub use crate::subdomain::kernel::Kernel;
    pub use crate::subdomain::rate::Rate;
    pub use crate::system::part::SystemPart;
    pub use crate::tolerances::RIGID;
}
