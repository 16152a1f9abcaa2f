//! Levels at which forces vanish: they have no size of their own and are measured against earlier levels.

use crate::common;
use crate::common::{block, run};
use signorini_contact::{Contact, Friction, Load, Scene, Settings, Support};
use signorini_fem_mesh::{History, Hooke, Materials, brick};

/// A block that is pressed on the floor below it, and not any more from `t = 0.5` on.
fn scene(gap: f64, friction: Friction) -> Scene {
    let history = History::table(vec![(0.0, 0.0), (0.3, 1.0), (0.5, 0.0), (1.0, 0.0)]);
    let hooke = Hooke::isotropic(1e3, 0.3).expect("material");
    Scene::new(block([2.0, 1.0, 1.0], [6, 3, 3]), Materials::uniform(hooke))
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(
            Load::traction(brick::Z_MAX, [0.2, 0.0, -1.0]).with_history(history.expect("history")),
        )
        .with_contact(
            Contact::rigid(brick::Z_MIN)
                .with_gap(gap)
                .with_friction(friction),
        )
        .with_boxes([2, 1, 1])
        .with_analysis(common::paper_steps(1.0, 10))
}

#[test]
fn a_body_that_is_unloaded_again_converges_in_few_products() {
    for (gap, friction, most) in [
        (1e-3, Friction::None, 130),
        (1e-3, Friction::coulomb(0.3), 170),
        (0.0, Friction::coulomb(0.3), 180),
    ] {
        // `run` asks every level for a certificate of 1e-6
        let (simulation, levels) = run(scene(gap, friction), Settings::default());
        let products = simulation.counters().products;
        println!("gap {gap}: {products} products");
        assert!(levels.iter().all(|l| !l.report.fallback));
        assert!(products <= most, "{products}");
    }
}
