//! Effects that are absent cost nothing: the counters and sizes say so.

use crate::common::*;

fn statics(friction: Friction) -> Scene {
    small_benchmark(friction, 1).with_analysis(Analysis::statics())
}

fn set_up(scene: Scene) -> Simulation {
    Simulation::new(scene, Settings::default()).expect("set-up")
}

#[test]
fn without_friction_there_are_no_tangential_rows() {
    let bare = set_up(statics(Friction::None));
    let ranges = bare.tfeti().gluing().ranges();
    assert!(ranges.tangential().is_empty() && !ranges.normal.is_empty());
    assert_eq!(bare.plan().tangential_rows, 0);
    let rough = set_up(statics(Friction::coulomb(0.3)));
    assert_eq!(
        rough.tfeti().dual_dim(),
        bare.tfeti().dual_dim() + 2 * ranges.normal.len()
    );
    for method in methods() {
        let result = solve(statics(Friction::None), by(method));
        assert_eq!(result.report.counters.slip_bound_updates, 0);
        assert!(result.report.fixed_point.is_none());
        assert!(
            result
                .points
                .iter()
                .all(|p| p.friction_force == [0.0; 3] && p.slip_bound == 0.0)
        );
    }
}

#[test]
fn given_friction_is_one_quadratic_program_a_step() {
    let steps = 5;
    let scene = || small_benchmark(Friction::tresca(3e8), steps);
    for method in [Method::paper(), Method::one_loop()] {
        let (_, results) = run(scene(), by(method));
        for result in &results {
            assert_eq!(result.report.counters.quadratic_programs, 1);
            assert_eq!(result.report.counters.slip_bound_updates, 1);
            assert!(result.report.fixed_point.is_none());
        }
    }
    let (_, results) = run(scene(), Settings::default());
    for result in &results {
        assert_eq!(result.report.counters.slip_bound_updates - set_by_hook(result), 0);
        assert!(result.report.fixed_point.is_none());
    }
    // Coulomb friction needs more than one, so that the counter can tell
    let coulomb = small_benchmark(Friction::coulomb(0.3), steps);
    let (simulation, _) = run(coulomb, by(Method::paper()));
    assert!(simulation.counters().quadratic_programs > steps);
}

/// The active-set method writes Tresca bounds once a step.
fn set_by_hook(result: &Solved) -> usize {
    assert!(!result.report.fallback);
    1
}

#[test]
fn static_scenes_hold_no_history() {
    for friction in [
        Friction::None,
        Friction::tresca(3e8),
        Friction::coulomb(0.3),
        weakening(),
    ] {
        let (simulation, results) = run(statics(friction.clone()), Settings::default());
        assert!(!simulation.plan().effects.history, "{friction:?}");
        assert_eq!(simulation.state().memory(), 0, "{friction:?}");
        assert_eq!(results[0].report.counters.rate_updates, 0, "{friction:?}");
        assert!(results[0].points.iter().all(|p| p.slip_rate == 0.0));
    }
    // one quasistatic step does keep something
    let (simulation, _) = run(small_benchmark(Friction::coulomb(0.3), 2), Settings::default());
    assert!(simulation.plan().effects.history && simulation.state().memory() > 0);
}

#[test]
fn without_friction_quasistatic_steps_keep_no_traces() {
    let bytes = |friction| {
        let (simulation, _) = run(small_benchmark(friction, 3), Settings::default());
        (
            simulation.state().memory(),
            simulation.tfeti().gluing().ranges().tangential().len(),
        )
    };
    let ((bare, none), (rough, rows)) = (bytes(Friction::None), bytes(Friction::coulomb(0.3)));
    assert_eq!(none, 0);
    // multipliers and products, two steps each, on the additional rows; two traces; one flag a point
    assert_eq!(rough - bare, 8 * (4 * rows + 2 * rows) + rows / 2);
}

#[test]
fn a_body_without_foundation_never_enters_an_inequality_solver() {
    for method in methods() {
        let scene = loaded_brick(block([3.0, 1.0, 1.0], [6, 2, 2]), ramp())
            .with_boxes([3, 1, 1])
            .with_analysis(paper_steps(1.0, 3));
        let settings = by(method);
        let (simulation, results) = run(scene, settings);
        assert_eq!(simulation.plan().method, MethodKind::Linear);
        assert!(!simulation.plan().effects.contact);
        let counters = simulation.counters();
        let expected = Counters::default();
        assert_eq!(counters.inequality_solves, expected.inequality_solves);
        assert_eq!((counters.quadratic_programs, counters.active_sets), (0, 0));
        assert_eq!((counters.setup_products, counters.slip_bound_updates), (0, 0));
        assert!(counters.products > 0 && results.iter().all(|l| l.points.is_empty()));
    }
    let (simulation, _) = run(small_benchmark(Friction::None, 3), Settings::default());
    assert_eq!(simulation.counters().inequality_solves, 3);
}

#[test]
fn a_constant_coefficient_computes_no_rate() {
    let steps = 4;
    for method in methods() {
        let settings = by(method);
        let count = |friction| {
            let (simulation, _) = run(small_benchmark(friction, steps), settings.clone());
            simulation.counters().rate_updates
        };
        assert_eq!(count(Friction::coulomb(0.3)), 0);
        assert_eq!(count(Friction::tresca(1e8)), 0);
        assert_eq!(count(Friction::None), 0);
        assert_eq!(count(weakening()), steps);
    }
}

#[test]
fn no_gap_no_offset() {
    // a zero gap is no gap, and the results are the same
    let touching = |contact: Contact| {
        let scene = Scene::new(block([3.0, 1.0, 1.0], [6, 2, 2]), steel())
            .with_support(Support::fixed(brick::X_MIN))
            .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -3e8]))
            .with_contact(contact.with_friction(Friction::coulomb(0.3)))
            .with_boxes([3, 1, 1]);
        let plan = Plan::new(&scene, &Settings::default()).expect("plan");
        (plan.effects.gap, solve(scene, Settings::default()))
    };
    let (none, a) = touching(Contact::rigid(brick::Z_MIN));
    let (zero, b) = touching(Contact::rigid(brick::Z_MIN).with_gap(0.0));
    let (field, c) = touching(Contact::rigid(brick::Z_MIN).with_gap_field(|_| 0.0));
    assert_eq!((none, zero, field), (false, false, true));
    assert!(a.summary.active > 0);
    assert_eq!(bits(&a), bits(&b));
    assert_eq!(bits(&a), bits(&c));
}

#[test]
fn one_supported_subdomain_has_no_interface_rows() {
    let whole = loaded_brick(block([3.0, 1.0, 1.0], [6, 2, 2]), ramp()).with_contact(foundation(Friction::None));
    let simulation = set_up(whole.clone());
    assert!(simulation.tfeti().gluing().ranges().interface.is_empty());
    assert!(!simulation.plan().effects.gluing && simulation.plan().interface_rows == 0);
    let torn = set_up(whole.with_boxes([3, 1, 1]));
    // two faces of 3 x 3 nodes
    assert_eq!(torn.tfeti().gluing().ranges().interface.len(), 2 * 9 * 3);
    assert!(torn.plan().effects.gluing);
}

#[test]
fn supports_that_rest_have_no_motion() {
    let scene = statics(Friction::None);
    assert!(!set_up(scene.clone()).plan().effects.motion);
    let moved = scene.with_support(
        Support::components(brick::X_MAX, [false, true, false]).with_motion([0.0, 1e-3, 0.0], History::constant(1.0)),
    );
    assert!(set_up(moved).plan().effects.motion);
}

/// Equal subdomains share one factorisation.
#[test]
fn translates_share_their_factors() {
    let simulation = set_up(benchmark(ramp(), 1));
    let system = simulation.tfeti();
    assert_eq!((system.subdomains(), system.report().classes.len()), (3, 2));
}

/// Loads that stay: with backward Euler what stands is the solution, and one product tells.
#[test]
fn steps_at_which_nothing_changes_cost_one_product() {
    let scene = pressed(4, Friction::coulomb(0.3)).with_analysis(Analysis::quasistatic(1.0, 4));
    let (_, results) = run(scene, Settings::default());
    let products: Vec<usize> = results.iter().map(|r| r.report.counters.products).collect();
    assert!(products[0] > 1 && products[1..] == [1; 3], "{products:?}");
    let last = &results[3];
    assert_close(&last.displacement, &results[0].displacement, 1e-10, "displacement");
    assert_eq!(last.report.counters.active_sets, 0);
}
