//! What the set-up did.

use crate::subdomain::cost::ClassReport;

/// Choices, memory and work of the set-up. Sizes stand where they belong: rows in [`Gluing`](crate::Gluing), unknowns
/// in [`Tfeti`](crate::Tfeti).
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SetupReport {
    /// The classes of translates.
    pub classes: Vec<ClassReport>,
    /// Bytes of the inverses and factors of subdomains, of several processes those that this one holds.
    pub inverse_bytes: u64,
    /// Bytes of the coarse factors: of two levels as many as were forecast, 0 without a forecast, else of a factor of the
    /// whole matrix.
    pub coarse_bytes: u64,
    /// Bytes of the gather tables.
    pub table_bytes: u64,
    /// Numeric factorisations, with that of the coarse matrix, which the first solver makes.
    pub factorisations: usize,
    /// Patterns of subdomains that were analysed: one a class, none where a forecast had done it.
    pub analysed: usize,
    /// Seconds to assemble stiffness and kernels.
    pub assembly_seconds: f64,
}
