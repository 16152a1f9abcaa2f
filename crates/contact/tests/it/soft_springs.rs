//! Soft springs, as those that hold bodies until they touch.

use crate::common::*;
use crate::springs::facets;

const YOUNG: f64 = 2e11;
const GROUND: f64 = 3e11;
const PRESSURE: f64 = 1e8;

/// Springs that are there to hold a body until it touches change nothing, and cost little: soft ones took 500 products
/// and the softest missed the certificate.
#[test]
fn soft_springs_change_nothing() {
    let block = |held: bool, friction: f64| {
        let load = Load::traction(brick::Z_MAX, [0.1 * PRESSURE, 0.03 * PRESSURE, -PRESSURE]);
        let scene = Scene::new(block([1.0; 3], [4; 3]), uniform(YOUNG, 0.3))
            .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(friction)))
            .with_load(load)
            .with_boxes([2; 3]);
        if held { scene.with_support(Support::fixed(brick::X_MIN)) } else { scene }
    };
    for (held, friction, most) in [(true, 1e-3, 60), (true, 0.3, 60), (false, 0.3, 60)] {
        let exact = solve(block(held, friction), at(1e-9));
        for exponent in [-4, -5, -6, -8, -10, -12, -14] {
            let what = format!("{held} {friction} 1e{exponent}");
            let springs = Spring::components(brick::X_MAX, [10f64.powi(exponent) * YOUNG; 3]);
            let result = solve(block(held, friction).with_spring(springs), Settings::default());
            assert_certified(&result, &what);
            let off = distance(&result.displacement, &exact.displacement);
            let products = result.report.counters.products;
            println!("{what}: {products} products, {off:e}");
            assert!(off < 1e-5 + 10f64.powi(exponent + 1), "{what}: {off:e}");
            assert!(products <= most, "{what}: {products}");
        }
    }
}

/// Friction that does not suffice leaves the rest to springs, however soft.
#[test]
fn soft_springs_stop_a_block_that_slides() {
    for exponent in [-2, -4, -6] {
        for direction in [[1.0, 0.0], [0.6, 0.8]] {
            let ground = 10f64.powi(exponent) * YOUNG;
            let load = Load::traction(
                brick::Z_MAX,
                [0.4 * direction[0], 0.4 * direction[1], -1.0].map(|f| f * PRESSURE),
            );
            let scene = Scene::new(block([1.0; 3], [3; 3]), uniform(YOUNG, 0.3))
                .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.3)))
                .with_spring(Spring::components(brick::X_MAX, [ground, ground, 0.0]))
                .with_load(load)
                .with_analysis(Analysis::quasistatic(1.0, 1));
            let what = format!("1e{exponent} {direction:?}");
            let (simulation, results) = run(scene, Settings::default());
            assert_certified(&results[0], &what);
            let springs = &simulation.result().expect("a step").reactions().springs[0];
            let force = springs.resultant.force;
            let taken = force[0].hypot(force[1]) / PRESSURE;
            println!("{what}: {taken} {} products", results[0].report.counters.products);
            // towards a corner the block turns, and friction with it
            let within = if direction[1] == 0.0 { 1e-3 } else { 0.02 };
            assert!((taken - 0.1).abs() < within, "{what}: {taken}");
        }
    }
}

/// A body that stands on soft springs and is dragged by friction with another one: they take no part in what friction
/// does, and cost no products. With stiff and soft parts, and alike, whatever the cut.
#[test]
fn soft_springs_beside_friction() {
    for (stiff, softness) in [1.0, 10.0]
        .into_iter()
        .flat_map(|s| [1e-2, 1e-6, 1e-12].map(|k| (s, k)))
    {
        let other = block([1.0; 3], [4; 3]).map_points(|x| [x[0] + 1.0, x[1], x[2]]);
        let mesh = with_second(&block([1.0; 3], [3; 3]), &other.expect("mesh"));
        let region = |t: usize| u32::from(mesh.tet_points(t).iter().all(|p| p[0] < 0.4));
        let regions = (0..mesh.tets().len()).map(region).collect();
        let law = |factor: f64| Hooke::isotropic(factor * YOUNG, 0.3).expect("Hooke");
        let materials = Materials::new(vec![(0, law(1.0)), (1, law(stiff))]).expect("materials");
        let motion = Support::fixed(second(brick::X_MAX)).with_motion([-2e-3, 3e-4, -1e-3], ramp());
        let scene = Scene::new(mesh.with_regions(regions).expect("regions"), materials)
            .with_support(Support::components(brick::Z_MIN, [true, true, false]))
            .with_spring(Spring::normal(brick::Z_MIN, softness * GROUND))
            .with_support(motion)
            .with_contact(Contact::between(second(brick::X_MIN), brick::X_MAX).with_friction(Friction::coulomb(0.3)))
            .with_analysis(Analysis::quasistatic(1.0, 3));
        let mut known: Option<Vec<f64>> = None;
        for boxes in [[1, 1, 1], [6, 1, 1]] {
            let what = format!("{stiff} {softness:e} {boxes:?}");
            let (simulation, results) = run(scene.clone().with_boxes(boxes), Settings::default());
            let products = simulation.counters().products;
            // 214 in one case: what springs miss is certified as a length, however soft they are
            assert!(products < 215, "{what}: {products}");
            let reactions = simulation.result().expect("a step").reactions();
            let lifted = reactions.springs[0].resultant.force[2];
            let dragged = reactions.contacts[0].force;
            assert!((lifted - dragged[2]).abs() < 1e-6 * dragged[0].abs(), "{what}");
            let u = &results[2].displacement;
            match &known {
                Some(known) => assert_close(u, known, 1e-4, &what),
                None => known = Some(u.clone()),
            }
        }
    }
}

/// What soft springs miss is told against the way on which they take all loads, however the solver scales their rows: by
/// up to a thousand.
#[test]
fn certificates_of_soft_springs_are_ways() {
    let ground = 1e-7 * GROUND;
    let scene = Scene::new(block([1.0; 3], [4; 3]), uniform(YOUNG, 0.3))
        .with_spring(Spring::components(brick::Z_MIN, [ground; 3]))
        .with_load(Load::traction(brick::Z_MAX, [1e5, 0.0, -1e5]))
        .with_boxes([2, 2, 2]);
    let mesh = scene.mesh().clone();
    let mut area = vec![0.0; mesh.points().len()];
    for (nodes, size, _) in facets(&mesh, brick::Z_MIN) {
        nodes.iter().for_each(|n| area[*n as usize] += size / 3.0);
    }
    let mut simulation = Simulation::new(scene, at(1e-2)).expect("set-up");
    let result = simulation.step().expect("step");
    let (u, mut largest) = (result.displacement(), 0.0_f64);
    let (told, forces) = (
        result.certificate().continuity,
        result.certificate().equilibrium.reference,
    );
    for held in &result.reactions().springs[0].nodes {
        for (u, force) in u[held.node as usize].iter().zip(held.force) {
            let stiffness = ground * area[held.node as usize];
            largest = largest.max((u + force / stiffness).abs() / (forces / stiffness));
        }
    }
    assert!(largest > 1e-12, "{largest:e} {told:?}");
    assert!(told.relative() >= 0.999 * largest, "{largest:e} {told:?}");
}

/// Springs along one direction leave others free: what rounding makes of these does not count.
#[test]
fn springs_of_one_direction_leave_the_others_free() {
    for exponent in [0, -4, -8, -12] {
        for friction in [Friction::None, Friction::coulomb(0.3)] {
            let scene = Scene::new(block([1.0; 3], [3; 3]), uniform(YOUNG, 0.3))
                .with_contact(Contact::rigid(brick::Z_MIN).with_friction(friction))
                .with_spring(Spring::normal(brick::Z_MAX, 10f64.powi(exponent) * YOUNG))
                .with_load(Load::body([0.0, 0.0, -PRESSURE]))
                .with_boxes([2, 1, 1]);
            let result = solve(scene, Settings::default());
            let products = result.report.counters.products;
            assert_certified(&result, &format!("1e{exponent}"));
            println!("1e{exponent}: {products}");
            assert!(products <= 100, "1e{exponent}: {products}");
        }
    }
}
