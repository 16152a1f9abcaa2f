//! Linear equations beside contact, on ranks, by other methods, from a state, in estimates; and what is refused.

use crate::common::*;
use crate::couplings::YOUNG;
use crate::equations::{AXES, LOWER, UPPER, alike, cell, column, minus, pairs, solved};
use crate::processes::the_same_on;
use signorini_fem_mesh::vec3;

/// A bar on a rough floor, whose end moves as a point that is pressed and pulled.
fn pulled(boxes: [usize; 3], steps: usize) -> Scene {
    let mesh = Brick::new([2.0, 1.0, 1.0], [6, 3, 3])
        .perturbed(0.1, 3)
        .build()
        .expect("brick");
    let end = mesh.nodes_on(brick::X_MAX).into_iter();
    let end: Vec<u32> = end.filter(|n| mesh.points()[*n as usize][2] > 1e-9).collect();
    let scene = Scene::new(mesh, uniform(YOUNG, 0.3))
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::pressure(brick::Z_MAX, 1e7).with_history(ramp()))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.3)))
        .with_coupling(Coupling::point([2.0, 0.5, 0.5]))
        .with_load(Load::on_coupling(0, [2e6, 5e5, -1e6], [0.0; 3]).with_history(up_down_up()))
        .with_analysis(Analysis::quasistatic(1.0, steps))
        .with_boxes(boxes);
    let moved = |node: u32| AXES.map(|e| Equation::new([(node, e)]).with_point(0, minus(e)));
    end.into_iter().flat_map(moved).fold(scene, Scene::with_equation)
}

#[test]
fn beside_friction_on_any_number_of_subdomains() {
    let whole = run(pulled([1; 3], 3), tight()).1;
    for boxes in [[2, 1, 1], [3, 2, 2]] {
        let found = run(pulled(boxes, 3), tight()).1;
        for (own, expected) in found.iter().zip(&whole) {
            assert_close(&own.displacement, &expected.displacement, 1e-7, "displacement");
            assert!(own.summary.slip > 0 && own.summary.stick > 0, "{:?}", own.summary);
            assert_close(&own.summary.resultant, &expected.summary.resultant, 1e-7, "contact");
        }
    }
}

/// The same with a coupling without rotations in the place of the equations.
#[test]
fn a_side_that_is_shifted_is_a_coupling() {
    let found = solved(pulled([3, 1, 1], 1), tight(), "equations");
    let scene = pulled([3, 1, 1], 1);
    let nodes: Vec<u32> = scene.equations().iter().step_by(3).map(|e| e.terms()[0].0).collect();
    let plate = Coupling::rigid(nodes, [2.0, 0.5, 0.5]).with_held([false, false, false, true, true, true]);
    let coupled = Scene::new(scene.mesh().clone(), scene.materials().clone())
        .with_support(scene.supports()[0].clone())
        .with_contact(scene.contacts()[0].clone())
        .with_analysis(scene.analysis().clone())
        .with_coupling(plate)
        .with_boxes([3, 1, 1]);
    let coupled = scene.loads().iter().cloned().fold(coupled, Scene::with_load);
    let expected = solved(coupled, tight(), "coupled");
    assert_close(
        &found.one.displacement,
        &expected.one.displacement,
        1e-7,
        "displacement",
    );
    assert_close(&found.points[0], &expected.points[0], 1e-7, "point");
    let [own, other] = [&found, &expected].map(|f| f.one.report.counters.products);
    assert!(own <= other + 5, "{own} products, coupled {other}");
}

#[test]
fn ranks_have_the_same_bits() {
    the_same_on(&[2, 3], &pulled([3, 2, 1], 2), Settings::default(), "contact");
    let mesh = Brick::new([1.0; 3], [2; 3]).build().expect("brick");
    let scene = cell(mesh, uniform(YOUNG, 0.3), [Some(1e-3), None, None]).with_boxes([2, 2, 2]);
    the_same_on(&[2, 3], &scene, Settings::default(), "cell");
}

#[test]
fn other_methods_find_the_same() {
    let expected = run(pulled([3, 1, 1], 1), tight()).1;
    for method in methods() {
        let mut simulation = Simulation::new(pulled([3, 1, 1], 1), by(method).with_tolerance(1e-7)).expect("set-up");
        let found = step(&mut simulation);
        assert!(
            found.report.status.converged() && !found.report.fallback,
            "{:?}",
            found.report
        );
        assert_close(&found.displacement, &expected[0].displacement, 1e-4, "displacement");
    }
}

#[test]
fn a_state_goes_on() {
    let (_, whole) = run(pulled([2, 1, 1], 4), Settings::default());
    let mut first = Simulation::new(pulled([2, 1, 1], 4), Settings::default()).expect("set-up");
    let _ = (step(&mut first), step(&mut first));
    let mut second = Simulation::new(pulled([2, 1, 1], 4), Settings::default()).expect("set-up");
    second.resume(first.state().clone()).expect("goes on");
    for (own, expected) in rest(&mut second).iter().zip(&whole[2..]) {
        assert_eq!(bits(own), bits(expected));
    }
    // other equations are another scene
    let other = Equation::new([(0, AXES[0]), (7, AXES[1])]);
    let mut other = Simulation::new(pulled([2, 1, 1], 4).with_equation(other), Settings::default()).expect("set-up");
    let error = other.resume(first.state().clone()).expect_err("refused").to_string();
    assert!(error.contains("or equations"), "{error}");
}

#[test]
fn estimates_are_near_the_error() {
    let mesh = Brick::new([1.0; 3], [4; 3]).build().expect("brick");
    let loaded = cell(mesh, uniform(YOUNG, 0.3), [Some(1e-3), None, None])
        .with_load(Load::body([0.0, 3e8, -2e8]))
        .with_load(Load::on_coupling(1, [0.0, 5e7, 0.0], [0.0; 3]))
        .with_boxes([2, 2, 2]);
    for (scene, what) in [(loaded, "cell"), (pulled([3, 2, 1], 1), "contact")] {
        let exact = solve(scene.clone(), at(1e-12));
        for tolerance in [1e-2, 1e-3, 1e-5, 1e-7] {
            let mut simulation = Simulation::new(scene.clone(), at(tolerance)).expect("set-up");
            let found = step(&mut simulation);
            let estimate = simulation.result().expect("a step").algebraic_error();
            let truth = energy_distance(&scene, &found.displacement, &exact.displacement);
            let bound = estimate.energy.sqrt();
            println!(
                "{what}, {tolerance:e}: {bound:.3e} of {truth:.3e}, {:.3e}",
                estimate.elastic.sqrt()
            );
            let rounding = 1e-9 * estimate.elastic.sqrt();
            assert!(
                bound * 1.0001 + rounding >= truth,
                "{what}, {tolerance:e}: {bound:e} of {truth:e}"
            );
            assert!(
                bound <= 20.0 * truth + rounding,
                "{what}, {tolerance:e}: {bound:e} of {truth:e}"
            );
        }
    }
}

/// What supports say, too: their nodes drop out, and each has the force that is its own.
#[test]
fn nodes_that_supports_hold_count_as_they_are_moved() {
    let mesh = block([2.0, 1.0, 1.0], [4, 2, 2]);
    let end = mesh.nodes_on(brick::X_MAX);
    let scene = Scene::new(mesh, uniform(YOUNG, 0.3))
        .with_support(Support::fixed(brick::X_MIN))
        .with_support(Support::fixed([end[0]]).with_motion([1e-4, -2e-4, 3e-4], ramp()))
        .with_boxes([2, 1, 1]);
    let follow = end[1..].iter().flat_map(|n| alike(*n, end[0]));
    let found = solved(follow.fold(scene.clone(), Scene::with_equation), tight(), "follow");
    let support = Support::fixed(brick::X_MAX).with_motion([1e-4, -2e-4, 3e-4], ramp());
    let expected = solved(scene.clone().with_support(support), tight(), "support");
    assert_close(
        &found.one.displacement,
        &expected.one.displacement,
        1e-8,
        "displacement",
    );
    let whole = found.reactions.supports[1].resultant.force;
    let parts = expected.reactions.supports[1..].iter().map(|s| s.resultant.force);
    let sum = parts.fold([0.0; 3], vec3::add);
    assert_close(&whole, &sum, 1e-7, "reaction");
    // wholly held, in agreement
    let said = Equation::new([(end[0], [1.0, 1.0, 0.0])]).with_value(-1e-4, ramp());
    let again = solved(scene.clone().with_equation(said), tight(), "said twice");
    assert_eq!(again.reactions.equations[0].multiplier, 0.0);
    let wrong = Equation::new([(end[0], [1.0, 1.0, 0.0])]).with_value(1e-4, ramp());
    let message = refused(&scene.with_equation(wrong)).to_string();
    assert!(
        message.contains("equation 0: it contradicts what supports"),
        "{message}"
    );
}

#[test]
fn equations_that_depend_on_others_say_so_or_drop_out() {
    let mesh = block([2.0, 1.0, 1.0], [4, 2, 2]);
    let end = mesh.nodes_on(brick::X_MAX);
    let [a, b, c] = [end[0], end[4], end[8]];
    let scene = Scene::new(mesh, uniform(YOUNG, 0.3))
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::traction(brick::X_MAX, [1e6, 2e6, 3e6]))
        .with_boxes([2, 1, 1]);
    let pair = |x, y, factor: f64| Equation::new([(x, AXES[0].map(|v| factor * v)), (y, AXES[0].map(|v| -factor * v))]);
    let chain = scene.with_equation(pair(a, b, 1.0)).with_equation(pair(b, c, 3.0));
    let expected = solved(chain.clone(), tight(), "chain");
    let circle = chain.clone().with_equation(pair(a, c, -7.0));
    let found = solved(circle.clone(), tight(), "circle");
    assert_eq!(found.one.displacement, expected.one.displacement);
    assert_eq!(Plan::new(&circle, &Settings::default()).expect("plan").equation_rows, 2);
    let wrong = chain.clone().with_equation(pair(a, c, -7.0).with_value(1e-6, ramp()));
    let message = refused(&wrong).to_string();
    assert!(
        message.contains("equation 2, node") && message.contains("beside equations 0, 1"),
        "{message}"
    );
    let nearly = Equation::new([(a, [1.0, 0.0, 0.0]), (c, [-1.0 - 1e-7, 0.0, 0.0])]);
    let message = refused(&chain.with_equation(nearly)).to_string();
    assert!(message.contains("more digits"), "{message}");
}

/// Sides of a tie that a coupling lets move against each other say nothing of that motion, so that equations may. They
/// were told to say what the tie says.
#[test]
fn equations_say_how_tied_sides_move() {
    let scene = |coupling: Coupling| {
        let column = column(3).with_support(Support::fixed(brick::Z_MAX));
        column.with_contact(Contact::tied(UPPER, LOWER)).with_coupling(coupling)
    };
    let coupling = || Coupling::relative(0, [0.4, 0.5, 1.0]);
    let free = |motion: usize| coupling().with_held([0, 1, 2, 3, 4, 5].map(|c| c != motion));
    let at = |place: [f64; 3]| {
        let scene = scene(free(2));
        let is_there = |pair: &&(u32, u32)| distance(&scene.mesh().points()[pair.0 as usize], &place) < 1e-9;
        *pairs(&scene).iter().find(is_there).expect("a pair")
    };
    let corners = [at([1.0, 1.0, 1.0]), at([1.0, 0.0, 1.0])];
    let parted = |k: usize, c: usize| {
        let (above, below) = corners[k];
        Equation::new([(above, AXES[c]), (below, minus(AXES[c]))])
    };
    let shorter = -5e-5;
    let said = scene(free(2)).with_equation(parted(0, 2).with_value(shorter, ramp()));
    let said = solved(said, tight(), "equation");
    let moved = coupling()
        .with_held([true; 6])
        .with_motion([0.0, 0.0, shorter, 0.0, 0.0, 0.0], ramp());
    let moved = solved(scene(moved), tight(), "coupling");
    assert_close(&said.one.displacement, &moved.one.displacement, 1e-7, "displacement");
    // about z the side y moves by 0.6 of the angle at both corners, and by 0.5 along x, not along z
    let angle = 1e-5;
    let said = scene(free(5)).with_equation(parted(1, 1).with_value(0.6 * angle, ramp()));
    let said = solved(said, tight(), "angle");
    let turned = coupling()
        .with_held([true; 6])
        .with_motion([0.0, 0.0, 0.0, 0.0, 0.0, angle], ramp());
    let turned = solved(scene(turned), tight(), "turned");
    assert_close(&said.one.displacement, &turned.one.displacement, 1e-7, "turned");
    for (motion, equations) in [
        (2, vec![parted(0, 0)]),
        (5, vec![parted(0, 2)]),
        (5, vec![parted(0, 1), parted(1, 1)]),
    ] {
        let scene = equations.into_iter().fold(scene(free(motion)), Scene::with_equation);
        let message = refused(&scene).to_string();
        assert!(message.contains("what a tied contact says"), "{message}");
    }
}

#[test]
fn what_is_refused_says_why() {
    let bar = || {
        let mesh = block([2.0, 1.0, 1.0], [4, 2, 2]);
        Scene::new(mesh, uniform(YOUNG, 0.3)).with_load(Load::traction(brick::X_MAX, [1e6, 0.0, 0.0]))
    };
    let held = || bar().with_support(Support::fixed(brick::X_MIN));
    let end = bar().mesh().nodes_on(brick::X_MAX);
    let node = end[0];
    let on = |vector: [f64; 3]| Equation::new([(node, vector)]);
    let point = || held().with_coupling(Coupling::point([0.0; 3]));
    let pull = |force| Load::on_coupling(0, force, [0.0; 3]);
    let rigid = || held().with_coupling(Coupling::rigid(brick::X_MAX, [2.0, 0.0, 0.0]));
    let floor = || held().with_contact(Contact::rigid(brick::X_MAX).with_friction(Friction::coulomb(0.2)));
    for (scene, why) in [
        (held().with_equation(Equation::new([])), "so that it says nothing"),
        (held().with_equation(on([0.0; 3])), "so that it says nothing"),
        (held().with_equation(on([f64::NAN, 0.0, 0.0])), "must be finite"),
        (held().with_equation(on([f64::INFINITY, 0.0, 0.0])), "must be finite"),
        (
            held().with_equation(Equation::new([(999, AXES[0])])),
            "equation 0, node 999: the mesh has no such node",
        ),
        (
            held().with_equation(on(AXES[0]).with_point(0, AXES[0])),
            "there is no point of its number",
        ),
        (
            rigid().with_equation(on(AXES[0]).with_point(0, AXES[0])),
            "it is in a rigid coupling",
        ),
        (point().with_load(pull([1.0, 0.0, 0.0])), "acts on nothing"),
        (
            point()
                .with_equation(on(AXES[0]).with_point(0, AXES[0]))
                .with_load(pull([1.0, 1.0, 0.0])),
            "acts on nothing",
        ),
        (
            point().with_load(Load::on_coupling(0, [0.0; 3], [1.0, 0.0, 0.0])),
            "takes no moments",
        ),
        (
            floor().with_equation(on(AXES[0])),
            "contact force, or the friction, is not determined",
        ),
        (
            floor().with_equation(on(AXES[1])),
            "contact force, or the friction, is not determined",
        ),
        (
            floor().with_equation(Equation::new([(end[0], AXES[0]), (end[4], minus(AXES[0]))])),
            "contact force, or the friction, is not determined",
        ),
        // an equation alone leaves five motions
        (bar().with_equation(on(AXES[1])), "cannot be in equilibrium"),
        // a point that moves with nothing but another one
        (
            point()
                .with_coupling(Coupling::point([1.0; 3]))
                .with_equation(Equation::new([]).with_point(0, AXES[0]).with_point(1, AXES[0]))
                .with_load(pull([1.0, 0.0, 0.0])),
            "cannot be in equilibrium",
        ),
    ] {
        let error = Simulation::new(scene, Settings::default())
            .map(|_| ())
            .expect_err(why)
            .to_string();
        assert!(error.contains(why), "{error}, not {why}");
    }
    // of ties: what they say, and what they leave
    let lower = block([1.0; 3], [2; 3]);
    let mesh = with_second(&lower, &lifted(&lower, 1.0));
    let [a, b] = [second(brick::Z_MIN), brick::Z_MAX].map(|tag| mesh.nodes_on(tag)[4]);
    let tied = Scene::new(mesh, uniform(YOUNG, 0.3))
        .with_support(Support::fixed(brick::Z_MIN))
        .with_load(Load::traction(second(brick::Z_MAX), [1e6, 0.0, 0.0]))
        .with_contact(Contact::tied(second(brick::Z_MIN), brick::Z_MAX));
    let message = refused(&alike(a, b).fold(tied.clone(), Scene::with_equation)).to_string();
    assert!(
        message.contains("equation 0, node") && message.contains("a tied contact says"),
        "{message}"
    );
    let held = Equation::new([(a, AXES[0])]);
    let found = solved(tied.with_equation(held), tight(), "tied and held");
    assert!(found.one.displacement[3 * a as usize].abs() < 1e-12);
}

/// Points of which nothing is said stay, and a scene without equations has no rows of them.
#[test]
fn what_is_not_there_costs_nothing() {
    let scene = small_benchmark(weakening(), 1);
    let simulation = Simulation::new(scene.clone(), Settings::default()).expect("set-up");
    assert!(simulation.tfeti().gluing().ranges().equations.is_empty());
    let plain = run(scene.clone(), Settings::default()).1;
    let idle = run(scene.with_coupling(Coupling::point([9.0; 3])), Settings::default());
    assert_eq!(idle.0.result().expect("a step").couplings()[0].displacement, [0.0; 3]);
    assert_close(&idle.1[0].displacement, &plain[0].displacement, 1e-5, "displacement");
}

/// Products are those of supports and of ties.
#[test]
fn products_are_those_of_other_rows() {
    let products = |scene: Scene| solve(scene, at(1e-8)).report.counters.products;
    let load = Load::body([0.0, 3e8, -2e8]);
    for (cells, boxes) in [(8, [2; 3]), (12, [4; 3])] {
        let mesh = block([1.0; 3], [cells; 3]);
        let clamped = Scene::new(mesh.clone(), uniform(YOUNG, 0.3)).with_support(Support::fixed(brick::X_MIN));
        let clamped = products(clamped.with_load(load.clone()).with_boxes(boxes));
        let periodic = cell(mesh, uniform(YOUNG, 0.3), [Some(1e-3), None, None]);
        let periodic = products(periodic.with_load(load.clone()).with_boxes(boxes));
        assert!(periodic <= clamped + 2, "{periodic} products, clamped {clamped}");
        let tied = column(cells)
            .with_contact(Contact::tied(UPPER, LOWER))
            .with_boxes(boxes);
        let joined = pairs(&column(cells)).into_iter().flat_map(|(a, b)| alike(a, b));
        let joined = joined.fold(column(cells), Scene::with_equation).with_boxes(boxes);
        let [joined, tied] = [joined, tied].map(products);
        assert!(joined <= tied + 1, "{joined} products, tied {tied}");
    }
}

/// A state belongs to its equations, not to a list of all their terms.
#[test]
fn states_know_where_an_equation_ends() {
    let mesh = block([2.0, 1.0, 1.0], [4, 2, 2]);
    let [a, b, c] = [0, 1, 2].map(|k| (mesh.nodes_on(brick::X_MAX)[k], AXES[0]));
    let simulation = |equations: [Vec<(u32, [f64; 3])>; 2]| {
        let scene = Scene::new(mesh.clone(), uniform(YOUNG, 0.3))
            .with_support(Support::fixed(brick::X_MIN))
            .with_load(Load::body([0.0, 0.0, -1e3]))
            .with_analysis(Analysis::quasistatic(1.0, 2));
        let equations = equations.into_iter().map(Equation::new);
        Simulation::new(equations.fold(scene, Scene::with_equation), Settings::default()).expect("set-up")
    };
    let mut first = simulation([vec![a, b], vec![c]]);
    step(&mut first);
    let state = first.state().clone();
    assert!(simulation([vec![a, b], vec![c]]).resume(state.clone()).is_ok());
    assert!(simulation([vec![a], vec![b, c]]).resume(state).is_err());
}
