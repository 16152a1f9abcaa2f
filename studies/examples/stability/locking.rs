//! Linear tetrahedra near incompressibility: the deflection of a cantilever against beam theory.

use signorini::prelude::*;
use signorini_studies::Failure;
use signorini_studies::brick::{Block, LENGTHS, YOUNG};

/// Poisson's ratios of the table.
pub(crate) const RATIOS: [f64; 4] = [0.0, 0.45, 0.49, 0.499];

/// Cells across the brick.
pub(crate) const CELLS: [usize; 3] = [2, 4, 8];

/// Traction at the end, Pa.
const TRACTION: f64 = 1e6;

/// Deflection of the end by the finite elements over that by Timoshenko's beam.
pub(crate) fn deflection(poisson: f64, cells: usize) -> Result<f64, Failure> {
    let block = Block {
        cells: [cells; 3],
        poisson,
        floor: None,
        top: [0.0; 3],
        end: [0.0, 0.0, -TRACTION],
        end_history: vec![(0.0, 1.0), (1.0, 1.0)],
        steps: 0,
        ..Block::default()
    };
    let mesh = block.mesh()?;
    let end = mesh.nodes_on(brick::X_MAX);
    let mut simulation = Simulation::new(block.scene()?, Settings::default())?;
    let result = simulation.step()?;
    if !result.report().status.converged() {
        return Err("the cantilever did not converge".into());
    }
    let u = result.displacement();
    let mean = end.iter().map(|&n| u[3 * n as usize + 2]).sum::<f64>() / end.len() as f64;
    let [length, width, height] = LENGTHS;
    let force = TRACTION * width * height;
    let bending = force * length.powi(3) / (3.0 * YOUNG * width * height.powi(3) / 12.0);
    let shear_modulus = YOUNG / (2.0 * (1.0 + poisson));
    let shear = force * length / (5.0 / 6.0 * shear_modulus * width * height);
    Ok(-mean / (bending + shear))
}
