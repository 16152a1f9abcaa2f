//! Forces, moments and dissipation in every step: reactions of supports, contact and loads are in balance.

use crate::common::*;

/// Forces that the displacement of a step exerts on the nodes: K u, summed over the copies.
fn internal_forces(simulation: &Simulation, torn: &[f64]) -> Vec<[f64; 3]> {
    let mut sum = vec![[0.0; 3]; simulation.scene().mesh().points().len()];
    let mut force = vec![0.0; torn.len()];
    simulation.tfeti().stiffness_times(torn, &mut force);
    let subdomains = simulation.decomposition().subdomains();
    let nodes = subdomains.iter().flat_map(|s| &s.nodes);
    for (&node, f) in nodes.zip(force.chunks_exact(3)) {
        (0..3).for_each(|c| sum[node as usize][c] += f[c]);
    }
    sum
}

/// Nodal loads of the benchmark at time t.
fn loads(mesh: &TetMesh, t: f64) -> Vec<[f64; 3]> {
    let whole = Decomposition::whole(mesh);
    let mut sum = vec![[0.0; 3]; mesh.points().len()];
    for (tag, traction, factor) in [
        (brick::Z_MAX, [0.0, 0.0, -30e8], ramp().value(t)),
        (brick::X_MAX, [9e8, 0.0, -15e8], up_down_up().value(t)),
    ] {
        let local = assemble_load(mesh, &whole, &LoadDensity::Traction(tag, traction));
        for (node, f) in local.expect("load")[0].chunks_exact(3).enumerate() {
            (0..3).for_each(|c| sum[node][c] += factor * f[c]);
        }
    }
    sum
}

/// Sum and moment about the origin.
fn resultants(points: &[[f64; 3]], forces: &[[f64; 3]]) -> [f64; 6] {
    let mut sum = [0.0; 6];
    for (x, f) in points.iter().zip(forces) {
        let m = cross(*x, *f);
        for c in 0..3 {
            sum[c] += f[c];
            sum[3 + c] += m[c];
        }
    }
    sum
}

/// What K u leaves over is load, contact force or reaction of a support, node by node; and loads, contact forces and
/// reactions have neither resultant nor moment.
#[test]
fn forces_and_moments_are_in_balance() {
    for method in methods() {
        let scene = benchmark(up_down_up(), 10);
        let mesh = scene.mesh().clone();
        let fixed = mesh.nodes_on(brick::X_MIN);
        let (simulation, results) = run(scene, by(method));
        for (k, result) in results.iter().enumerate() {
            let load = loads(&mesh, result.time);
            let mut contact = vec![[0.0; 3]; mesh.points().len()];
            for p in &result.points {
                // outward normal (0, 0, -1)
                let f = p.friction_force;
                contact[p.node as usize] = [f[0], f[1], f[2] - p.normal_force];
            }
            let mut reaction = vec![[0.0; 3]; mesh.points().len()];
            let size = norm(&result.load);
            for (node, f) in internal_forces(&simulation, &result.torn).iter().enumerate() {
                let rest = [0, 1, 2].map(|c| f[c] - load[node][c] - contact[node][c]);
                if fixed.contains(&(node as u32)) {
                    reaction[node] = rest;
                } else {
                    assert!(norm(&rest) <= 1e-6 * size, "step {k}, node {node}: {rest:?}");
                }
            }
            let points = mesh.points();
            let [l, c, r] = [&load, &contact, &reaction].map(|f| resultants(points, f));
            let sum: Vec<f64> = (0..6).map(|i| l[i] + c[i] + r[i]).collect();
            // the longest arm is that of the opposite corner
            let good = norm(&sum[..3]) <= 1e-6 * size && norm(&sum[3..]) <= 3.3e-6 * size;
            assert!(good, "step {k}: {sum:?} of {size:e}");
            // the sums that the library reports are these
            for i in 0..3 {
                assert!((c[i] - result.summary.resultant[i]).abs() <= 1e-12 * size);
                assert!((l[i] - result.load[i]).abs() <= 1e-12 * size);
            }
        }
    }
}

/// Friction takes energy in every step, whatever the law and the formula.
#[test]
fn no_step_has_negative_dissipation() {
    let laws = [
        Friction::tresca(3e8),
        Friction::coulomb(0.05),
        Friction::coulomb(0.6),
        weakening(),
    ];
    for law in laws {
        for formula in [DifferenceFormula::PAPER, DifferenceFormula::BACKWARD_EULER] {
            let scene = small_benchmark(law.clone(), 20);
            let analysis = scene.analysis().clone().with_formula(formula);
            let (_, results) = run(scene.with_analysis(analysis), at(1e-8));
            let total: f64 = results.iter().map(|l| l.summary.dissipation).sum();
            assert!(total > 0.0, "{law:?}: nothing slides");
            for (k, result) in results.iter().enumerate() {
                let s = &result.summary;
                assert!(s.dissipation >= -1e-6 * total, "{law:?}, step {k}: {:e}", s.dissipation);
                for p in &result.points {
                    let work: f64 = (0..3).map(|c| p.friction_force[c] * p.difference[c]).sum();
                    assert!(work <= 1e-6 * total, "{law:?}, step {k}, node {}", p.node);
                    if p.state == ContactState::Open {
                        assert!(matches!(law, Friction::Tresca(_)) || norm(&p.friction_force) == 0.0);
                    }
                }
                if formula.weights()[2] == 0.0 {
                    assert!((s.dissipation - s.friction_work).abs() <= 1e-9 * total);
                }
            }
        }
    }
}

fn reactions(simulation: &Simulation, point: [f64; 3]) -> Reactions {
    let frame = simulation.result().expect("frame");
    frame.reactions_about(point)
}

fn assert_balance(simulation: &Simulation, tolerance: f64, what: &str) {
    for point in [[0.0; 3], [3.0, -2.0, 0.5]] {
        let r = reactions(simulation, point);
        assert_eq!(r.point, point);
        let rest = r.imbalance();
        let size = |f: fn(&Resultant) -> [f64; 3]| {
            let parts = r.supports.iter().map(|s| norm(&f(&s.resultant)));
            parts.sum::<f64>() + norm(&f(&r.contact)) + norm(&f(&r.loads))
        };
        assert!(norm(&rest.force) <= tolerance * size(|r| r.force), "{what}: {rest:?}");
        assert!(norm(&rest.moment) <= tolerance * size(|r| r.moment), "{what}: {rest:?}");
    }
}

#[test]
fn supports_contact_and_loads_are_in_balance() {
    for method in methods() {
        let scene = small_benchmark(weakening(), 4);
        let settings = by(method.clone());
        let mut simulation = Simulation::new(scene, settings).expect("set-up");
        while !simulation.is_finished() {
            let frame = simulation.step().expect("step");
            let (r, sum) = (frame.reactions(), *frame.summary());
            assert_eq!(r.supports.len(), 1);
            if sum.active > 0 {
                assert_close(&r.contact.force, &sum.resultant, 1e-14, "contact");
            }
            assert_balance(&simulation, 1e-6, &method.kind().to_string());
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
            let found = stand.nodes.iter().find(|n| n.node == *node).expect("a node");
            assert!((found.force[2] - pressure * area).abs() <= 1e-7 * force, "{found:?}");
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
        .with_support(Support::components(brick::Z_MAX, [false, false, true]).with_motion([0.0, 0.0, stretch], ramp()))
        .with_boxes([2, 1, 2])
        .with_analysis(paper_steps(1.0, 2));
    let mut simulation = Simulation::new(scene, tight()).expect("set-up");
    let frame = simulation.step().expect("step");
    let r = frame.reactions();
    for (k, sign) in [(0, -1.0), (3, 1.0)] {
        let found = r.supports[k].resultant.force[2];
        assert!((found - sign * expected).abs() <= 1e-7 * expected, "{k}: {found}");
    }
    assert_eq!(norm(&r.loads.force) + norm(&r.contact.force), 0.0);
    assert_balance(&simulation, 1e-7, "moved");
}

#[test]
fn partitions_rows_and_materials_change_no_reaction() {
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
            let field = simulation.result().expect("frame").reaction_field();
            let r = reactions(&simulation, [0.0; 3]);
            for part in &r.supports[0].nodes {
                assert_close(&part.force, &field[part.node as usize], 1e-14, "node");
            }
            field.into_flattened()
        };
        let whole = field(scene(two), tight());
        assert!(norm(&whole) > 1.0);
        for boxes in [[3, 1, 1], [6, 2, 2]] {
            let cut = || scene(two).with_boxes(boxes);
            let same = |settings: Settings, what: &str| {
                assert_close(&field(cut(), settings), &whole, 1e-6, what);
            };
            same(tight(), "cut");
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
    assert_close(&r.supports[1].resultant.force, &[0.0, -4.0, 0.0], 1e-8, "oblique");
    assert_balance(&simulation, 1e-8, "oblique");
}

#[test]
fn a_free_body_on_a_floor_has_no_reactions_but_contact() {
    let scene = Scene::new(block([1.0; 3], [2; 3]), uniform(1e4, 0.3))
        .with_load(Load::body([0.0, 0.0, -5.0]))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.3)))
        .with_boxes([2, 1, 1]);
    let result = solve(scene.clone(), tight());
    let (simulation, _) = run(scene, tight());
    let r = reactions(&simulation, [0.5, 0.5, 0.0]);
    assert!(r.supports.is_empty());
    assert!((r.contact.force[2] - 5.0).abs() <= 1e-7 && norm(&r.contact.moment) <= 1e-6);
    assert!((result.summary.normal_force - 5.0).abs() <= 1e-7);
    let field = simulation.result().expect("frame").reaction_field();
    assert!(field.iter().all(|v| *v == [0.0; 3]));
}

/// A block on a block on a floor, pressed and pushed: each contact surface has its own force, and the field of contact
/// forces has them at the nodes, opposite at partners.
#[test]
fn each_contact_surface_has_its_force() {
    let lower = block([1.0; 3], [2; 3]);
    let count = lower.points().len();
    let mesh = with_second(&lower, &lifted(&lower, 1.0));
    let rough = |contact: Contact| contact.with_friction(Friction::coulomb(0.3));
    let scene = Scene::new(mesh, uniform(1e4, 0.3))
        .with_load(Load::traction(second(brick::Z_MAX), [1.0, 0.0, -10.0]))
        .with_load(Load::body([0.0, 0.0, -2.0]))
        .with_contact(rough(Contact::rigid(brick::Z_MIN)))
        .with_contact(rough(Contact::between(second(brick::Z_MIN), brick::Z_MAX)))
        .with_boxes([1, 1, 2]);
    let (simulation, _) = run(scene, tight());
    let frame = simulation.result().expect("frame");
    let r = frame.reactions();
    let [floor, joint] = r.contacts[..] else {
        panic!("two surfaces")
    };
    assert_close(&r.contact.force, &floor.force, 1e-12, "floor alone");
    assert_close(&floor.force, &[-1.0, 0.0, 14.0], 1e-7, "floor");
    assert_close(&joint.force, &[-1.0, 0.0, 12.0], 1e-7, "joint");
    let field = frame.contact_force_field();
    let sum = |nodes: std::ops::Range<usize>| {
        let mut sum = [0.0; 3];
        nodes.for_each(|n| (0..3).for_each(|c| sum[c] += field[n][c]));
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

/// Supports that hold nodes in contact along directions with contact forces: the forces of obstacles and partners are
/// not theirs.
#[test]
fn reactions_at_contact_nodes_have_no_contact_forces() {
    let lower = block([1.0; 3], [2; 3]);
    let mesh = with_second(&lower, &lifted(&lower, 1.0));
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
        let (simulation, results) = run(scene, tight());
        assert_eq!(results[0].summary.stick, 0);
        assert_balance(&simulation, 1e-7, "between");
        let r = reactions(&simulation, [0.0; 3]);
        let [held, push] = [0, 1].map(|k| r.supports[k].resultant.force[0]);
        assert!((push - 3.0).abs() < 1e-6 && (held + 3.0).abs() < 1e-6, "{push} {held}");
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

/// A force on a coarse hole, of which three facets a quarter are inside the circle: loads and reactions sum to it all
/// the same, where pressure over the area of the circle loses a part.
#[test]
fn a_force_on_a_coarse_hole_arrives_whole() {
    let bend = |[r, angle, z]: [f64; 3]| {
        let (sin, cos) = (0.5 * std::f64::consts::PI * angle).sin_cos();
        [(1.0 + r) * cos, (1.0 + r) * sin, z]
    };
    let quarter = block([1.0; 3], [2, 3, 2])
        .map_points(bend)
        .expect("a quarter of a hole");
    let hole = Surface::new(&quarter, &[brick::X_MIN]).expect("hole");
    let circle = 0.5 * std::f64::consts::PI;
    assert!(hole.total_area() < 0.99 * circle);
    let force = [3e4, -1e4, 500.0];
    let loads = [
        Load::force(brick::X_MIN, force),
        Load::traction(brick::X_MIN, force.map(|f| f / circle)),
    ];
    for (load, whole) in loads.into_iter().zip([true, false]) {
        for boxes in [[1, 1, 1], [1, 3, 2]] {
            let scene = Scene::new(quarter.clone(), steel())
                .with_support(Support::fixed(brick::X_MAX))
                .with_load(load.clone())
                .with_boxes(boxes);
            let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
            let result = simulation.step().expect("step");
            let reaction = result.reactions().supports[0].resultant.force;
            let lost = norm(&[0, 1, 2].map(|c| reaction[c] + force[c])) / norm(&force);
            assert_eq!(lost < 1e-9, whole, "{boxes:?}: {lost:e}");
            let load = result.reactions().loads.force;
            let lost = norm(&[0, 1, 2].map(|c| load[c] - force[c])) / norm(&force);
            assert_eq!(lost < 1e-13, whole, "{boxes:?}: {lost:e}");
        }
    }
}

#[test]
fn a_node_that_a_support_names_twice_reacts_once() {
    let mesh = block([1.0; 3], [2, 2, 2]);
    let facets = mesh.facets().iter().filter(|f| f.tag == brick::Z_MIN);
    let named: Vec<u32> = facets.flat_map(|f| f.nodes).collect();
    assert!(named.len() > mesh.nodes_on(brick::Z_MIN).len());
    let scene = Scene::new(mesh, steel())
        .with_load(Load::force(brick::Z_MAX, [1e3, 0.0, -1e4]))
        .with_support(Support::fixed(named));
    let mut simulation = Simulation::new(scene, tight()).expect("set-up");
    let reactions = simulation.step().expect("step").reactions();
    let force = reactions.supports[0].resultant.force;
    assert!(norm(&[force[0] + 1e3, force[1], force[2] - 1e4]) < 1e-4, "{force:?}");
}

/// Loads in a region act on it alone: the weight of each of two bodies comes to its own support.
#[test]
fn the_weight_of_a_region_comes_to_its_support() {
    let mesh = with_second(&block([1.0; 3], [2; 3]), &lifted(&block([1.0, 1.0, 2.0], [2; 3]), 3.0));
    let regions = mesh.components();
    let mesh = mesh.with_regions(regions).expect("regions");
    let weights = [[0.0, 0.0, -7.0], [3.0, 0.0, -5.0]];
    let scene = Scene::new(mesh, uniform(1e6, 0.3))
        .with_support(Support::fixed(brick::Z_MIN))
        .with_support(Support::fixed(second(brick::Z_MIN)))
        .with_load(Load::body_in(0, weights[0]))
        .with_load(Load::body_in(1, weights[1]));
    let (simulation, _) = run(scene, at(1e-9));
    let reactions = simulation.result().expect("a result").reactions();
    let supports = reactions.supports.iter();
    for ((support, weight), volume) in supports.zip(weights).zip([1.0, 2.0]) {
        let expected = weight.map(|w| -w * volume);
        assert_close(&support.resultant.force, &expected, 1e-6, "reaction");
    }
}
