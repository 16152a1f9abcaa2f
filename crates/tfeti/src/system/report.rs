//! What the set-up did.

use crate::dual::boundary::BoundaryMap;
use crate::dual::inverses::{ClassInverse, Inverses};
use crate::rows::kinds::{RemovalReason, RemovedRow, RowKind, RowRanges};
use crate::subdomain::class::Classes;
use crate::subdomain::cost::ClassReport;
use std::fmt;

/// Sizes, choices and times of the set-up.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SetupReport {
    /// Number of subdomains.
    pub subdomains: usize,
    /// The classes of translates.
    pub classes: Vec<ClassReport>,
    /// Unknowns of all subdomains: the paper's `n_p`.
    pub primal_unknowns: usize,
    /// Rows of `B` by kind.
    pub rows: RowRanges,
    /// Rows as the paper counts them: its `n_d`.
    pub rows_as_paper: usize,
    /// Removed rows by kind and reason.
    pub removed: Vec<(RowKind, RemovalReason, usize)>,
    /// Bytes of the inverses and factors of subdomains, of several processes those that this one holds.
    pub inverse_bytes: u64,
    /// Bytes of the coarse factors: of two levels as many as were forecast, else of a factor of the whole matrix.
    pub coarse_bytes: u64,
    /// Bytes of the gather tables.
    pub table_bytes: u64,
    /// Numeric factorisations, with that of the coarse matrix, which the first solver makes.
    pub factorisations: usize,
    /// Patterns of subdomains that were analysed: one a class, none where a forecast had done it.
    pub analysed: usize,
    /// Rigid motions that no row stops, in words.
    pub free_motions: Vec<String>,
    /// Seconds to find the classes.
    pub classes_seconds: f64,
    /// Seconds to build the rows and tables.
    pub gluing_seconds: f64,
    /// Seconds to assemble stiffness and kernels.
    pub assembly_seconds: f64,
    /// Seconds for the generalised inverses.
    pub inverse_seconds: f64,
    /// Seconds for the coarse matrix beyond those for the inverses, which run beside it.
    pub coarse_seconds: f64,
}

pub(super) fn count(removed: &[RemovedRow]) -> Vec<(RowKind, RemovalReason, usize)> {
    let mut sorted: Vec<_> = removed.iter().map(|r| (r.kind, r.reason)).collect();
    sorted.sort();
    let alike = sorted.chunk_by(|a, b| a == b);
    alike.map(|all| (all[0].0, all[0].1, all.len())).collect()
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

impl fmt::Display for SetupReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let dense = self.classes.iter().filter(|c| c.dense).count();
        let rows = &self.rows;
        writeln!(
            f,
            "{} subdomains in {} classes ({dense} dense), n_p = {}",
            self.subdomains,
            self.classes.len(),
            self.primal_unknowns
        )?;
        let [n, t, i, d] = [
            rows.normal.len(),
            rows.tangential().len(),
            rows.interface.len(),
            rows.dirichlet.len(),
        ];
        let tied = match rows.tied.len() {
            0 => String::new(),
            count => format!(", tied {count}"),
        };
        writeln!(
            f,
            "n_d = {} (normal {n}, tangential {t}, interface {i}{tied}, supports {d}); as the paper counts {}",
            rows.total(),
            self.rows_as_paper
        )?;
        for (kind, reason, count) in &self.removed {
            writeln!(f, "removed {count} {kind:?} rows: {reason}")?;
        }
        for motion in &self.free_motions {
            writeln!(f, "free motion: {motion}")?;
        }
        let mib = |bytes: u64| bytes as f64 / f64::from(1 << 20);
        writeln!(
            f,
            "memory: inverses {:.1} MiB, coarse factor {:.1} MiB, tables {:.1} MiB",
            mib(self.inverse_bytes),
            mib(self.coarse_bytes),
            mib(self.table_bytes)
        )?;
        let times = [
            self.classes_seconds,
            self.gluing_seconds,
            self.assembly_seconds,
            self.inverse_seconds,
            self.coarse_seconds,
        ];
        let [a, b, c, d, e] = times.map(|t| 1e3 * t);
        write!(
            f,
            "set-up: classes {a:.1} ms, rows {b:.1} ms, assembly {c:.1} ms, inverses {d:.1} ms, coarse {e:.1} ms"
        )
    }
}
