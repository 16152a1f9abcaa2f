//! VTU series of body and contact surface for ParaView.

use std::path::{Path, PathBuf};

use signorini::contact::{ContactState, StepResult};
use signorini::fem_mesh::Surface;
use signorini::fem_mesh::fields::{nodal_average, von_mises};
use signorini::fem_mesh::output::{Field, PvdSeries};
use signorini::prelude::Simulation;

use crate::Failure;
use crate::snapshot::{ContactPatch, contact_surface};

/// Writes `body.pvd` and `contact.pvd` with their VTU files into a folder.
#[derive(Debug)]
pub struct RunFiles {
    folder: PathBuf,
    every: usize,
    reactions: bool,
    series: Option<(PvdSeries, Surface, PvdSeries)>,
}

impl RunFiles {
    /// Files in a folder, at every `every`-th step and at the last (0: none); with the reactions of the supports as
    /// a field of the body if asked for.
    pub fn new(folder: &Path, every: usize, reactions: bool) -> Self {
        let folder = folder.to_path_buf();
        Self {
            folder,
            every,
            reactions,
            series: None,
        }
    }

    /// Writes the last step solved, if it is due.
    pub fn write(&mut self, simulation: &Simulation) -> Result<(), Failure> {
        let Some(result) = simulation.result() else {
            return Ok(());
        };
        let due = (result.step() + 1).checked_rem(self.every) == Some(0);
        if self.every == 0 || !(due || simulation.is_finished()) {
            return Ok(());
        }
        if self.series.is_none() {
            let body = PvdSeries::create(&self.folder, "body")?;
            let surface = contact_surface(simulation)?;
            self.series = Some((body, surface, PvdSeries::create(&self.folder, "contact")?));
        }
        if let Some((body, surface, contact)) = &mut self.series {
            write_body(body, result, self.reactions)?;
            write_contact(contact, surface, result)?;
        }
        Ok(())
    }
}

fn write_body(series: &mut PvdSeries, result: &StepResult, reactions: bool) -> Result<(), Failure> {
    let mesh = result.scene().mesh();
    let stress = result.stress();
    let nodal = nodal_average(mesh, &stress)?;
    let mut points = vec![
        Field::vector("displacement", &result.displacement()),
        Field::symmetric_tensor("stress", &nodal),
        Field::scalar("von_mises", nodal.iter().map(von_mises).collect()),
    ];
    if reactions {
        points.push(Field::vector("reaction", &result.reaction_field()));
    }
    let cells = [Field::scalar("von_mises", stress.iter().map(von_mises).collect())];
    Ok(series.write_pieces(result.time(), mesh, result.decomposition(), &points, &cells)?)
}

fn write_contact(series: &mut PvdSeries, surface: &Surface, result: &StepResult) -> Result<(), Failure> {
    let mesh = result.scene().mesh();
    let patch = ContactPatch::new(surface, mesh.points(), result.points());
    let u = result.displacement();
    let at = |node: &u32| u[*node as usize];
    let displacement: Vec<[f64; 3]> = surface.nodes().iter().map(at).collect();
    let fields = [
        Field::vector("displacement", &displacement),
        Field::scalar("pressure", patch.stress(&patch.normal_force)),
        Field::scalar("friction_stress", patch.stress(&patch.friction())),
        Field::vector("friction_force", &patch.friction_force),
        Field::scalar("state", patch.state.iter().map(|s| state_number(*s)).collect()),
        Field::scalar("normal_force", patch.normal_force),
        Field::scalar("slip_rate", patch.slip_rate),
        Field::scalar("gap", patch.gap),
    ];
    Ok(series.write_surface(result.time(), mesh, surface, &fields, &[])?)
}

/// 0 open, 1 stick, 2 slip, -1 fixed.
fn state_number(state: Option<ContactState>) -> f64 {
    match state {
        Some(ContactState::Open) => 0.0,
        Some(ContactState::Stick) => 1.0,
        Some(ContactState::Slip) => 2.0,
        _ => -1.0,
    }
}
