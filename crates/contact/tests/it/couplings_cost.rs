//! Couplings and what they cost: by the other methods, and on springs.

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
