//! The best admissible position of one contact node, and its share of the duality gap.
//!
//! Of two nodes that may touch each other one moves and the other one stays: the one moves that supports leave more
//! freedom. Where it is not free either, both move, each where it can. Where the other side is of several nodes, which
//! other points have too, they stay, but for one where a support holds the node along the normal. Where the own side
//! is, or where the own node is in a coupling, which stays, all points move together ([`shared`](super::shared)).

use crate::model::{ConstrainedPoint, Model, PointRow};
use crate::result::PointState;
use crate::tolerances::{FREEDOM_TAKEN, NEAR_BOUND, ROUNDING};
use crate::vec3::dot;
use nalgebra::{DMatrix, Vector3};

/// What the rows of a contact point measure of the displacement of one node, in metres: a direction for each row, the
/// normal one first, without the parts along directions that supports fix.
type RowPart = [[f64; 3]; 3];

/// Sum of the squares of directions without their factors: 3 for a node without supports.
fn freedom([normal, along @ ..]: &RowPart, stretch: &[f64; 2]) -> f64 {
    let squares = along.iter().zip(stretch).map(|(d, s)| dot(d, d) / (s * s));
    dot(normal, normal) + squares.sum::<f64>()
}

/// For each row how both nodes move so that the row grows by one, and the others do not.
type Shifts = [[[f64; 3]; 2]; 3];

/// The node of a contact point that moves, and those of the other side, which stay.
#[derive(Debug, Clone)]
pub(crate) struct AdmissibleNode {
    /// Mesh node.
    pub(crate) node: u32,
    /// The normal one, then the tangential ones, in lengths in which friction is the same in all directions.
    rows: Vec<PointRow>,
    /// Factors of the tangential ones.
    stretch: [f64; 2],
    own: RowPart,
    still: Vec<(u32, RowPart)>,
    /// Where supports hold the node in part, and the other side's, of several the freest, has to move, too: the first
    /// of those that else stay.
    both: Option<Box<Shifts>>,
    /// Whether supports hold its own node, so that one of several moves that other points have too.
    shares: bool,
}

impl AdmissibleNode {
    pub(crate) fn new(model: &Model, point: &ConstrainedPoint) -> Self {
        let rows: Vec<_> = point.isotropic().collect();
        let mut parts: Vec<(u32, RowPart)> = Vec::with_capacity(2);
        parts.push((point.node(), RowPart::default()));
        let others = point.contact.sides.nodes().skip(1);
        parts.extend(others.map(|other| (other.0, RowPart::default())));
        let last = parts.len() - 1;
        for (k, &PointRow { row, scale, .. }) in rows.iter().enumerate() {
            for (node, c, coefficient) in model.row(row) {
                let place = parts[..last].iter().position(|p| p.0 == node).unwrap_or(last);
                parts[place].1[k][c] += coefficient / scale;
            }
        }
        // where supports fix nothing, without rounding
        let normal = rows[0].direction;
        for ((_, part), sign) in parts.iter_mut().zip([1.0, -1.0]) {
            if (0..3).all(|c| (sign * part[0][c] - normal[c]).abs() <= ROUNDING) {
                part[0] = normal.map(|c| sign * c);
            }
        }
        if last == 0 {
            for (part, PointRow { direction, .. }) in parts[0].1.iter_mut().zip(&rows).skip(1) {
                *part = *direction;
            }
        }
        // a node that can move: of several partners, which have other points, only where the node itself cannot
        let couplings = &model.discrete.couplings;
        let free = |k: usize| if couplings.has(parts[k].0) { 0.0 } else { freedom(&parts[k].1, &point.stretch) };
        let moving = match last {
            0 => 0,
            1 => usize::from(free(1) > free(0) + ROUNDING),
            _ if free(0) > FREEDOM_TAKEN => 0,
            _ => (1..=last).fold(0, |best, k| if free(k) > free(best) { k } else { best }),
        };
        let (node, own) = parts.remove(moving);
        let mut still = parts;
        let taken = freedom(&own, &point.stretch) < rows.len() as f64 - FREEDOM_TAKEN;
        let both = match &still[..] {
            [_] => taken,
            // free along the surface only, it cannot leave the obstacle
            [_, ..] => dot(&own[0], &own[0]) <= FREEDOM_TAKEN,
            [] => false,
        };
        let freest = |parts: &[(u32, RowPart)]| {
            let free = |k: usize| freedom(&parts[k].1, &point.stretch);
            (0..parts.len()).reduce(|best, k| if free(k) > free(best) { k } else { best })
        };
        let movable = |other: &usize| both && !couplings.has(still[*other].0);
        let both = freest(&still).filter(movable).and_then(|other| {
            still.swap(0, other);
            shifts(&own, &still[0].1, rows.len())
        });
        let alone = point.contact.sides.own.nodes().len() == 1;
        Self {
            node,
            rows,
            shares: alone && last > 1 && (moving > 0 || both.is_some()),
            stretch: point.stretch,
            own,
            still,
            both,
        }
    }

    /// Moves the node such that row `k`, the normal one or those along the surface, grows by so many metres.
    fn shift(&self, v: &mut [f64], k: usize, by: f64) {
        if let (Some(shifts), Some((still, _))) = (&self.both, self.still.first()) {
            for (node, direction) in [self.node, *still].into_iter().zip(&shifts[k]) {
                shift(&mut v[3 * node as usize..][..3], direction, by);
            }
            return;
        }
        let direction = &self.own[k];
        // along the movable part, so that supports stay where they are
        let by = match k {
            0 => by / dot(direction, direction),
            k => by / (self.stretch[k - 1] * self.stretch[k - 1]),
        };
        shift(self.value(v), direction, by);
    }

    /// What the rows measure where the point is moved to its best place, m: the normal one, then those along the
    /// surface.
    pub(crate) fn targets(&self, offset: &[f64], moved: &Correction) -> impl Iterator<Item = f64> {
        let values = [moved.open, moved.slip[0], moved.slip[1]];
        self.touching(offset).zip(values).map(|(rest, value)| rest + value)
    }

    /// The same where it touches and sticks.
    pub(crate) fn touching(&self, offset: &[f64]) -> impl Iterator<Item = f64> {
        self.rows.iter().map(|own| offset[own.row] / own.scale)
    }

    /// Moves the node out of the obstacle, if it is inside.
    pub(crate) fn push_out(&self, offset: &[f64], v: &mut [f64]) {
        let depth = self.conditions(offset, v).depth(self.value(v)).max(0.0);
        self.shift(v, 0, -depth);
    }

    /// Whether it moves one of several nodes of a partner, which other points have too.
    pub(crate) fn shares(&self) -> bool {
        self.shares
    }

    /// The nodes that move.
    pub(crate) fn moving(&self) -> impl Iterator<Item = u32> {
        let other = self.still.first().filter(|_| self.both.is_some());
        std::iter::once(self.node).chain(other.map(|other| other.0))
    }

    /// The displacement of the node that moves.
    pub(crate) fn value<'a>(&self, v: &'a mut [f64]) -> &'a mut [f64] {
        &mut v[3 * self.node as usize..][..3]
    }

    /// The conditions on the node that moves, with the others at their displacements `v`.
    pub(crate) fn conditions(&self, offset: &[f64], v: &[f64]) -> Conditions {
        let mut planes = [([0.0; 3], 0.0); 3];
        for (k, &PointRow { row, scale, .. }) in self.rows.iter().enumerate() {
            // the offset of a row has the motion that supports prescribe along it already
            let mut plane = offset[row] / scale;
            for (node, part) in &self.still {
                plane -= dot(&part[k], &v[3 * *node as usize..][..3]);
            }
            planes[k] = (self.own[k], plane);
        }
        Conditions {
            planes,
            count: self.rows.len(),
        }
    }
}

/// Conditions on the displacement `v` of one node: `d . v <= offset` along the normal, and friction along the other
/// directions `d` where `d . v` is not their offset.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Conditions {
    planes: [([f64; 3], f64); 3],
    count: usize,
}

impl Conditions {
    /// The plane of the obstacle: normal and offset.
    pub(crate) fn obstacle(&self) -> ([f64; 3], f64) {
        self.planes[0]
    }

    /// Directions along the surface, with their offsets.
    pub(crate) fn along(&self) -> &[([f64; 3], f64)] {
        &self.planes[1..self.count]
    }

    /// How deep the node is in the obstacle, m; negative outside.
    fn depth(&self, value: &[f64]) -> f64 {
        let (normal, offset) = self.planes[0];
        dot(&normal, value) - offset
    }
}

/// A contact node after its move.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Correction {
    /// `v_nu - g`, m.
    open: f64,
    /// `v_T - z` along the tangential directions, m.
    slip: [f64; 2],
    /// Friction force along them, N.
    force: [f64; 2],
    /// Slip bound that the estimate takes, N.
    bound: f64,
    /// Energy that the change of the slip bound is worth, J.
    pub(crate) change: f64,
}

impl Correction {
    /// Moves a node such that the gap is smallest with all other nodes held; `stiffness` is that of rows in N/m.
    pub(crate) fn new(
        node: &AdmissibleNode,
        state: &PointState,
        offset: &[f64],
        stiffness: &[f64],
        v: &mut [f64],
    ) -> Self {
        let of_row = |k: usize| node.rows[k].scale.powi(2) * stiffness[node.rows[k].row];
        let open = node.conditions(offset, v).depth(node.value(v));
        let target = (open - state.normal_force / of_row(0)).min(0.0);
        node.shift(v, 0, target - open);
        let mut moved = Self {
            open: target,
            slip: [0.0; 2],
            force: [0.0; 2],
            bound: state.slip_bound,
            change: 0.0,
        };
        let conditions = node.conditions(offset, v);
        if conditions.along().is_empty() {
            return moved;
        }
        // across the axis of friction a row of length l gives way l² times as far
        let k = of_row(1) / node.stretch[1].powi(2).max(1.0);
        let value = node.value(v);
        let mut start = [0.0; 2];
        for (j, (own, offset)) in conditions.along().iter().enumerate() {
            start[j] = dot(own, value) - offset;
            let factor = node.stretch[j] * node.stretch[j];
            moved.force[j] = dot(&node.rows[1 + j].direction, &state.friction_force) / factor;
        }
        // with the bound of the step, or with the friction force as the bound: whichever costs less
        let size = length(moved.force);
        let nearest = |bound: f64| {
            let w = [start[0] - moved.force[0] / k, start[1] - moved.force[1] / k];
            let length = length(w);
            let shrink = if length > 0.0 { (1.0 - bound / (k * length)).max(0.0) } else { 0.0 };
            w.map(|w| shrink * w)
        };
        let change = 0.5 * (moved.bound - size).powi(2) / k;
        moved.slip = nearest(moved.bound);
        let way = length([moved.slip[0] - start[0], moved.slip[1] - start[1]]);
        let near = (moved.bound - size).abs() <= NEAR_BOUND * moved.bound;
        if size > moved.bound || near && change < moved.friction_term() + 0.5 * k * way * way {
            moved.bound = size;
            moved.change = change;
            moved.slip = nearest(size);
        }
        for j in 0..conditions.along().len() {
            node.shift(v, 1 + j, moved.slip[j] - start[j]);
        }
        moved
    }

    /// Force along the normal, then those along the surface, and their bound, N.
    pub(crate) fn forces(&self, state: &PointState) -> ([f64; 3], f64) {
        ([state.normal_force, self.force[0], self.force[1]], self.bound)
    }

    /// Whether the node is at the obstacle.
    pub(crate) fn touches(&self) -> bool {
        self.open == 0.0
    }

    /// Whether friction holds it where it is.
    pub(crate) fn sticks(&self) -> bool {
        self.bound > 0.0 && self.slip == [0.0; 2]
    }

    /// The node's share of the gap at its final position, which supports may have changed, J.
    pub(crate) fn gap(mut self, state: &PointState, conditions: &Conditions, value: &[f64]) -> f64 {
        let far = |a: f64, b: f64, size: f64| (a - b).abs() > ROUNDING * size;
        let size = value.iter().map(|v| v.abs()).fold(0.0, f64::max);
        let open = conditions.depth(value);
        if far(open, self.open, size + conditions.obstacle().1.abs()) {
            self.open = open;
        }
        for ((direction, offset), own) in conditions.along().iter().zip(&mut self.slip) {
            let slip = dot(direction, value) - offset;
            if far(slip, *own, size + offset.abs()) {
                *own = slip;
            }
        }
        (state.normal_force * self.open).abs() + self.friction_term()
    }

    /// `r |w| + lambda_T . w`, without the cancellation of a sliding node.
    fn friction_term(&self) -> f64 {
        let ([a, b], [x, y]) = (self.force, self.slip);
        let (size, way, work) = (length(self.force), length(self.slip), a * x + b * y);
        let angle = if work < 0.0 { (a * y - b * x).powi(2) / (size * way - work) } else { size * way + work };
        (self.bound - size).max(0.0) * way + angle
    }
}

/// How both nodes move for each of so many rows, as little as possible; `None` if nothing makes the rows independent.
fn shifts(own: &RowPart, still: &RowPart, rows: usize) -> Option<Box<Shifts>> {
    let matrix = DMatrix::from_fn(rows, 6, |k, c| if c < 3 { own[k][c] } else { still[k][c - 3] });
    let inverse = matrix.pseudo_inverse(FREEDOM_TAKEN).ok()?;
    let mut out = Shifts::default();
    for (k, shift) in out.iter_mut().enumerate().take(rows) {
        *shift = [0, 3].map(|at| Vector3::from_fn(|c, _| inverse[(at + c, k)]).into());
    }
    Some(Box::new(out))
}

fn length(w: [f64; 2]) -> f64 {
    w[0].hypot(w[1])
}

fn shift(value: &mut [f64], direction: &[f64; 3], by: f64) {
    for c in 0..3 {
        value[c] += by * direction[c];
    }
}
