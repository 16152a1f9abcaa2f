//! Quadratic programming with bounds, discs and linear equalities.

mod block;
mod coarse_space;
pub mod dense;
mod error;
pub mod face;
mod face_settings;
mod face_state;
pub mod kkt;
pub mod kprgp;
mod kprgp_settings;
pub mod laws;
mod objective;
pub mod operator;
mod penalised;
mod product;
mod projected;
mod report;
pub mod set;
pub mod smalse;
mod smalse_settings;
pub mod spectrum;
pub mod vector;

pub use coarse_space::{CoarseSpace, NoCoarseSpace};
pub use dense::{DenseEquality, DenseOperator};
pub use error::{QpError, SetError};
pub use face::{FaceHook, FaceProblem, face};
pub use face_settings::{FaceReport, FaceSettings, FaceWorkspace};
pub use kkt::Kkt;
pub use kprgp::kprgp;
pub use kprgp_settings::{
    Expansion, KprgpReport, KprgpSettings, KprgpWorkspace, Measure, Release, Verification,
};
pub use operator::{Equality, SymmetricOperator};
pub use product::{ProductSet, Segment};
pub use projected::{Projected, ProjectedScratch};
pub use report::{Products, Status, Steps, Tolerance};
pub use set::{Block, BlockKind, BlockState, ConvexSet, GradientNorms};
pub use smalse::smalse;
pub use smalse_settings::{
    HookAction, OuterHook, OuterStep, SmalseReport, SmalseSettings, SmalseWorkspace, Update,
};
pub use spectrum::{NormEstimate, NormSettings, norm_estimate};
