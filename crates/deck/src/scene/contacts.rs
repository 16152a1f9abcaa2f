//! Contact pairs and ties.

use signorini_contact::{Contact, Friction};
use signorini_fem_mesh::FacetTag;

use super::faces::{FaceTable, Known};
use super::rigid::{Motion, obstacle};
use super::ties;
use crate::error::DeckError;
use crate::lexer::Named;
use crate::model::{Ignored, Law, Names};

/// One contact for each pair: nodes of the dependent surface touch nodes of the other one, or an obstacle.
pub(super) fn contacts(
    known: Known,
    faces: &FaceTable,
    surfaces: &Names<Vec<FacetTag>>,
    motions: &[Motion],
    ignored: &mut Vec<Ignored>,
) -> Result<Vec<Contact>, DeckError> {
    let model = known.model;
    let mut out = Vec::with_capacity(model.pairs.len());
    for pair in &model.pairs {
        let interaction = match &pair.law {
            Law::Contact(Named { name, word }) => Some(model.interactions.find("interaction", name, word)?),
            Law::Tied(_) => None,
        };
        let surface = |Named { name, word }: &Named| surfaces.find("surface", name, word);
        let (dependent, other) = (surface(&pair.slave)?, surface(&pair.master)?);
        let (slave, master) = (surfaces.at(dependent), surfaces.at(other));
        let [own, partner] = [&pair.slave.word, &pair.master.word];
        if slave.is_empty() {
            return Err(own.cannot("a rigid surface has to be the second (independent) one of a pair; swap them"));
        }
        if slave.iter().any(|tag| master.contains(tag)) {
            return Err(partner.cannot(format!(
                "{} and {} share faces; a face does not touch itself, so give two surfaces",
                own.text, partner.text
            )));
        }
        if let (Law::Tied(tie), false) = (&pair.law, master.is_empty()) {
            ignored.extend(ties::check(known, faces, (pair, tie), [dependent, other])?);
        }
        let mut contact = match (&master[..], interaction) {
            ([], None) => {
                let why = "a rigid surface cannot be tied; hold the nodes with *BOUNDARY, or use *CONTACT PAIR";
                return Err(partner.cannot(why));
            }
            ([], Some(_)) => {
                let nodes = faces.places_of(known.raw, dependent as u32);
                let rigid = obstacle(&faces.rigid[other], motions, slave[0], &nodes);
                rigid.map_err(|why| partner.cannot(why))?
            }
            ([first, more @ ..], interaction) => {
                let between = match interaction {
                    Some(_) => Contact::between(slave[0], *first),
                    None => Contact::tied(slave[0], *first),
                };
                more.iter().fold(between, |c, tag| c.with_partner(*tag))
            }
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
