//! From a mesh of Gmsh to ParaView: `cargo run --release --example from_mesh`. Lengths in mm, stresses in MPa.

use signorini::prelude::*;

fn main() -> Result<(), Error> {
    run(concat!(env!("CARGO_MANIFEST_DIR"), "/roller.msh"), "out/from_mesh")
}

/// Solves and writes series for ParaView.
pub fn run(file: &str, folder: &str) -> Result<(), Error> {
    let (mesh, names) = read_gmsh(file)?;
    let rubber = Materials::uniform(Hooke::isotropic(5.0, 0.45)?);
    let ramp = History::ramp(1.0, 1.0)?;
    let scene = Scene::new(mesh, rubber)
        .with_support(Support::fixed(names.surface("top")?).with_motion([0.0, 0.0, -0.8], ramp))
        .with_contact(Contact::half_space(names.surface("rim")?, [0.0; 3], [0.0, 0.0, 1.0]))
        .with_analysis(Analysis::quasistatic(1.0, 5))
        .with_groups(names.surfaces(), names.volumes());
    let mut simulation = Simulation::new(scene, Settings::default())?;
    println!("{}", simulation.plan());
    let writer = ResultWriter::new(folder, "roller").with_field(ResultField::Stress);
    let report = simulation.run(&mut (Progress::new(std::io::stderr()), writer))?;
    Ok(report.require_converged()?)
}
