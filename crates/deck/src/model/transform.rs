//! `*TRANSFORM`: axes of nodes, along which supports and forces at nodes are.

use signorini_fem_mesh::vec3::{Vec3, cross, norm, sub, unit};

use super::Model;
use crate::error::{DeckError, Word};
use crate::lexer::{Card, Named};
use crate::tolerances::ROUNDING;

/// Axes of the nodes of a set.
#[derive(Debug, Clone)]
pub(crate) struct Transform {
    pub(crate) nset: Named,
    pub(crate) axes: Axes,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Axes {
    /// A point on the first axis and one in the plane of the first two.
    Rectangular([[f64; 3]; 2]),
    /// Two points of the axis.
    Cylindrical([[f64; 3]; 2]),
}

/// The two points of a line of axes.
pub(super) fn two_points(line: &Word, wanted: &'static str) -> Result<[Vec3; 2], DeckError> {
    let fields = line.at_most(6, wanted)?;
    Ok([line.reals(&fields, 0, wanted)?, line.reals(&fields, 3, wanted)?])
}

/// Whether the points of rectangular axes and the origin are in line, as far as digits tell.
pub(super) fn in_line([a, b]: [Vec3; 2]) -> bool {
    let size = norm(a) * norm(b);
    norm(cross(a, b)) <= ROUNDING * size || !size.is_finite()
}

/// Unit vectors along axes: the first goes through the first point, the second one lies in the plane of both.
pub(crate) fn rectangular([a, b]: [Vec3; 2]) -> [Vec3; 3] {
    let (first, third) = (unit(a), unit(cross(a, b)));
    [first, cross(third, first), third]
}

/// `*TRANSFORM`.
pub(super) fn transform(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["NSET", "TYPE"])?;
    let cylindrical = card.choice("TYPE", &["R", "C"], "TYPE=R or TYPE=C")? == Some(1);
    let wanted = "two points: on the first axis and in the plane of the first two, or with TYPE=C both on the axis";
    let line = card.only_line(wanted)?;
    let points = two_points(line, wanted)?;
    let [a, b] = points;
    let (long, size) = (norm(sub(b, a)), norm(a) + norm(b));
    let none = if cylindrical { long <= ROUNDING * size || !long.is_finite() } else { in_line(points) };
    if none {
        return Err(line.cannot(
            "these points give no axes; with TYPE=C they must differ, else they and the origin must not be in line",
        ));
    }
    model.transforms.push(Transform {
        nset: card.need("NSET")?,
        axes: if cylindrical { Axes::Cylindrical(points) } else { Axes::Rectangular(points) },
    });
    Ok(())
}
