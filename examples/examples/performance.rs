//! The ladder of methods on the brick; `--help` lists the options.

use std::process::ExitCode;

use clap::Parser;
use signorini_examples::error;
use signorini_examples::performance::{PerformanceOptions, execute};

fn main() -> ExitCode {
    error::exit(execute(
        &PerformanceOptions::parse(),
        &mut std::io::stdout(),
    ))
}
