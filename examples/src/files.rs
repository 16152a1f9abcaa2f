//! Files of a run for ParaView and for spreadsheets: VTU series of body and contact surface, a CSV of the steps.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use signorini::contact::ContactState;
use signorini::fem_mesh::Surface;
use signorini::fem_mesh::fields::{nodal_average, von_mises};
use signorini::fem_mesh::output::{Field, PvdSeries};
use signorini::prelude::Simulation;

use crate::error::ExampleError;
use crate::record::{RunRecord, StepRecord};
use crate::run::Sink;
use crate::snapshot::{ContactPatch, contact_surface};

/// Writes `LABEL/body.pvd`, `LABEL/contact.pvd` with their VTU files, and `LABEL/steps.csv`.
#[derive(Debug)]
pub struct RunFiles {
    folder: PathBuf,
    every: usize,
    reactions: bool,
    series: Option<Series>,
}

#[derive(Debug)]
struct Series {
    levels: usize,
    folder: PathBuf,
    body: PvdSeries,
    surface: Surface,
    contact: PvdSeries,
}

impl RunFiles {
    /// Files in a folder, VTU at every `every`-th step and at the last (0: none).
    #[must_use]
    pub fn new(folder: impl AsRef<Path>, every: usize) -> Self {
        Self {
            folder: folder.as_ref().to_path_buf(),
            every,
            reactions: false,
            series: None,
        }
    }

    /// Writes the reactions of the supports as a field of the body, too.
    #[must_use]
    pub fn with_reactions(mut self, on: bool) -> Self {
        self.reactions = on;
        self
    }
}

impl Sink for RunFiles {
    fn started(&mut self, label: &str, simulation: &Simulation) -> Result<(), ExampleError> {
        let folder = self.folder.join(label);
        std::fs::create_dir_all(&folder).map_err(ExampleError::write(&folder))?;
        self.series = Some(Series {
            body: PvdSeries::create(&folder, "body")?,
            surface: contact_surface(simulation)?,
            levels: simulation.plan().steps,
            contact: PvdSeries::create(&folder, "contact")?,
            folder,
        });
        Ok(())
    }

    fn step(&mut self, simulation: &Simulation, step: &StepRecord) -> Result<(), ExampleError> {
        let Some(series) = &mut self.series else {
            return Ok(());
        };
        let due = step.step.checked_rem(self.every) == Some(0);
        if due || (self.every > 0 && step.step == series.levels) {
            series.write_body(simulation, self.reactions)?;
            series.write_contact(simulation)?;
        }
        Ok(())
    }

    fn finished(&mut self, record: &RunRecord) -> Result<(), ExampleError> {
        if let Some(series) = self.series.take() {
            let path = series.folder.join("steps.csv");
            std::fs::write(&path, csv(record)).map_err(ExampleError::write(&path))?;
        }
        Ok(())
    }
}

impl Series {
    fn write_body(&mut self, simulation: &Simulation, reactions: bool) -> Result<(), ExampleError> {
        let frame = simulation.result().ok_or(ExampleError::NoLevel)?;
        let mesh = simulation.scene().mesh();
        let stress = frame.stress();
        let nodal = nodal_average(mesh, &stress)?;
        let mut points = vec![
            Field::vector("displacement", frame.displacement().into_flattened()),
            Field::symmetric_tensor("stress", &nodal),
            Field::scalar("von_mises", nodal.iter().map(von_mises).collect()),
        ];
        if reactions {
            points.push(Field::vector(
                "reaction",
                frame.reaction_field().into_flattened(),
            ));
        }
        let cells = [Field::scalar(
            "von_mises",
            stress.iter().map(von_mises).collect(),
        )];
        let parts = simulation.decomposition();
        self.body
            .write_pieces(frame.time(), mesh, parts, &points, &cells)?;
        Ok(())
    }

    fn write_contact(&mut self, simulation: &Simulation) -> Result<(), ExampleError> {
        let frame = simulation.result().ok_or(ExampleError::NoLevel)?;
        let mesh = simulation.scene().mesh();
        let patch = ContactPatch::new(&self.surface, mesh.points(), frame.points());
        let u = frame.displacement();
        let at = |node: &u32| u[*node as usize];
        let displacement = self.surface.nodes().iter().flat_map(at).collect();
        let friction = patch.friction_force.iter().flatten().copied().collect();
        let state = patch.state.iter().map(|s| state_number(*s)).collect();
        let fields = [
            Field::vector("displacement", displacement),
            Field::scalar("pressure", patch.pressure()),
            Field::scalar("friction_stress", patch.friction_stress()),
            Field::scalar("normal_force", patch.normal_force),
            Field::vector("friction_force", friction),
            Field::scalar("slip_rate", patch.slip_rate),
            Field::scalar("gap", patch.gap),
            Field::scalar("state", state),
        ];
        self.contact
            .write_surface(frame.time(), mesh, &self.surface, &fields, &[])?;
        Ok(())
    }
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

/// The steps as comma-separated values with a header line.
#[must_use]
pub fn csv(record: &RunRecord) -> String {
    let mut text = String::from(
        "step,t,it,n_m,active,stick,slip,normal_force,tangential_force_x,tangential_force_y,normal_norm,\
         tangential_norm,max_slip_rate,max_penetration,dissipation,dissipation_formula,certificate,status\n",
    );
    for s in &record.steps {
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{},{:e},{:e},{:e},{:e},{:e},{:e},{:e},{:e},{:e},{:e},{}",
            s.step,
            s.t,
            s.it,
            s.n_m,
            s.active,
            s.stick,
            s.slip,
            s.normal_force,
            s.tangential_force[0],
            s.tangential_force[1],
            s.normal_norm,
            s.tangential_norm,
            s.max_slip_rate,
            s.max_penetration,
            s.dissipation,
            s.dissipation_formula,
            s.certificate,
            s.status
        );
    }
    text
}
