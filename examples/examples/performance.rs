//! The ladder of methods on the brick; `--help` lists the options.

use std::process::ExitCode;

use clap::Parser;
use signorini_examples::performance::{PerformanceOptions, execute};
use signorini_examples::{cuts, error};

fn main() -> ExitCode {
    let options = PerformanceOptions::parse();
    let mut out = std::io::stdout();
    if options.cuts {
        return error::exit(cuts::execute(&options, &mut out));
    }
    error::exit(execute(&options, &mut out))
}
