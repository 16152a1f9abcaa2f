//! `*TRANSFORM`: axes of nodes, along which supports and forces at nodes are.

use signorini_fem_mesh::vec3::{cross, norm, sub};

use super::Model;
use crate::error::DeckError;
use crate::lexer::{Card, Named};

/// Axes of the nodes of a set.
#[derive(Debug, Clone)]
pub(crate) struct Transform {
    pub(crate) nset: Named,
    pub(crate) axes: Axes,
}

#[derive(Debug, Clone, Copy)]
pub(crate) enum Axes {
    /// A point on the first axis and one in the plane of the first two.
    Rectangular([[f64; 3]; 2]),
    /// Two points of the axis.
    Cylindrical([[f64; 3]; 2]),
}

/// `*TRANSFORM`.
pub(super) fn transform(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["NSET", "TYPE"])?;
    let cylindrical = card.choice("TYPE", &["R", "C"], "TYPE=R or TYPE=C")? == Some(1);
    let wanted = "two points: on the first axis and in the plane of the first two, or with TYPE=C both on the axis";
    let line = card.only_line(wanted)?;
    let fields = line.at_most(6, wanted)?;
    let mut points = [[0.0; 3]; 2];
    for (at, value) in points.as_flattened_mut().iter_mut().enumerate() {
        *value = line.real(&fields, at, wanted)?;
    }
    let [a, b] = points;
    let size = if cylindrical {
        norm(sub(b, a))
    } else {
        norm(cross(a, b))
    };
    if !(size > 0.0 && size.is_finite()) {
        return Err(line.cannot(
            "these points give no axes; with TYPE=C they must differ, else they and the origin must not be in line",
        ));
    }
    model.transforms.push(Transform {
        nset: card.need("NSET")?,
        axes: match cylindrical {
            true => Axes::Cylindrical(points),
            false => Axes::Rectangular(points),
        },
    });
    Ok(())
}
