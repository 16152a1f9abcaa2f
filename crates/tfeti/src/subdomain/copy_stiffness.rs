//! Stiffness of the copies of a node, where they differ: in a body of several materials, and in ragged cuts.

use crate::subdomain::matrices::{ClassBase, Subdomains};
use crate::tolerances::{ALIKE, RIGID};
use signorini_fem_mesh::Decomposition;
use signorini_fem_mesh::decomposition::NodeCopy;
use std::collections::HashMap;

/// The stiffness that each copy of a node has in its subdomain: the mean diagonal entry of the stiffness matrix.
///
/// Rows that act on a node of several subdomains take the mean of its copies with these weights. Between a stiff and a
/// soft subdomain they so follow the stiff one, to which gluing takes the soft copy, and the errors of gluing, large in
/// the soft one, stay out of them. Likewise between the bulk of a subdomain and the tip of a single tetrahedron of
/// another one.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CopyStiffness {
    /// First node of each subdomain in torn order.
    first: Vec<usize>,
    /// In torn order; empty where all copies of a node count alike.
    values: Vec<f64>,
}

impl CopyStiffness {
    /// With the mesh node of each copy in torn order. Copies in rigid subdomains are as much stiffer than the others of
    /// their node, places than all.
    pub(crate) fn new(subdomains: &Subdomains, node_of: impl Iterator<Item = Option<u32>>) -> Self {
        let by_class = |base: &ClassBase| -> Vec<f64> {
            let mean = |node: usize| {
                let diagonal = (3 * node..3 * node + 3).map(|i| base.diagonal[i]);
                (diagonal.sum::<f64>() / 3.0).max(f64::MIN_POSITIVE)
            };
            (0..base.diagonal.len() / 3).map(mean).collect()
        };
        let by_class: Vec<Vec<f64>> = subdomains.bases.iter().map(by_class).collect();
        let copies = (0..subdomains.count())
            .map(|s| by_class[subdomains.class(s)].len())
            .sum();
        let (mut first, mut values) = (Vec::with_capacity(subdomains.count()), Vec::with_capacity(copies));
        for s in 0..subdomains.count() {
            first.push(values.len());
            values.extend(&by_class[subdomains.class(s)]);
        }
        let is_rigid = |s: usize| subdomains.classes.classes()[subdomains.class(s)].is_rigid;
        if (0..subdomains.count()).any(is_rigid) {
            let node_of: Vec<Option<u32>> = node_of.collect();
            let mut largest: HashMap<Option<u32>, f64> = HashMap::new();
            for (node, value) in node_of.iter().zip(&values) {
                for node in [*node, None] {
                    let most = largest.entry(node).or_default();
                    *most = most.max(*value);
                }
            }
            for s in (0..subdomains.count()).filter(|s| is_rigid(*s)) {
                for k in first[s]..first[s] + by_class[subdomains.class(s)].len() {
                    values[k] = RIGID * largest.get(&node_of[k]).copied().unwrap_or(0.0);
                }
            }
        }
        Self { first, values }
    }

    /// Whether the copies of some node differ much.
    pub(crate) fn differs(&self, decomposition: &Decomposition) -> bool {
        let differ = |node: usize| {
            let copies = decomposition.copies(node);
            let (least, most) = copies
                .iter()
                .map(|c| self.of(c))
                .fold((f64::INFINITY, 0.0), |(a, b), v| (v.min(a), v.max(b)));
            most > ALIKE * least
        };
        (0..decomposition.nodes()).any(differ)
    }

    /// Whether all copies of a node count alike.
    pub(crate) fn is_plain(&self) -> bool {
        self.values.is_empty()
    }

    /// What the copy `k` in torn order counts in the mean of its node; only ratios matter.
    pub fn weight(&self, k: usize) -> f64 {
        self.values.get(k).copied().unwrap_or(1.0)
    }

    /// The same of a copy.
    pub fn of(&self, copy: &NodeCopy) -> f64 {
        self.weight(self.first[copy.subdomain as usize] + copy.local as usize)
    }

    /// Sum of the squared shares of the copies in their mean.
    pub(crate) fn squares(&self, copies: &[NodeCopy]) -> f64 {
        if self.is_plain() || copies.len() < 2 {
            return 1.0 / copies.len() as f64;
        }
        let sum: f64 = copies.iter().map(|c| self.of(c)).sum();
        copies.iter().map(|c| (self.of(c) / sum).powi(2)).sum()
    }

    /// Shares of the copies in their mean, scaled to length 1.
    pub(crate) fn unit_shares(&self, copies: &[NodeCopy], out: &mut Vec<f64>) {
        out.clear();
        if self.is_plain() || copies.len() < 2 {
            out.resize(copies.len(), 1.0 / (copies.len() as f64).sqrt());
            return;
        }
        let largest = copies.iter().map(|c| self.of(c)).fold(0.0, f64::max);
        out.extend(copies.iter().map(|c| self.of(c) / largest));
        let length = out.iter().map(|v| v * v).sum::<f64>().sqrt();
        out.iter_mut().for_each(|v| *v /= length);
    }
}
