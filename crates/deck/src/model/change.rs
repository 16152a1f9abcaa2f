//! `*MODEL CHANGE`.

use super::property::surfaces;
use crate::error::{DeckError, Fault};
use crate::lexer::{Card, Named};

/// What a step does to a contact pair.
#[derive(Debug, Clone)]
pub(crate) struct Change {
    /// Whether it comes, or goes.
    pub(crate) add: bool,
    pub(crate) slave: Named,
    pub(crate) master: Named,
}

/// `*MODEL CHANGE` of contact pairs.
pub(super) fn changes(card: &Card) -> Result<Vec<Change>, DeckError> {
    let of_pairs = card.value("TYPE")?.filter(|named| named.name == "CONTACTPAIR");
    if of_pairs.is_none() {
        let why = "bodies are there at all steps; contact pairs come and go with TYPE=CONTACT PAIR, and supports with \
            *BOUNDARY, OP=NEW";
        return Err(card.word.fault(Fault::Unsupported(why)));
    }
    card.allow(&["TYPE", "ADD", "REMOVE"])?;
    let add = match (card.flag("ADD")?, card.flag("REMOVE")?) {
        (add, remove) if add == remove => return Err(card.word.expected("ADD or REMOVE")),
        (add, _) => add,
    };
    let change = |[slave, master]: [Named; 2]| Change { add, slave, master };
    Ok(surfaces(card)?.into_iter().map(change).collect())
}
