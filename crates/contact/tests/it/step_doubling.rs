//! Errors of the time steps by runs with half and quarter steps, against references.

use crate::common::*;

#[test]
fn whole_steps_are_those_of_a_run_without_doubling() {
    let scene = small_benchmark(Friction::coulomb(0.3), 10).with_analysis(Analysis::quasistatic(1.0, 10));
    let mut doubling = StepDoubling::new(&scene, &tight()).expect("set-up");
    let mut plain = Simulation::new(scene, tight()).expect("set-up");
    while !doubling.is_finished() {
        let error = doubling.step().expect("step");
        let result = step(&mut plain);
        let whole = doubling.whole().result().expect("a step").displacement();
        assert_eq!(result.displacement, whole.as_flattened());
        assert_eq!(error.step, plain.state().step() - 1);
    }
    assert!(doubling.counters().products > 2 * doubling.whole().counters().products);
    let statics = pressed(1, Friction::None).with_analysis(Analysis::statics());
    let refused = StepDoubling::new(&statics, &tight());
    assert!(matches!(refused, Err(ContactError::Doubling { .. })));
}

#[test]
fn noise_of_the_solver_is_no_error_of_the_time_steps() {
    // no friction: every step stands alone, and steps of any length end at the same solution
    let scene = small_benchmark(Friction::None, 4);
    let mut doubling = StepDoubling::new(&scene, &Settings::default()).expect("set-up");
    while !doubling.is_finished() {
        let error = doubling.step().expect("step");
        assert!(error.is_below_solver(), "{error:?}");
        assert_eq!((error.is_reliable(), error.order), (None, None));
        assert!(error.whole_error() < 1e-4);
    }
    // with friction it is time error at a small tolerance, and lost in the solver's at a large one
    let scene = small_benchmark(Friction::coulomb(0.3), 160);
    let last = |tolerance: f64| {
        let mut doubling = StepDoubling::new(&scene, &at(tolerance)).expect("set-up");
        let mut told = Vec::new();
        while !doubling.is_finished() {
            told.push(doubling.step().expect("step"));
        }
        told
    };
    let (fine, coarse) = (last(1e-10), last(1e-2));
    let below = |told: &[TimeError]| told.iter().filter(|e| e.is_below_solver()).count();
    println!("below the solver: {} and {} of 160", below(&fine), below(&coarse));
    assert!(below(&fine) < 80 && below(&coarse) > 120);
    assert!(coarse.iter().all(|e| e.is_below_solver() == e.is_reliable().is_none()));
}

fn results(scene: &Scene, settings: Settings) -> Vec<Solved> {
    rest(&mut Simulation::new(scene.clone(), settings).expect("set-up"))
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
    let exact = results(&scene(most, DifferenceFormula::BACKWARD_EULER), at(1e-8));
    println!("error and estimates: root of the mean square over the steps");
    println!("formula steps true | difference of whole and half | Twice | order, reliable");
    let mut reliable = 0;
    for formula in [DifferenceFormula::BACKWARD_EULER, DifferenceFormula::PAPER] {
        let mut before: Option<(f64, bool)> = None;
        for steps in [10, 20, 40] {
            let scene = scene(steps, formula);
            let mut doubling = StepDoubling::new(&scene, &at(1e-8)).expect("set-up");
            let (mut truth, mut plain, mut better) = (0.0, 0.0, 0.0);
            let mut last = None;
            for k in 0..steps {
                let error = doubling.step().expect("step");
                let u = doubling.whole().result().expect("a step").displacement();
                let result = &exact[(k + 1) * most / steps - 1];
                truth += relative_distance(&scene, u.as_flattened(), &result.displacement).powi(2);
                plain += error.displacement().powi(2);
                better += error.whole_error().powi(2);
                last = Some(error);
            }
            let last = last.expect("a step");
            let (order, trust) = (last.order.expect("order"), last.is_reliable().expect("told"));
            let (plain, better) = ((plain / truth).sqrt(), (better / truth).sqrt());
            let truth = (truth / steps as f64).sqrt();
            println!("{formula:?} {steps} {truth:.1e} | {plain:.2} | {better:.2} | {order:.1}, {trust}");
            assert!((0.6..2.5).contains(&better), "{better}");
            // trusted where the true error falls at least in half with half the steps, as for first order, and only
            // there
            if let Some((longer, trusted)) = before.replace((truth, trust)) {
                assert_eq!(trusted, longer >= 2.0 * truth, "{longer:e} to {truth:e}");
            }
            reliable += usize::from(trust);
        }
    }
    // both kinds are among the six
    assert!((4..6).contains(&reliable), "{reliable}");
}
