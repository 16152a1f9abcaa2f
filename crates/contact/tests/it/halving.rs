//! Steps that fail are halved, within limits, and taken longer again.

use crate::common::*;
use signorini_qp::ActiveSetSettings;
use std::sync::{Arc, Mutex};

/// A brick pressed, pulled and released: steps of different effort.
pub(crate) fn scene(times: &[f64], formula: DifferenceFormula) -> Scene {
    let pull = History::table(vec![(0.0, 0.0), (1.0, 0.1), (2.0, 1.0), (3.0, 0.9), (4.0, 1.0)]).expect("table");
    Scene::new(block([3.0, 1.0, 1.0], [6, 2, 2]), steel())
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -30e8]).with_history(History::ramp(4.0, 1.0).expect("ramp")))
        .with_load(Load::traction(brick::X_MAX, [9e8, 0.0, -15e8]).with_history(pull))
        .with_contact(
            Contact::rigid(brick::Z_MIN)
                .with_gap(0.02)
                .with_friction(Friction::coulomb(0.3)),
        )
        .with_boxes([3, 1, 1])
        .with_analysis(Analysis::Quasistatic {
            times: times.to_vec(),
            formula,
        })
}

pub(crate) const WHOLE: [f64; 4] = [1.0, 2.0, 3.0, 4.0];

/// Few products: hard steps end at the limit.
pub(crate) fn short_of(products: usize) -> Settings {
    by(Method::ActiveSet(
        ActiveSetSettings::default().with_max_products(products),
    ))
    .with_max_fallback_products(1)
}

/// A scene with a load that notes the times at which it is asked.
fn noting(scene: Scene) -> (Scene, Arc<Mutex<Vec<f64>>>) {
    let times = Arc::new(Mutex::new(Vec::new()));
    let notes = times.clone();
    let none = History::function(move |time| {
        notes.lock().expect("times").push(time);
        0.0
    });
    (scene.with_load(Load::body([1.0, 0.0, 0.0]).with_history(none)), times)
}

/// The times that were gone on from: a halved increment is followed by an earlier end, others perhaps by their starts.
fn passed(asked: &[f64]) -> Vec<f64> {
    let mut passed: Vec<f64> = asked.windows(2).filter(|w| w[1] > w[0]).map(|w| w[0]).collect();
    passed.extend(asked.last());
    passed.extend(asked.iter().copied().reduce(f64::max));
    passed.retain(|time| *time > 0.0);
    passed.sort_by(f64::total_cmp);
    passed.dedup();
    passed
}

/// A run with halved steps is, bit for bit, that of a user who gave its times, and says what it did.
#[test]
fn halved_steps_are_those_of_the_times_between() {
    let settings = short_of(14).with_extrapolation(false);
    let whole = scene(&WHOLE, DifferenceFormula::BACKWARD_EULER);
    let mut failing = Simulation::new(whole, settings.clone()).expect("set-up");
    assert!(!step(&mut failing).report.status.converged());

    let (scene_noting, asked) = noting(scene(&WHOLE, DifferenceFormula::BACKWARD_EULER));
    let mut halved = Simulation::new(scene_noting, settings.clone().with_step_halving(6)).expect("set-up");
    asked.lock().expect("times").clear();
    let results = rest(&mut halved);
    let times = passed(&asked.lock().expect("times"));
    assert_eq!(results.iter().map(|r| r.time).collect::<Vec<_>>(), WHOLE);
    let first = results[0].report.counters;
    assert!(first.halvings >= 2 && first.between >= 3, "{first:?} {times:?}");
    // longer again: whole steps at the end
    assert!(times.ends_with(&[3.0, 4.0]) && times.len() > 6, "{times:?}");
    let total = halved.counters();
    assert_eq!(total.between, times.len() - 4);

    let explicit = scene(&times, DifferenceFormula::BACKWARD_EULER);
    let explicit = explicit.with_load(Load::body([1.0, 0.0, 0.0]).with_history(History::constant(0.0)));
    let (simulation, all) = run(explicit, settings);
    let mut work = 0.0;
    let mut slip = vec![[0.0; 3]; all[0].points.len()];
    let mut reported = results.iter();
    for result in &all {
        work += result.summary.friction_work;
        for (sum, point) in slip.iter_mut().zip(&result.points) {
            (0..3).for_each(|c| sum[c] += point.difference[c]);
        }
        if !WHOLE.contains(&result.time) {
            continue;
        }
        let halved = reported.next().expect("a step");
        assert_certified(halved, &format!("time {}", halved.time));
        assert_eq!(halved.displacement, result.displacement, "time {}", halved.time);
        assert_eq!(halved.summary.friction_work, work, "time {}", halved.time);
        // sums are taken in another order
        for (point, sum) in halved.points.iter().zip(&slip) {
            let off = (0..3).map(|c| (point.difference[c] - sum[c]).abs()).fold(0.0, f64::max);
            assert!(off < 1e-18, "time {}: {off:e}", halved.time);
        }
        work = 0.0;
        slip.fill([0.0; 3]);
    }
    // what failed is counted
    assert!(total.products > simulation.counters().products);
}

/// A ball that is pressed in and turns, by tables with points between the steps: its way past the body is the same, to
/// rounding, however a step is cut.
#[test]
fn obstacles_that_move_and_turn_have_one_way() {
    let table = |points: &[(f64, f64)]| History::table(points.to_vec()).expect("table");
    let scene = |times: &[f64]| {
        let ball = Contact::obstacle(brick::Z_MIN, Obstacle::sphere([1.0, 0.5, -3.0], 3.0))
            .with_friction(Friction::tresca(500.0))
            .with_motion(
                [0.0, 0.0, 3e-3],
                table(&[(0.0, 0.0), (1.0, 1.0), (2.0, 0.0), (4.0, 1.0)]),
            )
            .with_rotation(
                [1.0, 0.5, -3.0],
                [0.3, 1.0, 0.0],
                table(&[(0.0, 0.0), (0.6, 1.0), (1.8, -1.0), (3.2, 0.5), (4.0, 0.0)]),
            );
        Scene::new(block([2.0, 1.0, 1.0], [6, 3, 3]), uniform(1e6, 0.3))
            .with_support(Support::fixed(brick::Z_MAX))
            .with_contact(ball)
            .with_boxes([2, 1, 1])
            .with_analysis(Analysis::Quasistatic {
                times: times.to_vec(),
                formula: DifferenceFormula::BACKWARD_EULER,
            })
    };
    let settings = short_of(16).with_extrapolation(false);
    let (own, asked) = noting(scene(&WHOLE));
    let mut halved = Simulation::new(own, settings.clone().with_step_halving(8)).expect("set-up");
    asked.lock().expect("times").clear();
    let results = rest(&mut halved);
    assert!(halved.counters().between > 8);
    let times = passed(&asked.lock().expect("times"));
    let all = rest(&mut Simulation::new(scene(&times), settings).expect("set-up"));
    for halved in &results {
        let given = all.iter().find(|r| r.time == halved.time).expect("a step");
        assert_certified(halved, &format!("time {}", halved.time));
        assert!(distance(&halved.displacement, &given.displacement) < 1e-12);
    }
}

#[test]
fn nothing_is_halved_unless_asked_for_or_needed() {
    let easy = || Simulation::new(scene(&WHOLE, DifferenceFormula::PAPER), Settings::default());
    let hard = |most| {
        let settings = short_of(14).with_step_halving(most);
        Simulation::new(scene(&WHOLE, DifferenceFormula::PAPER), settings).expect("set-up")
    };
    let mut plain = easy().expect("set-up");
    let mut ready = Simulation::new(plain.scene().clone(), Settings::default().with_step_halving(6)).expect("set-up");
    let (plain, ready) = (rest(&mut plain), rest(&mut ready));
    for (a, b) in plain.iter().zip(&ready) {
        assert_eq!(
            (&a.displacement, a.report.counters),
            (&b.displacement, b.report.counters)
        );
        assert_eq!(b.report.counters.halvings + b.report.counters.between, 0);
    }
    // too few halvings: the step says so, and so do those that depend on it
    let mut simulation = hard(1);
    let report = simulation.run(&mut Silent).expect("run");
    assert_eq!(report.failures.first().map(|f| (f.step, f.time)), Some((0, 1.0)));
    assert_eq!((report.steps, simulation.state().unconverged_history()), (4, Some(0)));
    // none of the steps after it is halved, and nor is what is left of it
    assert_eq!((report.counters.halvings, report.counters.between), (1, 0));
    let out = Settings::default().with_step_halving(21).with_tolerance(1e-6);
    let refused = Simulation::new(scene(&WHOLE, DifferenceFormula::PAPER), out).map(|_| ());
    assert!(refused.expect_err("21").to_string().contains("step_halving = 21"));
}

/// With the paper's formula increments of unequal length are certified, and end where a run of short steps ends, within
/// what short steps differ from one another.
#[test]
fn unequal_increments_keep_the_papers_formula() {
    let settings = short_of(14).with_step_halving(4);
    let mut halved = Simulation::new(scene(&WHOLE, DifferenceFormula::PAPER), settings).expect("set-up");
    let results = rest(&mut halved);
    assert!(results[0].report.counters.between >= 3);
    let results_at = |parts: usize| {
        let times: Vec<f64> = (1..=4 * parts).map(|k| k as f64 / parts as f64).collect();
        run(scene(&times, DifferenceFormula::PAPER), tight()).1
    };
    let (coarse, fine) = (results_at(1), results_at(16));
    for (k, result) in results.iter().enumerate() {
        assert_certified(result, &format!("step {k}"));
        let exact = &fine[16 * k + 15].displacement;
        let square = |u: &[f64]| u.iter().zip(exact).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        let distance = |u: &[f64]| square(u).sqrt();
        let (found, whole) = (distance(&result.displacement), distance(&coarse[k].displacement));
        assert!(found <= 1.05 * whole, "step {k}: {found} {whole}");
    }
}

/// The state has what goes on: steps begin as long as they would have.
#[test]
fn a_resumed_run_goes_on_with_the_same_increments() {
    for formula in [DifferenceFormula::BACKWARD_EULER, DifferenceFormula::PAPER] {
        // the last increment of a step stays halved
        let settings = || short_of(12).with_step_halving(4);
        let new = || Simulation::new(scene(&WHOLE, formula), settings()).expect("set-up");
        let mut whole = new();
        let mut states = Vec::new();
        while !whole.is_finished() {
            states.push(whole.state().clone());
            let _ = whole.step().expect("step");
        }
        assert!(whole.counters().between > 4);
        for (k, state) in states.into_iter().enumerate() {
            let mut again = new();
            again.resume(state).expect("resume");
            let _ = again.run(&mut Silent).expect("run");
            assert!(again.state() == whole.state(), "resumed after {k} steps");
        }
    }
}

/// Where an increment cannot be solved at all the simulation stays where it was.
#[test]
fn a_history_without_a_value_between_is_named_and_changes_nothing() {
    let holes = History::function(|time| if time.fract() == 0.0 { 0.0 } else { f64::NAN });
    let scene = scene(&WHOLE, DifferenceFormula::PAPER).with_load(Load::body([1.0, 0.0, 0.0]).with_history(holes));
    let mut simulation = Simulation::new(scene, short_of(14).with_step_halving(2)).expect("set-up");
    let before = simulation.state().clone();
    let error = simulation.step().expect_err("no value");
    assert!(
        matches!(
            error,
            ContactError::HistoryValue {
                part: Part::Load(2),
                ..
            }
        ),
        "{error}"
    );
    assert!(simulation.state() == &before && simulation.result().is_none());
}

/// One step alone has a history, too, once it is halved.
#[test]
fn a_single_step_is_halved() {
    let settings = short_of(14).with_step_halving(4);
    let mut simulation = Simulation::new(scene(&[1.0], DifferenceFormula::PAPER), settings).expect("set-up");
    let result = step(&mut simulation);
    assert_certified(&result, "halved");
    assert!(result.report.counters.between >= 3 && simulation.is_finished());
    let fixed = scene(&[1.0], DifferenceFormula::PAPER).with_analysis(Analysis::statics());
    let mut fixed = Simulation::new(fixed, short_of(8).with_step_halving(4)).expect("set-up");
    let result = step(&mut fixed);
    assert_eq!(
        (result.report.counters.halvings, result.report.status.converged()),
        (0, false)
    );
}
