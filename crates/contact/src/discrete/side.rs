//! The two sides of a contact point: all that is above asks here which nodes a point moves.

use crate::tolerances::SHORT_LEVER;
use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use signorini_fem_mesh::vec3;
use signorini_tfeti::Side;

/// Both sides of a contact point: short lists of nodes with weights, where meshes match of one node each.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sides {
    /// That of the body whose outward normal counts.
    pub(crate) own: Side,
    /// That of the other body; `None` for a rigid obstacle.
    pub(crate) partner: Option<Side>,
    /// Whether the scene names the other body first.
    pub(crate) swapped: bool,
}

impl Sides {
    /// The node that names the point: the first.
    pub(crate) fn node(&self) -> u32 {
        self.own.nodes()[0].0
    }

    /// The node that names the other side.
    pub(crate) fn partner(&self) -> Option<u32> {
        self.partner.as_ref().map(|side| side.nodes()[0].0)
    }

    /// What a force on the point is at the nodes of both sides.
    pub(crate) fn forces(&self, force: [f64; 3]) -> impl Iterator<Item = (u32, [f64; 3])> {
        let partner = self.partner.iter();
        on_nodes(&self.own, 1.0, force).chain(partner.flat_map(move |side| on_nodes(side, -1.0, force)))
    }

    /// The same at nodes of the body that the scene names first.
    pub(crate) fn first(&self, force: [f64; 3]) -> impl Iterator<Item = (u32, [f64; 3])> {
        let partner = self.partner.as_ref().filter(|_| self.swapped);
        on_nodes(partner.unwrap_or(&self.own), self.sign(), force)
    }

    /// The displacement of the own side relative to the partner along a direction, from what each node has along a
    /// vector.
    pub(crate) fn way(&self, direction: &[f64; 3], along: impl Fn(u32, &[f64; 3]) -> f64) -> f64 {
        let mean: f64 = self.nodes().map(|(node, weight)| weight * along(node, direction)).sum();
        let turns = self
            .partner
            .iter()
            .flat_map(|side| side.nodes().iter().zip(side.turn()));
        let turned = turns.map(|((node, _), turn)| along(*node, &times(turn, direction)));
        mean - turned.sum::<f64>()
    }

    /// Facets of curved sides are apart where the sides touch, and forces of both act at two places: the partner turns
    /// over the way between them.
    pub(super) fn turn_partner(&mut self, place: impl Fn(u32) -> [f64; 3], rounding: f64) {
        let Some(partner) = &mut self.partner else { return };
        let way = vec3::sub(mean_place(partner, &place), mean_place(&self.own, &place));
        let weights: f64 = partner.nodes().iter().map(|(_, weight)| weight.abs()).sum();
        if vec3::norm(way) > weights * rounding {
            *partner = turning(partner, way, place);
        }
    }

    /// Sign of forces on the body that the scene names first.
    pub(crate) fn sign(&self) -> f64 {
        if self.swapped { -1.0 } else { 1.0 }
    }

    /// The displacement of one side relative to the other as a sum: nodes with weights, those of the partner negative.
    pub(crate) fn nodes(&self) -> impl Iterator<Item = (u32, f64)> {
        let partner = self.partner.iter().flat_map(Side::nodes);
        let partner = partner.map(|&(node, weight)| (node, -weight));
        self.own.nodes().iter().copied().chain(partner)
    }
}

/// A force times a sign at the nodes of a side.
fn on_nodes(side: &Side, sign: f64, force: [f64; 3]) -> impl Iterator<Item = (u32, [f64; 3])> {
    side.nodes().iter().enumerate().map(move |(k, &(node, weight))| {
        let mut own = force.map(|f| sign * weight * f);
        if let Some(turn) = side.turn().get(k) {
            let turned = times(turn, &force);
            (0..3).for_each(|c| own[c] += sign * turned[c]);
        }
        (node, own)
    })
}

/// The transpose of a matrix times a vector.
fn times(turn: &[[f64; 3]; 3], v: &[f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|c| (0..3).map(|r| turn[r][c] * v[r]).sum())
}

/// The mean of the places of a side, m.
pub(crate) fn mean_place(side: &Side, place: impl Fn(u32) -> [f64; 3]) -> [f64; 3] {
    match side.nodes() {
        [(node, _)] => place(*node),
        nodes => nodes.iter().fold([0.0; 3], |sum, &(node, weight)| {
            vec3::add(sum, vec3::scale(weight, place(node)))
        }),
    }
}

/// A side that turns about its mean: what displacements of its nodes add at the end of the way `-lever` from there, m.
///
/// The rotation is that which fits displacements best, weighted as the mean is: rigid ones are met exactly, and forces
/// of the couple are spread as those on a group of bolts. None about an axis from which the nodes are nearer than the
/// way is long.
fn turning(side: &Side, lever: [f64; 3], place: impl Fn(u32) -> [f64; 3]) -> Side {
    let shares = || {
        side.nodes()
            .iter()
            .map(|&(node, w)| (w.abs(), Vector3::from(place(node))))
    };
    let whole: f64 = shares().map(|s| s.0).sum();
    let middle: Vector3<f64> = shares().map(|(w, x)| x * (w / whole)).sum();
    let across = |x: Vector3<f64>| (x - middle).cross_matrix();
    let inertia: Matrix3<f64> = shares().map(|(w, x)| across(x) * across(x) * (-w / whole)).sum();
    let eigen = SymmetricEigen::new(inertia);
    let lever = Vector3::from(lever);
    let mut inverse = Matrix3::zeros();
    for (axis, &square) in eigen.eigenvectors.column_iter().zip(&eigen.eigenvalues) {
        if square > SHORT_LEVER * lever.norm_squared() {
            inverse += axis * axis.transpose() / square;
        }
    }
    let turn = shares().map(|(w, x)| lever.cross_matrix() * inverse * across(x) * (w / whole));
    side.clone().with_turn(turn.map(|m| m.transpose().into()).collect())
}

/// A gap that is not rounding of places.
pub(crate) fn rounded(gap: f64, rounding: f64) -> f64 {
    if gap.abs() <= rounding { 0.0 } else { gap }
}
