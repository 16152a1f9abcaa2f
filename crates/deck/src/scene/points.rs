//! Nodes without elements that take part in equations.

use super::couplings::Couplings;
use super::mesh::Raw;
use super::numbers::Sets;
use super::rigid::RigidBodies;
use crate::error::{DeckError, Fault, Word};
use crate::model::Term;

/// Most of them: the time of the set-up grows with the cube of their number.
const MOST: usize = 500;

/// Most terms of all equations together.
const TERMS: usize = 5_000_000;

/// How many terms there are so far, those of sets once for each of their nodes.
#[derive(Debug, Default)]
pub(super) struct Room(usize);

impl Room {
    /// Counts so many more; refuses too many.
    pub(super) fn take(&mut self, terms: usize, word: &Word) -> Result<(), DeckError> {
        self.0 += terms;
        match self.0 {
            0..=TERMS => Ok(()),
            _ => Err(word.fault(Fault::TooMany {
                what: "terms of equations, those of sets once for each of their nodes",
                most: TERMS as u64,
                remedy: "name smaller sets",
            })),
        }
    }
}

/// Nodes of the deck, by position, that equations name and no element uses, each with the first word that does.
#[derive(Debug, Default)]
pub(super) struct Points(pub(super) Vec<(u32, Word)>);

impl Points {
    pub(super) fn new(sets: &Sets, bodies: &RigidBodies, couplings: &Couplings, raw: &Raw) -> Result<Self, DeckError> {
        let (mut out, mut room) = (Self::default(), Room::default());
        for Term { target, word, .. } in sets.model.equations.iter().flat_map(|e| &e.terms) {
            let nodes = sets.nodes.find(target, word)?;
            room.take(nodes.len(), word)?;
            for node in nodes {
                if bodies.has(node) || couplings.of(node).is_some() {
                    let label = sets.model.nodes[node as usize].label;
                    return Err(word.cannot(format!(
                        "node {label} stands for a rigid body or a surface, which equations do not know; let the equation \
                        name nodes of the body"
                    )));
                }
                if raw.in_mesh(node).is_none() && !out.has(node) {
                    out.0.push((node, word.clone()));
                    if out.0.len() > MOST {
                        return Err(word.fault(Fault::TooMany {
                            what: "nodes in equations that no element uses",
                            most: MOST as u64,
                            remedy: "let equations name nodes of the body instead",
                        }));
                    }
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
