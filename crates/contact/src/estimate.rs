//! The plan's estimate of memory, products and time.
//!
//! Memory follows from counts ([`Forecast`]): classes of translates are found, boundary unknowns counted, and only the
//! sizes of sparse factors are estimated. Products of the default method follow
//!
//! ```text
//! products a level = 1 + d * sqrt(H/h) * (1 + s / sqrt(L))
//! ```
//!
//! with `d` the digits asked for, `H/h` the cells along the edge of a subdomain, `L` the number of levels (a level starts
//! from the line through the last two, and the line is the better the closer they are) and `s` by effect (table below). The form
//! is that of conjugate gradients with a condition number of `H/h`; the numbers are fitted to the brick benchmark with n = 1 to 3,
//! H/h = 2 to 8, tolerances 1e-3 to 1e-9 and 10 to 200 steps. Other shapes, supports and contact zones need up to a few
//! times more or fewer.
//!
//! | effect | s |
//! |---|---|
//! | no contact | 0 |
//! | contact without friction | 1.4 |
//! | given friction | 4 |
//! | Coulomb | 5.5 |
//!
//! The paper's methods need about 11 times as many products, its one inexact loop 8 times.
//!
//! Time is arithmetic plus traffic: a product costs its operations twice (operator and preconditioner) and about 100
//! numbers moved a row (vectors, projections, tables) and a fixed part, a level the recovery of the displacement and the
//! certificate.

use crate::clock::Analysis;
use crate::plan::{Effects, FrictionKind};
use crate::settings::{Method, Settings};
use signorini_tfeti::{Forecast, Rate};

/// Estimated cost of a run; made before any work.
#[derive(Debug, Clone, PartialEq)]
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
    /// Operations of one product with F.
    pub product_flops: f64,
    /// Products of all levels, recoveries included.
    pub products: usize,
    /// Machine for which times are given.
    pub rate: Rate,
    rows: usize,
    primal: usize,
    levels: usize,
    setup_flops: f64,
}

/// Numbers moved a row in a product with all that belongs to it.
const NUMBERS_PER_ROW: f64 = 100.0;
/// Time of a product that does not depend on its size, as numbers moved.
const NUMBERS_PER_PRODUCT: f64 = 2e5;
/// The same for the set-up.
const NUMBERS_OF_SETUP: f64 = 2e7;
/// Numbers moved an unknown displacement in the recovery and certificate of a level.
const NUMBERS_PER_UNKNOWN: f64 = 300.0;
/// Numbers moved an unknown displacement in the set-up.
const NUMBERS_PER_SETUP: f64 = 2000.0;

impl Estimate {
    pub(crate) fn new(
        effects: &Effects,
        settings: &Settings,
        analysis: &Analysis,
        forecast: &Forecast,
        sizes: Sizes,
    ) -> Self {
        let levels = analysis.levels();
        Self {
            classes: forecast.classes.len(),
            factorisations: forecast.classes.len() + 1,
            inverse_bytes: forecast.inverse_bytes,
            coarse_bytes: forecast.coarse_bytes,
            table_bytes: forecast.table_bytes,
            product_flops: forecast.product_flops(),
            products: (levels as f64 * products_per_level(effects, settings, levels, &sizes))
                .round() as usize,
            rate: Rate::default(),
            rows: sizes.rows,
            primal: sizes.primal,
            levels,
            setup_flops: forecast.setup_flops(),
        }
    }

    /// Bytes of everything but the vectors.
    #[must_use]
    pub fn setup_bytes(&self) -> u64 {
        self.inverse_bytes + self.coarse_bytes + self.table_bytes
    }

    /// Seconds of one product with its preconditioner, projections and vector operations, on one processor.
    #[must_use]
    pub fn product_seconds(&self) -> f64 {
        2.0 * self.product_flops / self.rate.flops
            + (NUMBERS_PER_PRODUCT + NUMBERS_PER_ROW * self.rows as f64) / self.rate.numbers
    }

    /// Seconds of the set-up, on one processor.
    #[must_use]
    pub fn setup_seconds(&self) -> f64 {
        self.setup_flops / self.rate.flops
            + (NUMBERS_OF_SETUP + NUMBERS_PER_SETUP * self.primal as f64) / self.rate.numbers
    }

    /// Seconds of all levels, on one processor.
    #[must_use]
    pub fn solve_seconds(&self) -> f64 {
        let level = NUMBERS_PER_UNKNOWN * self.primal as f64 / self.rate.numbers;
        self.products as f64 * self.product_seconds() + self.levels as f64 * level
    }
}

/// What the estimate needs of a plan.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sizes {
    pub(crate) rows: usize,
    pub(crate) primal: usize,
    pub(crate) elements: usize,
    pub(crate) subdomains: usize,
}

fn products_per_level(effects: &Effects, settings: &Settings, levels: usize, sizes: &Sizes) -> f64 {
    let cold = match (effects.contact, effects.friction) {
        (false, _) => 0.0,
        (true, FrictionKind::None) => 1.4,
        (true, FrictionKind::Given) => 4.0,
        (true, FrictionKind::Coulomb | FrictionKind::RateDependent) => 5.5,
    };
    let method = match settings.method {
        _ if !effects.contact => 1.0,
        Method::Face(_) => 1.0,
        Method::SuccessiveApproximations { .. } => 11.0,
        Method::OneLoop { .. } => 8.0,
    };
    let digits = -settings.tolerance.log10();
    // six tetrahedra fill a cell
    let cells = (sizes.elements as f64 / (6 * sizes.subdomains.max(1)) as f64).cbrt();
    let smooth = if settings.extrapolate {
        levels as f64
    } else {
        1.0
    };
    let products = 1.0 + method * digits * cells.max(1.0).sqrt() * (1.0 + cold / smooth.sqrt());
    // conjugate gradients end after as many steps as there are rows
    products.min(1.0 + method * (1 + sizes.rows) as f64)
}
