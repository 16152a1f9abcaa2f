//! The settings: how a scene is solved.
//!
//! The method of a step, its accuracy and when it ends, and what the set-up shares and holds.
//!
//! Uses: errors only (and the settings of `qp` and `tfeti`, which are part of these).
//! In: calls of `with_*`. Out: [`Settings`], checked once by plan and simulation.

mod accuracy;
mod method;
mod settings;

pub use accuracy::Accuracy;
pub(crate) use method::paper_smalse;
pub use method::{InnerAccuracy, Method, MethodKind};
pub use settings::{Preconditioner, Settings};
