//! The brick benchmark on several processes: the options, table and files of the study `brick`.
//!
//! `mpirun -n 2 target/release/examples/brick_mpi --n 5 --threads 1`

#[path = "../../../studies/examples/brick/main.rs"]
#[allow(dead_code, unreachable_pub)]
mod brick;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let options = brick::BrickOptions::parse();
    signorini_mpi::run(|communicator| brick::execute_on(&options, communicator, &mut std::io::stdout()).map(|_| ()))
}
