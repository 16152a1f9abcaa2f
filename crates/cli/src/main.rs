//! The program `signorini`.

use std::process::ExitCode;

fn main() -> ExitCode {
    match signorini_cli::command(std::env::args().skip(1)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("signorini: {error}");
            ExitCode::FAILURE
        }
    }
}
