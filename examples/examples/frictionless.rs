//! The brick, static and without friction; `--help` lists the options.

use std::process::ExitCode;

use clap::Parser;
use signorini_examples::options::FrictionlessOptions;
use signorini_examples::{error, frictionless};

fn main() -> ExitCode {
    error::exit(frictionless::execute(
        &FrictionlessOptions::parse(),
        &mut std::io::stdout(),
    ))
}
