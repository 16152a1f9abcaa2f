//! Makes the certificate of a step.

use super::certificate::{Certificate, Violation};
use super::sizes::{Measured, Sizes};
use signorini_qp::vector;

/// How far displacement and multipliers are from all conditions.
pub(super) fn certify(m: &Measured<'_>, sizes: &[Sizes]) -> Certificate {
    let (model, problem, lambda) = (m.model, m.problem, m.lambda);
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
    let gluing = model.tfeti.gluing();
    for row in ranges.interface.start..ranges.total() {
        let own = &sizes[model.bodies.of_row(row)];
        let jump = (m.rows[row] - problem.offset[row]).abs() / gluing.length(row);
        // of a soft spring the force counts: against the way on which it takes all
        let spring = gluing.spring(row);
        let whole = spring.map_or(0.0, |spring| own.forces * spring.compliance / spring.scale.powi(2));
        c.continuity.worsen(jump, own.displacement.max(whole));
    }
    for (k, point) in model.points.iter().enumerate() {
        let own = &sizes[model.bodies.of_row(point.row)];
        let (contact_force, displacement) = (own.contact_force, own.displacement);
        let open = (problem.offset[point.row] - m.rows[point.row]) / point.scale;
        let force = point.scale * lambda[point.row];
        c.gap.worsen(-open, displacement);
        c.sign.worsen(force, contact_force);
        let product = (force * open.max(0.0)).abs();
        c.complementarity.worsen(product, contact_force * displacement);
        let Some((row, count, scale)) = point.tangential_rows() else {
            continue;
        };
        let bound = problem.slip_bound(k, point, lambda);
        let mut slip = [0.0; 2];
        let mut friction = [0.0; 2];
        for j in 0..count {
            slip[j] = (m.rows[row + j] - problem.offset[row + j]) / scale;
            friction[j] = scale * lambda[row + j];
        }
        let (length, size) = (slip[0].hypot(slip[1]), friction[0].hypot(friction[1]));
        c.cone.worsen(size - bound, contact_force);
        let off = [
            bound * slip[0] + length * friction[0],
            bound * slip[1] + length * friction[1],
        ];
        // a bound above all forces says that the point sticks: only its displacement counts
        c.direction
            .worsen(off[0].hypot(off[1]), contact_force.max(bound) * displacement);
    }
    judge(m, sizes, &mut c.gap);
    c
}

/// A condition on the mean of several nodes.
struct Mean {
    /// The point that stands for it.
    point: usize,
    gap: f64,
    area: f64,
    /// How far it is violated, m, and what that is measured against.
    depth: f64,
    size: f64,
}

/// Penetration of the obstacles that the scene names, whatever points were made of them: gaps and normals of each
/// contact by itself, and mean displacements of its nodes. Means of contacts that are equally far and one point are one
/// mean over the facets of all.
fn judge(m: &Measured<'_>, sizes: &[Sizes], gap: &mut Violation) {
    let (model, u) = (m.model, m.u);
    let (tfeti, scene) = (&model.tfeti, &model.scene);
    let weights = tfeti.copy_stiffness();
    let along = |node: u32, normal: &[f64; 3]| {
        let (mut sum, mut weight) = (0.0, 0.0);
        for copy in model.discrete.decomposition.copies(node as usize) {
            let first = tfeti.torn_range(copy.subdomain as usize).start;
            let at = first + 3 * copy.local as usize;
            let own = weights.weight(at / 3);
            sum += own * vector::dot(&u[at..at + 3], normal);
            weight += own;
        }
        sum / weight
    };
    let mut means: Vec<Mean> = Vec::new();
    for (condition, point) in model.discrete.conditions.iter().zip(&model.standing) {
        let Some(point) = *point else {
            continue;
        };
        let normal = &condition.frame.normal;
        let pose = m.problem.obstacles[0].get(condition.surface);
        let open = pose.map_or(Ok(condition.gap), |pose| condition.gap_after(scene, pose));
        // no gap at all is no gap that holds
        let open = open.unwrap_or(f64::NAN) + model.discrete.rounding;
        let depth = condition.sides.way(normal, along) - open - model.given_way(point, m.lambda);
        let copies = model.discrete.decomposition.copies(condition.node() as usize);
        let body = copies
            .first()
            .map_or(0, |c| model.bodies.of_subdomain(c.subdomain as usize));
        let size = sizes[body].displacement;
        match condition.sides.own.nodes() {
            [_] => gap.worsen(depth, size),
            _ => means.push(Mean {
                point,
                gap: condition.gap,
                area: condition.area,
                depth,
                size,
            }),
        }
    }
    means.sort_by(|a, b| a.point.cmp(&b.point).then(a.gap.total_cmp(&b.gap)));
    for alike in means.chunk_by(|a, b| a.point == b.point && b.gap - a.gap <= model.discrete.rounding) {
        let area: f64 = alike.iter().map(|m| m.area).sum();
        let depth = match alike {
            [one] => one.depth,
            _ => alike.iter().map(|m| m.area * m.depth).sum::<f64>() / area,
        };
        gap.worsen(depth, alike[0].size);
    }
}

#[cfg(test)]
mod tests {
    use super::super::sizes::sizes;
    use super::*;
    use crate::Friction;
    use crate::Settings;
    use crate::State;
    use crate::model::Model;
    use crate::step::StepProblem;
    use crate::step::example::{block, first_step};
    use crate::{Analysis, Contact, Scene, Support};
    use signorini_fem_mesh::{Brick, History, Hooke, Materials, brick};
    use signorini_tfeti::TangentialRows;

    /// The gap of a certificate where all nodes are displaced alike, and the points of the model say nothing.
    fn judged(scene: Scene, displacement: [f64; 3]) -> Violation {
        let mut model = Model::new(scene, &Settings::default()).expect("model");
        model.points = [].into();
        let mut problem = StepProblem::default();
        let first = model.scene.analysis.increment(0).expect("a step");
        problem.prepare(&model, &State::default(), first, 0.0).expect("step");
        let u = displacement.repeat(model.tfeti.torn_dim() / 3);
        let (zero, lambda) = (vec![0.0; u.len()], vec![0.0; model.tfeti.dual_dim()]);
        let measured = Measured {
            model: &model,
            problem: &problem,
            tolerance: Settings::default().tolerance,
            lambda: &lambda,
            rows: &lambda,
            u: &u,
            residual: &zero,
        };
        certify(&measured, &sizes(&measured)).gap
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
        let held = cube().with_contact(floor).with_support(Support::fixed(brick::Z_MIN));
        assert_eq!(judged(held, [0.0, 0.0, -0.25]).value, 0.0);
    }

    #[test]
    fn obstacles_are_judged_where_they_have_moved() {
        let ramp = History::ramp(1.0, 1.0).expect("ramp");
        let moving = Contact::rigid(brick::Z_MIN)
            .with_gap_field(|x| 0.1 * x[0])
            .with_motion([1.0, 0.0, 0.05], ramp);
        let scene = cube().with_contact(moving).with_analysis(Analysis::quasistatic(1.0, 1));
        // at x = 0 the gap is now -0.1 - 0.05
        close(judged(scene, [0.0, 0.0, -0.25]), 0.4, 0.25);
    }

    /// Each condition, violated alone by a known amount, is found with that amount, and no other one.
    #[test]
    fn each_condition_is_seen() {
        const GAP: f64 = 1e-3;
        let (model, problem) = first_step(block(GAP, Friction::coulomb(0.3)));
        let point = model.points[4].clone();
        let (row, along, scale) = match point.tangential {
            TangentialRows::Disc { row, scale } => (point.row, row, scale),
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
            ("complementarity", &[(row, -2.0)], &[], 0.0, 2.0 * scale * GAP),
            ("cone", &[(row, -2.0), (along, 0.7)], &[at_floor], 0.0, 0.1 * scale),
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
            let mut rows = problem.offset.clone();
            model.points.iter().for_each(|p| rows[p.row] = 0.0);
            multipliers.iter().for_each(|&(k, value)| lambda[k] = value);
            moves.iter().for_each(|&(k, by)| rows[k] = problem.offset[k] + by);
            let mut residual = vec![0.0; torn];
            residual[7] = off;
            let measured = Measured {
                model: &model,
                problem: &problem,
                tolerance: Settings::default().tolerance,
                lambda: &lambda,
                rows: &rows,
                u: &vec![1e-3; torn],
                residual: &residual,
            };
            let certificate = certify(&measured, &sizes(&measured));
            for (part, violation) in certificate.parts() {
                let expected = if part == name { expected } else { 0.0 };
                let near = (violation.value - expected).abs() <= 1e-12 * expected.max(1e-9);
                assert!(near, "{name}: {part} {violation:?}, not {expected:e}");
                assert!(violation.reference > 0.0, "{part}: {violation:?}");
            }
        }
    }
}
