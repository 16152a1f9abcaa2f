//! `*COUPLING`: nodes that stand for a surface.

use super::Model;
use super::mesh::node_of;
use super::step::Target;
use crate::error::{DeckError, Word};
use crate::lexer::{Card, Named};

/// A node whose loads a surface takes, or whose displacement it has.
#[derive(Debug, Clone)]
pub(crate) struct Coupling {
    pub(crate) word: Word,
    /// The node, with the word that names it.
    pub(crate) reference: (Target, Word),
    pub(crate) surface: Named,
    /// What the card behind it says.
    pub(crate) law: Option<CouplingLaw>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum CouplingLaw {
    /// Loads are spread over the surface, forces always and these moments.
    Distributing { moments: [bool; 3] },
    /// The surface keeps its shape and moves as the node.
    Kinematic,
    /// The body is cut at the surface, and its sides move against each other along a normal, which may be given.
    Pretension { normal: Option<[f64; 3]> },
}

/// `*COUPLING`.
pub(super) fn coupling(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["CONSTRAINT NAME", "REF NODE", "SURFACE"])?;
    card.lines_at_most(
        0,
        "no data; *DISTRIBUTING or *KINEMATIC follows as a keyword of its own",
    )?;
    card.value("CONSTRAINTNAME")?;
    model.couplings.push(Coupling {
        word: card.word.clone(),
        reference: node_of(card.need("REFNODE")?),
        surface: card.need("SURFACE")?,
        law: None,
    });
    Ok(())
}

/// `*PRE-TENSION SECTION`.
pub(super) fn pretension(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["SURFACE", "NODE"])?;
    card.lines_at_most(1, "the normal")?;
    let wanted = "the three components of the normal";
    let normal = card.lines.first();
    let normal = normal.map(|line| line.reals(&line.at_most(3, wanted)?, 0, wanted));
    model.couplings.push(Coupling {
        word: card.word.clone(),
        reference: node_of(card.need("NODE")?),
        surface: card.need("SURFACE")?,
        law: Some(CouplingLaw::Pretension {
            normal: normal.transpose()?,
        }),
    });
    Ok(())
}

/// `*DISTRIBUTING`, and `*KINEMATIC` with `rigid`.
pub(super) fn law(model: &mut Model, card: &Card, rigid: bool) -> Result<(), DeckError> {
    card.allow(if rigid { &[] } else { &["COUPLING", "WEIGHTING METHOD"] })?;
    card.choice("COUPLING", &["CONTINUUM"], "COUPLING=CONTINUUM")?;
    card.choice("WEIGHTINGMETHOD", &["UNIFORM"], "WEIGHTING METHOD=UNIFORM: by area")?;
    let wanted = "the first and the last component, 1 to 6";
    let mut on = [card.lines.is_empty(); 6];
    for line in &card.lines {
        let fields = line.at_most(2, wanted)?;
        let first = line.label(&fields, 0, wanted)?;
        let last = match fields.get(1) {
            None | Some(&"") => first,
            Some(_) => line.label(&fields, 1, wanted)?,
        };
        if last < first || last > 6 {
            return Err(line.expected(wanted));
        }
        (first..=last).for_each(|c| on[c as usize - 1] = true);
    }
    if rigid && !on[..3].iter().all(|on| *on) {
        let why = "a surface of which some components move freely is not here; give 1 to 3, or hold its nodes, or let \
            single components follow a node by *EQUATION";
        return Err(card.lines[0].cannot(why));
    }
    let last = model.couplings.last_mut().filter(|last| last.law.is_none());
    let last = last.ok_or_else(|| card.word.cannot("this belongs to a coupling; put *COUPLING before it"))?;
    last.law = Some(if rigid {
        CouplingLaw::Kinematic
    } else {
        CouplingLaw::Distributing {
            moments: [on[3], on[4], on[5]],
        }
    });
    Ok(())
}
