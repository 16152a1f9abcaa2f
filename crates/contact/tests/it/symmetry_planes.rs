//! Contact nodes in a plane of symmetry: one direction along the surface is left to them, with the whole friction of the law.

use crate::common::{block, methods, ramp, run, tight, uniform};
use signorini_contact::{Analysis, Contact, ContactState, Friction, Scene, Support};
use signorini_fem_mesh::brick;

/// Half a block that is pressed on a floor and dragged along its plane of symmetry.
fn half(friction: Friction) -> Scene {
    Scene::new(block([2.0, 1.0, 1.0], [4, 2, 2]), uniform(1e9, 0.3))
        .with_support(Support::components(brick::Y_MIN, [false, true, false]))
        .with_support(Support::fixed(brick::Z_MAX).with_motion([8e-3, 0.0, -2e-3], ramp()))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(friction))
        .with_boxes([2, 1, 1])
        .with_analysis(Analysis::quasistatic(1.0, 3))
}

/// The slip bound of a node with one direction left is that of the law, not a part of it.
#[test]
fn sliding_nodes_in_a_plane_of_symmetry_have_the_friction_of_the_law() {
    let (mu, stress) = (0.3, 2e5);
    for (friction, given) in [
        (Friction::coulomb(mu), 0.0),
        (Friction::tresca(stress), stress),
    ] {
        for method in methods() {
            let name = method.name();
            let (_, levels) = run(half(friction.clone()), tight().with_method(method));
            let mut slid = 0;
            for point in levels.iter().flat_map(|l| &l.points) {
                let in_plane = point.node % 15 < 5;
                if !in_plane || point.state != ContactState::Slip {
                    continue;
                }
                slid += 1;
                let bound = match given {
                    0.0 => -mu * point.normal_force,
                    stress => stress * point.area,
                };
                assert!(bound > 0.0 && (point.slip_bound - bound).abs() <= 1e-9 * bound);
                let [x, y, z] = point.friction_force;
                assert!((x + bound).abs() <= 1e-6 * bound, "{name}: {point:?}");
                assert!(y.hypot(z) <= 1e-9 * bound, "{name}: {point:?}");
            }
            // five nodes lie in the plane
            assert!(slid >= 5, "{name}: {slid} slide");
        }
    }
}
