//! Which scenes a stored state can be continued in, and what the refusal of others says.

mod common;

use common::{block, rest, state_bits, steel, up_down_up, weakening};
use signorini_contact::{
    Accuracy, Analysis, Contact, ContactError, DifferenceFormula, Directions, Friction, Load,
    Method, Scene, Settings, Simulation, State, Support,
};
use signorini_fem_mesh::{Facet, History, Hooke, Materials, SurfaceFrame, TetMesh, brick};
use signorini_tfeti::RowScaling;

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
            contact: Contact::rigid(brick::Z_MIN)
                .with_gap(0.1)
                .with_friction(weakening()),
            load: Load::traction(brick::Z_MAX, [0.0, 0.0, -3e9]).with_history(common::ramp()),
            analysis: Analysis::quasistatic(1.0, 4),
        }
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

/// After two levels.
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
    let times = |times: [f64; 4]| Analysis::Quasistatic {
        times: times.to_vec(),
        formula: DifferenceFormula::THREE_STEP,
    };
    let moved = base.mesh.clone().map_points(|p| {
        let lift = if p == [1.5, 0.5, 0.5] { 1e-9 } else { 0.0 };
        [p[0], p[1], p[2] + lift]
    });
    // the same tetrahedra in another order
    let mut tets = base.mesh.tets().to_vec();
    tets.swap(0, 1);
    let facets: Vec<Facet> = base.mesh.facets().to_vec();
    let swapped = TetMesh::new(base.mesh.points().to_vec(), tets, facets);
    let tilted = Contact::rigid(brick::Z_MIN)
        .with_normal([0.0, 0.01, -1.0])
        .with_gap(0.1)
        .with_friction(weakening());
    let oblique = [1.0, 1e-3, 0.0];
    let planes = |normal: [f64; 3]| {
        let frame = SurfaceFrame::from_normal(normal).expect("frame");
        let [a, b] = frame.tangents;
        vec![
            Support::partial(brick::X_MIN, Directions::Vectors(vec![frame.normal])),
            Support::partial(brick::X_MAX, Directions::Vectors(vec![a, b])),
        ]
    };
    let cases = [
        (
            Parts {
                mesh: moved.expect("mesh"),
                ..base.clone()
            },
            "other coordinates of the mesh",
        ),
        (
            Parts {
                mesh: swapped.expect("mesh"),
                ..base.clone()
            },
            "other tetrahedra",
        ),
        (
            Parts {
                boxes: [1, 1, 3],
                ..base.clone()
            },
            "other subdomains",
        ),
        (
            Parts {
                supports: vec![Support::fixed(brick::X_MAX)],
                ..base.clone()
            },
            "other nodes or directions of supports",
        ),
        (
            Parts {
                supports: planes(oblique),
                ..base.clone()
            },
            "other nodes or directions of supports",
        ),
        (
            Parts {
                contact: tilted,
                ..base.clone()
            },
            "other contact points",
        ),
        (
            Parts {
                analysis: base
                    .analysis
                    .clone()
                    .with_formula(DifferenceFormula::BACKWARD_EULER),
                ..base.clone()
            },
            "other weights of the difference formula",
        ),
        (
            Parts {
                analysis: times([0.125, 0.25, 0.375, 0.5]),
                ..base
            },
            "other times of the levels solved",
        ),
    ];
    let state = stored();
    for (parts, expected) in cases {
        let mut simulation = parts.simulation();
        let before = state_bits(simulation.state());
        let found = text(simulation.resume(state.clone()));
        assert!(found.contains(expected), "{expected}: {found}");
        assert!(found.contains("without_origin"), "{found}");
        assert_eq!(state_bits(simulation.state()), before);
    }
}

#[test]
fn what_may_change_between_levels_is_accepted() {
    let base = Parts::new();
    let twice = vec![
        Support::components(brick::X_MIN, [false, true, true]),
        Support::components(brick::X_MIN, [true, false, false]),
    ];
    let softer = Materials::uniform(Hooke::isotropic(1e11, 0.3).expect("Hooke"));
    let cases = [
        base.clone(),
        Parts {
            load: Load::pressure(brick::Z_MAX, 1e9).with_history(up_down_up()),
            ..base.clone()
        },
        Parts {
            materials: softer,
            ..base.clone()
        },
        // the same directions by other supports
        Parts {
            supports: twice,
            ..base.clone()
        },
        Parts {
            supports: vec![
                Support::fixed(brick::X_MIN).with_motion([1e-3, 0.0, 0.0], up_down_up()),
            ],
            ..base.clone()
        },
        Parts {
            contact: Contact::rigid(brick::Z_MIN)
                .with_gap(0.05)
                .with_friction(Friction::coulomb(0.2)),
            ..base.clone()
        },
        // other levels to come
        Parts {
            analysis: Analysis::quasistatic(2.0, 8),
            ..base.clone()
        },
    ];
    let state = stored();
    for (k, parts) in cases.into_iter().enumerate() {
        let mut simulation = parts.simulation();
        simulation
            .resume(state.clone())
            .unwrap_or_else(|e| panic!("case {k}: {e}"));
        for level in rest(&mut simulation) {
            assert!(level.report.status.converged(), "case {k}");
        }
    }
    for settings in [
        Settings::default().with_tolerance(1e-8),
        Settings::default().with_method(Method::paper()),
        Settings::default().with_row_scaling(RowScaling::Chained),
    ] {
        let mut simulation = base.clone().simulation_with(settings);
        simulation.resume(state.clone()).expect("resume");
    }
}

#[test]
fn another_scene_on_purpose_is_possible_by_name() {
    let tilted = Parts {
        contact: Contact::rigid(brick::Z_MIN)
            .with_normal([0.0, 0.01, -1.0])
            .with_gap(0.1)
            .with_friction(weakening()),
        ..Parts::new()
    };
    let mut simulation = tilted.clone().simulation();
    simulation
        .resume(stored().without_origin())
        .expect("resume");
    assert!(
        rest(&mut simulation)
            .iter()
            .all(|l| l.report.status.converged())
    );
    // from here on it is a state of this scene
    let state = simulation.state().clone();
    tilted.simulation().resume(state.clone()).expect("resume");
    assert!(text(Parts::new().simulation().resume(state)).contains("contact points"));
    // sizes still count
    let mut other = Parts {
        boxes: [6, 1, 1],
        ..Parts::new()
    };
    other.analysis = Analysis::quasistatic(1.0, 4);
    let found = text(other.simulation().resume(stored().without_origin()));
    assert!(found.contains("another number of rows"), "{found}");
}

/// A body that its support lowers to a floor: where nothing presses yet, products with F are rounding errors of the displacement, and
/// kept all the same.
#[test]
fn a_body_that_nothing_loads_yet_continues_bit_for_bit() {
    let down = History::table(vec![(0.0, 0.0), (0.5, 1.0), (0.8, 0.2), (1.0, 1.1)]);
    let down = down.expect("table");
    let parts = |steps| Parts {
        mesh: block([2.0, 1.0, 1.0], [4, 2, 2]),
        materials: common::uniform(1e9, 0.3),
        boxes: [2, 1, 1],
        supports: vec![Support::fixed(brick::Z_MAX).with_motion([2e-4, 1e-4, -1e-3], down.clone())],
        contact: Contact::rigid(brick::Z_MIN)
            .with_gap(4e-4)
            .with_friction(Friction::coulomb(0.3)),
        load: Load::traction(brick::Z_MIN, [0.0; 3]),
        analysis: Analysis::quasistatic(1.0, steps),
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
                displacements.push(common::step(&mut whole).displacement);
                states.push(whole.state().clone());
            }
            for (level, state) in states.into_iter().enumerate() {
                let mut again = new();
                again.resume(state.clone()).expect("resume");
                assert_eq!(state_bits(again.state()), state_bits(&state), "{level}");
                for (one, expected) in rest(&mut again).iter().zip(&displacements[level + 1..]) {
                    assert_eq!(one.displacement, *expected, "{steps} steps, after {level}");
                }
            }
        }
    }
}

/// Before the first level a state says nothing that another scene could misread.
#[test]
fn a_state_before_the_first_level_starts_any_scene() {
    let fresh = Parts::new().simulation().state().clone();
    let other = Parts {
        mesh: block([3.0, 1.0, 1.0], [3, 1, 1]),
        ..Parts::new()
    };
    other.simulation().resume(fresh).expect("resume");
}

#[cfg(feature = "checkpoint")]
#[test]
fn bytes_keep_it() {
    let bytes = stored().to_bytes().expect("encode");
    let state = State::from_bytes(&bytes).expect("decode");
    assert_eq!(state, stored());
    let mut other = Parts {
        supports: vec![Support::fixed(brick::X_MAX)],
        ..Parts::new()
    }
    .simulation();
    assert!(text(other.resume(state.clone())).contains("supports"));
    let mut same = Parts::new().simulation();
    same.resume(state).expect("resume");
}
