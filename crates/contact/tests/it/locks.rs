//! Couplings that are locked: beside prescribed lengths, across states, between steps, with others' supports.

use crate::common::*;
use crate::couplings::assert_close;
use crate::relative::*;
use signorini_fem_mesh::vec3;

/// A locked bolt keeps its length, as if it had been prescribed: the force that tightened it may go, and one that pulls
/// the plates apart is shared by bolt and plates.
#[test]
fn a_locked_bolt_shares_what_pulls() {
    let pull = || Load::force(UPPER_TOP, [0.0, 0.0, 4e3]);
    let run = |coupling: Coupling, factors| {
        let mut simulation = Simulation::new(
            tightened(joint(0.2, 1), coupling, factors, pull()),
            Settings::default().with_tolerance(1e-8),
        )
        .expect("set-up");
        let found = contact_forces(&mut simulation);
        let result = simulation.result().expect("a step");
        (found, result.displacement(), result.couplings()[0])
    };
    let (unlocked, ..) = run(bolt(), [0.0, 1.0, 1.0]);
    assert!((unlocked[3].0[0][2] - 1e4).abs() < 1.0);
    let (locked, displacement, motion) = run(bolt().with_lock(AXIAL, 1.0), [0.0, 1.0, 1.0]);
    let (alone, other, _) = run(bolt().with_lock(AXIAL, 1.0), [0.0, 1.0, 0.0]);
    let length = History::table(vec![(0.0, 0.0), (1.0, 1.0), (2.0, 1.0)]).expect("table");
    let moved = [motion.displacement[2], 0.0, 0.0, 0.0, 0.0, 0.0];
    let (prescribed, third, _) = run(bolt().with_held([true; 6]).with_motion(moved, length), [0.0; 3]);
    for k in 0..4 {
        for c in 0..4 {
            for others in [&alone, &prescribed] {
                assert!(
                    vec3::norm(vec3::sub(locked[k].0[c], others[k].0[c])) < 1.0,
                    "step {k}, contact {c}"
                );
            }
        }
    }
    // the scene of the locked stage is planned as it was given
    let given = || tightened(joint(0.2, 1), bolt().with_lock(AXIAL, 1.0), [0.0, 1.0, 1.0], pull());
    let mut simulation = Simulation::new(given(), Settings::default()).expect("set-up");
    contact_forces(&mut simulation);
    let [again, fresh] = [simulation.scene(), &given()].map(|s| Plan::new(s, &Settings::default()).expect("plan"));
    assert_eq!((again.dual(), again.effects), (fresh.dual(), fresh.effects));
    let [rises, falls] = [locked[3].0[0][2] - 1e4, 1e4 - locked[3].0[1][2]];
    assert!(rises > 200.0 && (rises + falls - 4e3).abs() < 1.0, "{rises} {falls}");
    assert_close(
        other.as_flattened(),
        displacement.as_flattened(),
        1e-5,
        "without the force",
    );
    assert_close(third.as_flattened(), displacement.as_flattened(), 1e-5, "prescribed");
}

/// A state that is stored before or after the lock continues with the same bits.
#[test]
fn states_know_what_is_locked() {
    let scene = || {
        let pull = Load::force(UPPER_TOP, [0.0, 0.0, 4e3]);
        tightened(joint(0.2, 1), bolt().with_lock(AXIAL, 1.0), [0.0, 1.0, 0.0], pull)
    };
    let mut whole = Simulation::new(scene(), Settings::default()).expect("set-up");
    let mut states = vec![whole.state().clone()];
    let mut last = None;
    while !whole.is_finished() {
        last = Some(step(&mut whole));
        states.push(whole.state().clone());
    }
    let last = last.expect("steps");
    // each in a simulation of its own, and one in the place of the other
    let mut used = Simulation::new(scene(), Settings::default()).expect("set-up");
    for state in states.into_iter().take(4).rev() {
        let mut fresh = Simulation::new(scene(), Settings::default()).expect("set-up");
        for simulation in [&mut fresh, &mut used] {
            simulation.resume(state.clone()).expect("its state");
            let found = rest(simulation).pop().expect("steps");
            assert_eq!(found.displacement, last.displacement, "after step {}", state.step());
        }
    }
}

/// The end of a bar is pulled by 1e6 N a second, until it is locked.
fn pulled(lock: Option<f64>, times: Vec<f64>) -> Scene {
    let history = History::table(vec![(0.0, 0.0), (3.0, 3.0)]).expect("table");
    let coupling = end().with_held(ALONG);
    let coupling = match lock {
        Some(time) => coupling.with_lock(AXIAL, time),
        None => coupling,
    };
    bar(1, [2, 1, 1])
        .with_coupling(coupling)
        .with_load(Load::on_coupling(0, [1e6, 0.0, 0.0], [0.0; 3]).with_history(history))
        .with_analysis(Analysis::Quasistatic {
            times,
            formula: DifferenceFormula::BACKWARD_EULER,
        })
}

/// Forces of the section at each step.
fn across(simulation: &mut Simulation) -> Vec<f64> {
    let mut out = Vec::new();
    while !simulation.is_finished() {
        assert_certified(&step(simulation), "locked");
        out.push(simulation.result().expect("a step").reactions().contacts[0].force[0] / 1e6);
    }
    out
}

/// Steps that end later than the lock are locked, at what the last one before left; at zero before the first, where the
/// own weight remains.
#[test]
fn a_lock_holds_from_the_next_step_on() {
    for (lock, expected) in [
        (0.0, [0.0, 0.0, 0.0]),
        (0.5, [0.0, 0.0, 0.0]),
        (1.0, [1.0, 1.0, 1.0]),
        (1.5, [1.0, 1.0, 1.0]),
        (2.0, [1.0, 2.0, 2.0]),
        (3.0, [1.0, 2.0, 3.0]),
    ] {
        let mut simulation =
            Simulation::new(pulled(Some(lock), vec![1.0, 2.0, 3.0]), Settings::default()).expect("set-up");
        for (found, expected) in across(&mut simulation).iter().zip(expected) {
            assert!(
                (found - expected).abs() < 1e-3,
                "locked at {lock} s: {found} for {expected}"
            );
        }
    }
}

/// What is locked belongs to the state, not to the scene.
#[test]
fn scenes_do_not_keep_what_is_locked() {
    let times = || vec![1.0, 2.0, 3.0];
    let start = |scene: Scene| Simulation::new(scene, Settings::default()).expect("set-up");
    let mut locked = start(pulled(Some(1.0), times()));
    (0..2).for_each(|_| drop(step(&mut locked)));
    let mut again = start(locked.scene().clone());
    assert!((across(&mut again)[1] - 1.0).abs() < 1e-5);
    let (length, state) = (
        locked.result().expect("a step").couplings()[0].displacement[0],
        locked.state().clone(),
    );
    // a state brings along what is locked
    let mut free = start(pulled(None, times()));
    free.resume(state.clone()).expect("the same rows of contact");
    assert!((across(&mut free)[0] - 1.0).abs() < 1e-5);
    // from a state before it that knows the motion, although nothing was to be locked
    let mut before = start(pulled(None, times()));
    drop(step(&mut before));
    let mut later = start(pulled(Some(1.0), times()));
    later.resume(before.state().clone()).expect("the same rows");
    assert!(across(&mut later).iter().all(|force| (force - 1.0).abs() < 1e-5));
    // but not from one that knows it along other axes
    let turned = pulled(None, times()).couplings()[0].clone().with_axis([0.0, 1.0, 0.0]);
    let turned = turned.with_held([false; 6]).with_lock(ALONG, 3.0);
    let mut other = start(
        bar(1, [2, 1, 1])
            .with_coupling(turned)
            .with_analysis(Analysis::Quasistatic {
                times: times(),
                formula: DifferenceFormula::BACKWARD_EULER,
            }),
    );
    other.resume(before.state().clone()).expect_err("other axes");
    // a motion that is held says all of it
    let motion = [2.0 * length, 0.0, 0.0, 0.0, 0.0, 0.0];
    let held = bar(1, [2, 1, 1]).with_coupling(end().with_held([true; 6]).with_motion(motion, History::constant(1.0)));
    let mut held = start(held.with_analysis(Analysis::Quasistatic {
        times: times(),
        formula: DifferenceFormula::BACKWARD_EULER,
    }));
    held.resume(state.clone().without_origin()).expect("resumed");
    drop(step(&mut held));
    let found = held.result().expect("a step").couplings()[0].displacement[0];
    assert!((found / motion[0] - 1.0).abs() < 1e-6, "{found:e}");
    // a state that does not fit changes nothing
    let (step_before, force) = (locked.state().step(), across(&mut start(pulled(Some(1.0), times())))[2]);
    let other = start(pulled(None, vec![0.5, 2.0, 3.0]));
    let mut foreign = other;
    drop(step(&mut foreign));
    locked.resume(foreign.state().clone()).expect_err("other times");
    assert_eq!(locked.state().step(), step_before);
    assert!((across(&mut locked)[0] - force).abs() < 1e-6);
}

/// Supports along skew directions that hold both sides leave no row, wherever they do; moved alike they may.
#[test]
fn supports_of_both_sides_are_judged_together() {
    let scene = |own: Support, other: Support, held: [bool; 6]| {
        let scene = bar(1, [2, 1, 1]).with_support(own).with_support(other);
        Simulation::new(scene.with_coupling(end().with_held(held)), Settings::default()).map(|_| ())
    };
    let mesh = bar(1, [1; 3]).mesh().clone();
    let rim = |tag| -> Vec<u32> {
        let nodes = mesh.nodes_on(tag).into_iter();
        nodes.filter(|n| mesh.points()[*n as usize][1] < 1e-9).collect()
    };
    let skew = || Support::partial(rim(SECOND), Directions::Vectors(vec![[1.0, 1.0, 0.0]]));
    let refused = scene(Support::fixed(rim(FIRST)), skew(), ALONG).expect_err("a jump along x and y");
    assert!(refused.to_string().contains("supports hold both sides"), "{refused}");
    assert!(!refused.to_string().contains("  "), "{refused}");
    scene(Support::fixed(rim(FIRST)), skew(), [true; 6]).expect("nothing is free");
    let moved = |tag| Support::fixed(rim(tag)).with_motion([0.0, 1e-4, 0.0], History::constant(1.0));
    scene(moved(FIRST), moved(SECOND), [true; 6]).expect("both move alike");
}

/// A load that nothing holds once a lock is on is refused before any step is solved.
#[test]
fn loads_of_locked_stages_are_checked_before() {
    let aside = || Load::force(UPPER_TOP, [1e3, 0.0, 0.0]);
    let set_up = |friction: f64| {
        let scene = tightened(
            joint(friction, 1),
            bolt().with_lock(AXIAL, 1.0),
            [0.0, 1.0, 0.0],
            aside(),
        );
        Simulation::new(scene, Settings::default())
    };
    assert!(set_up(0.2).is_ok());
    let error = set_up(0.0).expect_err("not held");
    assert!(matches!(error, ContactError::NotHeld { .. }), "{error}");
}

/// The force that tightened a locked bolt goes, as if nothing pressed any more: whether bodies stand apart is looked at
/// without an effort. It took 277 more interior steps, most of the time.
#[test]
fn a_locked_joint_that_slides_is_soon_known_to_press() {
    let history = History::table(vec![(0.0, 0.0), (1.0, 0.0), (2.0, 1.0)]).expect("table");
    let drawn = Support::fixed(UPPER_END).with_motion([3e-5, 0.0, 0.0], history);
    let scene = joint_with(0.2, 1, Some([FacetTag(51), FacetTag(52)])).with_support(drawn);
    let no_pull = Load::force(UPPER_TOP, [0.0; 3]);
    let scene = tightened(scene, bolt().with_lock(AXIAL, 1.0), [0.0, 1.0, 0.0], no_pull);
    let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
    let forces = contact_forces(&mut simulation);
    // the plates slide on each other
    let [along, _, across] = forces[3].0[1].map(f64::abs);
    assert!((along / across - 0.2).abs() < 1e-3, "{forces:?}");
    let steps = simulation.counters().interior_steps;
    assert!(steps <= 150, "{steps} interior steps");
}

/// Locked from the beginning it is held from the beginning: the scene was judged, and refused, as if it were free.
#[test]
fn a_lock_before_the_first_step_is_there_at_once() {
    let mesh = bar(1, [2, 1, 1]).mesh().clone();
    let scene = Scene::new(mesh, uniform(1e9, 0.3))
        .with_support(Support::fixed(brick::X_MIN))
        .with_contact(Contact::tied(FIRST, SECOND))
        .with_load(Load::force(brick::X_MAX, [1e6, 0.0, 0.0]))
        .with_analysis(Analysis::quasistatic(2.0, 2));
    let locked = scene
        .clone()
        .with_coupling(end().with_held(ALONG).with_lock(AXIAL, 0.5));
    let (mut simulation, results) = run(locked.clone(), Settings::default());
    let (_, held) = run(scene.with_coupling(end().with_held([true; 6])), Settings::default());
    for (found, expected) in results.iter().zip(&held) {
        assert_eq!(found.displacement, expected.displacement);
    }
    // from a state of it, too
    let mut other = Simulation::new(locked, Settings::default()).expect("set-up");
    let _ = other.step().expect("step");
    simulation.resume(other.state().clone()).expect("its state");
    assert_eq!(step(&mut simulation).displacement, results[1].displacement);
}
