//! `*EXPANSION`, initial temperatures and `*TEMPERATURE`.

use super::mesh::target;
use super::property::{of_material, twice};
use super::step::{Condition, Given, Step, amplitude};
use super::{Ignored, Model};
use crate::error::{DeckError, Fault, Word};
use crate::lexer::Card;

/// Coefficients of expansion along x, y, z.
pub(super) fn expansion(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["TYPE", "ZERO"])?;
    let material = of_material(model, card)?;
    let (wanted, count) = match card.choice("TYPE", &["ISO", "ORTHO"], "TYPE=ISO or ORTHO; shears are not read")? {
        Some(1) => (
            "three coefficients in one line, and at most a temperature: laws that depend on temperature are not read",
            3,
        ),
        _ => (
            "one coefficient in one line, and at most a temperature: laws that depend on temperature are not read",
            1,
        ),
    };
    let line = card.only_line(wanted)?;
    let fields = line.at_most(count + 1, wanted)?;
    let mut coefficients = [0.0; 3];
    for (k, coefficient) in coefficients.iter_mut().enumerate() {
        *coefficient = line.real(&fields, k.min(count - 1), wanted)?;
    }
    if let Some((before, _)) = &material.expansion {
        return Err(twice(card, before));
    }
    material.expansion = Some((line.location.clone(), coefficients));
    if let Some(param) = card.param("ZERO") {
        let why = "with a constant coefficient only the rise above the initial temperature counts";
        model.ignored.push(Ignored::new(&param.word, why));
    }
    Ok(())
}

/// `*INITIAL CONDITIONS`.
pub(super) fn initial(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["TYPE"])?;
    if card.need("TYPE")?.name != "TEMPERATURE" {
        let why = "the body is at rest and without stress before the first step; TYPE=TEMPERATURE alone is read";
        return Err(card.word.fault(Fault::Unsupported(why)));
    }
    for line in &card.lines {
        model.initial.push(temperature(line, None)?);
    }
    Ok(())
}

/// `*TEMPERATURE`.
pub(super) fn temperatures(model: &Model, step: &mut Step, card: &Card) -> Result<(), DeckError> {
    card.allow(&["OP", "AMPLITUDE"])?;
    let amplitude = amplitude(model, card)?;
    step.temperatures.card(card)?;
    for line in &card.lines {
        step.temperatures.lines.push(temperature(line, amplitude)?);
    }
    Ok(())
}

fn temperature(line: &Word, amplitude: Option<usize>) -> Result<Condition<()>, DeckError> {
    let wanted = "a node or node set, and a temperature";
    let fields = line.at_most(2, wanted)?;
    Ok(Condition {
        word: line.part(fields[0]),
        target: target(line, fields[0])?,
        kind: (),
        given: Given {
            value: line.real(&fields, 1, wanted)?,
            amplitude,
        },
    })
}
