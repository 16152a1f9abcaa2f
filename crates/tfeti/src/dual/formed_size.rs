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

/// What `F + w Gᵀ G` and its factor store, and what that costs.
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
        let mut nodes: BTreeMap<Vec<u32>, usize> = BTreeMap::new();
        let mut key = Vec::new();
        for copies in (0..decomposition.nodes()).map(|node| decomposition.copies(node)) {
            if copies.len() > 1 {
                key.clear();
                key.extend(copies.iter().map(|copy| copy.subdomain));
                match nodes.get_mut(&key) {
                    Some(count) => *count += 1,
                    None => {
                        nodes.insert(key.clone(), 1);
                    }
                }
            }
        }
        let mut out = Self::default();
        for (key, count) in nodes {
            (2..=key.len()).for_each(|copies| out.add(false, 3 * count, key[..copies].iter().copied()));
        }
        out
    }

    /// Adds so many rows that touch these subdomains.
    pub fn add(&mut self, is_contact: bool, rows: usize, subdomains: impl Iterator<Item = u32>) {
        let mut key: Vec<u32> = subdomains.collect();
        key.sort_unstable();
        key.dedup();
        let groups = if is_contact { &mut self.contact } else { &mut self.others };
        *groups.entry(key).or_default() += rows;
    }

    /// Bytes of all that is in memory at once; 0 if there are too many.
    #[must_use]
    pub fn bytes(&self, boundary: usize) -> u64 {
        self.size(boundary).map_or(0, |size| size.bytes(boundary) as u64)
    }

    /// Numbers and operations; `None` if there are too many. `boundary` is the largest number of unknowns that rows
    /// touch in a subdomain.
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
        if size.bytes(boundary) > EXPLICIT_BYTES {
            return None;
        }
        let (mut pointers, mut rows) = (vec![0], Vec::new());
        for near in &graph[..others] {
            rows.extend(near.iter().map(|k| *k as usize).filter(|k| *k < others));
            pointers.push(rows.len());
        }
        let order = if others > 0 { minimum_degree(&pointers, &rows).ok()? } else { Vec::new() };
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

/// Whether so many rows, so many of them of contact, might be few enough, without a look at them: each of the others
/// meets at least its share of them, of entries with a number and its place.
#[doc(hidden)]
#[must_use]
pub fn may_be_formed(rows: usize, contact: usize, subdomains: usize) -> bool {
    let least = ((rows - contact) as f64).powi(2) / subdomains.max(1) as f64;
    contact <= EXPLICIT_CONTACT && 16.0 * least <= EXPLICIT_BYTES
}

impl FormedSize {
    /// Of all that is in memory at once: of contact rows a corner, a complement, a factor of it, and for interior points
    /// two more.
    fn bytes(&self, boundary: usize) -> f64 {
        let dense = 5.0 * self.contact.powi(2) + (boundary as f64).powi(2);
        8.0 * (dense + self.stored) + 16.0 * self.entries
    }
}

impl DualOperator {
    /// Of this operator, with the bytes; `None` where there are too many rows.
    pub(crate) fn formed_size(&self) -> Option<(FormedSize, u64)> {
        let (ranges, subdomains) = (self.gluing.ranges(), &self.subdomains);
        let contact = ranges.contact().end;
        if !may_be_formed(ranges.total(), contact, subdomains.count()) {
            return None;
        }
        let mut groups = RowGroups::default();
        for glob in &self.gluing.globs {
            for run in 0..glob.runs as usize {
                let entries = self.gluing.block(glob.block(run, 0)).iter();
                groups.add(false, 3 * glob.nodes as usize, entries.map(|entry| entry.subdomain));
            }
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
