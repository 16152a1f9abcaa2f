//! What each effect costs, beside the plan's prediction; `--help` lists the options.

use std::process::ExitCode;

use clap::Parser;
use signorini_examples::effects::{EffectsOptions, execute};
use signorini_examples::error;

fn main() -> ExitCode {
    error::exit(execute(&EffectsOptions::parse(), &mut std::io::stdout()))
}
