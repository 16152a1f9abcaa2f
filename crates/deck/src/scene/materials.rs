//! Sections as regions with materials.

use signorini_fem_mesh::Materials;

use super::mesh::Raw;
use super::numbers::Sets;
use crate::error::{DeckError, Word};

const NONE: u32 = u32::MAX;

/// The region of each tetrahedron, which is the number of its section from 0, and the materials; none for a
/// deck without sections.
pub(super) fn materials(raw: &Raw, sets: &Sets) -> Result<(Vec<u32>, Option<Materials>), DeckError> {
    let Some(sections) = sections(raw, sets)? else {
        return Ok((vec![0; raw.tets.len()], None));
    };
    let mut laws = Vec::new();
    for section in &sets.model.sections {
        let material = sets.model.material(section)?;
        let Some((_, law)) = &material.elastic else {
            let word = Word::new(&material.location, &section.material.name);
            return Err(word.cannot("the material has no *ELASTIC; put it behind *MATERIAL"));
        };
        let axes = sets.model.axes(section, law.poisson().is_some())?;
        // axes at right angles turn any law
        laws.push(axes.map_or(Ok(*law), |axes| law.rotated(axes)).map_err(|error| {
            let word = Word::new(&material.location, &section.material.name);
            word.cannot(error.to_string())
        })?);
    }
    let materials = match laws[..] {
        [law] => Some(Materials::uniform(law)),
        // the numbers 0, 1, ... do not repeat
        _ => Materials::new((0..).zip(laws).collect()).ok(),
    };
    Ok((sections, materials))
}

/// The section of each element, by position; `None` for a deck without sections.
pub(super) fn sections(raw: &Raw, sets: &Sets) -> Result<Option<Vec<u32>>, DeckError> {
    let model = sets.model;
    if model.sections.is_empty() {
        return Ok(None);
    }
    let mut of_element = vec![NONE; raw.tets.len()];
    for (index, section) in model.sections.iter().enumerate() {
        let word = &section.elset.word;
        let elements = sets.elements_of(&section.elset)?;
        if let Some(&mark) = elements.iter().find(|e| model.elements[**e as usize].kind.is_mark()) {
            return Err(word.cannot(format!(
                "element {} is a triangle or a line, which have no stiffness here; give sections to solid elements only",
                model.elements[mark as usize].label
            )));
        }
        // rigid ones need no material
        for tet in elements.into_iter().flat_map(|e| raw.tets_of(e)) {
            let before = std::mem::replace(&mut of_element[tet as usize], index as u32);
            if before != NONE {
                return Err(word.cannot(format!(
                    "element {} is in the section of {} already; an element has one section",
                    raw.element_labels[tet as usize], model.sections[before as usize].elset.word.location
                )));
            }
        }
    }
    match of_element.iter().position(|s| *s == NONE) {
        Some(tet) => {
            let word = model.elements[raw.elements[tet] as usize].word();
            Err(word.cannot("the element has no *SOLID SECTION; give one to all elements"))
        }
        None => Ok(Some(of_element)),
    }
}
