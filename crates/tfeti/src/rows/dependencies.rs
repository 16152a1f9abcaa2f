//! Rows of `B` that depend on one another: forces at a node that may replace one another.

use crate::rows::gluing::Gluing;
use crate::tolerances::PIVOT;
use nalgebra::{DMatrix, SymmetricEigen};
use std::collections::BTreeMap;

/// The contact and support rows of a node, or of nodes that contact points join, with the null space of their `Bᵀ`.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Dependency {
    /// Rows of `B`, ascending.
    pub rows: Vec<usize>,
    /// Orthonormal multipliers of these rows whose nodal forces cancel: what may be added to a solution as far as signs
    /// and slip bounds allow.
    pub vectors: Vec<Vec<f64>>,
}

impl Gluing {
    /// What depends on what at the [dependent nodes](Self::dependent_nodes), group by group; groups whose rows turn out
    /// to be independent are left out.
    pub fn dependencies(&self) -> Vec<Dependency> {
        let groups = self.node_groups();
        let mut members: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        let ranges = self.ranges();
        for row in ranges.contact().chain(ranges.dirichlet.clone()) {
            if let Some(node) = self.node(row).filter(|n| self.is_dependent(*n)) {
                members.entry(groups.of(node)).or_default().push(row);
            }
        }
        members.into_values().filter_map(|rows| self.dependency(rows)).collect()
    }

    fn dependency(&self, rows: Vec<usize>) -> Option<Dependency> {
        let entries: Vec<_> = rows.iter().map(|row| self.row(*row)).collect();
        let gram = DMatrix::from_fn(rows.len(), rows.len(), |i, j| {
            let mut sum = 0.0;
            for (subdomain, dof, v) in &entries[i] {
                let same = entries[j].iter().filter(|e| (e.0, e.1) == (*subdomain, *dof));
                sum += v * same.map(|e| e.2).sum::<f64>();
            }
            sum
        });
        let eigen = SymmetricEigen::new(gram);
        let limit = PIVOT * eigen.eigenvalues.max();
        let vectors: Vec<Vec<f64>> = (0..rows.len())
            .filter(|&k| eigen.eigenvalues[k] <= limit)
            .map(|k| eigen.eigenvectors.column(k).iter().copied().collect())
            .collect();
        (!vectors.is_empty()).then_some(Dependency { rows, vectors })
    }
}
