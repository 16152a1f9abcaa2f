//! The Signorini bar, whose reaction is known in closed form on every mesh.

use crate::common::*;

const YOUNG: f64 = 1000.0;
const GAP: f64 = 1e-3;

fn bar(mesh: TetMesh, force: f64, body: f64) -> Scene {
    Scene::new(mesh, uniform(YOUNG, 0.0))
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::traction(brick::X_MAX, [force, 0.0, 0.0]))
        .with_load(Load::body([body, 0.0, 0.0]))
        .with_contact(Contact::rigid(brick::X_MAX).with_gap(GAP))
}

/// With v = (x, 0, 0) as test function, the reaction is P + b L / 2 - E g / L as soon as the whole end touches.
#[test]
fn the_reaction_of_the_bar() {
    let meshes = [
        block([1.0; 3], [4, 2, 2]),
        Brick::new([1.0; 3], [4, 4, 4])
            .perturbed(0.15, 3)
            .build()
            .expect("brick"),
    ];
    for mesh in meshes {
        for boxes in [[1, 1, 1], [2, 1, 1], [4, 2, 2]] {
            for (force, body) in [
                (0.0, 0.0),
                (0.5, 0.0),
                (3.0, 0.0),
                (100.0, 0.0),
                (0.0, 5.0),
                (2.0, 3.0),
                (0.2, 1.0),
            ] {
                let result = solve(bar(mesh.clone(), force, body).with_boxes(boxes), tight());
                let expected = (force + body / 2.0 - YOUNG * GAP).max(0.0);
                let found = result.summary.normal_force;
                assert!(
                    (found - expected).abs() <= 1e-9 * expected.max(1.0),
                    "P {force}, b {body}, {boxes:?}: {found} instead of {expected}"
                );
                let touching = result.points.len() * usize::from(expected > 0.0);
                assert_eq!(result.summary.active, touching, "P {force}, b {body}");
            }
        }
    }
}

#[test]
fn every_method_finds_the_reaction() {
    for method in methods() {
        let scene = bar(block([1.0; 3], [4, 2, 2]), 3.0, 0.0).with_boxes([2, 1, 1]);
        let result = solve(scene, tight().with_method(method.clone()));
        let error = result.summary.normal_force / 2.0 - 1.0;
        assert!(error.abs() <= 1e-9, "{}: {error:e}", method.kind());
    }
}

/// Where the end just touches, the force is zero and the gap closed: neither side of the condition may win by rounding.
#[test]
fn the_end_that_just_touches() {
    let result = solve(
        bar(block([1.0; 3], [4, 2, 2]), YOUNG * GAP, 0.0).with_boxes([2, 1, 1]),
        tight(),
    );
    assert!(result.summary.normal_force.abs() <= 1e-9);
    for p in &result.points {
        assert!(p.gap.abs() <= 1e-9 * GAP, "{:e}", p.gap);
    }
}
