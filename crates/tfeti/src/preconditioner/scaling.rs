//! Scaling of the preconditioners where copies of a node differ in stiffness or the rows of `B` are not orthonormal.

use super::joined::{JoinedGroups, JoinedScratch, torn_entries};
use crate::error::TfetiError;
use crate::linalg::dense;
use crate::system::tfeti::Tfeti;
use crate::tolerances::{DEPENDENT, DEPENDENT_FEW, DEPENDENT_JOINED, DEPENDENT_TIED, GROUP_ROWS, SINGULAR};
use signorini_fem_mesh::internal::Lists;
use signorini_qp::active_set::{ActiveSetView, Freedom};
use std::collections::HashMap;

/// `B_D = (B D^-1 B^T)^-1 B D^-1` with `D` the stiffness of each copy of a node: rows that belong to one mesh node (or
/// to a contact pair) are coupled by a small matrix, which is inverted once.
///
/// Springs, and contact rows that give way, by `C`, act as if they ended in a subdomain of stiffness `C^-1`, a further
/// entry of `D` and of `K`: `B D^-1 B^T + C` in the place of the matrix, and `B D^-1 K D^-1 B^T + C` between its
/// inverses.
#[derive(Debug)]
pub(crate) struct Scaling {
    /// `1 / D` of each boundary copy, relative to the stiffest.
    pub(super) weights: Vec<f64>,
    /// Groups with contact or support rows.
    groups: Groups,
    /// Groups of interface rows only: their components do not couple, and have the same matrix. First rows of the
    /// triples.
    triples: Groups,
    /// Groups of many rows.
    joined: Option<JoinedGroups>,
    /// Group of each contact row, and its place there; none for rows of `joined`.
    contact: Vec<Option<(u32, u32)>>,
    /// `C` of rows, with `1 / D` of the stiffest copy as unit, N/m; none where they do not give way.
    compliance: Vec<(usize, f64)>,
}

/// What [`Scaling`] keeps for an active set, and work memory.
#[derive(Debug)]
pub(crate) struct ScalingScratch {
    /// Inverses of the small groups; empty for those of all rows.
    groups: Vec<f64>,
    joined: Option<JoinedScratch>,
}

/// Groups of rows, and the inverse of the matrix of each, column-major.
#[derive(Debug, Default)]
struct Groups {
    rows: Lists<u32>,
    inverses: Lists<f64>,
}

impl Groups {
    /// Calls `f` with the rows of each group and its part of `inverses`.
    fn for_each(&self, inverses: &[f64], mut f: impl FnMut(&[u32], &[f64])) {
        for (group, ends) in self.inverses.starts().windows(2).enumerate() {
            f(self.rows.of(group), &inverses[ends[0] as usize..ends[1] as usize]);
        }
    }
}

impl Scaling {
    pub(crate) fn new(system: &Tfeti) -> Result<Self, TfetiError> {
        let gluing = system.gluing();
        let stiffness = match gluing.is_aligned && !gluing.is_compliant() {
            true => system.copy_stiffness(),
            // rows join nodes, corners and mid-nodes too, or end in springs: ratios of copies are not enough
            false => system.all_copy_stiffness(),
        };
        let mut compliance: Vec<f64> = (0..system.torn_dim() / 3).map(|k| 1.0 / stiffness.weight(k)).collect();
        let smallest = compliance.iter().fold(f64::INFINITY, |m, v| m.min(*v));
        compliance.iter_mut().for_each(|v| *v /= smallest);
        let gives_way: HashMap<usize, f64> = gluing.compliance().map(|(row, c)| (row, c / smallest)).collect();
        // Rows by group: a mesh node, or nodes that contact points join.
        let groups = &gluing.groups;
        let mut members: Vec<(u32, u32)> = (0..gluing.ranges().total())
            .filter_map(|row| gluing.node(row).map(|node| (groups.of(node), row as u32)))
            .collect();
        members.sort_unstable();
        let mut out = Self {
            weights: Vec::new(),
            groups: Groups::default(),
            triples: Groups::default(),
            joined: None,
            contact: vec![None; gluing.ranges().contact().end],
            compliance: gluing
                .compliance()
                .map(|(row, c)| (row, c / smallest / smallest))
                .collect(),
        };
        let mut joined = Vec::new();
        let interface = &gluing.ranges().interface;
        for group in members.chunk_by(|a, b| a.0 == b.0) {
            let plain = group.iter().all(|r| interface.contains(&(r.1 as usize)));
            let step = if plain { 3 } else { 1 };
            let rows: Vec<(u32, u32)> = group.iter().copied().step_by(step).collect();
            let count = rows.len();
            if count > GROUP_ROWS {
                joined.extend(rows.iter().map(|r| r.1));
                continue;
            }
            let row = |row: u32| torn_entries(system, row as usize);
            let entries: Vec<Vec<(usize, f64)>> = rows.iter().map(|r| row(r.1)).collect();
            let mut matrix = vec![0.0; count * count];
            for i in 0..count {
                for j in 0..count {
                    let weight = |(dof, v): &(usize, f64)| {
                        let same = entries[j].iter().filter(|(other, _)| other == dof);
                        v * compliance[dof / 3] * same.map(|(_, w)| w).sum::<f64>()
                    };
                    matrix[i + j * count] = entries[i].iter().map(weight).sum();
                }
            }
            for (k, (_, row)) in rows.iter().enumerate() {
                matrix[k * (count + 1)] += gives_way.get(&(*row as usize)).copied().unwrap_or(0.0);
            }
            let depends = |row: u32| gluing.node(row as usize).is_some_and(|node| gluing.is_dependent(node));
            if rows.iter().any(|r| depends(r.1)) {
                let size = (0..count).map(|k| matrix[k * (count + 1)]).fold(0.0, f64::max);
                let contact = gluing.ranges().contact();
                let part = match rows.iter().any(|r| contact.contains(&(r.1 as usize))) {
                    false => DEPENDENT_TIED,
                    true if count > DEPENDENT_FEW => DEPENDENT_JOINED,
                    true => DEPENDENT,
                };
                (0..count).for_each(|k| matrix[k * (count + 1)] += part * size);
            }
            let node = rows[0].0;
            let inverse = dense::inverse(matrix, count, 0.0);
            let inverse = inverse.map_err(|_| TfetiError::DependentRows { node })?;
            for (place, &(_, row)) in rows.iter().enumerate() {
                if let Some(contact) = out.contact.get_mut(row as usize) {
                    *contact = Some((out.groups.rows.count() as u32, place as u32));
                }
            }
            let target = if plain { &mut out.triples } else { &mut out.groups };
            target.rows.push(rows.iter().map(|r| r.1));
            target.inverses.push(inverse);
        }
        if !joined.is_empty() {
            out.joined = Some(JoinedGroups::new(system, joined, &compliance, &gives_way)?);
        }
        out.weights = system
            .dual
            .map
            .copy_values(|subdomain, local| compliance[system.torn_range(subdomain).start / 3 + local]);
        Ok(out)
    }

    /// The matrices of the groups without the directions that an active set holds: with `H` these directions,
    /// `N - N H (H^T N H)^-1 H^T N` is the inverse of what `N^-1` is on the others. An interface row between a
    /// stiff and a soft subdomain follows the soft one, but the stiff one where contact holds the mean of the
    /// copies.
    pub(crate) fn on_active_set(&self, view: &ActiveSetView<'_>, s: &mut ScalingScratch) {
        if let (Some(joined), Some(s)) = (&self.joined, &mut s.joined) {
            joined.on_active_set(view, s);
        }
        let groups = &mut s.groups;
        groups.clear();
        groups.extend_from_slice(self.groups.inverses.items());
        let mut image = Vec::new();
        view.for_each(|row, count, freedom| match freedom {
            Freedom::Free => {}
            Freedom::Held => {
                for row in row..row + count {
                    self.drop_direction(groups, row, &[1.0], &mut image);
                }
            }
            Freedom::Along(tau) => self.drop_direction(groups, row, &[-tau[1], tau[0]], &mut image),
        });
    }

    /// Takes the direction with `values` on the rows from `row` on out of the matrix of its group.
    fn drop_direction(&self, groups: &mut [f64], row: usize, values: &[f64], image: &mut Vec<f64>) {
        let Some(&Some((group, _))) = self.contact.get(row) else {
            return;
        };
        let own = &self.groups;
        let count = own.rows.of(group as usize).len();
        let start = own.inverses.starts()[group as usize] as usize;
        let matrix = &mut groups[start..start + count * count];
        image.clear();
        image.resize(count, 0.0);
        let places = || {
            let rows = values.iter().zip(&self.contact[row..]);
            rows.filter_map(|(v, place)| Some((place.as_ref()?.1 as usize, v)))
        };
        for (place, value) in places() {
            for (out, entry) in image.iter_mut().zip(&matrix[place * count..]) {
                *out += value * entry;
            }
        }
        let own: f64 = places().map(|(place, value)| value * image[place]).sum();
        let size = (0..count).map(|k| matrix[k * (count + 1)]).fold(0.0, f64::max);
        if own <= SINGULAR * size {
            return;
        }
        for (j, &b) in image.iter().enumerate() {
            for (i, &a) in image.iter().enumerate() {
                matrix[i + j * count] -= a * b / own;
            }
        }
    }

    /// `y += C x`
    pub(crate) fn add_compliance(&self, x: &[f64], y: &mut [f64]) {
        self.compliance.iter().for_each(|&(row, c)| y[row] += c * x[row]);
    }

    pub(crate) fn scratch(&self) -> ScalingScratch {
        ScalingScratch {
            groups: Vec::new(),
            joined: self.joined.as_ref().map(JoinedGroups::scratch),
        }
    }

    /// `y = N x` with `N = (B D^-1 B^T)^-1`, on the last active set if there was one.
    pub(crate) fn solve(&self, x: &[f64], y: &mut [f64], s: &mut ScalingScratch) {
        if let (Some(joined), Some(s)) = (&self.joined, &mut s.joined) {
            joined.solve(x, y, s);
        }
        let inverses = if s.groups.is_empty() { self.groups.inverses.items() } else { &s.groups };
        self.groups.for_each(inverses, |rows, inverse| {
            for (column, &target) in inverse.chunks_exact(rows.len()).zip(rows) {
                let products = column.iter().zip(rows);
                y[target as usize] = products.map(|(v, &row)| v * x[row as usize]).sum();
            }
        });
        self.triples.for_each(self.triples.inverses.items(), |rows, inverse| {
            for (column, &target) in inverse.chunks_exact(rows.len()).zip(rows) {
                let mut sum = [0.0; 3];
                for (v, &row) in column.iter().zip(rows) {
                    let x = &x[row as usize..][..3];
                    (0..3).for_each(|c| sum[c] += v * x[c]);
                }
                y[target as usize..][..3].copy_from_slice(&sum);
            }
        });
    }
}
