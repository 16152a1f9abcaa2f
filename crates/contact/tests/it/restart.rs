//! A run that goes on from a stored state is the run that was never interrupted; which scenes a state fits.

use crate::common::*;
use signorini_fem_mesh::SurfaceFrame;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// What the variants of the scene change.
#[derive(Clone)]
struct Parts {
    mesh: TetMesh,
    materials: Materials,
    boxes: [usize; 3],
    supports: Vec<Support>,
    contact: Contact,
    load: Load,
    analysis: Analysis,
}

impl Parts {
    fn new() -> Self {
        Self {
            mesh: block([3.0, 1.0, 1.0], [6, 2, 2]),
            materials: steel(),
            boxes: [3, 1, 1],
            supports: vec![Support::fixed(brick::X_MIN)],
            contact: Contact::rigid(brick::Z_MIN).with_gap(0.1).with_friction(weakening()),
            load: Load::traction(brick::Z_MAX, [0.0, 0.0, -3e9]).with_history(ramp()),
            analysis: paper_steps(1.0, 4),
        }
    }

    /// With one part changed.
    fn with(change: impl FnOnce(&mut Self)) -> Self {
        let mut parts = Self::new();
        change(&mut parts);
        parts
    }

    fn simulation(self) -> Simulation {
        self.simulation_with(Settings::default())
    }

    fn simulation_with(self, settings: Settings) -> Simulation {
        let scene = Scene::new(self.mesh, self.materials)
            .with_load(self.load)
            .with_contact(self.contact)
            .with_boxes(self.boxes)
            .with_analysis(self.analysis);
        let scene = self.supports.into_iter().fold(scene, Scene::with_support);
        Simulation::new(scene, settings).expect("set-up")
    }
}

/// After two steps.
fn stored() -> State {
    let mut simulation = Parts::new().simulation();
    for _ in 0..2 {
        let _ = simulation.step().expect("step");
    }
    simulation.state().clone()
}

fn text(outcome: Result<(), ContactError>) -> String {
    match outcome {
        Err(error @ ContactError::Checkpoint { .. }) => error.to_string(),
        other => panic!("a refusal is expected, not {other:?}"),
    }
}

#[test]
fn another_scene_is_refused_with_the_part_that_differs() {
    let base = Parts::new();
    let moved = base.mesh.clone().map_points(|p| {
        let lift = if p == [1.5, 0.5, 0.5] { 1e-9 } else { 0.0 };
        [p[0], p[1], p[2] + lift]
    });
    // the same tetrahedra in another order
    let mut tets = base.mesh.tets().to_vec();
    tets.swap(0, 1);
    let facets: Vec<Facet> = base.mesh.facets().to_vec();
    let swapped = TetMesh::new(base.mesh.points().to_vec(), tets, facets);
    let frame = SurfaceFrame::from_normal([1.0, 1e-3, 0.0]).expect("frame");
    let oblique = vec![
        Support::partial(brick::X_MIN, Directions::Vectors(vec![frame.normal])),
        Support::partial(brick::X_MAX, Directions::Vectors(frame.tangents.to_vec())),
    ];
    let times = Analysis::Quasistatic {
        times: vec![0.125, 0.25, 0.375, 0.5],
        formula: DifferenceFormula::PAPER,
    };
    let cases = [
        (
            "coordinates of the mesh",
            Parts::with(|p| p.mesh = moved.expect("mesh")),
        ),
        ("tetrahedra", Parts::with(|p| p.mesh = swapped.expect("mesh"))),
        ("subdomains", Parts::with(|p| p.boxes = [1, 1, 3])),
        (
            "nodes or directions of supports",
            Parts::with(|p| p.supports = vec![Support::fixed(brick::X_MAX)]),
        ),
        ("nodes or directions of supports", Parts::with(|p| p.supports = oblique)),
        ("contact points", Parts::with(|p| p.contact = tilted())),
        (
            "weights of the difference formula",
            Parts::with(|p| p.analysis = Analysis::quasistatic(1.0, 4)),
        ),
        ("times of the steps solved", Parts::with(|p| p.analysis = times)),
    ];
    let state = stored();
    for (part, parts) in cases {
        let mut simulation = parts.simulation();
        let before = simulation.state().clone();
        let found = text(simulation.resume(state.clone()));
        assert!(found.contains(&format!("other {part}")), "{part}: {found}");
        assert!(found.contains("without_origin"), "{found}");
        assert!(*simulation.state() == before);
    }
}

#[test]
fn what_may_change_between_steps_is_accepted() {
    let ramped = || up_down_up();
    let twice = vec![
        Support::components(brick::X_MIN, [false, true, true]),
        Support::components(brick::X_MIN, [true, false, false]),
    ];
    let moved = Support::fixed(brick::X_MIN).with_motion([1e-3, 0.0, 0.0], ramped());
    let cases = [
        Parts::new(),
        Parts::with(|p| p.load = Load::pressure(brick::Z_MAX, 1e9).with_history(ramped())),
        Parts::with(|p| p.materials = uniform(1e11, 0.3)),
        // the same directions by other supports
        Parts::with(|p| p.supports = twice),
        Parts::with(|p| p.supports = vec![moved]),
        Parts::with(|p| {
            p.contact = Contact::rigid(brick::Z_MIN)
                .with_gap(0.05)
                .with_friction(Friction::coulomb(0.2))
        }),
        // other steps to come
        Parts::with(|p| p.analysis = paper_steps(2.0, 8)),
    ];
    let state = stored();
    for (k, parts) in cases.into_iter().enumerate() {
        let mut simulation = parts.simulation();
        simulation
            .resume(state.clone())
            .unwrap_or_else(|e| panic!("case {k}: {e}"));
        for result in rest(&mut simulation) {
            assert!(result.report.status.converged(), "case {k}");
        }
    }
    for settings in [at(1e-8), by(Method::paper())] {
        let mut simulation = Parts::new().simulation_with(settings);
        simulation.resume(state.clone()).expect("resume");
    }
}

fn tilted() -> Contact {
    let floor = Contact::rigid(brick::Z_MIN).with_normal([0.0, 0.01, -1.0]);
    floor.with_gap(0.1).with_friction(weakening())
}

#[test]
fn another_scene_on_purpose_is_possible_by_name() {
    let tilted = Parts::with(|p| p.contact = tilted());
    let mut simulation = tilted.clone().simulation();
    simulation.resume(stored().without_origin()).expect("resume");
    assert!(rest(&mut simulation).iter().all(|l| l.report.status.converged()));
    // from here on it is a state of this scene
    let state = simulation.state().clone();
    tilted.simulation().resume(state.clone()).expect("resume");
    assert!(text(Parts::new().simulation().resume(state)).contains("contact points"));
    // sizes still count
    let other = Parts::with(|p| p.boxes = [6, 1, 1]);
    let found = text(other.simulation().resume(stored().without_origin()));
    assert!(found.contains("another number of rows"), "{found}");
}

/// A body that its support lowers to a floor: where nothing presses yet, products with F are rounding errors of the
/// displacement, and kept all the same.
#[test]
fn a_body_that_nothing_loads_yet_continues_bit_for_bit() {
    let down = History::table(vec![(0.0, 0.0), (0.5, 1.0), (0.8, 0.2), (1.0, 1.1)]);
    let down = down.expect("table");
    let parts = |steps| Parts {
        mesh: block([2.0, 1.0, 1.0], [4, 2, 2]),
        materials: uniform(1e9, 0.3),
        boxes: [2, 1, 1],
        supports: vec![Support::fixed(brick::Z_MAX).with_motion([2e-4, 1e-4, -1e-3], down.clone())],
        contact: Contact::rigid(brick::Z_MIN)
            .with_gap(4e-4)
            .with_friction(Friction::coulomb(0.3)),
        load: Load::traction(brick::Z_MIN, [0.0; 3]),
        analysis: paper_steps(1.0, steps),
    };
    for settings in [
        Settings::default(),
        Settings::default().with_accuracy(Accuracy::Relative(1e-6)),
    ] {
        for steps in [5, 8] {
            let new = || parts(steps).simulation_with(settings.clone());
            let mut whole = new();
            let (mut states, mut displacements) = (Vec::new(), Vec::new());
            while !whole.is_finished() {
                displacements.push(step(&mut whole).displacement);
                states.push(whole.state().clone());
            }
            for (result, state) in states.into_iter().enumerate() {
                let mut again = new();
                again.resume(state.clone()).expect("resume");
                assert!(*again.state() == state, "{result}");
                for (one, expected) in rest(&mut again).iter().zip(&displacements[result + 1..]) {
                    assert_eq!(one.displacement, *expected, "{steps} steps, after {result}");
                }
            }
        }
    }
}

/// Quadratic elements: means over facets, and a state that fits no other order.
#[test]
fn quadratic_elements_continue_bit_for_bit() {
    let quadratic = || {
        Parts::with(|p| {
            p.mesh = p.mesh.raise_order().expect("quadratic");
            p.contact = Contact::rigid(brick::Z_MIN).with_friction(weakening());
        })
        .simulation()
    };
    let mut whole = quadratic();
    let all: Vec<_> = rest(&mut whole).iter().map(bits).collect();
    let mut first = quadratic();
    for _ in 0..2 {
        step(&mut first);
    }
    let mut again = quadratic();
    again.resume(first.state().clone()).expect("resume");
    assert!(rest(&mut again).iter().map(bits).eq(all[2..].iter().cloned()));
    assert!(again.state() == whole.state());
    let found = text(quadratic().resume(stored()));
    assert!(found.contains("other"), "{found}");
    let found = text(Parts::new().simulation().resume(first.state().clone()));
    assert!(found.contains("other"), "{found}");
}

/// Before the first step a state says nothing that another scene could misread.
#[test]
fn a_state_before_the_first_step_starts_any_scene() {
    let fresh = Parts::new().simulation().state().clone();
    let other = Parts::with(|p| p.mesh = block([3.0, 1.0, 1.0], [3, 1, 1]));
    other.simulation().resume(fresh).expect("resume");
}

/// The small benchmark with another modulus.
fn stiff_as(young: f64) -> Simulation {
    let base = small_benchmark(weakening(), 6);
    let elastic = Materials::uniform(Hooke::isotropic(young, 0.277).expect("Hooke"));
    let mut scene = Scene::new(base.mesh().clone(), elastic)
        .with_boxes([3, 1, 1])
        .with_analysis(base.analysis().clone());
    scene = base.supports().iter().cloned().fold(scene, Scene::with_support);
    scene = base.loads().iter().cloned().fold(scene, Scene::with_load);
    scene = base.contacts().iter().cloned().fold(scene, Scene::with_contact);
    Simulation::new(scene, Settings::default()).expect("set-up")
}

/// Products with F are those of the stiffness: a body a thousand times stiffer goes on from them only if they are
/// computed anew.
#[test]
fn products_of_other_materials_are_computed_anew() {
    let young = 211.9e9;
    let mut before = stiff_as(young);
    for _ in 0..3 {
        let _ = before.step().expect("step");
    }
    for factor in [1e-3, 0.3, 3.0, 1e3] {
        let mut simulation = stiff_as(factor * young);
        simulation.resume(before.state().clone()).expect("resume");
        for (k, result) in rest(&mut simulation).iter().enumerate() {
            assert_certified(result, &format!("modulus times {factor}, step {k} after it"));
        }
    }
}

fn restarts_bit_by_bit(method: &Method) {
    for law in [
        Friction::None,
        Friction::tresca(3e8),
        Friction::coulomb(0.3),
        weakening(),
    ] {
        let new = || Simulation::new(small_benchmark(law.clone(), 8), by(method.clone())).expect("set-up");
        let (whole, end) = fingerprint(small_benchmark(law.clone(), 8), by(method.clone()));
        for after in [0, 1, 2, 5, 7] {
            let mut first = new();
            for _ in 0..after {
                step(&mut first);
            }
            let mut again = new();
            again.resume(first.state().clone()).expect("resume");
            let tail: Vec<_> = rest(&mut again).iter().map(bits).collect();
            assert!(tail == whole[after..], "{law:?}, after {after}");
            assert!(*again.state() == end, "{law:?}, after {after}: state");
        }
    }
}

#[test]
fn a_restart_of_the_default_method_equals_the_uninterrupted_run_bit_by_bit() {
    restarts_bit_by_bit(&Method::default());
}

#[test]
fn a_restart_of_the_papers_method_equals_the_uninterrupted_run_bit_by_bit() {
    restarts_bit_by_bit(&Method::paper());
}

#[test]
fn a_restart_of_the_one_loop_equals_the_uninterrupted_run_bit_by_bit() {
    restarts_bit_by_bit(&Method::one_loop());
}

/// A step that is cut in two after it was tried equals one that was small from the beginning.
#[test]
fn a_cut_step_retried_equals_the_small_steps() {
    for method in methods() {
        let at = |times: &[f64]| {
            small_benchmark(Friction::coulomb(0.3), 1).with_analysis(Analysis::Quasistatic {
                times: times.to_vec(),
                formula: DifferenceFormula::BACKWARD_EULER,
            })
        };
        let (coarse, fine) = (at(&[0.2, 0.4, 0.8, 1.0]), at(&[0.2, 0.4, 0.6, 0.8, 1.0]));
        let (expected, _) = fingerprint(fine.clone(), by(method.clone()));
        let mut tried = Simulation::new(coarse, by(method.clone())).expect("set-up");
        step(&mut tried);
        step(&mut tried);
        let before = tried.state().clone();
        let rejected = step(&mut tried);
        let mut retry = Simulation::new(fine, by(method.clone())).expect("set-up");
        retry.resume(before).expect("resume");
        let tail: Vec<_> = rest(&mut retry).iter().map(bits).collect();
        assert!(tail == expected[2..], "{}", method.kind());
        // and the large step was indeed another one
        assert!(bits(&rejected) != expected[3], "{}", method.kind());
    }
}

/// A law that fails in the middle of a run: the error comes every time, and the run can go on once the law is well.
#[test]
fn a_law_that_fails_or_panics_leaves_the_run_as_it_was() {
    let mode = Arc::new(AtomicUsize::new(0));
    let inner = mode.clone();
    let law = Coefficient::rate_field(move |_, _| match inner.load(Ordering::Relaxed) {
        0 => 0.3,
        1 => f64::NAN,
        _ => panic!("a law of the user"),
    });
    let scene = small_benchmark(Friction::Coulomb(law), 4);
    let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
    assert!(simulation.result().is_none(), "before the first step");
    step(&mut simulation);
    let before = simulation.state().clone();
    for kind in [1, 1, 2, 2] {
        mode.store(kind, Ordering::Relaxed);
        let outcome = catch_unwind(AssertUnwindSafe(|| simulation.step().is_err()));
        assert!(outcome.is_err() == (kind == 2) && outcome.unwrap_or(true));
        assert!(simulation.result().is_none() && *simulation.state() == before);
    }
    mode.store(0, Ordering::Relaxed);
    assert_eq!(rest(&mut simulation).len(), 3);
    assert!(simulation.result().is_some());
}

/// A body that friction alone holds, in so many steps, of which those after the third have no load.
fn let_go(steps: usize) -> Scene {
    let table = |sideways: f64| {
        History::table(vec![
            (0.0, 0.0),
            (1.0, 1.0),
            (2.0, sideways),
            (3.0, sideways),
            (4.0, 0.0),
        ])
        .expect("table")
    };
    Scene::new(block([1.0; 3], [3; 3]), uniform(1e3, 0.3))
        .with_load(Load::force(brick::Z_MAX, [0.0, 0.0, -10.0]).with_history(table(1.0)))
        .with_load(Load::force(brick::X_MIN, [1.0, 0.3, 0.0]).with_history(table(2.0)))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.4)))
        .with_analysis(Analysis::quasistatic(steps as f64, steps))
}

/// The state after the last step of an analysis begins a longer one: it did not say where loose bodies stood, nor, after
/// a single step, what pressed.
#[test]
fn a_longer_analysis_goes_on_from_the_last_state() {
    let whole = run(let_go(5), Settings::default()).1;
    for steps in [1, 2, 3, 4] {
        let (short, _) = run(let_go(steps), Settings::default());
        let mut longer = Simulation::new(let_go(5), Settings::default()).expect("set-up");
        longer.resume(short.state().clone()).expect("resume");
        for (found, expected) in rest(&mut longer).iter().zip(&whole[steps..]) {
            assert!(bits(found) == bits(expected), "after {steps} steps, at {}", found.time);
        }
    }
}

/// Friction that is elsewhere is another scene, also with as many points and rows.
#[test]
fn friction_of_another_contact_is_refused() {
    let scene = |below: bool| {
        let rough =
            |contact: Contact, on: bool| if on { contact.with_friction(Friction::coulomb(0.3)) } else { contact };
        Scene::new(block([1.0; 3], [2; 3]), steel())
            .with_support(Support::fixed(brick::X_MIN))
            .with_load(Load::traction(brick::X_MAX, [1e6, 0.0, -1e6]))
            .with_contact(rough(Contact::rigid(brick::Z_MIN), below))
            .with_contact(rough(Contact::rigid(brick::Z_MAX), !below))
            .with_analysis(Analysis::quasistatic(2.0, 2))
    };
    let mut one = Simulation::new(scene(true), Settings::default()).expect("set-up");
    step(&mut one);
    let mut other = Simulation::new(scene(false), Settings::default()).expect("set-up");
    assert!(text(other.resume(one.state().clone())).contains("contact points"));
}
