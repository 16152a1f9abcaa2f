//! `*EQUATION`, `*MPC`: linear equations between displacements.

use super::Model;
use super::mesh::target;
use super::step::Target;
use crate::error::{DeckError, Word};
use crate::lexer::{Card, name};

/// A linear equation, its terms summing to zero.
#[derive(Debug, Clone)]
pub(crate) struct Equation {
    /// The keyword, where the equation begins.
    pub(crate) word: Word,
    pub(crate) terms: Vec<Term>,
}

/// A component of the displacement of a node, or of each node of a set, times a coefficient.
#[derive(Debug, Clone)]
pub(crate) struct Term {
    pub(crate) target: Target,
    /// The word that names it.
    pub(crate) word: Word,
    /// From 0.
    pub(crate) component: usize,
    pub(crate) coefficient: f64,
}

/// Nodes that stay in one plane, or on one line.
#[derive(Debug, Clone)]
pub(crate) struct Flat {
    /// The keyword, where their line is.
    pub(crate) word: Word,
    pub(crate) is_line: bool,
    pub(crate) nodes: Vec<(Target, Word)>,
}

/// `*MPC`: the type and nodes, and lines with more of them, where zeros are none.
pub(super) fn mpc(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&[])?;
    let wanted = "PLANE or STRAIGHT, and nodes or sets of them";
    let mut last: Option<Flat> = None;
    for line in &card.lines {
        let fields = line.fields();
        let mut nodes = &fields[..];
        if let [first, rest @ ..] = nodes
            && ["STRAIGHT", "PLANE"].contains(&&*name(first))
        {
            let flat = Flat {
                word: Word::new(&line.location, &card.word.text),
                is_line: name(first) == "STRAIGHT",
                nodes: Vec::new(),
            };
            model.flats.extend(last.replace(flat));
            nodes = rest;
        }
        let Some(flat) = &mut last else {
            return Err(line.entry(nodes, 0).expected(wanted));
        };
        for node in nodes.iter().filter(|node| **node != "0") {
            flat.nodes.push((target(line, node)?, line.part(node)));
        }
    }
    if card.lines.is_empty() {
        return Err(card.word.expected(wanted));
    }
    model.flats.extend(last);
    Ok(())
}

/// `*EQUATION`: the number of terms, then these, some a line, and so on.
pub(super) fn equation(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&[])?;
    let wanted = "the number of terms of an equation, alone in its line";
    let term = "a term: a node or a set, its component 1, 2 or 3, and a coefficient";
    let mut lines = card.lines.iter();
    while let Some(line) = lines.next() {
        let fields = line.at_most(1, wanted)?;
        let count = line.label(&fields, 0, wanted)? as usize;
        let word = Word::new(&line.location, &card.word.text);
        let mut terms = Vec::new();
        while terms.len() < count {
            let missing = || line.cannot("the equation has fewer terms than it says; correct the number");
            let line = lines.next().ok_or_else(missing)?;
            let fields = line.fields();
            for own in fields.chunks(3) {
                let component = line.label(own, 1, term)? as usize;
                if component > 3 {
                    return Err(line.part(own[1]).expected(term));
                }
                terms.push(Term {
                    target: target(line, own[0])?,
                    word: line.part(own[0]),
                    component: component - 1,
                    coefficient: line.real(own, 2, term)?,
                });
            }
        }
        if terms.len() > count {
            return Err(line.cannot("the equation has more terms than it says; correct the number"));
        }
        model.equations.push(Equation { word, terms });
    }
    if card.lines.is_empty() { Err(card.word.expected(wanted)) } else { Ok(()) }
}
