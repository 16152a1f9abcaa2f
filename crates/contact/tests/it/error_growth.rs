//! Errors that grow over the levels: algebraic ones that add up, and those of the time steps, against references.

use crate::common;
use crate::common::{Solved, benchmark, block, foundation, loaded_brick, rest, up_down_up};
use signorini_contact::{
    AccumulatedError, Accuracy, Analysis, DifferenceFormula, Doubling, Friction, Scene, Settings,
    Simulation, StepDoubling,
};
use signorini_fem_mesh::fields;

fn at(tolerance: f64) -> Settings {
    Settings::default().with_tolerance(tolerance)
}

fn levels(scene: &Scene, settings: Settings) -> Vec<Solved> {
    rest(&mut Simulation::new(scene.clone(), settings).expect("set-up"))
}

/// Distance relative to the reference in the energy norm.
fn distance(scene: &Scene, own: &[f64], reference: &[f64]) -> f64 {
    let energy = |u: &[f64]| {
        fields::strain_energy(scene.mesh(), scene.materials(), u).expect("strain energy")
    };
    let difference: Vec<f64> = own.iter().zip(reference).map(|(a, b)| a - b).collect();
    (energy(&difference) / energy(reference)).sqrt()
}

#[test]
fn errors_of_earlier_levels_add_up() {
    println!("estimated over true error at the end and, least and most, over the levels");
    println!("steps tolerance true | last level | likely | at most");
    for (steps, tolerances) in [(10, vec![1e-2, 1e-4]), (50, vec![1e-2, 1e-3, 1e-4, 1e-5])] {
        let scene = benchmark(up_down_up(), steps);
        let exact = levels(&scene, at(1e-10));
        for tolerance in tolerances {
            let mut simulation = Simulation::new(scene.clone(), at(tolerance)).expect("set-up");
            let mut sum = AccumulatedError::default();
            let mut indices = Vec::new();
            let mut truth = 0.0;
            for level in &exact {
                let frame = simulation.step().expect("step");
                sum.add(&frame);
                truth = distance(&scene, &frame.displacement(), &level.displacement);
                let estimates = [
                    frame.algebraic_error().relative(),
                    sum.likely(),
                    sum.at_most(),
                ];
                indices.push(estimates.map(|e| e / truth));
            }
            let text = [0, 1, 2].map(|k| {
                let of = indices.iter().map(|i| i[k]);
                let (least, most) = (
                    of.clone().fold(f64::INFINITY, f64::min),
                    of.fold(0.0, f64::max),
                );
                let end = indices.last().map_or(f64::NAN, |i| i[k]);
                format!("{end:.2} ({least:.2} to {most:.2})")
            });
            println!("{steps} {tolerance:e} {truth:.1e} | {}", text.join(" | "));
            for [last, likely, most] in indices {
                assert!(last <= likely * (1.0 + 1e-12) && likely <= most * (1.0 + 1e-12));
                assert!(most >= 0.3, "the sum is too small: {most}");
                assert!((0.1..15.0).contains(&likely), "{likely}");
            }
        }
    }
}

#[test]
fn an_accuracy_asked_for_is_kept_over_many_levels() {
    let scene = benchmark(up_down_up(), 50);
    let exact = levels(&scene, at(1e-10));
    println!("accuracy | products | largest true error over target | likely over target");
    for accuracy in [
        Accuracy::Relative(1e-4),
        Accuracy::Relative(1e-6),
        Accuracy::balanced(),
    ] {
        let settings = Settings::default().with_accuracy(accuracy);
        let mut simulation = Simulation::new(scene.clone(), settings).expect("set-up");
        let (mut worst, mut likely) = (0.0_f64, 0.0_f64);
        for level in &exact {
            let frame = simulation.step().expect("step");
            let report = frame.report().accuracy.expect("a report");
            assert!(report.reached && frame.report().status.converged());
            let truth = distance(&scene, &frame.displacement(), &level.displacement);
            worst = worst.max(truth / report.target);
            likely = likely.max(report.accumulated.likely() / report.target);
        }
        let products = simulation.counters().products;
        println!("{accuracy:?} | {products} | {worst:.2} | {likely:.2}");
        assert!(worst < 1.0 && likely <= 1.0 + 1e-12, "{accuracy:?}");
    }
}

#[test]
fn twice_doubled_steps_tell_the_error_and_its_order() {
    let mesh = || block([3.0, 1.0, 1.0], [12, 4, 4]);
    let scene = |steps: usize, formula| {
        loaded_brick(mesh(), up_down_up())
            .with_contact(foundation(Friction::coulomb(0.3)))
            .with_boxes([3, 1, 1])
            .with_analysis(Analysis::quasistatic(1.0, steps).with_formula(formula))
    };
    let most = 640;
    let exact = levels(&scene(most, DifferenceFormula::BACKWARD_EULER), at(1e-8));
    println!("error and estimates: root of the mean square over the levels");
    println!("formula steps true | difference of whole and half | Twice | order, reliable");
    let mut reliable = 0;
    for formula in [DifferenceFormula::BACKWARD_EULER, DifferenceFormula::PAPER] {
        let mut before: Option<(f64, bool)> = None;
        for steps in [10, 20, 40] {
            let scene = scene(steps, formula);
            let mut doubling =
                StepDoubling::new(&scene, &at(1e-8), Doubling::Twice).expect("set-up");
            let (mut truth, mut plain, mut better) = (0.0, 0.0, 0.0);
            let mut last = None;
            for k in 0..steps {
                let error = doubling.step().expect("step");
                let u = doubling.whole().frame().expect("a level").displacement();
                let level = &exact[(k + 1) * most / steps - 1];
                truth += distance(&scene, &u, &level.displacement).powi(2);
                plain += error.displacement().powi(2);
                better += error.whole_error().powi(2);
                assert!(error.changed_points <= doubling.whole().constrained_points().len());
                last = Some(error);
            }
            let last = last.expect("a step");
            let (order, trust) = (
                last.order.expect("order"),
                last.is_reliable().expect("told"),
            );
            let (plain, better) = ((plain / truth).sqrt(), (better / truth).sqrt());
            let truth = (truth / steps as f64).sqrt();
            println!(
                "{formula:?} {steps} {truth:.1e} | {plain:.2} | {better:.2} | {order:.1}, {trust}"
            );
            assert!((0.6..2.5).contains(&better), "{better}");
            // trusted where the true error falls at least in half with half the steps, as for first order, and only there
            if let Some((longer, trusted)) = before.replace((truth, trust)) {
                assert_eq!(trusted, longer >= 2.0 * truth, "{longer:e} to {truth:e}");
            }
            reliable += usize::from(trust);
        }
    }
    // both kinds are among the six
    assert!((4..6).contains(&reliable), "{reliable}");
}

#[test]
fn two_runs_assume_order_one_and_say_so() {
    let scene = loaded_brick(block([3.0, 1.0, 1.0], [6, 2, 2]), up_down_up())
        .with_contact(foundation(Friction::coulomb(0.3)))
        .with_analysis(common::paper_steps(1.0, 4));
    let mut doubling = StepDoubling::new(&scene, &at(1e-8), Doubling::Global).expect("set-up");
    let error = doubling.step().expect("step");
    assert_eq!((error.order, error.is_reliable()), (None, None));
    assert_eq!(error.whole_error(), 2.0 * error.displacement());
    assert!(doubling.quarter().is_none() && error.quarter_energy.is_none());
}
