//! Contact pairs and ties.

use signorini_contact::{Contact, Friction};
use signorini_fem_mesh::FacetTag;

use super::faces::{FaceTable, Known};
use super::rigid::{Motion, half_space};
use crate::error::{DeckError, Fault};
use crate::lexer::{Param, name};
use crate::model::{Names, named};

/// One contact for each pair: nodes of the dependent surface touch nodes of the other one, or a rigid plane.
pub(super) fn contacts(
    known: Known,
    faces: &FaceTable,
    surfaces: &Names<Vec<FacetTag>>,
    motions: &[Motion],
) -> Result<Vec<Contact>, DeckError> {
    let model = known.model;
    let mut out = Vec::with_capacity(model.pairs.len());
    for pair in &model.pairs {
        let fault = |word: &str, text: String| DeckError::at(&pair.location, word, Fault::Cannot(text));
        let interaction = |param: &Param| {
            let at = (&pair.location, param.word.as_str());
            model.interactions.find("interaction", &named(param), at)
        };
        let interaction = pair.interaction.as_ref().map(interaction).transpose()?;
        let surface = |word: &str| surfaces.find("surface", &name(word), (&pair.location, word));
        let (dependent, other) = (surface(&pair.slave)?, surface(&pair.master)?);
        let (slave, master) = (surfaces.at(dependent), surfaces.at(other));
        if slave.is_empty() {
            let text = "a rigid surface has to be the second (independent) one of a pair; swap them";
            return Err(fault(&pair.slave, text.into()));
        }
        if slave.iter().any(|tag| master.contains(tag)) {
            let text = format!(
                "{} and {} share faces; a face does not touch itself, so give two surfaces",
                pair.slave, pair.master
            );
            return Err(fault(&pair.master, text));
        }
        let mut contact = if let (true, None) = (master.is_empty(), interaction) {
            let text = "a rigid surface cannot be tied; hold the nodes with *BOUNDARY, or use *CONTACT PAIR";
            return Err(fault(&pair.master, text.into()));
        } else if master.is_empty() {
            let nodes = faces.nodes_of(known.raw, dependent as u32);
            let plane = half_space(&faces.rigid[other], motions, slave[0], &nodes);
            plane.map_err(|text| fault(&pair.master, text))?
        } else {
            let between = match interaction {
                Some(_) => Contact::between(slave[0], master[0]),
                None => Contact::tied(slave[0], master[0]),
            };
            master[1..].iter().fold(between, |c, tag| c.with_partner(*tag))
        };
        for &tag in &slave[1..] {
            contact = contact.with_tag(tag);
        }
        if let Some(law) = interaction.map(|found| model.interactions.at(found)) {
            let [normal, tangential] = law.compliance;
            contact = contact
                .with_normal_compliance(normal)
                .with_tangential_compliance(tangential);
            if let Some(coefficient) = law.friction {
                contact = contact.with_friction(Friction::coulomb(coefficient));
            }
        }
        out.push(contact);
    }
    Ok(out)
}
