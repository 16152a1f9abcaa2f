//! Exchanges of one system: counted, and after a failure none.

use super::communicator::{Alone, CommunicationError, Communicator};
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

/// What a rank has exchanged with the others so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Traffic {
    /// Gathers.
    pub exchanges: u64,
    /// Bytes that this rank contributed; each other rank was sent them.
    pub sent: u64,
    /// Bytes of the others.
    pub received: u64,
}

/// The ranks of a system. With one rank nothing is done.
#[derive(Debug)]
pub(crate) struct Exchange {
    communicator: Arc<dyn Communicator>,
    exchanges: AtomicU64,
    sent: AtomicU64,
    received: AtomicU64,
    failure: OnceLock<CommunicationError>,
}

impl Default for Exchange {
    fn default() -> Self {
        Self::new(Arc::new(Alone))
    }
}

impl Exchange {
    pub(crate) fn new(communicator: Arc<dyn Communicator>) -> Self {
        Self {
            communicator,
            exchanges: AtomicU64::new(0),
            sent: AtomicU64::new(0),
            received: AtomicU64::new(0),
            failure: OnceLock::new(),
        }
    }

    pub(crate) fn rank(&self) -> usize {
        self.communicator.rank()
    }

    pub(crate) fn ranks(&self) -> usize {
        self.communicator.size()
    }

    pub(crate) fn traffic(&self) -> Traffic {
        let read = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        Traffic {
            exchanges: read(&self.exchanges),
            sent: read(&self.sent),
            received: read(&self.received),
        }
    }

    /// The first failure; all that was gathered since is not a number.
    pub(crate) fn check(&self) -> Result<(), CommunicationError> {
        self.failure.get().map_or(Ok(()), |error| Err(error.clone()))
    }

    /// Completes `values`, of which this rank has set those in its part. After a failure all of them are NaN, so that
    /// solvers, which know nothing of ranks, end soon.
    pub(crate) fn gather(&self, values: &mut [f64], parts: &[Range<usize>]) {
        if self.ranks() == 1 {
            return;
        }
        let own = parts[self.rank()].len();
        let all: usize = parts.iter().map(Range::len).sum();
        let count = |counter: &AtomicU64, more: usize| counter.fetch_add(more as u64, Ordering::Relaxed);
        count(&self.exchanges, 1);
        count(&self.sent, 8 * own);
        count(&self.received, 8 * (all - own));
        if self.failure.get().is_none()
            && let Err(error) = self.communicator.gather(values, parts)
        {
            let _ = self.failure.set(error);
        }
        if self.failure.get().is_some() {
            values.fill(f64::NAN);
        }
    }

    /// The same for parts in any order: `pieces` says which rank has set which numbers.
    pub(crate) fn complete(&self, values: &mut [f64], pieces: &[(usize, Range<usize>)]) {
        if self.ranks() == 1 {
            return;
        }
        let mut packed = Vec::with_capacity(pieces.iter().map(|(_, range)| range.len()).sum());
        let mut parts = Vec::with_capacity(self.ranks());
        let of = |rank: usize| {
            pieces
                .iter()
                .filter(move |piece| piece.0 == rank)
                .map(|piece| piece.1.clone())
        };
        for rank in 0..self.ranks() {
            let start = packed.len();
            of(rank).for_each(|range| packed.extend_from_slice(&values[range]));
            parts.push(start..packed.len());
        }
        self.gather(&mut packed, &parts);
        let mut rest = &packed[..];
        for range in (0..self.ranks()).flat_map(of) {
            let (own, tail) = rest.split_at(range.len());
            values[range].copy_from_slice(own);
            rest = tail;
        }
    }
}
