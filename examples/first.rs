//! A first program: the one in the README.

use signorini::prelude::*;

fn main() -> Result<(), Error> {
    // a steel brick, clamped at one end, is pressed and pulled down to a rough floor 0.1 m below it
    let mesh = Brick::new([3.0, 1.0, 1.0], [15, 5, 5]).build()?;
    let steel = Materials::uniform(Hooke::isotropic(211.9e9, 0.277)?);
    let ramp = History::ramp(1.0, 1.0)?;
    let floor = Contact::rigid(brick::Z_MIN).with_gap(0.1);
    let scene = Scene::new(mesh, steel)
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::pressure(brick::Z_MAX, 3e9).with_history(ramp.clone()))
        .with_load(Load::traction(brick::X_MAX, [9e8, 0.0, -15e8]).with_history(ramp))
        .with_contact(floor.with_friction(Friction::coulomb(0.3)))
        .with_analysis(Analysis::quasistatic(1.0, 10));

    let mut simulation = Simulation::new(scene, Settings::default())?;
    while !simulation.is_finished() {
        let result = simulation.step()?;
        println!("{result}");
        result.require_converged()?;
    }
    Ok(())
}
