//! To stop and continue: a run that goes on from a stored state gives the same bits as one that was never interrupted.

use signorini::prelude::*;

fn main() -> Result<(), Error> {
    // without interruption
    let mut whole = Simulation::new(scene()?, Settings::default())?;
    whole.run(&mut Silent)?.require_converged()?;

    // four steps, and the state into a file
    let file = std::env::temp_dir().join(format!("signorini-restart-{}.bin", std::process::id()));
    let mut first = Simulation::new(scene()?, Settings::default())?;
    for _ in 0..4 {
        first.step()?.require_converged()?;
    }
    first.state().save(&file)?;
    println!("stored after 4 steps in {}", file.display());

    // perhaps in another program: the same scene again, and the other six steps
    let mut second = Simulation::new(scene()?, Settings::default())?;
    second.resume(State::load(&file)?)?;
    second.run(&mut Silent)?.require_converged()?;

    let displacement = |s: &Simulation| s.frame().map(|result| result.displacement());
    assert!(displacement(&whole) == displacement(&second));
    let step = second.state().step();
    println!("went on to step {step}: the same displacements, bit for bit");
    // a file that cannot be removed does no harm
    let _ = std::fs::remove_file(&file);
    Ok(())
}

/// A brick that is pressed on a floor, pulled, let go and pulled again in ten steps.
fn scene() -> Result<Scene, Error> {
    let mesh = Brick::new([3.0, 1.0, 1.0], [15, 5, 5]).build()?;
    let pulls = History::table(vec![(0.0, 0.0), (0.4, 1.0), (0.7, 0.0), (1.0, 1.0)])?;
    let steel = Hooke::isotropic(211.9e9, 0.277)?;
    let floor = Contact::rigid(brick::Z_MIN).with_gap(0.1);
    Ok(Scene::new(mesh, Materials::uniform(steel))
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::pressure(brick::Z_MAX, 3e9).with_history(History::ramp(1.0, 1.0)?))
        .with_load(Load::traction(brick::X_MAX, [9e8, 0.0, -15e8]).with_history(pulls))
        .with_contact(floor.with_friction(Friction::coulomb(0.3)))
        .with_boxes([3, 1, 1])
        .with_analysis(Analysis::quasistatic(1.0, 10)))
}
