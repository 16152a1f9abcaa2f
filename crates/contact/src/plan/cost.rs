//! What a run is likely to cost. Memory follows from counts; only the sizes of sparse factors are estimated
//! ([`Forecast`]).
//!
//! Products are likely to be `steps + sqrt(H/h / 5) d / 6 (first + (steps - 1) next)`: one a step for the recovery, and
//! those of a solve, which grow like conjugate gradients with a condition number of `H/h` (cells along the edge of a
//! subdomain) with the digits `d` asked for. `first` and `next` are the means of the benchmark, where `H/h` is 5 and
//! `d` 6. Slender bodies and loads that jump take several times as many, loads that grow in proportion fewer.

use crate::settings::{Accuracy, MethodKind, Settings};
use crate::tolerances::LOOSEST;
use signorini_tfeti::internal::{CoarseForecast, Forecast, Rate};

/// Estimated cost of a run; made before any work.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Estimate {
    /// Sets of equal subdomains, each with one stiffness and one inverse.
    pub classes: usize,
    /// Numeric factorisations of the set-up.
    pub factorisations: usize,
    /// Bytes of the inverses of subdomains.
    pub inverse_bytes: u64,
    /// Bytes of the coarse factor.
    pub coarse_bytes: u64,
    /// Bytes of the gather tables.
    pub table_bytes: u64,
    /// Products of all steps that are likely, recoveries included.
    pub products: usize,
    /// Times on the machine of [`Plan::with_machine`](crate::Plan::with_machine).
    pub times: Option<Times>,
    /// Rows, torn unknowns and steps of the plan.
    sizes: [usize; 3],
    product_flops: f64,
    setup_flops: f64,
    /// Unknowns of one member of each class.
    class_unknowns: f64,
    coarse_flops: f64,
}

/// Estimated times on one processor, s.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Times {
    /// One product with its preconditioner, projections and vector operations.
    pub product: f64,
    /// The set-up.
    pub setup: f64,
    /// All steps.
    pub steps: f64,
    /// The part of a product that the coarse problem takes.
    coarse: f64,
}

/// How often the coarse factor is made in a set-up, doubled: sparse factors are made at half the speed of dense
/// products.
const COARSE_FACTORS: f64 = 4.0;
/// How often a product with all that belongs to it reads the coarse factor.
const COARSE_READS: f64 = 4.0;
/// Share of the coarse factor that a change of the active set makes anew, times changes a product.
const COARSE_CHANGES: f64 = 0.05;
/// Numbers moved in a product with all that belongs to it, whatever its size, and a row.
const NUMBERS_OF_PRODUCT: [f64; 2] = [2e5, 100.0];
/// Numbers moved in the set-up, whatever its size, and an unknown displacement.
const NUMBERS_OF_SETUP: [f64; 2] = [2e7, 2000.0];
/// Numbers moved in the set-up an unknown of a class: assembly, analysis and factor of what is not shared.
const NUMBERS_OF_CLASS: f64 = 12e3;
/// Numbers moved an unknown displacement in the recovery and certificate of a step.
const NUMBERS_OF_STEP: f64 = 300.0;

impl Estimate {
    /// `sizes` are rows, torn unknowns and steps, `tets` the tetrahedra of a subdomain.
    pub(super) fn new(
        sizes: [usize; 3],
        tets: f64,
        method: MethodKind,
        settings: &Settings,
        forecast: &Forecast<'_>,
        coarse: CoarseForecast,
    ) -> Self {
        Self {
            classes: forecast.classes.len(),
            factorisations: forecast.classes.len() + 1,
            inverse_bytes: forecast.inverse_bytes,
            coarse_bytes: coarse.bytes,
            table_bytes: forecast.table_bytes,
            products: likely_products(tets, sizes[2] as f64, method, settings),
            times: None,
            sizes,
            product_flops: forecast.product_flops(),
            setup_flops: forecast.setup_flops(),
            class_unknowns: forecast.classes.iter().map(|c| c.unknowns as f64).sum(),
            coarse_flops: coarse.flops,
        }
    }

    /// Bytes of inverses, coarse factor and tables.
    pub fn setup_bytes(&self) -> u64 {
        self.inverse_bytes + self.coarse_bytes + self.table_bytes
    }

    /// Whether the coarse problem takes most of the time: subdomains are too small or too many.
    pub(super) fn is_mostly_coarse(&self) -> bool {
        let times = self.times.unwrap_or_else(|| self.times_on(Rate::default()));
        2.0 * times.coarse > times.product
    }

    pub(super) fn times_on(&self, rate: Rate) -> Times {
        let [rows, primal, steps] = self.sizes.map(|n| n as f64);
        let moved = |[fixed, each]: [f64; 2], count: f64| (fixed + each * count) / rate.numbers;
        let coarse = COARSE_CHANGES * self.coarse_flops / rate.flops
            + COARSE_READS * self.coarse_bytes as f64 / 8.0 / rate.numbers;
        // operator and preconditioner; matrices that subdomains do not share are read for a single column each, and
        // memory sets the pace
        let read = self.inverse_bytes as f64 / 8.0 / rate.numbers;
        let product = 2.0 * (self.product_flops / rate.flops).max(read) + moved(NUMBERS_OF_PRODUCT, rows) + coarse;
        let setup = (self.setup_flops + COARSE_FACTORS * self.coarse_flops) / rate.flops;
        let step = moved([0.0, NUMBERS_OF_STEP], primal);
        Times {
            product,
            setup: setup + moved(NUMBERS_OF_SETUP, primal) + moved([0.0, NUMBERS_OF_CLASS], self.class_unknowns),
            steps: self.products as f64 * product + steps * step,
            coarse,
        }
    }
}

/// Products of the first step, which starts from nothing, and of each later one: means of the benchmark.
fn benchmark(method: MethodKind) -> [f64; 2] {
    match method {
        MethodKind::Linear => [6.0, 2.0],
        MethodKind::ActiveSet => [55.0, 13.0],
        MethodKind::SuccessiveApproximations => [700.0, 225.0],
        MethodKind::OneLoop => [600.0, 170.0],
    }
}

fn likely_products(tets: f64, steps: f64, method: MethodKind, settings: &Settings) -> usize {
    let tolerance = match settings.accuracy {
        Accuracy::Tolerance => settings.tolerance,
        Accuracy::Relative(x) => x.min(LOOSEST),
        // a discretisation error of a tenth
        Accuracy::Balanced { fraction } => (0.1 * fraction).min(LOOSEST),
    };
    // five tetrahedra fill a cell of a brick
    let cells = (tets / 5.0).cbrt().max(1.0);
    let size = (cells / 5.0).sqrt() * -tolerance.log10() / 6.0;
    let [first, next] = benchmark(method);
    (steps + size * (first + (steps - 1.0).max(0.0) * next)).round() as usize
}
