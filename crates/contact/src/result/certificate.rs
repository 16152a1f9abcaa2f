//! The certificate of a level: how far the recovered displacement and the multipliers are from all conditions,
//! in physical units. It uses no residual of any solver.
//!
//! | condition | violation | unit | relative to |
//! |---|---|---|---|
//! | equilibrium (5.26) | norm of `K u - f - Bᵀ lambda` | N | norm of the loads and of all multipliers |
//! | continuity and supports (4.23) | largest difference between glued copies, or from a support | m | largest displacement |
//! | gap (2.5) | largest penetration | m | largest displacement |
//! | sign (2.5) | largest pulling normal force | N | largest contact force |
//! | complementarity (2.5) | largest normal force times open gap | N m | largest contact force times largest displacement |
//! | cone (2.11) | largest excess of friction over the slip bound | N | largest contact force |
//! | direction (2.11) | largest norm of `r dU + abs(dU) lambda_T` | N m | largest contact force, or `r` if it is larger, times largest displacement |
//!
//! The gap is judged twice: at the contact points that have rows, and for each node of each contact against the obstacle of that
//! contact alone. So it is the scene that is judged, not what was made of it.
//!
//! Each body is measured by its own loads, forces and displacements; what is reported is the worst of all. The largest displacement is that of the body or, if it is larger, what the load of a node would do to it with all others
//! held, so that a body that does not move has a scale too.
//!
//! `r` is the slip bound of the level's own normal forces and `dU` the tangential difference `u_T - z`. The
//! direction condition covers sticking as well: where `abs(lambda_T) < r`, it vanishes only with `dU`.

use crate::model::{Model, Tangential};
use crate::state::Peak;
use crate::step::StepProblem;
use crate::tolerances::{REST, ROUNDED};
use signorini_qp::vector;

/// A violation and the quantity it is relative to, in the same unit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Violation {
    /// How large the violation is.
    pub value: f64,
    /// What it is to be compared with.
    pub reference: f64,
}

impl Violation {
    /// `value / reference`; 0 if nothing is violated.
    #[must_use]
    pub fn relative(&self) -> f64 {
        if self.value == 0.0 {
            0.0
        } else {
            self.value / self.reference
        }
    }

    /// Takes another violation of the same condition in its place if that is relatively larger, or not a number.
    fn worsen(&mut self, value: f64, reference: f64) {
        let other = Self { value, reference };
        if is_worse(other.relative(), self.relative()) {
            *self = other;
        }
    }
}

/// Violations of all conditions at the end of a level.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct Certificate {
    /// Equilibrium of every subdomain, N.
    pub equilibrium: Violation,
    /// Gluing and supports, m.
    pub continuity: Violation,
    /// Penetration, m.
    pub gap: Violation,
    /// Pulling normal forces, N.
    pub sign: Violation,
    /// Normal force across an open gap, N m.
    pub complementarity: Violation,
    /// Friction above the slip bound, N.
    pub cone: Violation,
    /// Friction not opposite to the slip, or slip below the bound, N m.
    pub direction: Violation,
}

impl Certificate {
    /// The largest relative violation; not a number if one is none.
    #[must_use]
    pub fn largest(&self) -> f64 {
        worst(self.parts().iter().map(|(_, v)| v.relative()))
    }

    /// Name and violation of every condition.
    #[must_use]
    pub fn parts(&self) -> [(&'static str, Violation); 7] {
        [
            ("equilibrium", self.equilibrium),
            ("continuity", self.continuity),
            ("gap", self.gap),
            ("sign", self.sign),
            ("complementarity", self.complementarity),
            ("cone", self.cone),
            ("direction", self.direction),
        ]
    }
}

/// Whether a violation is larger than another one; what is not a number is worse than all that are.
fn is_worse(new: f64, old: f64) -> bool {
    new > old || new.is_nan() && !old.is_nan()
}

/// Largest relative violation of the contact conditions; not a number if one is none.
pub(crate) fn contact_violation(certificate: &Certificate) -> f64 {
    let c = certificate;
    let parts = [c.gap, c.sign, c.complementarity, c.cone, c.direction];
    worst(parts.iter().map(Violation::relative))
}

/// The largest violation, at least 0; `f64::max` would hide what is not a number.
fn worst(violations: impl IntoIterator<Item = f64>) -> f64 {
    let larger = |old, new| if is_worse(new, old) { new } else { old };
    violations.into_iter().fold(0.0, larger)
}

/// Displacements of rows, in metres, from the recovered torn displacement.
pub(crate) struct Measured<'a> {
    /// `B u` in row units.
    pub(crate) rows: &'a [f64],
    /// Torn displacement.
    pub(crate) u: &'a [f64],
    /// Torn load, N.
    pub(crate) force: &'a [f64],
    /// `K u - f - Bᵀ lambda`, N.
    pub(crate) residual: &'a [f64],
}

/// Part of all forces that a vanishing contact force is measured against.
const SMALL_PART: f64 = 1e-4;

/// What the violations of one body are measured against.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Sizes {
    /// Displacement, m.
    displacement: f64,
    /// Contact force at a node, N.
    contact_force: f64,
    /// Norm of the loads and of the contact forces, then of all multipliers, too, N.
    forces: f64,
    /// Norm of the multipliers, N.
    multipliers: f64,
    /// Norm of the residual of the equilibrium, N.
    residual: f64,
    /// Norm of the displacements times the stiffness of their nodes, N.
    stiff: f64,
}

impl Sizes {
    /// What later levels of the body remember.
    pub(crate) fn peak(&self) -> Peak {
        Peak {
            multipliers: self.multipliers,
            force: self.contact_force,
            displacement: self.displacement,
        }
    }
}

/// Sizes of every body.
pub(crate) fn sizes(
    model: &Model,
    level: &StepProblem,
    lambda: &[f64],
    m: &Measured<'_>,
) -> Vec<Sizes> {
    let bodies = &model.bodies;
    let mut out = vec![Sizes::default(); bodies.count().max(1)];
    // where nothing moves, what its load would do to a single node is the scale
    let copies = model.copies();
    for subdomain in 0..model.tfeti.subdomains() {
        let own = &mut out[bodies.of_subdomain(subdomain)];
        let range = model.tfeti.torn_range(subdomain);
        for (k, f) in m.force[range.clone()].chunks_exact(3).enumerate() {
            let alone = vector::max_abs(f) / copies.weight(range.start / 3 + k);
            own.displacement = own.displacement.max(alone);
        }
        for (k, u) in m.u[range.clone()].chunks_exact(3).enumerate() {
            let stiffness = copies.weight(range.start / 3 + k);
            own.stiff += stiffness * stiffness * vector::dot(u, u);
        }
        own.displacement = own.displacement.max(vector::max_abs(&m.u[range.clone()]));
        own.residual += vector::dot(&m.residual[range.clone()], &m.residual[range.clone()]);
        own.forces += vector::dot(&m.force[range.clone()], &m.force[range]);
    }
    for point in &model.points {
        let mut sum = (point.scale * lambda[point.row]).powi(2);
        if let Some((row, count, scale)) = point.tangential.rows() {
            let rows = lambda[row..row + count].iter();
            sum += rows.map(|v| (scale * v).powi(2)).sum::<f64>();
        }
        let own = &mut out[bodies.of_row(point.row)];
        own.contact_force = own.contact_force.max(sum.sqrt());
        own.forces += sum;
    }
    // gluing forces and reactions: what displacements alone cause has no loads
    let contact = model.tfeti.gluing().ranges().contact().end;
    let mut inner = vec![0.0; out.len()];
    bodies.add_squares(lambda, contact..lambda.len(), &mut inner);
    let mut all = inner.clone();
    bodies.add_squares(lambda, 0..contact, &mut all);
    for (body, own) in out.iter_mut().enumerate() {
        let peak = level.peaks.get(body).copied().unwrap_or_default();
        own.multipliers = all[body].sqrt();
        own.residual = own.residual.sqrt();
        own.displacement = own.displacement.max(REST * peak.displacement);
        // likewise where no force acts, or next to none on the contact surface
        // and where displacements leave nothing of a force but rounding errors
        let rounding = ROUNDED * own.stiff.sqrt();
        let outer = own.forces.sqrt().max(REST * peak.multipliers).max(rounding);
        own.contact_force = own
            .contact_force
            .max(REST * peak.force)
            .max(rounding)
            .max(SMALL_PART * outer);
        own.forces = outer.hypot(inner[body].sqrt());
    }
    out
}

pub(crate) fn certify(
    model: &Model,
    level: &StepProblem,
    lambda: &[f64],
    m: &Measured<'_>,
    sizes: &[Sizes],
) -> Certificate {
    let ranges = model.tfeti.gluing().ranges();
    // without violation, the largest sizes
    let none = |size: fn(&Sizes) -> f64| Violation {
        value: 0.0,
        reference: sizes.iter().map(size).fold(0.0, f64::max),
    };
    let (length, force) = (none(|s| s.displacement), none(|s| s.contact_force));
    let work = none(|s| s.contact_force * s.displacement);
    let mut c = Certificate {
        equilibrium: none(|s| s.forces),
        continuity: length,
        gap: length,
        sign: force,
        complementarity: work,
        cone: force,
        direction: work,
    };
    for own in sizes {
        c.equilibrium.worsen(own.residual, own.forces);
    }
    for row in ranges.interface.start..ranges.total() {
        let own = &sizes[model.bodies.of_row(row)];
        let jump = (m.rows[row] - level.offset[row]).abs();
        c.continuity.worsen(jump, own.displacement);
    }
    for (k, point) in model.points.iter().enumerate() {
        let own = &sizes[model.bodies.of_row(point.row)];
        let (contact_force, displacement) = (own.contact_force, own.displacement);
        let open = (level.offset[point.row] - m.rows[point.row]) / point.scale;
        let force = point.scale * lambda[point.row];
        c.gap.worsen(-open, displacement);
        c.sign.worsen(force, contact_force);
        let product = (force * open.max(0.0)).abs();
        c.complementarity
            .worsen(product, contact_force * displacement);
        let Some((row, count, scale)) = point.tangential.rows() else {
            continue;
        };
        let Some(bound) = slip_bound(model, level, k, lambda) else {
            continue;
        };
        let mut slip = [0.0; 2];
        let mut friction = [0.0; 2];
        for j in 0..count {
            slip[j] = (m.rows[row + j] - level.offset[row + j]) / scale;
            friction[j] = scale * lambda[row + j];
        }
        let (length, size) = (slip[0].hypot(slip[1]), friction[0].hypot(friction[1]));
        c.cone.worsen(size - bound, contact_force);
        let off = [
            bound * slip[0] + length * friction[0],
            bound * slip[1] + length * friction[1],
        ];
        // a bound above all forces says that the point sticks: only its displacement counts
        c.direction.worsen(
            off[0].hypot(off[1]),
            contact_force.max(bound) * displacement,
        );
    }
    judge(model, level, m.u, sizes, &mut c.gap);
    c
}

/// Penetration of the obstacles that the scene names, whatever points were made of them: gaps and normals of each contact by itself,
/// and mean displacements of its nodes.
fn judge(model: &Model, level: &StepProblem, u: &[f64], sizes: &[Sizes], gap: &mut Violation) {
    let (tfeti, scene) = (&model.tfeti, &model.scene);
    let weights = tfeti.copy_stiffness();
    let along = |node: u32, normal: &[f64; 3]| {
        let (mut sum, mut weight) = (0.0, 0.0);
        for copy in model.decomposition.copies(node as usize) {
            let first = tfeti.torn_range(copy.subdomain as usize).start;
            let at = first + 3 * copy.local as usize;
            let own = weights.weight(at / 3);
            sum += own * vector::dot(&u[at..at + 3], normal);
            weight += own;
        }
        sum / weight
    };
    for condition in &model.judged {
        let normal = &condition.frame.normal;
        let way = level.obstacles[0].get(condition.surface);
        let open = condition.gap_after(scene, way.unwrap_or(&[0.0; 3]));
        // no gap at all is no gap that holds
        let open = open.unwrap_or(f64::NAN) + model.found.rounding;
        let partner = condition.partner.map_or(0.0, |node| along(node, normal));
        let depth = along(condition.node, normal) - partner - open;
        let copies = model.decomposition.copies(condition.node as usize);
        let body = copies
            .first()
            .map_or(0, |c| model.bodies.of_subdomain(c.subdomain as usize));
        gap.worsen(depth, sizes[body].displacement);
    }
}

/// Slip bound of a point in newtons, from the level's own normal forces.
pub(crate) fn slip_bound(
    model: &Model,
    level: &StepProblem,
    k: usize,
    lambda: &[f64],
) -> Option<f64> {
    let point = &model.points[k];
    if point.tangential == Tangential::None {
        return None;
    }
    Some(level.bound(k, point, lambda))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Friction;
    use crate::Settings;
    use crate::State;
    use crate::step::example::{block, first_level};
    use crate::{Analysis, Contact, Scene, Support};
    use signorini_fem_mesh::{Brick, History, Hooke, Materials, brick};

    /// The gap of a certificate where all nodes are displaced alike, and the points of the model say nothing.
    fn judged(scene: Scene, displacement: [f64; 3]) -> Violation {
        let mut model = Model::new(scene, &Settings::default()).expect("model");
        model.points.clear();
        let mut level = StepProblem::default();
        level.prepare(&model, &State::default(), 0).expect("level");
        let u = displacement.repeat(model.tfeti.torn_dim() / 3);
        let (zero, lambda) = (vec![0.0; u.len()], vec![0.0; model.tfeti.dual_dim()]);
        let measured = Measured {
            rows: &lambda,
            u: &u,
            force: &zero,
            residual: &zero,
        };
        let sizes = sizes(&model, &level, &lambda, &measured);
        certify(&model, &level, &lambda, &measured, &sizes).gap
    }

    fn cube() -> Scene {
        let mesh = Brick::new([1.0; 3], [2, 2, 2]).build().expect("mesh");
        let material = Hooke::isotropic(1e6, 0.3).expect("Hooke");
        Scene::new(mesh, Materials::uniform(material)).with_boxes([2, 1, 1])
    }

    fn close(found: Violation, depth: f64, size: f64) {
        assert!(
            (found.value - depth).abs() < 1e-9 && found.reference == size,
            "{found:?}"
        );
    }

    #[test]
    fn the_obstacles_of_the_scene_are_judged_whatever_points_there_are() {
        let floor = Contact::rigid(brick::Z_MIN).with_gap(0.1);
        let wall = Contact::rigid(brick::X_MAX).with_gap(0.3);
        let scene = cube().with_contact(floor.clone()).with_contact(wall);
        close(judged(scene.clone(), [0.2, 0.0, -0.25]), 0.15, 0.25);
        close(judged(scene.clone(), [0.5, 0.0, -0.25]), 0.2, 0.5);
        assert_eq!(judged(scene, [-1.0, 0.0, -0.1]).value, 0.0);
        // on one side the nearer one, though one point stands for both
        let both = cube()
            .with_contact(floor.clone())
            .with_contact(floor.clone().with_gap(0.05));
        close(judged(both, [0.0, 0.0, -0.25]), 0.2, 0.25);
        // nodes that supports hold are judged before anything is solved
        let held = cube()
            .with_contact(floor)
            .with_support(Support::fixed(brick::Z_MIN));
        assert_eq!(judged(held, [0.0, 0.0, -0.25]).value, 0.0);
    }

    #[test]
    fn obstacles_are_judged_where_they_have_moved() {
        let ramp = History::ramp(1.0, 1.0).expect("ramp");
        let moving = Contact::rigid(brick::Z_MIN)
            .with_gap_field(|x| 0.1 * x[0])
            .with_motion([1.0, 0.0, 0.05], ramp);
        let scene = cube()
            .with_contact(moving)
            .with_analysis(Analysis::quasistatic(1.0, 1));
        // at x = 0 the gap is now -0.1 - 0.05
        close(judged(scene, [0.0, 0.0, -0.25]), 0.4, 0.25);
    }

    /// Each condition, violated alone by a known amount, is found with that amount, and no other one.
    #[test]
    fn each_condition_is_seen() {
        const GAP: f64 = 1e-3;
        let (model, level) = first_level(block(GAP, Friction::coulomb(0.3)));
        let point = model.points[4].clone();
        let (row, along, scale) = match point.tangential {
            Tangential::Plane { row, scale } => (point.row, row, scale),
            other => panic!("{other:?}"),
        };
        let support = model.tfeti.gluing().ranges().dirichlet.start;
        let torn = model.tfeti.torn_dim();
        // a name, multipliers, changes of the rows from where they want to be, residual, violation
        type Case<'a> = (&'a str, &'a [(usize, f64)], &'a [(usize, f64)], f64, f64);
        let at_floor = (row, 0.0);
        let cases: [Case<'_>; 9] = [
            ("none", &[(row, -2.0)], &[at_floor], 0.0, 0.0),
            ("equilibrium", &[(row, -2.0)], &[at_floor], 3.0, 3.0),
            ("continuity", &[], &[(support, 1e-4)], 0.0, 1e-4),
            ("gap", &[], &[(row, 1e-4 * scale)], 0.0, 1e-4),
            ("sign", &[(row, 2.0)], &[at_floor], 0.0, 2.0 * scale),
            (
                "complementarity",
                &[(row, -2.0)],
                &[],
                0.0,
                2.0 * scale * GAP,
            ),
            (
                "cone",
                &[(row, -2.0), (along, 0.7)],
                &[at_floor],
                0.0,
                0.1 * scale,
            ),
            // sticks and moves
            (
                "direction",
                &[(row, -2.0)],
                &[at_floor, (along, 1e-4 * scale)],
                0.0,
                0.6e-4 * scale,
            ),
            // slides along its friction
            (
                "direction",
                &[(row, -2.0), (along + 1, 0.6)],
                &[at_floor, (along + 1, 1e-4 * scale)],
                0.0,
                1.2e-4 * scale,
            ),
        ];
        for (name, multipliers, moves, off, expected) in cases {
            let mut lambda = vec![0.0; model.tfeti.dual_dim()];
            // open everywhere, and all else where it wants to be
            let mut rows = level.offset.clone();
            model.points.iter().for_each(|p| rows[p.row] = 0.0);
            multipliers.iter().for_each(|&(k, value)| lambda[k] = value);
            moves
                .iter()
                .for_each(|&(k, by)| rows[k] = level.offset[k] + by);
            let mut residual = vec![0.0; torn];
            residual[7] = off;
            let measured = Measured {
                rows: &rows,
                u: &vec![1e-3; torn],
                force: &vec![0.0; torn],
                residual: &residual,
            };
            let sizes = sizes(&model, &level, &lambda, &measured);
            let certificate = certify(&model, &level, &lambda, &measured, &sizes);
            for (part, violation) in certificate.parts() {
                let expected = if part == name { expected } else { 0.0 };
                let near = (violation.value - expected).abs() <= 1e-12 * expected.max(1e-9);
                assert!(near, "{name}: {part} {violation:?}, not {expected:e}");
                assert!(violation.reference > 0.0, "{part}: {violation:?}");
            }
        }
    }

    #[test]
    fn the_violation_of_contact_is_that_of_its_conditions() {
        let mut certificate = Certificate::default();
        certificate.cone.value = 1.0;
        certificate.cone.reference = 4.0;
        certificate.equilibrium.value = 1.0;
        assert_eq!(contact_violation(&certificate), 0.25);
        certificate.gap.value = f64::NAN;
        assert!(contact_violation(&certificate).is_nan());
    }
}
