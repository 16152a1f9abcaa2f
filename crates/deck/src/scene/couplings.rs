//! Nodes that stand for surfaces.

use super::mesh::Raw;
use super::numbers::Sets;
use super::rigid::RigidBodies;
use crate::error::{DeckError, Word};
use crate::model::CouplingLaw;

/// A node of the deck, by position, and the surface for which it stands.
#[derive(Debug)]
pub(super) struct Coupling {
    pub(super) node: u32,
    pub(super) law: CouplingLaw,
    /// Its position, and the word that names it.
    pub(super) surface: usize,
    pub(super) word: Word,
}

/// All couplings.
#[derive(Debug, Default)]
pub(super) struct Couplings(pub(super) Vec<Coupling>);

impl Couplings {
    pub(super) fn new(sets: &Sets, bodies: &RigidBodies, raw: &Raw) -> Result<Self, DeckError> {
        let mut list: Vec<Coupling> = Vec::with_capacity(sets.model.couplings.len());
        for said in &sets.model.couplings {
            let law = said.law;
            let law = law.ok_or_else(|| {
                let why = "the coupling does not say what it does; put *DISTRIBUTING or *KINEMATIC behind it";
                said.word.cannot(why)
            })?;
            let (target, word) = &said.reference;
            let node = sets.one_node(target, word)?;
            let uses = [
                (raw.in_mesh(node).is_some(), "belongs to an elastic element"),
                (bodies.has(node), "says how a rigid body moves"),
                (list.iter().any(|o| o.node == node), "stands for another surface"),
            ];
            if let Some((_, other)) = uses.into_iter().find(|used| used.0) {
                let label = sets.model.nodes[node as usize].label;
                let why = format!("node {label} {other}; give the coupling a node of its own");
                return Err(word.cannot(why));
            }
            let surface = &said.surface;
            list.push(Coupling {
                node,
                law,
                surface: sets.model.surfaces.find("surface", &surface.name, &surface.word)?,
                word: surface.word.clone(),
            });
        }
        Ok(Self(list))
    }

    /// The coupling of a node of the deck, by position, and its own.
    pub(super) fn of(&self, node: u32) -> Option<(usize, &Coupling)> {
        self.0.iter().enumerate().find(|(_, coupling)| coupling.node == node)
    }

    /// Whether a surface, or one side of a section, has the displacement of a node.
    pub(super) fn moves(&self, node: u32) -> bool {
        let law = self.of(node).map(|(_, c)| c.law);
        matches!(law, Some(CouplingLaw::Kinematic | CouplingLaw::Pretension { .. }))
    }
}
