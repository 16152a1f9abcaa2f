//! Contact constraints and their sides.

use crate::error::TfetiError;
use crate::rows::supports::check_node;
use crate::tolerances::{HELD, HELD_MEANS, SAME, UNIT};
use nalgebra::Matrix3;
use signorini_fem_mesh::SurfaceFrame;
use signorini_fem_mesh::vec3::{add, combine, dot, scale, skewed};
use std::collections::HashMap;

/// One side of a contact constraint: nodes with weights that sum to one. It moves by the weighted mean of their
/// displacements.
///
/// A side of node-to-node contact is the list of length one. Weights may be negative, as those of dual shape functions
/// and of quadratic facets are.
#[derive(Debug, Clone, PartialEq)]
pub struct Side {
    nodes: Vec<(u32, f64)>,
    turn: Vec<[[f64; 3]; 3]>,
}

impl Side {
    /// A single node.
    pub fn node(node: u32) -> Self {
        Self::new(vec![(node, 1.0)])
    }

    /// Mesh nodes with their weights; they are checked where rows are made of them.
    pub fn new(nodes: Vec<(u32, f64)>) -> Self {
        let turn = Vec::new();
        Self { nodes, turn }
    }

    /// Beside the mean it moves by the sum of these matrices, one a node, row by row, times their displacements: by its
    /// rotation over the way to where it meets the other side.
    #[must_use]
    pub fn with_turn(mut self, turn: Vec<[[f64; 3]; 3]>) -> Self {
        self.turn = turn;
        self
    }

    /// The part of its weights from which on what holds their nodes holds it.
    #[doc(hidden)]
    #[must_use]
    pub fn held_from(&self) -> f64 {
        if self.nodes.len() > 1 { HELD_MEANS } else { HELD }
    }

    /// The nodes and their weights.
    pub fn nodes(&self) -> &[(u32, f64)] {
        &self.nodes
    }

    /// The matrices of [`with_turn`](Self::with_turn); none where there is no way.
    pub fn turn(&self) -> &[[[f64; 3]; 3]] {
        &self.turn
    }

    /// The first node, which names the side.
    pub(crate) fn first(&self) -> u32 {
        self.nodes.first().map_or(0, |n| n.0)
    }

    fn check(&self, point: usize, nodes: usize) -> Result<(), TfetiError> {
        let refuse = |what| Err(TfetiError::BadSide { point, what });
        for (k, &(node, weight)) in self.nodes.iter().enumerate() {
            check_node(node, nodes, || format!("contact point {point}"))?;
            if !weight.is_finite() || weight == 0.0 {
                return refuse("a weight is zero or not finite");
            }
            if self.nodes[..k].iter().any(|other| other.0 == node) {
                return refuse("a node stands twice in it");
            }
        }
        if !self.turn.is_empty() && self.turn.len() != self.nodes.len() {
            return refuse("there is not one matrix a node");
        }
        if self.turn.as_flattened().as_flattened().iter().any(|t| !t.is_finite()) {
            return refuse("a matrix is not finite");
        }
        if (self.nodes.iter().map(|n| n.1).sum::<f64>() - 1.0).abs() > UNIT {
            return refuse("the weights do not sum to one");
        }
        Ok(())
    }
}

impl From<u32> for Side {
    fn from(node: u32) -> Self {
        Self::node(node)
    }
}

/// A side that may touch a rigid obstacle, or a side of another body.
///
/// A node in an edge or a corner has several, with other normals or partners; rows of such a node may depend on one
/// another.
///
/// Where supports hold a node and a quarter of its partner's mean in a direction along the surface, as on a plane of
/// symmetry, that direction has no row, tied or not: couplings that are meant otherwise want supports elsewhere.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactConstraint {
    /// Nodes on the body whose outward normal is given.
    pub side: Side,
    /// Nodes of the other body; `None` for a rigid obstacle. Rows act on the displacement of the side minus this one.
    pub partner: Option<Side>,
    /// Outward normal and two tangents, orthonormal.
    pub frame: SurfaceFrame,
    /// Whether there is friction. Without it there are no tangential rows.
    pub friction: bool,
    /// Whether the obstacle moves along the surface. Directions that supports fix then keep their tangential rows.
    pub moving: bool,
    /// Whether both sides move alike, in all directions that supports leave free, in place of contact and friction.
    pub tied: bool,
    /// Of a tied one: a [subdomain of places](signorini_fem_mesh::decomposition::Rigid::Places) with the nodes of the
    /// side, whose motion, times this factor, the side has beside that of the partner.
    pub relative: Option<(u32, f64)>,
    /// How far the point gives way along the normal and along the surface under a force, m/N: finite, 0 for not at all.
    pub compliance: [f64; 2],
    /// Factor of the second tangential row beside the first, finite and positive, 1 for isotropic friction. An ellipse
    /// with this ratio of its axes, along the tangents, is a disc in the rows.
    pub stretch: f64,
}

impl ContactConstraint {
    /// A node, or a side of several, that may touch a rigid obstacle that does not move, without friction. What else
    /// there is to say is said by its fields.
    pub fn new(side: impl Into<Side>, frame: SurfaceFrame) -> Self {
        let (side, partner) = (side.into(), None);
        Self {
            side,
            partner,
            frame,
            friction: false,
            moving: false,
            tied: false,
            relative: None,
            compliance: [0.0; 2],
            stretch: 1.0,
        }
    }

    /// Against a node or a side of another body; `None` for a rigid obstacle.
    #[must_use]
    pub fn with_partner(mut self, partner: Option<impl Into<Side>>) -> Self {
        self.partner = partner.map(Into::into);
        self
    }

    /// With friction or without.
    #[must_use]
    pub fn with_friction(mut self, friction: bool) -> Self {
        self.friction = friction;
        self
    }

    /// All nodes with their weights, those of the partner with the sign reversed.
    pub(crate) fn nodes(&self) -> impl Iterator<Item = (u32, f64)> {
        let partner = self.partner.iter().flat_map(Side::nodes);
        self.side
            .nodes()
            .iter()
            .copied()
            .chain(partner.map(|&(node, weight)| (node, -weight)))
    }

    /// What a direction is of the displacements of the nodes of the first side.
    pub(crate) fn on_side(&self, direction: [f64; 3]) -> impl Iterator<Item = (u32, [f64; 3])> {
        self.side.nodes().iter().enumerate().map(move |(k, &(node, weight))| {
            let turned = self
                .side
                .turn()
                .get(k)
                .map_or([0.0; 3], |turn| combine(turn, direction));
            (node, add(scale(weight, direction), turned))
        })
    }

    /// What sides add by turning, node by node as [`nodes`](Self::nodes); nothing where none does.
    pub(crate) fn turns(&self) -> Vec<Matrix3<f64>> {
        let sides = || std::iter::once((&self.side, 1.0)).chain(self.partner.iter().map(|p| (p, -1.0)));
        if sides().all(|(side, _)| side.turn.is_empty()) {
            return Vec::new();
        }
        let of = |(side, sign): (&Side, f64)| -> Vec<Matrix3<f64>> {
            let turn = |k| side.turn.get(k).copied().unwrap_or_default();
            let turns = (0..side.nodes.len()).map(turn);
            turns.map(|t| Matrix3::from(t).transpose() * sign).collect()
        };
        sides().flat_map(of).collect()
    }

    /// Whether it is of a single node and a rigid obstacle.
    pub(crate) fn is_single(&self) -> bool {
        self.partner.is_none() && self.side.nodes().len() == 1
    }

    /// Whether it has more nodes than a pair of nodes.
    pub(crate) fn is_long(&self) -> bool {
        self.nodes().count() > 2
    }

    /// Whether it says the same as another one, seen from either side.
    fn is_same(&self, other: &Self) -> bool {
        let cosine = dot(self.frame.normal, other.frame.normal);
        let seen = self.side == other.side && self.partner == other.partner;
        let reversed = self.partner.as_ref() == Some(&other.side) && other.partner.as_ref() == Some(&self.side);
        seen && cosine > 1.0 - SAME || reversed && -cosine > 1.0 - SAME
    }

    fn check(&self, point: usize, nodes: usize) -> Result<(), TfetiError> {
        for side in std::iter::once(&self.side).chain(&self.partner) {
            side.check(point, nodes)?;
        }
        let (node, stretch) = (self.side.first(), self.stretch);
        if !(stretch.is_finite() && stretch > 0.0) {
            return Err(TfetiError::BadStretch { point, node, stretch });
        }
        if let Some(&compliance) = self.compliance.iter().find(|c| !(c.is_finite() && **c >= 0.0)) {
            return Err(TfetiError::BadCompliance {
                point,
                node,
                compliance,
            });
        }
        let [t1, t2] = self.frame.tangents;
        match skewed([self.frame.normal, t1, t2], UNIT) {
            Some(_) => Err(TfetiError::BadFrame { point, node }),
            None => Ok(()),
        }
    }
}

/// Checks contact constraints against a mesh with so many nodes, and that none is said twice.
pub(super) fn check_constraints(points: &[ContactConstraint], nodes: usize) -> Result<(), TfetiError> {
    let mut of_smallest: HashMap<u32, Vec<&ContactConstraint>> = HashMap::new();
    for (index, point) in points.iter().enumerate() {
        point.check(index, nodes)?;
        let twice = TfetiError::ContactNodeTwice {
            node: point.side.first(),
        };
        let other = point.partner.as_ref().map_or(&[][..], Side::nodes);
        let (mut own, all) = (point.side.nodes().iter(), point.nodes().map(|n| n.0));
        if own.any(|n| other.iter().any(|o| o.0 == n.0)) {
            return Err(twice);
        }
        let earlier = of_smallest.entry(all.min().unwrap_or(0)).or_default();
        if earlier.iter().any(|other| other.is_same(point)) {
            return Err(twice);
        }
        earlier.push(point);
    }
    Ok(())
}
