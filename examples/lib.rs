//! Plain programs, each in one file; `cargo run --release --example NAME` runs them.
//!
//! | program | shows |
//! |---|---|
//! | `first` | the program of the README |
//! | `tresca` | a slip bound that is data, by two methods |
//! | `two_bodies` | a pad on a rail |
//! | `bolt` | plates that a tightened bolt holds, until they part |
//! | `crack` | a crack that slides to and fro under pressure |
//! | `from_mesh` | the program of the tutorial: from Gmsh to ParaView |
//! | `own_mesh` | a mesh of Gmsh, files for ParaView |
//! | `deck` | a deck of CalculiX or Abaqus, from file to ParaView |
//! | `parameters` | a study of friction: errors told apart, results as JSON |
//! | `coupled` | with a program of heat flow, step by step |
//! | `restart` | a run that is stopped and continued |
//! | `qp_only` | quadratic programming without mechanics |
//!
//! What is measured and reported about the library is in the package `signorini-studies`.

/// The pieces of code in the how-to pages compile.
#[cfg(doctest)]
#[doc = include_str!("../docs/how-to/loads.md")]
#[doc = include_str!("../docs/how-to/floors-and-walls.md")]
#[doc = include_str!("../docs/how-to/subdomains.md")]
#[doc = include_str!("../docs/how-to/decks.md")]
#[doc = include_str!("../docs/how-to/convergence.md")]
#[doc = include_str!("../docs/how-to/long-runs.md")]
#[doc = include_str!("../docs/how-to/accuracy.md")]
#[doc = include_str!("../docs/how-to/other-programs.md")]
#[doc = include_str!("../docs/how-to/results.md")]
#[doc = include_str!("../docs/how-to/reactions.md")]
pub struct HowTo;
