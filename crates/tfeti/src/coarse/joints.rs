//! Which subdomains the interface joins rigidly, and what it does to those that it joins by an edge or a node only.
//!
//! Two subdomains that share three nodes not on one line move as one body. Those that share less are bodies of their
//! own, held together by the interface rows of the nodes that they share: a hinge or a ball joint.

use crate::rows::gluing::{BlockEntry, CopyEntry, Gluing};
use crate::tolerances::ANGLE;
use signorini_fem_mesh::vec3::{cross, norm, sub};
use std::collections::HashMap;

/// Nodes that two subdomains share, as far as it is known.
#[derive(Debug, Clone, Copy)]
enum Shared {
    One([f64; 3]),
    Line([[f64; 3]; 2]),
    Rigid,
}

impl Shared {
    fn add(self, p: [f64; 3]) -> Self {
        match self {
            Self::One(a) => Self::Line([a, p]),
            Self::Line([a, b]) => {
                let [u, v] = [b, p].map(|q| sub(q, a));
                if norm(cross(u, v)) > ANGLE * norm(u) * norm(v) { Self::Rigid } else { self }
            }
            Self::Rigid => self,
        }
    }
}

/// Pairs of subdomains that the interface joins rigidly, ascending.
pub(crate) fn rigid_pairs(gluing: &Gluing, position: impl Fn(usize, usize) -> [f64; 3]) -> Vec<(u32, u32)> {
    let mut pairs: HashMap<(u32, u32), Shared> = HashMap::new();
    for glob in &gluing.globs {
        for node in 0..glob.nodes as usize {
            let copies = gluing.copies(glob, node);
            let mut open = false;
            for (k, a) in copies.iter().enumerate() {
                for b in &copies[k + 1..] {
                    let place = || position(a.subdomain as usize, a.local as usize);
                    let shared = pairs
                        .entry((a.subdomain, b.subdomain))
                        .and_modify(|s| {
                            if !matches!(s, Shared::Rigid) {
                                *s = s.add(place());
                            }
                        })
                        .or_insert_with(|| Shared::One(place()));
                    open |= !matches!(shared, Shared::Rigid);
                }
            }
            // all nodes of a glob have the same subdomains
            if !open {
                break;
            }
        }
    }
    let rigid = pairs.into_iter().filter(|(_, shared)| matches!(shared, Shared::Rigid));
    let mut out: Vec<(u32, u32)> = rigid.map(|(pair, _)| pair).collect();
    out.sort_unstable();
    out
}

/// The interface rows between different bodies, as entries.
pub(crate) fn joint_rows(gluing: &Gluing, body_of: &[u32]) -> Vec<Vec<CopyEntry>> {
    let body = |subdomain: u32| body_of[subdomain as usize];
    let joins = |block: &usize| {
        let mut bodies = gluing.block(*block).iter().map(|e| body(e.subdomain));
        let first = bodies.next();
        bodies.any(|b| Some(b) != first)
    };
    let row = |block: usize, c: usize| {
        let entry = |e: &BlockEntry| CopyEntry {
            subdomain: e.subdomain,
            local: e.local,
            vector: std::array::from_fn(|k| if k == c { e.coefficient } else { 0.0 }),
        };
        gluing.block(block).iter().map(entry).collect()
    };
    (0..gluing.blocks())
        .filter(joins)
        .flat_map(|block| (0..3).map(move |c| row(block, c)))
        .collect()
}
