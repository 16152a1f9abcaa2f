//! Nodes without elements that take part in equations.

use super::couplings::Couplings;
use super::mesh::Raw;
use super::numbers::Sets;
use super::rigid::RigidBodies;
use crate::error::{DeckError, Word};
use crate::model::Term;

/// Nodes of the deck, by position, that equations name and no element uses, each with the first word that does.
#[derive(Debug, Default)]
pub(super) struct Points(pub(super) Vec<(u32, Word)>);

impl Points {
    pub(super) fn new(sets: &Sets, bodies: &RigidBodies, couplings: &Couplings, raw: &Raw) -> Result<Self, DeckError> {
        let mut out = Self::default();
        for Term { target, word, .. } in sets.model.equations.iter().flat_map(|e| &e.terms) {
            for node in sets.nodes.find(target, word)? {
                if bodies.has(node) || couplings.of(node).is_some() {
                    let label = sets.model.nodes[node as usize].label;
                    return Err(word.cannot(format!(
                        "node {label} stands for a rigid body or a surface, which equations do not know; let the equation \
                        name nodes of the body"
                    )));
                }
                if raw.in_mesh(node).is_none() && !out.has(node) {
                    out.0.push((node, word.clone()));
                }
            }
        }
        Ok(out)
    }

    /// Whether a node is one of them.
    pub(super) fn has(&self, node: u32) -> bool {
        self.0.iter().any(|(point, _)| *point == node)
    }
}
