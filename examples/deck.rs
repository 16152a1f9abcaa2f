//! Runs a CalculiX or Abaqus deck: `cargo run --release --example deck -- part.inp --out DIR`.
//!
//! It is the program `signorini` of `crates/cli`, for those who have not installed it; `docs/how-to/decks.md` shows what
//! a program of your own needs.

use signorini::prelude::*;

pub use signorini_cli::command;

fn main() -> Result<(), Error> {
    command(std::env::args().skip(1))
}
