//! A block on a wedge (benchmark NAFEMS CGS-4). It slides up under the horizontal force F / G = (tan a + mu) / (1 - mu
//! tan a).

use crate::common::*;

/// tan a.
const SLOPE: f64 = 0.1;
const WEIGHT: f64 = 1.0;
const VOLUME: f64 = 4.0;

/// Coefficients with the published ratios.
const TABLE: [(f64, f64); 4] = [(0.0, 0.1), (0.1, 0.2020202), (0.2, 0.3061224), (0.3, 0.4123711)];

fn threshold(coefficient: f64) -> f64 {
    (SLOPE + coefficient) / (1.0 - coefficient * SLOPE)
}

fn uphill(v: [f64; 3]) -> [f64; 3] {
    turn(&rotation([0.0, -1.0, 0.0], SLOPE.atan()), v)
}

fn mesh() -> TetMesh {
    let flat = block([4.0, 1.0, 1.0], [4, 1, 1]);
    flat.map_points(uphill).expect("mesh")
}

fn on_the_wedge(friction: Friction) -> Scene {
    let slope = Contact::half_space(brick::Z_MIN, [0.0; 3], uphill([0.0, 0.0, 1.0]));
    Scene::new(mesh(), uniform(1e4, 0.3))
        .with_load(Load::body([0.0, 0.0, -WEIGHT / VOLUME]))
        .with_contact(slope.with_friction(friction))
}

fn law(coefficient: f64) -> Friction {
    if coefficient == 0.0 { Friction::None } else { Friction::coulomb(coefficient) }
}

/// The back is moved horizontally by so much that all of the block slides; the force that this takes is the threshold.
#[test]
fn the_force_that_moves_the_block() {
    for (coefficient, published) in TABLE {
        assert!((threshold(coefficient) - published).abs() < 5e-8);
        for method in methods() {
            for boxes in [[1, 1, 1], [2, 1, 1]] {
                // upper nodes only, so that every contact node is free: the grid has 5 x 2 x 2 nodes
                let (back, side) = (vec![10, 15], vec![10, 14]);
                let scene = on_the_wedge(law(coefficient))
                    .with_boxes(boxes)
                    .with_support(
                        Support::components(back, [true, false, false])
                            .with_motion([0.1, 0.0, 0.0], History::constant(1.0)),
                    )
                    .with_support(Support::components(side, [false, true, false]));
                let settings = at(1e-8).with_method(method.clone());
                let result = solve(scene, settings);
                // what the contact takes horizontally, the back must give
                let found = -result.summary.resultant[0] / WEIGHT;
                let error = found / threshold(coefficient) - 1.0;
                assert!(
                    error.abs() <= 1e-6,
                    "{}, mu {coefficient}, {boxes:?}: {found}, error {error:e}",
                    method.kind()
                );
            }
        }
    }
}

/// Weight and horizontal force, and nothing else but friction.
fn pushed(ratio: f64, coefficient: f64) -> Scene {
    on_the_wedge(law(coefficient)).with_load(Load::body([ratio * WEIGHT / VOLUME, 0.0, 0.0]))
}

#[test]
fn a_ten_thousandth_above_the_threshold_no_equilibrium_is_claimed() {
    for (coefficient, _) in &TABLE[1..] {
        for method in methods() {
            let scene = pushed(threshold(*coefficient) * (1.0 + 1e-4), *coefficient);
            let settings = by(method.clone());
            let mut simulation = match Simulation::new(scene, settings) {
                Ok(simulation) => simulation,
                // known before anything is solved
                Err(ContactError::NotHeld { .. }) => continue,
                Err(error) => panic!("{error}"),
            };
            if let Ok(frame) = simulation.step() {
                assert!(!frame.report().status.converged(), "{}", method.kind());
            }
        }
    }
}

/// Without friction no horizontal force but one holds the block, and this is known before anything is solved.
#[test]
fn without_friction_the_block_is_recognised_as_not_held() {
    for ratio in [0.0, SLOPE * (1.0 - 1e-4), SLOPE * (1.0 + 1e-4), 0.5] {
        match Simulation::new(pushed(ratio, 0.0), Settings::default()) {
            Err(ContactError::NotHeld { force, .. }) => assert!(force.abs() > 0.0),
            other => panic!("{ratio}: {:?}", other.map(|_| "accepted")),
        }
    }
}

#[test]
fn half_of_the_threshold_is_held() {
    for (coefficient, _) in &TABLE[1..] {
        let result = solve(pushed(0.5 * threshold(*coefficient), *coefficient), Settings::default());
        let normal = result.summary.normal_force;
        assert!(norm(&result.summary.friction_force) <= coefficient * normal * (1.0 + 1e-6));
    }
}

/// Nearly every point slides then; friction along the circles of sliding points takes part in holding the block.
#[test]
fn a_ten_thousandth_below_the_threshold_is_held() {
    for (coefficient, _) in &TABLE[1..] {
        solve(
            pushed(threshold(*coefficient) * (1.0 - 1e-4), *coefficient),
            Settings::default(),
        );
    }
}
