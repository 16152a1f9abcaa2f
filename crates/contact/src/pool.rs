//! Where the work of a level runs.

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::yield_now;

/// Runs `work` on a thread of the pool of rayon. Parts of it that run in parallel then begin where it runs; from another thread
/// each of them would cost a change of threads, about as long as a product of a small scene.
///
/// With `busy` the other threads of the pool stay awake for the next part.
pub(crate) fn on_pool<R: Send>(busy: bool, work: impl FnOnce() -> R + Send) -> R {
    if !busy {
        return rayon::scope(|_| work());
    }
    let flag = AtomicBool::new(false);
    let ended = &flag;
    rayon::scope(|scope| {
        let own = rayon::current_thread_index();
        scope.spawn_broadcast(move |_, thread| {
            let waits = Some(thread.index()) != own;
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
