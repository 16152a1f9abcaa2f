//! The shoe of a drum brake: a rigid shoe that turns about a pivot, with a lining that gives way, pressed to a drum.
//!
//! A turn about the pivot presses each point by its moment arm, so that moments about the pivot give the torque in
//! closed form (as of internal shoes in textbooks on machine elements). Friction on the trailing shoe takes pressure
//! away, the more the larger it is: with a moment larger than that of the pressure, slip bounds that follow pressures
//! that follow slip bounds swing ever wider.

use crate::common::*;

const RADIUS: f64 = 100.0;
const INNER: f64 = 80.0;
/// Half the angle of the shoe.
const HALF: f64 = std::f64::consts::FRAC_PI_3;
const PUSH: f64 = 1000.0;

fn place(radius: f64, angle: f64, z: f64) -> [f64; 3] {
    [radius * angle.cos(), radius * angle.sin(), z]
}

fn shoe((young, cells): (f64, usize), coefficient: f64, turn: f64) -> Scene {
    let straight = block([1.0, 1.0, 20.0], [2, cells, 2]);
    let mesh = straight.map_points(|[x, y, z]| place(INNER + x * (RADIUS - INNER), HALF * (2.0 * y - 1.0), z));
    let mesh = mesh.expect("mesh");
    let at_pivot = |x: &[f64; 3]| distance(&x[..2], &place(INNER, -HALF, 0.0)[..2]) < 1e-9;
    let pivot: Vec<u32> = (0..)
        .zip(mesh.points())
        .filter(|p| at_pivot(p.1))
        .map(|p| p.0)
        .collect();
    let drum = Obstacle::cylinder([0.0; 3], [0.0, 0.0, 1.0], RADIUS).hollow();
    let times = |a, b| History::table(vec![(0.0, 0.0), (1.0, a), (2.0, b)]).expect("history");
    let lining = Contact::obstacle(brick::X_MAX, drum)
        .with_normal_compliance(0.1)
        .with_friction(Friction::coulomb(coefficient))
        .with_rotation([0.0; 3], [0.0, 0.0, 1.0], times(0.0, turn));
    Scene::new(mesh, uniform(young, 0.3))
        .with_support(Support::fixed(pivot))
        .with_load(Load::force(brick::Y_MAX, [PUSH, 0.0, 0.0]).with_history(times(1.0, 1.0)))
        .with_contact(lining)
        .with_analysis(Analysis::quasistatic(2.0, 4))
}

/// Torque of the drum on a rigid shoe with these places and areas of its points, for friction along `sense`.
fn torque(scene: &Scene, points: &[PointState], friction: f64) -> f64 {
    let pivot = place(INNER, -HALF, 0.0);
    let turn = |arm: [f64; 2], force: [f64; 2]| arm[0] * force[1] - arm[1] * force[0];
    let (mut moment, mut torque) = (0.0, 0.0);
    for point in points {
        let x = scene.mesh().points()[point.node as usize];
        let ([nx, ny], arm) = ([x[0] / RADIUS, x[1] / RADIUS], [x[0] - pivot[0], x[1] - pivot[1]]);
        let pressed = turn(arm, [-nx, -ny]).abs() * point.area;
        let rubbed = [-friction * pressed * ny, friction * pressed * nx];
        moment += turn(arm, [rubbed[0] - pressed * nx, rubbed[1] - pressed * ny]);
        torque += turn([x[0], x[1]], rubbed);
    }
    let middle = place(0.5 * (INNER + RADIUS), HALF, 0.0);
    let push = turn([middle[0] - pivot[0], middle[1] - pivot[1]], [PUSH, 0.0]);
    -push / moment * torque
}

#[test]
fn the_torque_of_a_shoe_whatever_friction_takes_away() {
    // moments of friction over those of pressure: -0.36, 0.36, 1.07, 1.42
    for (coefficient, sense) in [(0.3, -1.0), (0.3, 1.0), (0.9, 1.0), (1.2, 1.0)] {
        let (simulation, results) = run(shoe((1e7, 24), coefficient, 0.5 * sense), at(1e-8));
        for result in &results {
            assert_certified(result, &format!("{coefficient}, {sense}, {} s", result.time));
        }
        let last = &results[3];
        let scene = simulation.scene();
        let at = |p: &PointState| scene.mesh().points()[p.node as usize];
        let found: f64 = last.points.iter().map(|p| cross(at(p), p.force())[2]).sum();
        let expected = torque(scene, &last.points, coefficient * sense);
        assert!(
            (found / expected - 1.0).abs() < 1e-2,
            "{coefficient}, {sense}: {found}, not {expected}"
        );
        let dearest = results.iter().map(|r| r.report.counters.products).max();
        assert!(dearest <= Some(100), "{coefficient}, {sense}: {dearest:?} products");
    }
}

/// The drum turns from the third step on, and friction turns round with it: from there the line through the last two
/// steps led to the end as not held, though it changes nothing any more.
#[test]
fn a_stiff_shoe_is_held_after_friction_has_turned_round() {
    let (_, results) = run(shoe((1e9, 12), 1.2, 0.5), Settings::default());
    let [third, last] = [2, 3].map(|k: usize| results[k].summary.normal_force);
    assert!((last / third - 1.0).abs() < 1e-6, "{third}, then {last}");
    // another start comes before another method
    let report = &results[3].report;
    assert!(!report.fallback && report.counters.products < 1200, "{report:?}");
}
