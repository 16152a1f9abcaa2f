//! What is allowed but hardly meant is said once, with figure, place and remedy, and nothing of it changes a result.

use crate::common::*;
use crate::curved_sides::ring;
use signorini_fem_mesh::Eigenstrain;
use std::mem::discriminant;

/// All that an observer is told.
#[derive(Default)]
struct Told {
    warnings: Vec<Warning>,
    /// Warnings known when each step was told.
    at_step: Vec<usize>,
    finished: bool,
}

impl Observer for Told {
    fn warning(&mut self, warning: &Warning) {
        assert!(!self.finished);
        self.warnings.push(warning.clone());
    }

    fn step(&mut self, _: &StepResult) -> Flow {
        self.at_step.push(self.warnings.len());
        Flow::Continue
    }

    fn finished(&mut self, _: usize) {
        self.finished = true;
    }
}

/// Runs a scene; what is told is what is reported, and each kind comes once.
fn told(scene: Scene) -> (RunReport, Told) {
    let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
    let mut told = Told::default();
    let report = simulation.run(&mut told).expect("run");
    assert_eq!(report.warnings(), told.warnings);
    for (k, warning) in told.warnings.iter().enumerate() {
        assert!(
            told.warnings[..k]
                .iter()
                .all(|w| discriminant(w) != discriminant(warning)),
            "{warning}"
        );
    }
    (report, told)
}

/// The one warning of a kind.
fn only(found: &[Warning], such: impl Fn(&Warning) -> bool) -> &Warning {
    let mut such = found.iter().filter(|w| such(w));
    let warning = such.next().unwrap_or_else(|| panic!("none in {found:?}"));
    assert!(such.next().is_none());
    warning
}

/// A column on three planes that hold one direction each, so that its strain is the same everywhere.
fn column(cells: usize) -> Scene {
    let plane = |tag, c: usize| {
        let mut on = [false; 3];
        on[c] = true;
        Support::components(tag, on)
    };
    Scene::new(block([1.0, 1.0, 2.0], [cells; 3]), uniform(1e9, 0.0))
        .with_support(plane(brick::X_MIN, 0))
        .with_support(plane(brick::Y_MIN, 1))
        .with_support(plane(brick::Z_MIN, 2))
}

/// The same, pressed down from above, in full at time 1.
fn pressed_column(pressure: f64, steps: usize) -> Scene {
    column(2)
        .with_load(Load::pressure(brick::Z_MAX, pressure).with_history(ramp()))
        .with_analysis(Analysis::quasistatic(1.0, steps))
}

/// The brick of the benchmark with a part of its loads and its gap.
fn brick_of_the_benchmark(part: f64) -> Scene {
    Scene::new(block([3.0, 1.0, 1.0], [15, 5, 5]), steel())
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -30e8 * part]).with_history(ramp()))
        .with_load(Load::traction(brick::X_MAX, [9e8 * part, 0.0, -15e8 * part]).with_history(up_down_up()))
        .with_contact(
            Contact::rigid(brick::Z_MIN)
                .with_gap(0.1 * part)
                .with_friction(weakening()),
        )
        .with_boxes([3, 1, 1])
        .with_analysis(paper_steps(1.0, 10))
}

#[test]
fn mild_scenes_are_not_warned_of() {
    let (report, _) = told(pressed_column(1e6, 3));
    assert_eq!(report.warnings(), []);
    assert!(report.mesh_error.expect("an error") < 1e-6);
    // nothing but its mesh: 15 by 5 by 5 cells leave a quarter
    let (report, told) = told(brick_of_the_benchmark(0.1));
    let error = report.mesh_error.expect("an error");
    assert!((0.2..0.3).contains(&error), "{error}");
    assert!(matches!(report.warnings(), [Warning::CoarseMesh { step: 9, error: e, .. }] if *e == error));
    assert_eq!(told.at_step, [0; 10]);
}

/// The brick of the benchmark: its displacements are within a tenth of its length, its strains at the free corner are
/// not within 5 %.
#[test]
fn the_benchmark_is_warned_of_its_strain() {
    let (report, told) = told(brick_of_the_benchmark(1.0));
    let [Warning::LargeStrain { step: 3, strain, .. }, Warning::CoarseMesh { .. }] = report.warnings() else {
        panic!("{:?}", report.warnings());
    };
    assert!((0.05..0.1).contains(strain), "{strain}");
    assert_eq!(told.at_step[2..4], [0, 1]);
}

/// E = 1e9 Pa and nu = 0: the strain is the pressure over E, to the tolerance of 1e-6, where it is first too large,
/// once.
#[test]
fn strains_and_displacements_are_named_where_they_are_first_large() {
    let (report, observed) = told(pressed_column(6e7, 4));
    let [Warning::LargeStrain { step: 3, strain, .. }] = report.warnings() else {
        panic!("{:?}", report.warnings());
    };
    assert!((strain - 0.06).abs() < 1e-6, "{strain}");
    assert_eq!(observed.at_step, [0, 0, 0, 1]);
    let text = report.warnings()[0].to_string();
    assert!(
        text.contains("step 3") && text.contains("6.0 %") && text.contains("units of loads"),
        "{text}"
    );

    let (report, observed) = told(pressed_column(3e8, 4));
    assert_eq!(observed.at_step, [1, 2, 2, 2]);
    let moved = only(report.warnings(), |w| matches!(w, Warning::LargeDisplacement { .. }));
    let Warning::LargeDisplacement {
        step: 1,
        place,
        displacement,
        extent,
        ..
    } = moved
    else {
        panic!("{moved}");
    };
    assert!(
        (displacement - 0.3).abs() < 1e-6 && place[2] == 2.0 && *extent == 2.0,
        "{moved}"
    );
    let text = moved.to_string();
    assert!(
        text.contains("is 3.000e-1, the body is 2.000e0 long") && text.contains("supports"),
        "{text}"
    );
}

/// Each body is measured by itself: what is little for a long one is much for a small one.
#[test]
fn bodies_are_measured_by_themselves() {
    let (long, small) = (block([10.0, 1.0, 1.0], [10, 1, 1]), block([0.5; 3], [2; 3]));
    let mesh = with_second(&long, &lifted(&small, 5.0));
    let moved = |tag, way| Support::fixed(tag).with_motion([way, 0.0, 0.0], History::constant(1.0));
    let scene = |way| {
        Scene::new(mesh.clone(), steel())
            .with_support(moved(brick::Z_MIN, 0.2))
            .with_support(moved(second(brick::Z_MIN), way))
    };
    let result = |scene| {
        Simulation::new(scene, Settings::default())
            .expect("set-up")
            .step()
            .expect("step")
    };
    assert_eq!(result(scene(0.04)).warnings(), []);
    let warnings = result(scene(0.06)).warnings();
    let [
        Warning::LargeDisplacement {
            node,
            displacement,
            extent,
            ..
        },
    ] = warnings[..]
    else {
        panic!("{warnings:?}");
    };
    assert!(mesh.points()[node as usize][2] >= 5.0 && extent == 0.5 && (displacement - 0.06).abs() < 1e-6);
}

/// A shaft in a vee that turns past its torque until the next nodes touch: 32 cells around, so half of one is 5.6
/// degrees.
#[test]
fn bodies_that_turn_far_are_named() {
    let shaft = |torque: f64| {
        let scene = Scene::new(ring([2.0, 10.0], [2, 32, 1], 0.0, 1), steel())
            .with_support(Support::components(brick::Z_MIN, [false, false, true]))
            .with_load(Load::force(brick::Z_MIN, [0.0, -5e5, 0.0]))
            .with_load(Load::force(brick::Z_MAX, [0.0, -5e5, 0.0]))
            .with_load(Load::moment(brick::Z_MAX, [0.0, 0.0, torque]));
        let vee = [-1.0, 1.0].into_iter().fold(scene, |scene, side: f64| {
            let out = [-side, 1.0, 0.0].map(|c| c * 0.5f64.sqrt());
            let wall = Contact::half_space(brick::X_MAX, out.map(|c| -10.0 * c), out);
            scene.with_contact(wall.with_friction(Friction::coulomb(0.3)))
        });
        told(vee).0
    };
    // friction holds sqrt(2) mu / (1 + mu^2) of weight times radius: 3.89e6
    let turned = |w: &Warning| matches!(w, Warning::LargeRotation { .. });
    let report = shaft(3.8e6);
    assert!(report.converged() && !report.warnings().iter().any(turned));
    let report = shaft(5e6);
    let warning = only(report.warnings(), turned);
    let Warning::LargeRotation { step: 0, turn, .. } = warning else {
        panic!("{warning}");
    };
    assert!(report.converged() && (turn - 5.625).abs() < 0.1, "{warning}");
    assert!(warning.to_string().contains("support the body"), "{warning}");

    // an exact rotation about any axis of one of two bodies
    let mesh = with_second(
        &block([10.0, 1.0, 1.0], [5, 1, 1]),
        &lifted(&block([1.0; 3], [2; 3]), 5.0),
    );
    for (angle, warned) in [(0.049, false), (0.051, true)] {
        let axis = [2.0 / 7.0, -3.0 / 7.0, 6.0 / 7.0].map(|c| c * angle);
        let held = mesh.nodes_on(second(brick::X_MIN));
        let from = |&n: &u32| [0, 1, 2].map(|c| mesh.points()[n as usize][c] - [0.5, 0.5, 5.5][c]);
        let motions = held.iter().map(|n| cross(axis, from(n))).collect();
        let scene = Scene::new(mesh.clone(), steel())
            .with_support(Support::fixed(brick::X_MIN))
            .with_support(Support::fixed(held).with_motions(motions, History::constant(1.0)));
        let (report, _) = told(scene);
        match report.warnings() {
            [] => assert!(!warned),
            [Warning::LargeRotation { node, turn, .. }] => {
                assert!(warned && mesh.points()[*node as usize][2] >= 5.0);
                assert!((turn.to_radians() - angle).abs() < 1e-6, "{turn}");
            }
            other => panic!("{other:?}"),
        }
    }
}

/// An obstacle is drawn by 0.8 m under a block whose facets have edges of 0.5 and 0.71 m, at once or in four steps.
/// Where its shape gives the normals it tells whether they have turned.
#[test]
fn slips_past_a_facet_are_named() {
    let plane = Obstacle::half_space([0.0, 0.0, 1e-3], [0.0, 0.0, 1.0]);
    let rigid = || Contact::rigid(brick::Z_MIN).with_gap(-1e-3);
    let shaped = Contact::obstacle(brick::Z_MIN, plane);
    let scene = |floor: Contact, steps| {
        let floor = floor.with_friction(Friction::coulomb(0.2));
        Scene::new(block([1.0; 3], [2; 3]), uniform(1e9, 0.3))
            .with_support(Support::fixed(brick::Z_MAX))
            .with_contact(floor.with_motion([0.8, 0.0, 0.0], ramp()))
            .with_analysis(Analysis::quasistatic(1.0, steps))
    };
    let long = |w: &Warning| matches!(w, Warning::LongSlip { .. });
    assert!(!told(scene(rigid(), 4)).0.warnings().iter().any(long));
    assert!(!told(scene(shaped, 1)).0.warnings().iter().any(long));
    let (report, _) = told(scene(rigid(), 1));
    let warning = only(report.warnings(), long);
    let Warning::LongSlip {
        step: 0,
        contact: 0,
        slip,
        edge,
        ..
    } = warning
    else {
        panic!("{warning}");
    };
    assert!(
        (slip - 0.8).abs() < 0.01 && (0.4999..0.7072).contains(edge),
        "{warning}"
    );
    assert!(warning.to_string().contains("smaller steps"), "{warning}");
}

#[test]
fn the_plan_has_the_warnings_of_the_scene() {
    let plan = |scene: &Scene| Plan::new(scene, &Settings::default()).expect("plan");
    let floor = || Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.3));
    // far at the ends, near in the middle; 2 m long
    assert_eq!(
        plan(&clamped().with_contact(floor().with_gap_field(|x| 9.0 * (x[0] - 1.0).powi(2)))).warnings(),
        []
    );
    assert_eq!(plan(&clamped().with_contact(floor().with_gap(1.9))).warnings(), []);
    // where no support holds a node inside
    let push = || Load::pressure(brick::X_MAX, 1.0);
    let hung = || Scene::new(block([2.0, 1.0, 1.0], [4, 2, 2]), steel()).with_support(Support::fixed(brick::Z_MAX));
    let hung = || hung().with_load(push());
    for (gap, word) in [(2.5, "2.500e0 from"), (-2.5, "2.500e0 inside")] {
        let plan = plan(&hung().with_contact(floor().with_gap(gap)));
        let [warning @ Warning::LargeGap { contact: 0, extent, .. }] = plan.warnings() else {
            panic!("{:?}", plan.warnings());
        };
        assert!(*extent == 2.0 && warning.to_string().contains(word), "{warning}");
    }
    let hooke = Hooke::isotropic(2e11, 0.3).expect("Hooke");
    let table = Materials::new(vec![(0, hooke), (3, hooke), (7, hooke)]).expect("table");
    let rising = Coefficient::Table(vec![(0.0, 0.3), (1.0, 30.0)]);
    let scene = Scene::new(block([2.0, 1.0, 1.0], [4, 2, 2]), table)
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(push())
        .with_contact(
            Contact::rigid(brick::Y_MIN)
                .with_gap(4.0)
                .with_friction(Friction::coulomb(20.0)),
        )
        .with_contact(floor().with_gap(3.0).with_friction(Friction::Coulomb(rising)));
    let known = plan(&scene);
    let [
        Warning::UnusedMaterials { regions, present },
        Warning::LargeGap {
            contact: 0, gap: 4.0, ..
        },
        Warning::LargeCoefficient {
            contact: 1,
            coefficient: 30.0,
            ..
        },
    ] = known.warnings()
    else {
        panic!("{:?}", known.warnings());
    };
    assert_eq!((&regions[..], &present[..]), (&[3, 7][..], &[0][..]));
    let text = known.to_string();
    for warning in known.warnings() {
        assert!(text.contains(&format!("warning     {warning}")), "{text}");
    }
    // a run tells them before its steps
    let (report, observed) = told(scene);
    assert_eq!(report.warnings()[..3], *known.warnings());
    assert_eq!(observed.at_step, [3]);
}

/// Loads that come and go, and rigid motions, leave noise; its relative error would be about one.
#[test]
fn bodies_at_rest_have_no_error_of_the_mesh() {
    let away = History::table(vec![(0.0, 0.0), (0.5, 1.0), (1.0, 0.0)]).expect("table");
    let pulled = |steps: usize| {
        Scene::new(block([2.0, 1.0, 1.0], [4, 2, 2]), uniform(1e9, 0.3))
            .with_support(Support::fixed(brick::X_MIN))
            .with_load(Load::force(brick::X_MAX, [0.0, 0.0, -1e5]).with_history(away.clone()))
            .with_analysis(Analysis::quasistatic(0.5 * steps as f64, steps))
    };
    assert!(told(pulled(1)).0.mesh_error.is_some_and(|e| e > 0.05));
    assert_eq!(told(pulled(2)).0.mesh_error, None);
    let drawn = Support::fixed(brick::X_MIN).with_motion([0.1, 0.0, 0.0], History::constant(1.0));
    let (report, _) = told(Scene::new(block([2.0, 1.0, 1.0], [4, 2, 2]), steel()).with_support(drawn));
    assert_eq!((report.mesh_error, report.warnings()), (None, &[][..]));
}

/// What is looked at is not changed.
#[test]
fn looking_changes_no_bit() {
    let mut run = Simulation::new(small_benchmark(weakening(), 4), Settings::default()).expect("set-up");
    let _ = run.run(&mut Told::default()).expect("run");
    let (_, state) = fingerprint(small_benchmark(weakening(), 4), Settings::default());
    assert!(*run.state() == state);
}

/// A pair of observers: both are told, and the stricter one decides.
#[test]
fn two_observers_are_told_both() {
    let mut simulation = Simulation::new(pressed_column(6e7, 4), Settings::default()).expect("set-up");
    let mut pair = (Told::default(), Told::default());
    let _ = simulation.run(&mut pair).expect("run");
    assert_eq!(pair.0.warnings, pair.1.warnings);
    assert!(pair.0.finished && pair.1.finished && pair.1.at_step == [0, 0, 0, 1]);

    let mut simulation = Simulation::new(pressed_column(1e6, 4), Settings::default()).expect("set-up");
    let stop = |_: &StepResult| Flow::Stop;
    let report = simulation.run(&mut (stop, Told::default())).expect("run");
    assert_eq!(report.steps, 1);
    let fail = |_: &StepResult| Flow::from(Err::<(), _>("full"));
    let failed = simulation.run(&mut (stop, fail)).expect_err("a failure");
    assert!(failed.to_string().contains("after step 1: full"), "{failed}");
}

/// A writer that is full from some byte on.
struct Full(usize);

impl std::io::Write for Full {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0 = self
            .0
            .checked_sub(bytes.len())
            .ok_or_else(|| std::io::Error::other("full"))?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[test]
fn progress_is_a_line_a_step() {
    let set_up = || Simulation::new(pressed_column(6e7, 4), Settings::default()).expect("set-up");
    let mut lines = Vec::new();
    let _ = set_up().run(&mut Progress::new(&mut lines)).expect("run");
    let text = String::from_utf8(lines).expect("text");
    let starts = [
        "1 of 4 steps, t = 0.25 s, ",
        "2 of 4 steps",
        "3 of 4 steps",
        "warning: step 3: the strain",
        "4 of 4 steps",
    ];
    assert_eq!(text.lines().count(), starts.len(), "{text}");
    for (line, start) in text.lines().zip(starts) {
        assert!(line.starts_with(start), "{line}");
        assert_eq!(
            line.ends_with(" left"),
            !start.starts_with("warning") && !start.starts_with("4 of"),
            "{line}"
        );
    }
    // a writer that fails ends the run with its error
    let failed = set_up().run(&mut Progress::new(Full(100))).expect_err("a full disk");
    assert!(failed.to_string().contains("full"), "{failed}");
}

/// Linear tetrahedra lock where the material hardly changes its volume; quadratic ones do not.
#[test]
fn a_mesh_that_locks_is_told() {
    let plan = |scene: &Scene| Plan::new(scene, &Settings::default()).expect("plan");
    let rubber = |poisson: f64| Hooke::isotropic(1e6, poisson).expect("Hooke");
    let scene = |mesh: TetMesh, poisson: f64| {
        Scene::new(mesh, Materials::uniform(rubber(poisson)))
            .with_support(Support::fixed(brick::X_MIN))
            .with_load(Load::pressure(brick::X_MAX, 1.0))
    };
    let mesh = || block([2.0, 1.0, 1.0], [4, 2, 2]);
    assert_eq!(plan(&scene(mesh(), 0.45)).warnings(), []);
    assert_eq!(
        plan(&scene(mesh().raise_order().expect("order 2"), 0.499)).warnings(),
        []
    );
    let locked = plan(&scene(mesh(), 0.499));
    let [warning @ Warning::Locking { region: 0, poisson }] = locked.warnings() else {
        panic!("{:?}", locked.warnings());
    };
    assert!(
        (poisson - 0.499).abs() < 1e-9 && warning.to_string().contains("raise_order"),
        "{warning}"
    );
}

#[test]
fn a_scene_in_which_nothing_acts_is_told() {
    let idle = |scene: Scene| {
        let plan = Plan::new(&scene, &Settings::default()).expect("plan");
        plan.warnings().iter().find_map(|w| match w {
            Warning::NothingActs { held } => Some(*held),
            _ => None,
        })
    };
    let body = || Scene::new(block([2.0, 1.0, 1.0], [4, 2, 2]), steel());
    let held = || body().with_support(Support::fixed(brick::Z_MAX));
    let floor = || Contact::rigid(brick::Z_MIN);
    let push = Load::pressure(brick::X_MAX, 1e5);
    let never = History::table(vec![(0.0, 1.0), (0.5, 0.0), (1.0, 0.0)]).expect("table");
    let last = Analysis::Quasistatic {
        times: vec![0.5, 1.0],
        formula: DifferenceFormula::BACKWARD_EULER,
    };
    assert_eq!(idle(body().with_contact(floor().with_gap(0.1))), Some(false));
    assert_eq!(idle(held().with_contact(floor())), Some(true));
    let rises = |way| floor().with_gap(0.1).with_motion([0.0, 0.0, way], ramp());
    // it stays below the body, or moves away
    for way in [0.09, -0.2] {
        assert_eq!(idle(held().with_contact(rises(way))), Some(true), "{way}");
    }
    let over = held().with_load(push.clone().with_history(never)).with_analysis(last);
    assert_eq!(idle(over), Some(true));
    let up = |way| Support::fixed(brick::Z_MIN).with_motion([0.0, 0.0, way], ramp());
    assert_eq!(idle(held().with_support(up(0.0))), Some(true));
    let acting = [
        held().with_load(push),
        held().with_support(up(1e-3)),
        held().with_contact(floor().with_gap(-1e-3)),
        held().with_contact(rises(0.2)),
        held().with_contact(floor().with_gap(1e-3).with_gap_history(History::constant(-1.0))),
        held().with_load(Load::eigenstrain(Eigenstrain::expansion(1e-3))),
    ];
    for (k, scene) in acting.into_iter().enumerate() {
        assert_eq!(idle(scene), None, "{k}");
    }
    let warning = Warning::NothingActs { held: false }.to_string();
    assert!(
        warning.contains("no support or spring") && warning.contains("missing"),
        "{warning}"
    );
}
