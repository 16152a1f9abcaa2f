//! Check 8 with finite elements: a cantilever that is stiff along its axis and soft across it meets an oblique
//! obstacle. Friction then changes the normal force by more than itself, and the Coulomb map is not contractive:
//! without friction the tip slides and presses, with it the tip sticks and presses less, and so on.

use crate::common::{block, methods, uniform};
use signorini_contact::{
    Contact, Friction, Load, Method, Scene, Settings, Simulation, StepStatus, Support,
    fixed_point::Verdict,
};
use signorini_fem_mesh::brick;

/// A cantilever under its own weight `across` and the axial load `axial` (N/m³); `tilt` is the angle between the axis
/// and the obstacle's normal.
fn cantilever(coefficient: f64, tilt: f64, axial: f64) -> Scene {
    Scene::new(block([5.0, 1.0, 1.0], [10, 2, 2]), uniform(1000.0, 0.0))
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::body([axial, 0.0, -1.0]))
        .with_contact(
            Contact::rigid(brick::X_MAX)
                .with_normal([tilt.cos(), 0.0, -tilt.sin()])
                .with_friction(Friction::coulomb(coefficient)),
        )
        .with_boxes([5, 1, 1])
}

fn first_level(scene: Scene, method: Method) -> (StepStatus, Option<Verdict>, Option<f64>, f64) {
    let settings = Settings::default().with_method(method);
    let mut simulation = Simulation::new(scene, settings).expect("set-up");
    let frame = simulation.step().expect("step");
    let fixed_point = frame.report().fixed_point.clone();
    (
        frame.report().status,
        fixed_point.as_ref().map(|f| f.verdict),
        fixed_point.and_then(|f| f.rate),
        frame.certificate().largest(),
    )
}

/// Whatever the coefficient: either a certified solution, or a status that says that there is none.
#[test]
fn no_method_claims_what_it_did_not_find() {
    let mut unsolved = 0;
    for method in methods() {
        for (tilt, axial) in [(0.02, 0.0), (0.1, 0.1), (0.1, 1.0), (0.3, 0.0)] {
            for coefficient in [0.05, 0.3, 0.5, 0.7, 0.9, 1.1, 1.5, 3.0] {
                let scene = cantilever(coefficient, tilt, axial);
                let (status, _, _, certificate) = first_level(scene, method.clone());
                let what = format!(
                    "{}, tilt {tilt}, axial {axial}, F {coefficient}",
                    method.name()
                );
                assert!(certificate.is_finite(), "{what}");
                if status.converged() {
                    assert!(
                        certificate <= 1e-6,
                        "{what}: converged with {certificate:e}"
                    );
                } else {
                    unsolved += 1;
                }
            }
        }
    }
    assert!(unsolved > 0, "the cases are too easy to tell anything");
}

#[test]
fn successive_approximations_say_that_the_map_is_not_contractive() {
    for coefficient in [0.6, 0.8, 1.0] {
        let scene = cantilever(coefficient, 0.02, 0.0);
        let (status, verdict, rate, _) = first_level(scene, Method::paper());
        assert_eq!(status, StepStatus::NotContractive, "F {coefficient}");
        assert_eq!(verdict, Some(Verdict::NotContractive), "F {coefficient}");
        assert!(rate.is_some_and(|r| r > 0.5), "F {coefficient}: {rate:?}");
    }
}

/// On both sides of that range the map has a limit: little friction, and so much that the tip sticks.
#[test]
fn outside_of_that_range_the_map_converges() {
    for coefficient in [0.05, 0.1, 3.0] {
        let scene = cantilever(coefficient, 0.02, 0.0);
        let (status, verdict, _, certificate) = first_level(scene, Method::paper());
        assert_eq!(
            (status, verdict),
            (StepStatus::Converged, Some(Verdict::Converged)),
            "F {coefficient}"
        );
        assert!(certificate <= 1e-6, "F {coefficient}: {certificate:e}");
    }
}

/// All loads act at contact nodes, which stick: nothing moves, and rounding must not count as a violation.
#[test]
fn a_body_that_does_not_move_is_certified() {
    for method in methods() {
        let scene = Scene::new(block([5.0, 1.0, 1.0], [10, 2, 2]), uniform(1000.0, 0.0))
            .with_support(Support::fixed(brick::X_MIN))
            .with_load(Load::traction(brick::X_MAX, [2.0, 0.0, -1.0]))
            .with_contact(Contact::rigid(brick::X_MAX).with_friction(Friction::coulomb(1.0)))
            .with_boxes([5, 1, 1]);
        let (status, _, _, certificate) = first_level(scene, method.clone());
        assert!(
            status.converged() && certificate <= 1e-6,
            "{}: {status:?}, {certificate:e}",
            method.name()
        );
    }
}
