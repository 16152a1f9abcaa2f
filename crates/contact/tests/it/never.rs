//! What acts at no step is told, with its time and the remedy; what acts at some step, or waits on purpose, is not.

use crate::common::*;

fn table(points: &[(f64, f64)]) -> History {
    History::table(points.to_vec()).expect("table")
}

/// Two steps, at 0.5 and 1 s.
fn scene() -> Scene {
    clamped()
        .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -1e6]))
        .with_analysis(Analysis::quasistatic(1.0, 2))
}

/// The warnings of what never acts.
fn never(scene: &Scene) -> Vec<Warning> {
    let plan = Plan::new(scene, &Settings::default()).expect("plan");
    let such = |w: &&Warning| matches!(w, Warning::BetweenSteps { .. } | Warning::ZeroAtSteps { .. });
    plan.warnings().iter().filter(such).cloned().collect()
}

fn plate() -> Coupling {
    Coupling::rigid(brick::X_MAX, [1.0, 0.5, 0.5])
}

/// One warning is told, such a one, of this part, with the remedy.
fn assert_told(scene: &Scene, is_such: impl Fn(&Warning) -> bool, part: Part, says: &str) {
    let found = never(scene);
    let [warning] = &found[..] else {
        panic!("{found:?}");
    };
    let text = warning.to_string();
    assert!(is_such(warning), "{text}");
    assert!(text.contains(says) && text.contains("take more steps"), "{text}");
    assert_eq!(warning.parts(), [part]);
}

#[test]
fn spans_between_the_ends_of_steps_are_told() {
    let floor = || Contact::rigid(brick::Z_MIN);
    let held = || Support::fixed(brick::X_MAX);
    for (scene, part, says) in [
        (
            scene().with_contact(floor().with_start(0.6).with_end(0.9)),
            Part::Contact(0),
            "from 0.6 s to 0.9 s",
        ),
        (
            scene().with_contact(floor().with_start(1.5)),
            Part::Contact(0),
            "from 1.5 s on",
        ),
        (
            scene().with_support(held().with_end(0.3)),
            Part::Support(1),
            "from 0 s to 0.3 s",
        ),
        (
            scene().with_coupling(plate().with_lock([true; 6], 10.0)),
            Part::Coupling(0),
            "from 10 s on",
        ),
    ] {
        let is_such = |w: &Warning| matches!(w, Warning::BetweenSteps { part: own, last: 1.0, .. } if *own == part);
        assert_told(&scene, is_such, part, says);
    }
    for scene in [
        scene().with_contact(floor().with_start(0.5)),
        scene().with_contact(floor().with_end(0.5)),
        scene().with_support(held().with_start(0.2).with_end(0.7)),
        scene()
            .with_support(held().with_end(0.5))
            .with_contact(floor().with_start(0.5)),
        // when all is over
        scene().with_contact(floor().with_start(1.0)),
        scene().with_coupling(plate().with_lock([true; 6], 0.5)),
    ] {
        assert_eq!(never(&scene), []);
    }
}

#[test]
fn histories_that_are_zero_at_all_steps_are_told() {
    let load = |history| Load::traction(brick::X_MAX, [1e6, 0.0, 0.0]).with_history(history);
    let moved = |history| Support::fixed(brick::X_MAX).with_motion([1e-4, 0.0, 0.0], history);
    let swing = |waves: f64| History::function(move |t| (std::f64::consts::TAU * waves * t).sin());
    let hat = table(&[(0.0, 0.0), (0.2, 1.0), (0.4, 0.0)]);
    let at_end = scene().mesh().nodes_on(brick::X_MAX)[0];
    for (scene, part, says) in [
        (scene().with_load(load(hat.clone())), Part::Load(2), "it is 1 at 0.2 s"),
        (scene().with_load(load(swing(2.0))), Part::Load(2), "it is 0.92977"),
        (
            scene().with_load(load(table(&[(1.0, 0.0), (2.0, 3.0)]))),
            Part::Load(2),
            "it is 3 at 2 s",
        ),
        (
            scene().with_support(moved(hat.clone())),
            Part::Support(1),
            "it is 1 at 0.2 s",
        ),
        (
            scene().with_contact(Contact::rigid(brick::Z_MIN).with_motion([0.0, 0.0, 1e-4], hat.clone())),
            Part::Contact(0),
            "it is 1 at 0.2 s",
        ),
        (
            scene().with_coupling(
                plate()
                    .with_held([true; 6])
                    .with_motion([1e-4, 0.0, 0.0, 0.0, 0.0, 0.0], hat.clone()),
            ),
            Part::Coupling(0),
            "it is 1 at 0.2 s",
        ),
        (
            scene().with_equation(Equation::new([(at_end, [1.0, 0.0, 0.0])]).with_value(1e-4, hat)),
            Part::Equation(0),
            "it is 1 at 0.2 s",
        ),
    ] {
        let is_such = |w: &Warning| matches!(w, Warning::ZeroAtSteps { part: own, .. } if *own == part);
        assert_told(&scene, is_such, part, says);
    }
    for scene in [
        scene().with_load(load(table(&[(0.0, 0.0), (0.5, 1.0), (0.7, 0.0)]))),
        scene().with_load(load(swing(0.5))),
        scene().with_load(load(History::constant(0.0))),
        scene().with_support(moved(ramp()).with_end(0.5)),
    ] {
        assert_eq!(never(&scene), []);
    }
}

/// What acts in one stage alone makes forces all the same.
#[test]
fn a_stage_in_which_nothing_acts_is_not_told() {
    let pressed = || Contact::rigid(brick::Z_MIN).with_gap(-1e-5);
    for contact in [pressed().with_end(0.5), pressed().with_start(0.5)] {
        let scene = Scene::new(block([2.0, 1.0, 1.0], [4, 2, 2]), steel())
            .with_support(Support::fixed(brick::Z_MAX))
            .with_contact(contact)
            .with_analysis(Analysis::quasistatic(1.0, 4));
        let idle = |w: &Warning| matches!(w, Warning::NothingActs { .. });
        let plan = Plan::new(&scene, &Settings::default()).expect("plan");
        assert!(!plan.warnings().iter().any(idle), "{:?}", plan.warnings());
        let simulation = Simulation::new(scene, Settings::default()).expect("set-up");
        assert!(!simulation.plan().warnings().iter().any(idle));
    }
}
