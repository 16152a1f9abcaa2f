//! The plan's estimate of memory, products and time.
//!
//! Memory follows from counts ([`Forecast`]): classes of translates are found, boundary unknowns counted, and only the
//! sizes of sparse factors are estimated. Products of the default method are likely to be
//!
//! ```text
//! products = L + sqrt(H/h) sqrt(m) ( c + 1.5 d + (L - 1) w d ),      w = w0 + w1 / sqrt(L)
//! ```
//!
//! with `L` levels, `d` the digits asked for, `H/h` the cells along the edge of a subdomain and `m` the ratio of compressional to
//! shear stiffness relative to steel (1; 16 for Poisson's ratio 0.49). The first level starts from nothing and finds its
//! contact zone (`c`), the others start from the line through the last two, which is the better the closer they are (`w`). The
//! form is that of conjugate gradients with a condition number of `H/h` and `m`.
//!
//! | effect | c | w0 | w1 | w without extrapolation |
//! |---|---|---|---|---|
//! | no contact | 0 | 0 | 1.5 | 1 |
//! | contact without friction | 14 | 0.6 | 1.8 | 1 |
//! | given friction, Coulomb | 17 | 0.9 | 1.4 | 1.25 |
//!
//! Without contact `1.5 d` is `d`. The paper's methods need 13 times as many products, its one inexact loop 11 times, both 10 times with given friction.
//!
//! **Slender subdomains.** Contact rows of a body that bends are coupled over its whole length, and the preconditioner sees only the
//! neighbours of a node. With `s` the ratio of the largest to the smallest extent of a subdomain (of the ellipsoid with its second
//! moments, mean over 64 of them at most), the first level takes
//!
//! ```text
//! S = (s / 3)²  times as much with friction, S^0.7 without, from s = 3 on,
//! ```
//!
//! and the later ones that to the power 1.4: the faces of a bending body are far from those of the level before. Measured on about forty runs of slabs and beams of one subdomain with 150
//! to 5500 nodes, `s` from 4 to 16, H/h from 3 to 16, and of such cut into 2 to 64 parts; a body that rests on its floor
//! bends less and takes less, one that may lift off all round takes more. The range therefore is `0.25 / S^0.7` to `2.2 S^0.6` times the likely figure.
//! Subdomains as long as thick need none of this: a slab of 4 x 4 x 0.25 m took 3471 products in one piece, 43 in 8 x 8 pieces.
//!
//! **Large subdomains** that are not slender (one of 5000 to 20,000 nodes, 12 runs) took 0.38 to 1.9 times the likely figure, once 2.9 times: a first contact is
//! harder to find on many nodes. From ten cells an edge on the upper end of the range is `2.2 (H/h / 10)^0.8`.
//!
//! **Digits.** With [`Accuracy::Tolerance`] those of the setting; with `Relative(x)` those of `x / sqrt(L)`, the share of a level, and with
//! `Balanced` those of `0.1 fraction / sqrt(L)` (a discretisation error of a tenth), both at least the three with which such levels begin.
//!
//! **Range.** The numbers are fitted to the benchmark (n = 1 to 3, 10 and 50 levels, tolerances 1e-4 to 1e-10; the dependence on H/h, 2 to 9,
//! and on m is older) and compared with sixteen other scenes (`examples/src/effects/shapes.rs`). In these the truth was 0.33 to 1.7 times the likely figure wherever the face
//! method did not give up and subdomains are neither slender nor large, so [`Estimate::fewest_products`] is 0.25 times (0.1 without contact) and [`Estimate::most_products`] 2.2 times it. Nothing in a plan tells whether a level falls back to
//! SMALSE; one that does needs some hundreds to ten thousand products more.
//!
//! **Very small subdomains.** The coarse matrix has six unknowns a subdomain, and all subdomains at a node are coupled. Its factor is
//! counted exactly but for contact between bodies: it is made twice (once for all rows, once for the free ones), a product reads it
//! four times, and a change of the face does a part of it again. From some thousand subdomains on, or with such of a few tetrahedra, this is all of the time,
//! and grows like the square of their number.
//!
//! Time is arithmetic plus traffic: a product costs its operations twice (operator and preconditioner) and about 100
//! numbers moved a row (vectors, projections, tables) and 200,000 besides, a level 300 an unknown displacement for the recovery of
//! the displacement and the certificate.

use super::effects::{Effects, FrictionKind};
use crate::scene::Analysis;
use crate::settings::{Accuracy, Method, Settings};
use crate::tolerances::LOOSEST;
use signorini_fem_mesh::Hooke;
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
    /// Products of all levels that are likely, recoveries included.
    pub products: usize,
    /// Fewer products would be a surprise.
    pub fewest_products: usize,
    /// More products would be a surprise, unless a level falls back to SMALSE.
    pub most_products: usize,
    /// Machine for which times are given.
    pub rate: Rate,
    rows: usize,
    primal: usize,
    levels: usize,
    setup_flops: f64,
    coarse_flops: f64,
}

/// How often the coarse factor is made in a set-up, doubled: sparse factors are made at half the speed of dense products.
const COARSE_FACTORS: f64 = 4.0;
/// How often a product with all that belongs to it reads the coarse factor.
const COARSE_READS: f64 = 4.0;
/// Share of the coarse factor that a change of the face makes anew, times changes a product.
const COARSE_CHANGES: f64 = 0.05;
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
        sizes: PlanSizes,
    ) -> Self {
        let levels = analysis.steps();
        let likely = likely_products(effects, settings, levels, &sizes);
        let bends = bending(effects, &sizes);
        let fewest = if effects.contact {
            FEWEST / bends.powf(0.7)
        } else {
            FEWEST_LINEAR
        };
        let large = (sizes.cells() / LARGE).max(1.0);
        let most = MOST * bends.powf(0.6) * large.powf(0.8);
        let round = |products: f64| products.round().max(levels as f64) as usize;
        Self {
            classes: forecast.classes.len(),
            factorisations: forecast.classes.len() + 1,
            inverse_bytes: forecast.inverse_bytes,
            coarse_bytes: forecast.coarse_bytes,
            table_bytes: forecast.table_bytes,
            product_flops: forecast.product_flops(),
            products: round(likely),
            fewest_products: round(fewest * likely),
            most_products: round(most * likely),
            rate: Rate::default(),
            rows: sizes.rows,
            primal: sizes.primal,
            levels,
            setup_flops: forecast.setup_flops(),
            coarse_flops: forecast.coarse_flops,
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
            + self.coarse_seconds()
    }

    /// The part of a product's seconds that the coarse problem takes.
    fn coarse_seconds(&self) -> f64 {
        COARSE_CHANGES * self.coarse_flops / self.rate.flops
            + COARSE_READS * self.coarse_bytes as f64 / 8.0 / self.rate.numbers
    }

    /// Whether the coarse problem takes most of the time: subdomains are too small or too many.
    pub(crate) fn is_mostly_coarse(&self) -> bool {
        2.0 * self.coarse_seconds() > self.product_seconds()
    }

    /// Seconds of the set-up, on one processor.
    #[must_use]
    pub fn setup_seconds(&self) -> f64 {
        (self.setup_flops + COARSE_FACTORS * self.coarse_flops) / self.rate.flops
            + (NUMBERS_OF_SETUP + NUMBERS_PER_SETUP * self.primal as f64) / self.rate.numbers
    }

    /// Seconds of all levels that are likely, on one processor.
    #[must_use]
    pub fn solve_seconds(&self) -> f64 {
        self.seconds(self.products)
    }

    /// The same with the fewest and with the most products.
    #[must_use]
    pub fn solve_seconds_range(&self) -> [f64; 2] {
        [self.fewest_products, self.most_products].map(|products| self.seconds(products))
    }

    fn seconds(&self, products: usize) -> f64 {
        let level = NUMBERS_PER_UNKNOWN * self.primal as f64 / self.rate.numbers;
        products as f64 * self.product_seconds() + self.levels as f64 * level
    }
}

/// What the estimate needs of a plan.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlanSizes {
    pub(crate) rows: usize,
    pub(crate) primal: usize,
    pub(crate) elements: usize,
    pub(crate) subdomains: usize,
    /// Largest ratio of compressional to shear stiffness.
    pub(crate) ratio: f64,
    /// Largest over smallest extent of a subdomain.
    pub(crate) slenderness: f64,
}

impl PlanSizes {
    /// Cells along the edge of a subdomain, H/h: five tetrahedra fill a cell of a brick.
    fn cells(&self) -> f64 {
        (self.elements as f64 / (5 * self.subdomains.max(1)) as f64).cbrt()
    }
}

/// How many times as much a first level takes because subdomains bend.
fn bending(effects: &Effects, sizes: &PlanSizes) -> f64 {
    let factor = (sizes.slenderness / SLENDER).max(1.0).powi(2);
    match (effects.contact, effects.friction) {
        (false, _) => 1.0,
        (true, FrictionKind::None) => factor.powf(0.7),
        (true, _) => factor,
    }
}

/// Subdomains count as slender from this ratio of extents on.
pub(crate) const SLENDER: f64 = 3.0;

/// Compressional over shear stiffness of a material; 3.2 for steel, large for nearly incompressible ones.
pub(crate) fn stiffness_ratio(hooke: &Hooke) -> f64 {
    let c = hooke.voigt();
    (c[0][0] + c[1][1] + c[2][2]) / (c[3][3] + c[4][4] + c[5][5])
}

/// That of steel.
const STEEL: f64 = 3.24;
/// Range of the truth relative to the likely products.
const FEWEST: f64 = 0.25;
/// The same without contact: loads that grow in proportion need no work after the second level.
const FEWEST_LINEAR: f64 = 0.1;
/// Upper end of the range.
const MOST: f64 = 2.2;
/// Cells along the edge of a subdomain from which on it is wider.
const LARGE: f64 = 10.0;

fn likely_products(
    effects: &Effects,
    settings: &Settings,
    levels: usize,
    sizes: &PlanSizes,
) -> f64 {
    let count = levels as f64;
    let (cold, rough, smooth, plain) = match (effects.contact, effects.friction) {
        (false, _) => (0.0, 0.0, 1.5, 1.0),
        (true, FrictionKind::None) => (14.0, 0.6, 1.8, 1.0),
        (true, _) => (17.0, 0.9, 1.4, 1.25),
    };
    let given = effects.friction == FrictionKind::Tresca;
    let method = match settings.method {
        _ if !effects.contact => 1.0,
        Method::ActiveSet(_) => 1.0,
        Method::SuccessiveApproximations { .. } | Method::OneLoop { .. } if given => 10.0,
        Method::SuccessiveApproximations { .. } => 13.0,
        Method::OneLoop { .. } => 11.0,
    };
    let share = if effects.history { count.sqrt() } else { 1.0 };
    let tolerance = match settings.accuracy {
        Accuracy::Tolerance => settings.tolerance,
        Accuracy::Relative(x) => (x / share).min(LOOSEST),
        Accuracy::Balanced { fraction } => (0.1 * fraction / share).min(LOOSEST),
    };
    let digits = -tolerance.log10();
    let warm = if settings.extrapolate {
        rough + smooth / count.sqrt()
    } else {
        plain
    };
    let size = method * (sizes.cells().max(1.0) * (sizes.ratio / STEEL).max(1.0)).sqrt();
    // conjugate gradients end after as many steps as there are rows
    let most = method * (1 + sizes.rows) as f64;
    let start = if effects.contact { 1.5 } else { 1.0 };
    let bends = bending(effects, sizes);
    // a bending body takes more than as many steps as there are rows: its faces change
    let most = most * bends;
    let first = (bends * size * (cold + start * digits)).min(most);
    let next = (bends.powf(1.4) * size * warm * digits).min(most);
    count + first + (count - 1.0) * next
}
