//! The methods on the benchmark with n = 1 and where they are hard put: the same forces, certified, and products within
//! bands.

use crate::common::*;
use signorini_qp::ActiveSetSettings;

// Bands of products around what was measured (loading b, c): a quarter for the paper's methods, whose counts follow
// rounding, an eighth for the default. A count below is too good to be true (products that are no longer counted).
const PAPER: [usize; 2] = [11744, 11240];
const ONE_LOOP: [usize; 2] = [8874, 8381];
const FACE: [usize; 2] = [639, 685];

fn is_near(found: usize, measured: usize, part: usize) -> bool {
    found.abs_diff(measured) <= measured / part
}

#[test]
fn all_methods_agree_in_every_step() {
    for history in [ramp(), up_down_up()] {
        let [default, paper, one_loop] = methods().map(|m| run(benchmark(history.clone(), 10), by(m)).1);
        for (name, other) in [("paper", &paper), ("one-loop", &one_loop)] {
            for (k, (a, b)) in default.iter().zip(other).enumerate() {
                let (x, y) = (&a.summary, &b.summary);
                let parts = [
                    ("nodal forces", forces(&a.points), forces(&b.points)),
                    ("normal force", vec![x.normal_force], vec![y.normal_force]),
                    ("friction force", x.friction_force.to_vec(), y.friction_force.to_vec()),
                    ("displacement", a.displacement.clone(), b.displacement.clone()),
                ];
                for (what, p, q) in parts {
                    let d = distance(&p, &q);
                    assert!(d <= 1e-5, "{name}, step {k}, {what}: {d:e}");
                }
                assert_eq!(x.active, y.active, "{name}, step {k}");
            }
        }
        assert!(default.iter().any(|l| l.summary.stick > 0) && default.iter().any(|l| l.summary.slip > 0));
    }
}

/// Products of all 50 steps, and steps that the active-set method handed to the fall-back.
fn products(history: History, method: Method) -> (usize, usize) {
    let (simulation, results) = run(benchmark(history, 50), by(method));
    let fallbacks = results.iter().filter(|l| l.report.fallback).count();
    let sum: usize = results.iter().map(|l| l.report.counters.products).sum();
    assert_eq!(sum, simulation.counters().products);
    (sum, fallbacks)
}

/// The paper's n_m of Table 6.1 are 17798 and 18194.
#[test]
fn the_papers_method_stays_below_the_papers_products() {
    for (history, measured) in [ramp(), up_down_up()].into_iter().zip(PAPER) {
        let (found, _) = products(history, Method::paper());
        assert!(is_near(found, measured, 4), "{found}, not {measured}");
    }
}

#[test]
fn the_default_method_needs_a_twentieth_of_the_papers_products() {
    for (history, measured) in [ramp(), up_down_up()].into_iter().zip(FACE) {
        let (found, fallbacks) = products(history, Method::default());
        assert!(is_near(found, measured, 8), "{found}, not {measured}");
        assert_eq!(fallbacks, 0);
    }
}

#[test]
fn the_one_loop_stays_below_the_papers_products() {
    for (history, measured) in [ramp(), up_down_up()].into_iter().zip(ONE_LOOP) {
        let (found, _) = products(history, Method::one_loop());
        assert!(is_near(found, measured, 4), "{found}, not {measured}");
    }
}

/// Where all loads are gone for a while there is nothing that errors could be relative to but what was there before.
#[test]
fn steps_without_loads_are_solved_by_all_methods() {
    let course = History::table(vec![(0.0, 0.0), (0.4, 1.0), (0.8, 0.0), (1.6, 0.0), (2.0, 1.0)]).expect("table");
    for (coefficient, most) in [(0.0, 130), (0.3, 1000)] {
        for method in methods() {
            for extrapolate in [true, false] {
                let load = Load::traction(brick::Z_MAX, [0.0, 0.0, -1e4]).with_history(course.clone());
                let floor = Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(coefficient));
                let scene = Scene::new(block([2.0, 1.0, 1.0], [6, 3, 3]), uniform(1e6, 0.3))
                    .with_support(Support::fixed(brick::X_MIN))
                    .with_load(load)
                    .with_contact(floor)
                    .with_boxes([2, 1, 1])
                    .with_analysis(Analysis::quasistatic(2.0, 10));
                let (_, results) = run(scene, by(method.clone()).with_extrapolation(extrapolate));
                let products: Vec<usize> = results.iter().map(|r| r.report.counters.products).collect();
                println!("{} {coefficient} {extrapolate}: {products:?}", method.kind());
                assert!(products[3..8].iter().all(|p| *p <= most), "{products:?}");
            }
        }
    }
}

/// Six decades of accuracy: 2.7 times the products.
#[test]
fn accuracy_is_not_dear() {
    let [loose, tight] = [1e-4, 1e-10].map(|tolerance| {
        let settings = at(tolerance);
        let mut simulation = Simulation::new(benchmark(ramp(), 50), settings).expect("set-up");
        while !simulation.is_finished() {
            simulation.step().expect("step");
        }
        simulation.counters().products
    });
    assert!(is_near(loose, 409, 8), "{loose}");
    assert!(10 * tight <= 27 * loose, "{tight} and {loose}");
}

/// The loads at t = 1 are the same, the states are not: friction remembers.
#[test]
fn the_state_at_the_end_depends_on_the_loading_history() {
    let last = |history| {
        run(benchmark(history, 50), by(Method::default()))
            .1
            .pop()
            .expect("steps")
    };
    let (b, c) = (last(ramp()), last(up_down_up()));
    assert_eq!(b.load, c.load);
    let friction = |l: &Solved| -> Vec<f64> { l.points.iter().flat_map(|p| p.friction_force).collect() };
    let normal = |l: &Solved| -> Vec<f64> { l.points.iter().map(|p| p.normal_force).collect() };
    let (t, n, u) = (
        distance(&friction(&b), &friction(&c)),
        distance(&normal(&b), &normal(&c)),
        distance(&b.displacement, &c.displacement),
    );
    println!("relative differences: friction {t:.3}, normal {n:.3}, displacement {u:.2e}");
    // far above the accuracy of 1e-6
    assert!(t > 0.05 && n > 1e-3 && u > 1e-4, "{t:e} {n:e} {u:e}");
}

/// A body that its support lowers until it just touches, and lifts again: normal forces are rounding errors there, and
/// slip bounds follow them. Each method solves each step.
#[test]
fn a_body_that_just_touches_is_solved_by_every_method() {
    let down = History::table(vec![(0.0, 0.0), (0.5, 1.0), (0.8, 0.2), (1.0, 1.1)]);
    let down = down.expect("table");
    for method in methods() {
        for friction in [0.0, 0.3] {
            for steps in [5, 10, 15, 20, 40] {
                let down = down.clone();
                let scene = Scene::new(block([2.0, 1.0, 1.0], [4, 2, 2]), uniform(1e9, 0.3))
                    .with_support(Support::fixed(brick::Z_MAX).with_motion([2e-4, 1e-4, -1e-3], down))
                    .with_contact(
                        Contact::rigid(brick::Z_MIN)
                            .with_gap(4e-4)
                            .with_friction(Friction::coulomb(friction)),
                    )
                    .with_boxes([2, 1, 1])
                    .with_analysis(paper_steps(1.0, steps));
                // converged, certificates at most 1e-6
                run(scene, by(method.clone()));
            }
        }
    }
}

fn soft_part(ratio: f64, friction: Friction) -> Scene {
    let mesh = block([3.0, 1.0, 1.0], [9, 3, 3]);
    let regions = (0..mesh.tets().len())
        .map(|t| {
            let x = mesh.tet_points(t).iter().map(|p| p[0]).sum::<f64>() / 4.0;
            u32::from(x > 1.0 && x < 2.0)
        })
        .collect();
    let hooke = |young| Hooke::isotropic(young, 0.277).expect("material");
    let materials = Materials::new(vec![(0, hooke(1e3)), (1, hooke(1e3 / ratio))]);
    Scene::new(
        mesh.with_regions(regions).expect("regions"),
        materials.expect("materials"),
    )
    .with_support(Support::fixed(brick::X_MIN))
    .with_load(Load::traction(brick::Z_MAX, [0.1, 0.0, -1.0]))
    .with_contact(Contact::rigid(brick::Z_MIN).with_friction(friction))
    .with_boxes([3, 1, 1])
}

/// One step: status, certificate, products, whether SMALSE had to help.
fn soft_part_solved(ratio: f64, friction: Friction) -> (StepStatus, f64, usize, bool) {
    let scene = soft_part(ratio, friction);
    let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
    let frame = simulation.step().expect("step");
    let report = frame.report();
    (
        report.status,
        frame.certificate().largest(),
        report.counters.products,
        report.fallback,
    )
}

#[test]
fn jumps_on_interfaces_are_solved() {
    for (ratio, friction, products) in JUMPS {
        let law = if friction > 0.0 { Friction::coulomb(friction) } else { Friction::None };
        let (status, certificate, found, fallback) = soft_part_solved(ratio, law);
        let what = format!("ratio {ratio:e}, F {friction}: {found} products, certificate {certificate:e}");
        println!("{what}, fallback {fallback}");
        assert!(status.converged() && certificate <= 1e-5, "{what}");
        assert!(!fallback && found <= products, "{what}");
    }
}

/// Ratio, coefficient of friction, most products.
const JUMPS: [(f64, f64, usize); 6] = [
    (1e1, 0.3, 60),
    (1e3, 0.0, 60),
    (1e3, 0.3, 60),
    (1e6, 0.0, 60),
    (1e6, 0.3, 60),
    (1e9, 0.3, 60),
];

/// The fall-back says no in time.
#[test]
fn the_fall_back_is_bounded() {
    let limit = 50;
    let few = Method::ActiveSet(ActiveSetSettings::default().with_max_active_sets(1));
    let settings = by(few).with_max_fallback_products(limit);
    let scene = soft_part(1e6, Friction::coulomb(0.3));
    let mut simulation = Simulation::new(scene, settings).expect("set-up");
    let frame = simulation.step().expect("step");
    let report = frame.report();
    assert!(report.fallback);
    assert_eq!(report.status, StepStatus::IterationLimit);
    // the last step of KPRGP is finished
    assert!(
        (1..=limit + 10).contains(&report.fallback_products),
        "{}",
        report.fallback_products
    );
}

/// A block that is pressed on the floor below it, and not any more from `t = 0.5` on.
fn unloaded(gap: f64, friction: Friction) -> Scene {
    let history = History::table(vec![(0.0, 0.0), (0.3, 1.0), (0.5, 0.0), (1.0, 0.0)]);
    let hooke = Hooke::isotropic(1e3, 0.3).expect("material");
    Scene::new(block([2.0, 1.0, 1.0], [6, 3, 3]), Materials::uniform(hooke))
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::traction(brick::Z_MAX, [0.2, 0.0, -1.0]).with_history(history.expect("history")))
        .with_contact(Contact::rigid(brick::Z_MIN).with_gap(gap).with_friction(friction))
        .with_boxes([2, 1, 1])
        .with_analysis(paper_steps(1.0, 10))
}

#[test]
fn a_body_that_is_unloaded_again_converges_in_few_products() {
    for (gap, friction, most) in [
        (1e-3, Friction::None, 130),
        (1e-3, Friction::coulomb(0.3), 170),
        (0.0, Friction::coulomb(0.3), 180),
    ] {
        // `run` asks every step for a certificate of 1e-6
        let (simulation, results) = run(unloaded(gap, friction), Settings::default());
        let products = simulation.counters().products;
        println!("gap {gap}: {products} products");
        assert!(results.iter().all(|l| !l.report.fallback));
        assert!(products <= most, "{products}");
    }
}

/// A block that its upper side presses on a larger one, moves along it and lifts until it rests there without a force.
/// On the way to rest circles grow from nothing; a set with their points free led astray: 507, 621 and 392 products in
/// the last step.
#[test]
fn a_block_lifted_to_rest_converges_in_few_products() {
    for (order, cells) in [
        (1, [[7, 7, 2], [5, 6, 3]]),
        (2, [[7, 7, 2], [4, 5, 3]]),
        (2, [[6, 6, 2], [5, 6, 3]]),
    ] {
        let low = block([4.0, 4.0, 1.0], cells[0]);
        let up = block([2.0, 2.4, 1.5], cells[1]).map_points(|[x, y, z]| [x + 1.0, y + 0.8, z + 1.0]);
        let mut mesh = with_second(&low, &up.expect("moved"));
        if order == 2 {
            mesh = mesh.raise_order().expect("quadratic");
        }
        let over = |values: [f64; 5]| {
            let times = [0.0, 0.25, 0.5, 0.75, 1.0];
            History::table(times.into_iter().zip(values).collect()).expect("history")
        };
        let top = |held| Support::components(second(brick::Z_MAX), held);
        let scene = Scene::new(mesh, uniform(2e11, 0.3))
            .with_support(Support::fixed(brick::Z_MIN))
            .with_support(top([true, true, false]).with_motion([2e-3, 0.0, 0.0], over([0.0, 0.0, 1.0, 1.0, 1.0])))
            .with_support(top([false, false, true]).with_motion([0.0, 0.0, -1e-3], over([0.0, 1.0, 1.0, 0.5, 0.0])))
            .with_contact(Contact::between(second(brick::Z_MIN), brick::Z_MAX).with_friction(Friction::coulomb(0.2)))
            .with_analysis(Analysis::quasistatic(1.0, 4));
        let (_, results) = run(scene, Settings::default());
        let products: Vec<usize> = results.iter().map(|r| r.report.counters.products).collect();
        let what = format!("order {order}: {products:?} products");
        println!("{what}");
        assert!(
            results[3].summary.normal_force < 1e-6 * results[2].summary.normal_force,
            "{what}"
        );
        assert!(results.iter().all(|r| !r.report.fallback), "{what}");
        assert!(products[3] <= 150, "{what}");
    }
}

/// A sheet that is clamped at one end, and whose other end comes down on the floor below it: forces gather in one line.
/// Without the path of compliant constraints the first touch takes 1,091 to 14,700 products.
#[test]
fn sheets_that_bend_down_touch_in_few_products() {
    for (size, cells, mu, most) in [
        ([1.0, 1.0, 0.05], [20, 20, 2], 0.0, 200),
        ([1.0, 1.0, 0.05], [20, 20, 2], 0.3, 230),
        ([1.0, 0.2, 0.02], [50, 10, 1], 0.0, 370),
        ([1.0, 0.2, 0.02], [50, 10, 1], 0.3, 420),
    ] {
        let [length, _, thickness] = size;
        let pressure = 1e11 * f64::powi(thickness / length, 4);
        let ramp = History::ramp(1.0, 1.0).expect("history");
        let floor = Contact::rigid(brick::Z_MIN).with_gap(0.05 * thickness);
        let scene = Scene::new(block(size, cells), uniform(2e11, 0.3))
            .with_support(Support::fixed(brick::X_MIN))
            .with_load(Load::pressure(brick::Z_MAX, pressure).with_history(ramp.clone()))
            .with_load(Load::traction(brick::X_MAX, [2.0 * pressure, 0.0, 0.0]).with_history(ramp))
            .with_contact(floor.with_friction(match mu {
                0.0 => Friction::None,
                _ => Friction::coulomb(mu),
            }))
            .with_analysis(Analysis::quasistatic(1.0, 4));
        let (simulation, results) = run(scene, Settings::default());
        let first = results[0].report.counters.products;
        let what = format!(
            "{size:?}, coefficient {mu}: {first} of {:?}",
            simulation.counters().products
        );
        println!("{what}");
        assert!(results.iter().all(|l| !l.report.fallback), "{what}");
        assert_eq!(results[0].summary.active, cells[1] + 1, "{what}: the end touches");
        assert!(first <= most, "{what}");
    }
}

/// A plate of 50 times its thickness that a load presses on the floor below it, most of it: forces that pull, cut off
/// and back again on every set, took 8,000 products in a step, and more than 20,000 with quadratic elements. A load
/// that stays changes nothing in later steps.
#[test]
fn plates_that_lie_down_are_solved_on_few_sets() {
    for (order, cells, mu, most) in [(1, 32, 0.0, 500), (2, 16, 0.0, 700), (2, 16, 0.3, 900)] {
        let mesh = block([1.0, 1.0, 0.02], [cells, cells, 1]);
        let mesh = if order == 2 { mesh.raise_order().expect("quadratic") } else { mesh };
        let floor = Contact::rigid(brick::Z_MIN).with_gap(1e-4);
        let mut scene = Scene::new(mesh, uniform(2e11, 0.3))
            .with_support(Support::fixed(brick::X_MIN))
            .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -1e4]))
            .with_analysis(Analysis::quasistatic(1.0, 3));
        scene = match mu {
            0.0 => scene.with_contact(floor),
            _ => {
                let ramp = History::ramp(1.0, 1.0).expect("history");
                scene
                    .with_load(Load::traction(brick::X_MAX, [0.0, 1e5, 0.0]).with_history(ramp))
                    .with_contact(floor.with_friction(Friction::coulomb(mu)))
            }
        };
        let (_, results) = run(scene, Settings::default());
        let products: Vec<usize> = results.iter().map(|r| r.report.counters.products).collect();
        let what = format!("order {order}, coefficient {mu}: {products:?} products");
        println!("{what}");
        assert!(results.iter().all(|r| !r.report.fallback), "{what}");
        assert!(products.iter().all(|p| *p <= most), "{what}");
        assert!(mu > 0.0 || products[1..].iter().all(|p| *p <= 3), "{what}");
    }
}

/// Three rows of a floor and three of supports balance the six motions of a body: nothing is left of the norm of F on
/// what they do not determine but rounding, with which the paper's methods began.
#[test]
fn forces_that_balance_alone_determines_are_found() {
    let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.2, 0.3, 1.0]];
    let tag = FacetTag(1);
    let bottom = Facet { nodes: [0, 2, 1], tag };
    let mesh = TetMesh::new(points, vec![[0, 1, 2, 3]], vec![bottom]).expect("mesh");
    let scene = Scene::new(mesh, uniform(1e9, 0.3))
        .with_support(Support::components(vec![0], [true, true, false]))
        .with_support(Support::components(vec![1], [false, true, false]))
        .with_contact(Contact::rigid(tag))
        .with_load(Load::new(LoadDensity::NodalForces(vec![(3, [0.0, 0.0, -6.0])])))
        .without_subdomains();
    for method in methods() {
        let found = solve(scene.clone(), by(method.clone()));
        let forces: Vec<f64> = found.points.iter().map(|p| -p.normal_force).collect();
        for (found, expected) in forces.iter().zip([3.0, 1.2, 1.8]) {
            assert!((found - expected).abs() < 1e-6, "{}: {forces:?}", method.kind());
        }
        assert!(
            found.report.counters.products <= 40,
            "{}: {}",
            method.kind(),
            found.report.counters.products
        );
    }
}
