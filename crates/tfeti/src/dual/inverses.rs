//! The generalised inverses of all classes: chosen by cost, then computed.

use crate::dual::boundary::BoundaryMap;
use crate::error::TfetiError;
use crate::linalg::sparse::Symbolic;
use crate::subdomain::cost::{ClassReport, InverseSettings, Size, choose};
use crate::subdomain::inverse::Inverse;
use crate::subdomain::matrices::{ClassMatrices, Subdomains};
use crate::subdomain::packed::counts;
use rayon::prelude::*;

/// Generalised inverse of a class.
#[derive(Debug)]
pub(crate) struct ClassInverse {
    /// Inverse of the whole matrix, for loads and recovery.
    pub(crate) full: Inverse,
    /// Dense inverse on the boundary, for products; `None` if products use the sparse factor.
    pub(crate) boundary: Option<Vec<f64>>,
}

impl ClassInverse {
    pub(crate) fn bytes(&self) -> u64 {
        8 * (self.full.stored() + self.boundary.as_ref().map_or(0, Vec::len)) as u64
    }
}

/// Chooses the inverses of all classes and computes those that this rank holds, with a report of each class; their
/// patterns may be `known`.
pub(crate) fn invert(
    subdomains: &Subdomains,
    map: &BoundaryMap,
    settings: &InverseSettings,
    known: Option<&[Symbolic]>,
) -> Result<(Vec<Option<ClassInverse>>, Vec<ClassReport>), TfetiError> {
    let (bases, classes) = (&subdomains.bases, subdomains.classes.classes());
    let first = |k: usize| classes[k].members[0] as usize;
    let symbolic = |k: usize| {
        let own = |own: &ClassMatrices| match known {
            Some(known) => Ok(known[k].clone()),
            None => Symbolic::new(&own.regularised(&bases[k].kernel), 3).map_err(|e| TfetiError::pattern(e, first(k))),
        };
        subdomains.held(k).map(own).transpose()
    };
    let each = || (0..bases.len()).into_par_iter();
    let patterns: Vec<Option<Symbolic>> = each().map(symbolic).collect::<Result<_, _>>()?;
    let counted = |k: usize| match (subdomains.held(k), &patterns[k]) {
        (Some(own), Some(pattern)) => counts(&classes[k], &own.stiffness, pattern),
        _ => [0; 2],
    };
    let counted: Vec<[usize; 2]> = each().map(counted).collect();
    let numbers = [0, 1].map(|which| {
        let mut numbers: Vec<f64> = counted.iter().map(|both| both[which] as f64).collect();
        subdomains.ownership.complete(&mut numbers);
        numbers
    });
    let numbers = |k: usize| [0, 1].map(|which| numbers[which][k] as usize);
    let size = |k: usize| Size::new(&classes[k], map.classes[k].nodes.len(), numbers(k));
    let sizes: Vec<Size> = (0..bases.len()).map(size).collect();
    let dense = choose(&sizes, settings)?;
    let inverse = |k: usize| {
        let (Some(own), Some(pattern)) = (subdomains.held(k), &patterns[k]) else {
            return Ok(None);
        };
        let kernel = &bases[k].kernel;
        let full = Inverse::new(&own.regularised(kernel), pattern, first(k))?;
        let boundary = dense[k].then(|| full.boundary_block(kernel, &map.classes[k].nodes));
        let full = match &boundary {
            None if sizes[k].is_packed(dense[k]) => full.packed(&own.stiffness),
            _ => full,
        };
        Ok(Some(ClassInverse { full, boundary }))
    };
    let inverses: Vec<Option<ClassInverse>> = each().map(inverse).collect::<Result<_, TfetiError>>()?;
    let report = |k: usize| ClassReport {
        bytes: inverses[k].as_ref().map_or(0, ClassInverse::bytes),
        ..sizes[k].report(dense[k])
    };
    let reports = (0..inverses.len()).map(report).collect();
    Ok((inverses, reports))
}
