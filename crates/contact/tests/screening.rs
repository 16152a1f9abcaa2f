//! Contact points that stay open leave the dual problem; results are those of the complete problem.

mod common;

use common::{
    StepProblem, assert_certified, assert_close, bits, block, forces, loaded_brick, ramp, rest,
    run, small_benchmark, steel, step, tight, up_down_up, weakening,
};
use signorini_contact::{
    Analysis, Contact, ContactError, DifferenceFormula, Doubling, Friction, Load, Method, Scene,
    Screening, Settings, Simulation, StepDoubling, Support,
};
use signorini_fem_mesh::{FacetTag, History, brick};

fn screened() -> Settings {
    tight().with_screening(Screening::on())
}

/// Points come back one by one.
fn narrow() -> Screening {
    Screening::On { margin: 0.0 }
}

/// Runs with and without screening; the results must be the same at all points.
fn compare(
    scene: &Scene,
    off: Settings,
    on: Settings,
    what: &str,
) -> (Simulation, Vec<StepProblem>) {
    let (_, complete) = run(scene.clone(), off);
    let (simulation, levels) = run(scene.clone(), on);
    assert_eq!(levels.len(), complete.len());
    for (k, (a, b)) in levels.iter().zip(&complete).enumerate() {
        let what = format!("{what}, level {k}");
        assert_certified(a, &what);
        assert_close(&forces(&a.points), &forces(&b.points), 1e-6, &what);
        assert_close(&a.displacement, &b.displacement, 1e-7, &what);
        for (p, q) in a.points.iter().zip(&b.points) {
            assert_eq!((p.node, p.state), (q.node, q.state), "{what}");
            let size = b.summary.max_slip_rate.max(1.0);
            assert!((p.slip_rate - q.slip_rate).abs() <= 1e-6 * size, "{what}");
            assert!((p.gap - q.gap).abs() <= 1e-8, "{what}: {p:?} {q:?}");
        }
    }
    (simulation, levels)
}

/// Supports in a plane of symmetry leave some contact points one tangential direction.
fn symmetric(friction: Friction, steps: usize) -> Scene {
    loaded_brick(block([3.0, 1.0, 1.0], [9, 3, 3]), up_down_up())
        .with_support(Support::components(brick::Y_MIN, [false, true, false]))
        .with_contact(
            Contact::rigid(brick::Z_MIN)
                .with_gap(0.1)
                .with_friction(friction),
        )
        .with_boxes([3, 1, 1])
        .with_analysis(Analysis::quasistatic(1.0, steps))
}

#[test]
fn results_are_those_of_the_complete_problem() {
    for (name, friction) in [
        ("none", Friction::None),
        ("Coulomb", Friction::coulomb(0.3)),
        ("weakening", weakening()),
    ] {
        for scene in [
            small_benchmark(friction.clone(), 20),
            symmetric(friction.clone(), 20),
        ] {
            let (simulation, levels) =
                compare(&scene, tight(), tight().with_screening(narrow()), name);
            let counters = simulation.counters();
            assert!(counters.rebuilds > 1 && counters.screened_points > 0);
            // some points come back after the first touch, too
            let first = levels
                .iter()
                .position(|l| l.summary.active > 0)
                .expect("touch");
            let later: usize = levels[first + 1..]
                .iter()
                .map(|l| l.report.counters.rebuilds)
                .sum();
            assert!(later > 0, "{name}");
            // before anything touches, no inequality solver is entered
            let before: usize = levels[..first]
                .iter()
                .map(|l| l.report.counters.inequality_solves)
                .sum();
            assert_eq!(before, 0);
            assert_eq!(
                simulation.constrained_points().len(),
                levels[0].points.len()
            );
        }
    }
}

#[test]
fn the_papers_methods_are_screened_alike() {
    let scene = small_benchmark(Friction::coulomb(0.3), 4);
    for method in [Method::paper(), Method::one_loop()] {
        let settings = Settings::default().with_tolerance(1e-9).with_method(method);
        let on = settings.clone().with_screening(Screening::on());
        compare(&scene, settings, on, "paper");
    }
}

#[test]
fn any_margin_gives_the_same() {
    let scene = small_benchmark(weakening(), 5);
    let rebuilds = [0.0, 0.2, 10.0].map(|margin| {
        let on = tight().with_screening(Screening::On { margin });
        compare(&scene, tight(), on, "margin").0.counters().rebuilds
    });
    assert!(rebuilds[0] >= rebuilds[1] && rebuilds[1] >= rebuilds[2]);
    assert_eq!(rebuilds[2], 1, "all points come back at once");
    for margin in [-0.1, f64::NAN, 11.0] {
        let bad = Settings::default().with_screening(Screening::On { margin });
        assert!(matches!(
            Simulation::new(scene.clone(), bad),
            Err(ContactError::Setting {
                name: "screening.margin",
                ..
            })
        ));
    }
}

#[test]
fn points_that_touch_at_first_may_lift_off() {
    // a touching block is pressed at one end and lifted at the other: the points there are never in
    let scene = Scene::new(block([3.0, 1.0, 1.0], [9, 3, 3]), steel())
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::traction(brick::X_MAX, [0.0, 0.0, 1e9]).with_history(ramp()))
        .with_load(Load::pressure(brick::Z_MAX, 1e8).with_history(ramp()))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.3)))
        .with_boxes([3, 1, 1])
        .with_analysis(Analysis::quasistatic(1.0, 3));
    let off = Settings::default().with_tolerance(1e-9);
    let on = off.clone().with_screening(Screening::On { margin: 1e-3 });
    let (simulation, levels) = compare(&scene, off, on, "lift");
    assert!(simulation.counters().screened_points > 0);
    assert!(levels.iter().all(|l| l.summary.max_penetration < 1e-9));
}

#[test]
fn a_restart_across_a_rebuild_is_bit_for_bit() {
    let scene = || small_benchmark(weakening(), 20);
    let settings = || Settings::default().with_screening(narrow());
    let mut simulation = Simulation::new(scene(), settings()).expect("set-up");
    let (mut states, mut levels) = (vec![simulation.state().clone()], Vec::new());
    while !simulation.is_finished() {
        levels.push(step(&mut simulation));
        states.push(simulation.state().clone());
    }
    assert!(simulation.counters().rebuilds > 1);
    for (k, state) in states.iter().enumerate() {
        let mut again = Simulation::new(scene(), settings()).expect("set-up");
        again.resume(state.clone()).expect("resume");
        for (a, b) in rest(&mut again).iter().zip(&levels[k..]) {
            assert_eq!(bits(a), bits(b), "resumed after level {k}");
        }
        assert_eq!(again.state(), simulation.state(), "resumed after level {k}");
    }
}

#[test]
fn states_move_between_screened_and_complete_runs() {
    let scene = || small_benchmark(weakening(), 8);
    let (_, levels) = run(scene(), tight());
    for (first, second) in [(tight(), screened()), (screened(), tight())] {
        for k in [2, 5] {
            let mut a = Simulation::new(scene(), first.clone()).expect("set-up");
            (0..k).for_each(|_| drop(step(&mut a)));
            let mut b = Simulation::new(scene(), second.clone()).expect("set-up");
            b.resume(a.state().clone()).expect("resume");
            for (x, y) in rest(&mut b).iter().zip(&levels[k..]) {
                assert_certified(x, "moved");
                assert_close(&forces(&x.points), &forces(&y.points), 1e-6, "moved");
            }
        }
    }
}

#[test]
fn where_nothing_touches_only_the_linear_solver_runs() {
    let mesh = || block([3.0, 1.0, 1.0], [6, 2, 2]);
    let floor = Contact::rigid(brick::Z_MIN)
        .with_gap(10.0)
        .with_friction(weakening());
    let three = Analysis::quasistatic(1.0, 3);
    let bare = loaded_brick(mesh(), ramp())
        .with_boxes([3, 1, 1])
        .with_analysis(three.clone());
    let far = bare.clone().with_contact(floor);
    let (_, expected) = run(bare.clone(), tight());
    let (simulation, levels) = run(far, screened());
    let counters = simulation.counters();
    assert_eq!((counters.inequality_solves, counters.faces), (0, 0));
    assert_eq!((counters.slip_bound_updates, counters.rebuilds), (0, 0));
    assert_eq!(counters.screened_points, 3 * levels[0].points.len());
    let contact = simulation.tfeti().gluing().ranges().contact();
    assert!(contact.is_empty());
    for (a, b) in levels.iter().zip(&expected) {
        assert_eq!(a.torn, b.torn);
        assert!(
            a.points
                .iter()
                .all(|p| p.gap > 0.0 && p.normal_force == 0.0)
        );
    }
}

#[test]
fn screening_stays_away_where_open_points_matter() {
    // given friction acts at open points, too
    let given = small_benchmark(Friction::tresca(3e8), 3);
    // contact alone holds this block
    let free = Scene::new(block([1.0, 1.0, 1.0], [2, 2, 2]), steel())
        .with_load(Load::pressure(brick::Z_MAX, 1e8))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.3)));
    for scene in [given, free] {
        let (_, complete) = run(scene.clone(), tight());
        let (simulation, levels) = run(scene, screened());
        assert_eq!(simulation.counters().screened_points, 0);
        for (a, b) in levels.iter().zip(&complete) {
            assert_eq!(bits(a), bits(b));
        }
    }
}

#[test]
fn supports_that_move_and_step_doubling() {
    let formula = DifferenceFormula::BACKWARD_EULER;
    let scene = symmetric(Friction::coulomb(0.2), 4)
        .with_support(
            Support::components(brick::X_MAX, [true, false, false])
                .with_motion([0.05, 0.0, 0.0], History::ramp(1.0, 1.0).expect("ramp")),
        )
        .with_analysis(Analysis::quasistatic(1.0, 4).with_formula(formula));
    compare(&scene, tight(), screened(), "moved");
    let errors = [tight(), screened()].map(|settings| {
        let mut doubling = StepDoubling::new(&scene, &settings, Doubling::Local).expect("set-up");
        let mut errors = Vec::new();
        while !doubling.is_finished() {
            let error = doubling.step().expect("step");
            errors.extend([error.displacement(), error.force()]);
        }
        errors
    });
    for (a, b) in errors[0].iter().zip(&errors[1]) {
        assert!((a - b).abs() <= 1e-5 * (1.0 + a), "{errors:?}");
    }
}

/// A load that travels along a slab presses one part of it after the other on the floor.
fn travelling(levels: usize) -> Scene {
    let mesh = block([8.0, 1.0, 0.5], [16, 2, 1]).tag_boundary(|centre, normal| {
        if normal[2] > 0.5 {
            Some(FacetTag(100 + centre[0] as u32))
        } else if normal[2] < -0.5 {
            Some(brick::Z_MIN)
        } else {
            (normal[1] < -0.5).then_some(brick::Y_MIN)
        }
    });
    let floor = Contact::rigid(brick::Z_MIN)
        .with_gap(0.005)
        .with_friction(Friction::coulomb(0.3));
    let mut scene = Scene::new(mesh, steel())
        .with_support(Support::fixed(brick::Y_MIN))
        .with_contact(floor)
        .with_boxes([8, 1, 1])
        .with_analysis(Analysis::quasistatic(1.0, levels));
    for metre in 0..8 {
        let hat = [-1.5, 0.0, 1.5].map(|s| ((f64::from(metre) + 0.5 + s) / 8.0, 1.5 - s.abs()));
        let hat = History::table(hat.to_vec()).expect("hat");
        let pressure = Load::pressure(FacetTag(100 + metre as u32), 6e8);
        scene = scene.with_load(pressure.with_history(hat));
    }
    scene
}

#[test]
fn points_leave_again_and_rebuilds_factorise_no_subdomain() {
    let scene = travelling(24);
    let (simulation, levels) = compare(&scene, tight(), screened(), "travelling");
    let counters = simulation.counters();
    assert!(counters.rebuilds > 2);
    assert_eq!(counters.factorisations, counters.rebuilds);
    let out: Vec<usize> = levels
        .iter()
        .map(|l| l.report.counters.screened_points)
        .collect();
    assert!(
        out.windows(2).any(|w| w[1] > w[0]),
        "nobody leaves: {out:?}"
    );
    // most are let in before they touch: fewer levels are solved twice than there are rebuilds
    let twice: usize = levels
        .iter()
        .filter(|l| l.report.counters.inequality_solves > 1)
        .count();
    assert!(
        twice < counters.rebuilds,
        "{twice} of {}",
        counters.rebuilds
    );
    // most of the surface is out on average
    assert!(2 * counters.screened_points > levels.len() * levels[0].points.len());
}
