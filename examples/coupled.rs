//! Two programs in one: heat flows through a brake block that friction warms; warm it expands and presses harder.
//!
//! The block is held at its back and rubs on a rail. After each step the heat of friction enters a column of
//! temperatures, in which it flows by finite differences; these load the next step.

use signorini::prelude::*;

/// Height of the block, m, and its base, m².
const HEIGHT: f64 = 0.05;
const AREA: f64 = 0.1 * 0.05;
/// Coefficient of friction, speed of the rail, m/s, and length of a step, s.
const FRICTION: f64 = 0.3;
const SPEED: f64 = 0.1;
const STEP: f64 = 3.0;
/// Young's modulus, Pa, thermal expansion, 1/K, heat capacity, J/(m³ K), conductivity, W/(m K).
const YOUNG: f64 = 1.5e9;
const EXPANSION: f64 = 3e-5;
const CAPACITY: f64 = 2e6;
const CONDUCTIVITY: f64 = 2.0;
/// How far the cold block is pressed, m.
const OVERLAP: f64 = 1e6 * HEIGHT / YOUNG;
/// Layers of the column.
const LAYERS: usize = 10;

fn main() -> Result<(), Error> {
    println!("  t in s  normal in N  heat in J  at the rail in K");
    let forces = run(20)?;
    let growth = (forces[forces.len() - 1] / forces[0]).ln() / (STEP * (forces.len() - 1) as f64);
    println!(
        "the force grows by {growth:.4}/s, as stiffness and heat tell by {:.4}/s",
        rate(forces[0])
    );
    Ok(())
}

/// Normal forces after each step, N.
pub fn run(steps: usize) -> Result<Vec<f64>, Error> {
    let mesh = Brick::new([0.1, 0.05, HEIGHT], [12, 6, 6]).build()?;
    let heights: Vec<f64> = mesh.points().iter().map(|p| p[2]).collect();
    let end = STEP * steps as f64;
    let moves = History::ramp(end, SPEED * end)?;
    let rail = Contact::rigid(brick::Z_MIN).with_gap(-OVERLAP);
    let rail = rail
        .with_friction(Friction::coulomb(FRICTION))
        .with_motion([1.0, 0.0, 0.0], moves);
    let scene = Scene::new(mesh, Materials::uniform(Hooke::isotropic(YOUNG, 0.3)?))
        .with_support(Support::fixed(brick::Z_MAX))
        .with_contact(rail)
        .with_analysis(Analysis::quasistatic(end, steps));
    let mut simulation = Simulation::new(scene, Settings::default())?;
    let (mut column, mut forces) = ([0.0; LAYERS], Vec::new());
    while !simulation.is_finished() {
        // a mean of each layer, taken at its middle
        let at = |z: &f64| interpolated(&column, z / HEIGHT * LAYERS as f64 - 0.5);
        let warm = Eigenstrain::expansion(EXPANSION).with_factors(heights.iter().map(at).collect());
        // matrices, contact and the state stay as they are
        simulation.set_loads(vec![Load::eigenstrain(warm)])?;
        let result = simulation.step()?;
        result.require_converged()?;
        let force = result.summary().normal_force;
        let heat = FRICTION * force.abs() * SPEED * STEP;
        flow(&mut column, heat);
        println!("{:>8.1} {force:>12.1} {heat:>10.1} {:>17.1}", result.time(), column[0]);
        forces.push(force.abs());
    }
    Ok(forces)
}

/// Growth of the force, 1/s, of a block that keeps all heat: by friction times speed, by what a joule lengthens it, and
/// by its stiffness, which the force on the cold block tells.
pub fn rate(cold: f64) -> f64 {
    let longer = EXPANSION / (CAPACITY * AREA);
    FRICTION * SPEED * longer * cold / OVERLAP
}

/// A step of heat flow; the back of the block is insulated.
fn flow(column: &mut [f64; LAYERS], heat: f64) {
    let layer = HEIGHT / LAYERS as f64;
    let before = *column;
    let passes = CONDUCTIVITY * STEP / (layer * layer * CAPACITY);
    for k in 1..LAYERS {
        let passing = passes * (before[k - 1] - before[k]);
        column[k - 1] -= passing;
        column[k] += passing;
    }
    column[0] += heat / (AREA * layer * CAPACITY);
}

fn interpolated(column: &[f64; LAYERS], place: f64) -> f64 {
    let place = place.clamp(0.0, (LAYERS - 1) as f64);
    let low = (place as usize).min(LAYERS - 2);
    let part = place - low as f64;
    (1.0 - part) * column[low] + part * column[low + 1]
}
