//! Plain programs, each in one file; `cargo run --release --example NAME` runs them.
//!
//! | program | shows |
//! |---|---|
//! | `first` | the program of the README |
//! | `tresca` | a slip bound that is data, by two methods |
//! | `two_bodies` | a pad on a rail |
//! | `own_mesh` | a mesh of Gmsh, files for ParaView |
//! | `restart` | a run that is stopped and continued |
//! | `qp_only` | quadratic programming without mechanics |
//!
//! What is measured and reported about the library is in the package `signorini-studies`.

/// The pieces of code in the guide compile.
#[cfg(doctest)]
#[doc = include_str!("../docs/guide.md")]
pub struct Guide;
