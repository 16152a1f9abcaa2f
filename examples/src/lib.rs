//! What the examples share, and what they do: each binary under `examples/` reads its options and calls one function here,
//! so that a test can call the same function.
//!
//! | example | what it shows | function |
//! |---|---|---|
//! | `brick` | the benchmark of the paper's section 6, its table beside the paper's, pictures and files | [`app::execute`] |
//! | `frictionless` | the same brick, static and without friction, product by product | [`frictionless::execute`] |
//! | `tresca` | given friction: one quadratic program a level | [`tresca::execute`] |
//! | `bodies` | two elastic bodies: a pad pressed on a rail and pulled along it | [`bodies::execute`] |
//! | `accuracy` | error against products and time: tolerance, mesh, time step, method, effects | [`accuracy::execute`] |
//! | `stability` | hard cases, what the library does with them, and what has to hold | [`stability::app::execute`] |
//! | `effects` | one brick, its effects switched on one by one beside the plan's prediction; estimates | [`effects::execute`] |
//! | `performance` | from the paper's method to the default: products and time of each idea; `--cuts`: subdomains of every shape | [`performance::execute`], [`cuts::execute`] |
//! | `qp_only` | quadratic programming without mechanics | [`qp_only::execute`] |
//! | `first` | the program of the README | |
//!
//! | module | holds |
//! |---|---|
//! | [`brick`] | the scene of the benchmark |
//! | [`paper`] | numbers of the paper's Table 6.1 |
//! | [`run`], [`record`] | running a scene, results as JSON |
//! | [`files`], [`pictures`] | VTU, CSV, SVG |

pub mod accuracy;
pub mod app;
pub mod bodies;
pub mod brick;
pub mod cuts;
pub mod dependence;
pub mod effects;
pub mod error;
pub mod files;
pub mod frictionless;
pub mod options;
pub mod paper;
pub mod performance;
pub mod pictures;
pub mod progress;
pub mod qp_only;
pub mod reactions;
pub mod record;
pub mod run;
pub mod snapshot;
pub mod stability;
pub mod table;
pub mod tresca;

/// The pieces of code in the guide compile.
#[cfg(doctest)]
#[doc = include_str!("../../docs/guide.md")]
pub struct Guide;

pub use error::ExampleError;
