//! Bodies that nothing holds: what the messages say, and with which numbers.

use crate::common::*;
use signorini_qp::{ActiveSetSettings, EqualityProjector};
use signorini_tfeti::ActiveSetProjector;

fn free(mesh: TetMesh) -> Scene {
    Scene::new(mesh, steel())
}

fn cube() -> Scene {
    free(block([1.0; 3], [2, 2, 2]))
}

fn refused_by(scene: Scene, settings: Settings) -> ContactError {
    Simulation::new(scene, settings).expect_err("refused")
}

fn refused(scene: Scene) -> ContactError {
    refused_by(scene, Settings::default())
}

/// Solved, body, motion, force.
fn not_held(scene: Scene) -> (usize, usize, String, f64) {
    let error = refused(scene);
    let text = error.to_string();
    match error {
        ContactError::NotHeld {
            step,
            body,
            mode,
            force,
            ..
        } => {
            assert!(
                text.contains(&format!("with a force of {force:.3e};")) && text.contains(&mode),
                "{text}"
            );
            (step, body, mode, force)
        }
        other => panic!("{other}"),
    }
}

fn close(found: f64, expected: f64) {
    assert!(
        (found - expected).abs() <= 1e-9 * expected,
        "{found:e}, not {expected:e}"
    );
}

/// Supports forgotten: the load of 1e7 N is said, with its direction.
#[test]
fn the_force_on_a_free_body_is_its_load() {
    for boxes in [[1, 1, 1], [2, 2, 1]] {
        let scene = cube().with_load(Load::pressure(brick::Z_MAX, 1e7)).with_boxes(boxes);
        let (result, body, mode, force) = not_held(scene);
        close(force, 1e7);
        assert_eq!(
            (result, body, mode.as_str()),
            (0, 0, "its translation (0.000, 0.000, -1.000)")
        );
    }
}

#[test]
fn the_force_is_that_of_the_step_at_which_it_acts() {
    let late = History::table(vec![(0.5, 0.0), (1.0, 1.0)]).expect("history");
    let scene = cube()
        .with_load(Load::traction(brick::X_MAX, [3e6, 4e6, 0.0]).with_history(late))
        .with_support(Support::components(brick::Z_MIN, [false, false, true]))
        .with_support(Support::components(brick::Y_MIN, [false, true, false]))
        .with_analysis(Analysis::quasistatic(1.0, 4));
    // y is held, x is not; at t = 0.75 half of it acts
    let (result, _, mode, force) = not_held(scene);
    close(force, 1.5e6);
    assert_eq!((result, mode.as_str()), (2, "its translation (1.000, 0.000, 0.000)"));
}

/// A couple of 1e6 N at distance 1 m: the moment is the force times the radius that the message names.
#[test]
fn a_couple_is_a_moment() {
    let scene = cube()
        .with_load(Load::traction(brick::X_MAX, [0.0, 1e6, 0.0]))
        .with_load(Load::traction(brick::X_MIN, [0.0, -1e6, 0.0]));
    let (_, _, mode, force) = not_held(scene);
    let radius = mode
        .strip_prefix("its rotation (0.000, 0.000, 1.000) at radius ")
        .and_then(|number| number.parse::<f64>().ok())
        .expect("radius");
    assert!((force * radius / 1e6 - 1.0).abs() < 1e-3, "{force:e} at {radius}");
}

/// Two cubes far from each other, each with its own load: the one with the larger load is named, with its load alone.
#[test]
fn of_two_bodies_the_one_pushed_most_is_named() {
    let one = block([1.0; 3], [2, 2, 2]);
    let count = one.points().len() as u32;
    let mut points = one.points().to_vec();
    points.extend(one.points().iter().map(|p| [p[0] + 5.0, p[1], p[2]]));
    let mut tets = one.tets().to_vec();
    tets.extend(one.tets().iter().map(|t| t.map(|n| n + count)));
    let mut facets = one.facets().to_vec();
    facets.extend(one.facets().iter().map(|f| Facet {
        nodes: f.nodes.map(|n| n + count),
        tag: FacetTag(f.tag.0 + 100),
    }));
    let parts = (0..tets.len()).map(|t| u32::from(t >= one.tets().len())).collect();
    let other = FacetTag(brick::Z_MAX.0 + 100);
    let scene = free(TetMesh::new(points, tets, facets).expect("mesh"))
        .with_parts_as_given(parts)
        .with_load(Load::pressure(brick::Z_MAX, 3e6))
        .with_load(Load::pressure(other, 4e6));
    let (_, body, mode, force) = not_held(scene);
    close(force, 4e6);
    assert_eq!((body, mode.as_str()), (1, "its translation (0.000, 0.000, -1.000)"));
}

/// What the friction cone cannot hold is the force: on a smooth floor all of the pull.
#[test]
fn on_a_smooth_floor_the_force_is_the_pull() {
    let scene = cube()
        .with_load(Load::pressure(brick::Z_MAX, 1e7))
        .with_load(Load::traction(brick::Z_MIN, [2e6, 0.0, 0.0]))
        .with_contact(Contact::rigid(brick::Z_MIN));
    let (_, _, mode, force) = not_held(scene);
    close(force, 2e6);
    assert_eq!(mode, "its translation (1.000, 0.000, 0.000)");
}

#[test]
fn without_forces_or_in_balance_the_motions_are_free() {
    let balanced = cube()
        .with_load(Load::pressure(brick::Z_MAX, 1e7))
        .with_load(Load::pressure(brick::Z_MIN, 1e7));
    let floor = cube()
        .with_load(Load::pressure(brick::Z_MAX, 1e7))
        .with_contact(Contact::rigid(brick::Z_MIN));
    let paper = by(Method::paper());
    let turning = cube().with_support(Support::fixed(vec![0]));
    for (scene, settings, expected) in [
        (cube(), Settings::default(), 6),
        (balanced, Settings::default(), 6),
        (turning, Settings::default(), 3),
        // the default method solves this one: the body rests where it is
        (floor, paper, 3),
    ] {
        let touches = !scene.contacts().is_empty();
        let error = refused_by(scene, settings);
        let text = error.to_string();
        match error {
            ContactError::NotDetermined { body, count, .. } => {
                assert_eq!((body, count), (0, expected))
            }
            other => panic!("{other}"),
        }
        assert!(
            text.contains("not determined") && text.contains("the loads are in balance"),
            "{text}"
        );
        assert!(text.contains(&format!("{expected} rigid motion")), "{text}");
        assert_eq!(text.contains("default method"), touches, "{text}");
        assert!(!text.contains("cannot be in equilibrium"), "{text}");
    }
}

/// Where the default method ends at a limit and the paper's cannot go on, since motions are free, the step has a
/// status. It was an error in the middle of the run.
#[test]
fn without_a_second_method_the_step_ends_with_its_status() {
    let scene = cube()
        .with_load(Load::pressure(brick::Z_MAX, 1e7))
        .with_load(Load::body([0.0, 0.0, -1e6]))
        .with_contact(Contact::rigid(brick::Z_MIN).with_gap_field(|x| 1e-4 * (x[0] - 0.3).powi(2)));
    let few = Method::ActiveSet(ActiveSetSettings::default().with_max_products(1));
    let mut simulation = Simulation::new(scene.clone(), by(few)).expect("set-up");
    let frame = simulation.step().expect("step");
    assert_eq!(frame.report().status, StepStatus::IterationLimit);
    assert!(!frame.report().fallback && frame.displacement().iter().flatten().all(|u| u.is_finite()));
    // with products enough it is solved
    assert!(solve(scene, Settings::default()).report.status.converged());
}

/// Given friction holds bounds times area whatever the pressure, and no more.
#[test]
fn loads_beyond_given_slip_bounds_are_refused() {
    let scene = |along: f64| {
        Scene::new(block([2.0, 1.0, 1.0], [4, 2, 2]), uniform(1e6, 0.3))
            .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::tresca(30.0)))
            .with_load(Load::pressure(brick::Z_MAX, 100.0))
            .with_load(Load::body([0.6 * along / 2.0, 0.8 * along / 2.0, 0.0]))
    };
    // 30 Pa on 2 m²: 60 N, and 200 N of pressure keep the block from tipping
    for along in [0.0, 20.0, 59.0] {
        let result = solve(scene(along), Settings::default());
        let held = result.summary.friction_force;
        assert!((norm(&held) - along).abs() < 1e-3, "{along}: {held:?}");
    }
    for along in [60.1, 90.0] {
        match Simulation::new(scene(along), Settings::default()) {
            Err(ContactError::NotHeld { mode, force, .. }) => {
                assert!(mode.contains("Tresca friction holds 6.000e1,"), "{mode}");
                assert!((force / along - 1.0).abs() < 1e-3, "{force}");
            }
            Err(error) => panic!("{error}"),
            Ok(_) => panic!("{along} accepted"),
        }
    }
}

/// Pulled with 4.1 kN where friction can hold 1.9 kN: the message says so, and how much is missing.
#[test]
fn a_pull_beyond_friction_is_named() {
    let refused = |friction, pull: [f64; 3], weight: f64| {
        let scene = cube()
            .with_contact(Contact::rigid(brick::Z_MIN).with_friction(friction))
            .with_load(Load::pressure(brick::Z_MAX, weight))
            .with_load(Load::traction(brick::Z_MIN, pull));
        match refused(scene) {
            error @ ContactError::NotHeld { friction, .. } => (error.to_string(), friction),
            error => panic!("{error}"),
        }
    };
    for (friction, weight) in [(Friction::coulomb(0.19), 1e4), (Friction::tresca(1.9e3), 1e5)] {
        let (text, factor) = refused(friction.clone(), [2.46e3, 3.28e3, 0.0], weight);
        let factor = factor.expect("friction could");
        assert!((factor / (4.1 / 1.9) - 1.0).abs() < 2e-4, "{factor}");
        assert!(text.contains("beyond what friction can hold"), "{text}");
        assert!(text.contains("more than 2.157 times as large"), "{text}");
        assert!(!text.contains("neither"), "{text}");
        // what friction cannot hold at all
        let (text, factor) = refused(friction, [4.1e3, 0.0, 1.5 * weight], weight);
        assert_eq!(factor, None);
        assert!(text.contains("held neither by supports nor by contact"), "{text}");
    }
}

/// Squeezed between two walls, a block is held by as much friction as it is pressed, which only the step can tell:
/// where it goes, and what is missing. That took 4,700 products; the fall-back ends where it does not come nearer to
/// balance.
#[test]
fn a_block_pulled_out_of_a_clamp_is_not_held() {
    let pulled = |traction: f64| {
        let wall = |tag| Contact::rigid(tag).with_friction(Friction::coulomb(0.2));
        let squeeze = wall(brick::Z_MAX).with_motion([0.0, 0.0, -1e-3], History::constant(1.0));
        let scene = Scene::new(block([1.0; 3], [4; 3]), uniform(1e9, 0.3))
            .with_contact(wall(brick::Z_MIN))
            .with_contact(squeeze)
            .with_load(Load::traction(brick::X_MAX, [traction, 0.0, 0.0]))
            .with_boxes([2; 3]);
        let mut simulation = Simulation::new(scene, Settings::default()).expect("friction may hold it");
        simulation.step().expect("step")
    };
    let held = pulled(3.5e5);
    assert!(held.report().status.converged() && held.report().slide.is_none());
    // both walls press with this force
    let normal = held.summary().normal_force;
    for load in [1.2, 3.0] {
        let out = pulled(0.2 * load * normal);
        let report = out.report();
        assert_eq!(report.status, StepStatus::NotHeld);
        assert_eq!(out.certificate().worst().0, "equilibrium");
        assert!(report.counters.products <= 1400, "{load}: {report:?}");
        let slide = report.slide.expect("it slides");
        assert!(slide.body == 0 && slide.translation[0] > 0.99, "{slide:?}");
        let missing = out.reactions().imbalance().force[0];
        assert!((slide.force / missing - 1.0).abs() < 1e-3, "{slide:?}, {missing}");
        // a block that is stretched is squeezed less
        let least = 0.2 * (load - 1.0) * normal;
        assert!(missing > least && missing < 1.2 * least, "{missing} of {least}");
        let text = out.failure().expect("failure").to_string();
        assert!(text.contains("slides away along its translation (1.000"), "{text}");
    }
}

/// A block between plates that close on it, without any load: nothing tells the size of forces before they touch. The
/// stress is that of a block squeezed without friction; with friction the forces of both plates balance.
#[test]
fn plates_that_close_press_what_no_load_does() {
    let ramp = History::ramp(1.0, 1.0).expect("ramp");
    for (gap, boxes, friction) in [
        (0.0, [1; 3], Friction::None),
        (0.0, [2, 1, 1], Friction::coulomb(0.3)),
        (0.6e-3, [1; 3], Friction::coulomb(0.3)),
        (0.6e-3, [2, 2, 1], Friction::None),
        (0.6e-3, [2, 2, 2], Friction::coulomb(0.3)),
    ] {
        let below = Contact::rigid(brick::Z_MIN).with_friction(friction.clone());
        let above = Contact::rigid(brick::Z_MAX)
            .with_gap(gap)
            .with_motion([0.0, 0.0, -1e-3], ramp.clone())
            .with_friction(friction.clone());
        let scene = free(block([1.0; 3], [4; 3]))
            .with_contact(below)
            .with_contact(above)
            .with_boxes(boxes)
            .with_analysis(Analysis::quasistatic(1.0, 2));
        let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
        for depth in [0.5e-3 - gap, 1e-3 - gap] {
            let result = simulation.step().expect("step");
            let (report, summary) = (result.report(), result.summary());
            assert!(
                report.status.converged() && result.certificate().largest() < 1e-6,
                "{report:?}"
            );
            assert!(
                report.counters.products <= 20,
                "{gap} {boxes:?}: {}",
                report.counters.products
            );
            // of both plates; friction hinders what the block grows by sideways
            let squeezed = 2.0 * 211.9e9 * depth.max(0.0);
            let more = if friction.is_some() { 1.1 } else { 1.0 + 1e-6 };
            let force = summary.normal_force;
            assert!(
                force >= squeezed * (1.0 - 1e-6) && force <= squeezed * more,
                "{force:e}, {squeezed:e}"
            );
        }
    }
}

/// Motions of a block along its smooth base have rows of exact zeros: not of rounding, as a turn about the normal has
/// in a body without symmetry, which would ask contact forces for a balance that they cannot give.
#[test]
fn motions_along_a_smooth_plane_have_no_rows() {
    let mesh = crate::mortar::blocks([3, 3, 2], [4, 2, 2], 1.0);
    let skew = |[x, y, z]: [f64; 3]| [1.3 * x + 0.21 * y, 0.7 * y + 0.1 * x + 0.3 * z, z];
    let scene = Scene::new(mesh.map_points(skew).expect("skew"), uniform(1e9, 0.3))
        .with_support(Support::fixed(brick::Z_MIN))
        .with_contact(Contact::between(second(brick::Z_MIN), brick::Z_MAX))
        .with_boxes([1, 1, 2]);
    let simulation = Simulation::new(scene, Settings::default()).expect("set-up");
    let system = simulation.tfeti();
    let contact = system.gluing().ranges().contact().end;
    let projector = ActiveSetProjector::new(system.coarse(), contact, None).expect("a projector");
    let largest = |row: &[(usize, f64)]| row.iter().fold(0.0, |most: f64, (_, c)| most.max(c.abs()));
    let rows: Vec<f64> = projector.loose().iter().map(|mode| largest(&mode.row)).collect();
    assert_eq!(rows.iter().filter(|c| **c == 0.0).count(), 3, "{rows:?}");
    assert_eq!(rows.iter().filter(|c| **c > 1e-3).count(), 3, "{rows:?}");
}

/// Two cubes on each other, rough between, on a smooth floor: pushed at the top they go together.
#[test]
fn bodies_that_go_together_are_all_named() {
    let stack = |push: f64, between: f64| {
        let mesh = with_second(&block([1.0; 3], [2; 3]), &lifted(&block([1.0; 3], [2; 3]), 1.0));
        free(mesh)
            .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.1)))
            .with_contact(
                Contact::between(brick::Z_MAX, second(brick::Z_MIN)).with_friction(Friction::coulomb(between)),
            )
            .with_load(Load::pressure(second(brick::Z_MAX), 1e6))
            .with_load(Load::traction(second(brick::Z_MAX), [push, 0.0, 0.0]))
    };
    let (_, _, both, force) = not_held(stack(3e5, 0.9));
    assert!(
        both.contains("translation") && both.contains(", together with body "),
        "{both}, {force}"
    );
    // the upper one alone
    let (_, body, alone, _) = not_held(stack(3e5, 0.05));
    assert!(body == 1 && !alone.contains("together"), "{alone}");
}

/// The tag of a side of brick `k`.
fn of_brick(k: u32, tag: FacetTag) -> FacetTag {
    FacetTag(100 + 20 * k + tag.0)
}

/// Four bricks of 78 N in a row, apart by a gap, each on a floor of its own; they may touch.
fn row_of_bricks(cells: usize, gap: f64, floor: impl Fn(Contact) -> Contact) -> Scene {
    let brick = |k: u32| {
        let moved = block([0.1; 3], [cells; 3]).map_points(|[x, y, z]| [x + f64::from(k) * (0.1 + gap), y, z]);
        moved.expect("moved").map_tags(|tag| of_brick(k, tag))
    };
    let mesh = (1..4).fold(brick(0), |all, k| all.append(&brick(k)).expect("bodies"));
    let scene = Scene::new(mesh, uniform(2.1e11, 0.3)).with_load(Load::body([0.0, 0.0, -7.8e4]));
    let rough = |k| Contact::rigid(of_brick(k, brick::Z_MIN)).with_friction(Friction::coulomb(0.3));
    let scene = (0..4).fold(scene, |scene, k| scene.with_contact(floor(rough(k))));
    let pair = |k| Contact::between(of_brick(k, brick::X_MIN), of_brick(k - 1, brick::X_MAX));
    (1..4).fold(scene, |scene, k| scene.with_contact(pair(k)))
}

/// An iterate lifts them off the belt, and they were said to slide away, into it, for want of friction.
#[test]
fn bricks_ride_on_a_belt() {
    let (gap, way) = (2e-3, 1e-3);
    let ramp = || History::ramp(2.0, 1.0).expect("ramp");
    let scene = row_of_bricks(2, gap, |belt| belt.with_motion([way, 0.0, 0.0], ramp()))
        .with_contact(Contact::rigid(of_brick(3, brick::X_MAX)).with_gap(gap))
        .with_analysis(Analysis::quasistatic(2.0, 1));
    let result = solve(scene, Settings::default());
    assert!(result.report.counters.products <= 800, "{:?}", result.report);
    assert!((result.summary.normal_force - 4.0 * 78.0).abs() < 1e-4);
    assert!(result.displacement.iter().step_by(3).all(|u| (u - way).abs() < 1e-8));
}

/// The first one is moved, short of the next: the step begins again from where weight alone presses them.
#[test]
fn the_first_brick_of_a_row_is_pushed() {
    let ramp = History::ramp(1.0, 1.0).expect("ramp");
    let push = Support::components(of_brick(0, brick::X_MIN), [true, false, false]);
    let scene = row_of_bricks(4, 1e-3, |floor| floor)
        .with_support(push.with_motion([5e-4, 0.0, 0.0], ramp))
        .with_analysis(Analysis::quasistatic(1.0, 1));
    let (simulation, results) = run(scene, Settings::default());
    let result = &results[0];
    assert!(result.report.counters.products <= 400, "{:?}", result.report);
    let pushed = simulation.result().expect("a result").reactions().supports[0]
        .resultant
        .force[0];
    assert!((pushed / (0.3 * 78.0) - 1.0).abs() < 1e-6, "{pushed}");
}

/// What rounding leaves of normals along a plane stops no motion there: a stiff body that only slides, on a soft one,
/// is solved as soon as one that is held, wherever they are.
#[test]
fn a_motion_along_a_frictionless_plane_is_stopped_by_nothing() {
    let both = with_second(&block([1.0; 3], [3; 3]), &lifted(&block([1.0; 3], [2; 3]), 1.0));
    let (sin, cos) = 0.7_f64.sin_cos();
    for (by, turned) in [(0.0, false), (0.0, true), (1e4, true)] {
        let place = |[x, y, z]: [f64; 3]| {
            if turned { [cos * x + sin * z + by, y - by, cos * z - sin * x + by] } else { [x, y, z] }
        };
        let mesh = both.map_points(place).expect("a mesh");
        let up = if turned { [sin, 0.0, cos] } else { [0.0, 0.0, 1.0] };
        let regions = mesh.components();
        let law = |young| Hooke::isotropic(young, 0.3).expect("a law");
        let laws = Materials::new(vec![(0, law(1e2)), (1, law(2e5))]).expect("laws");
        let scene = Scene::new(mesh.with_regions(regions).expect("regions"), laws)
            .with_support(Support::fixed(brick::Z_MIN))
            .with_support(Support::partial(second(brick::Z_MAX), Directions::Vectors(vec![up])))
            .with_contact(Contact::between(second(brick::Z_MIN), brick::Z_MAX))
            .with_load(Load::traction(second(brick::Y_MIN), up.map(|c| -0.02 * c)));
        let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
        let result = simulation.step().expect("a step");
        assert!(
            result.report().status.converged(),
            "{by} {turned}: {}",
            result.report().status
        );
        assert!(
            result.report().counters.products <= 60,
            "{:?}",
            result.report().counters
        );
    }
}

/// A body that nothing presses is squeezed and bulges into the one below: it stands apart, at the first step and later.
#[test]
fn what_nothing_presses_stands_apart() {
    let both = with_second(&block([1.0; 3], [3; 3]), &lifted(&block([1.0; 3], [2; 3]), 1.0));
    let regions = both.components();
    let law = |young| Hooke::isotropic(young, 0.3).expect("a law");
    for stiff in [2e5, 1e2] {
        let laws = Materials::new(vec![(0, law(1e2)), (1, law(stiff))]).expect("laws");
        let scene = Scene::new(both.clone().with_regions(regions.clone()).expect("regions"), laws)
            .with_support(Support::fixed(brick::Z_MIN))
            .with_contact(Contact::between(second(brick::Z_MIN), brick::Z_MAX))
            .with_load(Load::pressure(second(brick::Y_MIN), 1.0).with_history(ramp()))
            .with_load(Load::pressure(second(brick::Y_MAX), 1.0).with_history(ramp()))
            .with_analysis(Analysis::quasistatic(1.0, 3));
        let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
        while !simulation.is_finished() {
            let result = simulation.step().expect("a step");
            assert!(
                result.report().status.converged(),
                "{stiff}: {}",
                result.report().status
            );
            let (products, points) = (result.report().counters.products, result.points());
            assert!(products <= 20, "{stiff}: {products}");
            assert!(points.iter().all(|p| p.normal_force.abs() < 1e-9), "{stiff}");
        }
    }
}
