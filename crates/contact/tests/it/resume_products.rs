//! A state that goes on under other conditions: its products with F belong to the old ones and must not be believed.

use crate::common::{assert_certified, rest, small_benchmark, weakening};
use signorini_contact::{Scene, Settings, Simulation};
use signorini_fem_mesh::{Hooke, Materials};

/// The small benchmark with another modulus.
fn of(young: f64) -> Simulation {
    let base = small_benchmark(weakening(), 6);
    let elastic = Materials::uniform(Hooke::isotropic(young, 0.277).expect("Hooke"));
    let mut scene = Scene::new(base.mesh().clone(), elastic)
        .with_boxes([3, 1, 1])
        .with_analysis(base.analysis().clone());
    scene = base
        .supports()
        .iter()
        .cloned()
        .fold(scene, Scene::with_support);
    scene = base.loads().iter().cloned().fold(scene, Scene::with_load);
    scene = base
        .contacts()
        .iter()
        .cloned()
        .fold(scene, Scene::with_contact);
    Simulation::new(scene, Settings::default()).expect("set-up")
}

/// Products with F are those of the stiffness: a body a thousand times stiffer goes on from them only if they are computed anew.
#[test]
fn products_of_other_materials_are_computed_anew() {
    let young = 211.9e9;
    let mut before = of(young);
    for _ in 0..3 {
        let _ = before.step().expect("step");
    }
    for factor in [1e-3, 0.3, 3.0, 1e3] {
        let mut simulation = of(factor * young);
        simulation.resume(before.state().clone()).expect("resume");
        for (k, level) in rest(&mut simulation).iter().enumerate() {
            assert_certified(
                level,
                &format!("modulus times {factor}, level {k} after it"),
            );
        }
    }
}
