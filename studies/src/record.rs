//! Results of a run as plain data: the JSON of the benchmark. Units are SI.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};
use signorini::contact::{Certificate, StepResult};

use crate::chart::{Chart, Curve, page};
use crate::{Failure, save};

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
    /// Outer iterations of all steps, see `it_name`.
    pub it: usize,
    /// Products with F, recoveries and restarts included.
    pub n_m: usize,
    /// Products with F spent on estimating norms.
    pub n_m_setup: usize,
    /// Wall clock before the first step, s.
    pub setup_seconds: f64,
    /// Wall clock of all steps, s; writing of files not included.
    pub solve_seconds: f64,
    /// Largest resident memory of the process so far (it never falls from run to run); 0 where the system does not
    /// tell.
    pub peak_rss_bytes: u64,
    /// What `it` counts: the method's own name of its outer iterations.
    pub it_name: String,
    /// Cells along the edge of a subdomain.
    pub cells: usize,
    /// Relative tolerance of a step.
    pub tolerance: f64,
    /// Difference formula, `"three-step"`, `"backward-euler"`, or `"static"`.
    pub formula: String,
    /// Active sets tried.
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

impl RunRecord {
    /// The method as the command line calls it.
    pub fn method_name(&self) -> &str {
        match self.method.as_str() {
            "face" => "active-set",
            other => other,
        }
    }
}

/// One time step.
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
    /// How the step ended.
    pub status: String,
    /// The first earlier step that did not converge and on whose slip this one depends, from 1; absent where there
    /// is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unconverged_history: Option<usize>,
    /// Whether the active-set method gave up and SMALSE finished.
    pub fallback: bool,
    /// Active sets tried.
    pub faces: usize,
    /// Quadratic programs solved by SMALSE.
    pub quadratic_programs: usize,
    /// Estimated factor by which an iteration of the fixed-point loop shrinks the error, if there is one.
    pub contraction: Option<f64>,
    /// Sum of all loads, N.
    pub load: [f64; 3],
}

impl StepRecord {
    /// Reads a result.
    pub fn new(result: &StepResult) -> Self {
        let (sum, report) = (result.summary(), result.report());
        Self {
            step: result.step() + 1,
            t: result.time(),
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
            certificate: finite(result.certificate().largest()),
            certificate_parts: parts(result.certificate()),
            status: report.status.to_string(),
            unconverged_history: result.report().unconverged_history.map(|step| step + 1),
            fallback: report.fallback,
            faces: report.counters.active_sets,
            quadratic_programs: report.counters.quadratic_programs,
            contraction: report.fixed_point.as_ref().and_then(|f| f.rate),
            load: result.reactions().loads.force,
        }
    }

    /// Whether the tolerance was reached.
    pub fn converged(&self) -> bool {
        self.status == "converged"
    }
}

fn parts(certificate: &Certificate) -> BTreeMap<String, f64> {
    let entry = |(name, v): (&str, signorini::contact::result::Violation)| (name.to_owned(), finite(v.relative()));
    certificate.parts().into_iter().map(entry).collect()
}

/// JSON has no infinity.
fn finite(value: f64) -> f64 {
    if value.is_finite() { value } else { f64::MAX }
}

/// Writes runs as a JSON array.
pub fn write_json(path: &Path, runs: &[&RunRecord]) -> Result<(), Failure> {
    save(path, &(serde_json::to_string_pretty(runs)? + "\n"))
}

/// Columns of [`csv`]: names, and where they are in a record if that is another place.
const COLUMNS: &str = "step,t,it,n_m,active,stick,slip,normal_force,tangential_force_x=tangential_force/0,\
                       tangential_force_y=tangential_force/1,normal_norm,tangential_norm,max_slip_rate,max_penetration,\
                       dissipation,dissipation_formula,certificate,status";

/// The steps as comma-separated values with a header line.
pub fn csv(record: &RunRecord) -> Result<String, Failure> {
    let rows: Result<Vec<_>, _> = record.steps.iter().map(serde_json::to_value).collect();
    Ok(columns(COLUMNS, &rows?))
}

/// Values of JSON records as comma-separated columns: `name` or `name=path/in/record` each; empty where there is none.
pub fn columns(names: &str, rows: &[serde_json::Value]) -> String {
    let columns: Vec<_> = names.split(',').map(|c| c.split_once('=').unwrap_or((c, c))).collect();
    let head: Vec<&str> = columns.iter().map(|c| c.0).collect();
    let mut text = head.join(",") + "\n";
    for row in rows {
        let cell = |path: &str| match row.pointer(&format!("/{path}")) {
            None | Some(serde_json::Value::Null) => String::new(),
            Some(serde_json::Value::String(s)) if !s.contains([',', ' ']) => s.clone(),
            Some(value) => value.to_string(),
        };
        let cells: Vec<String> = columns.iter().map(|c| cell(c.1)).collect();
        text += &(cells.join(",") + "\n");
    }
    text
}

/// What happened over time as four charts: nodes in contact, forces, cost and certificate of the steps.
pub fn steps_chart(record: &RunRecord) -> Result<String, Failure> {
    let curve = |name: &str, colour, value: &dyn Fn(&StepRecord) -> f64| {
        Curve::new(name, colour, record.steps.iter().map(|s| (s.t, value(s))))
    };
    let chart = |title: String, unit: &str, log: bool, curves: Vec<Curve>| Chart {
        title,
        axes: ["t in s".to_owned(), unit.to_owned()],
        log: [false, log],
        marks: false,
        legend: true,
        curves,
    };
    let nodes = vec![
        curve("in contact", 5, &|s| s.active as f64),
        curve("stick", 0, &|s| s.stick as f64),
        curve("slip", 1, &|s| s.slip as f64),
    ];
    let forces = vec![
        curve("normal", 5, &|s| 1e-6 * s.normal_force),
        curve("friction along x1", 1, &|s| 1e-6 * s.tangential_force[0]),
    ];
    let cost = vec![
        curve("products", 0, &|s| s.n_m as f64),
        curve(&record.it_name, 2, &|s| s.it as f64),
    ];
    let quality = vec![
        curve("certificate", 0, &|s| s.certificate),
        curve("tolerance", 5, &|_| record.tolerance),
    ];
    let method = record.method_name();
    let RunRecord {
        n, loading, it_name, ..
    } = record;
    let charts = [
        chart(
            format!("n = {n}, loading {loading}, method {method}: nodes of the contact surface"),
            "nodes",
            false,
            nodes,
        ),
        chart("contact forces on the body".to_owned(), "MN", false, forces),
        chart(
            format!("cost of the steps: products with F, and {it_name}"),
            "a step",
            false,
            cost,
        ),
        chart(
            "certificate: largest relative violation of all conditions".to_owned(),
            "relative",
            true,
            quality,
        ),
    ];
    page((900, 980), [4, 1], "", &charts)
}
