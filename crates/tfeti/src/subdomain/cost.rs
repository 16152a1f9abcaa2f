//! Which generalised inverse is cheaper for a class: a dense one on the boundary or a sparse factor.

use crate::error::TfetiError;
use crate::subdomain::class::Class;
use crate::tolerances::{BANDWIDTH, CACHE, FLOPS, PANEL, PRODUCTS};

/// Choice of the generalised inverse.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum InverseKind {
    /// Chosen for each class by a cost model from sizes, members and the expected number of products.
    #[default]
    Auto,
    /// Dense matrix on the boundary unknowns.
    Dense,
    /// Sparse Cholesky factor.
    Sparse,
}

/// Settings of the generalised inverses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InverseSettings {
    kind: InverseKind,
    memory_limit: u64,
}

impl Default for InverseSettings {
    fn default() -> Self {
        Self {
            kind: InverseKind::Auto,
            memory_limit: 8 << 30,
        }
    }
}

impl InverseSettings {
    /// Dense or sparse inverses for all classes, for benches and tests. Default: chosen by cost.
    #[doc(hidden)]
    #[must_use]
    pub fn with_kind(mut self, kind: InverseKind) -> Self {
        self.kind = kind;
        self
    }

    /// Upper bound in bytes for all inverses and factors, of all processes together. Default: 8 GiB.
    #[must_use]
    pub fn with_memory_limit(mut self, bytes: u64) -> Self {
        self.memory_limit = bytes;
        self
    }
}

/// Sizes of a class of translates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct ClassReport {
    /// Number of members.
    pub members: usize,
    /// Unknowns of a member.
    pub unknowns: usize,
    /// Unknowns on nodes that rows of `B` touch in some member.
    pub boundary: usize,
    /// Whether products use a dense matrix on the boundary (otherwise a sparse factor).
    pub dense: bool,
    /// Bytes of the inverses; 0 where another process holds them.
    pub bytes: u64,
}

impl ClassReport {
    /// Operations of a product with one member.
    pub(crate) fn flops(&self) -> f64 {
        if self.dense {
            2.0 * (self.boundary * self.boundary) as f64
        } else {
            4.0 * (self.bytes / 8) as f64
        }
    }
}

/// What the cost model knows of a class.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Size {
    /// Unknowns of one member.
    pub(crate) dim: usize,
    /// Unknowns that `B` touches in some member.
    pub(crate) boundary: usize,
    /// Members.
    pub(crate) members: usize,
    /// Numbers of the sparse factor, and those stored for products with one column, if they are counted.
    pub(crate) factor: usize,
    pub(crate) packed: usize,
}

impl Size {
    /// From the nodes that `B` touches and the numbers of the factor; a rigid class has no matrices.
    pub(crate) fn new(class: &Class, nodes: usize, [factor, packed]: [usize; 2]) -> Self {
        let all = [3 * class.nodes, 3 * nodes, factor, packed];
        let [dim, boundary, factor, packed] = if class.is_rigid { [0; 4] } else { all };
        Self {
            dim,
            boundary,
            members: class.members.len(),
            factor,
            packed,
        }
    }

    pub(crate) fn report(&self, dense: bool) -> ClassReport {
        ClassReport {
            members: self.members,
            unknowns: self.dim,
            boundary: self.boundary,
            dense,
            bytes: self.bytes(dense),
        }
    }

    /// Whether the factor is stored for products with one column.
    pub(crate) fn is_packed(&self, dense: bool) -> bool {
        self.members == 1 && !dense
    }

    fn bytes(&self, dense: bool) -> u64 {
        let own = if self.is_packed(dense) { self.packed } else { self.factor };
        8 * (own + if dense { self.boundary * self.boundary } else { 0 }) as u64
    }

    /// Seconds of a product of all members with a dense matrix: arithmetic for shared matrices, streaming for single
    /// ones.
    fn dense_product(&self, bandwidth: f64) -> f64 {
        let entries = (self.boundary * self.boundary) as f64;
        let arithmetic = 2.0 * entries * self.members as f64 / FLOPS;
        arithmetic.max(8.0 * entries / bandwidth)
    }

    /// Seconds of a product of all members with the sparse factor: two passes over it for each block of columns.
    fn sparse_product(&self) -> f64 {
        let columns = self.members.min(PANEL) as f64;
        let per_number = 0.12e-9 + 0.42e-9 / columns;
        (self.factor as f64 * per_number + self.dim as f64 * 6e-9) * self.members as f64
    }

    /// Whether a dense boundary matrix pays within so many products; `resident` tells that all of them stay in cache.
    pub(crate) fn prefers_dense(&self, products: usize, resident: bool) -> bool {
        let saved = self.sparse_product() - self.dense_product(bandwidth(resident));
        // seconds to form the dense matrix besides the factor
        products as f64 * saved > self.factor as f64 * 0.14e-9 * self.boundary as f64
    }
}

/// Bytes per second at which a matrix is read.
fn bandwidth(resident: bool) -> f64 {
    BANDWIDTH[usize::from(!resident)]
}

/// Chooses dense (`true`) or sparse for each class within the memory limit.
pub(crate) fn choose(sizes: &[Size], settings: &InverseSettings) -> Result<Vec<bool>, TfetiError> {
    let boundary = |s: &Size| 8 * (s.boundary * s.boundary) as u64;
    let resident = sizes.iter().map(boundary).sum::<u64>() <= CACHE;
    let mut dense: Vec<bool> = sizes
        .iter()
        .map(|size| match settings.kind {
            InverseKind::Auto => size.prefers_dense(PRODUCTS, resident),
            InverseKind::Dense => true,
            InverseKind::Sparse => false,
        })
        .collect();
    let (limit, auto) = (settings.memory_limit, settings.kind == InverseKind::Auto);
    let bytes = |dense: &[bool]| sizes.iter().zip(dense).map(|(s, d)| s.bytes(*d)).sum::<u64>();
    let mut needed = bytes(&dense);
    if needed > limit && auto {
        // Give up the dense matrices that cost most memory for the time they save.
        let mut order: Vec<usize> = (0..sizes.len()).filter(|&k| dense[k]).collect();
        let worth = |k: usize| {
            let saved = sizes[k].sparse_product() - sizes[k].dense_product(bandwidth(resident));
            saved.max(0.0) / boundary(&sizes[k]).max(1) as f64
        };
        order.sort_by(|&a, &b| worth(a).total_cmp(&worth(b)).then(a.cmp(&b)));
        for k in order {
            if needed <= limit {
                break;
            }
            dense[k] = false;
            needed = needed - sizes[k].bytes(true) + sizes[k].bytes(false);
        }
    }
    if needed > limit { Err(TfetiError::Memory { needed, limit }) } else { Ok(dense) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shared_classes_are_dense_single_ones_follow_the_cost() {
        let shared = Size {
            dim: 648,
            boundary: 456,
            members: 188,
            factor: 39_740,
            packed: 41_000,
        };
        assert!(shared.prefers_dense(2000, true));
        let single = Size { members: 1, ..shared };
        assert!(
            !single.prefers_dense(2000, false),
            "one solve streams less than the dense block"
        );
        let settings = InverseSettings::default();
        let mut sizes = vec![single; 20];
        sizes.push(shared);
        let chosen = choose(&sizes, &settings).unwrap();
        assert!(chosen[20] && chosen[..20].iter().all(|d| !d));
    }

    #[test]
    fn memory_limit_turns_dense_into_sparse_and_then_fails() {
        let size = Size {
            dim: 648,
            boundary: 456,
            members: 188,
            factor: 39_740,
            packed: 41_000,
        };
        let sparse = size.bytes(false);
        let limited = InverseSettings::default().with_memory_limit(sparse);
        assert_eq!(choose(&[size], &limited), Ok(vec![false]));
        let impossible = limited.with_memory_limit(sparse - 1);
        assert_eq!(
            choose(&[size], &impossible),
            Err(TfetiError::Memory {
                needed: sparse,
                limit: sparse - 1
            })
        );
        assert!(matches!(
            choose(&[size], &limited.with_kind(InverseKind::Dense)),
            Err(TfetiError::Memory { .. })
        ));
    }
}
