//! A mesh of one's own: from a file of Gmsh to files for ParaView.
//!
//! Half a rubber roller (10 mm radius, `roller.msh`) is pressed on a floor and dragged along it. Lengths in mm,
//! stresses in MPa.

use signorini::prelude::*;

fn main() -> Result<(), Error> {
    run("out/own_mesh")
}

/// The roller of a mesh file on the floor.
pub fn scene(file: &str) -> Result<Scene, Error> {
    // physical surfaces and volumes of the file by their names
    let (mesh, names) = read_gmsh(file)?;
    let (top, rim) = (names.surface("top")?, names.surface("rim")?);
    let rubber = Hooke::isotropic(5.0, 0.45)?;
    let materials = Materials::new(vec![(names.volume("roller")?, rubber)])?;

    let down = History::table(vec![(0.0, 0.0), (0.5, 1.0), (1.0, 1.0)])?;
    let along = History::table(vec![(0.0, 0.0), (0.5, 0.0), (1.0, 1.0)])?;
    let press = Support::components(top, [false, true, true]);
    let drag = Support::components(top, [true, false, false]);
    // the floor is the half-space below z = 0
    let floor = Contact::half_space(rim, [0.0; 3], [0.0, 0.0, 1.0]);
    Ok(Scene::new(mesh, materials)
        .with_support(press.with_motion([0.0, 0.0, -0.8], down))
        .with_support(drag.with_motion([0.4, 0.0, 0.0], along))
        .with_contact(floor.with_friction(Friction::coulomb(0.5)))
        .with_analysis(Analysis::quasistatic(1.0, 10)))
}

/// Writes a series into a folder.
pub fn run(folder: &str) -> Result<(), Error> {
    let scene = scene(concat!(env!("CARGO_MANIFEST_DIR"), "/roller.msh"))?;
    let (nodes, tets) = (scene.mesh().points().len(), scene.mesh().tets().len());
    println!("{nodes} nodes, {tets} tetrahedra");
    let mut simulation = Simulation::new(scene, Settings::default())?;
    let mut writer = ResultWriter::new(folder, "roller").with_field(ResultField::Stress);
    println!("  t in s  touch  slide  normal in N  friction in N");
    while !simulation.is_finished() {
        let result = simulation.step()?;
        result.require_converged()?;
        let (t, sum) = (result.time(), result.summary());
        let (touch, slide, normal) = (sum.active, sum.slip, sum.normal_force);
        let friction = sum.friction_force[0];
        println!("{t:>8.1} {touch:>6} {slide:>6} {normal:>12.4} {friction:>14.4}");
        writer.write(&result)?;
    }
    println!("written to {}", writer.path().display());
    Ok(())
}
