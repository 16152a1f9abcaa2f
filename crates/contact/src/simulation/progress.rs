//! An observer that tells how far a run is.

use super::observer::{Flow, Observer};
use super::result::StepResult;
use crate::plan::Plan;
use crate::report::Warning;
use std::collections::VecDeque;
use std::io::{self, Write};
use std::time::{Duration, Instant};

/// Steps whose mean time foretells those to come.
const RECENT: usize = 10;

/// Writes one line per step: its number, time, products, and the time left, if the remaining steps take as long as the
/// last ten. Warnings are separate lines. Of several processes only rank 0 writes. A writer that fails ends the run
/// with its error.
#[derive(Debug)]
pub struct Progress<W> {
    out: W,
    /// Steps of the analysis, and those left.
    steps: usize,
    left: usize,
    /// Whether it is rank 0.
    speaks: bool,
    before: Instant,
    recent: VecDeque<Duration>,
    /// What could not be written before a step.
    failed: io::Result<()>,
}

impl<W: Write> Progress<W> {
    /// Writes to `out`, such as `std::io::stderr()`.
    pub fn new(out: W) -> Self {
        Self {
            out,
            steps: 0,
            left: 0,
            speaks: true,
            before: Instant::now(),
            recent: VecDeque::with_capacity(RECENT),
            failed: Ok(()),
        }
    }

    /// Takes the time of a step, and foretells that of those left.
    fn foretell(&mut self, time: Duration) -> Duration {
        if self.recent.len() == RECENT {
            self.recent.pop_front();
        }
        self.recent.push_back(time);
        let mean = self.recent.iter().sum::<Duration>().as_secs_f64() / self.recent.len() as f64;
        Duration::try_from_secs_f64(mean * self.left as f64).unwrap_or(Duration::MAX)
    }
}

impl<W: Write> Observer for Progress<W> {
    fn started(&mut self, plan: &Plan, steps: usize) {
        (self.steps, self.left) = (plan.steps, steps);
        self.speaks = plan.rank == 0;
        self.before = Instant::now();
        self.recent.clear();
    }

    fn warning(&mut self, warning: &Warning) {
        if !self.speaks {
            return;
        }
        let written = writeln!(self.out, "warning: {warning}");
        if self.failed.is_ok() {
            self.failed = written;
        }
    }

    fn step(&mut self, result: &StepResult) -> Flow {
        if !self.speaks {
            return Flow::Continue;
        }
        let now = Instant::now();
        self.left = self.left.saturating_sub(1);
        let left = self.foretell(now - self.before);
        self.before = now;
        let number = result.step() + 1;
        let products = result.report().counters.products;
        let failed = std::mem::replace(&mut self.failed, Ok(()));
        let written = failed.and_then(|()| {
            write!(
                self.out,
                "{number} of {} steps, t = {} s, {products} products",
                self.steps,
                result.time() as f32
            )?;
            if let Some(failure) = result.failure() {
                write!(self.out, ", {}", failure.status)?;
            }
            if self.left > 0 {
                write!(self.out, ", {} left", words(left))?;
            }
            writeln!(self.out)?;
            self.out.flush()
        });
        Flow::from(written)
    }
}

/// A duration for people: two figures.
fn words(time: Duration) -> String {
    let seconds = time.as_secs();
    match seconds {
        0..60 => format!("{seconds} s"),
        60..3600 => format!("{} min {:02} s", seconds / 60, seconds % 60),
        _ => format!("{} h {:02} min", seconds / 3600, seconds % 3600 / 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_ten_steps_foretell_the_rest() {
        let mut progress = Progress::new(io::sink());
        progress.left = 4;
        for _ in 0..3 {
            let _ = progress.foretell(Duration::from_secs(1000));
        }
        assert_eq!(progress.foretell(Duration::from_secs(1000)), Duration::from_secs(4000));
        for _ in 0..9 {
            let _ = progress.foretell(Duration::from_secs(2));
        }
        // 1000 s and nine times 2 s
        assert_eq!(progress.foretell(Duration::from_secs(2)), Duration::from_secs(8));
    }

    #[test]
    fn durations_have_two_figures() {
        for (seconds, text) in [
            (0, "0 s"),
            (59, "59 s"),
            (61, "1 min 01 s"),
            (3600, "1 h 00 min"),
            (93_784, "26 h 03 min"),
        ] {
            assert_eq!(words(Duration::from_secs(seconds)), text);
        }
    }
}
