//! Accuracies that are asked for: reached, kept over many steps, told where they are out of reach.

use crate::common::*;
use signorini_fem_mesh::fields::energy_of_difference;

#[test]
fn nothing_is_estimated_unless_asked_for() {
    let result = solve(pressed(2, Friction::coulomb(0.3)), Settings::default());
    assert!(result.report.accuracy.is_none());
}

#[test]
fn a_relative_accuracy_is_reached_and_reported() {
    let scene = small_benchmark(Friction::coulomb(0.3), 6);
    let mut reference = Simulation::new(scene.clone(), tight()).expect("set-up");
    let exact = rest(&mut reference);
    let mut last = 0;
    for target in [1e-2, 1e-4, 1e-6] {
        let settings = Settings::default().with_accuracy(Accuracy::Relative(target));
        let mut simulation = Simulation::new(scene.clone(), settings).expect("set-up");
        for (k, result) in rest(&mut simulation).iter().enumerate() {
            let report = result.report.accuracy.expect("a report");
            assert!(result.report.status.converged() && report.reached && report.target == target);
            assert!(report.algebraic.relative() <= target && report.discretisation.is_none());
            let d: Vec<f64> = (result.displacement.iter().zip(&exact[k].displacement))
                .map(|(a, b)| a - b)
                .collect();
            let energy = fields::strain_energy(scene.mesh(), scene.materials(), &d).expect("energy");
            let truth = (energy / report.algebraic.elastic).sqrt();
            // with all that the steps before have left in it
            assert!(truth <= 1.2 * target, "step {k}: {truth:e} for {target:e}");
            assert!(report.share <= target && report.accumulated.likely() <= target);
        }
        let products = simulation.counters().products;
        println!("relative {target:e}: {products} products");
        assert!(products >= last);
        last = products;
    }
}

#[test]
fn the_error_of_the_mesh_is_estimated_now_and_then() {
    let settings = Settings::default().with_accuracy(Accuracy::balanced());
    let scene = small_benchmark(Friction::coulomb(0.3), 20);
    let mut simulation = Simulation::new(scene, settings).expect("set-up");
    let mut fresh = 0;
    for (k, result) in rest(&mut simulation).iter().enumerate() {
        let report = result.report.accuracy.expect("a report");
        let at = report.estimated_at.expect("an estimate");
        assert!(report.reached && at <= k && k - at < 8, "step {k}: {at}");
        fresh += usize::from(at == k);
    }
    println!("{fresh} estimates in 20 steps");
    assert!((3..=12).contains(&fresh));
}

#[test]
fn a_target_out_of_reach_is_no_success() {
    let solved = |accuracy| {
        let settings = Settings::default().with_accuracy(accuracy);
        let mut simulation = Simulation::new(pressed(3, Friction::coulomb(0.3)), settings).expect("set-up");
        let report = step(&mut simulation).report;
        (report.status, report.accuracy.expect("a report"))
    };
    // the smallest relative target is within reach
    let (status, report) = solved(Accuracy::Relative(1e-11));
    assert!(report.reached && status == StepStatus::Converged);
    // far below the rounding of doubles
    let (status, report) = solved(Accuracy::Balanced { fraction: 1e-20 });
    assert!(!report.reached, "{report:?}");
    assert!(report.algebraic.relative() > report.share);
    assert_eq!(status, StepStatus::Stagnated);
    // what was reached is given all the same
    assert!(report.algebraic.relative() < 1e-10, "{report:?}");
}

#[test]
fn balanced_saves_products_and_keeps_the_error() {
    balanced([12, 4].map(|cells| pressed(cells, Friction::coulomb(0.3))));
}

#[test]
fn balanced_does_so_with_quadratic_elements() {
    balanced([6, 2].map(|cells| {
        let linear = pressed(cells, Friction::coulomb(0.3));
        let mesh = linear.mesh().raise_order().expect("quadratic");
        pressed_on(mesh, Friction::coulomb(0.3))
    }));
}

fn balanced([fine_scene, scene]: [Scene; 2]) {
    let fine = solve(fine_scene.clone(), at(1e-8));
    let error = |settings: Settings| {
        let mut simulation = Simulation::new(scene.clone(), settings).expect("set-up");
        let result = step(&mut simulation);
        let energy = energy_of_difference(
            fine_scene.mesh(),
            scene.materials(),
            &fine.displacement,
            scene.mesh(),
            &result.displacement,
        )
        .expect("energy");
        let estimate = simulation
            .result()
            .expect("a step")
            .discretisation_error()
            .expect("estimate");
        let truth = (energy / estimate.elastic_energy).sqrt();
        (
            truth,
            estimate.relative(),
            simulation.counters().products,
            result.report,
        )
    };
    let (fixed, _, products, _) = error(at(1e-6));
    let (balanced, estimate, fewer, report) = error(Settings::default().with_accuracy(Accuracy::balanced()));
    let report = report.accuracy.expect("a report");
    println!("fixed 1e-6: {fixed:.5} with {products} products; balanced: {balanced:.5} with {fewer}");
    println!(
        "index of the discretisation estimate with contact: {:.3}",
        estimate / balanced
    );
    assert!(report.reached && report.discretisation == Some(estimate));
    assert!((balanced / fixed - 1.0).abs() < 0.02);
    assert!(10 * fewer <= 8 * products, "{fewer} of {products}");
    assert!((0.6..1.5).contains(&(estimate / balanced)));
}

#[test]
fn unusable_accuracies_are_refused() {
    for accuracy in [Accuracy::Relative(0.0), Accuracy::Balanced { fraction: 2.0 }] {
        let settings = Settings::default().with_accuracy(accuracy);
        let error = Simulation::new(pressed(1, Friction::None), settings).expect_err("refused");
        assert!(matches!(error, ContactError::Setting { .. }), "{error}");
    }
}

/// A brick that is pulled hard and pressed on the floor by next to nothing.
fn pulled(cells: [usize; 3], pressure: f64, friction: f64) -> Scene {
    Scene::new(block([3.0, 1.0, 1.0], cells), uniform(1e9, 0.0))
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::pressure(brick::Z_MAX, pressure))
        .with_load(Load::traction(brick::X_MAX, [1e7, 0.0, 0.0]))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(friction)))
        .with_boxes([3, 1, 1])
        .with_analysis(Analysis::quasistatic(1.0, 1))
}

#[test]
fn what_weighs_little_in_the_energy_is_certified_too() {
    let mut worst = 0.0_f64;
    for cells in [[6, 2, 2], [9, 3, 2]] {
        for (pressure, friction) in [(600.0, 0.64), (1600.0, 0.9), (2100.0, 0.71)] {
            for accuracy in [1e-3, 1e-4, 1e-5, 1e-6].map(Accuracy::Relative) {
                let settings = Settings::default().with_accuracy(accuracy).with_method(Method::paper());
                let scene = pulled(cells, pressure, friction);
                let mut simulation = Simulation::new(scene, settings).expect("set-up");
                let result = step(&mut simulation);
                let report = result.report.accuracy.expect("a report");
                let c = result.certificate;
                let largest = [c.gap, c.sign, c.complementarity, c.cone, c.direction]
                    .iter()
                    .map(|v| v.relative())
                    .fold(0.0, f64::max);
                if result.report.status == StepStatus::Converged {
                    worst = worst.max(largest / report.target);
                    assert!(report.reached && report.certified);
                }
            }
        }
    }
    println!("largest violation over target: {worst:.1}");
    assert!(worst > 0.0 && worst <= 5.0, "{worst}");
}

#[test]
fn an_accuracy_asked_for_is_kept_over_many_steps() {
    let scene = benchmark(up_down_up(), 50);
    let exact = rest(&mut Simulation::new(scene.clone(), at(1e-10)).expect("set-up"));
    println!("accuracy | products | largest true error over target | likely over target");
    for accuracy in [Accuracy::Relative(1e-4), Accuracy::Relative(1e-6), Accuracy::balanced()] {
        let settings = Settings::default().with_accuracy(accuracy);
        let mut simulation = Simulation::new(scene.clone(), settings).expect("set-up");
        let (mut worst, mut likely) = (0.0_f64, 0.0_f64);
        for result in &exact {
            let frame = simulation.step().expect("step");
            let report = frame.report().accuracy.expect("a report");
            assert!(report.reached && frame.report().status.converged());
            let truth = relative_distance(&scene, frame.displacement().as_flattened(), &result.displacement);
            worst = worst.max(truth / report.target);
            likely = likely.max(report.accumulated.likely() / report.target);
        }
        let products = simulation.counters().products;
        println!("{accuracy:?} | {products} | {worst:.2} | {likely:.2}");
        assert!(worst < 1.0 && likely <= 1.0 + 1e-12, "{accuracy:?}");
    }
}

/// Where no old slip rate magnifies what a step inherits, the likely error is above the true one in every step.
#[test]
fn the_likely_error_is_above_the_true_one() {
    let scene = loaded_brick(block([3.0, 1.0, 1.0], [15, 5, 5]), up_down_up())
        .with_contact(foundation(Friction::coulomb(0.2)))
        .with_boxes([3, 1, 1])
        .with_analysis(paper_steps(1.0, 50));
    let exact = rest(&mut Simulation::new(scene.clone(), at(1e-10)).expect("set-up"));
    for target in [1e-4, 1e-6] {
        let settings = Settings::default().with_accuracy(Accuracy::Relative(target));
        let results = rest(&mut Simulation::new(scene.clone(), settings).expect("set-up"));
        for (k, (found, exact)) in results.iter().zip(&exact).enumerate() {
            let likely = found.report.accuracy.expect("a report").accumulated.likely();
            let truth = relative_distance(&scene, &found.displacement, &exact.displacement);
            assert!(truth <= likely, "step {k}: {truth:e} above {likely:e}");
        }
    }
}

/// Multipliers are solved less well where there is no contact, but solved.
#[test]
fn the_largest_tolerance_does_without_contact() {
    let scene = Scene::new(block([2.0, 1.0, 1.0], [4, 2, 2]), steel())
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::pressure(brick::X_MAX, 1e6))
        .with_boxes([2, 1, 1]);
    for method in methods() {
        let mut simulation = Simulation::new(scene.clone(), at(0.1).with_method(method)).expect("set-up");
        let result = simulation.step().expect("step");
        assert!(result.require_converged().is_ok());
    }
}

/// Where loads end, too, the tolerance has no say, and estimates are those of the step.
#[test]
fn an_accuracy_is_kept_where_loads_end() {
    let history = || History::table(vec![(0.0, 0.0), (1.0, 1.0), (2.0, 1.0), (3.0, 0.0)]).expect("table");
    let scene = Scene::new(block([1.0; 3], [3; 3]), uniform(1e3, 0.3))
        .with_load(Load::force(brick::Z_MAX, [0.0, 0.0, -10.0]).with_history(history()))
        .with_load(Load::force(brick::X_MIN, [1.0, 0.3, 0.0]).with_history(history()))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.2)))
        .with_analysis(Analysis::quasistatic(3.0, 3));
    let exact = run(scene.clone(), tight()).1;
    let settings = Settings::default()
        .with_accuracy(Accuracy::Relative(1e-8))
        .with_tolerance(0.1);
    let mut simulation = Simulation::new(scene, settings).expect("set-up");
    for exact in &exact {
        let found = step(&mut simulation);
        assert!(found.report.status.converged(), "{:?}", found.report);
        let report = found.report.accuracy.expect("a report");
        let own = simulation.result().expect("a step").algebraic_error();
        assert_eq!(report.algebraic.elastic, own.elastic, "{}", found.time);
        assert!(report.reached && found.certificate.largest() <= 1e-6, "{report:?}");
        let off = distance(&found.displacement, &exact.displacement);
        // a small part of the loads tells where the body stands without
        assert!(off <= 1e-3, "{}: {off:e}", found.time);
    }
}
