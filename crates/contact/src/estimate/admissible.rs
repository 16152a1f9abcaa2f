//! The best admissible position of one contact node, and its share of the duality gap; see the [algebraic
//! error](crate::AlgebraicError).
//!
//! Of two nodes that may touch each other one moves and the other one stays: the one moves that supports leave more freedom. Where
//! it is not free either, both move, each where it can.

use crate::model::{ConstrainedPoint, Model};
use crate::result::PointState;
use crate::step::StepProblem;
use crate::vec3::dot;
use nalgebra::{DMatrix, Vector3};

/// Rounding of directions.
const SAME: f64 = 1e-12;

/// Freedom of a node that supports take counts above this.
const HELD: f64 = 1e-8;

/// Rounding of differences of positions, relative.
const ROUNDING: f64 = 1e-12;

/// Relative change of a slip bound that is judged by the stiffness of the node. Larger ones move the whole body, and the
/// gap, which overrates small changes, is the safer measure.
const NEAR: f64 = 0.01;

/// What the rows of a contact point measure of the displacement of one node, in metres: their directions, without the parts
/// along directions that supports fix.
#[derive(Debug, Clone, Copy, Default)]
struct Side {
    normal: [f64; 3],
    along: [[f64; 3]; 2],
}

impl Side {
    /// Sum of the squares: 3 for a node without supports.
    fn freedom(&self) -> f64 {
        let all = [self.normal, self.along[0], self.along[1]];
        all.iter().map(|d| dot(d, d)).sum()
    }

    fn direction(&self, k: usize) -> &[f64; 3] {
        match k {
            0 => &self.normal,
            k => &self.along[k - 1],
        }
    }
}

/// For each row how both nodes move so that the row grows by one, and the others do not.
type Shifts = [[[f64; 3]; 2]; 3];

/// The node of a contact point that moves, and its partner, which stays.
#[derive(Debug, Clone)]
pub(crate) struct Movable {
    /// Mesh node.
    pub(crate) node: u32,
    own: Side,
    still: Option<(u32, Side)>,
    /// Where supports hold both nodes in part.
    both: Option<Box<Shifts>>,
}

impl Movable {
    pub(crate) fn new(model: &Model, touch: &ConstrainedPoint) -> Self {
        let subdomains = model.decomposition.subdomains();
        let mut sides = [Side::default(); 2];
        let rows = touch.directions().zip(0..);
        for ((_, row, scale), k) in rows {
            for (subdomain, dof, coefficient) in model.tfeti.gluing().row(row) {
                let first = subdomains[subdomain].nodes[dof / 3] == touch.node;
                let side = &mut sides[usize::from(!first)];
                let part = match k {
                    0 => &mut side.normal,
                    k => &mut side.along[k - 1],
                };
                part[dof % 3] += coefficient / scale;
            }
        }
        // where supports fix nothing, without rounding
        let normal = touch.frame.normal;
        for (side, sign) in sides.iter_mut().zip([1.0, -1.0]) {
            if (0..3).all(|c| (sign * side.normal[c] - normal[c]).abs() <= SAME) {
                side.normal = normal.map(|c| sign * c);
            }
        }
        let [mut first, second] = sides;
        match touch.partner {
            None => {
                for (along, (direction, ..)) in first.along.iter_mut().zip(touch.along()) {
                    *along = direction;
                }
                Self {
                    node: touch.node,
                    own: first,
                    still: None,
                    both: None,
                }
            }
            Some(partner) => {
                let swap = second.freedom() > first.freedom() + SAME;
                let (node, own, still) = if swap {
                    (partner, second, (touch.node, first))
                } else {
                    (touch.node, first, (partner, second))
                };
                let rows = touch.directions().count();
                let held = own.freedom() < rows as f64 - HELD;
                Self {
                    node,
                    own,
                    still: Some(still),
                    both: held.then(|| shifts(&own, &still.1, rows)).flatten(),
                }
            }
        }
    }

    /// Moves the node such that row `k`, the normal one or those along the surface, grows by so many metres.
    pub(crate) fn shift(&self, v: &mut [f64], k: usize, by: f64) {
        if let (Some(shifts), Some((still, _))) = (&self.both, &self.still) {
            for (node, direction) in [self.node, *still].into_iter().zip(&shifts[k]) {
                shift(&mut v[3 * node as usize..][..3], direction, by);
            }
            return;
        }
        let direction = self.own.direction(k);
        // along the movable part, so that supports stay where they are
        let by = if k == 0 {
            by / dot(direction, direction)
        } else {
            by
        };
        shift(self.value(v), direction, by);
    }

    /// Moves the node out of the obstacle, if it is inside.
    pub(crate) fn push_out(&self, level: &StepProblem, touch: &ConstrainedPoint, v: &mut [f64]) {
        let place = self.place(level, touch, v);
        let depth = place.depth(self.value(v)).max(0.0);
        self.shift(v, 0, -depth);
    }

    /// The displacement of the node that moves.
    pub(crate) fn value<'a>(&self, v: &'a mut [f64]) -> &'a mut [f64] {
        &mut v[3 * self.node as usize..][..3]
    }

    /// The conditions on the node that moves, with the others at their displacements `v`.
    pub(crate) fn place(&self, level: &StepProblem, touch: &ConstrainedPoint, v: &[f64]) -> Place {
        // the offset of a row has the motion that supports prescribe along it already
        let offset = |row: usize, scale: f64, still: fn(&Side) -> [f64; 3]| {
            let own = level.offset[row] / scale;
            match &self.still {
                Some((node, side)) => own - dot(&still(side), &v[3 * *node as usize..][..3]),
                None => own,
            }
        };
        let mut place = Place {
            normal: self.own.normal,
            offset: offset(touch.row, touch.scale, |s| s.normal),
            along: [([0.0; 3], 0.0); 2],
            count: 0,
        };
        for (k, (_, row, scale)) in touch.along().enumerate() {
            let still = [|s: &Side| s.along[0], |s: &Side| s.along[1]][k];
            place.along[k] = (self.own.along[k], offset(row, scale, still));
            place.count = k + 1;
        }
        place
    }
}

/// Conditions on the displacement `v` of one node: `normal . v <= offset`, and friction along directions `d` where
/// `d . v` is not their offset.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    pub(crate) normal: [f64; 3],
    pub(crate) offset: f64,
    along: [([f64; 3], f64); 2],
    count: usize,
}

impl Place {
    /// Directions along the surface, with their offsets.
    pub(crate) fn along(&self) -> &[([f64; 3], f64)] {
        &self.along[..self.count]
    }

    /// How deep the node is in the obstacle, m; negative outside.
    fn depth(&self, value: &[f64]) -> f64 {
        dot(&self.normal, value) - self.offset
    }
}

/// A contact node after its move.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Moved {
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

impl Moved {
    /// Moves a node such that the gap is smallest with all other nodes held; `rows` are stiffnesses of rows in N/m.
    pub(crate) fn new(
        touch: &ConstrainedPoint,
        point: &PointState,
        (level, movable): (&StepProblem, &Movable),
        rows: &[f64],
        v: &mut [f64],
    ) -> Self {
        let k = touch.scale.powi(2) * rows[touch.row];
        let place = movable.place(level, touch, v);
        let open = place.depth(movable.value(v));
        let target = (open - point.normal_force / k).min(0.0);
        movable.shift(v, 0, target - open);
        let place = movable.place(level, touch, v);
        let value = movable.value(v);
        let mut moved = Self {
            open: target,
            slip: [0.0; 2],
            force: [0.0; 2],
            bound: point.slip_bound,
            change: 0.0,
        };
        let Some((_, row, scale)) = touch.along().next() else {
            return moved;
        };
        let k = scale.powi(2) * rows[row];
        let mut start = [0.0; 2];
        let conditions = touch.along().zip(place.along());
        for (j, ((direction, ..), (own, offset))) in conditions.enumerate() {
            start[j] = dot(own, value) - offset;
            moved.force[j] = dot(&direction, &point.friction_force);
        }
        // with the bound of the level, or with the friction force as the bound: whichever costs less
        let size = length(moved.force);
        let nearest = |bound: f64| {
            let w = [start[0] - moved.force[0] / k, start[1] - moved.force[1] / k];
            let shrink = if length(w) > 0.0 {
                (1.0 - bound / (k * length(w))).max(0.0)
            } else {
                0.0
            };
            w.map(|w| shrink * w)
        };
        let change = 0.5 * (moved.bound - size).powi(2) / k;
        moved.slip = nearest(moved.bound);
        let way = length([moved.slip[0] - start[0], moved.slip[1] - start[1]]);
        let near = (moved.bound - size).abs() <= NEAR * moved.bound;
        if size > moved.bound || near && change < moved.friction_term() + 0.5 * k * way * way {
            moved.bound = size;
            moved.change = change;
            moved.slip = nearest(size);
        }
        for j in 0..place.along().len() {
            movable.shift(v, 1 + j, moved.slip[j] - start[j]);
        }
        moved
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
    pub(crate) fn gap(mut self, point: &PointState, place: &Place, value: &[f64]) -> f64 {
        let far = |a: f64, b: f64, size: f64| (a - b).abs() > ROUNDING * size;
        let size = value.iter().map(|v| v.abs()).fold(0.0, f64::max);
        let open = place.depth(value);
        if far(open, self.open, size + place.offset.abs()) {
            self.open = open;
        }
        for (j, (direction, offset)) in place.along().iter().enumerate() {
            let slip = dot(direction, value) - offset;
            if far(slip, self.slip[j], size + offset.abs()) {
                self.slip[j] = slip;
            }
        }
        (point.normal_force * self.open).abs() + self.friction_term()
    }

    /// `r |w| + lambda_T . w`, without the cancellation of a sliding node.
    fn friction_term(&self) -> f64 {
        let ([a, b], [x, y]) = (self.force, self.slip);
        let (size, way, work) = (length(self.force), length(self.slip), a * x + b * y);
        let angle = if work < 0.0 {
            (a * y - b * x).powi(2) / (size * way - work)
        } else {
            size * way + work
        };
        (self.bound - size).max(0.0) * way + angle
    }
}

/// How both nodes move for each of so many rows, as little as possible; `None` if nothing makes the rows independent.
fn shifts(own: &Side, still: &Side, rows: usize) -> Option<Box<Shifts>> {
    let matrix = DMatrix::from_fn(rows, 6, |k, c| {
        if c < 3 {
            own.direction(k)[c]
        } else {
            still.direction(k)[c - 3]
        }
    });
    let inverse = matrix.pseudo_inverse(HELD).ok()?;
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
