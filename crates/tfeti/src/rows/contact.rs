//! Contact points and the directions in which they can still move once supports are taken into account.

use crate::error::TfetiError;
use crate::rows::kinds::{RemovalReason, RemovedRow, RowKind};
use crate::rows::supports::{FixedNode, MergedSupports, NodeSupport, dot};
use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use signorini_fem_mesh::SurfaceFrame;

/// A node that may touch a rigid obstacle, or a node of another body.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ContactConstraint {
    /// Mesh node on the body whose outward normal is given.
    pub node: u32,
    /// Node of the other body; `None` for a rigid obstacle. Rows act on `u_node - u_opponent`.
    pub partner: Option<u32>,
    /// Outward normal and two tangents, orthonormal.
    pub frame: SurfaceFrame,
    /// Whether there is friction. Without it there are no tangential rows.
    pub friction: bool,
    /// Whether the obstacle moves along the surface. Directions that supports fix then keep their tangential rows.
    pub moving: bool,
}

impl ContactConstraint {
    /// A node that may touch a rigid obstacle that does not move, without friction.
    #[must_use]
    pub fn new(node: u32, frame: SurfaceFrame) -> Self {
        Self {
            node,
            partner: None,
            frame,
            friction: false,
            moving: false,
        }
    }

    /// Against a node of another body; `None` for a rigid obstacle.
    #[must_use]
    pub fn with_partner(mut self, partner: Option<u32>) -> Self {
        self.partner = partner;
        self
    }

    /// With friction or without.
    #[must_use]
    pub fn with_friction(mut self, friction: bool) -> Self {
        self.friction = friction;
        self
    }

    /// Whether the obstacle moves along the surface.
    #[must_use]
    pub fn with_moving_obstacle(mut self, moving: bool) -> Self {
        self.moving = moving;
        self
    }
}

/// The contact points of a system.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct ContactConstraints {
    /// The points. A node in an edge or a corner appears several times, with other normals or partners; rows of such a node
    /// may depend on one another.
    pub points: Vec<ContactConstraint>,
}

impl ContactConstraints {
    /// Points against a rigid obstacle, one frame per node.
    #[must_use]
    pub fn rigid(nodes: &[u32], frames: &[SurfaceFrame], friction: bool) -> Self {
        let point = |(&node, frame): (&u32, &SurfaceFrame)| {
            ContactConstraint::new(node, *frame).with_friction(friction)
        };
        nodes.iter().zip(frames).map(point).collect()
    }
}

impl FromIterator<ContactConstraint> for ContactConstraints {
    fn from_iter<I: IntoIterator<Item = ContactConstraint>>(points: I) -> Self {
        Self {
            points: points.into_iter().collect(),
        }
    }
}

/// A contact point whose normal displacement is fixed by supports, so that it has no normal row.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct PrescribedPoint {
    /// Position in the list of contact points.
    pub point: usize,
    /// Mesh node.
    pub node: u32,
    /// `(case, relative normal displacement in metres)`: what supports prescribe for a factor of one, cases ascending.
    pub normal: Vec<(u32, f64)>,
}

/// The contact points whose normal displacement supports fix, in the order of the points.
///
/// No contact force acts on them. Whether they stay outside the obstacle is to be judged by whoever knows the gap: the
/// normal displacement at a time is the sum over cases of `factor(case, t) * value`.
///
/// # Errors
/// [`TfetiError`] as for [`Gluing::new`](crate::Gluing::new): wrong supports, unknown nodes, wrong frames.
pub fn prescribed_points(
    contact: &ContactConstraints,
    supports: &[NodeSupport],
    nodes: usize,
) -> Result<Vec<PrescribedPoint>, TfetiError> {
    let merged = MergedSupports::new(supports, nodes)?;
    let all = contact_rows(contact, &merged, nodes, |_| 1.0)?;
    Ok(all.held)
}

/// One contact row: what it does to the mean displacements of the node and its partner.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ContactRow {
    /// Coefficients on the displacement of the node (to be spread over its copies).
    pub(crate) node: [f64; 3],
    /// Coefficients on the displacement of the partner, sign included.
    pub(crate) partner: [f64; 3],
    /// The physical direction: the row stands for `scale * direction . (u_node - u_opponent)`.
    pub(crate) direction: [f64; 3],
    pub(crate) scale: f64,
}

/// The rows of one contact point.
#[derive(Debug, Clone)]
pub(crate) struct PointRows {
    /// Position in the list of points.
    pub(crate) point: usize,
    pub(crate) normal: ContactRow,
    pub(crate) tangential: Vec<ContactRow>,
    /// Whether the rows keep directions that supports fix.
    pub(crate) dragged: bool,
    /// `(case, relative displacement prescribed by supports)`.
    pub(crate) prescribed: Vec<(u32, [f64; 3])>,
}

/// Rows of all points, what was left out, and the points without normal row.
#[derive(Debug, Default)]
pub(crate) struct ContactRows {
    pub(crate) rows: Vec<PointRows>,
    pub(crate) removed: Vec<RemovedRow>,
    pub(crate) held: Vec<PrescribedPoint>,
}

/// Cosine of the angle between two normals of a node from which on they count as one.
const SAME_NORMAL: f64 = 1.0 - 1e-12;

/// Cosine to the normal below which a direction counts as tangential.
const OBLIQUE: f64 = 1e-6;

/// Below this share of a direction that can move, the direction counts as fixed.
const FIXED: f64 = 1e-8;

/// Rows of all points. `squares(node)` is the sum of the squared
/// shares of the copies of a node in their mean: one over their number where all count alike.
pub(crate) fn contact_rows(
    contact: &ContactConstraints,
    supports: &MergedSupports,
    nodes: usize,
    squares: impl Fn(u32) -> f64,
) -> Result<ContactRows, TfetiError> {
    let mut uses = Uses::new(nodes, contact.points.len());
    let mut out = ContactRows {
        rows: Vec::with_capacity(contact.points.len()),
        ..ContactRows::default()
    };
    for (index, point) in contact.points.iter().enumerate() {
        uses.add(index, contact)?;
        check_frame(index, point)?;
        // Unit row on the means of k copies: weights c/sqrt(k) with c = (1/k_a + 1/k_b)^(-1/2).
        let a = squares(point.node);
        let b = point.partner.map_or(0.0, &squares);
        let scale = (a + b).sqrt().recip();
        let (alpha, beta) = (scale * a.sqrt(), scale * b.sqrt());
        let space = Space::new(
            supports.at(point.node),
            point.partner.and_then(|n| supports.at(n)),
            alpha,
            beta,
        );
        reduce(index, point, point.friction, &space, scale, &mut out);
    }
    Ok(out)
}

/// The contact points of each node, or of each pair under its smaller node.
struct Uses {
    /// Last point of a node, plus one; 0 for none.
    last: Vec<u32>,
    /// The point of the same node before a point, plus one; 0 for none.
    before: Vec<u32>,
}

impl Uses {
    fn new(nodes: usize, points: usize) -> Self {
        Self {
            last: vec![0; nodes],
            before: vec![0; points],
        }
    }

    /// Takes a point in: its node may have others, but none with the same partner (or a rigid obstacle) along the same
    /// normal.
    fn add(&mut self, index: usize, contact: &ContactConstraints) -> Result<(), TfetiError> {
        let point = &contact.points[index];
        let nodes = self.last.len();
        for node in std::iter::once(point.node).chain(point.partner) {
            if node as usize >= nodes {
                return Err(TfetiError::UnknownNode {
                    place: format!("contact point {index}"),
                    node,
                    nodes,
                });
            }
        }
        let twice = TfetiError::ContactNodeTwice { node: point.node };
        if point.partner == Some(point.node) {
            return Err(twice);
        }
        let last = &mut self.last[first(point) as usize];
        let mut earlier = *last as usize;
        while earlier > 0 {
            let other = &contact.points[earlier - 1];
            let cosine = dot(&other.frame.normal, &point.frame.normal);
            let same = match point.partner {
                None => other.partner.is_none() && cosine > SAME_NORMAL,
                Some(partner) if other.node == point.node => {
                    other.partner == Some(partner) && cosine > SAME_NORMAL
                }
                Some(partner) => {
                    (other.node, other.partner) == (partner, Some(point.node))
                        && -cosine > SAME_NORMAL
                }
            };
            if same {
                return Err(twice);
            }
            earlier = self.before[earlier - 1] as usize;
        }
        self.before[index] = *last;
        *last = index as u32 + 1;
        Ok(())
    }
}

/// The node under which a point is listed.
fn first(point: &ContactConstraint) -> u32 {
    point.partner.map_or(point.node, |o| o.min(point.node))
}

fn check_frame(index: usize, point: &ContactConstraint) -> Result<(), TfetiError> {
    let [t1, t2] = &point.frame.tangents;
    let axes = [&point.frame.normal, t1, t2];
    for i in 0..3 {
        for j in i..3 {
            let expected = if i == j { 1.0 } else { 0.0 };
            let error = (dot(axes[i], axes[j]) - expected).abs();
            if error.is_nan() || error > 1e-10 {
                return Err(TfetiError::BadFrame {
                    point: index,
                    node: point.node,
                });
            }
        }
    }
    Ok(())
}

/// Free part of the relative displacement of a point.
struct Space {
    alpha: f64,
    beta: f64,
    free_node: Matrix3<f64>,
    free_opponent: Matrix3<f64>,
    /// Gram matrix of the rows `direction -> (alpha P_a direction, -beta P_b direction)`.
    gram: Matrix3<f64>,
    prescribed: Vec<(u32, [f64; 3])>,
}

impl Space {
    fn new(node: Option<&FixedNode>, partner: Option<&FixedNode>, alpha: f64, beta: f64) -> Self {
        let free = |fixed: Option<&FixedNode>| {
            let mut matrix = Matrix3::identity();
            for direction in fixed.iter().flat_map(|f| &f.directions) {
                let d = Vector3::from(direction.direction);
                matrix -= d * d.transpose();
            }
            matrix
        };
        let (free_node, free_opponent) = (free(node), free(partner));
        let mut prescribed = node.map(FixedNode::prescribed).unwrap_or_default();
        for (case, value) in partner.map(FixedNode::prescribed).unwrap_or_default() {
            match prescribed.iter_mut().find(|v| v.0 == case) {
                Some(v) => (0..3).for_each(|c| v.1[c] -= value[c]),
                None => prescribed.push((case, value.map(|v| -v))),
            }
        }
        prescribed.sort_by_key(|v| v.0);
        let gram = free_node * (alpha * alpha) + free_opponent * (beta * beta);
        Self {
            alpha,
            beta,
            free_node,
            free_opponent,
            gram,
            prescribed,
        }
    }

    fn row(&self, direction: Vector3<f64>, scale: f64, factor: f64) -> ContactRow {
        let node = self.free_node * direction * (self.alpha * factor);
        let partner = self.free_opponent * direction * (-self.beta * factor);
        ContactRow {
            node: node.into(),
            partner: partner.into(),
            direction: direction.into(),
            scale: scale * factor,
        }
    }

    /// The row of a direction that does not leave out what supports fix.
    fn full_row(&self, direction: Vector3<f64>, scale: f64) -> ContactRow {
        ContactRow {
            node: (direction * self.alpha).into(),
            partner: (direction * -self.beta).into(),
            direction: direction.into(),
            scale,
        }
    }

    /// Whether supports move the point along the surface, or fix a direction that is neither normal nor tangential, so that
    /// friction works where they act.
    fn is_dragged(&self, normal: &Vector3<f64>, fixed: &[Vector3<f64>]) -> bool {
        let moved = self.prescribed.iter().any(|(_, value)| {
            let value = Vector3::from(*value);
            let length = value.norm();
            (value - normal * value.dot(normal)).norm() > FIXED * length
        });
        // all fixed directions are tangential: then what is left is the normal, or the normal and a tangent
        moved || fixed.iter().any(|d| d.dot(normal).abs() > OBLIQUE)
    }

    /// The row of a direction, divided by its length.
    fn unit_row(&self, direction: Vector3<f64>, scale: f64, unit: bool) -> ContactRow {
        let length = direction.dot(&(self.gram * direction)).sqrt();
        self.row(direction, scale, if unit { length.recip() } else { 1.0 })
    }
}

fn reduce(
    index: usize,
    point: &ContactConstraint,
    friction: bool,
    space: &Space,
    scale: f64,
    out: &mut ContactRows,
) {
    let normal = Vector3::from(point.frame.normal);
    let tangents = point.frame.tangents.map(Vector3::from);
    let eigen = SymmetricEigen::new(space.gram);
    let largest = eigen.eigenvalues.max();
    let held = |k: usize| {
        eigen.eigenvalues[k] <= FIXED * (space.alpha * space.alpha + space.beta * space.beta)
    };
    let fixed: Vec<Vector3<f64>> = (0..3)
        .filter(|&k| held(k))
        .map(|k| eigen.eigenvectors.column(k).into())
        .collect();
    let mut drop = |kind, reason| {
        out.removed.push(RemovedRow {
            node: point.node,
            kind,
            reason,
        })
    };
    let movable = normal
        - fixed
            .iter()
            .map(|d| *d * d.dot(&normal))
            .sum::<Vector3<f64>>();
    if fixed.len() == 3 || largest <= 0.0 || movable.norm() <= FIXED {
        drop(RowKind::Normal, RemovalReason::NormalFixed);
        if friction {
            let reason = if fixed.len() == 3 {
                RemovalReason::TangentFixed
            } else {
                RemovalReason::NoNormalRow
            };
            drop(RowKind::Tangential, reason);
            drop(RowKind::Tangential, reason);
        }
        let value = |(case, v): &(u32, [f64; 3])| (*case, dot(v, &point.frame.normal));
        out.held.push(PrescribedPoint {
            point: index,
            node: point.node,
            normal: space.prescribed.iter().map(value).collect(),
        });
        return;
    }
    // With all three directions free the rows keep one common scale, so that the friction disc stays a disc.
    let unit = !fixed.is_empty();
    if friction && !fixed.is_empty() && (point.moving || space.is_dragged(&normal, &fixed)) {
        // friction and support act along the same directions: all rows as without support
        out.rows.push(PointRows {
            point: index,
            normal: space.full_row(normal, scale),
            tangential: tangents.iter().map(|t| space.full_row(*t, scale)).collect(),
            dragged: true,
            prescribed: Vec::new(),
        });
        return;
    }
    let mut tangential = Vec::new();
    if friction {
        match fixed.len() {
            0 => tangential.extend(tangents.map(|t| space.row(t, scale, 1.0))),
            1 => {
                // The one tangential direction orthogonal to the fixed one.
                let along = [tangents[0].dot(&fixed[0]), tangents[1].dot(&fixed[0])];
                let length = along[0].hypot(along[1]);
                let free = (tangents[0] * along[1] - tangents[1] * along[0]) / length;
                tangential.push(space.unit_row(free, scale, unit));
                drop(RowKind::Tangential, RemovalReason::TangentFixed);
            }
            _ => {
                drop(RowKind::Tangential, RemovalReason::TangentFixed);
                drop(RowKind::Tangential, RemovalReason::TangentFixed);
            }
        }
    }
    let normal = space.unit_row(normal, scale, unit);
    out.rows.push(PointRows {
        point: index,
        normal,
        tangential,
        dragged: false,
        prescribed: space.prescribed.clone(),
    });
}
