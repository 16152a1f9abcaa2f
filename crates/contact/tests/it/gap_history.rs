//! Gaps that change in time: press fits that grow, obstacles that come and go.

use crate::common::*;

const YOUNG: f64 = 2e11;
const POISSON: f64 = 0.3;
const FIT: f64 = 1e-3;

/// Free to widen, held at planes of symmetry: strained along z alone.
fn symmetric(scene: Scene, tags: [FacetTag; 2]) -> Scene {
    let [x, y] = tags;
    scene
        .with_support(Support::components(x, [true, false, false]))
        .with_support(Support::components(y, [false, true, false]))
}

/// A column of height 2, held at its top, on a floor.
fn column(contact: Contact) -> Scene {
    let mesh = Brick::new([1.0, 1.0, 2.0], [2, 2, 4]).build().expect("brick");
    let scene = Scene::new(mesh, uniform(YOUNG, POISSON))
        .with_support(Support::components(brick::Z_MAX, [false, false, true]))
        .with_contact(contact)
        .with_analysis(Analysis::quasistatic(1.0, 4));
    symmetric(scene, [brick::X_MIN, brick::Y_MIN])
}

fn there_and_back() -> History {
    History::table(vec![(0.0, 0.0), (0.5, 1.0), (0.75, 0.5), (1.0, -1.0)]).expect("table")
}

fn fit(history: History) -> Contact {
    Contact::rigid(brick::Z_MIN).with_gap(-FIT).with_gap_history(history)
}

/// The pressure is Young's modulus times the interference of the time over the height; none where the gap is open.
#[test]
fn a_column_is_pressed_by_the_interference_of_the_time() {
    for method in methods() {
        let scene = column(fit(there_and_back())).with_boxes([1, 1, 2]);
        let (simulation, results) = run(scene, by(method).with_tolerance(1e-9));
        assert!(simulation.plan().effects.gap_history && !simulation.plan().effects.moving_obstacle);
        assert!(simulation.plan().to_string().contains("with a history"));
        let mut work = 0.0;
        for (result, factor) in results.iter().zip([0.5, 1.0, 0.5, 0.0]) {
            let force = YOUNG * FIT * factor / 2.0;
            assert!(
                (result.summary.normal_force - force).abs() < 1e-6 * YOUNG * FIT,
                "{factor}"
            );
            work += result.summary.obstacle_work;
        }
        // forces at the ends of the steps, times what the gap has closed: 1/2 and 1 up, 1/2 down, none
        let unit = YOUNG * FIT * FIT / 2.0;
        assert!(
            (work - unit * (0.5 * 0.5 + 0.5 - 0.5 * 0.5)).abs() < 1e-6 * unit,
            "{}",
            work / unit
        );
        let open = &results[3].points;
        assert!(open.iter().all(|p| (p.gap - FIT).abs() < 1e-9 * FIT));
    }
}

/// Two cubes: the interference is shared.
#[test]
fn a_fit_between_bodies_is_shared_by_them() {
    let lower = Brick::new([1.0; 3], [2; 3]).build().expect("brick");
    let far = |tag: FacetTag| FacetTag(tag.0 + 10);
    let upper = lower
        .map_points(|[x, y, z]| [x, y, z + 1.0])
        .expect("moved")
        .map_tags(far);
    let scene = Scene::new(lower.append(&upper).expect("two"), uniform(YOUNG, POISSON))
        .with_support(Support::components(brick::Z_MIN, [false, false, true]))
        .with_support(Support::components(far(brick::Z_MAX), [false, false, true]))
        .with_contact(
            Contact::between(far(brick::Z_MIN), brick::Z_MAX)
                .with_gap(-FIT)
                .with_gap_history(ramp())
                .with_friction(Friction::coulomb(0.3)),
        )
        .with_analysis(Analysis::quasistatic(1.0, 2));
    let scene = symmetric(scene, [brick::X_MIN, brick::Y_MIN]);
    let scene = symmetric(scene, [brick::X_MIN, brick::Y_MIN].map(far));
    let (_, results) = run(scene, tight());
    for (result, factor) in results.iter().zip([0.5, 1.0]) {
        let force = YOUNG * FIT * factor / 2.0;
        assert!((result.summary.normal_force - force).abs() < 1e-7 * force, "{factor}");
    }
}

/// A floor that rises is a gap that closes.
#[test]
fn a_gap_that_closes_is_an_obstacle_that_comes() {
    let friction = || Friction::coulomb(0.3);
    let pull = |scene: Scene| scene.with_load(Load::traction(brick::X_MAX, [2e7, 0.0, 0.0]).with_history(ramp()));
    let moved = Contact::rigid(brick::Z_MIN).with_motion([0.0, 0.0, FIT], ramp());
    let (_, came) = run(pull(column(moved.with_friction(friction()))), tight());
    let (_, closed) = run(pull(column(fit(ramp()).with_friction(friction()))), tight());
    for (a, b) in came.iter().zip(&closed) {
        let scale = a.displacement.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        for (a, b) in a.displacement.iter().zip(&b.displacement) {
            assert!((a - b).abs() < 1e-9 * scale, "{a} {b}");
        }
        let works = [a, b].map(|r| r.summary.obstacle_work);
        assert!((works[0] - works[1]).abs() < 1e-7 * works[0].abs(), "{works:?}");
    }
}

/// A factor of the gap at rest beside a motion: the same of a plane, told as a gap or as a shape.
#[test]
fn what_a_motion_opens_is_not_multiplied() {
    let (point, outward) = ([0.0, 0.0, -1e-4], [0.02, 0.01, 1.0]);
    let course = || History::table(vec![(0.0, 0.0), (0.5, 1.5), (1.0, -1.0)]).expect("table");
    let scene = |plane: Contact| {
        let plane = plane
            .with_motion([1e-3, 0.0, 2e-4], ramp())
            .with_rotation(point, outward, History::ramp(1.0, 1e-2).expect("ramp"))
            .with_gap_history(course())
            .with_friction(Friction::coulomb(0.3));
        Scene::new(block([2.0, 1.0, 1.0], [4, 2, 2]), uniform(1e6, 0.3))
            .with_support(Support::fixed(brick::Z_MAX))
            .with_contact(plane)
            .with_analysis(Analysis::quasistatic(1.0, 4))
    };
    let shape = Obstacle::half_space(point, outward);
    let (_, told) = run(scene(Contact::half_space(brick::Z_MIN, point, outward)), at(1e-9));
    let (_, shaped) = run(scene(Contact::obstacle(brick::Z_MIN, shape)), at(1e-9));
    for (a, b) in told.iter().zip(&shaped) {
        assert_close(&b.displacement, &a.displacement, 1e-7, "displacement");
    }
    assert!(told.iter().any(|r| r.summary.active > 0));
}

#[test]
fn a_run_goes_on_from_a_state_with_the_same_bits() {
    let new = || {
        let contact = fit(there_and_back()).with_friction(Friction::coulomb(0.2));
        Simulation::new(column(contact), Settings::default()).expect("set-up")
    };
    let (mut whole, mut first, mut second) = (new(), new(), new());
    let _ = whole.run(&mut Silent).expect("run");
    let _ = step(&mut first);
    second.resume(first.state().clone()).expect("resume");
    let _ = second.run(&mut Silent).expect("run");
    assert!(second.state() == whole.state());
}

#[test]
fn gaps_that_have_no_value_or_change_places_are_refused() {
    let refused = |scene: Scene| {
        Plan::new(&scene, &Settings::default())
            .map(|_| ())
            .expect_err("refused")
    };
    for hole in [0.0, 0.5] {
        let bad = History::function(move |t| if t == hole { f64::NAN } else { 1.0 });
        let error = refused(column(fit(bad)));
        assert!(
            matches!(error, ContactError::HistoryValue { part: Part::Contact(0), time, .. } if time == hole),
            "{error}"
        );
    }
    let huge = refused(column(fit(History::constant(1e200))));
    assert!(matches!(huge, ContactError::TooLarge { .. }), "{huge}");
    // another floor on the same facets, nearer at first, but not when the fit has grown
    let other = Contact::rigid(brick::Z_MIN).with_gap(-FIT / 2.0);
    for other in [other.clone(), other.with_gap_history(there_and_back())] {
        let error = refused(column(fit(there_and_back())).with_contact(other));
        assert!(
            matches!(
                error,
                ContactError::SharedNode {
                    first: 0,
                    second: 1,
                    ..
                }
            ),
            "{error}"
        );
    }
    // support inside the obstacle from a time on
    let held = column(fit(ramp())).with_support(Support::fixed(brick::Z_MIN));
    let error = refused(held);
    assert!(matches!(error, ContactError::SupportInObstacle { .. }), "{error}");
}
