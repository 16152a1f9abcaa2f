//! `*ORIENTATION`: axes of materials.

use signorini_fem_mesh::vec3::{Vec3, add, scale};

use super::transform::{in_line, rectangular, two_points};
use super::{MaterialAxes, Model, Section};
use crate::error::{DeckError, Word};
use crate::lexer::Card;

/// Axes that sections can have.
#[derive(Debug, Clone)]
pub(crate) struct Orientation {
    word: Word,
    /// Unit vectors; none of cylindrical ones, which differ from place to place.
    axes: Option<[Vec3; 3]>,
}

/// `*ORIENTATION`.
pub(super) fn orientation(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["NAME", "SYSTEM", "DEFINITION"])?;
    let definition = "DEFINITION=COORDINATES; others are not supported";
    card.choice("DEFINITION", &["COORDINATES"], definition)?;
    let systems = ["RECTANGULAR", "CYLINDRICAL"];
    let cylindrical = card.choice("SYSTEM", &systems, "SYSTEM=RECTANGULAR or SYSTEM=CYLINDRICAL")? == Some(1);
    let wanted = "a line with two points, on the first axis and in the plane of the first two, and at most one with the \
        number of an axis and an angle in degrees by which all turn about it";
    card.lines_at_most(2, wanted)?;
    let line = card.lines.first().ok_or_else(|| card.word.expected(wanted))?;
    let points = two_points(line, wanted)?;
    if in_line(points) && !cylindrical {
        return Err(line.cannot("these points give no axes; they and the origin must not be in line"));
    }
    let mut axes = rectangular(points);
    if let Some(line) = card.lines.get(1) {
        let fields = line.at_most(2, wanted)?;
        let axis = line.label(&fields, 0, wanted)?;
        let angle = line.optional(&fields, 1, wanted)?.unwrap_or(0.0).to_radians();
        let Some(kept) = (1..=3).contains(&axis).then(|| axis as usize - 1) else {
            return Err(line.part(fields[0]).expected("an axis: 1, 2 or 3"));
        };
        let [first, second] = [1, 2].map(|k| (kept + k) % 3);
        let (sine, cosine) = angle.sin_cos();
        let (u, v) = (axes[first], axes[second]);
        axes[first] = add(scale(cosine, u), scale(sine, v));
        axes[second] = add(scale(cosine, v), scale(-sine, u));
    }
    let name = card.need("NAME")?.name;
    if model.orientations.position(&name).is_some() {
        return Err(card
            .word
            .cannot("an orientation of this name is there already; keep one of them"));
    }
    let word = card.word.clone();
    let axes = (!cylindrical).then_some(axes);
    model.orientations.add(name, Orientation { word, axes });
    Ok(())
}

impl Model {
    /// The axes of the material of a section; none along x, y, z, and where it is isotropic.
    pub(crate) fn axes(&self, section: &Section, isotropic: bool) -> Result<Option<[Vec3; 3]>, DeckError> {
        let named = match &section.axes {
            MaterialAxes::Global => return Ok(None),
            MaterialAxes::Named(named) => named,
            MaterialAxes::Turned(_) if isotropic => return Ok(None),
            MaterialAxes::Turned(word) => {
                let why = "the instance turns, and with it the axes of a material that is not isotropic; give its section \
                    behind the assembly, of a set there, with *ORIENTATION";
                return Err(word.cannot(why));
            }
        };
        let Orientation { word, axes } =
            self.orientations
                .at(self.orientations.find("orientation", &named.name, &named.word)?);
        let why = "axes that differ from place to place are read of isotropic materials only, where they mean nothing; \
            give SYSTEM=RECTANGULAR, and parts of the body sections of their own";
        match axes {
            _ if isotropic => Ok(None),
            Some(axes) => Ok(Some(*axes)),
            None => Err(word.cannot(why)),
        }
    }
}
