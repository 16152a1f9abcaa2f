//! States as bytes: what was stored and read back is the same state, and continues bit for bit.
//! Stands alone, so that it runs with the feature `checkpoint` and no other.

use signorini_contact::{
    Accuracy, Analysis, Coefficient, Contact, DifferenceFormula, Friction, Load, Method, Scene, Settings, Silent,
    Simulation, State, Support,
};
use signorini_fem_mesh::{Brick, History, Hooke, Materials, brick};

/// A coarse relative of the benchmark.
fn simulation(friction: &Friction, settings: &Settings) -> Simulation {
    let mesh = Brick::new([3.0, 1.0, 1.0], [6, 2, 2]).build().expect("brick");
    let steel = Hooke::isotropic(211.9e9, 0.277).expect("steel");
    let ramp = History::ramp(1.0, 1.0).expect("ramp");
    let pull = History::table(vec![(0.0, 0.0), (0.4, 1.0), (0.7, 0.0), (1.0, 1.0)]).expect("table");
    let scene = Scene::new(mesh, Materials::uniform(steel))
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -30e8]).with_history(ramp))
        .with_load(Load::traction(brick::X_MAX, [9e8, 0.0, -15e8]).with_history(pull))
        .with_contact(
            Contact::rigid(brick::Z_MIN)
                .with_gap(0.1)
                .with_friction(friction.clone()),
        )
        .with_boxes([3, 1, 1])
        .with_analysis(Analysis::quasistatic(1.0, 4).with_formula(DifferenceFormula::PAPER));
    Simulation::new(scene, settings.clone()).expect("set-up")
}

fn continues_bit_for_bit(settings: &Settings) {
    let weakening = Coefficient::Exponential {
        fixed: 0.3,
        kinetic: 0.1,
        decay: 0.05,
    };
    for friction in [Friction::coulomb(0.3), Friction::Coulomb(weakening)] {
        let mut whole = simulation(&friction, settings);
        let mut stored = Vec::new();
        while !whole.is_finished() {
            stored.push(whole.state().to_bytes().expect("encode"));
            let _ = whole.step().expect("step");
        }
        for (k, bytes) in stored.iter().enumerate() {
            let state = State::from_bytes(bytes).expect("decode");
            assert_eq!(state.to_bytes().expect("encode"), *bytes);
            let mut again = simulation(&friction, settings);
            again.resume(state).expect("resume");
            let _ = again.run(&mut Silent).expect("run");
            assert!(again.state() == whole.state(), "resumed after {k} steps");
            let last = |s: &Simulation| s.result().expect("a step").torn_displacement().to_vec();
            assert_eq!(last(&again), last(&whole), "resumed after {k} steps");
        }
    }
}

#[test]
fn with_the_default_method() {
    continues_bit_for_bit(&Settings::default());
}

#[test]
fn with_the_papers_methods() {
    for method in [Method::paper(), Method::one_loop()] {
        continues_bit_for_bit(&Settings::default().with_method(method));
    }
}

#[test]
fn with_accuracies_by_estimates() {
    for accuracy in [Accuracy::Relative(1e-5), Accuracy::balanced()] {
        continues_bit_for_bit(&Settings::default().with_accuracy(accuracy));
    }
}

#[test]
fn a_step_that_did_not_converge_stays_named() {
    let one_product = signorini_qp::ActiveSetSettings::default().with_max_products(1);
    let settings = Settings::default()
        .with_method(Method::ActiveSet(one_product))
        .with_max_fallback_products(1);
    let mut simulation = simulation(&Friction::coulomb(0.3), &settings);
    let _ = simulation.run(&mut Silent).expect("run");
    let named = simulation.state().unconverged_history();
    assert!(named.is_some());
    let state = State::from_bytes(&simulation.state().to_bytes().expect("encode")).expect("decode");
    assert_eq!(state.unconverged_history(), named);
}
