//! A soft part between stiff ones, cut along the jump of stiffness: contact nodes on the interfaces belong to stiff and soft
//! subdomains. Their rows have to follow the stiff ones.

mod common;

use common::block;
use signorini_contact::{
    Contact, Friction, Load, Method, Scene, Settings, Simulation, StepStatus, Support,
};
use signorini_fem_mesh::{Hooke, Materials, brick};
use signorini_qp::ActiveSetSettings;

fn scene(ratio: f64, friction: Friction) -> Scene {
    let mesh = block([3.0, 1.0, 1.0], [9, 3, 3]);
    let regions = (0..mesh.tets().len())
        .map(|t| {
            let x = mesh.tet_points(t).iter().map(|p| p[0]).sum::<f64>() / 4.0;
            u32::from(x > 1.0 && x < 2.0)
        })
        .collect();
    let hooke = |young| Hooke::isotropic(young, 0.277).expect("material");
    let materials = Materials::new(vec![(0, hooke(1e3)), (1, hooke(1e3 / ratio))]);
    Scene::new(
        mesh.with_regions(regions).expect("regions"),
        materials.expect("materials"),
    )
    .with_support(Support::fixed(brick::X_MIN))
    .with_load(Load::traction(brick::Z_MAX, [0.1, 0.0, -1.0]))
    .with_contact(Contact::rigid(brick::Z_MIN).with_friction(friction))
    .with_boxes([3, 1, 1])
}

/// One level: status, certificate, products, whether SMALSE had to help.
fn level(ratio: f64, friction: Friction) -> (StepStatus, f64, usize, bool) {
    let scene = scene(ratio, friction);
    let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
    let frame = simulation.step().expect("step");
    let report = frame.report();
    (
        report.status,
        frame.certificate().largest(),
        report.counters.products,
        report.fallback,
    )
}

#[test]
fn jumps_on_interfaces_are_solved() {
    for (ratio, friction, products) in JUMPS {
        let law = if friction > 0.0 {
            Friction::coulomb(friction)
        } else {
            Friction::None
        };
        let (status, certificate, found, fallback) = level(ratio, law);
        let what =
            format!("ratio {ratio:e}, F {friction}: {found} products, certificate {certificate:e}");
        println!("{what}, fallback {fallback}");
        assert!(status.converged() && certificate <= 1e-5, "{what}");
        assert!(!fallback && found <= products, "{what}");
    }
}

/// Ratio, coefficient of friction, most products.
const JUMPS: [(f64, f64, usize); 6] = [
    (1e1, 0.3, 60),
    (1e3, 0.0, 60),
    (1e3, 0.3, 60),
    (1e6, 0.0, 60),
    (1e6, 0.3, 60),
    (1e9, 0.3, 60),
];

/// The fall-back says no in time.
#[test]
fn the_fall_back_is_bounded() {
    let limit = 50;
    let few = Method::ActiveSet(ActiveSetSettings::default().with_max_active_sets(1));
    let settings = Settings::default()
        .with_method(few)
        .with_max_fallback_products(limit);
    let scene = scene(1e6, Friction::coulomb(0.3));
    let mut simulation = Simulation::new(scene, settings).expect("set-up");
    let frame = simulation.step().expect("step");
    let report = frame.report();
    assert!(report.fallback);
    assert_eq!(report.status, StepStatus::IterationLimit);
    // the last step of KPRGP is finished
    assert!(
        (1..=limit + 10).contains(&report.fallback_products),
        "{}",
        report.fallback_products
    );
}
