//! Effects that are absent cost nothing: the counters and sizes say so.

mod common;

use common::{
    block, foundation, loaded_brick, methods, run, small_benchmark, solve, steel, weakening,
};
use signorini_contact::{
    Analysis, Contact, Counters, Friction, Load, Method, Plan, Scene, Settings, Simulation, Support,
};
use signorini_fem_mesh::{History, brick};

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
        let level = solve(
            statics(Friction::None),
            Settings::default().with_method(method),
        );
        assert_eq!(level.report.counters.slip_bound_updates, 0);
        assert!(level.report.fixed_point.is_none());
        assert!(
            level
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
        let (_, levels) = run(scene(), Settings::default().with_method(method));
        for level in &levels {
            assert_eq!(level.report.counters.quadratic_programs, 1);
            assert_eq!(level.report.counters.slip_bound_updates, 1);
            assert!(level.report.fixed_point.is_none());
        }
    }
    let (_, levels) = run(scene(), Settings::default());
    for level in &levels {
        assert_eq!(
            level.report.counters.slip_bound_updates - set_by_hook(level),
            0
        );
        assert!(level.report.fixed_point.is_none());
    }
    // Coulomb friction needs more than one, so that the counter can tell
    let coulomb = small_benchmark(Friction::coulomb(0.3), steps);
    let (simulation, _) = run(coulomb, Settings::default().with_method(Method::paper()));
    assert!(simulation.counters().quadratic_programs > steps);
}

/// The face method writes given bounds once a level.
fn set_by_hook(level: &common::StepProblem) -> usize {
    assert!(!level.report.fallback);
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
        let (simulation, levels) = run(statics(friction.clone()), Settings::default());
        assert!(!simulation.plan().effects.history, "{friction:?}");
        assert_eq!(simulation.state().memory(), 0, "{friction:?}");
        assert_eq!(levels[0].report.counters.rate_updates, 0, "{friction:?}");
        assert!(levels[0].points.iter().all(|p| p.slip_rate == 0.0));
    }
    // one quasistatic step does keep something
    let (simulation, _) = run(
        small_benchmark(Friction::coulomb(0.3), 2),
        Settings::default(),
    );
    assert!(simulation.plan().effects.history && simulation.state().memory() > 0);
}

#[test]
fn without_friction_quasistatic_levels_keep_no_traces() {
    let bytes = |friction| {
        let (simulation, _) = run(small_benchmark(friction, 3), Settings::default());
        (
            simulation.state().memory(),
            simulation.tfeti().gluing().ranges().tangential().len(),
        )
    };
    let ((bare, none), (rough, rows)) = (bytes(Friction::None), bytes(Friction::coulomb(0.3)));
    assert_eq!(none, 0);
    // multipliers and products, two levels each, on the additional rows; two traces; one flag a point
    assert_eq!(rough - bare, 8 * (4 * rows + 2 * rows) + rows / 2);
}

#[test]
fn a_body_without_foundation_never_enters_an_inequality_solver() {
    for method in methods() {
        let scene = loaded_brick(block([3.0, 1.0, 1.0], [6, 2, 2]), common::ramp())
            .with_boxes([3, 1, 1])
            .with_analysis(Analysis::quasistatic(1.0, 3));
        let settings = Settings::default().with_method(method);
        let (simulation, levels) = run(scene, settings);
        assert_eq!(simulation.plan().method, "linear");
        assert!(!simulation.plan().effects.contact);
        let counters = simulation.counters();
        let expected = Counters::default();
        assert_eq!(counters.inequality_solves, expected.inequality_solves);
        assert_eq!((counters.quadratic_programs, counters.faces), (0, 0));
        assert_eq!(
            (counters.setup_products, counters.slip_bound_updates),
            (0, 0)
        );
        assert!(counters.products > 0 && levels.iter().all(|l| l.points.is_empty()));
    }
    let (simulation, _) = run(small_benchmark(Friction::None, 3), Settings::default());
    assert_eq!(simulation.counters().inequality_solves, 3);
}

#[test]
fn a_constant_coefficient_computes_no_rate() {
    let steps = 4;
    for method in methods() {
        let settings = Settings::default().with_method(method);
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
    assert_eq!(common::bits(&a), common::bits(&b));
    assert_eq!(common::bits(&a), common::bits(&c));
}

#[test]
fn one_supported_subdomain_has_no_interface_rows() {
    let whole = loaded_brick(block([3.0, 1.0, 1.0], [6, 2, 2]), common::ramp())
        .with_contact(foundation(Friction::None));
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
        Support::components(brick::X_MAX, [false, true, false])
            .with_motion([0.0, 1e-3, 0.0], History::constant(1.0)),
    );
    assert!(set_up(moved).plan().effects.motion);
}

/// Equal subdomains share one factorisation.
#[test]
fn translates_share_their_factors() {
    let simulation = set_up(common::benchmark(common::ramp(), 1));
    let report = simulation.tfeti().report();
    assert_eq!((report.subdomains, report.classes.len()), (3, 2));
}

/// What the plan promises is what the set-up finds.
/// A mesh in other units or in another place shows in the plan.
#[test]
fn the_plan_tells_the_range_of_the_gaps() {
    let plan = |contact: Contact| {
        let scene = Scene::new(block([2.0, 1.0, 1.0], [4, 2, 2]), steel()).with_contact(contact);
        Plan::new(&scene, &Settings::default()).expect("plan")
    };
    let touching = plan(Contact::rigid(brick::Z_MIN));
    assert_eq!(touching.gaps, Some([0.0; 2]));
    assert!(touching.to_string().contains("no gap"));
    let wedge = plan(Contact::rigid(brick::Z_MIN).with_gap_field(|x| 0.25 * x[0] - 0.125));
    assert_eq!(wedge.gaps, Some([-0.125, 0.375]));
    let text = wedge.to_string();
    assert!(
        text.contains("gaps -1.250e-1 to 3.750e-1 m, starts inside"),
        "{text}"
    );
    let scene =
        Scene::new(block([1.0; 3], [2; 3]), steel()).with_support(Support::fixed(brick::X_MIN));
    let none = Plan::new(&scene, &Settings::default()).expect("plan");
    assert_eq!(none.gaps, None);
}

#[test]
fn the_plan_predicts_the_rows() {
    for scene in [
        statics(Friction::None),
        statics(Friction::coulomb(0.3)),
        common::benchmark(common::ramp(), 3),
        common::benchmark(common::ramp(), 3).with_boxes([1, 1, 1]),
    ] {
        let plan = Plan::new(&scene, &Settings::default()).expect("plan");
        let simulation = set_up(scene);
        let ranges = simulation.tfeti().gluing().ranges().clone();
        assert_eq!(plan.normal_rows, ranges.normal.len());
        assert_eq!(plan.tangential_rows, ranges.tangential().len());
        assert_eq!(plan.interface_rows, ranges.interface.len());
        assert_eq!(plan.dirichlet_rows, ranges.dirichlet.len());
        assert_eq!(plan.dual(), simulation.tfeti().dual_dim());
        assert_eq!(plan.primal, simulation.tfeti().torn_dim());
    }
}

/// Every tetrahedron a subdomain, by mistake: six unknowns each and thirty neighbours make a coarse problem that outweighs all else.
#[test]
fn the_plan_knows_what_very_small_subdomains_cost() {
    let plan = |n: usize, small: bool| {
        let mesh = block([3.0, 1.0, 1.0], [3 * n, n, n]);
        let parts = (0..mesh.tets().len() as u32).collect();
        let scene = Scene::new(mesh, steel())
            .with_support(Support::fixed(brick::X_MIN))
            .with_load(Load::traction(brick::Z_MAX, [3e8, 0.0, -3e9]))
            .with_contact(Contact::rigid(brick::Z_MIN).with_gap(0.01));
        let scene = if small {
            scene.with_parts(parts)
        } else {
            scene.with_boxes([3, 1, 1])
        };
        Plan::new(&scene, &Settings::default()).expect("plan")
    };
    let seconds = |p: &Plan| p.estimate.setup_seconds() + p.estimate.solve_seconds();
    let (coarse, fine) = (plan(3, true), plan(6, true));
    // eight times as many subdomains, nearly their square
    assert!(seconds(&fine) > 30.0 * seconds(&coarse));
    assert!(seconds(&fine) > 30.0 * seconds(&plan(6, false)));
    assert!(fine.to_string().contains("too small ones"), "{fine}");
    assert!(!plan(6, false).to_string().contains("too small ones"));
}
