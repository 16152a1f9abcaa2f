//! The table: a row a step, as comma-separated values. It is replaced whole at every step, as the series are.

use super::fields::LEGEND;
use crate::error::ContactError;
use crate::part::Part;
use crate::simulation::StepResult;
use crate::vec3::norm;
use signorini_fem_mesh::internal::replace_file;
use signorini_fem_mesh::output::OutputError;
use std::fmt::Write as _;
use std::path::PathBuf;

/// A table that grows by a row after every step.
#[derive(Debug)]
pub(super) struct Table {
    path: PathBuf,
    probes: Vec<u32>,
    /// All that was written.
    text: String,
}

impl Table {
    /// The head alone.
    pub(super) fn new(path: PathBuf, probes: &[u32], result: &StepResult) -> Self {
        Self {
            path,
            probes: probes.to_vec(),
            text: head(probes, result),
        }
    }

    /// Goes on with the table that is there, if there is one, without its rows of this step and later ones.
    pub(super) fn open(path: PathBuf, probes: &[u32], result: &StepResult) -> Result<Self, ContactError> {
        let mut table = Self::new(path, probes, result);
        if !table.path.exists() {
            return Ok(table);
        }
        let path = table.path.clone();
        let read = std::fs::read_to_string(&path);
        let old = read.map_err(|source| OutputError::Read { path, source })?;
        let wrong = |line: usize, expected: &str| ContactError::ResultTable {
            path: table.path.clone(),
            line: line + 1,
            found: old.lines().nth(line).unwrap_or_default().to_owned(),
            expected: expected.to_owned(),
        };
        let same = table.text.lines().count();
        for (line, expected) in table.text.lines().enumerate() {
            // comments may tell other names
            if expected.starts_with('#') {
                continue;
            }
            if old.lines().nth(line) != Some(expected) {
                return Err(wrong(line, &format!("{expected:?}")));
            }
        }
        let mut rows = String::new();
        let last = old.lines().count();
        for (line, row) in old.lines().enumerate().skip(same) {
            // one that was cut short
            if line + 1 == last && !old.ends_with('\n') {
                break;
            }
            let step = row.split(',').next().and_then(|s| s.parse::<usize>().ok());
            let step = step.ok_or_else(|| wrong(line, "a row that begins with the number of its step"))?;
            if step < result.step() {
                rows += row;
                rows.push('\n');
            }
        }
        table.text += &rows;
        Ok(table)
    }

    /// Adds a row; the file is replaced, and complete at any moment.
    pub(super) fn write(&mut self, result: &StepResult) -> Result<(), ContactError> {
        let before = self.text.len();
        self.text += &row(&self.probes, result);
        let done = replace_file(&self.path, self.text.as_bytes());
        let Err(source) = done else { return Ok(()) };
        self.text.truncate(before);
        let path = self.path.clone();
        Err(OutputError::Io { path, source }.into())
    }
}

/// The lines before the rows: comments, which also tell names of parts, and the columns.
pub(super) fn head(probes: &[u32], result: &StepResult) -> String {
    let scene = result.scene();
    let contacts = (0..scene.contacts().len()).map(Part::Contact);
    let supports = (0..scene.supports().len()).map(Part::Support);
    let couplings = (0..scene.couplings().len()).map(Part::Coupling);
    let names = scene.names.of(contacts.chain(supports).chain(couplings).collect());
    let names = names.map_or_else(String::new, |names| format!("; {names}").replace(['\n', '\r'], " "));
    let mut text = format!(
        "# forces on the body, moments about the origin; units as in the scene\n# {LEGEND}{names}\n\
         step,time,products,status,certificate,touch,stick,slide"
    );
    let (forces, motion) = (
        ["fx", "fy", "fz", "mx", "my", "mz"],
        ["ux", "uy", "uz", "rx", "ry", "rz"],
    );
    for (what, count, parts) in [
        ("contact", scene.contacts().len(), &forces[..]),
        ("support", scene.supports().len(), &forces),
        ("coupling", scene.couplings().len(), &forces),
        ("coupling", scene.couplings().len(), &motion),
        (
            "contact",
            scene.contacts().len(),
            &["area", "max_pressure", "normal", "friction"],
        ),
    ] {
        for k in 0..count {
            for part in parts {
                // writing to a string cannot fail
                let _ = write!(text, ",{what}_{k}_{part}");
            }
        }
    }
    for node in probes {
        let _ = write!(text, ",node_{node}_ux,node_{node}_uy,node_{node}_uz");
    }
    text.push('\n');
    text
}

fn row(probes: &[u32], result: &StepResult) -> String {
    let (report, sum, reactions) = (result.report(), result.summary(), result.reactions());
    let mut text = format!(
        "{},{:?},{},{},{:?},{},{},{}",
        result.step(),
        result.time(),
        report.counters.products,
        report.status,
        result.certificate().largest(),
        sum.active,
        sum.stick,
        sum.slip
    );
    let supports = reactions.supports.iter().map(|s| s.resultant);
    let couplings = reactions.couplings.iter().copied();
    let resultants = reactions.contacts.iter().copied().chain(supports).chain(couplings);
    let motions = result.couplings().into_iter();
    let motions = motions.flat_map(|m| [m.displacement, m.rotation]);
    let u = if probes.is_empty() { Vec::new() } else { result.displacement() };
    let probed = probes.iter().flat_map(|&node| u[node as usize]);
    let resultants = resultants.flat_map(|r| [r.force, r.moment]);
    let sums = (0..reactions.contacts.len()).filter_map(|k| result.summary_of(k));
    let sums = sums.flat_map(|s| [s.area, s.max_pressure, s.normal_force, norm(&s.friction_force)]);
    for value in resultants.chain(motions).flatten().chain(sums).chain(probed) {
        // the shortest digits that give the same bits again
        let _ = write!(text, ",{value:?}");
    }
    text.push('\n');
    text
}
