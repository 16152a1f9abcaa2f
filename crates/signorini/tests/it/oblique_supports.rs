//! Supports oblique to a contact surface with friction: their rows and those of the contact depend on one another.

use signorini::prelude::*;

/// Bricks of so much stiffness, apart from one another, each pressed on a floor, its foot guided along a random oblique
/// direction, in coordinates turned about (1, 1, 1).
fn scene(k: u64, angle: f64, (copies, stiffness): (u32, f64)) -> Result<Scene, Error> {
    // numbers in [-1, 1]
    let mut state = k.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x5bf0_3635;
    let mut next = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    let mesh = Brick::new([2.0, 1.0, 1.0], [4, 2, 1 + (k % 2) as usize]).build()?;
    let on = |t: FacetTag| mesh.nodes_on(t);
    let top = on(brick::Z_MAX);
    let below = |t: FacetTag| on(t).into_iter().filter(|n| !top.contains(n));
    let all = |one: &[u32]| -> Vec<u32> {
        let nodes = mesh.points().len() as u32;
        (0..copies)
            .flat_map(|copy| one.iter().map(move |n| n + copy * nodes))
            .collect()
    };
    let foot = all(&below(brick::X_MIN).collect::<Vec<u32>>());
    let oblique = [1.0, 0.4 * next(), 0.4 * next()];
    let d = 1e-3;
    let turn = |v: [f64; 3]| {
        let (sin, cos) = (angle.sin() / 3f64.sqrt(), angle.cos());
        let mean = (v[0] + v[1] + v[2]) / 3.0 * (1.0 - cos);
        [0, 1, 2].map(|c| cos * v[c] + mean + sin * (v[(c + 2) % 3] - v[(c + 1) % 3]))
    };
    let friction = if k % 5 == 1 {
        Friction::tresca(1e-3 * stiffness)
    } else if k.is_multiple_of(3) {
        Friction::tresca(2e-5 * stiffness * (1.0 + next()))
    } else {
        Friction::coulomb(0.35 + 0.2 * next())
    };
    let down = [0.0, d * next(), -d * (0.6 + 0.4 * next())];
    let mut contact = Contact::rigid(brick::Z_MIN).with_gap(2e-4).with_friction(friction);
    if k.is_multiple_of(2) {
        let way = [0.3 * d * next(), 0.3 * d * next(), 0.3 * d * next()];
        contact = contact.with_motion(turn(way), History::constant(1.0));
    }
    let hold = all(&below(brick::X_MAX).take(2).collect::<Vec<u32>>());
    let along = |v: &[[f64; 3]]| Directions::Vectors(v.iter().map(|v| turn(*v)).collect());
    let press = along(&[[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    let swing = History::function(|t| (6.0 * t).sin());
    let steel = Materials::uniform(Hooke::isotropic(stiffness, 0.3)?);
    let mut bodies = mesh.clone();
    for copy in 1..copies {
        bodies = bodies.append(&mesh.clone().map_points(|[x, y, z]| [x, y + 3.0 * f64::from(copy), z])?)?;
    }
    let top = all(&top);
    Ok(Scene::new(bodies.map_points(turn)?, steel)
        .with_support(Support::partial(foot, along(&[oblique])))
        .with_support(Support::partial(top, press).with_motion(turn(down), swing))
        .with_support(Support::partial(hold, along(&[[1.0, 0.0, 0.0]])))
        .with_contact(contact)
        .with_analysis(Analysis::quasistatic(1.0, 5).with_formula(DifferenceFormula::PAPER)))
}

/// Six that ended at certificates of 1e-4 to 1e-2: points that stuck where the support moves them were put on their
/// circles against their slip, whatever their forces were, and the next active set took them back. Of several bodies,
/// which are solved in units of force of their own, those that are stiff did the same.
#[test]
fn points_that_a_support_moves_along_the_obstacle_slide() -> Result<(), Error> {
    for k in [26, 51, 211, 362, 531, 551] {
        for (angle, bodies) in [(0.0, (1, 1e9)), (0.7, (1, 1e9)), (0.7, (2, 1e15))] {
            let mut simulation = Simulation::new(scene(k, angle, bodies)?, Settings::default())?;
            while !simulation.is_finished() {
                let frame = simulation.step()?;
                let status = frame.report().status;
                let certificate = frame.certificate().largest();
                let place = format!("scene {k}, turned by {angle}, level {}", frame.step());
                assert_eq!(status, StepStatus::Converged, "{place}: {certificate:.1e}");
            }
        }
    }
    Ok(())
}
