//! Loads that a program decides step by step: what a new set-up would give, without one.

use crate::common::*;
use signorini_fem_mesh::Eigenstrain;
use std::ptr;
use std::sync::Arc;

/// A block on a rough floor, clamped at one end or not, in so many steps; without the floor where `contact` is false.
fn scene(clamped: bool, contact: bool) -> Scene {
    let mesh = block([3.0, 1.0, 1.0], [6, 2, 2]);
    let mut scene = Scene::new(mesh, steel())
        .with_boxes([3, 1, 1])
        .with_analysis(backward(1.0, 5));
    if clamped {
        scene = scene.with_support(Support::fixed(brick::X_MIN));
    }
    if contact {
        scene = scene.with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.4)));
    }
    scene
}

fn backward(end: f64, steps: usize) -> Analysis {
    Analysis::quasistatic(end, steps)
}

/// What another program finds at a step: a pressure that grows, and a warm place that moves along the block.
fn found(step: usize, mesh: &TetMesh) -> Vec<Load> {
    let front = 0.6 * step as f64;
    let rises = mesh
        .points()
        .iter()
        .map(|p| 80.0 * (1.0 - (p[0] - front).abs()).max(0.0));
    let heat = Eigenstrain::expansion(12e-6).with_factors(rises.collect());
    vec![
        Load::pressure(brick::Z_MAX, 1e6 * (1.0 + step as f64)),
        Load::traction(brick::X_MAX, [2e5 * (3.0 - step as f64), 1e5, 0.0]),
        Load::eigenstrain(heat),
    ]
}

fn with_loads(scene: &Scene, loads: Vec<Load>) -> Scene {
    loads.into_iter().fold(scene.clone(), Scene::with_load)
}

#[test]
fn they_give_the_bits_of_a_new_set_up() {
    for (clamped, contact) in [(true, true), (false, true), (true, false)] {
        for method in methods() {
            let (scene, what) = (scene(clamped, contact), format!("{clamped} {contact} {method:?}"));
            let first = with_loads(&scene, found(0, scene.mesh()));
            let mut simulation = Simulation::new(first, by(method.clone())).expect("set-up");
            let matrices = ptr::from_ref(simulation.tfeti());
            for step in 0..5 {
                let state = simulation.state().clone();
                simulation.set_loads(found(step, scene.mesh())).expect("loads");
                let result = simulation.step().expect("step");
                assert!(result.report().status.converged(), "{what}, step {step}");
                let anew = with_loads(&scene, found(step, scene.mesh()));
                let mut anew = Simulation::new(anew, by(method.clone())).expect("set-up");
                anew.resume(state).expect("state");
                let other = anew.step().expect("step");
                assert_eq!(result.displacement(), other.displacement(), "{what}, step {step}");
                assert_eq!(result.points(), other.points(), "{what}, step {step}");
                assert_eq!(simulation.plan().vector_bytes, anew.plan().vector_bytes);
            }
            assert!(ptr::eq(matrices, simulation.tfeti()), "{what}");
        }
    }
}

#[test]
fn results_keep_the_loads_of_their_step() {
    let scene = scene(true, true);
    let mut simulation =
        Simulation::new(with_loads(&scene, found(0, scene.mesh())), Settings::default()).expect("set-up");
    let force = |result: &Arc<StepResult>| result.reactions().loads.force;
    let first = simulation.step().expect("step");
    let before = force(&first);
    simulation
        .set_loads(vec![Load::pressure(brick::Z_MAX, 5e6)])
        .expect("loads");
    assert_eq!(force(&first), before);
    assert_eq!(simulation.scene().loads().len(), 1);
    let second = simulation.step().expect("step");
    assert!((force(&second)[2] / -15e6 - 1.0).abs() < 1e-12, "{:?}", force(&second));
}

/// As a coupled program does that iterates until both agree.
#[test]
fn a_step_may_be_repeated_with_other_loads() {
    fn sent<T: Send>(value: T) -> T {
        value
    }
    let scene = scene(false, true);
    let start = || with_loads(&scene, found(0, scene.mesh()));
    let mut simulation = sent(Simulation::new(start(), Settings::default()).expect("set-up"));
    let mut other = Simulation::new(start(), Settings::default()).expect("set-up");
    for step in 0..4 {
        let before = simulation.state().clone();
        for guess in [0, 4, step] {
            simulation.resume(before.clone()).expect("state");
            simulation.set_loads(found(guess, scene.mesh())).expect("loads");
            let _ = simulation.step().expect("step");
        }
        other.set_loads(found(step, scene.mesh())).expect("loads");
        let expected = other.step().expect("step");
        let result = simulation.result().expect("a result");
        assert_eq!(result.displacement(), expected.displacement(), "step {step}");
        assert_eq!(simulation.state(), other.state(), "step {step}");
    }
}

/// What is wrong with them is told as in a new scene, and nothing has changed then; steps before count no more.
#[test]
fn bad_loads_are_refused() {
    let scene = scene(false, true).with_coupling(Coupling::point([9.0; 3]));
    let mut simulation =
        Simulation::new(with_loads(&scene, found(0, scene.mesh())), Settings::default()).expect("set-up");
    let _ = simulation.step().expect("step");
    for (load, words) in [
        (Load::pressure(FacetTag(77), 1e6), "load 0"),
        (Load::pressure(brick::Z_MAX, f64::NAN), "load 0"),
        (
            Load::eigenstrain(Eigenstrain::expansion(1e-5).with_factors(vec![1.0])),
            "load 0",
        ),
        (Load::traction(brick::X_MAX, [1e6, 0.0, 0.0]), "step 1: body 0"),
        (
            Load::on_coupling(0, [1.0, 0.0, 0.0], [0.0; 3]),
            "pushes the point in a direction",
        ),
        (Load::on_coupling(0, [0.0; 3], [1.0, 0.0, 0.0]), "takes no moments"),
        (Load::on_coupling(3, [1.0, 0.0, 0.0], [0.0; 3]), "load 0"),
    ] {
        let error = simulation.set_loads(vec![load]).expect_err(words).to_string();
        assert!(error.contains(words), "{words}: {error}");
    }
    let mut same = Simulation::new(with_loads(&scene, found(0, scene.mesh())), Settings::default()).expect("set-up");
    let _ = same.step().expect("step");
    let [a, b] = [&mut simulation, &mut same].map(|s| s.step().expect("step"));
    assert_eq!(a.displacement(), b.displacement());
    // a load that the first step would not have held
    let later = History::table(vec![(0.39, -10.0), (0.4, 1.0)]).expect("table");
    let down = Load::pressure(brick::Z_MAX, 1e6).with_history(later);
    simulation.set_loads(vec![down]).expect("loads");
    assert!(simulation.step().expect("step").report().status.converged());
}

/// They belong to the materials, not to the loads: the first set of loads lost them, and the strain with them.
#[test]
fn eigenstrains_of_materials_stay() {
    let materials = steel().with_eigenstrain(1.0, Eigenstrain::expansion(1e-4));
    let scene = Scene::new(block([3.0, 1.0, 1.0], [6, 2, 2]), materials)
        .with_support(Support::fixed(brick::X_MIN))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.4)));
    let loads = || vec![Load::pressure(brick::Z_MAX, 1e6)];
    let mut simulation = Simulation::new(scene.clone(), Settings::default()).expect("set-up");
    for _ in 0..2 {
        simulation.set_loads(loads()).expect("loads");
    }
    assert_eq!(simulation.scene().loads().len(), 2);
    let found = simulation.step().expect("step");
    let anew = solve(with_loads(&scene, loads()), Settings::default());
    assert_eq!(found.displacement().as_flattened(), anew.displacement);
    // strained by a ten-thousandth of its length
    assert!((found.displacement().iter().map(|u| u[0]).fold(0.0, f64::max) / 3e-4 - 1.0).abs() < 0.1);
}

/// Names that the scene has for its loads are not theirs.
#[test]
fn other_loads_have_no_names() {
    let scene = scene(true, true).with_load(Load::pressure(brick::Z_MAX, 1e6));
    let scene = scene.with_names(|part| matches!(part, Part::Load(_)).then(|| "that of the file".into()));
    let error = Simulation::new(
        scene.clone().with_load(Load::pressure(FacetTag(77), 1.0)),
        Settings::default(),
    );
    assert!(error.map(|_| ()).unwrap_err().to_string().contains("that of the file"));
    let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
    let error = simulation
        .set_loads(vec![Load::pressure(FacetTag(77), 1.0)])
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("load 0") && !error.contains("that of the file"),
        "{error}"
    );
}

/// A program gives each step loads that are constant: that the steps differ was not known, and each was first asked
/// whether the last one stands.
#[test]
fn loads_of_every_step_are_known_to_change() {
    let scene = scene(true, true);
    let pressure = |step: usize| 1e6 * (1.0 + step as f64);
    let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
    for k in 0..5 {
        simulation
            .set_loads(vec![Load::pressure(brick::Z_MAX, pressure(k))])
            .expect("loads");
        let found = simulation.step().expect("step").report().counters;
        // the first two tell how loads grow
        assert!(k < 2 || found.products <= 3, "step {k}: {}", found.products);
    }
}
