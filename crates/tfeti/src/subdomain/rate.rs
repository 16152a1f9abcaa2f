//! How fast this machine is, for forecasts in seconds.

use crate::linalg::dense;
use std::time::Instant;

/// What a processor does a second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rate {
    /// Operations of dense products.
    pub flops: f64,
    /// Numbers that a vector operation reads and writes.
    pub numbers: f64,
}

impl Default for Rate {
    /// One core of a desktop processor with 256 bit vectors.
    fn default() -> Self {
        Self {
            flops: 6e10,
            numbers: 5e9,
        }
    }
}

impl Rate {
    /// Measures this machine with one small dense product and one vector operation, in about ten milliseconds.
    pub fn measure() -> Self {
        const SIZE: usize = 240;
        const COLUMNS: usize = 48;
        const LENGTH: usize = 1 << 18;
        let a: Vec<f64> = (0..SIZE * SIZE).map(|i| (i % 17) as f64).collect();
        let b: Vec<f64> = (0..SIZE * COLUMNS).map(|i| (i % 13) as f64).collect();
        let mut c = vec![0.0; SIZE * COLUMNS];
        let best = |work: &mut dyn FnMut()| {
            let time = |_| {
                let start = Instant::now();
                work();
                start.elapsed().as_secs_f64().max(1e-9)
            };
            (0..6).map(time).fold(f64::INFINITY, f64::min)
        };
        let product = best(&mut || dense::multiply(&mut c, &a, &b, SIZE, SIZE, COLUMNS));
        let x: Vec<f64> = (0..LENGTH).map(|i| (i % 11) as f64).collect();
        let mut y = vec![0.0; LENGTH];
        let stream = best(&mut || y.iter_mut().zip(&x).for_each(|(y, x)| *y += 1.5 * x));
        Self {
            flops: (2 * SIZE * SIZE * COLUMNS) as f64 / product,
            numbers: 3.0 * LENGTH as f64 / stream,
        }
    }
}
