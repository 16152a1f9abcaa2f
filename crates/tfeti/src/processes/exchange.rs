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
        let (rank, size) = (self.rank(), self.ranks());
        if rank >= size {
            return Err(CommunicationError::NoRank { rank, size });
        }
        self.failure.get().map_or(Ok(()), |error| Err(error.clone()))
    }

    /// Completes `values`, of which this rank has set those in its part. After a failure all of them are NaN, so that
    /// solvers, which know nothing of ranks, end soon.
    pub(crate) fn gather(&self, values: &mut [f64], parts: &[Range<usize>]) {
        self.gather_while(values, parts, || ());
    }

    /// The same, and `work` meanwhile.
    pub(crate) fn gather_while(&self, values: &mut [f64], parts: &[Range<usize>], mut work: impl FnMut()) {
        if self.ranks() == 1 {
            return work();
        }
        let own = parts[self.rank()].len();
        let all: usize = parts.iter().map(Range::len).sum();
        let count = |counter: &AtomicU64, more: usize| counter.fetch_add(more as u64, Ordering::Relaxed);
        count(&self.exchanges, 1);
        count(&self.sent, 8 * own);
        count(&self.received, 8 * (all - own));
        if self.failure.get().is_some() {
            work();
        } else if let Err(error) = self.communicator.gather_while(values, parts, &mut work) {
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
        let of = |rank: usize| pieces.iter().filter(move |piece| piece.0 == rank).map(|p| p.1.clone());
        let mut at = 0;
        let part = |rank: usize| {
            let start = at;
            at += of(rank).map(|range| range.len()).sum::<usize>();
            start..at
        };
        let parts: Vec<Range<usize>> = (0..self.ranks()).map(part).collect();
        let mut packed = vec![0.0; at];
        let mut rest = &mut packed[parts[self.rank()].clone()];
        for range in of(self.rank()) {
            let (own, tail) = rest.split_at_mut(range.len());
            own.copy_from_slice(&values[range]);
            rest = tail;
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
