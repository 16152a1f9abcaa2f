//! Several processes that solve one problem together: the interface between them.
//!
//! Uses no other folder. `communicator` is the trait for a message library, `exchange` counts what is sent and
//! remembers failures, `threads` uses threads of one process as ranks, for tests.

pub(crate) mod communicator;
pub(crate) mod exchange;
pub(crate) mod threads;
