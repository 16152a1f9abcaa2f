//! What the parts of the scene are in the deck: errors of a simulation say it.

use std::ops::Range;

use signorini_contact::Part;
use signorini_fem_mesh::FacetTag;

use super::mesh::Raw;
use super::numbers::Sets;
use crate::model::{Law, Names, Pair};

/// Lines and names by the numbers of the scene.
#[derive(Debug, Clone, Default)]
pub(super) struct Parts {
    contacts: Vec<Option<String>>,
    pub(super) supports: Vec<String>,
    pub(super) couplings: Vec<String>,
    pub(super) equations: Vec<String>,
    pub(super) loads: Vec<String>,
    sections: Vec<String>,
    /// Increments up to the end of each step of the deck.
    pub(super) steps: Vec<(usize, String)>,
    surfaces: Vec<(FacetTag, String)>,
    /// Numbers in the deck, and for each the place of its set among the sections, if it has one.
    nodes: Vec<(u32, Option<u32>)>,
    /// Those that divided elements add, whose number is that of a neighbour.
    added: Range<usize>,
    elements: Vec<(u32, Option<u32>)>,
}

fn contact(pair: &Pair) -> String {
    let keyword = match pair.law {
        Law::Contact(_) => "*CONTACT PAIR",
        Law::Tied(_) => "*TIE",
    };
    let [first, second] = [&pair.slave.word, &pair.master.word];
    format!("{keyword} {}, {} ({})", first.text, second.text, first.location)
}

impl Parts {
    /// Those of the mesh; `regions` are the sections of the tetrahedra.
    pub(super) fn new(raw: &Raw, sets: &Sets, regions: &[u32]) -> Self {
        let model = sets.model;
        let region = |tet: usize| regions.get(tet).copied().filter(|_| !model.sections.is_empty());
        let mut nodes: Vec<_> = raw.node_labels.iter().map(|&label| (label, None)).collect();
        for (tet, corners) in raw.tets.iter().enumerate() {
            let mids = raw.mids.get(tet).into_iter().flatten();
            corners
                .iter()
                .chain(mids)
                .for_each(|&n| nodes[n as usize].1 = region(tet));
        }
        let elements = raw.element_labels.iter().enumerate();
        Self {
            nodes,
            added: raw.new_nodes(),
            elements: elements.map(|(tet, &label)| (label, region(tet))).collect(),
            sections: model.sections.iter().map(|s| s.elset.word.told()).collect(),
            contacts: model.pairs.iter().map(|pair| Some(contact(pair))).collect(),
            ..Self::default()
        }
    }

    /// Notes that pairs come back as the contacts behind so many.
    pub(super) fn come_back(&mut self, contacts: usize, pairs: impl Iterator<Item = usize>) {
        let names: Vec<_> = pairs.map(|pair| self.contacts.get(pair).cloned().flatten()).collect();
        self.contacts.resize(contacts, None);
        self.contacts.extend(names);
    }

    /// Notes the tags of surfaces.
    pub(super) fn tagged(&mut self, surfaces: &Names<Vec<FacetTag>>) {
        let pairs =
            |(name, tags): (&str, &Vec<FacetTag>)| tags.iter().map(|&t| (t, name.to_owned())).collect::<Vec<_>>();
        self.surfaces = surfaces.iter().flat_map(pairs).collect();
    }

    /// What a part is in the deck.
    pub(super) fn name(&self, part: Part) -> Option<String> {
        let numbered = |(label, section): (u32, Option<u32>)| {
            let section = section.and_then(|s| self.sections.get(s as usize));
            section.map_or_else(|| label.to_string(), |section| format!("{label} in {section}"))
        };
        match part {
            Part::Contact(index) => self.contacts.get(index).cloned().flatten(),
            Part::Support(index) => self.supports.get(index).cloned(),
            Part::Coupling(index) => self.couplings.get(index).cloned(),
            Part::Equation(index) => self.equations.get(index).cloned(),
            Part::Load(index) => self.loads.get(index).cloned(),
            Part::Step(step) => {
                let at = self.steps.partition_point(|s| s.0 <= step);
                let before = at.checked_sub(1).map_or(0, |last| self.steps[last].0);
                let (_, word) = self.steps.get(at)?;
                Some(format!("increment {} of {word}", step - before + 1))
            }
            Part::Region(region) => self.sections.get(region as usize).cloned(),
            Part::Node(node) => {
                let name = self.nodes.get(node as usize).copied().map(numbered);
                let added = self.added.contains(&(node as usize));
                name.map(|name| if added { format!("beside {name}") } else { name })
            }
            Part::Tet(tet) => self.elements.get(tet).copied().map(numbered),
            Part::Tag(tag) => {
                let with = self.surfaces.iter().filter(|s| s.0 == tag);
                let names: Vec<&str> = with.map(|s| &*s.1).collect();
                (!names.is_empty()).then(|| names.join(", "))
            }
            _ => None,
        }
    }
}
