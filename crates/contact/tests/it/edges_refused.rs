//! Edges and shared nodes: what is refused, and what an open edge is worth to the estimates.

use crate::common::{block, ramp, uniform};
use signorini_contact::{
    Accuracy, Contact, ContactError, Friction, Load, Plan, Scene, Settings, Simulation, Support,
};
use signorini_fem_mesh::{History, brick};

fn clamped() -> Scene {
    Scene::new(block([2.0, 1.0, 1.0], [4, 2, 2]), uniform(1e9, 0.3))
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -1e5]))
}

fn refused(scene: &Scene) -> ContactError {
    let planned = Plan::new(scene, &Settings::default()).expect_err("refused");
    let found = Simulation::new(scene.clone(), Settings::default()).expect_err("refused");
    assert_eq!(planned.to_string(), found.to_string());
    found
}

/// Nodes in an edge that touch neither floor nor wall have rows that depend on one another, and no plane to be moved to.
#[test]
fn an_open_edge_has_an_estimate() {
    for friction in [Friction::None, Friction::coulomb(0.3)] {
        let side = |tag| {
            Contact::rigid(tag)
                .with_gap(0.5)
                .with_friction(friction.clone())
        };
        let scene = clamped()
            .with_contact(side(brick::Z_MIN))
            .with_contact(side(brick::Y_MIN))
            .with_boxes([2, 1, 1]);
        for accuracy in [
            Accuracy::Tolerance,
            Accuracy::Relative(1e-6),
            Accuracy::balanced(),
        ] {
            let settings = Settings::default().with_accuracy(accuracy);
            let mut simulation = Simulation::new(scene.clone(), settings).expect("set-up");
            let frame = simulation.step().expect("step");
            assert!(frame.report().status.converged());
            assert_eq!(frame.summary().active, 0);
            let error = frame.algebraic_error().relative();
            assert!(error < 0.1, "{accuracy:?}: {error:e}");
        }
    }
}

/// A floor, and a plate on the same facets that sinks: which is nearer changes with time.
#[test]
fn obstacles_that_move_apart_do_not_share_nodes() {
    let floor = || Contact::half_space(brick::Z_MIN, [0.0; 3], [0.0, 0.0, 1.0]);
    let plate = floor().with_motion([0.0, 0.0, -0.1], ramp());
    match refused(&clamped().with_contact(floor()).with_contact(plate.clone())) {
        ContactError::SharedNode { first, second, .. } => assert_eq!((first, second), (0, 1)),
        error => panic!("{error}"),
    }
    let both = clamped().with_contact(plate.clone()).with_contact(plate);
    Plan::new(&both, &Settings::default()).expect("one motion");
}

#[test]
fn an_obstacle_that_moves_too_far_is_named() {
    for history in [History::constant(1e200), History::constant(1e300)] {
        let floor = Contact::rigid(brick::Z_MIN).with_motion([0.0, 0.0, 1e200], history);
        let error = refused(&clamped().with_contact(floor)).to_string();
        assert!(
            error.contains("obstacle 0") && error.contains("displacement"),
            "{error}"
        );
    }
}
