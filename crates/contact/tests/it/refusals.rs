//! Scenes that cannot be meant are refused, by the plan and by the set-up alike, with the place and a remedy.

use crate::common::*;
use crate::estimates::estimated;
use signorini_tfeti::TfetiError;

fn on_a_side(contact: Contact) -> Scene {
    Scene::new(block([1.0; 3], [2, 2, 2]), steel())
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::pressure(brick::Z_MAX, 1e9))
        .with_contact(contact)
}

#[test]
fn a_direction_into_the_body_or_along_its_surface_is_refused() {
    let floor = || Contact::rigid(brick::Z_MIN);
    let plane = |up| Contact::half_space(brick::Z_MIN, [0.0; 3], up);
    for (contact, expected) in [
        (floor().with_normal([0.0, 0.0, 2.0]), [0.0, 0.0, 2.0]),
        (floor().with_normal([1.0, 0.0, 0.5]), [1.0, 0.0, 0.5]),
        (floor().with_normal([0.0, 1.0, 0.0]), [0.0, 1.0, 0.0]),
        (plane([0.0, 0.0, -3.0]), [0.0, 0.0, 1.0]),
    ] {
        let error = refused(&on_a_side(contact.clone()));
        let text = error.to_string();
        assert!(
            text.starts_with("contact 0:") && text.contains("turn the direction round"),
            "{text}"
        );
        match error {
            ContactError::ObstacleSide {
                contact: 0,
                direction,
                nodes,
            } => {
                assert_eq!(direction.map(|c| c + 0.0), expected);
                assert_eq!(nodes, 9);
            }
            other => panic!("{other}"),
        }
    }
}

/// One node on the outer side is enough: a wall under a body with two sides in contact.
#[test]
fn a_direction_out_of_the_body_somewhere_is_accepted() {
    for contact in [
        Contact::rigid(brick::Z_MIN).with_normal([0.0, 0.0, -1.0]),
        Contact::rigid(brick::Z_MIN).with_normal([0.99, 0.0, -0.01]),
        Contact::half_space(brick::Z_MIN, [0.0; 3], [0.0, 0.0, 1.0]),
        Contact::rigid(brick::Z_MIN)
            .with_tag(brick::X_MAX)
            .with_normal([1.0, 0.0, 0.2]),
    ] {
        let scene = on_a_side(contact);
        Plan::new(&scene, &Settings::default()).expect("accepted");
        Simulation::new(scene, Settings::default()).expect("accepted");
    }
}

/// A floor, and a plate on the same facets that sinks: which is nearer changes with time.
#[test]
fn obstacles_that_move_apart_do_not_share_nodes() {
    let floor = || Contact::half_space(brick::Z_MIN, [0.0; 3], [0.0, 0.0, 1.0]);
    let plate = floor().with_motion([0.0, 0.0, -0.1], ramp());
    match refused(&clamped().with_contact(floor()).with_contact(plate.clone())) {
        ContactError::SharedNode { first, second, .. } => assert_eq!((first, second), (0, 1)),
        error => panic!("{error}"),
    }
    let both = clamped().with_contact(plate.clone()).with_contact(plate);
    Plan::new(&both, &Settings::default()).expect("one motion");
}

#[test]
fn an_obstacle_that_moves_too_far_is_named() {
    for history in [History::constant(1e200), History::constant(1e300)] {
        let floor = Contact::rigid(brick::Z_MIN).with_motion([0.0, 0.0, 1e200], history);
        let error = refused(&clamped().with_contact(floor)).to_string();
        assert!(
            error.starts_with("contact 0") && error.contains("displacement of its obstacle"),
            "{error}"
        );
    }
}

fn beam(support: Support, contact: Contact) -> Scene {
    Scene::new(block([3.0, 1.0, 1.0], [6, 2, 2]), steel())
        .with_support(support)
        .with_contact(contact)
        .with_analysis(Analysis::quasistatic(1.0, 4))
}

fn floor(gap: f64) -> Contact {
    Contact::rigid(brick::Z_MIN).with_gap(gap)
}

/// A clamp that goes down 0.2 m above a floor 0.1 m below: at the third of four steps it is 0.05 m inside.
#[test]
fn a_support_that_pushes_a_contact_edge_through_the_floor_is_refused() {
    let support = Support::fixed(brick::X_MIN).with_motion([0.0, 0.0, -0.2], ramp());
    let scene = beam(support, floor(0.1));
    let error = refused(&scene);
    let text = error.to_string();
    let ContactError::SupportInObstacle {
        support: 0,
        contact: 0,
        node,
        position,
        depth,
        time,
        displacement,
        gap,
    } = error
    else {
        panic!("{text}");
    };
    let place = scene.mesh().points()[node as usize];
    assert_eq!((place, place[0], place[2]), (position, 0.0, 0.0));
    assert_eq!((time, gap), (0.75, 0.1));
    assert!((depth - 0.05).abs() < 1e-15 && (displacement - 0.15).abs() < 1e-15);
    assert!(
        text.contains(&format!("node {node}")) && text.contains("0.75 s"),
        "{text}"
    );
    assert!(text.contains("shorten the motion"), "{text}");
}

#[test]
fn a_clamp_that_starts_inside_the_obstacle_is_refused() {
    let up = [0.0, 0.0, 1.0];
    let inside = [
        (Contact::half_space(brick::Z_MIN, [0.0, 0.0, 0.1], up), 0.1),
        (floor(-1e-3), 1e-3),
    ];
    for (contact, expected) in inside {
        let scene = beam(Support::fixed(brick::X_MIN), contact).with_analysis(Analysis::statics());
        match refused(&scene) {
            ContactError::SupportInObstacle {
                depth, displacement, ..
            } => {
                assert!((depth - expected).abs() < 1e-15, "{depth}");
                assert_eq!(displacement, 0.0);
            }
            other => panic!("{other}"),
        }
    }
}

/// A support along the plane or away from it, and one that ends exactly on it, leave nothing to refuse.
#[test]
fn supports_that_touch_or_stay_outside_are_accepted() {
    let down = |d: f64| Support::fixed(brick::X_MIN).with_motion([0.0, 0.0, -d], ramp());
    let tilt = 0.37_f64;
    // a plane through the lower edge of the clamp, far from the origin of its coordinates
    let (up, along) = ([-tilt.sin(), 0.0, tilt.cos()], [tilt.cos(), 0.0, tilt.sin()]);
    let slope = Contact::half_space(brick::Z_MIN, along.map(|c| -70.0 * c), up);
    for scene in [
        beam(down(0.1), floor(0.1)),
        beam(down(0.1), floor(0.1 * (1.0 - 1e-12))),
        beam(down(-0.1), floor(0.0)),
        beam(Support::fixed(brick::X_MIN), floor(0.0)),
        beam(
            Support::fixed(brick::X_MIN).with_motion([1e-3, 0.0, 0.0], ramp()),
            floor(0.0),
        ),
        beam(Support::fixed(brick::X_MIN), slope),
        // not fixed along the normal: the contact row holds it
        beam(Support::components(brick::X_MIN, [true, true, false]), floor(-1e-3))
            .with_support(Support::components(vec![62], [true, true, false])),
    ] {
        Simulation::new(scene.with_load(Load::pressure(brick::Z_MAX, 1e5)), Settings::default()).expect("accepted");
    }
    let error = refused(&beam(down(0.1), floor(0.1 * (1.0 - 1e-8))));
    assert!(
        matches!(error, ContactError::SupportInObstacle { time: 1.0, .. }),
        "{error}"
    );
}

/// In a quadratic mesh supports hold a part of the mean around a node, and all of it moves with that.
#[test]
fn supports_take_means_with_them() {
    let beam = |way: f64, floor: Contact| {
        let mesh = block([3.0, 1.0, 1.0], [6, 2, 2]).raise_order().expect("order 2");
        Scene::new(mesh, steel())
            .with_support(Support::fixed(brick::X_MIN).with_motion([0.0, 0.0, way], ramp()))
            .with_contact(floor)
            .with_load(Load::pressure(brick::Z_MAX, 1e5))
            .with_analysis(Analysis::quasistatic(1.0, 4))
    };
    match refused(&beam(-0.15, floor(0.1))) {
        ContactError::SupportInObstacle {
            time,
            displacement,
            depth,
            ..
        } => {
            assert_eq!(time, 0.75);
            assert!((displacement - 0.1125).abs() < 1e-12 && (depth - 0.0125).abs() < 1e-12);
        }
        error => panic!("{error}"),
    }
    for (way, floor) in [
        (-0.1, floor(0.1)),
        (0.1, floor(0.0).with_motion([0.0, 0.0, 0.1], ramp())),
    ] {
        Plan::new(&beam(way, floor), &Settings::default()).expect("accepted");
    }
}

/// A block that is moved on two adjacent sides, the second with history `h`.
fn two_sides(second: [f64; 3], first_history: &History, second_history: &History) -> Scene {
    Scene::new(block([1.0; 3], [2, 2, 2]), steel())
        .with_support(Support::fixed(brick::Z_MAX).with_motion([1e-3, 0.0, -1e-3], first_history.clone()))
        .with_support(Support::fixed(brick::X_MAX).with_motion(second, second_history.clone()))
        .with_load(Load::pressure(brick::X_MIN, 1e7))
        .with_analysis(Analysis::quasistatic(1.0, 2))
}

/// Supports with one motion agree at the nodes they share, and move them.
#[test]
fn adjacent_supports_with_one_motion_agree() {
    let way = [1e-3, 0.0, -1e-3];
    let function = History::function(|t| t * t);
    for (first, second) in [
        (ramp(), ramp()),
        (function.clone(), function.clone()),
        (History::constant(0.25), History::constant(0.25)),
    ] {
        let mut simulation = Simulation::new(two_sides(way, &first, &second), tight()).expect("accepted");
        while !simulation.is_finished() {
            let frame = simulation.step().expect("step");
            let status = frame.report().status;
            assert!(status.converged(), "{status:?}");
            let factor = first.value(frame.time());
            for tag in [brick::Z_MAX, brick::X_MAX] {
                for node in frame.scene().mesh().nodes_on(tag) {
                    let u = frame.displacement()[node as usize];
                    for (u, d) in u.iter().zip(&way) {
                        assert!((u - factor * d).abs() < 1e-12, "node {node}: {u}");
                    }
                }
            }
        }
    }
}

#[test]
fn adjacent_supports_with_other_motions_are_contradictory() {
    let way = [1e-3, 0.0, -1e-3];
    let function = || History::function(|t| t);
    let longer = History::ramp(2.0, 1.0).expect("ramp");
    for scene in [
        two_sides(way, &ramp(), &longer),
        two_sides(way, &function(), &function()),
        two_sides(way, &ramp(), &function()),
        two_sides([1e-3, 0.0, 0.0], &ramp(), &ramp()),
    ] {
        let error = refused(&scene);
        assert!(
            matches!(
                error,
                ContactError::Tfeti(TfetiError::ContradictorySupports {
                    first: 0,
                    second: 1,
                    ..
                })
            ),
            "{error}"
        );
    }
}

/// Refused with the place at the beginning and a word on units.
fn refused_at(scene: Scene, place: &str) -> ContactError {
    let error = refused(&scene);
    let text = error.to_string();
    assert!(text.starts_with(place) && text.contains("units"), "{text}");
    error
}

#[test]
fn sizes_whose_squares_overflow_are_named() {
    let large = |size: f64| History::function(move |_| size);
    let brick = || Scene::new(block([2.0, 1.0, 1.0], [2, 1, 1]), uniform(1e9, 0.3));
    let floor = || Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.3));
    let clamped = || brick().with_support(Support::fixed(brick::X_MIN));
    let press = |p: f64| clamped().with_load(Load::pressure(brick::Z_MAX, p));
    let moved = |size: f64| {
        let support = Support::fixed(brick::X_MIN).with_motion([0.0, size, 0.0], ramp());
        brick().with_support(support)
    };
    let pressed = press(1.0).with_load(Load::body([0.0, 0.0, -1.0]).with_history(large(1e200)));
    let cases = [
        (
            press(1e200).with_contact(floor()),
            "load 0 at time 1 s",
            "units of force",
        ),
        (press(1e308).with_contact(floor()), "load 0", "units of force"),
        (pressed.with_contact(floor()), "load 1", "units of force"),
        (
            moved(-1e200).with_contact(floor()),
            "support 0 at time 1 s",
            "units of length",
        ),
        (
            press(1.0).with_contact(floor().with_gap(1e200)),
            "contact 0 at node",
            "units of length",
        ),
        (press(1e200), "load 0", "units of force"),
    ];
    for (scene, place, unit) in cases {
        let error = refused_at(scene.with_analysis(Analysis::quasistatic(1.0, 1)), place);
        assert!(matches!(error, ContactError::TooLarge { unit: u, .. } if u == unit));
    }
    // what follows from two sizes, each of which is taken
    let solid = |young: f64| Scene::new(block([2.0, 1.0, 1.0], [2, 1, 1]), uniform(young, 0.3));
    for (scene, place) in [
        (
            solid(1e60).with_support(Support::fixed(brick::X_MIN).with_motion([0.0, 1e40, 0.0], ramp())),
            "support 0 at time 1 s: its displacement times",
        ),
        (
            solid(1e-60)
                .with_support(Support::fixed(brick::X_MIN))
                .with_load(Load::pressure(brick::Z_MAX, 1e40)),
            "load 0 at time 1 s: its largest nodal force over",
        ),
    ] {
        refused_at(scene.with_analysis(Analysis::quasistatic(1.0, 1)), place);
    }
    // materials, whatever the method
    for young in [1e300, 1e150, 1e-100, 1e-300] {
        for method in methods() {
            let scene = solid(young).with_support(Support::fixed(brick::X_MIN));
            let load = Load::pressure(brick::Z_MAX, 1.0);
            let scene = scene.with_load(load).with_contact(floor());
            let settings = by(method);
            let error = Simulation::new(scene, settings).expect_err("stiffness");
            assert!(matches!(
                error,
                ContactError::Stiffness { region: 0, value, .. } if (0.5..4.0).contains(&(value / young))
            ));
            refused_at(
                solid(young).with_support(Support::fixed(brick::X_MIN)),
                "region 0: its material",
            );
        }
    }
    // what is taken is solved and estimated
    for scene in [
        press(1e60).with_contact(floor()),
        press(1.0).with_contact(floor().with_gap(1e60)),
        solid(1e60)
            .with_support(Support::fixed(brick::X_MIN))
            .with_load(Load::pressure(brick::Z_MAX, 1e60))
            .with_contact(floor()),
        solid(1e-60)
            .with_support(Support::fixed(brick::X_MIN))
            .with_load(Load::pressure(brick::Z_MAX, 1e-3))
            .with_contact(floor()),
    ] {
        for accuracy in [Accuracy::Tolerance, Accuracy::Relative(1e-5)] {
            let settings = Settings::default().with_accuracy(accuracy);
            let scene = scene.clone().with_analysis(Analysis::quasistatic(1.0, 2));
            for (result, error, _) in estimated(&scene, settings) {
                assert!(result.report.status.converged() && error.relative() < 1e-4);
            }
        }
    }
}

/// What a support moves it must hold, whatever the axes and for each node; what rounding leaves of turned axes is no
/// motion, and oblique directions and those of each node take what is along them.
#[test]
fn motions_that_a_support_does_not_hold_are_refused() {
    let scene = |support: Support| clamped().with_support(support);
    let up = || Support::components(brick::X_MAX, [false, false, true]);
    let vectors = |list: &[[f64; 3]]| Support::partial(brick::X_MAX, Directions::Vectors(list.to_vec()));
    let (nodes, way) = (clamped().mesh().nodes_on(brick::X_MAX), [0.01, 0.0, -1e-3]);
    let mut each = vec![[0.0, 0.0, -1e-3]; nodes.len()];
    each[4][1] = 1e-5;
    let about = |on| Support::components(brick::X_MAX, on).with_axis([0.0, -5.0, 0.0], [1.0, 0.0, 0.0]);
    for (support, at, says) in [
        (up().with_motion(way, ramp()), nodes[0], "by 0.01 along x"),
        (up().with_motions(each, ramp()), nodes[4], "by 1e-5 along y"),
        (
            vectors(&[[0.0, 0.0, 2.0]]).with_motion(way, ramp()),
            nodes[0],
            "along x",
        ),
        (
            vectors(&[[0.0, 3.0, 4.0], [0.0, 1.0, 0.0]]).with_motion(way, ramp()),
            nodes[0],
            "along x",
        ),
        (
            about([true, false, true]).with_motion([1e-3, 2e-3, 0.0], ramp()),
            nodes[0],
            "by 0.002 tangentially",
        ),
    ] {
        let error = refused(&scene(support));
        let text = error.to_string();
        assert!(
            text.contains(says) && text.contains("make this part of the motion zero"),
            "{text}"
        );
        assert!(
            matches!(error, ContactError::MotionNotHeld { support: 1, node, .. } if node == at),
            "{text}"
        );
        assert_eq!(error.parts(), [Part::Support(1), Part::Node(at)]);
    }
    let normals = nodes.iter().map(|_| vec![[0.0, 0.0, 1.0]]).collect();
    for support in [
        up().with_motion([1e-13, 0.0, -1e-3], ramp()),
        vectors(&[[1.0, 0.0, -1.0]]).with_motion(way, ramp()),
        Support::partial(brick::X_MAX, Directions::EachNode(normals)).with_motion(way, ramp()),
        about([false, true, false]).with_motion([0.0, 1e-3, 0.0], ramp()),
    ] {
        Plan::new(&scene(support), &Settings::default()).expect("accepted");
    }
}

#[test]
fn what_would_do_nothing_is_refused() {
    let text = |scene: Scene| refused(&scene).to_string();
    let held = || Scene::new(two_blocks(), steel()).with_support(Support::fixed(brick::Z_MIN));
    let plane = Contact::half_space(second(brick::Z_MIN), [0.0; 3], [0.0, 0.0, 1.0]).with_partner(brick::Z_MAX);
    assert!(matches!(
        refused(&held().with_contact(plane)),
        ContactError::MovedPartner { contact: 0 }
    ));
    let nothing = Support::partial(brick::Z_MAX, Directions::Nothing).with_motion([1e-3, 0.0, 0.0], ramp());
    assert!(matches!(
        refused(&held().with_support(nothing)),
        ContactError::MotionNotHeld { support: 1, .. }
    ));
    let none = Contact::rigid(brick::Z_MAX).with_gap(0.0).with_gap_history(ramp());
    assert!(text(held().with_contact(none)).contains("with_gap_history"));
    for gamma in [-0.5, -0.51] {
        let formula = DifferenceFormula::new(1.0 + gamma, -1.0 - 2.0 * gamma, gamma);
        assert_eq!(formula.is_ok(), gamma >= -0.5, "{gamma}");
    }
}

/// Two cubes on one another.
fn two_blocks() -> TetMesh {
    let cube = block([1.0; 3], [1; 3]);
    with_second(&cube, &lifted(&cube, 1.0))
}
