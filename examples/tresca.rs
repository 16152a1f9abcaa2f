//! Tresca friction: the slip bound is data, so that a step is one quadratic program.
//!
//! A brick lies on a floor, is pressed on its top and pulled at its end until all of it slides. The default method
//! and the paper's find the same forces.

use signorini::prelude::*;

/// Most friction stress that the floor bears, Pa.
const BOUND: f64 = 3e7;

fn main() -> Result<(), Error> {
    let mut pulls = Vec::new();
    for method in [Method::default(), Method::paper()] {
        println!("method {}", method.kind());
        println!("  t in s  products  stick  slip  normal in N  friction in N  dissipation in J  certificate");
        let settings = Settings::default().with_method(method).with_tolerance(1e-8);
        let mut simulation = Simulation::new(scene(BOUND)?, settings)?;
        let mut pull = 0.0;
        while !simulation.is_finished() {
            let result = simulation.step()?;
            result.require_converged()?;
            let (sum, certificate) = (result.summary(), result.certificate().largest());
            pull = sum.friction_force[0];
            println!(
                "{:>8.2} {:>9} {:>6} {:>5} {:>12.3e} {pull:>14.3e} {:>17.3e} {certificate:>12.1e}",
                result.time(),
                result.report().counters.products,
                sum.stick,
                sum.slip,
                sum.normal_force,
                sum.friction_work,
            );
        }
        pulls.push(pull);
    }
    let difference = (pulls[0] - pulls[1]).abs() / pulls[1].abs();
    println!("friction at the end: both methods agree to {difference:.0e}");
    Ok(())
}

/// The brick in five steps of backward Euler.
pub fn scene(bound: f64) -> Result<Scene, Error> {
    let mesh = Brick::new([3.0, 1.0, 1.0], [12, 4, 4]).build()?;
    let steel = Hooke::isotropic(211.9e9, 0.277)?;
    let pull = Load::traction(brick::X_MAX, [2e8, 0.0, 0.0]);
    Ok(Scene::new(mesh, Materials::uniform(steel))
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::pressure(brick::Z_MAX, 1e8))
        .with_load(pull.with_history(History::ramp(1.0, 1.0)?))
        .with_contact(Contact::rigid(brick::Z_MIN).with_friction(Friction::tresca(bound)))
        .with_boxes([3, 1, 1])
        .with_analysis(Analysis::quasistatic(1.0, 5)))
}
