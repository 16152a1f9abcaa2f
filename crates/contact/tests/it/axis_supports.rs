//! Supports along radial, tangential and axial directions, and moments.

use crate::common::*;
use signorini_contact::Directions;
use signorini_fem_mesh::vec3::{add, cross, norm, scale, sub};

const POINT: [f64; 3] = [0.3, -0.2, 0.1];
/// Not along a coordinate, and not of unit length.
const AXIS: [f64; 3] = [1.0, 2.0, 2.0];

/// Unit vectors: two across the axis, and the axis.
const FRAME: [[f64; 3]; 3] = [
    [2.0 / 3.0, 1.0 / 3.0, -2.0 / 3.0],
    [-2.0 / 3.0, 2.0 / 3.0, -1.0 / 3.0],
    [1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0],
];

fn place([a, b, c]: [f64; 3]) -> [f64; 3] {
    let [u, v, w] = FRAME;
    add(POINT, add(scale(a, u), add(scale(b, v), scale(c, w))))
}

/// A sector of a tube, x of the brick the radius from 1 to 2, y the angle, z along the axis.
fn sector(angle: f64, cells: [usize; 3]) -> TetMesh {
    let brick = block([1.0, angle, 0.5], cells);
    let bent = brick.map_points(|[x, y, z]| place([(1.0 + x) * y.cos(), (1.0 + x) * y.sin(), z]));
    bent.expect("sector")
}

fn held(tag: FacetTag, components: [bool; 3]) -> Support {
    Support::components(tag, components).with_axis(POINT, AXIS)
}

fn solved(scene: Scene, tolerance: f64) -> std::sync::Arc<StepResult> {
    let result = Simulation::new(scene, at(tolerance))
        .expect("set-up")
        .step()
        .expect("step");
    assert!(result.report().status.converged());
    result
}

/// All of the bore moves by the same tangential way, and the rest is free to be strained: it turns as a rigid body.
#[test]
fn a_bore_that_turns_takes_the_tube_along() {
    let angle = 1e-3;
    for boxes in [[1, 1, 1], [2, 3, 1]] {
        let turned = held(brick::X_MIN, [false, true, true]).with_motion([0.0, angle, 0.0], History::constant(1.0));
        let scene = Scene::new(sector(2.0, [2, 8, 1]), steel())
            .with_support(turned)
            .with_boxes(boxes);
        // no forces but rounding: less cannot be asked for
        let result = solved(scene, 1e-6);
        for (u, x) in result.displacement().iter().zip(result.scene().mesh().points()) {
            let rigid = cross(scale(angle, FRAME[2]), sub(*x, POINT));
            assert!(norm(sub(*u, rigid)) < 1e-8 * angle, "{u:?} {rigid:?}");
        }
    }
}

/// Planes through the axis are held tangentially, which is along their normals, and the bore is opened radially.
#[test]
fn an_opened_bore_is_the_same_by_vectors() {
    let angle = 0.9_f64;
    let mesh = sector(angle, [3, 4, 1]);
    let way = 1e-3;
    let open = History::constant(1.0);
    let scene = |bore: Support, planes: [Support; 2]| {
        let [first, second] = planes;
        let scene = Scene::new(mesh.clone(), steel()).with_support(bore.clone());
        let axial = Support::partial(brick::Z_MIN, Directions::Vectors(vec![AXIS]));
        scene.with_support(first).with_support(second).with_support(axial)
    };
    let tangential = [brick::Y_MIN, brick::Y_MAX].map(|tag| held(tag, [false, true, false]));
    let opened = held(brick::X_MIN, [true, false, false]).with_motion([way, 0.0, 0.0], open.clone());
    let by_axis = solved(scene(opened, tangential), 1e-10);

    let normal = |a: f64| Directions::Vectors(vec![sub(place([-a.sin(), a.cos(), 0.0]), POINT)]);
    let planes = [(brick::Y_MIN, 0.0), (brick::Y_MAX, angle)].map(|(tag, a)| Support::partial(tag, normal(a)));
    let radial = |node: &u32| {
        let arm = sub(mesh.points()[*node as usize], POINT);
        let along = sub(arm, scale(signorini_fem_mesh::vec3::dot(arm, FRAME[2]), FRAME[2]));
        scale(1.0 / norm(along), along)
    };
    let nodes = mesh.nodes_on(brick::X_MIN);
    let units: Vec<[f64; 3]> = nodes.iter().map(radial).collect();
    let lists = units.iter().map(|u| vec![*u]).collect();
    let ways = units.iter().map(|u| scale(way, *u)).collect();
    let opened = Support::partial(nodes, Directions::EachNode(lists)).with_motions(ways, open);
    let by_vectors = solved(scene(opened, planes), 1e-10);
    let (a, b) = (by_axis.displacement(), by_vectors.displacement());
    assert!(distance(a.as_flattened(), b.as_flattened()) < 1e-8);
}

/// A moment on the rim is carried by the bore.
#[test]
fn the_torque_arrives_at_the_bore() {
    let torque = scale(3e6, FRAME[2]);
    let scene = Scene::new(sector(2.0, [2, 8, 1]), steel())
        .with_support(held(brick::X_MIN, [true, true, true]))
        .with_load(Load::moment(brick::X_MAX, torque));
    let result = solved(scene, 1e-10);
    for about in [[0.0; 3], POINT] {
        let support = result.reactions_about(about).supports[0].resultant;
        assert!(norm(add(support.moment, torque)) < 1e-6 * 3e6, "{support:?}");
        assert!(norm(support.force) < 1e-6 * 3e6, "{support:?}");
    }
}

#[test]
fn what_is_no_axis_is_refused() {
    let disc = block([1.0; 3], [2; 3]);
    let error = |support: Support| {
        let scene = Scene::new(disc.clone(), steel()).with_support(support);
        Simulation::new(scene, Settings::default()).expect_err("refused")
    };
    let end = |on: [bool; 3]| Support::components(brick::Z_MIN, on);
    for (point, axis) in [
        ([0.0; 3], [0.0; 3]),
        ([f64::NAN, 0.0, 0.0], AXIS),
        ([0.0; 3], [f64::INFINITY; 3]),
    ] {
        let found = error(end([true; 3]).with_axis(point, axis));
        assert!(matches!(found, ContactError::SupportAxis { support: 0, .. }), "{found}");
    }
    // the node in the middle of the end
    let (middle, up) = ([0.5, 0.5, 7.0], [0.0, 0.0, -2.0]);
    let found = error(end([true, false, false]).with_axis(middle, up));
    assert!(matches!(found, ContactError::OnAxis { support: 0, .. }), "{found}");
    assert_eq!(found.parts().len(), 2, "{found}");
    for count in [1, 2] {
        let list = Support::partial(brick::Z_MIN, Directions::EachNode(vec![vec![AXIS]; count]));
        for support in [list.clone(), list.with_axis([5.0; 3], up)] {
            let found = error(support);
            let wanted = format!("support 0: {count} lists of directions for 9 nodes; give one for each");
            assert_eq!(found.to_string(), wanted);
        }
    }
    // axial alone needs no radius
    let scene = Scene::new(disc.clone(), steel())
        .with_support(end([false, false, true]).with_axis(middle, up))
        .with_support(Support::fixed(brick::X_MIN));
    solved(scene.with_load(Load::pressure(brick::Z_MAX, 1e6)), 1e-6);
}
