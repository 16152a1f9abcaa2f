//! Reactions of supports: balance with contact and loads, known values, and nothing that depends on how the scene is solved.

mod common;

use common::{
    assert_close, block, methods, norm, ramp, run, small_benchmark, solve, tight, uniform,
    weakening,
};
use signorini_contact::{
    Contact, Directions, Friction, Load, Reactions, Scene, Settings, Simulation, Support,
};
use signorini_fem_mesh::{FacetTag, Hooke, Materials, Surface, brick};
use signorini_tfeti::RowScaling;

fn reactions(simulation: &Simulation, point: [f64; 3]) -> Reactions {
    let frame = simulation.frame().expect("frame");
    frame.reactions_about(point).expect("reactions")
}

fn assert_balance(simulation: &Simulation, tolerance: f64, what: &str) {
    for point in [[0.0; 3], [3.0, -2.0, 0.5]] {
        let r = reactions(simulation, point);
        assert_eq!(r.point, point);
        let rest = r.imbalance();
        let size = |f: fn(&signorini_contact::Resultant) -> [f64; 3]| {
            let parts = r.supports.iter().map(|s| norm(&f(&s.resultant)));
            parts.sum::<f64>() + norm(&f(&r.contact)) + norm(&f(&r.loads))
        };
        assert!(
            norm(&rest.force) <= tolerance * size(|r| r.force),
            "{what}: {rest:?}"
        );
        assert!(
            norm(&rest.moment) <= tolerance * size(|r| r.moment),
            "{what}: {rest:?}"
        );
    }
}

#[test]
fn supports_contact_and_loads_are_in_balance() {
    for method in methods() {
        let scene = small_benchmark(weakening(), 4);
        let settings = Settings::default().with_method(method.clone());
        let mut simulation = Simulation::new(scene, settings).expect("set-up");
        while !simulation.is_finished() {
            let frame = simulation.step().expect("step");
            let (load, sum) = (frame.load_resultant(), *frame.summary());
            let r = frame.reactions().expect("reactions");
            assert_eq!(r.supports.len(), 1);
            assert_close(&r.loads.force, &load, 1e-14, "loads");
            if sum.active > 0 {
                assert_close(&r.contact.force, &sum.resultant, 1e-14, "contact");
            }
            assert_balance(&simulation, 1e-6, method.name());
        }
    }
}

/// A column on a smooth support, held sideways by planes of symmetry: the stress is uniform.
fn column() -> Scene {
    Scene::new(block([2.0, 1.0, 3.0], [4, 2, 5]), uniform(1000.0, 0.3))
        .with_support(Support::components(brick::Z_MIN, [false, false, true]))
        .with_support(Support::components(brick::X_MIN, [true, false, false]))
        .with_support(Support::components(brick::Y_MIN, [false, true, false]))
}

#[test]
fn a_pressed_column_has_the_reaction_of_its_pressure_at_every_node() {
    let pressure = 7.0;
    for boxes in [[1; 3], [2, 1, 3], [4, 2, 5]] {
        let scene = column()
            .with_load(Load::pressure(brick::Z_MAX, pressure))
            .with_boxes(boxes);
        let foot = Surface::new(scene.mesh(), &[brick::Z_MIN]).expect("surface");
        let (simulation, _) = run(scene, tight());
        let r = reactions(&simulation, [1.0, 0.5, 0.0]);
        let [stand, x, y] = &r.supports[..] else {
            panic!("three supports")
        };
        // p A upwards, in the middle
        let force = 2.0 * pressure;
        assert!((stand.resultant.force[2] - force).abs() <= 1e-8 * force);
        assert!(norm(&stand.resultant.moment) <= 1e-7 * force, "{stand:?}");
        assert!(norm(&x.resultant.force) + norm(&y.resultant.force) <= 1e-7 * force);
        assert_eq!(stand.nodes.len(), foot.nodes().len());
        for (node, area) in foot.nodes().iter().zip(foot.areas()) {
            let found = stand
                .nodes
                .iter()
                .find(|n| n.node == *node)
                .expect("a node");
            assert!(
                (found.force[2] - pressure * area).abs() <= 1e-7 * force,
                "{found:?}"
            );
            // a smooth support has no force along its plane
            assert_eq!(found.force[..2], [0.0; 2]);
        }
    }
}

#[test]
fn a_moved_support_pulls_with_the_force_of_the_strain() {
    // E A d / L at half of the ramp
    let (stretch, expected) = (0.01, 1000.0 * 2.0 * (0.5 * 0.01) / 3.0);
    let scene = column()
        .with_support(
            Support::components(brick::Z_MAX, [false, false, true])
                .with_motion([0.0, 0.0, stretch], ramp()),
        )
        .with_boxes([2, 1, 2])
        .with_analysis(signorini_contact::Analysis::quasistatic(1.0, 2));
    let mut simulation = Simulation::new(scene, tight()).expect("set-up");
    let frame = simulation.step().expect("step");
    let r = frame.reactions().expect("reactions");
    for (k, sign) in [(0, -1.0), (3, 1.0)] {
        let found = r.supports[k].resultant.force[2];
        assert!(
            (found - sign * expected).abs() <= 1e-7 * expected,
            "{k}: {found}"
        );
    }
    assert_eq!(norm(&r.loads.force) + norm(&r.contact.force), 0.0);
    assert_balance(&simulation, 1e-7, "moved");
}

#[test]
fn cuts_rows_and_materials_change_no_reaction() {
    let scene = |two: bool| {
        let mut mesh = block([3.0, 1.0, 1.0], [6, 2, 2]);
        let hooke = |young| Hooke::isotropic(young, 0.3).expect("Hooke");
        let mut materials = Materials::uniform(hooke(1e4));
        if two {
            let regions = mesh
                .tets()
                .iter()
                .map(|t| u32::from(t.iter().all(|&n| mesh.points()[n as usize][0] <= 1.0)))
                .collect();
            mesh = mesh.with_regions(regions).expect("regions");
            materials = Materials::new(vec![(0, hooke(1e4)), (1, hooke(1e2))]).expect("materials");
        }
        Scene::new(mesh, materials)
            .with_support(Support::fixed(brick::X_MIN))
            .with_load(Load::traction(brick::Z_MAX, [3.0, 1.0, -30.0]))
            .with_contact(
                Contact::rigid(brick::Z_MIN)
                    .with_gap(0.002)
                    .with_friction(Friction::coulomb(0.3)),
            )
    };
    for two in [false, true] {
        let field = |scene: Scene, settings: Settings| {
            let (simulation, _) = run(scene, settings);
            assert_balance(&simulation, 1e-7, "any");
            let field = simulation.frame().expect("frame").reaction_field();
            let r = reactions(&simulation, [0.0; 3]);
            for part in &r.supports[0].nodes {
                assert_close(
                    &part.force,
                    &field[3 * part.node as usize..][..3],
                    1e-14,
                    "node",
                );
            }
            field
        };
        let whole = field(scene(two), tight());
        assert!(norm(&whole) > 1.0);
        for boxes in [[3, 1, 1], [6, 2, 2]] {
            let cut = || scene(two).with_boxes(boxes);
            let same = |settings: Settings, what: &str| {
                assert_close(&field(cut(), settings), &whole, 1e-6, what);
            };
            same(tight(), "cut");
            same(tight().with_row_scaling(RowScaling::Chained), "chained");
        }
    }
}

#[test]
fn what_two_supports_share_is_counted_once_for_the_first() {
    let scene = |first: Support, second: Support| {
        Scene::new(block([2.0, 1.0, 1.0], [4, 2, 2]), uniform(1e4, 0.3))
            .with_support(first)
            .with_support(second)
            .with_load(Load::body([1.0, 2.0, -3.0]))
            .with_boxes([2, 1, 1])
    };
    let edge = |tag: FacetTag, scene: &Scene| scene.mesh().nodes_on(tag).len();
    // all directions twice along an edge
    let both = scene(Support::fixed(brick::X_MIN), Support::fixed(brick::Y_MIN));
    let (left, front) = (edge(brick::X_MIN, &both), edge(brick::Y_MIN, &both));
    let (simulation, _) = run(both, tight());
    let r = reactions(&simulation, [0.0; 3]);
    assert_eq!(
        [r.supports[0].nodes.len(), r.supports[1].nodes.len()],
        [left, front - 3]
    );
    assert_balance(&simulation, 1e-8, "doubled");
    // another component at the same nodes: each support has its own
    let parts = scene(
        Support::components(brick::X_MIN, [true, false, true]),
        Support::components(brick::X_MIN, [false, true, false]),
    );
    let (simulation, _) = run(parts, tight());
    let r = reactions(&simulation, [0.0; 3]);
    let force = |k: usize| r.supports[k].resultant.force;
    assert_close(&force(0), &[-2.0, 0.0, 6.0], 1e-8, "x and z");
    assert_close(&force(1), &[0.0, -4.0, 0.0], 1e-8, "y");
    // an oblique one: the later has what it adds at right angles to the first
    let oblique = scene(
        Support::components(brick::X_MIN, [true, false, true]),
        Support::partial(brick::X_MIN, Directions::Vectors(vec![[3.0, 4.0, 0.0]])),
    );
    let (simulation, _) = run(oblique, tight());
    let r = reactions(&simulation, [0.0; 3]);
    assert_close(
        &r.supports[1].resultant.force,
        &[0.0, -4.0, 0.0],
        1e-8,
        "oblique",
    );
    assert_balance(&simulation, 1e-8, "oblique");
}

#[test]
fn a_free_body_on_a_floor_has_no_reactions_but_contact() {
    let scene = Scene::new(block([1.0; 3], [2; 3]), uniform(1e4, 0.3))
        .with_load(Load::body([0.0, 0.0, -5.0]))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.3)))
        .with_boxes([2, 1, 1]);
    let level = solve(scene.clone(), tight());
    let (simulation, _) = run(scene, tight());
    let r = reactions(&simulation, [0.5, 0.5, 0.0]);
    assert!(r.supports.is_empty());
    assert!((r.contact.force[2] - 5.0).abs() <= 1e-7 && norm(&r.contact.moment) <= 1e-6);
    assert!((level.summary.normal_force - 5.0).abs() <= 1e-7);
    let field = simulation.frame().expect("frame").reaction_field();
    assert!(field.iter().all(|v| *v == 0.0));
}

/// A block on a block on a floor, pressed and pushed: each contact surface has its own force, and the field of contact forces
/// has them at the nodes, opposite at partners.
#[test]
fn each_contact_surface_has_its_force() {
    let second = |tag: FacetTag| FacetTag(tag.0 + 100);
    let lower = block([1.0; 3], [2; 3]);
    let upper = lower
        .map_points(|[x, y, z]| [x, y, z + 1.0])
        .expect("moved");
    let count = lower.points().len();
    let mesh = lower.append(&upper.map_tags(second)).expect("bodies");
    let rough = |contact: Contact| contact.with_friction(Friction::coulomb(0.3));
    let scene = Scene::new(mesh, uniform(1e4, 0.3))
        .with_load(Load::traction(second(brick::Z_MAX), [1.0, 0.0, -10.0]))
        .with_load(Load::body([0.0, 0.0, -2.0]))
        .with_contact(rough(Contact::rigid(brick::Z_MIN)))
        .with_contact(rough(Contact::between(second(brick::Z_MIN), brick::Z_MAX)))
        .with_boxes([1, 1, 2]);
    let (simulation, _) = run(scene, tight());
    let frame = simulation.frame().expect("frame");
    let r = frame.reactions().expect("reactions");
    let [floor, joint] = r.contacts[..] else {
        panic!("two surfaces")
    };
    assert_close(&r.contact.force, &floor.force, 1e-12, "floor alone");
    assert_close(&floor.force, &[-1.0, 0.0, 14.0], 1e-7, "floor");
    assert_close(&joint.force, &[-1.0, 0.0, 12.0], 1e-7, "joint");
    let field = frame.contact_force_field();
    let sum = |nodes: std::ops::Range<usize>| {
        let mut sum = [0.0; 3];
        nodes.for_each(|n| (0..3).for_each(|c| sum[c] += field[3 * n + c]));
        sum
    };
    assert_close(&sum(count..2 * count), &joint.force, 1e-12, "upper");
    let lower = [0, 1, 2].map(|c| floor.force[c] - joint.force[c]);
    assert_close(&sum(0..count), &lower, 1e-12, "lower");
    for point in frame.points() {
        assert_close(&point.normal, &[0.0, 0.0, -1.0], 1e-14, "normal");
        assert!((point.force()[2] + point.normal_force).abs() <= 1e-12);
    }
}

/// Supports that hold nodes in contact along directions with contact forces: the forces of obstacles and partners are not
/// theirs.
#[test]
fn reactions_at_contact_nodes_have_no_contact_forces() {
    let second = |tag: FacetTag| FacetTag(tag.0 + 100);
    let lower = block([1.0; 3], [2; 3]);
    let upper = lower
        .map_points(|[x, y, z]| [x, y, z + 1.0])
        .expect("moved");
    let mesh = lower.append(&upper.map_tags(second)).expect("bodies");
    // pushed by a face with contact nodes until it slides, on either side of the contact
    for sides in [
        [second(brick::Z_MIN), brick::Z_MAX],
        [brick::Z_MAX, second(brick::Z_MIN)],
    ] {
        let joint = Contact::between(sides[0], sides[1]).with_friction(Friction::coulomb(0.3));
        let push = Support::components(second(brick::X_MIN), [true, false, false]);
        let scene = Scene::new(mesh.clone(), uniform(1e4, 0.3))
            .with_support(Support::fixed(brick::Z_MIN))
            .with_support(push.with_motion([0.1, 0.0, 0.0], ramp()))
            .with_load(Load::pressure(second(brick::Z_MAX), 10.0))
            .with_contact(joint)
            .with_boxes([1, 1, 2]);
        let (simulation, levels) = run(scene, tight());
        assert_eq!(levels[0].summary.stick, 0);
        assert_balance(&simulation, 1e-7, "between");
        let r = reactions(&simulation, [0.0; 3]);
        let [held, push] = [0, 1].map(|k| r.supports[k].resultant.force[0]);
        assert!(
            (push - 3.0).abs() < 1e-6 && (held + 3.0).abs() < 1e-6,
            "{push} {held}"
        );
    }
    // a guide that is oblique to the floor
    let oblique = Directions::Vectors(vec![[1.0, 0.0, 1.0]]);
    for friction in [Friction::None, Friction::coulomb(0.3)] {
        let scene = Scene::new(lower.clone(), uniform(1e4, 0.3))
            .with_support(Support::partial(brick::X_MIN, oblique.clone()))
            .with_support(Support::components(brick::Y_MIN, [false, true, false]))
            .with_load(Load::traction(brick::Z_MAX, [1.0, 0.0, -10.0]))
            .with_contact(Contact::rigid(brick::Z_MIN).with_friction(friction))
            .with_boxes([2, 1, 1]);
        let (simulation, _) = run(scene, tight());
        assert_balance(&simulation, 1e-7, "oblique");
    }
}
