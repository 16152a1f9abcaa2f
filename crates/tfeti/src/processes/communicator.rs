//! What processes ask of one another.

use std::fmt::Debug;
use std::ops::Range;

signorini_fem_mesh::errors! {
    /// Processes that solve a problem together lost one another.
    #[derive(Clone, PartialEq, Eq)]
    CommunicationError {
        Lost { rank: usize } =
            "rank {rank} has ended before the others, which cannot go on without it; its own message says why: mend \
            that and start all ranks again";
        OutOfStep { rank: usize, expected: usize, found: usize } =
            "rank {rank} sent {found} numbers where {expected} belong: the ranks do not run the same program on the \
            same scene with the same settings; start one program on one kind of processor everywhere";
        NoRank { rank: usize, size: usize } =
            "the communicator is rank {rank} of {size}; ranks are numbered from 0, each less than their number";
        TooLong { numbers: usize } =
            "the {numbers} numbers of one rank are more than a message can hold; use more ranks";
    }
}

/// The processes that solve a problem together, each with its *rank*. Every rank runs the same program on the same
/// scene; the matrices of the subdomains are spread over the ranks, and what belongs to a vector is gathered from all.
///
/// Calls are collective: all ranks make the same ones in the same order. Results have the same bits for any number of
/// ranks on processors of one kind, since nothing is added up on the way.
pub trait Communicator: Debug + Send + Sync {
    /// Number of this rank, from 0.
    fn rank(&self) -> usize;

    /// Number of ranks.
    fn size(&self) -> usize;

    /// Completes `values`: on entry those in `parts[rank]` are set, on return those in the parts of all ranks. Parts
    /// follow one another, one a rank, and may be empty. Meanwhile, or first, it does `work`, once, which needs none of
    /// the values: a rank that is early waits for the others that much less.
    ///
    /// # Errors
    /// [`CommunicationError`]; what is in the parts of other ranks is then undefined. The work is done in any case.
    fn gather_while(
        &self,
        values: &mut [f64],
        parts: &[Range<usize>],
        work: &mut dyn FnMut(),
    ) -> Result<(), CommunicationError>;
}

/// One process: nothing to gather.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Alone;

impl Communicator for Alone {
    fn rank(&self) -> usize {
        0
    }

    fn size(&self) -> usize {
        1
    }

    fn gather_while(
        &self,
        _: &mut [f64],
        _: &[Range<usize>],
        work: &mut dyn FnMut(),
    ) -> Result<(), CommunicationError> {
        work();
        Ok(())
    }
}
