//! Rigid obstacles of any shape, as signed distances.

use super::facets::Facets;
use super::seen::Seen;
use crate::error::ContactError;
use crate::tolerances::{DISTANCE, FASTER, FEW_STEPS, NEWTON, RAY, RAY_END, SIDEWAYS, STEEP};
use signorini_fem_mesh::loads::Function;
use signorini_fem_mesh::vec3::{add, dot, norm, scale, sub};
use std::sync::Arc;

/// Of a place, the side that is free (1, or -1 for what is turned inside out), and the direction that the gradient is
/// to be opposite to where there is a choice.
type Field = dyn Fn([f64; 3], f64, Option<[f64; 3]>) -> Seen + Send + Sync;

/// A rigid obstacle of any shape: the signed distance to it, m, positive outside, and the gradient of the distance, a
/// unit vector out of the obstacle.
///
/// ```
/// use signorini_contact::Obstacle;
///
/// let ball = Obstacle::sphere([0.0, 0.0, -2.0], 1.5);
/// assert_eq!(ball.distance([0.0, 0.0, 0.0]), (0.5, [0.0, 0.0, 1.0]));
/// // the same by functions
/// let length = |x: [f64; 3]| (x[0] * x[0] + x[1] * x[1] + (x[2] + 2.0).powi(2)).sqrt();
/// let own = Obstacle::from_distance(
///     move |x| length(x) - 1.5,
///     move |x| [x[0], x[1], x[2] + 2.0].map(|c| c / length(x)),
/// );
/// assert_eq!(own.distance([3.0, 0.0, -2.0]), ball.distance([3.0, 0.0, -2.0]));
/// // a socket: the body is inside
/// assert_eq!(ball.hollow().distance([0.0, 0.0, -1.0]), (0.5, [-0.0, -0.0, -1.0]));
/// ```
#[derive(Debug, Clone)]
#[must_use]
pub struct Obstacle {
    field: Function<Field>,
    side: f64,
    /// Whether the distance is a function of the user.
    own: bool,
    /// What has to be finite and positive, with its name.
    sizes: Vec<(&'static str, f64)>,
}

impl Obstacle {
    /// Any shape: its signed distance (m, positive outside) and the gradient of that. Both are evaluated at nodes of
    /// the body, with quadratic elements also beside them. There the gradient must have length 1 to within a
    /// thousandth, and along it the distance must change by the way to within a tenth. Another function that is zero on
    /// the obstacle is none; near the obstacle its value over the length of its gradient is nearly one.
    pub fn from_distance(
        distance: impl Fn([f64; 3]) -> f64 + Send + Sync + 'static,
        gradient: impl Fn([f64; 3]) -> [f64; 3] + Send + Sync + 'static,
    ) -> Self {
        Self {
            own: true,
            ..Self::new(Vec::new(), move |x| (distance(x), gradient(x)))
        }
    }

    /// The half-space below a plane: `point` lies on the plane, `outward` points out of the obstacle.
    pub fn half_space(point: [f64; 3], outward: [f64; 3]) -> Self {
        let length = norm(outward);
        let unit = outward.map(|c| c / length);
        Self::new(
            vec![("length of the outward normal of an obstacle", length)],
            move |x| (dot(sub(x, point), unit), unit),
        )
    }

    /// A ball; its radius in m.
    pub fn sphere(centre: [f64; 3], radius: f64) -> Self {
        Self::new(vec![("radius of an obstacle", radius)], move |x| {
            from_core(sub(x, centre), radius)
        })
    }

    /// An endless cylinder about an axis through `point`; its radius in m.
    pub fn cylinder(point: [f64; 3], axis: [f64; 3], radius: f64) -> Self {
        let length = norm(axis);
        let unit = axis.map(|c| c / length);
        let sizes = vec![
            ("radius of an obstacle", radius),
            ("length of the axis of an obstacle", length),
        ];
        Self::new(sizes, move |x| {
            let arm = sub(x, point);
            from_core(sub(arm, scale(dot(arm, unit), unit)), radius)
        })
    }

    /// A triangulated surface, closed or open: its nodes, m, and triangles whose nodes are counter-clockwise seen from
    /// outside. Coincident nodes are merged. A tree finds the nearest point; beyond the rim of an open surface nothing
    /// is inside.
    ///
    /// # Errors
    /// [`ContactError::ObstacleFacet`] for triangles without area or with unknown nodes, if there is none, and for
    /// neighbours with inconsistent orientation.
    pub fn surface(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Result<Self, ContactError> {
        let facets = Facets::new(points, triangles)?;
        Ok(Self {
            field: Function(Arc::new(move |x, side, against| facets.distance(x, side, against))),
            side: 1.0,
            own: false,
            sizes: Vec::new(),
        })
    }

    /// Turns the obstacle inside out: a ball becomes a socket, a cylinder a bore.
    pub fn hollow(self) -> Self {
        Self {
            side: -self.side,
            ..self
        }
    }

    fn new(
        sizes: Vec<(&'static str, f64)>,
        field: impl Fn([f64; 3]) -> (f64, [f64; 3]) + Send + Sync + 'static,
    ) -> Self {
        let turned = move |x, side, _| {
            let (distance, gradient): (f64, [f64; 3]) = field(x);
            Seen::new(side * distance, gradient.map(|c| side * c))
        };
        Self {
            field: Function(Arc::new(turned) as Arc<Field>),
            side: 1.0,
            own: false,
            sizes,
        }
    }

    /// The signed distance of a place, m, and its gradient.
    pub fn distance(&self, place: [f64; 3]) -> (f64, [f64; 3]) {
        let seen = (self.field)(place, self.side, None);
        (seen.distance, seen.gradient)
    }

    /// The same; on edges and corners of surfaces, and beyond sharp ones and the rim, with the gradient that is most
    /// opposite to a direction.
    pub(crate) fn see(&self, place: [f64; 3], against: [f64; 3]) -> Seen {
        let seen = (self.field)(place, self.side, Some(against));
        let along = -dot(seen.gradient, against);
        let level = match self.own && seen.distance > 0.0 && along < SIDEWAYS {
            // a function does not tell where a side ends
            true => seen.distance * along.max(0.0),
            false => seen.level,
        };
        Seen { level, ..seen }
    }

    /// Whether its distance is a function of the user.
    pub(crate) fn is_own(&self) -> bool {
        self.own
    }

    /// How much a distance given by a function changes along its gradient, over a way; one side of the place is enough.
    /// `None` where that is next to 1 or nothing is known, and where steps along it end on the obstacle ever faster, as
    /// those of a function over the length of its gradient do (Newton's method).
    pub(crate) fn steep(&self, place: [f64; 3], (distance, gradient): (f64, [f64; 3]), way: f64) -> Option<f64> {
        if !distance.is_finite() {
            return None;
        }
        let slope = |way: f64| (self.distance(add(place, scale(way, gradient))).0 - distance) / way;
        let is_good = |slope: &f64| (slope - 1.0).abs() <= DISTANCE;
        let slopes = [way, -way].map(slope);
        let step = |&(place, (d, g)): &([f64; 3], (f64, [f64; 3]))| {
            let foot = add(place, scale(-d, g));
            Some((foot, self.distance(foot)))
        };
        let ends = || {
            let steps = std::iter::successors(Some((place, (distance, gradient))), step);
            let left: Vec<f64> = steps.take(FEW_STEPS).map(|(_, (d, _))| d.abs()).collect();
            left.windows(3).any(|d| d[2] * d[0] < FASTER * d[1] * d[1])
        };
        (!slopes.iter().any(is_good) && !ends()).then_some(slopes[0])
    }

    /// The way along a direction from a place to the obstacle, m, negative inside. Where that direction does not lead
    /// there the way to the continuation of a side that has ended before, or the shortest distance.
    pub(super) fn along(&self, place: [f64; 3], direction: [f64; 3]) -> f64 {
        self.reach(place, direction).unwrap_or_else(|start| {
            let seen = self.see(place, direction);
            let along = -dot(seen.gradient, direction);
            let continues = seen.ends && along > STEEP;
            if continues { seen.level / along } else { start }
        })
    }

    /// The way along a direction to the obstacle, or the shortest distance where it does not lead there.
    pub(super) fn reach(&self, place: [f64; 3], direction: [f64; 3]) -> Result<f64, f64> {
        let (start, _) = self.distance(place);
        // what was left at least, and the way there
        let (mut way, mut best) = (0.0, (f64::INFINITY, 0.0));
        for _ in 0..NEWTON {
            let (distance, gradient) = self.distance(add(place, scale(way, direction)));
            let slope = -dot(gradient, direction);
            if slope.is_nan() || slope < STEEP {
                return Err(start);
            }
            let left = distance.abs();
            if left < best.0 {
                best = (left, way);
            } else if best.0 <= RAY * (norm(place) + way.abs()) {
                // rounding of coordinates
                break;
            }
            way += distance / slope;
            if left <= RAY * (start.abs() + way.abs()) {
                return Ok(way);
            }
        }
        let ends = best.0 <= RAY_END * start.abs();
        ends.then_some(best.1).ok_or(start)
    }

    /// A size that is not finite and positive.
    pub(super) fn flaw(&self) -> Option<(&'static str, f64)> {
        let flaw = |(_, value): &&(&str, f64)| !(value.is_finite() && *value > 0.0);
        self.sizes.iter().find(flaw).copied()
    }
}

/// Distance and gradient at the end of an arm from a point or an axis with so much around it. In the middle there is
/// no gradient: it is not a number there.
fn from_core(arm: [f64; 3], radius: f64) -> (f64, [f64; 3]) {
    let length = norm(arm);
    (length - radius, arm.map(|c| c / length))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Far from the origin the rounding of coordinates is more than that of a small gap.
    #[test]
    fn small_gaps_are_measured_along_the_direction_anywhere() {
        let (centre, radius) = ([60.0, 40.0, 100.0], 10.0);
        let ball = Obstacle::sphere(centre, radius);
        let unit = [0.48, 0.64, -0.6];
        let plane = Obstacle::half_space([10.0, 20.0, 30.0], [-0.6, 0.0, 0.8]);
        for gap in [1e-2, 1e-4, 1e-6, -1e-6, -1e-4] {
            for k in 0..200 {
                let angle = 0.01 * f64::from(k);
                let out = [0.6 * angle.cos(), 0.6 * angle.sin(), 0.8];
                let place = add(centre, scale(radius + gap, out));
                // the root of a square, without cancellation
                let (arm, direction) = (sub(place, centre), scale(-1.0, out));
                let direction = scale(
                    1.0 / norm(add(direction, scale(0.3, unit))),
                    add(direction, scale(0.3, unit)),
                );
                let (b, c) = (dot(arm, direction), gap * (2.0 * radius + gap));
                let exact = c / (-b + (b * b - c).sqrt());
                let way = ball.along(place, direction);
                assert!(
                    (way - exact).abs() <= 1e-12 * norm(place),
                    "ball, {gap}, {k}: {way:e} {exact:e}"
                );
                // down, at an angle whose cosine is 0.8
                let place = [10.0 + angle, 20.0 - angle, 30.0 + 0.75 * angle + 1.25 * gap];
                let way = plane.along(place, [0.0, 0.0, -1.0]);
                assert!(
                    (way - 1.25 * gap).abs() <= 1e-12 * norm(place),
                    "plane, {gap}, {k}: {way:e}"
                );
            }
        }
    }
}
