//! What accuracy costs in time; `--help` lists the options.

use std::process::ExitCode;

use clap::Parser;
use signorini_examples::accuracy::{AccuracyOptions, execute};
use signorini_examples::error;

fn main() -> ExitCode {
    error::exit(execute(&AccuracyOptions::parse(), &mut std::io::stdout()))
}
