//! Contact pairs and ties.

use std::collections::{BTreeMap, BTreeSet};

use signorini_contact::{Contact, Friction};
use signorini_fem_mesh::FacetTag;

use super::changes::spans;
use super::faces::FaceTable;
use super::known::Known;
use super::rigid::{FreeLead, Lead, obstacle};
use super::ties;
use super::timeline::Acting;
use crate::error::{DeckError, Fault, Word};
use crate::lexer::Named;
use crate::model::{Clearance, Ignored, Law, Model, Names, Pair, Tie, Touch};

/// One contact for each pair, and those of pairs that come back, with the position of the pair.
pub(super) struct Contacts {
    pub(super) first: Vec<Contact>,
    pub(super) later: Vec<(usize, Contact)>,
}

/// Nodes of the dependent surface of each pair touch nodes of the other one, or an obstacle.
pub(super) fn contacts(
    known: Known,
    faces: &FaceTable,
    surfaces: &Names<Vec<FacetTag>>,
    leads: &[Result<Lead, FreeLead>],
    ignored: &mut Vec<Ignored>,
) -> Result<Contacts, DeckError> {
    let (model, clearances) = (known.model, clearances(known.model)?);
    let spans = spans(model, ignored)?;
    let (mut first, mut later) = (Vec::with_capacity(model.pairs.len()), Vec::new());
    for (index, (pair, spans)) in model.pairs.iter().zip(spans).enumerate() {
        let law = match &pair.law {
            Law::Contact(Touch { interaction, .. }) => {
                let Named { name, word } = interaction;
                let found = model.interactions.find("interaction", name, word)?;
                Some(model.interactions.at(found))
            }
            Law::Tied(_) => None,
        };
        let sides = sides(known, surfaces, pair)?;
        let tie = match (&pair.law, law.and_then(|law| law.tied.as_ref())) {
            (Law::Tied(tie), _) => Some(tie.clone()),
            (Law::Contact(_), Some(word)) if clearances.contains_key(&pair.surfaces()) => {
                let why = "pairs of this interaction are tied and have no gap; remove their *CLEARANCE";
                return Err(word.cannot(why));
            }
            (Law::Contact(touch), Some(word)) => Some(tied(touch, word, ignored)),
            (Law::Contact(_), None) => None,
        };
        let law = law.filter(|_| tie.is_none());
        if let (Some(tie), false) = (&tie, surfaces.at(sides[1]).is_empty()) {
            ignored.extend(ties::check(known, faces, (pair, tie), sides)?);
        }
        let [slave, master] = sides.map(|side| &surfaces.at(side)[..]);
        // a gap is that to a plane or along measured normals; the rim of another rigid surface has none
        let (contact, takes_gap) = match (master, law) {
            ([], None) => {
                let why = "a rigid surface cannot be tied; hold the nodes with *BOUNDARY, or use *CONTACT PAIR";
                return Err(pair.master.word.cannot(why));
            }
            ([], Some(_)) => {
                let nodes = faces.places_of(known.raw, sides[0] as u32);
                let moves = (known.timeline, leads);
                obstacle(&faces.rigid[sides[1]], moves, (slave[0], &nodes), &pair.master.word)?
            }
            ([first, more @ ..], law) => {
                let contact = match law {
                    Some(_) => Contact::between(slave[0], *first),
                    None => Contact::tied(slave[0], *first),
                };
                (more.iter().fold(contact, |c, tag| c.with_partner(*tag)), true)
            }
        };
        let mut contact = slave[1..].iter().fold(contact, |c, tag| c.with_tag(*tag));
        if let Some(law) = law {
            let [normal, tangential] = law.compliance;
            contact = contact
                .with_normal_compliance(normal)
                .with_tangential_compliance(tangential);
            if let Some(coefficient) = law.friction {
                contact = contact.with_friction(Friction::coulomb(coefficient));
            }
        }
        if let (Law::Contact(touch), Some(_)) = (&pair.law, law) {
            let given = clearances.get(&pair.surfaces()).copied();
            contact = with_gap(contact, (given, takes_gap), (touch, master.is_empty()), ignored)?;
        }
        let during = |[from, until]: Acting| {
            let start = |step| known.timeline.span(step).map(|span| span.start);
            let contact = start(from).map_or(contact.clone(), |time| contact.clone().with_start(time));
            start(until).map_or(contact.clone(), |time| contact.with_end(time))
        };
        let mut all = spans.into_iter().map(during);
        // one that is gone all the time comes when all is over
        let over = known.timeline.spans.last().map_or(0.0, |last| last.end);
        first.push(all.next().unwrap_or_else(|| contact.clone().with_start(over)));
        later.extend(all.map(|contact| (index, contact)));
    }
    Ok(Contacts { first, later })
}

/// What an interaction that ties makes of a contact pair.
fn tied(touch: &Touch, word: &Word, ignored: &mut Vec<Ignored>) -> Tie {
    let why = "the sides are tied without giving way, whatever the slope and the friction";
    ignored.push(Ignored::new(word, why));
    Tie {
        word: word.clone(),
        adjust: true,
        tolerance: touch.adjust.as_ref().map(|(_, reach)| *reach),
    }
}

/// The positions of both surfaces of a pair, which have no face in common; the dependent one has faces of elements.
fn sides(known: Known, surfaces: &Names<Vec<FacetTag>>, pair: &Pair) -> Result<[usize; 2], DeckError> {
    let surface = |Named { name, word }: &Named| surfaces.find("surface", name, word);
    let (dependent, other) = (surface(&pair.slave)?, surface(&pair.master)?);
    let [own, partner] = [&pair.slave.word, &pair.master.word];
    known.sections.check_outside(dependent, own)?;
    known.sections.check_outside(other, partner)?;
    let (slave, master) = (surfaces.at(dependent), surfaces.at(other));
    if slave.is_empty() {
        return Err(own.cannot("a rigid surface has to be the second (independent) one of a pair; swap them"));
    }
    if slave.iter().any(|tag| master.contains(tag)) {
        Err(partner.cannot(format!(
            "{} and {} share faces; a face does not touch itself, so give two surfaces",
            own.text, partner.text
        )))
    } else {
        Ok([dependent, other])
    }
}

/// The contact with the gap of its `*CLEARANCE`, where it takes one, or without those that `ADJUST` closes.
fn with_gap(
    contact: Contact,
    (given, takes_gap): (Option<&Clearance>, bool),
    (touch, is_rigid): (&Touch, bool),
    ignored: &mut Vec<Ignored>,
) -> Result<Contact, DeckError> {
    match (given, &touch.adjust) {
        (Some(given), _) if !takes_gap => Err(given.word.cannot(
            "the gap to a rigid surface is prescribed only where that is a half-space: flat, below all nodes of the \
            first surface, and not turning; remove this and put the nodes where they are",
        )),
        (Some(given), adjust) => {
            let why = "the gap of this pair is that of its *CLEARANCE";
            ignored.extend(adjust.iter().map(|(word, _)| Ignored::new(word, why)));
            Ok(contact.with_gap(given.value))
        }
        (None, Some((word, _))) if is_rigid => {
            let why = "gaps to a rigid surface are not closed; put the nodes on it, and remove ADJUST";
            Err(word.cannot(why))
        }
        (None, Some((word, reach))) => {
            let why = "nodes are not moved; where a gap is not larger than this, the sides touch without stress";
            ignored.push(Ignored::new(word, why));
            Ok(contact.with_closed_gaps(*reach))
        }
        (None, None) if is_rigid => Ok(contact),
        (None, None) => Ok(contact.with_measured_overlaps()),
    }
}

/// The clearances of contact pairs, by their surfaces. Refuses those of no pair, and second ones of a pair.
fn clearances(model: &Model) -> Result<BTreeMap<[&str; 2], &Clearance>, DeckError> {
    let contacts = model.pairs.iter().filter(|pair| matches!(pair.law, Law::Contact(_)));
    let pairs: BTreeSet<[&str; 2]> = contacts.map(Pair::surfaces).collect();
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
