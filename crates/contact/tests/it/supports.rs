//! Supports that move: rigid motions cost little, dragged contact nodes have the friction of the law, planes of
//! symmetry.

use crate::common::*;

/// Displacements alone: no loads, no contact, forces from gluing and supports only.
#[test]
fn a_body_stretched_by_its_supports_is_certified() {
    let ramp = History::ramp(1.0, 1.0).expect("ramp");
    let scene = Scene::new(block([3.0, 1.0, 1.0], [6, 2, 2]), steel())
        .with_support(Support::fixed(brick::X_MIN))
        .with_support(Support::fixed(brick::X_MAX).with_motion([1e-3, 0.0, 0.0], ramp))
        .with_boxes([3, 1, 1])
        .with_analysis(paper_steps(1.0, 2));
    let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
    while !simulation.is_finished() {
        let frame = simulation.step().expect("step");
        let (status, certificate) = (frame.report().status, frame.certificate());
        assert!(status.converged(), "{status:?} {certificate:?}");
        assert!(certificate.largest() < 1e-6, "{certificate:?}");
    }
}

/// A thin plate glued to the ground: its torn subdomains bend by far more than the plate moves, and are no scale for
/// it.
#[test]
fn the_certificate_of_a_thin_bedded_plate_tells_its_error() {
    let scene = || {
        Scene::new(block([1.0, 0.2, 0.003], [20, 4, 2]), steel())
            .with_support(Support::fixed(brick::Z_MIN))
            .with_load(Load::new(LoadDensity::traction_field(
                brick::Z_MAX,
                |x: [f64; 3], _| [0.0, 0.0, -1e6 * f64::sin(7.0 * x[0])],
            )))
            .with_boxes([5, 1, 1])
            .with_analysis(Analysis::Static { time: 1.0 })
    };
    let solve = |tolerance: f64| {
        let settings = at(tolerance);
        let mut simulation = Simulation::new(scene(), settings).expect("set-up");
        let frame = simulation.step().expect("step");
        (
            frame.displacement(),
            frame.certificate().largest(),
            frame.report().status,
        )
    };
    let (exact, _, _) = solve(1e-10);
    for tolerance in [1e-2, 1e-4, 1e-6] {
        let (u, certificate, status) = solve(tolerance);
        let off = distance(u.as_flattened(), exact.as_flattened());
        println!("{tolerance:e}: error {off:.1e}, certificate {certificate:.1e}, {status:?}");
        assert!(!status.converged() || off < 30.0 * tolerance, "{tolerance:e}: {off:e}");
    }
}

/// A block on its top support, lowered on a floor.
fn lowered(gap: f64, depth: f64, tilt: [f64; 2]) -> Scene {
    let down = History::table(vec![(0.0, 0.0), (1.0, 1.0)]).expect("ramp");
    Scene::new(block([2.0, 1.0, 1.0], [8, 4, 4]), steel())
        .with_support(Support::fixed(brick::Z_MAX).with_motion([tilt[0], tilt[1], -depth], down))
        .with_contact(
            Contact::rigid(brick::Z_MIN)
                .with_gap(gap)
                .with_friction(Friction::coulomb(0.3)),
        )
        .with_boxes([2, 1, 1])
        .with_analysis(paper_steps(1.0, 10))
}

fn assert_cheap(result: &Solved, what: &str) {
    let report = &result.report;
    let parts = result.certificate.parts().map(|(n, v)| (n, v.relative()));
    assert!(report.status.converged(), "{what}: {report:?} {parts:?}");
    assert!(report.counters.products <= 60, "{what}: {report:?}");
}

#[test]
fn a_body_that_is_lowered_touches_at_the_right_step() {
    for (gap, depth, tilt) in [
        (1e-3, 2e-3, [0.0; 2]),
        (1e-3, 2e-3, [3e-4, 1e-4]),
        (0.99, 1.0, [0.1, 0.0]),
        (1e-3, 0.9e-3, [0.0; 2]),
    ] {
        let mut simulation = Simulation::new(lowered(gap, depth, tilt), Settings::default()).expect("set-up");
        while !simulation.is_finished() {
            let result = step(&mut simulation);
            let reach = depth * result.time;
            let what = format!("gap {gap}, depth {depth}, t = {}", result.time);
            assert_cheap(&result, &what);
            let touches = result.summary.normal_force > 1.0;
            assert_eq!(touches, reach > gap * (1.0 + 1e-9), "{what}");
        }
    }
}

/// Two supports that move alike: every step is a rigid motion.
#[test]
fn a_rigid_motion_costs_little() {
    let motion = [1e-3, -2e-3, 5e-4];
    let cases = [
        (false, Settings::default()),
        (true, Settings::default()),
        (true, at(1e-10)),
    ];
    for (contact, settings) in cases {
        let mut scene = Scene::new(block([2.0, 1.0, 1.0], [8, 4, 4]), steel())
            .with_support(Support::fixed(brick::X_MIN).with_motion(motion, ramp()))
            .with_support(Support::fixed(brick::X_MAX).with_motion(motion, ramp()))
            .with_boxes([3, 1, 1])
            .with_analysis(paper_steps(1.0, 5));
        if contact {
            let floor = Contact::rigid(brick::Z_MIN).with_gap(1e-2);
            scene = scene.with_contact(floor.with_friction(Friction::coulomb(0.3)));
        }
        let what = format!("contact {contact} to {:e}", settings.tolerance());
        let mut simulation = Simulation::new(scene, settings).expect("set-up");
        while !simulation.is_finished() {
            let result = step(&mut simulation);
            assert_cheap(&result, &what);
            for u in result.displacement.chunks_exact(3) {
                for (u, m) in u.iter().zip(motion) {
                    assert!((u - result.time * m).abs() < 1e-12, "{u:e}");
                }
            }
        }
    }
}

const COEFFICIENT: f64 = 0.3;
const PRESSURE: f64 = 1e3;

fn there_and_back() -> History {
    History::table(vec![(0.0, 0.0), (0.5, 1.0), (1.0, -1.0)]).expect("table")
}

fn pressed(friction: Friction, boxes: [usize; 3], steps: usize) -> Scene {
    Scene::new(block([2.0, 1.0, 1.0], [4, 2, 2]), uniform(1e7, 0.3))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(friction))
        .with_load(Load::pressure(brick::Z_MAX, PRESSURE))
        .with_boxes(boxes)
        .with_analysis(Analysis::quasistatic(1.0, steps))
}

/// All of the bottom is moved along (3, 4, 0) / 5 and back: friction mu N against it at every node, whatever the body
/// does.
fn dragged(method: Method, boxes: [usize; 3]) {
    let name = method.kind();
    let length = 1e-2;
    let way = [0.6 * length, 0.8 * length, 0.0];
    let scene = pressed(Friction::coulomb(COEFFICIENT), boxes, 8)
        .with_support(Support::components(brick::Z_MIN, [true, true, false]).with_motion(way, there_and_back()));
    let (mut work, mut before) = (0.0, 0.0);
    let (_, results) = run(scene, at(1e-9).with_method(method));
    for result in &results {
        let what = format!("{} {boxes:?} t = {}", name, result.time);
        let sign = if result.time <= 0.5 { -1.0 } else { 1.0 };
        let total = COEFFICIENT * 2.0 * PRESSURE;
        let friction = result.summary.friction_force;
        for (found, part) in friction.iter().zip([0.6, 0.8, 0.0]) {
            assert!((found - sign * part * total).abs() < 1e-5 * total, "{what}");
        }
        for point in &result.points {
            assert_eq!(point.state, ContactState::Slip, "{what}");
            let size = norm(&point.friction_force);
            assert!((size + COEFFICIENT * point.normal_force).abs() < 1e-6 * size);
        }
        let now = length * there_and_back().value(result.time);
        work += total * (now - before).abs();
        before = now;
    }
    let found: f64 = results.iter().map(|l| l.summary.friction_work).sum();
    assert!((found / work - 1.0).abs() < 1e-5, "{found} {work}");
}

#[test]
fn a_bottom_that_is_dragged_slides_with_friction() {
    for method in methods() {
        dragged(method, [1, 1, 1]);
    }
}

#[test]
fn a_bottom_of_two_parts_that_is_dragged_slides_with_friction() {
    for method in methods() {
        dragged(method, [2, 1, 1]);
    }
}

#[test]
fn a_bottom_of_eight_parts_that_is_dragged_slides_with_friction() {
    for method in methods() {
        dragged(method, [2, 2, 2]);
    }
}

/// The displacement is that without friction: the support takes all of it.
#[test]
fn what_is_dragged_moves_as_without_friction() {
    let scene = |friction| {
        pressed(friction, [2, 1, 1], 4)
            .with_support(Support::components(brick::Z_MIN, [true, true, false]).with_motion([1e-2, 0.0, 0.0], ramp()))
    };
    let rough = run(scene(Friction::coulomb(COEFFICIENT)), at(1e-9)).1;
    let smooth = run(scene(Friction::None), at(1e-9)).1;
    for (a, b) in rough.iter().zip(&smooth) {
        assert_close(&a.displacement, &b.displacement, 1e-7, "displacement");
    }
}

/// One direction prescribed, the other free: friction acts against the direction of both, so that any force across
/// drives the block sideways, with s_y / s_x = F_y / sqrt((mu N)^2 - F_y^2).
#[test]
fn a_block_that_is_dragged_drifts_with_a_force_across() {
    let (normal, across, way) = (2.0 * PRESSURE, 0.25 * 2.0 * PRESSURE, 1e-1);
    let bound = COEFFICIENT * normal;
    let along = (bound * bound - across * across).sqrt();
    for boxes in [[1, 1, 1], [2, 1, 1]] {
        let scene = pressed(Friction::coulomb(COEFFICIENT), boxes, 1)
            .with_load(Load::body([0.0, across / 2.0, 0.0]))
            .with_support(Support::components(brick::Z_MIN, [true, false, false]).with_motion([way, 0.0, 0.0], ramp()));
        let (_, results) = run(scene, at(1e-9));
        let what = format!("{boxes:?}: {:?}", results[0].report);
        let friction = results[0].summary.friction_force;
        assert!((friction[0] + along).abs() < 1e-4 * bound, "{what}: {friction:?}");
        assert!((friction[1] + across).abs() < 1e-4 * bound, "{what}: {friction:?}");
        for point in &results[0].points {
            let [x, y, _] = point.tangential_displacement;
            assert!((x / way - 1.0).abs() < 1e-9, "{what}");
            assert!((y / x - across / along).abs() < 2e-2, "{what}: {}", y / x);
        }
        assert!(!results[0].report.fallback, "{what}");
    }
}

/// With given friction the bound holds without pressure.
#[test]
fn given_friction_of_what_is_dragged() {
    let stress = 40.0;
    let scene = pressed(Friction::tresca(stress), [2, 1, 1], 2)
        .with_support(Support::components(brick::Z_MIN, [true, true, false]).with_motion([1e-2, 0.0, 0.0], ramp()));
    for result in run(scene, at(1e-9)).1 {
        let friction = result.summary.friction_force[0];
        assert!((friction + 2.0 * stress).abs() < 1e-6 * stress, "{friction}");
    }
}

/// A support that does not move leaves its friction open; as before there is none along it.
#[test]
fn a_symmetry_plane_keeps_one_tangential_row() {
    let scene = pressed(Friction::coulomb(COEFFICIENT), [1, 1, 1], 1)
        .with_support(Support::components(brick::Y_MIN, [false, true, false]))
        .with_support(Support::components(brick::X_MIN, [true, false, false]));
    let simulation = Simulation::new(scene, at(1e-9)).expect("set-up");
    let gluing = simulation.tfeti().gluing();
    assert_eq!(gluing.ranges().intervals.len(), 4 + 2);
    assert!(gluing.dependent_nodes().is_empty() && orthonormal(gluing));
}

/// Half a block that is pressed on a floor and dragged along its plane of symmetry.
fn half(friction: Friction) -> Scene {
    Scene::new(block([2.0, 1.0, 1.0], [4, 2, 2]), uniform(1e9, 0.3))
        .with_support(Support::components(brick::Y_MIN, [false, true, false]))
        .with_support(Support::fixed(brick::Z_MAX).with_motion([8e-3, 0.0, -2e-3], ramp()))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(friction))
        .with_boxes([2, 1, 1])
        .with_analysis(Analysis::quasistatic(1.0, 3))
}

/// The slip bound of a node with one direction left is that of the law, not a part of it.
#[test]
fn sliding_nodes_in_a_plane_of_symmetry_have_the_friction_of_the_law() {
    let (mu, stress) = (0.3, 2e5);
    for (friction, given) in [(Friction::coulomb(mu), 0.0), (Friction::tresca(stress), stress)] {
        for method in methods() {
            let name = method.kind();
            let (_, results) = run(half(friction.clone()), at(1e-9).with_method(method));
            let mut slid = 0;
            for point in results.iter().flat_map(|l| &l.points) {
                let in_plane = point.node % 15 < 5;
                if !in_plane || point.state != ContactState::Slip {
                    continue;
                }
                slid += 1;
                let bound = match given {
                    0.0 => -mu * point.normal_force,
                    stress => stress * point.area,
                };
                assert!(bound > 0.0 && (point.slip_bound - bound).abs() <= 1e-9 * bound);
                let [x, y, z] = point.friction_force;
                assert!((x + bound).abs() <= 1e-6 * bound, "{name}: {point:?}");
                assert!(y.hypot(z) <= 1e-9 * bound, "{name}: {point:?}");
            }
            // five nodes lie in the plane
            assert!(slid >= 5, "{name}: {slid} slide");
        }
    }
}

/// Supports and ties that move bodies as rigid ones leave forces of rounding: a step ends there, however small an error
/// is asked for, whether contact that stays open asks for active sets or not.
#[test]
fn rigid_motions_take_few_products() {
    let way = [0.01, 0.02, -0.03];
    for (tied, open, tolerance) in [
        (false, false, 1e-9),
        (false, true, 1e-9),
        (true, false, 1e-9),
        (true, true, 1e-9),
        (true, true, 1e-6),
    ] {
        let mesh = crate::mortar::blocks([3, 3, 2], [2, 3, 2], 1.0);
        let (mut support, mut tie) = (
            Support::fixed(brick::Z_MIN),
            Contact::tied(second(brick::Z_MIN), brick::Z_MAX),
        );
        if tied {
            tie = tie.with_motion(way, ramp())
        } else {
            support = support.with_motion(way, ramp())
        }
        let mut scene = Scene::new(mesh.clone(), uniform(2e9, 0.3))
            .with_support(support)
            .with_contact(tie)
            .with_boxes([2, 2, 2])
            .with_analysis(Analysis::quasistatic(1.0, 3));
        if open {
            scene = scene.with_contact(Contact::rigid(second(brick::Z_MAX)).with_gap(1.0));
        }
        let mut simulation = Simulation::new(scene, at(tolerance)).expect("set-up");
        let results = rest(&mut simulation);
        let what = format!("tied {tied}, open {open}, {tolerance:e}");
        for result in &results {
            let products = result.report.counters.products;
            assert!(products < 30, "{what}: {products} products, {}", result.report.status);
        }
        let last = results.last().expect("steps");
        for (x, u) in mesh.points().iter().zip(last.displacement.as_chunks::<3>().0) {
            // the seam belongs to both
            if x[2] != 1.0 {
                let share = f64::from(u8::from(!tied || x[2] > 1.0));
                let error = (0..3).map(|c| (u[c] - share * way[c]).abs()).fold(0.0, f64::max);
                assert!(error < 1e-11, "{what}: {error:e} at {x:?}");
            }
        }
    }
}

/// As many rows as rigid motions: equilibrium alone tells the reactions, here none, and nothing is left to be solved.
#[test]
fn statically_determinate_bodies_take_no_iterations() {
    for (cells, order) in [([2, 2, 2], 1), ([3, 3, 3], 1), ([3, 3, 3], 2)] {
        let brick = Brick::new([1.0, 1.0, 0.5], cells);
        let corner = |at: [usize; 3]| [brick.node(at).expect("a corner")];
        let mut mesh = brick.build().expect("brick");
        if order == 2 {
            mesh = mesh.raise_order().expect("quadratic");
        }
        for pull in [1e6, 3e6] {
            let scene = Scene::new(mesh.clone(), steel())
                .with_support(Support::fixed(corner([0, 0, 0])))
                .with_support(Support::components(corner([cells[0], 0, 0]), [false, true, true]))
                .with_support(Support::components(corner([0, cells[1], 0]), [false, false, true]))
                .with_load(Load::traction(brick::X_MIN, [-pull, 0.0, 0.0]))
                .with_load(Load::traction(brick::X_MAX, [pull, 0.0, 0.0]))
                .without_subdomains();
            let result = solve(scene, Settings::default());
            let products = result.report.counters.products;
            assert!(products <= 3, "{cells:?}, order {order}, {pull:e}: {products} products");
        }
    }
}

/// A plane of symmetry that cuts the contact surface, and a clamp: what supports hold no friction and no gap moves.
#[test]
fn quadratic_floors_meet_what_supports_hold() {
    let mesh = block([1.0; 3], [2, 3, 2]).raise_order().expect("quadratic");
    let floor = |gap: f64| foundation(Friction::coulomb(0.2)).with_gap(gap);
    let scene = Scene::new(mesh, steel())
        .with_load(Load::traction(brick::Z_MAX, [0.0, 1e7, -1e8]))
        .with_support(Support::components(brick::Y_MIN, [false, true, false]));
    let sided = Support::components(brick::X_MIN, [true, false, false]);
    let sided = scene.clone().with_support(sided).with_contact(floor(0.0));
    let planned = Plan::new(&sided, &tight()).expect("plan").dual();
    assert_eq!(
        planned,
        Simulation::new(sided.clone(), tight()).expect("set-up").plan().dual()
    );
    let result = solve(sided, tight());
    let at = |p: &&PointState| scene.mesh().points()[p.node as usize];
    let points = result.points.iter().filter(|p| at(p)[0] == 0.0);
    let forces: Vec<[f64; 3]> = points.map(|p| p.force()).collect();
    let pressed: f64 = forces.iter().map(|f| f[2]).sum();
    assert!(forces.len() > 3 && pressed.abs() > 1e6, "{forces:?}");
    assert!(forces.iter().all(|f| f[0].abs() < 1e-6 * pressed.abs()), "{forces:?}");
    assert!(result.points.iter().any(|p| p.force()[0].abs() > 1e-4 * pressed.abs()));
    let clamped = scene.with_support(Support::fixed(brick::X_MAX));
    assert_certified(&solve(clamped.clone().with_contact(floor(0.0)), tight()), "clamped");
    let inside = refused(&clamped.with_contact(floor(-1e-4))).to_string();
    assert!(inside.contains("inside the obstacle"), "{inside}");
}

/// A leaf clamped on a floor and lifted at its tip: a mean at the clamp saw how it bends, and pressed with 144 N.
#[test]
fn quadratic_leaves_that_are_lifted_off_a_floor_press_nowhere() {
    for cells in [20, 23] {
        let leaf = block([100.0, 10.0, 1.0], [cells, 3, 1])
            .raise_order()
            .expect("quadratic");
        let scene = Scene::new(leaf, uniform(2.1e5, 0.3))
            .with_support(Support::fixed(brick::X_MIN))
            .with_contact(foundation(Friction::coulomb(0.1)))
            .with_load(Load::force(brick::X_MAX, [0.0, 0.0, 3.0]));
        let force = solve(scene, Settings::default()).summary.normal_force;
        assert!(force < 1e-3, "{force}");
    }
}
