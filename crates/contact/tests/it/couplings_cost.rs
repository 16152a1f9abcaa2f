//! Couplings and what they cost: by the other methods, on springs, and on bodies much softer than others.

use crate::common::*;
use crate::couplings::{POINT, YOUNG, bar, moved, on_floor};

fn products(scene: Scene, settings: Settings) -> usize {
    solve(scene, settings).report.counters.products
}

/// Nodes of an end of a brick above its floor.
fn above_floor(mesh: &TetMesh, end: FacetTag) -> Vec<u32> {
    let nodes = mesh.nodes_on(end).into_iter();
    nodes.filter(|n| mesh.points()[*n as usize][2] > 1e-9).collect()
}

/// The methods of the paper, which know nothing of weights of rows, find what holds a coupling in the products of a
/// support, wherever its reference point is.
#[test]
fn other_methods_do_not_see_what_holds_a_coupling() {
    let sizes = |what: String, held: usize, supported: usize| {
        println!("{what}: {held}, supported {supported}");
        assert!(10 * held <= 16 * supported, "{what}: {held}, supported {supported}");
    };
    let (motion, axial) = ([1e-4, 0.0, 0.0], [1e-4, 0.0, 0.0, 0.0, 0.0, 0.0]);
    for boxes in [[2, 1, 1], [3, 2, 2]] {
        for method in [Method::paper(), Method::one_loop()] {
            let scene = || on_floor(bar(boxes));
            let nodes = above_floor(scene().mesh(), brick::X_MAX);
            let plate = Coupling::rigid(nodes.clone(), POINT).with_held([true; 6]);
            let held = scene().with_coupling(plate.with_motion(axial, moved()));
            let support = Support::fixed(nodes).with_motion(motion, moved());
            let [held, supported] = [held, scene().with_support(support)].map(|s| products(s, by(method.clone())));
            sizes(format!("{boxes:?}, {}", method.kind()), held, supported);
        }
    }
    // nothing else holds the body
    let mesh = block([2.0, 1.0, 1.0], [6, 3, 3]);
    let nodes = above_floor(&mesh, brick::X_MIN);
    let floor = Contact::rigid(brick::Z_MIN).with_gap_field(|x| if x[0] > 0.5 { 0.0 } else { 1.0 });
    for boxes in [[1, 1, 1], [6, 3, 3]] {
        let scene = Scene::new(mesh.clone(), uniform(YOUNG, 0.3))
            .with_load(Load::traction(brick::Y_MAX, [1e7, 0.0, -1e7]))
            .with_load(Load::pressure(brick::Z_MAX, 1e7))
            .with_contact(floor.clone().with_friction(Friction::coulomb(0.3)))
            .with_boxes(boxes);
        let far = Coupling::rigid(nodes.clone(), [-3.0, 4.0, 2.0]).with_held([true; 6]);
        for method in [Method::paper(), Method::one_loop()] {
            let both = [
                scene.clone().with_coupling(far.clone()),
                scene.clone().with_support(Support::fixed(nodes.clone())),
            ];
            let [held, supported] = both.map(|s| products(s, by(method.clone())));
            sizes(format!("alone, {boxes:?}, {}", method.kind()), held, supported);
        }
    }
}

/// Without contact, too: on springs softer and stiffer than the body.
#[test]
fn held_couplings_on_springs_are_supports() {
    for boxes in [[1, 1, 1], [3, 1, 1]] {
        for stiffness in [3e9, 3e11, 3e13] {
            let scene = Scene::new(block([2.0, 1.0, 1.0], [12, 6, 6]), uniform(YOUNG, 0.3))
                .with_load(Load::traction(brick::Y_MAX, [1e6, 0.0, -1e7]))
                .with_load(Load::pressure(brick::Z_MAX, 1e7))
                .with_spring(Spring::components(brick::Z_MIN, [stiffness; 3]))
                .with_boxes(boxes);
            let plate = Coupling::rigid(brick::X_MIN, [0.0, 0.5, 0.5]).with_held([true; 6]);
            let held = products(scene.clone().with_coupling(plate), Settings::default());
            let supported = products(scene.with_support(Support::fixed(brick::X_MIN)), Settings::default());
            assert!(
                held <= supported,
                "{stiffness:e}, {boxes:?}: {held}, supported {supported}"
            );
        }
    }
}

/// A stiff block, and a small soft one somewhere.
fn beside(young: f64, place: impl Fn([f64; 3]) -> [f64; 3]) -> Scene {
    let big = block([1.0; 3], [3; 3]);
    let small = big.map_points(place).expect("moved");
    let soft = |t: usize| u32::from(t >= big.tets().len());
    let mesh = with_second(&big, &small);
    let regions = (0..mesh.tets().len()).map(soft).collect();
    let law = |young: f64| Hooke::isotropic(young, 0.3).expect("Hooke");
    let materials = Materials::new(vec![(0, law(YOUNG)), (1, law(young))]).expect("materials");
    Scene::new(mesh.with_regions(regions).expect("regions"), materials)
        .with_support(Support::fixed(second(brick::Z_MIN)))
        .with_subdomains(4)
}

/// Each of two blocks that do not touch is pressed by its plate, free or guided, or by a traction: products are those
/// of a block alone, however much softer and smaller one is.
#[test]
fn plates_on_soft_blocks_cost_no_products() {
    let guided = [true, true, false, true, true, true];
    for (young, size) in [(1e7, 1e-2), (1e6, 1e-3), (1e5, 1e-3)] {
        for (on_soft, on_stiff, held) in [
            (true, false, false),
            (true, false, true),
            (false, true, false),
            (true, true, true),
        ] {
            let force = [0.0, 0.0, -young * size * size * 1e-3];
            let scene = beside(young, |x| [x[0] * size + 2.0, x[1] * size, x[2] * size]);
            let scene = scene.with_support(Support::fixed(brick::Z_MIN));
            let press = |scene: Scene, plate: bool, tag: FacetTag, at: [f64; 3], force: [f64; 3]| {
                if !plate {
                    return scene.with_load(Load::force(tag, force));
                }
                let own = Load::on_coupling(scene.couplings().len(), force, [0.0; 3]);
                let plate = Coupling::rigid(tag, at).with_held(if held { guided } else { [false; 6] });
                scene.with_coupling(plate).with_load(own)
            };
            let scene = press(scene, on_soft, second(brick::Z_MAX), [2.0, 0.0, size], force);
            let scene = press(scene, on_stiff, brick::Z_MAX, [0.5, 0.5, 1.0], [0.0, 0.0, -1e8]);
            let what = format!("{young:e} {size:e} {on_soft} {on_stiff} {held}");
            let one = step(&mut Simulation::new(scene, Settings::default()).expect("set-up"));
            let (largest, products) = (one.certificate.largest(), one.report.counters.products);
            assert!(largest < 3e-6 && products < 30, "{what}: {largest:e}, {products}");
        }
    }
}

/// A stiff block stands on a small soft one, guided by supports or by the plate that presses it.
#[test]
fn stiff_blocks_stand_on_soft_ones() {
    for (young, size) in [(1e9, 1e-2), (1e7, 1e-1), (1e7, 1e-2), (1e6, 1e-2)] {
        let low = |x: [f64; 3]| {
            [
                0.5 + (x[0] - 0.5) * size,
                0.5 + (x[1] - 0.5) * size,
                (x[2] - 1.0) * size,
            ]
        };
        let force = [0.0, 0.0, -young * size * size * 1e-3];
        let scene = beside(young, low)
            .with_contact(Contact::between(second(brick::Z_MAX), brick::Z_MIN))
            .with_support(Support::components(brick::X_MIN, [true, true, false]));
        let plate = Coupling::rigid(brick::Z_MAX, [0.5, 0.5, 1.0]).with_held([true, true, false, true, true, true]);
        let plate = scene
            .clone()
            .with_coupling(plate)
            .with_load(Load::on_coupling(0, force, [0.0; 3]));
        for scene in [scene.with_load(Load::force(brick::Z_MAX, force)), plate] {
            let one = step(&mut Simulation::new(scene, Settings::default()).expect("set-up"));
            let (largest, products) = (one.certificate.largest(), one.report.counters.products);
            assert!(
                largest < 3e-6 && products < 40,
                "{young:e} {size:e}: {largest:e}, {products}"
            );
        }
    }
}
