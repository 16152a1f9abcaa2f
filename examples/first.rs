//! A first program: the one in the README.

use signorini::prelude::*;

fn main() -> Result<(), Error> {
    // a steel brick, clamped at one end, 0.1 m above a rough floor
    let mesh = Brick::new([3.0, 1.0, 1.0], [15, 5, 5]).build()?;
    let steel = Hooke::isotropic(211.9e9, 0.277)?;
    let ramp = History::ramp(1.0, 1.0)?;
    let scene = Scene::new(mesh, Materials::uniform(steel))
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -3e9]).with_history(ramp.clone()))
        .with_load(Load::traction(brick::X_MAX, [9e8, 0.0, -15e8]).with_history(ramp))
        .with_contact(
            Contact::rigid(brick::Z_MIN)
                .with_gap(0.1)
                .with_friction(Friction::coulomb(0.3)),
        )
        .with_boxes([3, 1, 1])
        .with_analysis(Analysis::quasistatic(1.0, 10));

    let mut simulation = Simulation::new(scene, Settings::default())?;
    println!("{}", simulation.plan());
    while !simulation.is_finished() {
        let frame = simulation.step()?;
        let (sum, certificate) = (frame.summary(), frame.certificate().largest());
        println!(
            "t = {:.1} s: {:2} nodes touch, {:2} slide, pressed with {:.3e} N, certificate {certificate:.0e}",
            frame.time(),
            sum.active,
            sum.slip,
            sum.normal_force,
        );
    }
    Ok(())
}
