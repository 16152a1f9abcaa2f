//! Several processes that solve one problem together: the one place where they meet.
//!
//! Uses no other room. `communicator` is what is asked of a library for messages, `exchange` counts what is sent and
//! remembers a failure, `threads` lets threads of one process play the ranks, for tests.

pub(crate) mod communicator;
pub(crate) mod exchange;
pub(crate) mod threads;
