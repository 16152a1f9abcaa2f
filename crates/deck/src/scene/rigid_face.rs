//! Sides of the elements of rigid bodies, as polygons and triangles.

use signorini_fem_mesh::vec3::Vec3;

use super::numbers::Sets;
use crate::error::{DeckError, Word};
use crate::model::{Kind, Side};

/// A side of a rigid element: corners, counter-clockwise seen from outside.
#[derive(Debug)]
pub(super) struct RigidFace {
    pub(super) corners: Vec<Vec3>,
    /// The same between neighbouring nodes.
    pub(super) triangles: Vec<[Vec3; 3]>,
    pub(super) body: u32,
}

impl RigidFace {
    /// A side of an element of a body, both by position.
    pub(super) fn new(sets: &Sets, (body, element): (u32, u32), side: Side, word: &Word) -> Result<Self, DeckError> {
        let element = &sets.model.elements[element as usize];
        let nodes = sets.nodes_of(element)?;
        let p: Vec<Vec3> = nodes.iter().map(|&n| sets.model.nodes[n as usize].point).collect();
        let mut triangles = Vec::new();
        let mut corners = match (element.kind, side) {
            (Kind::Solid(shape), Side::Face(number)) => {
                let Some(face) = shape.faces().get(usize::from(number) - 1) else {
                    return Err(word.cannot(element.no_face(number)));
                };
                // faces are numbered counter-clockwise seen from inside
                let around: Vec<usize> = face.iter().rev().copied().collect();
                let mid = |i: usize| {
                    let ends = [around[i], around[(i + 1) % around.len()]];
                    let edge = shape.edges().iter().position(|e| e.iter().all(|k| ends.contains(k)));
                    p.get(shape.corners() + edge?).copied()
                };
                if let Some(mids) = (0..around.len()).map(mid).collect::<Option<Vec<Vec3>>>() {
                    let before = |i: usize| mids[(i + mids.len() - 1) % mids.len()];
                    triangles.extend((0..mids.len()).map(|i| [p[around[i]], mids[i], before(i)]));
                    triangles.extend(fan(&mids));
                }
                around.into_iter().map(|k| p[k]).collect()
            }
            (Kind::Solid(_), _) => return Err(word.expected("faces S1 to S6 of solid elements")),
            (_, Side::Face(_) | Side::Outside | Side::Nodes) => {
                return Err(word.expected("SPOS or SNEG of rigid facets"));
            }
            (Kind::Line, _) => return Err(word.expected("facets: lines have no sides")),
            (Kind::Rigid | Kind::Flat, _) => p,
        };
        if side == (Side::Facet { positive: false }) {
            corners.reverse();
        }
        if triangles.is_empty() {
            // a quadrilateral whose last corner is there twice is a triangle
            triangles.extend(fan(&corners).filter(|t| t[1] != t[2]));
        }
        Ok(RigidFace {
            corners,
            triangles,
            body,
        })
    }
}

/// Triangles between the first of some points and each two neighbours.
fn fan(around: &[Vec3]) -> impl Iterator<Item = [Vec3; 3]> {
    (1..around.len() - 1).map(|i| [around[0], around[i], around[i + 1]])
}
