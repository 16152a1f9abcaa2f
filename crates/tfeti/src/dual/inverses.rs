//! The generalised inverses of all classes: chosen by cost, then computed.

use crate::dual::boundary::BoundaryMap;
use crate::error::TfetiError;
use crate::linalg::sparse::Symbolic;
use crate::subdomain::cost::{InverseSettings, Size, choose};
use crate::subdomain::inverse::{Inverse, regularised};
use crate::subdomain::matrices::Subdomains;
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

/// Chooses and computes the inverses of all classes; their patterns may be `known`.
pub(crate) fn invert(
    subdomains: &Subdomains,
    map: &BoundaryMap,
    settings: &InverseSettings,
    known: Option<&[Symbolic]>,
) -> Result<Vec<ClassInverse>, TfetiError> {
    let (bases, classes) = (&subdomains.bases, subdomains.classes.classes());
    let first = |k: usize| classes[k].members[0] as usize;
    let symbolic = |k: usize| {
        Symbolic::new(&regularised(&bases[k].stiffness, &bases[k].kernel), 3)
            .map_err(|e| TfetiError::pattern(e, first(k)))
    };
    let each = || (0..bases.len()).into_par_iter();
    let patterns: Vec<Symbolic> = match known {
        Some(known) => known.to_vec(),
        None => each().map(symbolic).collect::<Result<_, _>>()?,
    };
    let size = |k: usize| Size {
        dim: bases[k].stiffness.dim,
        boundary: 3 * map.classes[k].nodes.len(),
        members: classes[k].members.len(),
        factor: patterns[k].stored(),
    };
    let sizes: Vec<Size> = (0..bases.len()).map(size).collect();
    let dense = choose(&sizes, settings)?;
    let inverse = |k: usize| {
        let base = &bases[k];
        let full = Inverse::new(&base.stiffness, &base.kernel, &patterns[k], first(k))?;
        let boundary = dense[k].then(|| full.boundary_block(&base.kernel, &map.classes[k].nodes));
        let full = match &boundary {
            None if sizes[k].is_packed(dense[k]) => full.packed(&base.stiffness),
            _ => full,
        };
        Ok(ClassInverse { full, boundary })
    };
    each().map(inverse).collect()
}
