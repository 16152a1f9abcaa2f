//! Two elastic bodies; `--help` lists the options.

use std::process::ExitCode;

use clap::Parser;
use signorini_examples::options::BodiesOptions;
use signorini_examples::{bodies, error};

fn main() -> ExitCode {
    error::exit(bodies::execute(
        &BodiesOptions::parse(),
        &mut std::io::stdout(),
    ))
}
