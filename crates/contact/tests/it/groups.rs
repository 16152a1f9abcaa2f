//! Errors and warnings of a scene speak in the names of the groups of its mesh file.

use crate::common::*;

/// Two bricks, one far above the other, with names.
fn named(order: usize, poisson: f64) -> Scene {
    let both = with_second(&block([1.0; 3], [2; 3]), &lifted(&block([1.0; 3], [3; 3]), 9.0));
    let both = if order == 2 { both.raise_order().expect("order 2") } else { both };
    let above = |tet: usize| 3 + 4 * u32::from(both.tet_points(tet)[0][2] > 5.0);
    let regions = (0..both.tets().len()).map(above).collect();
    let hooke = |poisson| Hooke::isotropic(1e9, poisson).expect("Hooke");
    let laws = Materials::new(vec![(3, hooke(0.3)), (7, hooke(poisson))]).expect("laws");
    Scene::new(both.with_regions(regions).expect("regions"), laws)
        .with_support(Support::fixed(brick::Z_MIN))
        .with_load(Load::pressure(second(brick::Z_MAX), 1.0))
        .with_contact(Contact::between(second(brick::Z_MIN), brick::Z_MAX).with_friction(Friction::coulomb(9.0)))
        .with_groups(
            [
                ("sole", second(brick::Z_MIN)),
                ("table", brick::Z_MAX),
                ("roof", second(brick::Z_MAX)),
            ],
            [("base", 3), ("pad", 7)],
        )
}

#[test]
fn warnings_name_sides_and_bodies() {
    let plan = Plan::new(&named(1, 0.49), &Settings::default()).expect("plan");
    let told: Vec<String> = plan.warnings().iter().map(ToString::to_string).collect();
    let starts = |with: &str| told.iter().any(|warning| warning.starts_with(with));
    assert!(starts("region 7 is pad: region 7 has a Poisson's ratio"), "{told:?}");
    // the coarser side has the points
    assert!(
        starts("contact 0 is that of sole and table, node 18 is in base: contact 0 begins"),
        "{told:?}"
    );
}

#[test]
fn errors_name_bodies_loads_and_supports() {
    for order in [1, 2] {
        let loose = Scene::new(named(order, 0.3).mesh().clone(), uniform(1e9, 0.3))
            .with_support(Support::fixed(brick::Z_MIN))
            .with_load(Load::pressure(second(brick::X_MAX), f64::MAX))
            .with_groups([("side", second(brick::X_MAX))], [("pad", 7)]);
        let error = refused(&loose).to_string();
        assert!(error.starts_with("load 0 is that on side: "), "{error}");
        let free = Scene::new(named(order, 0.3).mesh().clone(), uniform(1e9, 0.3))
            .with_support(Support::fixed(brick::Z_MIN))
            .with_load(Load::pressure(second(brick::X_MAX), 1.0))
            .with_groups([], [("pad", 7)]);
        // only the set-up can say so
        let error = Simulation::new(free, Settings::default()).map(|_| ());
        let error = error.expect_err("not held").to_string();
        assert!(error.contains(" is in pad"), "{error}");
    }
}

#[test]
fn errors_name_springs_and_couplings() {
    let scene = || {
        let side = Coupling::rigid(brick::X_MAX, [1.0; 3]).with_axis([0.0; 3]);
        Scene::new(block([1.0; 3], [2; 3]), uniform(1e9, 0.3))
            .with_support(Support::fixed(brick::Z_MIN))
            .with_coupling(side)
    };
    let groups = |scene: Scene| scene.with_groups([("side", brick::X_MAX), ("ground", brick::X_MIN)], []);
    let told = |scene: Scene| refused(&groups(scene)).to_string();
    let coupling = told(scene());
    assert!(coupling.starts_with("coupling 0 is that of side: "), "{coupling}");
    let spring = told(scene().with_spring(Spring::normal(brick::X_MIN, -1.0)));
    assert!(spring.starts_with("spring 0 is that of ground: "), "{spring}");
    let force = Load::on_coupling(0, [f64::NAN; 3], [0.0; 3]);
    let load = told(scene().with_load(force.with_history(History::constant(f64::NAN))));
    assert!(load.starts_with("load 0 is that on side: "), "{load}");
}
