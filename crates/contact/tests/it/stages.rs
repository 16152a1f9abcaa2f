//! Stages: supports that are released, contacts that start and end; beside scenes that never had them, across states
//! and ranks.

use crate::common::*;
use signorini_tfeti::internal::on_ranks;

/// A block on a floor, held at one end and, at first, at the other, which is moved away and up; pressed from above.
fn clamped_on(friction: Friction, release: Option<f64>) -> Scene {
    let motion = History::table(vec![(0.0, 0.0), (1.0, 1.0), (9.0, 1.0)]).expect("table");
    let clamp = Support::fixed(brick::X_MAX).with_motion([4e-4, 0.0, 2e-4], motion);
    let clamp = match release {
        Some(time) => clamp.with_end(time),
        None => clamp,
    };
    pressed_floor(friction).with_support(clamp)
}

fn pressed_floor(friction: Friction) -> Scene {
    Scene::new(block([2.0, 1.0, 1.0], [6, 3, 3]), steel())
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::pressure(brick::Z_MAX, 1e8).with_history(ramp()))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(friction))
        .with_boxes([2, 1, 1])
        .with_analysis(Analysis::quasistatic(4.0, 4))
}

/// Without friction a released scene is one that never had the support, whatever the method.
#[test]
fn without_friction_a_support_leaves_nothing_behind() {
    for method in methods() {
        let settings = || by(method.clone()).with_tolerance(1e-9);
        let (simulation, released) = run(clamped_on(Friction::None, Some(2.0)), settings());
        let (_, never) = run(pressed_floor(Friction::None), settings());
        let (_, always) = run(clamped_on(Friction::None, None), settings());
        for k in 0..4 {
            let (beside, what) = if k < 2 { (&always[k], "held") } else { (&never[k], "released") };
            let scene = simulation.scene();
            let off = relative_distance(scene, &released[k].displacement, &beside.displacement);
            assert!(off < 1e-6, "{method:?}, step {k}, {what}: {off:e}");
            assert_eq!(released[k].points.len(), beside.points.len(), "{what}");
            assert_close(&forces(&released[k].points), &forces(&beside.points), 1e-5, what);
        }
        let reactions = simulation.result().expect("steps").reactions();
        assert_eq!(reactions.supports.len(), 2);
        assert_eq!(reactions.supports[1].resultant.force, [0.0; 3]);
        assert!(reactions.supports[1].nodes.is_empty());
        assert!(norm(&reactions.imbalance().force) < 1e-6 * norm(&reactions.loads.force));
    }
}

/// Supports and contacts that end with the run, or start with it, cost nothing: bits and counts are those without.
#[test]
fn what_never_ends_costs_nothing() {
    let run = |scene: Scene| {
        let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
        let bits: Vec<_> = rest(&mut simulation).iter().map(bits).collect();
        let state = simulation.state().clone();
        (bits, *simulation.counters(), simulation.plan().stages, state.memory())
    };
    let friction = || Friction::coulomb(0.3);
    let plain = run(clamped_on(friction(), None));
    assert_eq!(plain.2, 1);
    assert!(plain == run(clamped_on(friction(), Some(4.0))));
    let floor = Contact::rigid(brick::Z_MIN).with_friction(friction());
    let other = Scene::new(block([2.0, 1.0, 1.0], [6, 3, 3]), steel())
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::pressure(brick::Z_MAX, 1e8).with_history(ramp()))
        .with_contact(floor.with_start(0.0).with_end(5.0))
        .with_boxes([2, 1, 1])
        .with_analysis(Analysis::quasistatic(4.0, 4));
    assert!(run(pressed_floor(friction())) == run(other));
}

/// With friction a support that is released is a force that is taken away: points keep where they stick.
#[test]
fn with_friction_points_keep_where_they_stick() {
    let friction = || Friction::coulomb(0.4);
    let mut held = Simulation::new(clamped_on(friction(), Some(2.0)), tight()).expect("set-up");
    let mut forces_of = Vec::new();
    let mut released = Vec::new();
    while !held.is_finished() {
        released.push(step(&mut held));
        let nodes = held.result().expect("a step").reactions().supports[1].nodes.clone();
        forces_of.push(nodes.into_iter().map(|n| (n.node, n.force)).collect::<Vec<_>>());
    }
    assert!(forces_of[2].is_empty() && forces_of[3].is_empty());
    let mut scene = pressed_floor(friction());
    for (k, forces) in forces_of[..2].iter().enumerate() {
        let at = (k + 1) as f64;
        let hat = History::table(vec![(at - 1.0, 0.0), (at, 1.0), (at + 1.0, 0.0)]).expect("table");
        scene = scene.with_load(Load::new(LoadDensity::NodalForces(forces.clone())).with_history(hat));
    }
    let (simulation, loaded) = run(scene, tight());
    for k in 0..4 {
        let off = relative_distance(simulation.scene(), &released[k].displacement, &loaded[k].displacement);
        println!(
            "step {k}: {off:.1e}, {} slide, {} stick, {} products of {}",
            count(&released[k].points, ContactState::Slip),
            count(&released[k].points, ContactState::Stick),
            released[k].report.counters.products,
            loaded[k].report.counters.products,
        );
        assert!(off < 1e-6, "step {k}: {off:e}");
    }
    assert!(count(&released[3].points, ContactState::Stick) > 0);
    assert!(count(&released[2].points, ContactState::Slip) > 0);
    // friction keeps part of the stretch
    let (_, never) = run(pressed_floor(friction()), tight());
    let off = relative_distance(simulation.scene(), &released[3].displacement, &never[3].displacement);
    assert!(off > 1e-2, "{off:e}");
}

/// A body that nothing holds any more is refused when the scene is made, with the step.
#[test]
fn a_scene_that_falls_apart_is_refused_beforehand() {
    let scene = |load: bool| {
        let scene = Scene::new(block([2.0, 1.0, 1.0], [4, 2, 2]), steel())
            .with_support(Support::fixed(brick::X_MIN).with_end(2.0))
            .with_support(Support::components(brick::X_MAX, [true, true, false]))
            .with_analysis(Analysis::quasistatic(4.0, 4));
        if load {
            scene.with_load(Load::pressure(brick::Z_MAX, 1e6).with_history(ramp()))
        } else {
            scene
        }
    };
    let refused = |scene: Scene| Simulation::new(scene, Settings::default()).map(drop).expect_err("free");
    let error = refused(scene(true));
    assert!(matches!(error, ContactError::NotHeld { step: 2, .. }), "{error}");
    let error = refused(scene(false));
    assert!(matches!(error, ContactError::NotDetermined { .. }), "{error}");
    // a load that is gone by then is no excuse, one that comes too late is held before
    Simulation::new(
        scene(true).with_support(Support::fixed(brick::Z_MAX)),
        Settings::default(),
    )
    .expect("held");
    for (support, what) in [
        (Support::fixed(brick::X_MIN).with_end(f64::NAN), "NaN"),
        (Support::fixed(brick::X_MIN).with_end(-1.0), "-1 s"),
    ] {
        let error = refused(scene(true).with_support(support));
        assert!(
            matches!(
                error,
                ContactError::Span {
                    part: Part::Support(2),
                    ..
                }
            ),
            "{error}"
        );
        assert!(error.to_string().contains(what), "{error}");
    }
    let contact = Contact::rigid(brick::Z_MIN).with_start(2.0).with_end(2.0);
    let error = refused(scene(true).with_contact(contact));
    assert_eq!(error.parts(), [Part::Contact(0)], "{error}");
}

/// A floor that comes later is one that was always there, and one that goes was never there, where there is no
/// friction.
#[test]
fn contacts_start_and_end() {
    let scene = |floors: Vec<Contact>| {
        let scene = Scene::new(block([2.0, 1.0, 1.0], [6, 3, 3]), steel())
            .with_support(Support::fixed(brick::X_MIN))
            .with_load(Load::pressure(brick::Z_MAX, 1e7).with_history(ramp()))
            .with_boxes([2, 1, 1])
            .with_analysis(Analysis::quasistatic(4.0, 4));
        floors.into_iter().fold(scene, Scene::with_contact)
    };
    let floor = || Contact::rigid(brick::Z_MIN).with_gap(1e-5);
    let all = |floors| run(scene(floors), at(1e-9)).1;
    let (always, never) = (all(vec![floor()]), all(Vec::new()));
    // there at steps 0 and 3
    let again = all(vec![floor().with_end(1.0), floor().with_start(3.0)]);
    let whole = scene(Vec::new());
    for k in 0..4 {
        let (beside, points) = if k % 3 == 0 { (&always[k], 28) } else { (&never[k], 0) };
        let off = relative_distance(&whole, &again[k].displacement, &beside.displacement);
        assert!(off < 1e-6, "step {k}: {off:e}");
        assert_eq!(again[k].points.len(), beside.points.len().min(points), "step {k}");
    }
    assert_eq!(again[3].points[0].surface, 1);
}

/// A body that was moved along where a floor comes later has no friction there: only what comes after counts.
#[test]
fn friction_counts_from_where_a_contact_starts() {
    let down = History::table(vec![(0.0, 0.0), (1.0, 1.0), (9.0, 1.0)]).expect("table");
    let scene = |start: f64, along: f64| {
        Scene::new(block([2.0, 1.0, 1.0], [4, 2, 2]), steel())
            .with_support(Support::fixed(brick::Z_MAX).with_motion([along, 0.5 * along, -1e-4], down.clone()))
            .with_contact(
                Contact::rigid(brick::Z_MIN)
                    .with_friction(Friction::coulomb(0.3))
                    .with_start(start),
            )
            .with_boxes([2, 1, 1])
            .with_analysis(Analysis::quasistatic(3.0, 3))
    };
    let (_, at_rest) = run(scene(0.0, 0.0), at(1e-8));
    let (simulation, moved) = run(scene(1.0, 5e-4), at(1e-8));
    assert!(moved[0].points.is_empty());
    for k in 1..3 {
        let (found, wanted) = (forces(&moved[k].points), forces(&at_rest[0].points));
        assert_close(&found, &wanted, 1e-6, "forces");
    }
    // the obstacle that carries the body along says the same
    let along = Contact::rigid(brick::Z_MIN)
        .with_motion([5e-4, 2.5e-4, 0.0], down.clone())
        .with_friction(Friction::coulomb(0.3));
    let mut scene = simulation.scene().clone();
    scene = Scene::new(scene.mesh().clone(), steel())
        .with_support(scene.supports()[0].clone())
        .with_contact(along.with_start(1.0))
        .with_boxes([2, 1, 1])
        .with_analysis(Analysis::quasistatic(3.0, 3));
    let (_, carried) = run(scene, at(1e-8));
    assert_close(
        &forces(&carried[2].points),
        &forces(&at_rest[0].points),
        1e-6,
        "carried",
    );
}

/// Sides that are bonded until a time part, and open.
#[test]
fn ties_end() {
    let own = block([1.0; 3], [2; 3]);
    let mesh = with_second(&own, &lifted(&block([1.0; 3], [3; 3]), 1.0));
    let scene = |tie: Option<Contact>| {
        let scene = Scene::new(mesh.clone(), steel())
            .with_support(Support::fixed(brick::Z_MIN))
            .with_support(Support::fixed(second(brick::Z_MAX)))
            .with_load(Load::body([0.0, 0.0, -1e7]).with_history(ramp()))
            .with_analysis(Analysis::quasistatic(2.0, 2));
        match tie {
            Some(tie) => scene.with_contact(tie),
            None => scene,
        }
    };
    let tie = || Contact::tied(brick::Z_MAX, second(brick::Z_MIN));
    let all = |tie| run(scene(tie), at(1e-9)).1;
    let (ended, always, never) = (all(Some(tie().with_end(1.0))), all(Some(tie())), all(None));
    let whole = scene(None);
    let off = |a: &Solved, b: &Solved| relative_distance(&whole, &a.displacement, &b.displacement);
    assert!(off(&ended[0], &always[0]) < 1e-6);
    assert!(off(&ended[1], &never[1]) < 1e-6);
    assert!(off(&ended[0], &never[0]) > 1e-2);
}

/// A state that is stored before or after a release continues with the same bits, in any simulation of the scene.
#[test]
fn states_know_their_stage() {
    let scene = || clamped_on(Friction::coulomb(0.3), Some(2.0));
    let mut whole = Simulation::new(scene(), Settings::default()).expect("set-up");
    let mut states = vec![whole.state().clone()];
    let mut last = Vec::new();
    while !whole.is_finished() {
        last = bits(&step(&mut whole));
        states.push(whole.state().clone());
    }
    let mut used = Simulation::new(scene(), Settings::default()).expect("set-up");
    for state in states.into_iter().take(4).rev() {
        let mut fresh = Simulation::new(scene(), Settings::default()).expect("set-up");
        for simulation in [&mut fresh, &mut used] {
            simulation.resume(state.clone()).expect("its state");
            let found = rest(simulation).pop().expect("steps");
            assert!(bits(&found) == last, "after step {}", state.step());
        }
        // steps that are solved do not ask when the release was to be; that it was is in the rows
        let start =
            |end| Simulation::new(clamped_on(Friction::coulomb(0.3), end), Settings::default()).expect("set-up");
        if state.step() == 2 {
            let mut earlier = start(Some(1.0));
            earlier.resume(state.clone()).expect("the same rows");
            assert!(bits(&rest(&mut earlier).pop().expect("steps")) == last);
        }
        let resumed = start(None).resume(state.clone());
        assert_eq!(resumed.is_err(), state.step() > 2, "after step {}", state.step());
    }
    // a scene is as it was given
    let mut again = Simulation::new(whole.scene().clone(), Settings::default()).expect("set-up");
    assert!(bits(&rest(&mut again).pop().expect("steps")) == last);
}

/// The same bits on several ranks.
#[test]
fn ranks_release_together() {
    let run = |settings: Settings| {
        let scene = clamped_on(Friction::coulomb(0.3), Some(2.0));
        let mut simulation = Simulation::new(scene, settings.with_share_translates(false)).expect("set-up");
        rest(&mut simulation).iter().map(bits).collect::<Vec<_>>()
    };
    let alone = run(Settings::default());
    for rank in on_ranks(2, |c| run(Settings::default().with_communicator(c))) {
        assert!(rank.expect("no panic") == alone);
    }
}

/// The plan is that of the largest stage, and tells how many there are.
#[test]
fn the_plan_tells_the_largest_stage() {
    let plan = |scene: &Scene| Plan::new(scene, &Settings::default()).expect("plan");
    let scene = clamped_on(Friction::coulomb(0.3), Some(2.0));
    let [largest, released] = [plan(&scene), plan(&pressed_floor(Friction::coulomb(0.3)))];
    assert_eq!((largest.stages, released.stages), (2, 1));
    assert!(largest.to_string().contains("stages"));
    let held = plan(&clamped_on(Friction::coulomb(0.3), None));
    assert_eq!(largest.vector_bytes, held.vector_bytes.max(released.vector_bytes));
}

/// The paper's methods carry multipliers of the coarse equality across a release, too.
#[test]
fn methods_agree_across_a_release() {
    let solve = |method: Method| {
        run(
            clamped_on(Friction::coulomb(0.4), Some(2.0)),
            by(method).with_tolerance(1e-8),
        )
    };
    let [(simulation, first), others @ ..] = methods().map(solve);
    for (k, other) in others.iter().enumerate() {
        for (step, (a, b)) in first.iter().zip(&other.1).enumerate() {
            let off = relative_distance(simulation.scene(), &a.displacement, &b.displacement);
            assert!(off < 1e-5, "method {k}, step {step}: {off:e}");
        }
    }
}

/// Steps that are solved to an estimated accuracy reach it in every stage, and the mesh is judged there.
#[test]
fn estimates_pass_a_release() {
    let settings = Settings::default().with_accuracy(Accuracy::Balanced { fraction: 0.1 });
    let mut simulation = Simulation::new(clamped_on(Friction::coulomb(0.3), Some(2.0)), settings).expect("set-up");
    while !simulation.is_finished() {
        let result = simulation.step().expect("step");
        let accuracy = result.report().accuracy.expect("asked for");
        assert!(result.report().status.converged() && accuracy.reached && accuracy.certified);
        let error = result.discretisation_error().expect("an estimate").relative();
        assert!(error > 0.05 && error < 1.0, "{error}");
    }
}

/// Increments that are halved, and the paper's formula, pass a release.
#[test]
fn halved_steps_and_the_formula_of_the_paper_pass_a_release() {
    let scene = clamped_on(Friction::coulomb(0.3), Some(2.0)).with_analysis(paper_steps(4.0, 8));
    let (simulation, steps) = run(scene.clone(), Settings::default().with_step_halving(3));
    assert_eq!(steps.len(), 8);
    assert!(steps[3].points.len() < steps[4].points.len());
    assert!(simulation.result().expect("steps").algebraic_error().relative() < 1e-5);
    let mut doubling = StepDoubling::new(&scene, &Settings::default()).expect("set-up");
    while !doubling.is_finished() {
        let _ = doubling.step().expect("step");
    }
}
