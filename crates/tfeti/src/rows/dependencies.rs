//! Rows of `B` that depend on one another: forces at a node that may replace one another.

use crate::linalg::sparse::{Columns, SparseCholesky, Symbolic};
use crate::rows::contact::{ContactRow, PointRows};
use crate::rows::gluing::Gluing;
use crate::rows::side::ContactConstraint;
use crate::rows::supports::MergedSupports;
use crate::tolerances::{EXCHANGED_ROWS, INDEPENDENT, PIVOT};
use nalgebra::{DMatrix, SymmetricEigen};
use std::collections::{BTreeMap, HashMap};

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
    /// to be independent are left out, and so are groups of more than a thousand rows, whose null space would cost too
    /// much.
    #[doc(hidden)]
    pub fn dependencies(&self) -> Vec<Dependency> {
        let groups = &self.exchanging;
        let mut members: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        let ranges = self.ranges();
        for row in ranges.contact().chain(ranges.interface.end..ranges.total()) {
            if let Some(node) = self.node(row).filter(|n| self.is_dependent(*n)) {
                members.entry(groups.of(node)).or_default().push(row);
            }
        }
        let members = members.into_values().filter(|rows| rows.len() <= EXCHANGED_ROWS);
        members.filter_map(|rows| self.dependency(rows)).collect()
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

/// Places of the points whose rows may depend on others. Left out are points of long sides with a node that no support
/// holds and no other point has, or only such that are left out before: their rows are independent of all others.
pub(super) fn not_alone(contact: &[ContactConstraint], points: &[&PointRows], supports: &MergedSupports) -> Vec<usize> {
    let of = |k: usize| &contact[points[k].point];
    let mut users: HashMap<u32, u32> = HashMap::new();
    let mut left: Vec<usize> = (0..points.len()).collect();
    if left.iter().all(|&k| !of(k).is_long()) {
        return left;
    }
    for &k in &left {
        of(k).nodes().for_each(|(n, _)| *users.entry(n).or_insert(0) += 1);
    }
    loop {
        let before = left.len();
        left.retain(|&k| {
            let own = |&(node, _): &(u32, f64)| users[&node] == 1 && supports.at(node).is_none();
            let alone = of(k).is_long() && !points[k].dragged && of(k).side.nodes().iter().any(own);
            if alone {
                for (node, _) in of(k).nodes() {
                    users.entry(node).and_modify(|count| *count -= 1);
                }
            }
            !alone
        });
        if left.len() == before {
            return left;
        }
    }
}

/// Whether the rows of points are linearly independent for certain: from their Gram matrix. What supports fix is in
/// none of them, unless it is dragged.
pub(super) fn are_independent<'a>(points: impl Iterator<Item = (&'a ContactConstraint, &'a PointRows)>) -> bool {
    let mut rows: Vec<Vec<(usize, f64)>> = Vec::new();
    for (constraint, point) in points {
        let row = |r: &ContactRow| {
            let parts = constraint.nodes().zip(&r.parts);
            let parts = parts.flat_map(|((node, _), v)| [0, 1, 2].map(|c| (3 * node as usize + c, v[c])));
            parts.collect()
        };
        rows.push(row(&point.normal));
        rows.extend(point.tangential.iter().map(row));
    }
    let gram = Columns::gram(&rows, |_| 1.0, |_| None);
    let factor = Symbolic::new(&gram, 1).and_then(|symbolic| SparseCholesky::new(&symbolic, &gram));
    factor.is_ok_and(|factor| {
        let (smallest, _, largest) = factor.pivots();
        smallest > INDEPENDENT * largest
    })
}
