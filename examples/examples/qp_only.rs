//! Quadratic programming without mechanics.

use std::process::ExitCode;

use signorini_examples::{error, qp_only};

fn main() -> ExitCode {
    error::exit(qp_only::execute(&mut std::io::stdout()))
}
