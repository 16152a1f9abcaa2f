//! Contact points that have rows.

use crate::discrete::ContactPoint;
use crate::scene::Scene;
use signorini_fem_mesh::SurfaceFrame;
use signorini_tfeti as tfeti;
use signorini_tfeti::{Gluing, TangentialRows};

/// A node that can touch an obstacle or a node of another body. A node in an edge or a corner is several, with other normals.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ConstrainedPoint {
    /// Mesh node.
    pub node: u32,
    /// Its partner on another body; `None` for a rigid obstacle.
    pub partner: Option<u32>,
    /// Position of its contact surface in [`Scene::contacts`].
    pub surface: usize,
    /// Its position, m.
    pub position: [f64; 3],
    /// Normal into the obstacle and two tangents.
    pub frame: SurfaceFrame,
    /// A third of the areas of the adjacent facets, m².
    pub area: f64,
    /// Initial distance to the obstacle, m.
    pub gap: f64,
    /// Place among all points of the scene.
    pub(crate) place: usize,
    /// Normal row.
    pub(crate) row: usize,
    /// Row value over normal displacement, and nodal force over multiplier.
    pub(crate) scale: f64,
    pub(crate) tangential: Tangential,
}

impl ConstrainedPoint {
    /// Directions of all rows of the point, with row and scale: the normal, then the tangential ones.
    pub(crate) fn directions(&self) -> impl Iterator<Item = ([f64; 3], usize, f64)> + use<> {
        std::iter::once((self.frame.normal, self.row, self.scale)).chain(self.along())
    }

    /// Directions of the tangential rows, with row and scale.
    pub(crate) fn along(&self) -> impl Iterator<Item = ([f64; 3], usize, f64)> + use<> {
        let [a, b] = self.frame.tangents;
        let list = match self.tangential {
            Tangential::None => [None, None],
            Tangential::Line {
                row,
                direction,
                scale,
            } => [Some((direction, row, scale)), None],
            Tangential::Plane { row, scale } => [Some((a, row, scale)), Some((b, row + 1, scale))],
        };
        list.into_iter().flatten()
    }
}

/// Tangential rows of a point, as positions among all tangential rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Tangential {
    None,
    /// One row along a direction.
    Line {
        row: usize,
        direction: [f64; 3],
        scale: f64,
    },
    /// Rows `row` and `row + 1` along the tangents of the frame.
    Plane {
        row: usize,
        scale: f64,
    },
}

impl Tangential {
    /// First row, number of rows, scale.
    pub(crate) fn rows(&self) -> Option<(usize, usize, f64)> {
        match *self {
            Self::None => None,
            Self::Line { row, scale, .. } => Some((row, 1, scale)),
            Self::Plane { row, scale } => Some((row, 2, scale)),
        }
    }
}

/// The points that have rows.
pub(crate) fn constrained_points(
    scene: &Scene,
    candidates: &[ContactPoint],
    gluing: &Gluing,
) -> Vec<ConstrainedPoint> {
    let point = |info: &tfeti::ContactRows| {
        let place = info.point;
        let candidate = &candidates[place];
        let tangential = match info.tangential {
            TangentialRows::Disc { row, scale } => Tangential::Plane { row, scale },
            TangentialRows::Interval {
                row,
                direction,
                scale,
            } => Tangential::Line {
                row,
                direction,
                scale,
            },
            _ => Tangential::None,
        };
        ConstrainedPoint {
            node: info.node,
            partner: candidate.partner,
            surface: candidate.surface,
            position: scene.mesh.points()[info.node as usize],
            frame: info.frame,
            area: candidate.area,
            gap: candidate.gap,
            place,
            row: info.row,
            scale: info.scale,
            tangential,
        }
    };
    gluing.contact().iter().map(point).collect()
}
