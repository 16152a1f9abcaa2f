//! Contact between bodies whose contact nodes supports hold on one side or on both; estimates and reactions of pairs.

use crate::common::*;
use crate::pairs::beam;

fn block_on(lower: &TetMesh) -> TetMesh {
    with_second(lower, &lifted(&block([1.0; 3], [2; 3]), 1.0))
}

/// The second body is pushed, and the first one moved, or the obstacle in its place.
fn pushed(mesh: TetMesh, contact: Contact) -> Scene {
    let q = 2e6;
    let shear = Load::traction(second(brick::Z_MAX), [0.0, 0.1 * q, -q]);
    Scene::new(mesh, uniform(1e9, 0.3))
        .with_support(Support::components(second(brick::X_MAX), [true, true, false]))
        .with_load(shear)
        .with_contact(contact.with_friction(weakening()))
        .with_analysis(paper_steps(1.0, 5))
}

/// A surface that supports hold and move as a whole is a rigid obstacle that moves, the history of its slip included.
#[test]
fn a_surface_that_supports_move_is_an_obstacle_that_moves() {
    let motion = [2e-3, -5e-4, 1e-3];
    let floor = Contact::rigid(second(brick::Z_MIN)).with_motion(motion, up_down_up());
    let upper = block([1.0; 3], [2; 3]).map_tags(second);
    let (_, reference) = run(pushed(upper, floor), tight());
    let slides = reference.iter().any(|l| l.summary.slip > 0);
    assert!(slides && reference.iter().any(|l| l.summary.stick > 0));
    let body = reference[0].displacement.len();
    let both = block_on(&block([1.0; 3], [2; 3]));
    let contact = Contact::between(second(brick::Z_MIN), brick::Z_MAX);
    let scene = || {
        pushed(both.clone(), contact.clone())
            .with_support(Support::fixed(brick::Z_MAX).with_motion(motion, up_down_up()))
            .with_boxes([2, 1, 2])
    };
    for method in methods() {
        let what = method.kind().to_string();
        let (_, results) = run(scene(), tight().with_method(method));
        for (a, b) in results.iter().zip(&reference) {
            let upper = &a.displacement[a.displacement.len() - body..];
            assert_close(upper, &b.displacement, 1e-6, &what);
            assert_close(&forces(&a.points), &forces(&b.points), 1e-6, &what);
            let works = [a, b].map(|l| l.summary.friction_work);
            let size = b.summary.normal_force * norm(&motion);
            assert!((works[0] - works[1]).abs() < 1e-6 * size, "{what}: {works:?}");
        }
    }
}

fn held(scene: Scene, tag: FacetTag, directions: &[[f64; 3]]) -> Scene {
    scene.with_support(Support::partial(tag, Directions::Vectors(directions.to_vec())))
}

/// Supports at contact nodes of the lower body, of the upper one, and of both, along the axes and oblique.
fn supported(friction: &Friction) -> [Scene; 5] {
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let scene = || {
        let q = 2e6;
        Scene::new(block_on(&block([1.0; 3], [2; 3])), uniform(1e9, 0.3))
            .with_support(Support::fixed(brick::Z_MIN))
            .with_load(Load::traction(second(brick::Z_MAX), [0.1 * q, 0.05 * q, -q]))
            .with_contact(Contact::between(second(brick::Z_MIN), brick::Z_MAX).with_friction(friction.clone()))
            .with_boxes([2, 1, 2])
    };
    let (lower, upper) = (brick::X_MIN, second(brick::X_MIN));
    [
        held(scene(), lower, &[x, y, z]),
        held(held(scene(), lower, &[z]), upper, &[x, y]),
        held(held(scene(), lower, &[x]), upper, &[y]),
        held(scene(), lower, &[[1.0, 0.5, 0.7]]),
        held(held(scene(), lower, &[[1.0, 0.5, 0.7]]), upper, &[[0.3, -1.0, 0.6], x]),
    ]
}

/// What a support takes from the other body belongs to its reaction.
#[test]
fn reactions_have_the_contact_force_on_supported_nodes() {
    for friction in [Friction::None, Friction::coulomb(0.4)] {
        for (k, scene) in supported(&friction).into_iter().enumerate() {
            let scene = held(scene, second(brick::Y_MIN), &[[0.0, 1.0, 0.0]]);
            let scene = held(scene, second(brick::X_MAX), &[[1.0, 0.0, 0.0]]);
            let mut simulation = Simulation::new(scene, tight()).expect("set-up");
            let frame = simulation.step().expect("step");
            let reactions = frame.reactions();
            let rest = reactions.imbalance();
            let whole = norm(&reactions.loads.force);
            assert!(
                norm(&rest.force) < 1e-7 * whole && norm(&rest.moment) < 1e-7 * whole,
                "{k} {friction:?}: {rest:?}"
            );
            let field = frame.reaction_field();
            let sum = reactions.of_supports().force;
            for c in 0..3 {
                let total: f64 = field.iter().map(|force| force[c]).sum();
                assert!((total - sum[c]).abs() < 1e-9 * whole, "{k} {friction:?}");
            }
        }
    }
}

/// The estimate of the algebraic error is no guess where supports hold both nodes of a pair in part.
#[test]
fn the_algebraic_error_is_estimated_where_both_sides_are_held() {
    for friction in [Friction::None, Friction::tresca(2e5)] {
        for (k, scene) in supported(&friction).into_iter().enumerate() {
            let scene = held(scene, second(brick::Y_MAX), &[[0.0, 1.0, 0.0]]);
            let scene = held(scene, second(brick::X_MAX), &[[1.0, 0.0, 0.0]]);
            let exact = solve(scene.clone(), tight().with_tolerance(1e-11)).displacement;
            let settings = at(1e-3);
            let mut simulation = Simulation::new(scene, settings).expect("set-up");
            let frame = simulation.step().expect("step");
            let found = frame.displacement();
            let truth = relative_distance(frame.scene(), found.as_flattened(), &exact);
            let ratio = frame.algebraic_error().relative() / truth;
            assert!((0.9..30.0).contains(&ratio), "{k} {friction:?}: {ratio}, {truth:e}");
        }
    }
}

/// Where supports fix the normal displacement of one side its rows are of the other body alone. Friction joins both all
/// the same: a body that its supports press on another one is held by friction.
#[test]
fn friction_joins_bodies_that_no_normal_row_joins() {
    let contact = Contact::between(second(brick::Z_MIN), brick::Z_MAX)
        .with_gap(-1e-3)
        .with_friction(Friction::coulomb(0.3));
    let scene = |push: f64| {
        let scene = Scene::new(block_on(&block([1.0; 3], [2; 3])), uniform(1e9, 0.3))
            .with_support(Support::fixed(brick::Z_MIN))
            .with_load(Load::traction(second(brick::Z_MAX), [push, 0.0, 0.0]))
            .with_contact(contact.clone());
        held(scene, second(brick::Z_MIN), &[[0.0, 0.0, 1.0]])
    };
    let reference = solve(scene(1e5), tight());
    let force = reference.summary;
    assert!((force.resultant[0] + 1e5).abs() < 1.0, "{force:?}");
    assert!(force.normal_force > 4e5, "{force:?}");
    for method in methods() {
        let result = solve(scene(1e5).with_boxes([2, 1, 2]), tight().with_method(method));
        assert_close(&result.displacement, &reference.displacement, 1e-6, "cut");
    }
}

/// The estimate of the algebraic error bounds the truth, and is not far above it, whichever side supports hold.
#[test]
fn the_algebraic_error_is_estimated() {
    let held = |tag: FacetTag| Support::components(tag, [false, true, false]);
    for sides in [&[][..], &[brick::Y_MIN], &[second(brick::Y_MIN)]] {
        let scene = || {
            let scene = sides
                .iter()
                .fold(beam(Some(4e11)), |scene, tag| scene.with_support(held(*tag)));
            scene.with_analysis(Analysis::Static { time: 1.0 })
        };
        let exact = solve(scene(), tight().with_tolerance(1e-11)).displacement;
        let mut simulation = Simulation::new(scene(), at(1e-4)).expect("set-up");
        let frame = simulation.step().expect("step");
        let found = frame.displacement();
        let truth = relative_distance(frame.scene(), found.as_flattened(), &exact);
        let estimate = frame.algebraic_error();
        let ratio = estimate.relative() / truth;
        assert!((0.9..30.0).contains(&ratio), "{sides:?}: {ratio}, {truth:e}");
    }
}

/// Two leaves of a spring, clamped together at one end, where nothing holds them yet.
fn leaves(cells: [usize; 2], order: usize) -> Scene {
    let leaf = |long: f64, cells| block([long, 10.0, 1.0], [cells, 3, 1]);
    let both = with_second(&leaf(100.0, cells[0]), &lifted(&leaf(85.0, cells[1]), 1.0));
    let both = match order {
        2 => both.raise_order().expect("order 2"),
        _ => both,
    };
    let tip = Load::force(brick::X_MAX, [0.0, 0.0, 3.0]);
    let touching = Contact::between(brick::Z_MAX, second(brick::Z_MIN));
    Scene::new(both, uniform(2.1e5, 0.3))
        .with_contact(touching.with_friction(Friction::coulomb(0.1)))
        .with_load(tip)
}

const CLAMPS: [FacetTag; 2] = [brick::X_MIN, FacetTag(brick::X_MIN.0 + 100)];

/// Two leaves of a spring, clamped together at one end, of meshes that match nowhere else: where supports hold both
/// sides no force belongs to contact.
#[test]
fn leaves_clamped_together_press_on_each_other_only_where_they_move() {
    for (cells, order) in [
        ([20, 20], 1),
        ([20, 23], 1),
        ([20, 80], 1),
        ([20, 20], 2),
        ([20, 40], 2),
    ] {
        let loose = leaves(cells, order);
        // a coupling that is held clamps as well, but would tell no force where both sides are rigid
        let rigid = CLAMPS.map(|end| Coupling::rigid(end, [0.0; 3]).with_held([true; 6]));
        let rigid = rigid.into_iter().fold(loose.clone(), Scene::with_coupling);
        let refused = Simulation::new(rigid, Settings::default()).map(|_| ());
        let refused = refused.expect_err("rigid on both sides").to_string();
        assert!(refused.contains("no contact force is determined"), "{refused}");
        let fixed = CLAMPS.map(Support::fixed);
        let scene = fixed.into_iter().fold(loose, Scene::with_support);
        let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
        let result = simulation.step().expect("step");
        let clamps: Vec<f64> = result
            .reactions()
            .supports
            .iter()
            .map(|r| r.resultant.force[2])
            .collect();
        println!("{cells:?} order {order}: {clamps:?}, {}", result.summary().normal_force);
        assert!((clamps.iter().sum::<f64>() + 3.0).abs() < 1e-6, "{clamps:?}");
        // as the part of the upper leaf in the load
        assert!(clamps.iter().all(|force| (-2.0..-1.0).contains(force)), "{clamps:?}");
    }
}

/// Clamps that move together do not move the leaves against each other, however much of a mean they hold: refused.
#[test]
fn leaves_whose_clamps_move_together_are_clamped_leaves() {
    for (cells, order) in [([20, 23], 1), ([20, 20], 2)] {
        let moved = |by: f64| {
            let clamp = |end| Support::fixed(end).with_motion([0.0, 0.0, by], History::constant(1.0));
            let clamps = CLAMPS.map(clamp).into_iter();
            solve(clamps.fold(leaves(cells, order), Scene::with_support), tight())
        };
        let (still, moved) = (moved(0.0), moved(1.0));
        let there: Vec<f64> = (moved.displacement.iter().enumerate())
            .map(|(k, u)| if k % 3 == 2 { u - 1.0 } else { *u })
            .collect();
        assert_close(&there, &still.displacement, 1e-6, &format!("{cells:?} order {order}"));
    }
}

/// Where supports hold both sides of a tie no row says how these move: supports that part them are refused, and were
/// not. A tie that moves as they do may.
#[test]
fn supports_do_not_part_tied_sides() {
    let way = [0.0, 1e-3, 1e-3];
    for (cells, order) in [(2, 1), (3, 1), (2, 2), (3, 2)] {
        let mesh = block_on(&block([1.0; 3], [cells, cells, 2]));
        let mesh = if order == 2 { mesh.raise_order().expect("order 2") } else { mesh };
        let scene = |ways: [[f64; 3]; 2], tie: Contact| {
            let sides = [brick::X_MIN, second(brick::X_MIN)].into_iter().zip(ways);
            let scene = Scene::new(mesh.clone(), uniform(1e9, 0.3))
                .with_contact(tie)
                .with_load(Load::traction(second(brick::Z_MAX), [1e5, 0.0, 0.0]))
                .with_analysis(Analysis::quasistatic(1.0, 2));
            sides.fold(scene, |scene, (side, way)| {
                scene.with_support(Support::fixed(side).with_motion(way, ramp()))
            })
        };
        let tied = || Contact::tied(second(brick::Z_MIN), brick::Z_MAX);
        for (ways, tie) in [
            ([[0.0; 3], way], tied()),
            (
                [way, [0.0; 3]],
                Contact::tied(brick::Z_MAX, second(brick::Z_MIN)).with_motion(way.map(|c| -c), ramp()),
            ),
            ([way; 2], tied().with_motion(way, ramp())),
        ] {
            let error = refused(&scene(ways, tie)).to_string();
            assert!(
                error.contains("contact 0") && error.contains("tied") && error.contains("0.5 s"),
                "{error}"
            );
        }
        for (ways, tie) in [
            ([way; 2], tied()),
            ([[0.0; 3], way], tied().with_motion(way, ramp())),
            (
                [way, [0.0; 3]],
                Contact::tied(brick::Z_MAX, second(brick::Z_MIN)).with_motion(way, ramp()),
            ),
        ] {
            let (_, results) = run(scene(ways, tie), at(1e-8));
            assert!(norm(&results[1].displacement) > 1e-3);
        }
    }
}
