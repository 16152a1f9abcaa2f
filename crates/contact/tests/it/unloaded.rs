//! Loads that go back to zero: bodies that only contact holds stand where next to no load leaves them, or are locked.

use crate::common::*;

/// A plug between rigid sides that open upwards by a tenth, pushed down, then let go in so many steps.
fn plug(coefficient: f64, steps: usize) -> Scene {
    let taper = |[x, y, z]: [f64; 3]| [(x - 1.0) * (1.0 + 0.1 * (z - 1.0)), y, z];
    let mesh = block([2.0, 1.0, 2.0], [6, 3, 6]).map_points(taper);
    let push = History::table(vec![(0.0, 0.0), (1.0, 1.0), (2.0, 0.0), (3.0, 0.0)]).expect("history");
    let side = |tag| Contact::rigid(tag).with_friction(Friction::coulomb(coefficient));
    Scene::new(mesh.expect("mesh"), uniform(1e3, 0.3))
        .with_contact(side(brick::X_MIN))
        .with_contact(side(brick::X_MAX))
        .with_support(Support::components(brick::Y_MIN, [false, true, false]))
        .with_load(Load::force(brick::Z_MAX, [0.0, 0.0, -10.0]).with_history(push))
        .with_analysis(Analysis::quasistatic(3.0, steps))
}

/// With friction above the slope of its sides it stays, pressed by next to all that pressed it; below, all comes back.
#[test]
fn friction_above_the_slope_locks_a_plug() {
    for (coefficient, locked) in [(0.05, false), (0.06, false), (0.12, true), (0.3, true)] {
        for steps in [3, 6, 12] {
            let (_, results) = run(plug(coefficient, steps), Settings::default());
            let what = |k: usize| format!("{coefficient}, step {k} of {steps}");
            let force = |k: usize| results[k].points.iter().map(|p| p.normal_force).sum::<f64>();
            for (k, result) in results.iter().enumerate() {
                assert_certified(result, &what(k));
                let products = result.report.counters.products;
                assert!(products <= 180 && !result.report.fallback, "{}: {products}", what(k));
            }
            let [full, let_go, last] = [steps / 3, 2 * steps / 3, steps].map(|k| force(k - 1));
            let left = let_go / full;
            assert!(
                if locked { left > 0.5 } else { left == 0.0 },
                "{coefficient}, {steps}: {left}"
            );
            assert!((last - let_go).abs() <= 1e-6 * full.abs(), "{last:e} {let_go:e}");
            // nothing moves any more
            let [a, b] = [2 * steps / 3, steps].map(|k| &results[k - 1].displacement);
            let moved: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
            assert!(norm(&moved) <= 1e-6 * norm(&results[steps / 3 - 1].displacement));
        }
    }
}

/// Two cubes on a rough floor and on one another, pressed, pushed sideways, then loaded by no more than this part.
fn pushed(left: f64, steps: usize) -> Scene {
    let mesh = with_second(&block([1.0; 3], [4; 3]), &lifted(&block([1.0; 3], [3; 3]), 1.0));
    let table = |sideways: f64| {
        let most = 1.0 + sideways;
        let times = vec![(0.0, 0.0), (1.0, 1.0), (2.0, most), (3.0, left * most)];
        History::table(times).expect("history")
    };
    let rough = |contact: Contact| contact.with_friction(Friction::coulomb(0.3));
    Scene::new(mesh, uniform(1e3, 0.3))
        .with_load(Load::traction(second(brick::Z_MAX), [0.0, 0.0, -10.0]).with_history(table(0.0)))
        .with_load(Load::traction(second(brick::X_MIN), [1.0, 0.3, 0.0]).with_history(table(0.8)))
        .with_contact(rough(Contact::rigid(brick::Z_MIN)))
        .with_contact(rough(Contact::between(brick::Z_MAX, second(brick::Z_MIN))))
        .with_analysis(Analysis::quasistatic(3.0, steps))
}

#[test]
fn bodies_stand_where_next_to_no_load_leaves_them() {
    for steps in [3, 12] {
        let [without, little] = [0.0, 1e-4].map(|left| run(pushed(left, steps), Settings::default()).1);
        let [full, free, held] = [&without[2 * steps / 3 - 1], &without[steps - 1], &little[steps - 1]];
        assert_certified(free, "without loads");
        assert_certified(held, "with next to none");
        assert_eq!(count(&free.points, ContactState::Open), free.points.len());
        let size = norm(&full.displacement);
        let [moved, off] = [
            norm(&free.displacement),
            distance(&free.displacement, &held.displacement),
        ];
        assert!(moved > 0.01 * size && off < 0.01, "{steps}: {size:e} {moved:e} {off:e}");
        let products = free.report.counters.products;
        assert!(products <= 50, "{steps}: {products}");
    }
}
