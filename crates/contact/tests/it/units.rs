//! Units: a stiffness scaled by 1e9 and lengths by 1e-3 change nothing but the numbers.

use crate::common;
use crate::common::{assert_close, block, forces, run, uniform, up_down_up};
use proptest::prelude::*;
use signorini_contact::{
    Coefficient, Contact, Friction, Load, Method, Preconditioner, Scene, Settings, Support,
};
use signorini_fem_mesh::brick;

/// The small benchmark in units in which a metre is `length` and a newton `force` times one; seconds are `time`.
fn scene(law: usize, length: f64, force: f64, time: f64) -> Scene {
    let stress = force / (length * length);
    let friction = match law {
        0 => Friction::None,
        1 => Friction::tresca(3e8 * stress),
        2 => Friction::coulomb(0.3),
        _ => Friction::Coulomb(Coefficient::Exponential {
            fixed: 0.3,
            kinetic: 0.1,
            decay: 0.05 * length / time,
        }),
    };
    let history = |table: fn() -> signorini_fem_mesh::History| {
        let table = table();
        signorini_fem_mesh::History::function(move |t| table.value(t / time))
    };
    let q = 1e8 * stress;
    Scene::new(
        block([3.0 * length, length, length], [6, 2, 2]),
        uniform(211.9e9 * stress, 0.277),
    )
    .with_support(Support::fixed(brick::X_MIN))
    .with_load(
        Load::traction(brick::Z_MAX, [0.0, 0.0, -30.0 * q]).with_history(history(common::ramp)),
    )
    .with_load(
        Load::traction(brick::X_MAX, [9.0 * q, 0.0, -15.0 * q]).with_history(history(up_down_up)),
    )
    .with_load(Load::body([0.0, 1e7 * force / length.powi(3), 0.0]))
    .with_contact(
        Contact::rigid(brick::Z_MIN)
            .with_gap(0.1 * length)
            .with_friction(friction),
    )
    .with_boxes([3, 1, 1])
    .with_analysis(common::paper_steps(time, 5))
}

/// Compares a scene in other units with the original; returns the products of both.
fn compare(law: usize, settings: &Settings, length: f64, force: f64, time: f64) -> [usize; 2] {
    let (a, reference) = run(scene(law, 1.0, 1.0, 1.0), settings.clone());
    let (b, levels) = run(scene(law, length, force, time), settings.clone());
    for (k, (x, y)) in levels.iter().zip(&reference).enumerate() {
        let what = format!("law {law}, {length:e} m, {force:e} N, {time:e} s, level {k}");
        let u: Vec<f64> = x.displacement.iter().map(|v| v / length).collect();
        let f: Vec<f64> = forces(&x.points).iter().map(|v| v / force).collect();
        assert_close(&u, &y.displacement, 1e-7, &what);
        assert_close(&f, &forces(&y.points), 1e-7, &what);
        assert_eq!(x.summary.active, y.summary.active, "{what}");
        let rate = x.summary.max_slip_rate * time / length;
        assert!(
            (rate - y.summary.max_slip_rate).abs() <= 1e-6 * rate.max(1e-3),
            "{what}"
        );
        let work = x.summary.dissipation / (force * length);
        assert!(
            (work - y.summary.dissipation).abs() <= 1e-6 * work.abs().max(1e3),
            "{what}"
        );
    }
    assert!(reference.iter().any(|l| l.summary.active > 0));
    [a.counters().products, b.counters().products]
}

#[test]
fn stiffness_and_lengths_scale() {
    let accurate = Settings::default().with_tolerance(1e-8);
    for law in 0..4 {
        for method in common::methods() {
            let settings = accurate.clone().with_method(method);
            for (length, force) in [
                (1.0, 1e9),
                (1.0, 1e-9),
                (1e-3, 1e-6 * 1e9),
                (1e3, 1.0),
                (1e-3, 1.0),
            ] {
                let [a, b] = compare(law, &settings, length, force, 1.0);
                // the same iterations up to rounding
                assert!(a.abs_diff(b) <= 5 + a / 10, "{a} and {b} products");
            }
        }
        let settings = accurate
            .clone()
            .with_preconditioner(Preconditioner::Dirichlet);
        compare(law, &settings, 1e-3, 1e3, 1e3);
    }
}

/// Powers of two are exact: not one product may differ, nor one bit of the mantissas.
#[test]
fn powers_of_two_change_no_bit() {
    for method in common::methods() {
        let settings = Settings::default().with_method(method.clone());
        let (length, force) = (2.0_f64.powi(-10), 2.0_f64.powi(30));
        let (_, reference) = run(scene(2, 1.0, 1.0, 1.0), settings.clone());
        let (_, levels) = run(scene(2, length, force, 1.0), settings);
        for (x, y) in levels.iter().zip(&reference) {
            assert_eq!(x.report.counters, y.report.counters, "{}", method.name());
            for (a, b) in x.torn.iter().zip(&y.torn) {
                assert_eq!(a / length, *b, "{}", method.name());
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 12,
        rng_seed: proptest::test_runner::RngSeed::Fixed(20),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn any_units(law in 0..4usize, length in -4.0..4.0f64, force in -9.0..9.0f64, time in -3.0..6.0f64) {
        let settings = Settings::default().with_method(Method::default()).with_tolerance(1e-8);
        compare(law, &settings, 10f64.powf(length), 10f64.powf(force), 10f64.powf(time));
    }
}
