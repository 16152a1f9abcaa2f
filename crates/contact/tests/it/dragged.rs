//! Contact nodes that supports drag along an obstacle: their friction is that of the law, and the support takes it.

use crate::common;
use crate::common::{block, methods, run, uniform};
use signorini_contact::{
    Analysis, Contact, ContactState, Friction, Load, Scene, Settings, Simulation, Support,
};
use signorini_fem_mesh::{History, brick};

const COEFFICIENT: f64 = 0.3;
const PRESSURE: f64 = 1e3;

fn tight() -> Settings {
    Settings::default().with_tolerance(1e-9)
}

fn there_and_back() -> History {
    History::table(vec![(0.0, 0.0), (0.5, 1.0), (1.0, -1.0)]).expect("table")
}

fn pressed(friction: Friction, boxes: [usize; 3], steps: usize) -> Scene {
    Scene::new(block([2.0, 1.0, 1.0], [4, 2, 2]), uniform(1e7, 0.3))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(friction))
        .with_load(Load::pressure(brick::Z_MAX, PRESSURE))
        .with_boxes(boxes)
        .with_analysis(Analysis::quasistatic(1.0, steps))
}

/// All of the bottom is moved along (3, 4, 0) / 5 and back: friction mu N against it at every node, whatever the body does.
#[test]
fn a_bottom_that_is_dragged_slides_with_friction() {
    let length = 1e-2;
    let way = [0.6 * length, 0.8 * length, 0.0];
    for method in methods() {
        for boxes in [[1, 1, 1], [2, 1, 1], [2, 2, 2]] {
            let scene = pressed(Friction::coulomb(COEFFICIENT), boxes, 8).with_support(
                Support::components(brick::Z_MIN, [true, true, false])
                    .with_motion(way, there_and_back()),
            );
            let (mut work, mut before) = (0.0, 0.0);
            let (_, levels) = run(scene, tight().with_method(method.clone()));
            for level in &levels {
                let what = format!("{} {boxes:?} t = {}", method.name(), level.time);
                let sign = if level.time <= 0.5 { -1.0 } else { 1.0 };
                let total = COEFFICIENT * 2.0 * PRESSURE;
                let friction = level.summary.friction_force;
                for (found, part) in friction.iter().zip([0.6, 0.8, 0.0]) {
                    assert!((found - sign * part * total).abs() < 1e-5 * total, "{what}");
                }
                for point in &level.points {
                    assert_eq!(point.state, ContactState::Slip, "{what}");
                    let size = common::norm(&point.friction_force);
                    assert!((size + COEFFICIENT * point.normal_force).abs() < 1e-6 * size);
                }
                let now = length * there_and_back().value(level.time);
                work += total * (now - before).abs();
                before = now;
            }
            let found: f64 = levels.iter().map(|l| l.summary.friction_work).sum();
            assert!((found / work - 1.0).abs() < 1e-5, "{found} {work}");
        }
    }
}

/// The displacement is that without friction: the support takes all of it.
#[test]
fn what_is_dragged_moves_as_without_friction() {
    let scene = |friction| {
        pressed(friction, [2, 1, 1], 4).with_support(
            Support::components(brick::Z_MIN, [true, true, false])
                .with_motion([1e-2, 0.0, 0.0], common::ramp()),
        )
    };
    let rough = run(scene(Friction::coulomb(COEFFICIENT)), tight()).1;
    let smooth = run(scene(Friction::None), tight()).1;
    for (a, b) in rough.iter().zip(&smooth) {
        common::assert_close(&a.displacement, &b.displacement, 1e-7, "displacement");
    }
}

/// One direction prescribed, the other free: friction acts against the direction of both, so that any force across drives the
/// block sideways, with s_y / s_x = F_y / sqrt((mu N)^2 - F_y^2).
#[test]
fn a_block_that_is_dragged_drifts_with_a_force_across() {
    let (normal, across, way) = (2.0 * PRESSURE, 0.25 * 2.0 * PRESSURE, 1e-1);
    let bound = COEFFICIENT * normal;
    let along = (bound * bound - across * across).sqrt();
    for boxes in [[1, 1, 1], [2, 1, 1]] {
        let scene = pressed(Friction::coulomb(COEFFICIENT), boxes, 1)
            .with_load(Load::body([0.0, across / 2.0, 0.0]))
            .with_support(
                Support::components(brick::Z_MIN, [true, false, false])
                    .with_motion([way, 0.0, 0.0], common::ramp()),
            );
        let (_, levels) = run(scene, tight());
        let what = format!("{boxes:?}: {:?}", levels[0].report);
        let friction = levels[0].summary.friction_force;
        assert!(
            (friction[0] + along).abs() < 1e-4 * bound,
            "{what}: {friction:?}"
        );
        assert!(
            (friction[1] + across).abs() < 1e-4 * bound,
            "{what}: {friction:?}"
        );
        for point in &levels[0].points {
            let [x, y, _] = point.tangential_displacement;
            assert!((x / way - 1.0).abs() < 1e-9, "{what}");
            assert!((y / x - across / along).abs() < 2e-2, "{what}: {}", y / x);
        }
        assert!(!levels[0].report.fallback, "{what}");
    }
}

/// With given friction the bound holds without pressure.
#[test]
fn given_friction_of_what_is_dragged() {
    let stress = 40.0;
    let scene = pressed(Friction::tresca(stress), [2, 1, 1], 2).with_support(
        Support::components(brick::Z_MIN, [true, true, false])
            .with_motion([1e-2, 0.0, 0.0], common::ramp()),
    );
    for level in run(scene, tight()).1 {
        let friction = level.summary.friction_force[0];
        assert!(
            (friction + 2.0 * stress).abs() < 1e-6 * stress,
            "{friction}"
        );
    }
}

/// A support that does not move leaves its friction open; as before there is none along it.
#[test]
fn a_symmetry_plane_keeps_one_tangential_row() {
    let scene = pressed(Friction::coulomb(COEFFICIENT), [1, 1, 1], 1)
        .with_support(Support::components(brick::Y_MIN, [false, true, false]))
        .with_support(Support::components(brick::X_MIN, [true, false, false]));
    let simulation = Simulation::new(scene, tight()).expect("set-up");
    let gluing = simulation.tfeti().gluing();
    assert_eq!(gluing.ranges().intervals.len(), 4 + 2);
    assert!(gluing.dependent_nodes().is_empty() && gluing.is_orthonormal());
}
