//! The cone of the wrenches that contact forces can exert on rigid motions, and the closest point in it.
//!
//! Least squares with non-negative coefficients (Lawson and Hanson) over the generators `n + F (t1 cos + t2 sin)` of
//! all points and angles: each round takes in the generator that helps most; those in use are hardly more than the
//! motions.
//!
//! Tresca friction adds forces that are bounded whatever the pressure: a set of points `z` around the cone. Whether
//! loads lie in the sum of both is asked by going towards them in steps (Frank and Wolfe, as far as the distance
//! falls): the residual of `b - z` separates `b` if `b` works more on it than all friction can.

use super::positive_factors::improve;
use crate::tolerances::{FRICTION_FACTOR, LEVERAGE, MOST_FRICTION, SLIDES, SLIDING, TRESCA_EXCESS, WRENCH_RESIDUAL};
use crate::vec3::{dot, norm};
use signorini_qp::vector;

/// Force directions of one contact point, as work on the motions.
#[derive(Debug, Clone)]
pub(crate) struct Generators {
    /// Of a pressing force of 1 N.
    pub(crate) normal: Vec<f64>,
    /// Of friction forces of 1 N along each tangent.
    pub(crate) tangents: Vec<Vec<f64>>,
    /// Largest friction over pressure; `None` if friction has no known bound.
    pub(crate) coefficient: Option<f64>,
    /// Largest friction without pressure (Tresca), N.
    pub(crate) tresca: f64,
}

impl Generators {
    /// Of a point without friction.
    pub(crate) fn pressure(normal: Vec<f64>) -> Self {
        Self {
            normal,
            tangents: Vec::new(),
            coefficient: Some(0.0),
            tresca: 0.0,
        }
    }

    /// The work of a friction force of 1 N along a motion, at most.
    fn friction_work(&self, motion: &[f64]) -> f64 {
        norm(&self.along(motion))
    }

    /// Adds the friction force of this size that works most on a motion, as work on the motions.
    fn add_friction(&self, size: f64, motion: &[f64], out: &mut [f64]) {
        let along = self.along(motion);
        let length = norm(&along);
        if length > 0.0 {
            for (t, a) in self.tangents.iter().zip(&along) {
                vector::axpy(size * a / length, t, out);
            }
        }
    }

    fn along(&self, motion: &[f64]) -> Vec<f64> {
        self.tangents.iter().map(|t| dot(t, motion)).collect()
    }
}

/// A motion along which loads push more than contact can take.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Separation {
    /// The motion, of length one.
    pub(crate) motion: Vec<f64>,
    /// What Tresca friction takes along it, N.
    pub(crate) tresca: f64,
}

/// Where loads are.
enum Found {
    /// In the cone.
    Inside,
    /// Outside, with a motion that separates them.
    Apart(Vec<f64>),
    /// Not found out.
    Open,
}

/// The cone, and the bounded set of Tresca friction around it.
#[derive(Debug)]
pub(crate) struct WrenchCone {
    generators: Vec<Generators>,
    /// Norm of the largest generator.
    largest: f64,
    /// What Tresca friction took of the last loads.
    last_friction: Vec<f64>,
}

/// Rounds before the question is left open.
const ROUNDS: usize = 500;

/// Steps towards the loads before the question is left open.
const STEPS: usize = 200;

impl WrenchCone {
    pub(crate) fn new(generators: Vec<Generators>) -> Self {
        let vectors = generators
            .iter()
            .flat_map(|g| std::iter::once(&g.normal).chain(&g.tangents));
        Self {
            largest: vectors.map(|v| norm(v)).fold(0.0, f64::max),
            generators,
            last_friction: Vec::new(),
        }
    }

    /// By more than which factor friction would have to be larger for contact to hold the loads `b`, N, that it does
    /// not hold; `None` where no friction could.
    pub(crate) fn friction_needed(&self, b: &[f64]) -> Option<f64> {
        let with = |friction: &dyn Fn(f64) -> Option<f64>, tresca: f64| {
            let changed = self.generators.iter().map(|g| Generators {
                coefficient: g.coefficient.and_then(friction),
                tresca: tresca * g.tresca,
                ..g.clone()
            });
            Self::new(changed.collect())
        };
        let cone = |factor: f64| with(&|c| Some(factor * c), factor);
        let loads = scaled(b, norm(b));
        // what topples is told at once by friction without bound, and by larger and larger one late
        if let Found::Apart(_) = with(&|c| (c == 0.0).then_some(c), 1.0).closest(&loads, true) {
            return None;
        }
        let holds = |factor: f64| cone(factor).exceeded(b).is_none();
        let (mut low, mut high) = (1.0_f64, MOST_FRICTION);
        if !holds(high) {
            return None;
        }
        while high > (1.0 + FRICTION_FACTOR) * low {
            let middle = (low * high).sqrt();
            *if holds(middle) { &mut high } else { &mut low } = middle;
        }
        // what was left open is no remedy
        let tresca = self.generators.iter().any(|g| g.tresca > 0.0);
        let held = || matches!(cone(2.0 * high).closest(&loads, false), Found::Inside);
        (tresca || held()).then_some(low)
    }

    /// A motion along which the loads push too much, of unit length, as Coulomb's friction lets it go: points slide
    /// without opening. The cone's own motions open the points that slide, by the coefficient times the slip. The
    /// motion as it is where that leaves little of it.
    pub(crate) fn sliding(&self, motion: &[f64]) -> Vec<f64> {
        // on the edge of what the cone allows: points that stick or slide, not those that open beyond their slip
        let closed = |g: &&Generators| {
            let slips = g.coefficient.unwrap_or(0.0) * g.friction_work(motion);
            (dot(&g.normal, motion) + slips).abs() <= SLIDING * norm(&g.normal)
        };
        let mut normals: Vec<Vec<f64>> = Vec::new();
        for g in self.generators.iter().filter(closed) {
            let mut normal = g.normal.clone();
            // twice, against rounding
            for known in normals.iter().chain(&normals) {
                let along = dot(known, &normal);
                vector::axpy(-along, known, &mut normal);
            }
            let left = norm(&normal);
            if left > WRENCH_RESIDUAL * norm(&g.normal) {
                normals.push(scaled(&normal, left));
            }
        }
        let mut flat = motion.to_vec();
        for normal in &normals {
            let along = dot(normal, &flat);
            vector::axpy(-along, normal, &mut flat);
        }
        match norm(&flat) {
            left if left > SLIDES => scaled(&flat, left),
            _ => motion.to_vec(),
        }
    }

    /// Whether the loads `b`, N, are out of reach of cone and Tresca friction.
    pub(crate) fn exceeded(&mut self, b: &[f64]) -> Option<Separation> {
        let size = norm(b);
        // what friction of any size cannot hold: friction much larger than the loads would take many steps to tell
        if let Found::Apart(motion) = self.closest(&scaled(b, size), true) {
            return Some(Separation { motion, tresca: 0.0 });
        }
        // loads mostly follow one another
        let mut z = std::mem::take(&mut self.last_friction);
        z.resize(b.len(), 0.0);
        let mut found = None;
        for _ in 0..STEPS {
            let rest: Vec<f64> = b.iter().zip(&z).map(|(b, z)| b - z).collect();
            let length = norm(&rest);
            if length <= TRESCA_EXCESS * size {
                break;
            }
            let Some(motion) = self.separates(&scaled(&rest, length)) else {
                break;
            };
            let mut most = vec![0.0; motion.len()];
            for g in self.generators.iter().filter(|g| g.tresca > 0.0) {
                g.add_friction(g.tresca, &motion, &mut most);
            }
            let tresca = dot(&most, &motion);
            if dot(b, &motion) > tresca + TRESCA_EXCESS * size {
                found = Some(Separation { motion, tresca });
                break;
            }
            // the residual is at right angles to the closest point of the cone
            let residual = dot(&motion, &rest);
            if residual <= TRESCA_EXCESS * size {
                break;
            }
            let way: Vec<f64> = most.iter().zip(&z).map(|(m, z)| m - z).collect();
            let share = (residual * dot(&motion, &way) / dot(&way, &way)).clamp(0.0, 1.0);
            vector::axpy(share, &way, &mut z);
        }
        self.last_friction = z;
        found
    }

    /// A unit vector on which `b` (of length 1) works and against which no force of the cone can; `None` if `b` lies
    /// in the cone, or if that remains open.
    pub(crate) fn separates(&self, b: &[f64]) -> Option<Vec<f64>> {
        match self.closest(b, false) {
            Found::Apart(motion) => Some(motion),
            Found::Inside | Found::Open => None,
        }
    }

    /// Where `b` is; with `unbounded`, Tresca friction may be as large as it likes.
    fn closest(&self, b: &[f64], unbounded: bool) -> Found {
        let mut used: Vec<Vec<f64>> = Vec::new();
        let mut factors: Vec<f64> = Vec::new();
        for _ in 0..ROUNDS {
            let mut r = b.to_vec();
            for (column, x) in used.iter().zip(&factors) {
                vector::axpy(-x, column, &mut r);
            }
            let length = norm(&r);
            if length <= WRENCH_RESIDUAL {
                return Found::Inside;
            }
            // no force, or none that helps: the residual separates, unless enormous forces could close it
            let best = self.best(&r, unbounded);
            let enough = length * length * self.largest;
            match best.filter(|(gain, _)| LEVERAGE * gain.max(0.0) > enough) {
                Some((_, column)) => used.push(column),
                None => return Found::Apart(scaled(&r, length)),
            }
            factors.push(0.0);
            if !improve(&mut used, &mut factors, b) {
                return Found::Open;
            }
        }
        Found::Open
    }

    /// The generator with the largest product with `r`; `None` if there is none.
    fn best(&self, r: &[f64], unbounded: bool) -> Option<(f64, Vec<f64>)> {
        // parts of pressure and friction of 1 N each
        let mut best: Option<(f64, &Generators, [f64; 2])> = None;
        let mut offer = |gain: f64, g, parts| {
            if best.as_ref().is_none_or(|b| gain > b.0) {
                best = Some((gain, g, parts));
            }
        };
        for g in &self.generators {
            let coefficient = g.coefficient.filter(|_| !(unbounded && g.tresca > 0.0));
            let (bound, friction) = (coefficient.unwrap_or(0.0), g.friction_work(r));
            offer(dot(&g.normal, r) + bound * friction, g, [1.0, bound]);
            if coefficient.is_none() {
                offer(friction, g, [0.0, 1.0]);
            }
        }
        best.map(|(gain, g, [pressure, friction])| {
            let mut column = vec![0.0; r.len()];
            g.add_friction(friction, r, &mut column);
            vector::axpy(pressure, &g.normal, &mut column);
            (gain, column)
        })
    }
}

fn scaled(v: &[f64], length: f64) -> Vec<f64> {
    v.iter().map(|v| v / length).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A block pushed along the floor slides on it, though the motion of the cone lifts it.
    #[test]
    fn a_block_slides_flat() {
        let cone = two_points(0.3);
        let push = scaled(&[1.0, 1.0, 0.0], 2.0_f64.sqrt());
        let found = cone.separates(&push).expect("slides");
        assert!(found[0].abs() > 0.2, "{found:?}");
        let flat = cone.sliding(&found);
        assert!(flat[0].abs() < 1e-12 && flat[2].abs() < 1e-12, "{flat:?}");
        assert!((flat[1].abs() - 1.0).abs() < 1e-12, "{flat:?}");
        // what opens for lack of a force that pulls does not slide
        let lift = cone.separates(&[1.0, 0.0, 0.0]);
        let back = cone.separates(&[-1.0, 0.0, 0.0]);
        for up in [lift, back].into_iter().flatten() {
            assert_eq!(cone.sliding(&up), up);
        }
    }

    /// Two points at x = -1 and 1 on a floor; motions: up, along the floor, rotation in the plane.
    fn two_points(coefficient: f64) -> WrenchCone {
        let point = |x: f64| Generators {
            normal: vec![1.0, 0.0, x],
            tangents: vec![vec![0.0, 1.0, 0.0]],
            coefficient: Some(coefficient),
            tresca: 0.0,
        };
        WrenchCone::new(vec![point(-1.0), point(1.0)])
    }

    #[test]
    fn tresca_friction_holds_up_to_its_bounds() {
        let mut cone = two_points(0.0);
        for g in &mut cone.generators {
            g.tresca = 5.0;
        }
        for along in [0.0, 3.0, 9.999, -9.999] {
            assert_eq!(cone.exceeded(&[7.0, along, 1.0]), None, "{along}");
        }
        for along in [10.001, -30.0] {
            let found = cone.exceeded(&[7.0, along, 1.0]).expect("exceeded");
            assert!((found.tresca - 10.0).abs() < 1e-6, "{found:?}");
            assert!((found.motion[1] - along.signum()).abs() < 1e-6, "{found:?}");
        }
        // what lifts the body off is not held by it
        assert!(cone.exceeded(&[-1.0, 0.0, 0.0]).is_some());
    }

    /// Friction a million times the loads does not hide what it cannot hold.
    #[test]
    fn huge_tresca_friction_holds_no_lift() {
        for tresca in [1.0, 1e6, 1e12] {
            let mut cone = two_points(0.0);
            for g in &mut cone.generators {
                g.tresca = tresca;
            }
            let found = cone.exceeded(&[-1.0, 0.3, 0.1]).expect("lifts off");
            assert_eq!(found.tresca, 0.0);
            assert!(found.motion[0] < -0.5 && found.motion[1].abs() < 1e-6);
            assert_eq!(cone.exceeded(&[1.0, 0.3, 0.1]), None);
        }
    }

    #[test]
    fn the_friction_needed_is_named() {
        let close = |found: Option<f64>, expected: f64| {
            let found = found.expect("friction could");
            assert!((found / expected - 1.0).abs() < 2e-4, "{found}");
        };
        close(two_points(0.3).friction_needed(&[2.0, 1.5, 0.0]), 2.5);
        let mut cone = two_points(0.0);
        cone.generators.iter_mut().for_each(|g| g.tresca = 5.0);
        close(cone.friction_needed(&[2.0, 41.0, 0.0]), 4.1);
        // lifted, tipped, or without any friction
        assert_eq!(two_points(0.3).friction_needed(&[-1.0, 0.1, 0.0]), None);
        assert_eq!(two_points(0.3).friction_needed(&[1.0, 0.1, 2.0]), None);
        assert_eq!(two_points(0.0).friction_needed(&[1.0, 0.1, 0.0]), None);
    }

    fn held(cone: &mut WrenchCone, b: [f64; 3]) -> bool {
        let length = norm(&b);
        cone.separates(&b.map(|v| v / length)).is_none()
    }

    #[test]
    fn weight_between_the_points_is_held_and_beyond_it_tips() {
        let mut cone = two_points(0.0);
        for x in [-1.0, -0.3, 0.999_999, 1.0] {
            assert!(held(&mut cone, [1.0, 0.0, x]), "{x}");
        }
        for x in [-1.001, 1.000_1, 5.0] {
            assert!(!held(&mut cone, [1.0, 0.0, x]), "{x}");
        }
        assert!(!held(&mut cone, [-1.0, 0.0, 0.0]));
    }

    /// Units of the motions change nothing.
    #[test]
    fn small_and_large_motions_are_judged_alike() {
        for scale in [1e-9, 1e-3, 1e3, 1e9] {
            let mut cone = two_points(0.3);
            for g in &mut cone.generators {
                let vectors = std::iter::once(&mut g.normal).chain(&mut g.tangents);
                vectors.flatten().for_each(|v| *v *= scale);
            }
            let mut cone = WrenchCone::new(cone.generators);
            assert!(held(&mut cone, [1.0, 0.29, 0.3]), "{scale:e}");
            assert!(!held(&mut cone, [1.0, 0.31, 0.3]), "{scale:e}");
            assert!(!held(&mut cone, [1.0, 0.0, 1.01]), "{scale:e}");
        }
    }

    #[test]
    fn friction_holds_up_to_its_cone() {
        let mut cone = two_points(0.3);
        assert!(held(&mut cone, [1.0, 0.299_999, 0.0]));
        assert!(held(&mut cone, [1.0, -0.3, 0.5]));
        assert!(!held(&mut cone, [1.0, 0.300_1, 0.0]));
    }

    #[test]
    fn unbounded_friction_is_not_judged() {
        let mut cone = two_points(0.0);
        for g in &mut cone.generators {
            g.coefficient = None;
        }
        assert!(held(&mut cone, [1.0, 100.0, 0.0]));
        assert!(!held(&mut cone, [-1.0, 0.0, 0.0]));
    }

    #[test]
    fn without_contact_points_nothing_is_held() {
        let cone = WrenchCone::new(Vec::new());
        assert_eq!(cone.separates(&[0.6, -0.8]), Some(vec![0.6, -0.8]));
    }

    #[test]
    fn round_cones_of_many_points() {
        let points = (0..40)
            .map(|k| {
                let angle = f64::from(k) * 0.157;
                let (x, y) = (angle.cos(), angle.sin());
                Generators {
                    normal: vec![0.0, 0.0, 1.0, y, -x, 0.0],
                    tangents: vec![vec![1.0, 0.0, 0.0, 0.0, 0.0, -y], vec![0.0, 1.0, 0.0, 0.0, 0.0, x]],
                    coefficient: Some(0.5),
                    tresca: 0.0,
                }
            })
            .collect();
        let cone = WrenchCone::new(points);
        for (along, expected) in [(0.49, true), (0.499_99, true), (0.500_1, false)] {
            let b = [0.6 * along, 0.8 * along, 1.0, 0.0, 0.0, 0.0];
            let length = norm(&b);
            let b = b.map(|v| v / length);
            assert_eq!(cone.separates(&b).is_none(), expected, "{along}");
        }
    }
}
