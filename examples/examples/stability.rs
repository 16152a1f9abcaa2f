//! Hard cases and what the library does with them; `--help` lists the options.

use std::process::ExitCode;

use clap::Parser;
use signorini_examples::error;
use signorini_examples::stability::app::{StabilityOptions, execute};

fn main() -> ExitCode {
    let options = StabilityOptions::parse();
    match execute(&options, &mut std::io::stdout()) {
        Ok(0) => ExitCode::SUCCESS,
        Ok(_) => ExitCode::FAILURE,
        Err(e) => error::exit(Err::<(), _>(e)),
    }
}
