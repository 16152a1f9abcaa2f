//! Settings that would say nothing are refused, with their place and the remedy.

use crate::common::*;

fn floor() -> Contact {
    Contact::rigid(brick::Z_MIN)
}

/// What is refused of a part: a setting without another one.
fn assert_idle(scene: &Scene, part: Part, words: [&str; 2]) {
    let error = refused(scene);
    let is_such = matches!(error, ContactError::Idle { part: own, .. } if own == part);
    assert!(is_such, "{error}");
    assert_eq!(error.parts(), [part]);
    let text = error.to_string();
    assert!(words.iter().all(|word| text.contains(word)), "{text}");
}

#[test]
fn a_support_that_does_not_start_has_nothing_that_fades() {
    let held = || Support::fixed(brick::X_MAX).with_fading(ramp());
    let scene = clamped().with_support(held());
    assert_idle(&scene, Part::Support(1), ["with_fading", "with_start"]);
    let started = clamped()
        .with_support(held().with_start(0.5))
        .with_analysis(Analysis::quasistatic(1.0, 2));
    assert!(Plan::new(&started, &Settings::default()).is_ok());
}

#[test]
fn an_axis_of_friction_needs_a_law() {
    let along = |contact: Contact| contact.with_friction_axis([1.0, 0.0, 0.0], 2.0);
    let scene = clamped().with_contact(along(floor()));
    assert_idle(
        &scene,
        Part::Contact(0),
        ["with_friction_axis", "without with_friction;"],
    );
    // a study may begin without friction, and the order is free
    for law in [Friction::None, Friction::coulomb(0.0), Friction::coulomb(0.3)] {
        for contact in [
            along(floor()).with_friction(law.clone()),
            along(floor().with_friction(law)),
        ] {
            assert!(Plan::new(&clamped().with_contact(contact), &Settings::default()).is_ok());
        }
    }
}

#[test]
fn overlaps_are_measured_between_bodies_or_from_a_shape() {
    let cube = block([1.0; 3], [2; 3]);
    let two = with_second(&cube, &lifted(&cube, 1.0));
    let sides = || (second(brick::Z_MIN), brick::Z_MAX);
    let between = Contact::between(sides().0, sides().1);
    let scene = |contact: Contact| {
        let held = Scene::new(two.clone(), uniform(2e11, 0.3)).with_support(Support::fixed(brick::Z_MIN));
        held.with_support(Support::fixed(second(brick::Z_MAX)))
            .with_contact(contact.with_measured_overlaps())
    };
    for contact in [
        Contact::tied(sides().0, sides().1),
        between.clone().with_gap(1e-3),
        Contact::rigid(brick::X_MAX),
    ] {
        let words = [
            "with_measured_overlaps",
            "a gap that is measured between bodies or from a shape",
        ];
        assert_idle(&scene(contact), Part::Contact(0), words);
    }
    assert!(Plan::new(&scene(between), &Settings::default()).is_ok());
}

#[test]
fn gaps_do_not_add_up() {
    let field = |contact: Contact| contact.with_gap_field(|x| 1e-3 * x[0]);
    for contact in [field(floor().with_gap(1e-3)), field(floor()).with_gap(1e-3)] {
        let error = refused(&clamped().with_contact(contact));
        assert!(matches!(error, ContactError::TwoGaps { contact: 0 }), "{error}");
        assert_eq!(error.parts(), [Part::Contact(0)]);
        let text = error.to_string();
        assert!(
            text.contains("with_gap and with_gap_field") && text.contains("leave one out"),
            "{text}"
        );
    }
    // what takes the place of a distance, or of the same setting, is meant
    for contact in [
        Contact::half_space(brick::Z_MIN, [0.0; 3], [0.0, 0.0, 1.0]).with_gap(1e-3),
        field(Contact::half_space(brick::Z_MIN, [0.0; 3], [0.0, 0.0, 1.0])),
        floor().with_gap(1e-3).with_gap(2e-3),
    ] {
        assert!(Plan::new(&clamped().with_contact(contact), &Settings::default()).is_ok());
    }
}

/// Also where no point asks for it: those of a contact that starts later, and of nodes that are held.
#[test]
fn slip_bounds_are_checked_before_any_step() {
    let law = || Friction::tresca(-1.0);
    let later = clamped()
        .with_contact(floor().with_friction(law()).with_start(0.5))
        .with_analysis(Analysis::quasistatic(1.0, 2));
    let held = clamped().with_contact(Contact::rigid(brick::X_MIN).with_friction(law()));
    for scene in [later, held] {
        let error = refused(&scene);
        assert!(matches!(error, ContactError::Coefficient { contact: 0, .. }), "{error}");
        assert!(error.to_string().contains("the slip bound is -1; it must"), "{error}");
    }
}

/// A block that rides 0.1 m, and is pressed by half a millionth of that: it was said to stand apart, without a force.
#[test]
fn a_long_ride_hides_no_light_touch() {
    for over in [5e-8, 2e-7] {
        let scene = Scene::new(block([1.0; 3], [2; 3]), uniform(2e11, 0.0))
            .with_support(
                Support::components(brick::X_MIN, [true, false, false]).with_motion([0.1 + over, 0.0, 0.0], ramp()),
            )
            .with_support(Support::components(brick::Z_MIN, [false, false, true]))
            .with_contact(Contact::rigid(brick::X_MAX).with_gap(0.1))
            .with_analysis(Analysis::quasistatic(1.0, 1));
        let force = solve(scene, Settings::default()).summary.normal_force;
        let expected = 2e11 * over;
        assert!(
            (force / expected - 1.0).abs() < 1e-3,
            "{over:e}: {force:e} for {expected:e}"
        );
    }
}
