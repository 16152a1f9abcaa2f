//! Contact points that have rows.

use crate::discrete::ContactPoint;
use signorini_fem_mesh::SurfaceFrame;
use signorini_tfeti::{ContactRows, Gluing, TangentialRows};

/// What one of its rows measures of a contact point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PointRow {
    pub(crate) direction: [f64; 3],
    pub(crate) row: usize,
    /// Row value over displacement along the direction, and force over multiplier.
    pub(crate) scale: f64,
}

/// A node that can touch an obstacle or a node of another body. A node in an edge or a corner is several, with other
/// normals.
#[derive(Debug, Clone, PartialEq)]
pub struct ConstrainedPoint {
    /// What the scene says of it.
    pub(crate) contact: ContactPoint,
    /// Normal row.
    pub(crate) row: usize,
    /// Row value over normal displacement, and nodal force over multiplier.
    pub(crate) scale: f64,
    /// The scale of tangential rows is that of the disc or interval.
    pub(crate) tangential: TangentialRows,
    /// Factor of each tangential row beside that scale: the axes of an ellipse of friction. One where friction is the
    /// same in all directions.
    pub(crate) stretch: [f64; 2],
}

impl ConstrainedPoint {
    /// Mesh node.
    pub fn node(&self) -> u32 {
        self.contact.node()
    }

    /// Its partner on another body, of several nodes the one with the largest weight; `None` for a rigid obstacle.
    pub fn partner(&self) -> Option<u32> {
        self.contact.sides.partner()
    }

    /// Mesh nodes with weights: the displacement relative to the obstacle or the partner is their weighted sum, and a
    /// force on the point acts on each of them with its weight. Those of the partner are last, with negative weights
    /// (but for dual shape functions, of either sign) that sum to minus one. Where the sides touch and their places are
    /// apart, as facets of curved sides are, [`forces`](Self::forces) add a couple on the partner, and its rotation
    /// counts.
    pub fn nodes(&self) -> impl Iterator<Item = (u32, f64)> {
        self.contact.sides.nodes()
    }

    /// Forces at mesh nodes that a force on the point is: without resultant and moment where it has a partner and its
    /// gap is closed. Their work on displacements of the nodes is that of the force on the relative displacement.
    pub fn forces(&self, force: [f64; 3]) -> impl Iterator<Item = (u32, [f64; 3])> {
        self.contact.sides.forces(force)
    }

    /// Position of its contact surface in [`Scene::contacts`](crate::Scene::contacts).
    pub fn surface(&self) -> usize {
        self.contact.surface
    }

    /// Its place, m.
    pub fn position(&self) -> [f64; 3] {
        self.contact.position
    }

    /// Normal into the obstacle and two tangents.
    pub fn frame(&self) -> &SurfaceFrame {
        &self.contact.frame
    }

    /// Its part of the [areas](signorini_fem_mesh::Surface::areas) of the facets of its side, m².
    pub fn area(&self) -> f64 {
        self.contact.area
    }

    /// Initial distance to the obstacle or the partner, m.
    pub fn gap(&self) -> f64 {
        self.contact.gap
    }

    /// All rows of the point: the normal one, then the tangential ones.
    pub(crate) fn rows(&self) -> impl Iterator<Item = PointRow> + use<> {
        std::iter::once(self.normal()).chain(self.along())
    }

    fn normal(&self) -> PointRow {
        PointRow {
            direction: self.contact.frame.normal,
            row: self.row,
            scale: self.scale,
        }
    }

    /// The tangential rows.
    pub(crate) fn along(&self) -> impl Iterator<Item = PointRow> + use<> {
        self.on_disc().map(|(own, factor)| PointRow {
            scale: own.scale * factor,
            ..own
        })
    }

    /// All rows, the tangential ones in lengths in which friction is the same in all directions: with vectors that
    /// need not have length one, and the scale of the disc.
    pub(crate) fn isotropic(&self) -> impl Iterator<Item = PointRow> + use<> {
        let along = self.on_disc().map(|(own, factor)| PointRow {
            direction: own.direction.map(|c| c * factor),
            ..own
        });
        std::iter::once(self.normal()).chain(along)
    }

    /// The tangential rows with the scale of the disc, and the factor of each beside it.
    fn on_disc(&self) -> impl Iterator<Item = (PointRow, f64)> + use<> {
        let ([a, b], [p, q]) = (self.contact.frame.tangents, self.stretch);
        let own = |direction, row, scale| PointRow { direction, row, scale };
        let list = match self.tangential {
            TangentialRows::Disc { row, scale } => [Some((own(a, row, scale), p)), Some((own(b, row + 1, scale), q))],
            TangentialRows::Interval { row, direction, scale } => [Some((own(direction, row, scale), p)), None],
            _ => [None, None],
        };
        list.into_iter().flatten()
    }

    /// First tangential row, number of rows, scale of the disc.
    pub(crate) fn tangential_rows(&self) -> Option<(usize, usize, f64)> {
        match self.tangential {
            TangentialRows::Disc { row, scale } => Some((row, 2, scale)),
            TangentialRows::Interval { row, scale, .. } => Some((row, 1, scale)),
            _ => None,
        }
    }
}

/// The points that have rows.
pub(super) fn constrained_points(points: &[ContactPoint], gluing: &Gluing) -> Vec<ConstrainedPoint> {
    let point = |rows: &ContactRows| {
        let contact = points[rows.point].clone();
        let (mut tangential, mut stretch) = (rows.tangential, [1.0, contact.stretch]);
        // of an ellipse its extent in the only direction of slip
        if let TangentialRows::Interval { direction, scale, .. } = &mut tangential {
            let [a, b] = contact.frame.tangential_part(*direction);
            if contact.stretch != 1.0 {
                stretch[0] = a.hypot(contact.stretch * b);
                *scale /= stretch[0];
            }
        }
        ConstrainedPoint {
            contact,
            row: rows.row,
            scale: rows.scale,
            tangential,
            stretch,
        }
    };
    gluing.contact().iter().map(point).collect()
}
