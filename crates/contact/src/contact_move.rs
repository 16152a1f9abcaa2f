//! The best admissible position of one contact node, and its share of the duality gap; see the [algebraic
//! error](crate::AlgebraicError).

use crate::frame::PointState;
use crate::level::Level;
use crate::model::TouchPoint;
use signorini_tfeti::Gluing;

/// Rounding of directions.
const SAME: f64 = 1e-12;

/// Rounding of differences of positions, relative.
const ROUNDING: f64 = 1e-12;

/// Relative change of a slip bound that is judged by the stiffness of the node. Larger ones move the whole body, and the
/// gap, which overrates small changes, is the safer measure.
const NEAR: f64 = 0.01;

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
    /// Moves a node such that the gap is smallest with all other nodes held; `rows` are stiffnesses of rows in N/m, `normal`
    /// is the [movable](movable_normal) one.
    pub(crate) fn new(
        level: &Level,
        touch: &TouchPoint,
        point: &PointState,
        normal: &[f64; 3],
        rows: &[f64],
        value: &mut [f64],
    ) -> Self {
        let k = touch.scale.powi(2) * rows[touch.row];
        let open = normal_offset(level, touch, normal, value);
        let target = (open - point.normal_force / k).min(0.0);
        // along the movable part, so that supports stay where they are
        shift(value, normal, (target - open) / dot(normal, normal));
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
        for (j, (direction, row, scale)) in touch.along().enumerate() {
            start[j] = dot(&direction, value) - level.offset[row] / scale;
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
        for (j, (direction, ..)) in touch.along().enumerate() {
            shift(value, &direction, moved.slip[j] - start[j]);
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
    pub(crate) fn gap(
        mut self,
        level: &Level,
        touch: &TouchPoint,
        point: &PointState,
        normal: &[f64; 3],
        value: &[f64],
    ) -> f64 {
        let far = |a: f64, b: f64, size: f64| (a - b).abs() > ROUNDING * size;
        let size = value.iter().map(|v| v.abs()).fold(0.0, f64::max);
        let offset = level.offset[touch.row] / touch.scale;
        let open = normal_offset(level, touch, normal, value);
        if far(open, self.open, size + offset.abs()) {
            self.open = open;
        }
        for (j, (direction, row, scale)) in touch.along().enumerate() {
            let offset = level.offset[row] / scale;
            let slip = dot(&direction, value) - offset;
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

fn length(w: [f64; 2]) -> f64 {
    w[0].hypot(w[1])
}

fn shift(value: &mut [f64], direction: &[f64; 3], by: f64) {
    for c in 0..3 {
        value[c] += by * direction[c];
    }
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Moves a node out of the obstacle of a point, if it is inside.
pub(crate) fn push_out(level: &Level, touch: &TouchPoint, normal: &[f64; 3], value: &mut [f64]) {
    let depth = normal_offset(level, touch, normal, value).max(0.0);
    shift(value, normal, -depth / dot(normal, normal));
}

/// `v_nu - g`, m. The offset of the row has the motion that supports prescribe along the normal already, so that
/// only the movable part of the normal counts.
fn normal_offset(level: &Level, touch: &TouchPoint, normal: &[f64; 3], value: &[f64]) -> f64 {
    dot(normal, value) - level.offset[touch.row] / touch.scale
}

/// The normal without its parts along directions that supports fix: what the row of the point measures and moves. The
/// normal itself where nothing is fixed.
pub(crate) fn movable_normal(gluing: &Gluing, touch: &TouchPoint) -> [f64; 3] {
    let mut movable = [0.0; 3];
    for (_, dof, coefficient) in gluing.row(touch.row) {
        movable[dof % 3] += coefficient / touch.scale;
    }
    let normal = touch.frame.normal;
    let same = (0..3).all(|c| (movable[c] - normal[c]).abs() <= SAME);
    if same { normal } else { movable }
}
