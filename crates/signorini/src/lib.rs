//! Three-dimensional quasistatic contact with Coulomb friction by Total FETI: the facade.
//!
//! It re-exports the crates below; [`prelude`] has what most programs need.
//!
//! | module | package | holds |
//! |---|---|---|
//! | [`fem_mesh`] | `signorini-fem-mesh` | tetrahedra of order 1 and 2, elasticity, loads, decomposition, files |
//! | [`qp`] | `signorini-qp` | quadratic programming: KPRGP, SMALSE, active sets |
//! | [`tfeti`] | `signorini-tfeti` | gluing, kernels, generalised inverses, dual operator, projectors |
//! | [`contact`] | `signorini-contact` | scenes, plans, time steps, Coulomb friction, certificates |
//! | `deck` | `signorini-deck` (feature `deck`) | CalculiX and Abaqus decks as scenes |
//!
//! ```
//! use signorini::prelude::*;
//!
//! # fn main() -> Result<(), Error> {
//! // a steel brick, clamped at one end, is pressed on a rough floor 0.1 m below it and pulled along
//! let mesh = Brick::new([3.0, 1.0, 1.0], [6, 2, 2]).build()?;
//! let steel = Hooke::isotropic(211.9e9, 0.277)?;
//! let scene = Scene::new(mesh, Materials::uniform(steel))
//!     .with_support(Support::fixed(brick::X_MIN))
//!     .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -3e9]).with_history(History::ramp(1.0, 1.0)?))
//!     .with_load(Load::traction(brick::X_MAX, [9e8, 0.0, -15e8]).with_history(History::ramp(1.0, 1.0)?))
//!     .with_contact(Contact::rigid(brick::Z_MIN).with_gap(0.1).with_friction(Friction::coulomb(0.3)))
//!     .with_boxes([3, 1, 1])
//!     .with_analysis(Analysis::quasistatic(1.0, 5));
//! let mut simulation = Simulation::new(scene, Settings::default())?;
//! println!("{}", simulation.plan());
//! while !simulation.is_finished() {
//!     let result = simulation.step()?;
//!     let sum = result.summary();
//!     println!("t = {:.2} s: {} nodes touch, {} slide", result.time(), sum.active, sum.slip);
//!     assert!(result.report().status.converged() && result.certificate().largest() < 1e-6);
//! }
//! # Ok(())
//! # }
//! ```
//!
//! Features: `vtu` writes ParaView files, `gmsh` reads Gmsh meshes, `deck` reads CalculiX and Abaqus decks,
//! `checkpoint` turns states into bytes and back, `serde` serialises step reports, certificates, reactions,
//! contact points, tags, facets, frames and bricks. All are off by default.

pub use signorini_contact as contact;
#[cfg(feature = "deck")]
pub use signorini_deck as deck;
pub use signorini_fem_mesh as fem_mesh;
pub use signorini_qp as qp;
pub use signorini_tfeti as tfeti;

mod error;
pub use error::Error;

/// The names that a program usually needs.
pub mod prelude {
    pub use crate::Error;
    #[cfg(feature = "checkpoint")]
    pub use signorini_contact::Every;
    pub use signorini_contact::result::{ContactSummary, Reactions, Resultant};
    pub use signorini_contact::{
        Accuracy, Analysis, Certificate, Coefficient, Communicator, Contact, ContactError, ContactPair, ContactState,
        Coupling, DifferenceFormula, Directions, Equation, Flow, Friction, Load, Method, Observer, Obstacle, Part,
        Partition, Place, Plan, PointState, Preconditioner, Progress, RunReport, Scene, Settings, Silent, Simulation,
        SlipBound, Spring, State, StepFailure, StepResult, StepStatus, Support, Warning,
    };
    #[cfg(feature = "vtu")]
    pub use signorini_contact::{ResultField, ResultWriter};
    #[cfg(feature = "deck")]
    pub use signorini_deck::Deck;
    #[cfg(feature = "gmsh")]
    pub use signorini_fem_mesh::gmsh::{GroupNames, read_gmsh};
    pub use signorini_fem_mesh::{
        Brick, Eigenstrain, Facet, FacetTag, History, Hooke, LoadDensity, Materials, TetMesh, brick,
    };
}
