//! Contact pairs.

use signorini_contact::{Contact, Friction};
use signorini_fem_mesh::FacetTag;

use crate::error::{DeckError, Fault};
use crate::lexer::name;
use crate::model::{Model, Names, named};

/// One contact for each pair: nodes of the dependent surface touch nodes of the other one.
pub(super) fn contacts(
    model: &Model,
    surfaces: &Names<Vec<FacetTag>>,
) -> Result<Vec<Contact>, DeckError> {
    let mut out = Vec::with_capacity(model.pairs.len());
    for pair in &model.pairs {
        let interaction = named(&pair.interaction);
        let at = (&pair.place, pair.interaction.word.as_str());
        let found = model.interactions.find("interaction", &interaction, at)?;
        let tags = |word: &str| -> Result<&Vec<FacetTag>, DeckError> {
            let found = surfaces.find("surface", &name(word), (&pair.place, word))?;
            Ok(surfaces.at(found))
        };
        let (slave, master) = (tags(&pair.slave)?, tags(&pair.master)?);
        if slave.iter().any(|tag| master.contains(tag)) {
            let text = format!(
                "{} and {} share faces; a face does not touch itself, so give two surfaces",
                pair.slave, pair.master
            );
            return Err(DeckError::at(
                &pair.place,
                &pair.master,
                Fault::Cannot(text),
            ));
        }
        // surfaces are not empty
        let mut contact = Contact::between(slave[0], master[0]);
        for &tag in &slave[1..] {
            contact = contact.with_tag(tag);
        }
        for &tag in &master[1..] {
            contact = contact.with_partner(tag);
        }
        if let Some(coefficient) = model.interactions.at(found).friction {
            contact = contact.with_friction(Friction::coulomb(coefficient));
        }
        out.push(contact);
    }
    Ok(out)
}
