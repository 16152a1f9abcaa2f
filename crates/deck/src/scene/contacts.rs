//! Contact pairs and ties.

use signorini_contact::{Contact, Friction};
use signorini_fem_mesh::FacetTag;

use super::faces::{FaceTable, Known};
use super::rigid::{Motion, obstacle};
use super::ties;
use crate::error::DeckError;
use crate::lexer::Named;
use crate::model::{Clearance, Ignored, Law, Names, Pair, Touch};

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
            Law::Contact(Touch { interaction, .. }) => Some(model.interactions.find(
                "interaction",
                &interaction.name,
                &interaction.word,
            )?),
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
        let given = model
            .clearances
            .iter()
            .rfind(|c| c.slave.name == pair.slave.name && c.master.name == pair.master.name);
        let adjust = match &pair.law {
            Law::Contact(Touch { adjust, .. }) => adjust.as_ref(),
            Law::Tied(_) => None,
        };
        contact = match (given, adjust) {
            (Some(given), _) => contact.with_gap(given.value),
            (None, Some((word, _))) if master.is_empty() => {
                return Err(
                    word.cannot("gaps to a rigid surface are not closed; put the nodes on it, and remove ADJUST")
                );
            }
            (None, Some((word, reach))) => {
                let why = "nodes are not moved; where a gap is not larger than this, the sides touch without stress";
                ignored.push(Ignored::new(word, why));
                contact.with_closed_gaps(*reach)
            }
            (None, None) => contact,
        };
        out.push(contact);
    }
    for Clearance {
        word, slave, master, ..
    } in &model.clearances
    {
        let touch = |pair: &&Pair| matches!(pair.law, Law::Contact(_));
        let mut pairs = model.pairs.iter().filter(touch);
        if !pairs.any(|pair| pair.slave.name == slave.name && pair.master.name == master.name) {
            return Err(word.cannot("no *CONTACT PAIR has these surfaces in this order; name those of one"));
        }
    }
    Ok(out)
}
