//! What the set-up did.

use crate::dual::boundary::BoundaryMap;
use crate::dual::inverses::{ClassInverse, Inverses};
use crate::subdomain::class::Classes;
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
    /// Bytes of a factor of the whole coarse matrix.
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

pub(super) fn class_reports(classes: &Classes, map: &BoundaryMap, inverses: &Inverses) -> Vec<ClassReport> {
    let (inverses, dense) = inverses;
    let report = |k: usize| ClassReport {
        members: classes.classes()[k].members.len(),
        unknowns: 3 * classes.classes()[k].nodes,
        boundary: 3 * map.classes[k].nodes.len(),
        dense: dense[k],
        bytes: inverses[k].as_ref().map_or(0, ClassInverse::bytes),
    };
    (0..inverses.len()).map(report).collect()
}
