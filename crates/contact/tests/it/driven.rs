//! Bodies that only their supports drive: no loads, and no forces as long as they move like rigid bodies.

use crate::common;
use crate::common::{block, ramp, steel, step};
use signorini_contact::{Contact, Friction, Scene, Settings, Simulation, Support};
use signorini_fem_mesh::{History, brick};

/// A block on its top support, lowered on a floor.
fn lowered(gap: f64, depth: f64, tilt: [f64; 2]) -> Scene {
    let down = History::table(vec![(0.0, 0.0), (1.0, 1.0)]).expect("ramp");
    Scene::new(block([2.0, 1.0, 1.0], [8, 4, 4]), steel())
        .with_support(Support::fixed(brick::Z_MAX).with_motion([tilt[0], tilt[1], -depth], down))
        .with_contact(
            Contact::rigid(brick::Z_MIN)
                .with_gap(gap)
                .with_friction(Friction::coulomb(0.3)),
        )
        .with_boxes([2, 1, 1])
        .with_analysis(common::paper_steps(1.0, 10))
}

fn assert_cheap(level: &common::Solved, what: &str) {
    let report = &level.report;
    let parts = level.certificate.parts().map(|(n, v)| (n, v.relative()));
    assert!(report.status.converged(), "{what}: {report:?} {parts:?}");
    assert!(report.counters.products <= 60, "{what}: {report:?}");
}

#[test]
fn a_body_that_is_lowered_touches_at_the_right_level() {
    for (gap, depth, tilt) in [
        (1e-3, 2e-3, [0.0; 2]),
        (1e-3, 2e-3, [3e-4, 1e-4]),
        (0.99, 1.0, [0.1, 0.0]),
        (1e-3, 0.9e-3, [0.0; 2]),
    ] {
        let mut simulation =
            Simulation::new(lowered(gap, depth, tilt), Settings::default()).expect("set-up");
        while !simulation.is_finished() {
            let level = step(&mut simulation);
            let reach = depth * level.time;
            let what = format!("gap {gap}, depth {depth}, t = {}", level.time);
            assert_cheap(&level, &what);
            let touches = level.summary.normal_force > 1.0;
            assert_eq!(touches, reach > gap * (1.0 + 1e-9), "{what}");
        }
    }
}

/// Two supports that move alike: every level is a rigid motion.
#[test]
fn a_rigid_motion_costs_little() {
    let motion = [1e-3, -2e-3, 5e-4];
    for contact in [false, true] {
        let mut scene = Scene::new(block([2.0, 1.0, 1.0], [8, 4, 4]), steel())
            .with_support(Support::fixed(brick::X_MIN).with_motion(motion, ramp()))
            .with_support(Support::fixed(brick::X_MAX).with_motion(motion, ramp()))
            .with_boxes([3, 1, 1])
            .with_analysis(common::paper_steps(1.0, 5));
        if contact {
            let floor = Contact::rigid(brick::Z_MIN).with_gap(1e-2);
            scene = scene.with_contact(floor.with_friction(Friction::coulomb(0.3)));
        }
        let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
        while !simulation.is_finished() {
            let level = step(&mut simulation);
            assert_cheap(&level, &format!("contact {contact}"));
            for u in level.displacement.chunks_exact(3) {
                for (u, m) in u.iter().zip(motion) {
                    assert!((u - level.time * m).abs() < 1e-12, "{u:e}");
                }
            }
        }
    }
}
