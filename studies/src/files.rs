//! VTU series of body and contact surface for ParaView.

use std::path::Path;

use signorini::prelude::{ResultField, ResultWriter, Simulation};

use crate::Failure;

/// Writes `body.pvd` and `contact.pvd` with their VTU files and `body.csv` into a folder.
#[derive(Debug)]
pub struct RunFiles(Option<ResultWriter>);

impl RunFiles {
    /// Files in a folder, at rest, at every `every`-th step and at the last (0: none); with the reactions of the
    /// supports as a field of the body if asked for.
    pub fn new(folder: &Path, every: usize, reactions: bool) -> Self {
        let mut writer = ResultWriter::new(folder, "body")
            .with_contact_name("contact")
            .with_field(ResultField::Stress)
            .with_field(ResultField::SlipRate)
            .with_field(ResultField::Subdomain)
            .with_every(every);
        if reactions {
            writer = writer.with_field(ResultField::Reaction);
        }
        Self((every > 0).then_some(writer))
    }

    /// Writes the last step solved.
    pub fn write(&mut self, simulation: &Simulation) -> Result<(), Failure> {
        if let (Some(writer), Some(result)) = (&mut self.0, simulation.result()) {
            writer.write(result)?;
        }
        Ok(())
    }
}
