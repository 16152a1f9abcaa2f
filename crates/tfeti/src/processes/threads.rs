//! Ranks that are threads of one process: the same program without a library for messages, for tests.

use super::communicator::{CommunicationError, Communicator};
use std::ops::Range;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

/// A rank with a channel from each rank to each.
#[derive(Debug)]
struct ThreadRank {
    rank: usize,
    to: Vec<Sender<Vec<f64>>>,
    from: Mutex<Vec<Receiver<Vec<f64>>>>,
}

impl Communicator for ThreadRank {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.to.len()
    }

    fn gather_while(
        &self,
        values: &mut [f64],
        parts: &[Range<usize>],
        work: &mut dyn FnMut(),
    ) -> Result<(), CommunicationError> {
        let own = &values[parts[self.rank].clone()];
        let others = self.to.iter().enumerate().filter(|(rank, _)| *rank != self.rank);
        let sent: Result<Vec<()>, CommunicationError> = others
            .map(|(rank, to)| to.send(own.to_vec()).map_err(|_| CommunicationError::Lost { rank }))
            .collect();
        work();
        sent?;
        let from = self.from.lock().unwrap_or_else(PoisonError::into_inner);
        for (rank, from) in from.iter().enumerate().filter(|(rank, _)| *rank != self.rank) {
            let sent = from.recv().map_err(|_| CommunicationError::Lost { rank })?;
            let part = &mut values[parts[rank].clone()];
            let (expected, found) = (part.len(), sent.len());
            if expected != found {
                return Err(CommunicationError::OutOfStep { rank, expected, found });
            }
            part.copy_from_slice(&sent);
        }
        Ok(())
    }
}

/// Runs `work` once a rank, each in a thread and a pool of its own, and returns what they return, by rank. A rank that
/// panics, or gets no thread of its pool, counts as `None`, and the others lose it.
///
/// # Panics
/// If the system has no more threads.
pub fn on_ranks<R: Send>(ranks: usize, work: impl Fn(Arc<dyn Communicator>) -> R + Sync) -> Vec<Option<R>> {
    let mut from: Vec<Vec<Receiver<Vec<f64>>>> = (0..ranks).map(|_| Vec::new()).collect();
    let mut to: Vec<Vec<Sender<Vec<f64>>>> = (0..ranks).map(|_| Vec::new()).collect();
    for to in &mut to {
        for from in &mut from {
            let (sender, receiver) = channel();
            to.push(sender);
            from.push(receiver);
        }
    }
    thread::scope(|scope| {
        let one = |(rank, (to, from)): (usize, (Vec<_>, Vec<_>))| {
            let communicator = ThreadRank {
                rank,
                to,
                from: Mutex::new(from),
            };
            let work = &work;
            scope.spawn(move || {
                // a rank that waits for another one must not hold a thread that this one needs
                let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
                pool.ok().map(|pool| pool.install(|| work(Arc::new(communicator))))
            })
        };
        let handles: Vec<_> = to.into_iter().zip(from).enumerate().map(one).collect();
        handles.into_iter().map(|handle| handle.join().ok().flatten()).collect()
    })
}
