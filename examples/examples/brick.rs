//! The brick benchmark; `--help` lists the options.

use std::process::ExitCode;

use clap::Parser;
use signorini_examples::options::BrickOptions;
use signorini_examples::{app, error};

fn main() -> ExitCode {
    error::exit(app::execute(&BrickOptions::parse(), &mut std::io::stdout()))
}
