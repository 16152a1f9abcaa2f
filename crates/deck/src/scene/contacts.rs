//! Contact pairs and ties.

use std::collections::{BTreeMap, BTreeSet};

use signorini_contact::{Contact, Friction};
use signorini_fem_mesh::FacetTag;

use super::faces::{FaceTable, Known};
use super::rigid::{FreeLead, Lead, obstacle};
use super::ties;
use crate::error::{DeckError, Fault};
use crate::lexer::Named;
use crate::model::{Clearance, Ignored, Law, Model, Names, Pair, Touch};

/// One contact for each pair: nodes of the dependent surface touch nodes of the other one, or an obstacle.
pub(super) fn contacts(
    known: Known,
    faces: &FaceTable,
    surfaces: &Names<Vec<FacetTag>>,
    leads: &[Result<Lead, FreeLead>],
    ignored: &mut Vec<Ignored>,
) -> Result<Vec<Contact>, DeckError> {
    let model = known.model;
    let clearances = clearances(model)?;
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
        known.sections.check_outside(dependent, own)?;
        known.sections.check_outside(other, partner)?;
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
        // a gap is that to a plane or along measured normals; the rim of another rigid surface has none
        let (mut contact, takes_gap) = match (&master[..], interaction) {
            ([], None) => {
                let why = "a rigid surface cannot be tied; hold the nodes with *BOUNDARY, or use *CONTACT PAIR";
                return Err(partner.cannot(why));
            }
            ([], Some(_)) => {
                let nodes = faces.places_of(known.raw, dependent as u32);
                let moves = (known.timeline, leads);
                obstacle(&faces.rigid[other], moves, (slave[0], &nodes), partner)?
            }
            ([first, more @ ..], interaction) => {
                let between = match interaction {
                    Some(_) => Contact::between(slave[0], *first),
                    None => Contact::tied(slave[0], *first),
                };
                (more.iter().fold(between, |c, tag| c.with_partner(*tag)), true)
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
        if let Law::Contact(Touch { adjust, .. }) = &pair.law {
            contact = match (clearances.get(&surfaces_of(pair)), adjust) {
                (Some(given), _) if !takes_gap => {
                    return Err(given.word.cannot(
                        "the gap to a rigid surface is prescribed only where that is a half-space: flat, below all \
                        nodes of the first surface, and not turning; remove this and put the nodes where they are",
                    ));
                }
                (Some(given), adjust) => {
                    let why = "the gap of this pair is that of its *CLEARANCE";
                    ignored.extend(adjust.iter().map(|(word, _)| Ignored::new(word, why)));
                    contact.with_gap(given.value)
                }
                (None, Some((word, _))) if master.is_empty() => {
                    let why = "gaps to a rigid surface are not closed; put the nodes on it, and remove ADJUST";
                    return Err(word.cannot(why));
                }
                (None, Some((word, reach))) => {
                    let why =
                        "nodes are not moved; where a gap is not larger than this, the sides touch without stress";
                    ignored.push(Ignored::new(word, why));
                    contact.with_closed_gaps(*reach)
                }
                (None, None) => contact,
            };
        }
        out.push(contact);
    }
    Ok(out)
}

/// The names of both surfaces.
fn surfaces_of(pair: &Pair) -> [&str; 2] {
    [&pair.slave.name, &pair.master.name]
}

/// The clearances of contact pairs, by their surfaces. Refuses those of no pair, and second ones of a pair.
fn clearances(model: &Model) -> Result<BTreeMap<[&str; 2], &Clearance>, DeckError> {
    let contacts = model.pairs.iter().filter(|pair| matches!(pair.law, Law::Contact(_)));
    let pairs: BTreeSet<[&str; 2]> = contacts.map(surfaces_of).collect();
    let mut known: BTreeMap<[&str; 2], &Clearance> = BTreeMap::new();
    for given in &model.clearances {
        let surfaces = [given.slave.name.as_str(), given.master.name.as_str()];
        if let Some(before) = known.insert(surfaces, given) {
            return Err(given.word.fault(Fault::Repeated {
                first: before.word.location.clone(),
                remedy: "keep one of them",
            }));
        }
        if !pairs.contains(&surfaces) {
            let why = "no *CONTACT PAIR has these surfaces in this order; name those of one";
            return Err(given.word.cannot(why));
        }
    }
    Ok(known)
}
