//! Couplings that are refused, what a plan says of others, and bodies of other scales beside them.

use crate::common::*;
use crate::couplings::{MOTION, POINT, YOUNG, bar, end, moved};

/// Coupled nodes against nodes that supports hold have no determined forces, nor have two couplings.
#[test]
fn rigid_sides_do_not_touch() {
    let lower = Brick::new([1.0; 3], [2; 3]).build().expect("brick");
    let upper = lower.map_points(|[x, y, z]| [x, y, z + 1.0]).expect("moved");
    let mesh = with_second(&lower, &upper);
    let scene = |below: bool| {
        let scene = Scene::new(mesh.clone(), uniform(YOUNG, 0.3))
            .with_support(Support::fixed(brick::Z_MIN))
            .with_contact(Contact::between(brick::Z_MAX, second(brick::Z_MIN)))
            .with_coupling(Coupling::rigid(second(brick::Z_MIN), POINT));
        if below {
            scene.with_support(Support::components(brick::Z_MAX, [false, false, true]))
        } else {
            scene.with_coupling(Coupling::rigid(brick::Z_MAX, POINT))
        }
    };
    for below in [true, false] {
        let refused = Simulation::new(scene(below), Settings::default())
            .map(|_| ())
            .expect_err("rigid");
        assert!(refused.to_string().contains("rigid or held, too"), "{refused}");
    }
}

/// A small soft block beside a stiff one, each with its plate, is solved as if it were alone.
#[test]
fn couplings_do_not_know_of_stiffer_bodies() {
    for (young, size) in [(1e9, 1e-2), (1e7, 1e-2), (1e6, 1e-2), (1e6, 1e-3), (1e5, 1e-3)] {
        let big = block([1.0; 3], [3; 3]);
        let small = big
            .map_points(|x| [x[0] * size + 2.0, x[1] * size, x[2] * size])
            .expect("moved");
        let mesh = with_second(&big, &small);
        let soft = |t: usize| u32::from(mesh.tet_points(t)[0][0] > 1.5);
        let regions = (0..mesh.tets().len()).map(soft).collect();
        let law = |young: f64| Hooke::isotropic(young, 0.3).expect("Hooke");
        let materials = Materials::new(vec![(0, law(YOUNG)), (1, law(young))]).expect("materials");
        let (guided, force) = ([true, true, false, true, true, true], young * size * size * 1e-3);
        let scene = Scene::new(mesh.with_regions(regions).expect("regions"), materials)
            .with_support(Support::fixed(brick::Z_MIN))
            .with_support(Support::fixed(second(brick::Z_MIN)))
            .with_coupling(Coupling::rigid(second(brick::Z_MAX), [2.0, 0.0, size]).with_held(guided))
            .with_coupling(Coupling::rigid(brick::Z_MAX, [0.5, 0.5, 1.0]))
            .with_load(Load::on_coupling(0, [0.0, 0.0, -force], [0.0; 3]))
            .with_load(Load::on_coupling(1, [0.0, 0.0, -1e8], [0.0; 3]))
            .with_subdomains(4);
        let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
        let one = step(&mut simulation);
        let largest = one.certificate.largest();
        assert!(largest <= 2e-6, "{young:e} {size:e}: {largest:e} {:?}", one.report);
        let [small, big] = simulation.result().expect("a step").couplings()[..] else {
            panic!("two")
        };
        let [small, big] = [small.displacement[2] / size / 1e-3, big.displacement[2] * YOUNG / 1e8];
        // the plates are guided and free
        assert!((small / big - 1.0).abs() < 0.1, "{small} {big}");
        let products = one.report.counters.products;
        assert!(products < 30, "{young:e} {size:e}: {products}");
    }
}

/// Where a held coupling takes its load and nothing moves, lengths are measured by what the load would do to a node.
#[test]
fn a_load_that_moves_nothing_is_certified() {
    for boxes in [[1, 1, 1], [3, 1, 2]] {
        let plain = bar(boxes);
        let scene = Scene::new(plain.mesh().clone(), uniform(YOUNG, 0.3))
            .with_support(Support::fixed(brick::X_MIN))
            .with_coupling(end().with_held([true; 6]))
            .with_load(Load::on_coupling(0, [1e7, -2e7, 3e7], [1e6, 0.0, -1e6]))
            .with_boxes(boxes);
        let one = solve(scene, at(1e-9));
        assert!(one.certificate.largest() <= 1e-9, "{:?}", one.certificate);
    }
}

/// Each fault is refused with its place.
#[test]
fn faults_are_refused() {
    let refuse = |scene: Scene, words: &[&str]| {
        let error = Simulation::new(scene, Settings::default())
            .map(|_| ())
            .expect_err(words[0]);
        let text = error.to_string();
        assert!(words.iter().all(|w| text.contains(w)), "{words:?}: {text}");
    };
    let with = |coupling: Coupling| bar([2, 1, 1]).with_coupling(coupling);
    refuse(
        with(Coupling::rigid(FacetTag(77), POINT)),
        &["coupling 0", "no facet has the tag 77"],
    );
    refuse(
        with(Coupling::rigid([1, 999_999], POINT)),
        &["coupling 0, node 999999", "no such node"],
    );
    refuse(with(Coupling::rigid([3, 4, 5], POINT)), &["coupling 0", "on one line"]);
    refuse(
        with(Coupling::rigid([6, 20], POINT)),
        &["coupling 0", "less than three"],
    );
    refuse(
        with(Coupling::rigid(brick::X_MAX, [f64::NAN, 0.0, 0.0])),
        &["coupling 0", "must be finite"],
    );
    let infinite = end().with_held([true; 6]).with_motion([f64::INFINITY; 6], moved());
    refuse(with(infinite), &["coupling 0", "must be finite"]);
    let idle = end().with_motion([0.0, 0.0, 1e-3, 0.0, 0.0, 0.0], moved());
    refuse(with(idle), &["coupling 0", "does not hold is prescribed"]);
    let far = Coupling::rigid(brick::X_MAX, [2e6, 0.0, 0.0]).with_held([true; 6]);
    refuse(with(far), &["coupling 0", "a million times as far"]);
    let thin = |off: f64| {
        let mesh = bar([1; 3]).mesh().clone();
        let node = |x: [f64; 3]| mesh.points().iter().position(|p| *p == x).expect("a corner");
        let corners = [[2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [2.0, 1.0 / 3.0, 0.0]].map(node);
        let shift = corners[2];
        let moved = mesh.map_points(|x| if x == mesh.points()[shift] { [x[0], x[1], x[2] + off] } else { x });
        let scene = Scene::new(moved.expect("moved"), steel()).with_support(Support::fixed(brick::X_MIN));
        scene.with_coupling(Coupling::rigid(corners.map(|n| n as u32), POINT))
    };
    refuse(thin(1e-7), &["on one line"]);
    let wild = History::function(|_| f64::NAN);
    refuse(
        with(end().with_motion([0.0; 6], wild)),
        &["coupling 0", "its history gives NaN"],
    );
    let long = end()
        .with_held([true; 6])
        .with_motion([1e200, 0.0, 0.0, 0.0, 0.0, 0.0], moved());
    refuse(with(long), &["coupling 0", "too much"]);
    refuse(
        with(Coupling::rigid(brick::Z_MAX, POINT)),
        &["coupling 0", "a support holds it"],
    );
    refuse(with(end()).with_coupling(end()), &["coupling 1", "in another coupling"]);
    refuse(
        with(end()).with_load(Load::on_coupling(1, [1.0; 3], [0.0; 3])),
        &["load 1", "coupling 1 does not exist"],
    );
    let far = Load::on_coupling(usize::MAX, [1.0; 3], [0.0; 3]);
    refuse(with(end()).with_load(far), &["does not exist"]);
    refuse(
        with(end()).with_load(Load::on_coupling(0, [f64::NAN; 3], [0.0; 3])),
        &["must be finite"],
    );
    refuse(
        with(end()).with_contact(Contact::rigid(brick::X_MAX)),
        &["coupling 0, node", "rigid or held, too"],
    );
    let free = Scene::new(bar([1; 3]).mesh().clone(), steel()).with_coupling(end());
    refuse(
        free.with_load(Load::on_coupling(0, [1.0, 0.0, 0.0], [0.0; 3])),
        &["cannot be in equilibrium"],
    );
}

/// A coupling without effect costs nothing where there is none, and its plan counts its rows exactly.
#[test]
fn the_plan_counts_couplings() {
    let scene = bar([3, 1, 1]);
    let settings = Settings::default();
    let plain = Plan::new(&scene, &settings).expect("plan");
    let coupled = Plan::new(
        &scene.with_coupling(end().with_held([true, false, false, true, false, false])),
        &settings,
    );
    let coupled = coupled.expect("plan");
    assert!(coupled.effects.couplings && !plain.effects.couplings);
    let nodes = bar([1; 3]).mesh().nodes_on(brick::X_MAX).len();
    assert_eq!(coupled.interface_rows - plain.interface_rows, 3 * nodes);
    assert_eq!(coupled.dirichlet_rows - plain.dirichlet_rows, 2);
    assert_eq!(coupled.coarse - plain.coarse, 6);
    let alone = Scene::new(bar([1; 3]).mesh().clone(), steel());
    let moving = alone.with_coupling(end().with_held([true; 6]).with_motion(MOTION, moved()));
    let plan = Plan::new(&moving, &settings).expect("plan");
    assert!(
        plan.to_string().contains("6 rows, moving, couplings only") && plan.warnings().is_empty(),
        "{plan}"
    );
    let idle = moving.mesh().clone();
    let idle = Scene::new(idle, steel()).with_coupling(end().with_held([true; 6]).with_motion([0.0; 6], moved()));
    let plan = Plan::new(&idle, &settings).expect("plan");
    assert!(
        matches!(plan.warnings(), [Warning::NothingActs { held: true }]),
        "{plan}"
    );
}
