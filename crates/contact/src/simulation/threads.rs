//! Where the work of a level runs.

use std::cell::Cell;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::yield_now;

thread_local! {
    /// Whether this thread is inside a level or waits for parts of one. What it then takes up while it waits, other
    /// levels with it, stands on the same stack, and must not make further threads wait in turn.
    static INSIDE: Cell<bool> = const { Cell::new(false) };
}

/// Runs `work` on a thread of the pool of rayon. Parts of it that run in parallel then begin where it runs; from another thread
/// each of them would cost a change of threads, about as long as a product of a small scene.
///
/// With `busy` the other threads of the pool stay awake for the next part, unless the level is solved within another one (a
/// thread that waits took it up).
pub(crate) fn on_pool<R: Send>(busy: bool, work: impl FnOnce() -> R + Send) -> R {
    rayon::scope(|_| {
        let outer = Inside::enter();
        if busy && !outer.0 {
            awake(work)
        } else {
            work()
        }
    })
}

/// Runs `work` while the other threads of the pool wait for parts of it.
fn awake<R: Send>(work: impl FnOnce() -> R + Send) -> R {
    let flag = AtomicBool::new(false);
    let ended = &flag;
    rayon::scope(|scope| {
        let own = rayon::current_thread_index();
        scope.spawn_broadcast(move |_, thread| {
            let outer = Inside::enter();
            let waits = Some(thread.index()) != own && !outer.0;
            while waits && !ended.load(Ordering::Relaxed) {
                if rayon::yield_now() != Some(rayon::Yield::Executed) {
                    yield_now();
                }
            }
        });
        // also if the work panics
        let _end = End(ended);
        work()
    })
}

/// Marks the thread as inside a level; back to what it was before when dropped.
struct Inside(bool);

impl Inside {
    fn enter() -> Self {
        Self(INSIDE.replace(true))
    }
}

impl Drop for Inside {
    fn drop(&mut self) {
        INSIDE.set(self.0);
    }
}

/// Tells the waiting threads.
struct End<'a>(&'a AtomicBool);

impl Drop for End<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::on_pool;
    use rayon::prelude::*;

    #[test]
    fn many_levels_at_once_do_not_pile_up() {
        // without the mark the stack grows with the number of levels, and overflows
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build();
        pool.expect("a pool").install(|| {
            (0..2000_usize)
                .into_par_iter()
                .with_max_len(1)
                .for_each(|k| {
                    for _ in 0..3 {
                        let sum = || {
                            (0..1000_usize)
                                .into_par_iter()
                                .map(|i| i ^ k)
                                .sum::<usize>()
                        };
                        assert!(on_pool(true, sum) > 0);
                    }
                });
        });
    }

    #[test]
    fn work_is_done_and_waiting_ends_even_after_a_panic() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build();
        pool.expect("a pool").install(|| {
            for busy in [false, true] {
                let sum = || (0..100_000_u64).into_par_iter().sum::<u64>();
                assert_eq!(on_pool(busy, sum), 4_999_950_000);
                // levels within levels
                assert_eq!(on_pool(busy, || on_pool(busy, sum)), 4_999_950_000);
                let failed = std::panic::catch_unwind(|| on_pool(busy, || panic!("no")));
                assert!(failed.is_err());
            }
        });
    }
}
