//! Results of a run as plain data: the JSON of the benchmark. Units are SI.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};
use signorini::contact::{Certificate, StepResult};

use crate::error::ExampleError;

/// One run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunRecord {
    /// Subdomains along the short edges.
    pub n: usize,
    /// `"b"`, `"c"`, or the name of another scene.
    pub loading: String,
    /// Name of the method.
    pub method: String,
    /// Threads.
    pub threads: usize,
    /// Subdomains.
    pub n_s: usize,
    /// Unknown displacements of all subdomains.
    pub n_p: usize,
    /// Multipliers, full rank.
    pub n_d: usize,
    /// Multipliers as the paper counts them.
    pub n_d_paper: usize,
    /// Outer iterations of all levels, see `it_name`.
    pub it: usize,
    /// Products with F, recoveries and restarts included.
    pub n_m: usize,
    /// Products with F spent on estimating norms.
    pub n_m_setup: usize,
    /// Wall clock before the first step, s.
    pub setup_seconds: f64,
    /// Wall clock of all steps, s; writing of files not included.
    pub solve_seconds: f64,
    /// Largest resident memory of the process so far (it never falls from run to run); 0 where the system does not tell.
    pub peak_rss_bytes: u64,
    /// What `it` counts: the method's own name of its outer iterations.
    pub it_name: String,
    /// Cells along the edge of a subdomain.
    pub cells: usize,
    /// Relative tolerance of a level.
    pub tolerance: f64,
    /// Difference formula, `"three-step"`, `"backward-euler"`, or `"static"`.
    pub formula: String,
    /// Faces of the face method.
    pub faces: usize,
    /// Quadratic programs solved by SMALSE.
    pub quadratic_programs: usize,
    /// Applications of the preconditioner.
    pub preconditionings: usize,
    /// Applications of the projector.
    pub projections: usize,
    /// Factorisations of the coarse problem after the set-up.
    pub coarse_factorisations: usize,
    /// Bytes of inverses, coarse factor and tables.
    pub setup_bytes: u64,
    /// The largest certificate of all steps.
    pub largest_certificate: f64,
    /// Steps that did not reach the tolerance, from 1.
    pub unconverged: Vec<usize>,
    /// The steps.
    pub steps: Vec<StepRecord>,
}

/// One time level.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StepRecord {
    /// Number, from 1.
    pub step: usize,
    /// Time, s.
    pub t: f64,
    /// Outer iterations.
    pub it: usize,
    /// Products with F.
    pub n_m: usize,
    /// Nodes with a normal force.
    pub active: usize,
    /// Those of them that stick.
    pub stick: usize,
    /// Those of them that slide.
    pub slip: usize,
    /// Sum of the pressing forces, N.
    pub normal_force: f64,
    /// Sum of the friction forces on the body along x1 and x2, N.
    pub tangential_force: [f64; 2],
    /// Euclidean norm of the nodal normal forces, N.
    pub normal_norm: f64,
    /// Euclidean norm of the nodal friction forces, N.
    pub tangential_norm: f64,
    /// Largest slip rate of nodes in contact, m/s.
    pub max_slip_rate: f64,
    /// Largest penetration, m.
    pub max_penetration: f64,
    /// Work done against friction by the displacement increments, J.
    pub dissipation: f64,
    /// Friction force times the tangential difference of the formula, J.
    pub dissipation_formula: f64,
    /// Largest relative violation of all conditions.
    pub certificate: f64,
    /// Relative violation of each condition.
    pub certificate_parts: BTreeMap<String, f64>,
    /// How the level ended.
    pub status: String,
    /// The first earlier step that did not converge and on whose slip this one depends, from 1; absent where there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unconverged_history: Option<usize>,
    /// Whether the face method gave up and SMALSE finished.
    pub fallback: bool,
    /// Faces of the face method.
    pub faces: usize,
    /// Quadratic programs solved by SMALSE.
    pub quadratic_programs: usize,
    /// Estimated factor by which an iteration of the fixed-point loop shrinks the error, if there is one.
    pub contraction: Option<f64>,
    /// Sum of all loads, N.
    pub load: [f64; 3],
}

impl StepRecord {
    /// Reads a frame.
    #[must_use]
    pub fn new(frame: &StepResult) -> Self {
        let (sum, report) = (frame.summary(), frame.report());
        Self {
            step: frame.step() + 1,
            t: frame.time(),
            it: report.iterations,
            n_m: report.counters.products,
            active: sum.active,
            stick: sum.stick,
            slip: sum.slip,
            normal_force: sum.normal_force,
            tangential_force: [sum.friction_force[0], sum.friction_force[1]],
            normal_norm: sum.normal_norm,
            tangential_norm: sum.friction_norm,
            max_slip_rate: sum.max_slip_rate,
            max_penetration: sum.max_penetration,
            dissipation: sum.friction_work,
            dissipation_formula: sum.dissipation,
            certificate: finite(frame.certificate().largest()),
            certificate_parts: parts(frame.certificate()),
            status: report.status.to_string(),
            unconverged_history: frame.unconverged_history().map(|level| level + 1),
            fallback: report.fallback,
            faces: report.counters.active_sets,
            quadratic_programs: report.counters.quadratic_programs,
            contraction: report.fixed_point.as_ref().and_then(|f| f.rate),
            load: frame.load_resultant(),
        }
    }

    /// Whether the tolerance was reached.
    #[must_use]
    pub fn converged(&self) -> bool {
        self.status == "converged"
    }
}

fn parts(certificate: &Certificate) -> BTreeMap<String, f64> {
    let entry =
        |(name, v): (&str, signorini::contact::Violation)| (name.to_owned(), finite(v.relative()));
    certificate.parts().into_iter().map(entry).collect()
}

/// JSON has no infinity.
fn finite(value: f64) -> f64 {
    if value.is_finite() { value } else { f64::MAX }
}

/// Writes runs as a JSON array.
///
/// # Errors
/// [`ExampleError`] if the file cannot be written.
pub fn write_json<'a>(
    path: &Path,
    runs: impl IntoIterator<Item = &'a RunRecord>,
) -> Result<(), ExampleError> {
    let runs: Vec<&RunRecord> = runs.into_iter().collect();
    let mut text = serde_json::to_string_pretty(&runs)?;
    text.push('\n');
    std::fs::write(path, text).map_err(ExampleError::write(path))
}
