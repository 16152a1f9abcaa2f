//! The direction into the obstacle must point out of the body somewhere on the contact surface.

mod common;

use common::{block, steel};
use signorini_contact::{Contact, ContactError, Load, Plan, Scene, Settings, Simulation, Support};
use signorini_fem_mesh::brick;

fn result(contact: Contact, settings: Settings) -> Result<Simulation, ContactError> {
    let scene = Scene::new(block([1.0; 3], [2, 2, 2]), steel())
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::pressure(brick::Z_MAX, 1e9))
        .with_contact(contact);
    let plan = Plan::new(&scene, &settings).map_err(|e| e.to_string());
    let set_up = Simulation::new(scene, settings);
    assert_eq!(
        plan.err(),
        set_up.as_ref().err().map(ToString::to_string),
        "the plan knows it before any work"
    );
    set_up
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
        let settings = Settings::default();
        let error = result(contact, settings).expect_err("refused");
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
        result(contact, Settings::default()).expect("accepted");
    }
}
