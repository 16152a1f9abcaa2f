//! Supports beside a contact surface: what cannot be meant is refused, what can be meant is accepted.

mod common;

use common::{block, steel, tight};
use signorini_contact::{
    Analysis, Contact, ContactError, DifferenceFormula, Load, Plan, Scene, Settings, Simulation,
    Support,
};
use signorini_fem_mesh::{History, LoadDensity, brick};
use signorini_tfeti::TfetiError;

fn ramp() -> History {
    History::ramp(1.0, 1.0).expect("ramp")
}

fn beam(support: Support, contact: Contact) -> Scene {
    Scene::new(block([3.0, 1.0, 1.0], [6, 2, 2]), steel())
        .with_support(support)
        .with_contact(contact)
        .with_analysis(
            Analysis::quasistatic(1.0, 4).with_formula(DifferenceFormula::BACKWARD_EULER),
        )
}

fn floor(gap: f64) -> Contact {
    Contact::rigid(brick::Z_MIN).with_gap(gap)
}

fn refused(scene: &Scene, settings: &Settings) -> ContactError {
    let plan = Plan::new(scene, settings);
    match Simulation::new(scene.clone(), settings.clone()) {
        Err(error) => {
            // a plan says so before any work
            let early = plan.expect_err("refused by the plan");
            assert_eq!(early.to_string(), error.to_string());
            error
        }
        Ok(_) => panic!("accepted"),
    }
}

/// A clamp that goes down 0.2 m above a floor 0.1 m below: at the third of four levels it is 0.05 m inside.
#[test]
fn a_support_that_pushes_a_contact_edge_through_the_floor_is_refused() {
    let support = Support::fixed(brick::X_MIN).with_motion([0.0, 0.0, -0.2], ramp());
    let scene = beam(support, floor(0.1));
    let error = refused(&scene, &Settings::default());
    let text = error.to_string();
    let ContactError::SupportInObstacle {
        node,
        depth,
        time,
        displacement,
        gap,
    } = error
    else {
        panic!("{text}");
    };
    let place = scene.mesh().points()[node as usize];
    assert_eq!((place[0], place[2]), (0.0, 0.0));
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
        match refused(&scene, &Settings::default()) {
            ContactError::SupportInObstacle {
                depth,
                displacement,
                ..
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
    let (up, along) = (
        [-tilt.sin(), 0.0, tilt.cos()],
        [tilt.cos(), 0.0, tilt.sin()],
    );
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
        beam(
            Support::components(brick::X_MIN, [true, true, false]),
            floor(-1e-3),
        )
        .with_support(Support::components(vec![62], [true, true, false])),
    ] {
        Simulation::new(
            scene.with_load(Load::pressure(brick::Z_MAX, 1e5)),
            Settings::default(),
        )
        .expect("accepted");
    }
    let error = refused(
        &beam(down(0.1), floor(0.1 * (1.0 - 1e-8))),
        &Settings::default(),
    );
    assert!(
        matches!(error, ContactError::SupportInObstacle { time: 1.0, .. }),
        "{error}"
    );
}

/// A block that is moved on two adjacent sides, the second with history `h`.
fn two_sides(second: [f64; 3], first_history: &History, second_history: &History) -> Scene {
    Scene::new(block([1.0; 3], [2, 2, 2]), steel())
        .with_support(
            Support::fixed(brick::Z_MAX).with_motion([1e-3, 0.0, -1e-3], first_history.clone()),
        )
        .with_support(Support::fixed(brick::X_MAX).with_motion(second, second_history.clone()))
        .with_load(Load::pressure(brick::X_MIN, 1e7))
        .with_analysis(
            Analysis::quasistatic(1.0, 2).with_formula(DifferenceFormula::BACKWARD_EULER),
        )
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
        let mut simulation =
            Simulation::new(two_sides(way, &first, &second), tight()).expect("accepted");
        while !simulation.is_finished() {
            let frame = simulation.step().expect("level");
            let status = frame.report().status;
            assert!(status.converged(), "{status:?}");
            let factor = first.value(frame.time());
            for tag in [brick::Z_MAX, brick::X_MAX] {
                for node in frame.scene().mesh().nodes_on(tag) {
                    let u = &frame.displacement()[3 * node as usize..][..3];
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
        let error = refused(&scene, &Settings::default());
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

/// Displacements alone: no loads, no contact, forces from gluing and supports only.
#[test]
fn a_body_stretched_by_its_supports_is_certified() {
    let ramp = History::ramp(1.0, 1.0).expect("ramp");
    let scene = Scene::new(block([3.0, 1.0, 1.0], [6, 2, 2]), steel())
        .with_support(Support::fixed(brick::X_MIN))
        .with_support(Support::fixed(brick::X_MAX).with_motion([1e-3, 0.0, 0.0], ramp))
        .with_boxes([3, 1, 1])
        .with_analysis(Analysis::quasistatic(1.0, 2));
    let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
    while !simulation.is_finished() {
        let frame = simulation.step().expect("step");
        let (status, certificate) = (frame.report().status, frame.certificate());
        assert!(status.converged(), "{status:?} {certificate:?}");
        assert!(certificate.largest() < 1e-6, "{certificate:?}");
    }
}

/// A thin plate glued to the ground: its torn subdomains bend by far more than the plate moves, and are no scale for it.
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
        let settings = Settings::default().with_tolerance(tolerance);
        let mut simulation = Simulation::new(scene(), settings).expect("set-up");
        let frame = simulation.step().expect("step");
        (
            frame.displacement(),
            frame.certificate().largest(),
            frame.report().status,
        )
    };
    let (exact, _, _) = solve(1e-10);
    let norm = |v: &mut dyn Iterator<Item = f64>| v.map(|x| x * x).sum::<f64>().sqrt();
    let size = norm(&mut exact.iter().copied());
    for tolerance in [1e-2, 1e-4, 1e-6] {
        let (u, certificate, status) = solve(tolerance);
        let off = norm(&mut u.iter().zip(&exact).map(|(a, b)| a - b)) / size;
        println!("{tolerance:e}: error {off:.1e}, certificate {certificate:.1e}, {status:?}");
        assert!(
            !status.converged() || off < 30.0 * tolerance,
            "{tolerance:e}: {off:e}"
        );
    }
}
