//! The last rank dies after the second step, by an error or, told `panic` or `exit`, otherwise: all ranks must end.

use signorini::prelude::*;
use std::process::ExitCode;

fn main() -> ExitCode {
    let how = std::env::args().nth(1).unwrap_or_default();
    signorini_mpi::run(|communicator| {
        let dies = communicator.rank() + 1 == communicator.size();
        let mesh = Brick::new([2.0, 1.0, 1.0], [8, 4, 4]).build()?;
        let scene = Scene::new(mesh, Hooke::isotropic(1e9, 0.3)?.into())
            .with_support(Support::fixed(brick::X_MIN))
            .with_load(Load::pressure(brick::Z_MAX, 1e5))
            .with_contact(Contact::rigid(brick::Z_MIN))
            .with_subdomains(8)
            .with_analysis(Analysis::quasistatic(1.0, 8));
        let settings = Settings::default().with_communicator(communicator);
        let mut simulation = Simulation::new(scene, settings)?;
        while !simulation.is_finished() {
            let result = simulation.step()?;
            if dies && result.step() == 1 {
                match how.as_str() {
                    "panic" => panic!("as asked for"),
                    "exit" => std::process::exit(3),
                    _ => return Err("the disk is full".into()),
                }
            }
        }
        Ok::<(), Box<dyn std::error::Error>>(())
    })
}
