//! Several processes for the [`signorini`](https://github.com/signorini-rs/signorini) contact library, over an MPI
//! installation (Open MPI, MPICH).
//!
//! Every rank runs the same program. It passes the communicator to the settings and otherwise looks like a program for
//! one process:
//!
//! ```no_run
//! use signorini::prelude::*;
//! use std::process::ExitCode;
//!
//! fn main() -> ExitCode {
//!     signorini_mpi::run(|communicator| {
//!         let mesh = Brick::new([3.0, 1.0, 1.0], [30, 10, 10]).build()?;
//!         let scene = Scene::new(mesh, Hooke::isotropic(2.1e11, 0.3)?.into())
//!             .with_support(Support::fixed(brick::X_MIN))
//!             .with_load(Load::pressure(brick::Z_MAX, 1e8))
//!             .with_contact(Contact::rigid(brick::Z_MIN))
//!             .with_subdomains(48);
//!         let settings = Settings::default().with_communicator(communicator);
//!         let mut simulation = Simulation::new(scene, settings)?;
//!         simulation.run(&mut Progress::new(std::io::stderr()))?;
//!         Ok::<(), Error>(())
//!     })
//! }
//! ```
//!
//! `mpirun -n 2 PROGRAM` then solves with two ranks: each holds and applies the matrices of its subdomains, and one
//! gather per product combines the results. On processors of one kind, results are bit-identical for any number of
//! ranks.
//!
//! This package is outside the workspace because it needs MPI and libclang to build.

use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator as _, Destination as _, Equivalence as _, Source as _};
use mpi::{Count, Rank, Threading, request};
use signorini_tfeti::{CommunicationError, Communicator};
use std::fmt::Display;
use std::io::Write;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;
use std::sync::Arc;

/// All ranks that `mpirun` has started.
#[derive(Debug)]
struct World {
    rank: usize,
    size: usize,
}

impl Communicator for World {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.size
    }

    fn gather_while(
        &self,
        values: &mut [f64],
        parts: &[Range<usize>],
        work: &mut dyn FnMut(),
    ) -> Result<(), CommunicationError> {
        let numbers = parts.iter().map(Range::len).max().unwrap_or(0);
        if Count::try_from(numbers).is_err() {
            work();
            return Err(CommunicationError::TooLong { numbers });
        }
        let (mut rest, mut at, mut own, mut others) = (values, 0, &[][..], Vec::with_capacity(parts.len()));
        for (rank, part) in parts.iter().enumerate() {
            let (_, tail) = std::mem::take(&mut rest).split_at_mut(part.start - at);
            let (piece, tail) = tail.split_at_mut(part.len());
            (rest, at) = (tail, part.end);
            if rank == self.rank { own = piece } else { others.push((rank as Rank, piece)) }
        }
        let world = SimpleCommunicator::world();
        // straight from and to where the numbers stand: gathers of MPI copy what a rank sends, and own parts once more
        request::scope(|scope| {
            let to: Vec<_> = others.iter().map(|other| world.process_at_rank(other.0)).collect();
            let mut received = Vec::with_capacity(others.len());
            for ((rank, piece), from) in others.into_iter().zip(&to) {
                received.push((rank, piece.len(), from.immediate_receive_into(scope, piece)));
            }
            let sent: Vec<_> = to.iter().map(|to| to.immediate_send(scope, own)).collect();
            work();
            let mut outcome = Ok(());
            for (rank, expected, request) in received {
                let found = request.wait().count(f64::equivalent_datatype()) as usize;
                if found != expected {
                    let rank = rank as usize;
                    outcome = Err(CommunicationError::OutOfStep { rank, expected, found });
                }
            }
            sent.into_iter().for_each(|request| {
                request.wait();
            });
            outcome
        })
    }
}

/// Starts MPI, runs `work` as this rank with the communicator of all, and ends MPI.
///
/// An error or a panic of one rank is printed with its number and ends all ranks at once, with exit code 1: the others
/// would wait for it for ever. Give it all work of `main` but the reading of options.
pub fn run<E: Display>(work: impl FnOnce(Arc<dyn Communicator>) -> Result<(), E>) -> ExitCode {
    // products call from a thread of the pool
    let Some((universe, threading)) = mpi::initialize_with_threading(Threading::Serialized) else {
        eprintln!("error: MPI has been started already; call signorini_mpi::run once, at the beginning of main");
        return ExitCode::FAILURE;
    };
    let world = universe.world();
    let rank = world.rank();
    if threading < Threading::Serialized {
        let why = "error: this MPI does not serve programs with threads; build or choose another one";
        end_all(&world, why);
    }
    let communicator = World {
        rank: rank as usize,
        size: world.size() as usize,
    };
    match catch_unwind(AssertUnwindSafe(|| work(Arc::new(communicator)))) {
        Ok(Ok(())) => ExitCode::SUCCESS,
        Ok(Err(error)) => end_all(&world, &format!("error: {error}")),
        Err(_) => end_all(&world, "panicked, see above"),
    }
}

/// Ends all ranks and prints why, in one write: `mpirun` mixes what ranks and itself print, piece by piece.
fn end_all(world: &SimpleCommunicator, why: &str) -> ! {
    let line = format!("rank {}: {why}\n", world.rank());
    // nobody is left to tell that the stream is closed
    let _ = std::io::stderr().lock().write_all(line.as_bytes());
    world.abort(1)
}
