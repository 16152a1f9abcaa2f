//! Given friction; `--help` lists the options.

use std::process::ExitCode;

use clap::Parser;
use signorini_examples::options::TrescaOptions;
use signorini_examples::{error, tresca};

fn main() -> ExitCode {
    error::exit(tresca::execute(
        &TrescaOptions::parse(),
        &mut std::io::stdout(),
    ))
}
