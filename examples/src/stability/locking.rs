//! Linear tetrahedra near incompressibility: the deflection of a cantilever against beam theory.

use super::case::Failure;
use crate::brick::{LENGTHS, YOUNG};
use signorini::prelude::*;

/// Poisson's ratios of the table.
pub const RATIOS: [f64; 4] = [0.0, 0.45, 0.49, 0.499];

/// Cells across the brick.
pub const CELLS: [usize; 3] = [2, 4, 8];

/// Traction at the end, Pa.
const TRACTION: f64 = 1e6;

/// Deflection of the end by the finite elements over that by Timoshenko's beam.
///
/// # Errors
/// Those of the library.
pub fn deflection(poisson: f64, cells: usize) -> Result<f64, Failure> {
    let mesh = Brick::new(LENGTHS, [3 * cells, cells, cells]).build()?;
    let end = mesh.nodes_on(brick::X_MAX);
    let scene = Scene::new(mesh, Materials::uniform(Hooke::isotropic(YOUNG, poisson)?))
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::traction(brick::X_MAX, [0.0, 0.0, -TRACTION]))
        .with_boxes([3, 1, 1]);
    let mut simulation = Simulation::new(scene, Settings::default())?;
    let frame = simulation.step()?;
    if !frame.report().status.converged() {
        return Err("the cantilever did not converge".into());
    }
    let u = frame.displacement();
    let mean = end.iter().map(|&n| u[n as usize][2]).sum::<f64>() / end.len() as f64;
    let [length, width, height] = LENGTHS;
    let force = TRACTION * width * height;
    let bending = force * length.powi(3) / (3.0 * YOUNG * width * height.powi(3) / 12.0);
    let shear_modulus = YOUNG / (2.0 * (1.0 + poisson));
    let shear = force * length / (5.0 / 6.0 * shear_modulus * width * height);
    Ok(-mean / (bending + shear))
}
