//! What a formed `F` stores and costs, from groups of rows that touch the same subdomains.

use crate::dual::operator::DualOperator;
use crate::linalg::elimination::patterns;
use crate::linalg::sparse::minimum_degree;
use crate::tolerances::{EXPLICIT_BYTES, EXPLICIT_CONTACT};
use signorini_fem_mesh::Decomposition;
use signorini_fem_mesh::internal::distinct;
use std::collections::BTreeMap;

/// Numbers of rows, contact rows apart from others, by the subdomains that they touch.
#[doc(hidden)]
#[derive(Debug, Clone, Default)]
pub struct RowGroups {
    contact: BTreeMap<Vec<u32>, usize>,
    others: BTreeMap<Vec<u32>, usize>,
}

/// Numbers that `F + w Gᵀ G` has, and its factor in the rows behind the contact rows.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct FormedSize {
    /// Contact rows.
    pub(crate) contact: f64,
    /// Entries of a triangle.
    pub(crate) entries: f64,
    /// Numbers of the factor, and operations to make it.
    pub(crate) stored: f64,
    pub(crate) flops: f64,
}

impl RowGroups {
    /// The rows that glue the copies of nodes.
    #[must_use]
    pub fn of_interface(decomposition: &Decomposition) -> Self {
        let mut out = Self::default();
        for node in 0..decomposition.nodes() {
            let copies = decomposition.copies(node);
            for last in 1..copies.len() {
                out.add(false, 3, copies[..=last].iter().map(|copy| copy.subdomain));
            }
        }
        out
    }

    /// Adds so many rows that touch these subdomains.
    pub fn add(&mut self, is_contact: bool, rows: usize, subdomains: impl Iterator<Item = u32>) {
        let mut key: Vec<u32> = subdomains.collect();
        key.sort_unstable();
        key.dedup();
        let groups = if is_contact {
            &mut self.contact
        } else {
            &mut self.others
        };
        *groups.entry(key).or_default() += rows;
    }

    /// Bytes of all that is in memory at once; 0 if there are too many.
    #[must_use]
    pub fn bytes(&self, boundary: usize) -> u64 {
        self.size(boundary).map_or(0, |size| size.bytes(boundary) as u64)
    }

    /// Numbers and operations; `None` if there are too many. `boundary` is the largest number of unknowns that rows touch in
    /// a subdomain.
    fn size(&self, boundary: usize) -> Option<FormedSize> {
        let all = self.others.iter().chain(&self.contact);
        let groups: Vec<(&Vec<u32>, f64)> = all.map(|(key, rows)| (key, *rows as f64)).collect();
        let others = self.others.len();
        let mut at: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for (k, (key, _)) in (0..).zip(&groups) {
            key.iter().for_each(|s| at.entry(*s).or_default().push(k));
        }
        let near = |key: &[u32]| distinct(key.iter().flat_map(|s| &at[s]).copied());
        let graph: Vec<Vec<u32>> = groups.iter().map(|(key, _)| near(key)).collect();
        let rows_of = |list: &[u32]| list.iter().map(|k| groups[*k as usize].1).sum::<f64>();
        let mut size = FormedSize {
            contact: self.contact.values().sum::<usize>() as f64,
            entries: groups
                .iter()
                .zip(&graph)
                .map(|(group, near)| group.1 * rows_of(near) / 2.0)
                .sum(),
            ..FormedSize::default()
        };
        if size.contact > EXPLICIT_CONTACT as f64 || size.bytes(boundary) > EXPLICIT_BYTES {
            return None;
        }
        let (mut pointers, mut rows) = (vec![0], Vec::new());
        for near in &graph[..others] {
            rows.extend(near.iter().map(|k| *k as usize).filter(|k| *k < others));
            pointers.push(rows.len());
        }
        let order = if others > 0 {
            minimum_degree(&pointers, &rows).ok()?
        } else {
            Vec::new()
        };
        let order: Vec<u32> = order
            .into_iter()
            .chain(others..groups.len())
            .map(|k| k as u32)
            .collect();
        for (own, below) in order.iter().zip(patterns(&graph, &order)) {
            let own = groups[*own as usize].1;
            let below: f64 = below.iter().map(|p| groups[order[*p as usize] as usize].1).sum();
            size.stored += own * (own + below);
            size.flops += ((own + below).powi(3) - below.powi(3)) / 3.0;
        }
        (size.bytes(boundary) <= EXPLICIT_BYTES).then_some(size)
    }
}

impl FormedSize {
    /// Of all that is in memory at once.
    fn bytes(&self, boundary: usize) -> f64 {
        let dense = 2.0 * self.contact.powi(2) + (boundary as f64).powi(2);
        8.0 * (dense + self.stored) + 16.0 * self.entries
    }
}

impl DualOperator {
    /// Of this operator, with the bytes; `None` where there are too many rows.
    pub(crate) fn formed_size(&self) -> Option<(FormedSize, u64)> {
        let (ranges, subdomains) = (self.gluing.ranges(), &self.subdomains);
        let (contact, others) = (ranges.contact().end, ranges.total() - ranges.contact().end);
        // without a look at rows: each meets at least its share of the others
        let least = (others as f64).powi(2) / subdomains.count().max(1) as f64;
        if contact > EXPLICIT_CONTACT || 16.0 * least > EXPLICIT_BYTES {
            return None;
        }
        let mut groups = RowGroups::default();
        for block in 0..self.gluing.blocks() {
            groups.add(false, 3, self.gluing.block(block).iter().map(|entry| entry.subdomain));
        }
        for row in (0..ranges.total()).filter(|row| !ranges.interface.contains(row)) {
            let entries = self.gluing.row(row).into_iter();
            groups.add(row < contact, 1, entries.map(|entry| entry.0 as u32));
        }
        let boundaries = self.map.classes.iter().map(|class| 3 * class.nodes.len());
        let boundary = boundaries.max().unwrap_or(0);
        groups.size(boundary).map(|size| (size, size.bytes(boundary) as u64))
    }
}
