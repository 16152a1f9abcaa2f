//! The rows of contact constraints: the directions in which they can still move once supports are taken into account.

use crate::error::TfetiError;
use crate::linalg::entry;
use crate::rows::side::{ContactConstraint, check_constraints};
use crate::rows::supports::{FixedNode, MergedSupports};
use crate::tolerances::{ANGLE, FIXED, HELD_OF_OTHER, ONE_DIRECTION};
use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use signorini_fem_mesh::vec3::dot;
use std::ops::Range;

/// A contact point whose normal displacement is fixed by supports, so that it has no normal row.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct PrescribedPoint {
    /// Position in the list of contact points.
    pub point: usize,
    /// Its first mesh node.
    pub node: u32,
    /// `(case, relative normal displacement in metres)`: what supports prescribe for a factor of one, cases ascending.
    /// Of a side that they hold in part all moves with that.
    pub normal: Vec<(u32, f64)>,
}

/// A direction in which supports hold both sides of a tied constraint, so that no row says there how they move.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct HeldTie {
    /// Position in the list of contact points.
    pub point: usize,
    /// Of length one.
    pub direction: [f64; 3],
    /// `(case, relative displacement along it in metres)`: what supports prescribe for a factor of one, cases
    /// ascending. `None` where they hold a part of a side whose nodes do not move alike.
    pub values: Option<Vec<(u32, f64)>>,
}

/// The contact points whose normal displacement supports fix at all nodes, in the order of the points.
///
/// No contact force acts on them. Whether they stay outside the obstacle is to be judged by whoever knows the gap: the
/// normal displacement at a time is the sum over cases of `factor(case, t) * value`.
///
/// # Errors
/// [`TfetiError`] as of a set-up: unknown nodes, wrong frames.
pub fn prescribed_points(
    contact: &[ContactConstraint],
    supports: &MergedSupports,
) -> Result<Vec<PrescribedPoint>, TfetiError> {
    Ok(contact_rows(contact, supports, |_| 1.0)?.prescribed)
}

/// The directions in which supports hold both sides of tied constraints, in the order of the constraints. Whether what
/// they prescribe is what the tie says is to be judged by whoever knows how its sides move.
pub fn held_ties(contact: &[ContactConstraint], supports: &MergedSupports) -> Vec<HeldTie> {
    let tied = contact.iter().enumerate().filter(|(_, point)| point.tied);
    let of = |(index, point): (usize, &ContactConstraint)| {
        let space = Space::new(point, supports, &|_| 1.0);
        let held = |d: Vector3<f64>| HeldTie {
            point: index,
            direction: d.into(),
            values: space.moves_alike(point, d).then(|| space.prescribed_along(point, d)),
        };
        let fixed = space.fixed(point, Vector3::zeros());
        fixed.into_iter().map(held).collect::<Vec<_>>()
    };
    tied.flat_map(of).collect()
}

/// One contact row: what it does to the mean displacements of the nodes of both sides.
#[derive(Debug, Clone)]
pub(super) struct ContactRow {
    /// Coefficients on the displacement of each node (to be spread over its copies), those of the partner last.
    pub(super) parts: Vec<[f64; 3]>,
    /// The physical direction: the row stands for `scale * direction . (u_side - u_partner)`.
    pub(super) direction: [f64; 3],
    pub(super) scale: f64,
}

/// The rows of one contact point.
#[derive(Debug, Clone)]
pub(super) struct PointRows {
    /// Position in the list of points.
    pub(super) point: usize,
    pub(super) normal: ContactRow,
    pub(super) tangential: Vec<ContactRow>,
    /// Whether the rows keep directions that supports fix.
    pub(super) dragged: bool,
    /// `(case, relative displacement prescribed by supports)`.
    pub(super) prescribed: Vec<(u32, [f64; 3])>,
}

/// Rows of all points, and the points without normal row.
#[derive(Debug, Default)]
pub(super) struct AllRows {
    pub(super) rows: Vec<PointRows>,
    /// Rows of tied constraints: the first as the normal one.
    pub(super) tied: Vec<PointRows>,
    prescribed: Vec<PrescribedPoint>,
}

/// Rows of all points. `squares(node)` is the sum of the squared shares of the copies of a node in their mean: one over
/// their number where all count alike.
pub(super) fn contact_rows(
    contact: &[ContactConstraint],
    supports: &MergedSupports,
    squares: impl Fn(u32) -> f64,
) -> Result<AllRows, TfetiError> {
    check_constraints(contact, supports.mesh_nodes)?;
    let mut out = AllRows::default();
    for (index, point) in contact.iter().enumerate() {
        out.add(index, point, Space::new(point, supports, &squares));
    }
    Ok(out)
}

/// Free part of the relative displacement of the sides of a point.
struct Space {
    /// Of each node its coefficient, signed, on the mean of its copies (as a unit vector of these), and the projector
    /// on what supports leave free.
    nodes: Vec<(f64, Matrix3<f64>)>,
    /// Of each node the projector on what supports hold, but from where a solve has left it.
    held: Vec<Matrix3<f64>>,
    /// Of each node what it adds by the turn of its side, as the coefficient; none where no side turns.
    turns: Vec<Matrix3<f64>>,
    /// Scale of a row of length one if there are no supports.
    scale: f64,
    /// Gram matrix of the rows `direction -> coefficient * projector * direction`.
    gram: Matrix3<f64>,
    prescribed: Vec<(u32, [f64; 3])>,
    /// What of it each node is moved by.
    moved: Vec<Vec<(u32, [f64; 3])>>,
}

impl Space {
    fn new(point: &ContactConstraint, supports: &MergedSupports, squares: &impl Fn(u32) -> f64) -> Self {
        // A unit row on weighted means of copies: c w_i sqrt(s_i) with c = (sum w_i^2 s_i)^(-1/2).
        let sum: f64 = point.nodes().map(|(n, w)| w * w * squares(n)).sum();
        let scale = sum.sqrt().recip();
        let mut prescribed: Vec<(u32, [f64; 3])> = Vec::new();
        let mut nodes = Vec::with_capacity(2);
        let mut held = Vec::with_capacity(2);
        let mut turns = point.turns();
        let mut moved = Vec::with_capacity(2);
        for (k, (node, weight)) in point.nodes().enumerate() {
            let fixed = supports.at(node);
            let [mut free, mut own] = [Matrix3::identity(), Matrix3::zeros()];
            for direction in fixed.iter().flat_map(|f| &f.directions) {
                let d = Vector3::from(direction.direction);
                let along = d * d.transpose();
                free -= along;
                if !direction.left {
                    own += along;
                }
            }
            held.push(own);
            nodes.push((scale * squares(node).sqrt() * weight, free));
            let own = fixed.map(FixedNode::prescribed).unwrap_or_default();
            for &(case, value) in &own {
                let sum = entry(&mut prescribed, case, [0.0; 3]);
                (0..3).for_each(|c| sum[c] += weight * value[c]);
                if let Some(turn) = turns.get(k) {
                    let turned = turn * Vector3::from(value);
                    (0..3).for_each(|c| sum[c] += turned[c]);
                }
            }
            moved.push(own);
            if let Some(turn) = turns.get_mut(k) {
                *turn *= scale * squares(node).sqrt();
            }
        }
        prescribed.sort_by_key(|v| v.0);
        let gram = nodes.iter().map(|(c, free)| free * (c * c)).sum();
        Self {
            nodes,
            held,
            turns,
            scale,
            gram,
            prescribed,
            moved,
        }
    }

    /// How much of a direction supports hold at a node.
    fn held_of(&self, node: usize, d: Vector3<f64>) -> f64 {
        1.0 - d.dot(&(self.nodes[node].1 * d))
    }

    /// The sides of which supports hold some nodes along a direction and not all, with the share of the mean.
    fn parts(&self, point: &ContactConstraint, d: Vector3<f64>) -> Vec<(Range<usize>, f64)> {
        let (own, all) = (point.side.nodes().len(), self.nodes.len());
        let weights: Vec<f64> = point.nodes().map(|n| n.1).collect();
        let sides = [0..own, own..all].into_iter();
        let parts = sides.filter(|side| side.clone().any(|k| self.held_of(k, d) < 1.0 - ANGLE));
        let share = |side: &Range<usize>| side.clone().map(|k| weights[k] * self.held_of(k, d)).sum::<f64>();
        parts.map(|side| (side.clone(), share(&side).abs())).collect()
    }

    /// What supports prescribe of the relative displacement along a direction, by case, with copies that count alike:
    /// what they hold of a side takes the rest, which has no row of its own, with it.
    fn prescribed_along(&self, point: &ContactConstraint, d: Vector3<f64>) -> Vec<(u32, f64)> {
        let along = |v: &[f64; 3]| d.dot(&Vector3::from(*v));
        let mut out: Vec<(u32, f64)> = self.prescribed.iter().map(|(case, v)| (*case, along(v))).collect();
        let weights: Vec<f64> = point.nodes().map(|n| n.1).collect();
        for (side, share) in self.parts(point, d) {
            let more = share.max(HELD_OF_OTHER).recip() - 1.0;
            for k in side {
                for (case, v) in &self.moved[k] {
                    // a side that is shifted does not turn
                    let turned = self
                        .turns
                        .get(k)
                        .map_or(0.0, |turn| d.dot(&(turn * Vector3::from(*v))) / self.scale);
                    *entry(&mut out, *case, 0.0) += weights[k] * more * along(v) - turned;
                }
            }
        }
        out
    }

    /// Whether the nodes that supports hold of a side move alike along a direction in which others are free.
    fn moves_alike(&self, point: &ContactConstraint, d: Vector3<f64>) -> bool {
        let moved = |k: usize| -> Vec<(u32, f64)> {
            let values = self.moved[k].iter().map(|(case, v)| (*case, d.dot(&Vector3::from(*v))));
            values.filter(|v| v.1 != 0.0).collect()
        };
        self.parts(point, d).into_iter().all(|(side, _)| {
            let mut held = side.filter(|k| self.held_of(*k, d) > ANGLE);
            let first = held.next();
            first.is_none_or(|first| {
                let alike = |k| self.held_of(k, d) > 1.0 - ANGLE && moved(k) == moved(first);
                alike(first) && held.all(alike)
            })
        })
    }

    /// The row of a direction times a factor, without what supports fix, or `whole`.
    fn row(&self, direction: Vector3<f64>, factor: f64, whole: bool) -> ContactRow {
        let part = |(c, free): &(f64, Matrix3<f64>)| {
            let own = if whole { direction } else { free * direction };
            (own * (c * factor)).into()
        };
        let mut parts: Vec<[f64; 3]> = self.nodes.iter().map(part).collect();
        for ((part, turn), (_, free)) in parts.iter_mut().zip(&self.turns).zip(&self.nodes) {
            let own = turn.tr_mul(&direction);
            let own = if whole { own } else { free * own };
            (0..3).for_each(|c| part[c] += factor * own[c]);
        }
        ContactRow {
            parts,
            direction: direction.into(),
            scale: self.scale * factor,
        }
    }

    /// The row of a direction, divided by its length.
    fn unit_row(&self, direction: Vector3<f64>) -> ContactRow {
        let mut square = direction.dot(&(self.gram * direction));
        if !self.turns.is_empty() {
            let row = self.row(direction, 1.0, false);
            square = row.parts.iter().map(|&v| dot(v, v)).sum();
        }
        self.row(direction, square.sqrt().recip(), false)
    }

    /// Directions that supports fix at all nodes, and those in which they hold both sides, or one beside an obstacle: a
    /// node or a good part of a mean, along `normal` and at right angles to it. There, at a clamp or a plane of
    /// symmetry that cuts both, a row would see no slip and no gap, but how displacements bend beside the plane. What is
    /// held from where a solve has left it is in balance with the row.
    fn fixed(&self, point: &ContactConstraint, normal: Vector3<f64>) -> Vec<Vector3<f64>> {
        let eigen = SymmetricEigen::new(self.gram);
        let zero = FIXED * self.nodes.iter().map(|(c, _)| c * c).sum::<f64>();
        let fixed = (0..3).filter(|&k| eigen.eigenvalues[k] <= zero);
        let mut fixed: Vec<Vector3<f64>> = fixed.map(|k| eigen.eigenvectors.column(k).into()).collect();
        let (own, all) = (point.side.nodes().len(), self.nodes.len());
        if all > 2 || own > 1 {
            let along = |d: &Vector3<f64>| d * d.transpose();
            let shares = point.nodes().zip(&self.held).map(|((_, w), held)| held * w);
            let shares: Vec<Matrix3<f64>> = shares.collect();
            let is_pair = all > own;
            let other: Matrix3<f64> = match is_pair {
                true => shares[own..].iter().map(|share| -share).sum(),
                // an obstacle
                false => Matrix3::identity(),
            };
            let least = point.side.held_from();
            let (own, least_of_other) = match own {
                1 => (self.held[0], least),
                // the directions that supports hold at a good part of a mean
                _ => {
                    let held = SymmetricEigen::new(shares[..own].iter().sum::<Matrix3<f64>>());
                    let found = (0..3).filter(|&k| held.eigenvalues[k] >= least);
                    let is_cut = held.eigenvalues.max() < 1.0 - ANGLE;
                    let own = found.map(|k| along(&held.eigenvectors.column(k).into())).sum();
                    (own, if is_cut { HELD_OF_OTHER } else { least })
                }
            };
            // supports may fix the normal, too
            let across = fixed.iter().fold(normal, |n, d| n - d * n.dot(d));
            let across = across.try_normalize(ANGLE).unwrap_or_else(Vector3::zeros);
            let left = fixed
                .iter()
                .fold(Matrix3::identity() - along(&across), |p, d| p - along(d));
            // by a good part, and not a direction between that and free ones
            let holds = |side: &Matrix3<f64>, least: f64, d: Vector3<f64>| {
                let share = d.dot(&(side * d));
                share >= least && (side * d - d * share).norm() <= ANGLE * share
            };
            if holds(&own, least, across) && holds(&other, least_of_other, across) {
                fixed.push(across);
            }
            let held = SymmetricEigen::new(left * own * other * own * left);
            let found = (0..3).filter(|&k| held.eigenvalues[k] >= least_of_other);
            let found = found.map(|k| Vector3::from(held.eigenvectors.column(k)));
            fixed.extend(found.filter(|&d| is_pair || holds(&own, least, d)));
        }
        fixed
    }

    /// Whether supports move the point along the surface, or fix a direction that is neither normal nor tangential, so
    /// that friction works where they act.
    fn is_dragged(&self, normal: &Vector3<f64>, fixed: &[Vector3<f64>]) -> bool {
        let moved = self.prescribed.iter().any(|(_, value)| {
            let value = Vector3::from(*value);
            let length = value.norm();
            (value - normal * value.dot(normal)).norm() > FIXED * length
        });
        // all fixed directions are tangential: then what is left is the normal, or the normal and a tangent
        moved || fixed.iter().any(|d| d.dot(normal).abs() > ANGLE)
    }
}

/// Unit vectors at right angles to orthonormal ones and to one another.
fn complement(fixed: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let projector: Matrix3<f64> = fixed.iter().fold(Matrix3::identity(), |p, d| p - d * d.transpose());
    let eigen = SymmetricEigen::new(projector);
    let free = (0..3).filter(|&k| eigen.eigenvalues[k] > 0.5);
    free.map(|k| eigen.eigenvectors.column(k).into()).collect()
}

impl AllRows {
    /// The rows of a tied constraint: the axes, or all directions that are left.
    fn tie(&mut self, index: usize, point: &ContactConstraint, space: Space) {
        let fixed = space.fixed(point, Vector3::zeros());
        let mut rows: Vec<ContactRow> = match fixed.len() {
            0 => (0..3).map(|c| space.row(Vector3::ith(c, 1.0), 1.0, false)).collect(),
            _ => complement(&fixed).into_iter().map(|d| space.unit_row(d)).collect(),
        };
        if rows.is_empty() {
            return;
        }
        self.tied.push(PointRows {
            point: index,
            normal: rows.remove(0),
            tangential: rows,
            dragged: false,
            prescribed: space.prescribed,
        });
    }

    fn add(&mut self, index: usize, point: &ContactConstraint, space: Space) {
        if point.tied {
            return self.tie(index, point, space);
        }
        let normal = Vector3::from(point.frame.normal);
        let tangents = point.frame.tangents.map(Vector3::from);
        let factors = [1.0, point.stretch];
        let fixed = space.fixed(point, normal);
        let along: Vector3<f64> = fixed.iter().map(|d| *d * d.dot(&normal)).sum();
        if fixed.len() == 3 || (normal - along).norm() <= ONE_DIRECTION {
            self.prescribed.push(PrescribedPoint {
                point: index,
                node: point.side.first(),
                normal: space.prescribed_along(point, normal),
            });
            return;
        }
        let dragged = point.friction && !fixed.is_empty() && (point.moving || space.is_dragged(&normal, &fixed));
        let mut tangential = Vec::new();
        // With all three directions free the rows keep one common scale, so that the friction disc stays a disc. Where
        // friction and support act along the same directions, all rows are as without support.
        let normal = match fixed.len() {
            count if count == 0 || dragged => {
                if point.friction {
                    let along = tangents.into_iter().zip(factors);
                    tangential.extend(along.map(|(t, factor)| space.row(t, factor, dragged)));
                }
                space.row(normal, 1.0, dragged)
            }
            count => {
                if point.friction && count == 1 {
                    // The one tangential direction orthogonal to the fixed one.
                    let along = [tangents[0].dot(&fixed[0]), tangents[1].dot(&fixed[0])];
                    let length = along[0].hypot(along[1]);
                    let free = (tangents[0] * along[1] - tangents[1] * along[0]) / length;
                    tangential.push(space.unit_row(free));
                }
                space.unit_row(normal)
            }
        };
        let prescribed = if dragged { Vec::new() } else { space.prescribed };
        self.rows.push(PointRows {
            point: index,
            normal,
            tangential,
            dragged,
            prescribed,
        });
    }
}
