//! How an obstacle moves: it is displaced, and turns about an axis that goes along.

use signorini_fem_mesh::History;
use signorini_fem_mesh::vec3::{add, cross, dot, scale, sub, unit};

/// A turn of an obstacle about an axis.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Rotation {
    /// A point of the axis, m.
    pub(crate) point: [f64; 3],
    /// Direction of the axis, of any length.
    pub(crate) axis: [f64; 3],
    /// Angle in radians, right-handed about the axis.
    pub(crate) angle: History,
}

/// Where an obstacle is at a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pose {
    /// Its displacement, m; with a turn that of its axis.
    shift: [f64; 3],
    turn: Option<Turn>,
    /// Factor of the gap.
    pub(crate) factor: f64,
}

impl Default for Pose {
    /// At rest.
    fn default() -> Self {
        Self::shifted([0.0; 3])
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Turn {
    point: [f64; 3],
    /// Unit vector.
    axis: [f64; 3],
    angle: f64,
    /// Integral of the displacement over the angle, m.
    swept: [f64; 3],
}

impl Pose {
    pub(crate) fn shifted(shift: [f64; 3]) -> Self {
        Self {
            shift,
            turn: None,
            factor: 1.0,
        }
    }

    /// The poses of an obstacle that has displacements and angles (rad) at a sequence of times. Between two of them the
    /// displacement is the mean of both.
    pub(super) fn turning(rotation: &Rotation, ways: impl Iterator<Item = ([f64; 3], f64)>) -> Vec<Self> {
        let axis = unit(rotation.axis);
        let (mut before, mut swept) = (([0.0; 3], 0.0), [0.0; 3]);
        let pose = |(shift, angle)| {
            swept = add(swept, scale(0.5 * (angle - before.1), add(shift, before.0)));
            before = (shift, angle);
            let point = rotation.point;
            Self {
                shift,
                turn: Some(Turn {
                    point,
                    axis,
                    angle,
                    swept,
                }),
                factor: 1.0,
            }
        };
        ways.map(pose).collect()
    }

    /// What of a whole gap along a normal it brings to a place, m, with its factor: without what it opens.
    pub(crate) fn brings(&self, whole: f64, place: &[f64; 3], normal: &[f64; 3]) -> f64 {
        let whole = whole + (self.factor - 1.0) * (whole - dot(self.way(place), *normal));
        whole - dot(self.drag(place), *normal)
    }

    /// Whether it is turned.
    pub(crate) fn turns(&self) -> bool {
        self.turn.is_some()
    }

    /// The way of the obstacle past a place since the start, m: the integral of its velocity there.
    pub(crate) fn drag(&self, place: &[f64; 3]) -> [f64; 3] {
        match &self.turn {
            None => self.shift,
            Some(turn) => {
                let arm = scale(turn.angle, sub(*place, turn.point));
                add(self.shift, cross(turn.axis, sub(arm, turn.swept)))
            }
        }
    }

    /// To first order in the angle: the displacement of the obstacle at a place, m.
    pub(crate) fn small(&self, place: &[f64; 3]) -> [f64; 3] {
        match &self.turn {
            None => self.shift,
            Some(turn) => {
                let arm = sub(sub(*place, turn.point), self.shift);
                add(self.shift, scale(turn.angle, cross(turn.axis, arm)))
            }
        }
    }

    /// Where the part of the obstacle that is at a place now was at the start, m.
    pub(crate) fn origin(&self, place: &[f64; 3]) -> [f64; 3] {
        let place = sub(*place, self.shift);
        match &self.turn {
            None => place,
            Some(turn) => add(turn.point, self.back(&sub(place, turn.point))),
        }
    }

    /// The displacement of that part, m.
    pub(crate) fn way(&self, place: &[f64; 3]) -> [f64; 3] {
        match &self.turn {
            None => self.shift,
            Some(_) => sub(*place, self.origin(place)),
        }
    }

    /// A direction as it was at the start.
    pub(crate) fn back(&self, direction: &[f64; 3]) -> [f64; 3] {
        self.rotated(direction, -1.0)
    }

    /// A direction of the start as it is now.
    pub(crate) fn forth(&self, direction: &[f64; 3]) -> [f64; 3] {
        self.rotated(direction, 1.0)
    }

    fn rotated(&self, v: &[f64; 3], sign: f64) -> [f64; 3] {
        let Some(turn) = &self.turn else {
            return *v;
        };
        let (sin, cos) = (sign * turn.angle).sin_cos();
        let along = scale((1.0 - cos) * dot(turn.axis, *v), turn.axis);
        add(add(scale(cos, *v), scale(sin, cross(turn.axis, *v))), along)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use signorini_fem_mesh::vec3::norm;

    /// A wheel that rolls: where it touches the ground nothing slides, and its hub returns to the same hub.
    #[test]
    fn a_wheel_that_rolls_does_not_drag() {
        let (radius, steps) = (0.5, 40);
        let wheel = Rotation {
            point: [0.0, 0.0, radius],
            axis: [0.0, 3.0, 0.0],
            angle: History::constant(0.0),
        };
        // three radians in forty steps
        let ways = (1..=steps).map(|k| 3.0 * f64::from(k) / f64::from(steps));
        let poses = Pose::turning(&wheel, ways.map(|a| ([a * radius, 0.0, 0.0], a)));
        let mut before = Pose::default();
        for (k, pose) in poses.iter().enumerate() {
            let contact = [pose.shift[0], 0.0, 0.0];
            let middle = scale(0.5, add(contact, [before.shift[0], 0.0, 0.0]));
            let slip = sub(pose.drag(&middle), before.drag(&middle));
            assert!(norm(slip) < 1e-14, "step {k}: {slip:?}");
            let hub = add(wheel.point, pose.shift);
            assert!(norm(sub(pose.origin(&hub), wheel.point)) < 1e-15);
            let spoke = [0.3, 0.1, -0.4];
            assert!(norm(sub(pose.back(&pose.forth(&spoke)), spoke)) < 1e-15);
            before = *pose;
        }
        // after three radians the spoke at the ground has gone by
        let last = poses.last().expect("poses").origin(&[1.5, 0.0, 0.0]);
        let expected = [radius * 3f64.sin(), 0.0, radius - radius * 3f64.cos()];
        assert!(norm(sub(last, expected)) < 1e-14, "{last:?}");
    }

    #[test]
    fn small_turns_are_linear() {
        let lever = Rotation {
            point: [1.0, 2.0, 3.0],
            axis: [1.0, 1.0, 0.0],
            angle: History::constant(0.0),
        };
        let place = [4.0, -1.0, 0.5];
        let poses = Pose::turning(&lever, [([1e-5, 0.0, -2e-5], 1e-5)].into_iter());
        let [pose] = poses[..] else { panic!("one") };
        for other in [pose.drag(&place), pose.way(&place)] {
            assert!(norm(sub(pose.small(&place), other)) < 1e-8 * norm(other) / 1e-5);
        }
    }
}
