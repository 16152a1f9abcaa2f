//! Levels that do not converge: who depends on them knows it, and who wants errors gets them.

mod common;

use common::{block, methods, uniform};
use signorini_contact::{
    Analysis, Contact, ContactError, DifferenceFormula, Flow, Friction, Load, Method, Scene,
    Settings, Silent, Simulation, StepResult, StepStatus, Support,
};
use signorini_fem_mesh::{History, brick};
use signorini_qp::ActiveSetSettings;

/// A cantilever pressed on an oblique obstacle, where with this coefficient successive approximations have no limit, then lifted.
fn cantilever(friction: Friction) -> Scene {
    let lifted = History::table(vec![(0.0, 0.0), (1.0, 1.0), (2.0, -1.0)]).expect("table");
    let tilt = 0.02_f64;
    Scene::new(block([5.0, 1.0, 1.0], [10, 2, 2]), uniform(1000.0, 0.0))
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::body([0.0, 0.0, -1.0]).with_history(lifted))
        .with_contact(
            Contact::rigid(brick::X_MAX)
                .with_normal([tilt.cos(), 0.0, -tilt.sin()])
                .with_friction(friction),
        )
        .with_boxes([5, 1, 1])
        .with_analysis(
            Analysis::quasistatic(3.0, 3).with_formula(DifferenceFormula::BACKWARD_EULER),
        )
}

fn rough() -> Simulation {
    let settings = Settings::default().with_method(Method::paper());
    Simulation::new(cantilever(Friction::coulomb(0.8)), settings).expect("set-up")
}

#[test]
fn later_levels_name_the_first_level_that_did_not_converge() {
    let mut simulation = rough();
    let mut seen = Vec::new();
    while !simulation.is_finished() {
        let frame = simulation.step().expect("step");
        seen.push((frame.report().status, frame.unconverged_history()));
        let strict = frame.require_converged();
        match frame.step() {
            0 => assert!(matches!(
                strict,
                Err(ContactError::NotConverged {
                    level: 0,
                    status: StepStatus::NotContractive,
                    ..
                })
            )),
            _ => assert!(matches!(
                strict,
                Err(ContactError::UnconvergedHistory { level: 0 })
            )),
        }
    }
    // lifted off the obstacle the body is certified, but where it stands along the obstacle depends on level 0
    assert_eq!(
        seen,
        [
            (StepStatus::NotContractive, None),
            (StepStatus::Converged, Some(0)),
            (StepStatus::Converged, Some(0)),
        ]
    );
    assert_eq!(simulation.state().unconverged_history(), Some(0));
}

#[test]
fn a_run_is_no_error_and_a_strict_run_names_level_status_and_remedy() {
    let mut simulation = rough();
    let report = simulation.run(&mut Silent).expect("run");
    assert_eq!((report.levels, report.failures.len()), (3, 1));
    assert!(!report.converged() && report.counters == *simulation.counters());
    let first = *report.first_failure().expect("a failure");
    assert_eq!(
        (first.level, first.time, first.status),
        (0, 1.0, StepStatus::NotContractive)
    );
    assert!(first.certificate <= report.largest_certificate);
    let error = report.require_converged().expect_err("not converged");
    let text = error.to_string();
    for part in [
        "level 0",
        "at 1 s",
        "not contractive",
        "smaller coefficient",
    ] {
        assert!(text.contains(part), "{text}");
    }
}

#[test]
fn an_observer_can_end_a_run_at_the_first_such_level() {
    let mut simulation = rough();
    let outcome =
        simulation.run(&mut |frame: &StepResult<'_>| Flow::from(frame.require_converged()));
    let error = outcome.expect_err("not converged");
    assert!(matches!(error, ContactError::Observer { level: 0, .. }));
    assert!(error.to_string().contains("not contractive"), "{error}");
    assert_eq!(simulation.state().step(), 1);
}

#[test]
fn a_resumed_run_knows_what_it_continues() {
    let mut first = rough();
    let _ = first.step().expect("step");
    let mut second =
        Simulation::new(cantilever(Friction::coulomb(0.8)), Settings::default()).expect("set-up");
    second.resume(first.state().clone()).expect("resume");
    let report = second.run(&mut Silent).expect("run");
    assert!(report.failures.is_empty());
    assert_eq!(report.unconverged_history, Some(0));
    let error = report
        .require_converged()
        .expect_err("an unconverged history");
    assert!(matches!(
        error,
        ContactError::UnconvergedHistory { level: 0 }
    ));
}

#[cfg(feature = "checkpoint")]
#[test]
fn stored_states_keep_it() {
    let mut simulation = rough();
    let _ = simulation.step().expect("step");
    let bytes = simulation.state().to_bytes().expect("encode");
    let state = signorini_contact::State::from_bytes(&bytes).expect("decode");
    assert_eq!(state.unconverged_history(), Some(0));
}

/// Without friction a level depends on nothing that an earlier one found.
#[test]
fn scenes_without_memory_never_set_it() {
    let short = Settings::default()
        .with_method(Method::ActiveSet(
            ActiveSetSettings::default().with_max_products(1),
        ))
        .with_max_fallback_products(1);
    let mut simulation = Simulation::new(cantilever(Friction::None), short).expect("set-up");
    let report = simulation.run(&mut Silent).expect("run");
    assert!(report.first_failure().is_some(), "{report:?}");
    assert_eq!(report.unconverged_history, None);
    assert_eq!(simulation.state().unconverged_history(), None);
    let frame = simulation.frame().expect("frame");
    assert_eq!(frame.unconverged_history(), None);
}

#[test]
fn runs_that_converge_are_converged() {
    for method in methods() {
        let settings = Settings::default().with_method(method);
        let mut simulation =
            Simulation::new(cantilever(Friction::coulomb(0.05)), settings).expect("set-up");
        let report = simulation.run(&mut Silent).expect("run");
        assert!(report.converged() && report.largest_certificate <= 1e-6);
        report.require_converged().expect("converged");
        assert_eq!(report.levels, 3);
        assert_eq!(simulation.state().unconverged_history(), None);
    }
}
