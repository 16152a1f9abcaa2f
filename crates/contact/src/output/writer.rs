//! The observer that writes what one wants.

use super::fields::{ResultField, body, surfaces};
use super::table::{Table, head};
use crate::error::ContactError;
use crate::simulation::{Flow, Observer, StepResult};
use signorini_fem_mesh::output::{OutputError, PvdSeries, SurfaceFields};
use std::path::PathBuf;

/// Writes each step into a folder: series of the bodies and of the contact surfaces for ParaView, and a table.
///
/// | file | holds |
/// |---|---|
/// | `NAME.pvd` | the bodies: displacement and von Mises stress; of several processes each writes its subdomains |
/// | `NAME_contact.pvd` | the contact surfaces, each a piece: displacement, contact pressure, friction stress, gap, slip, state |
/// | `NAME.csv` | one row per step: time, products, status, certificate, numbers of points, contact forces, reactions, couplings, sums of each contact, probes |
///
/// [`with_field`](Self::with_field) and [`with_fields`](Self::with_fields) choose other fields. The series
/// begin at time 0, undeformed. All files are complete at any moment. If writing fails, the run ends with the error
/// after the step; existing files stay. The first two lines of the table begin with `#` and tell what parts are called;
/// columns are `contact_0_fx` to `contact_0_mz` for each contact surface, support and coupling (force on the body and
/// its moment about the origin; [`Reactions::contacts`](crate::result::Reactions::contacts)), `coupling_0_ux` to
/// `coupling_0_rz` for motions of couplings, `contact_0_area`, `_max_pressure`, `_normal` and `_friction` (force;
/// [`StepResult::summary_of`]), then `node_7_ux` for probes.
///
/// A resumed run continues its files: files and rows of steps before its first one are kept, later ones are replaced.
#[derive(Debug)]
#[must_use]
pub struct ResultWriter {
    folder: PathBuf,
    name: String,
    contact_name: String,
    fields: Vec<ResultField>,
    probes: Vec<u32>,
    every: usize,
    files: Option<Files>,
}

/// The files of a run that has begun.
#[derive(Debug)]
struct Files {
    body: PvdSeries,
    contact: Option<PvdSeries>,
    table: Option<Table>,
    /// The process of each tetrahedron; empty with one process.
    owners: Vec<u32>,
    /// The last step written.
    step: usize,
    of: Of,
}

/// What files must have been begun for: nodes, tetrahedra and columns of a scene.
type Of = ([usize; 2], String);

impl ResultWriter {
    /// Files of this name (no folders in it) in a folder, which is created if it does not exist. Nothing is written
    /// before the first step.
    pub fn new(folder: impl Into<PathBuf>, name: impl Into<String>) -> Self {
        let name = name.into();
        Self {
            folder: folder.into(),
            contact_name: format!("{name}_contact"),
            name,
            fields: ResultField::USUAL.to_vec(),
            probes: Vec::new(),
            every: 1,
            files: None,
        }
    }

    /// Adds a field.
    pub fn with_field(mut self, field: ResultField) -> Self {
        if !self.fields.contains(&field) {
            self.fields.push(field);
        }
        self
    }

    /// Writes these fields and no other.
    pub fn with_fields(mut self, fields: impl IntoIterator<Item = ResultField>) -> Self {
        self.fields.clear();
        fields.into_iter().fold(self, Self::with_field)
    }

    /// A column of the table for each component of the displacement of this mesh node.
    pub fn with_probe(mut self, node: u32) -> Self {
        if !self.probes.contains(&node) {
            self.probes.push(node);
        }
        self
    }

    /// Writes only every `steps`-th step and the last one to the series; 0 for none. The table has a row for each step.
    pub fn with_every(mut self, steps: usize) -> Self {
        self.every = steps;
        self
    }

    /// Sets another name for the series of the contact surfaces, which is not that of the bodies.
    pub fn with_contact_name(mut self, name: impl Into<String>) -> Self {
        self.contact_name = name.into();
        self
    }

    /// The series of the bodies, to open in ParaView.
    pub fn path(&self) -> PathBuf {
        self.folder.join(format!("{}.pvd", self.name))
    }

    /// Writes a step; call it in a loop of your own (as an observer, the writer does so itself). A step that could not
    /// be written can be written again, and one before the last, or of a scene with another mesh or other columns,
    /// begins anew there, without the rows and pictures from it on. Of several processes each writes the tetrahedra of
    /// its subdomains, rank 0 the rest, so every rank needs this writer.
    ///
    /// # Errors
    /// [`ContactError::Output`] if a name cannot name a file, a file cannot be written or continued, or a field is not
    /// finite; [`ContactError::Probe`] if a probe is not a node; [`ContactError::ResultTable`] if there is a
    /// different table to go on with.
    pub fn write(&mut self, result: &StepResult) -> Result<(), ContactError> {
        let of = self.of(result);
        let goes_on = |files: &Files| files.step < result.step() && files.of == of;
        let mut files = match self.files.take().filter(goes_on) {
            Some(files) => files,
            None => self.begin(result, of)?,
        };
        let last = result.step() + 1 == result.scene().analysis().steps();
        let due = (result.step() + 1)
            .checked_rem(self.every)
            .is_some_and(|rest| rest == 0 || last);
        if due {
            self.picture(&mut files, result, false)?;
        }
        if let Some(table) = &mut files.table {
            table.write(result)?;
        }
        files.step = result.step();
        self.files = Some(files);
        Ok(())
    }

    fn of(&self, result: &StepResult) -> Of {
        let mesh = result.scene().mesh();
        ([mesh.points().len(), mesh.tets().len()], head(&self.probes, result))
    }

    /// Starts the files, or goes on with those of the steps before.
    fn begin(&self, result: &StepResult, of: Of) -> Result<Files, ContactError> {
        let nodes = of.0[0];
        if let Some(&node) = self.probes.iter().find(|&&node| node as usize >= nodes) {
            return Err(ContactError::Probe { node, nodes });
        }
        if self.contact_name == self.name {
            let name = self.name.clone();
            return Err(OutputError::SharedSeries { name }.into());
        }
        let goes_on = |name: &str| result.step() > 0 && self.folder.join(format!("{name}.pvd")).exists();
        let series = |name: &str| {
            if goes_on(name) {
                PvdSeries::open_before(&self.folder, name, result.time())
            } else {
                PvdSeries::create(&self.folder, name)
            }
        };
        let body = series(&self.name)?;
        let plan = &result.model.plan;
        let mut files = Files {
            body,
            contact: None,
            table: None,
            owners: Vec::new(),
            step: result.step(),
            of,
        };
        if plan.ranks > 1 {
            let rank = |p: &u32| result.model.tfeti.rank_of(*p as usize) as u32;
            files.owners = result.decomposition().parts().iter().map(rank).collect();
        }
        if plan.rank == 0 {
            files.contact = match result.surfaces() {
                [] => None,
                _ => Some(series(&self.contact_name)?),
            };
            let path = self.folder.join(format!("{}.csv", self.name));
            files.table = Some(match result.step() {
                0 => Table::new(path, &self.probes, result),
                _ => Table::open(path, &self.probes, result)?,
            });
        }
        // a static scene may be at time 0 itself
        if self.every > 0 && result.time() > 0.0 {
            self.picture(&mut files, result, true)?;
        }
        Ok(files)
    }

    /// A picture of bodies and surfaces; at rest only where there is none yet.
    fn picture(&self, files: &mut Files, result: &StepResult, rest: bool) -> Result<(), ContactError> {
        let mesh = result.scene().mesh();
        let time = if rest { 0.0 } else { result.time() };
        if !rest || files.body.times().is_empty() {
            let (at_nodes, in_tets) = body(result, &self.fields, rest)?;
            match &files.owners[..] {
                [] => files.body.write(time, mesh, &at_nodes, &in_tets)?,
                owners => {
                    let own = (owners, result.model.plan.rank as u32);
                    files.body.write_part(time, mesh, own, &at_nodes, &in_tets)?;
                }
            }
        }
        if let Some(contact) = files.contact.as_mut().filter(|c| !rest || c.times().is_empty()) {
            let fields = surfaces(result, &self.fields, rest);
            let pieces = result.surfaces().iter().zip(&fields);
            let pieces: Vec<SurfaceFields<'_>> = pieces.map(|(s, (a, b))| (s, &a[..], &b[..])).collect();
            contact.write_surfaces(time, mesh, &pieces)?;
        }
        Ok(())
    }
}

impl Observer for ResultWriter {
    fn step(&mut self, result: &StepResult) -> Flow {
        Flow::from(self.write(result))
    }

    /// Another run opens its files anew: of several processes only one may have failed to write them.
    fn finished(&mut self, _: usize) {
        self.files = None;
    }
}
