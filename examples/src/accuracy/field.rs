//! The estimated discretisation error of each tetrahedron as a VTU file.

use std::path::Path;

use signorini::fem_mesh::output::{Field, write_vtu};
use signorini::prelude::*;

use super::scenes::{Floor, Variant};
use crate::brick::Loading;
use crate::error::ExampleError;

/// Solves the brick pressed on the floor and writes displacement, error energies (J) and error stresses (Pa).
pub(super) fn write(path: &Path, short: bool) -> Result<(), ExampleError> {
    let variant = Variant {
        n: if short { 1 } else { 2 },
        cells: if short { 2 } else { 5 },
        steps: 4,
        formula: DifferenceFormula::BACKWARD_EULER,
        loading: Loading::B,
        floor: Floor::Coulomb,
    };
    let mut simulation = Simulation::new(variant.scene()?, Settings::default())?;
    simulation.run(&mut Silent)?.require_converged()?;
    let frame = simulation.result().ok_or(ExampleError::NoLevel)?;
    let error = frame.discretisation_error()?;
    let scene = simulation.scene();
    let stress = error.stress_errors(scene.mesh(), scene.materials())?;
    let points = [Field::vector(
        "displacement",
        frame.displacement().into_flattened(),
    )];
    let cells = [
        Field::scalar("error_energy", error.energies().to_vec()),
        Field::scalar("error_stress", stress),
    ];
    Ok(write_vtu(path, scene.mesh(), &points, &cells)?)
}
