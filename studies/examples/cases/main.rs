//! Published problems with known answers, on meshes that do not match; `--help` lists the options.
//!
//! Each case is a file: it makes the scene, solves it and compares with the target. `--out FILE` writes the page
//! `docs/reports/cases.md`.

pub mod blocks;
pub mod crack;
pub mod curved;
pub mod dovetail;
pub mod meshes;
pub mod mindlin;
pub mod orthotropic;
pub mod plate;
pub mod press_fit;
pub mod punch;
pub mod rigid_sphere;
pub mod spheres;
pub mod wedge;

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use signorini::prelude::*;
use signorini_studies::{Failure, aligned, exit, save};

/// Options of `cases`.
#[derive(Debug, Clone, PartialEq, Eq, Parser)]
#[command(
    name = "cases",
    about = "Published problems with known answers, on meshes that do not match"
)]
pub struct CasesOptions {
    /// Only these: blocks, curved, plate, press-fit, wedge, dovetail, orthotropic, crack, punch, spheres, mindlin,
    /// rigid-sphere.
    #[arg(long, value_delimiter = ',')]
    pub case: Vec<String>,
    /// Coarse meshes: seconds in place of minutes, and larger errors.
    #[arg(long)]
    pub short: bool,
    /// Write the page of the cases to this file.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// A number that a case compares with its target.
#[derive(Debug, Clone)]
pub struct Finding {
    /// Which case and which of its variants.
    pub case: String,
    /// What is compared, with its unit.
    pub quantity: &'static str,
    /// What was found.
    pub value: f64,
    /// What it should be; 0 where the value is an error itself.
    pub target: f64,
    /// Largest relative error (or value) that passes on the full mesh; 0 where nothing is asked for.
    pub asked: f64,
    /// The run.
    pub run: RunFacts,
}

impl Finding {
    /// All fields in their order.
    pub fn new(case: &str, quantity: &'static str, value: f64, target: f64, asked: f64, run: RunFacts) -> Self {
        Self {
            case: case.to_owned(),
            quantity,
            value,
            target,
            asked,
            run,
        }
    }

    /// Relative error, or the value where the target is 0.
    pub fn error(&self) -> f64 {
        match self.target {
            0.0 => self.value.abs(),
            target => (self.value / target - 1.0).abs(),
        }
    }
}

/// What a run took.
#[derive(Debug, Clone, Copy, Default)]
pub struct RunFacts {
    /// Tetrahedra.
    pub tets: usize,
    /// Subdomains.
    pub subdomains: usize,
    /// Products with F in the dearest step.
    pub products: usize,
    /// Seconds from the scene to the last step.
    pub seconds: f64,
    /// The worst certificate.
    pub certificate: f64,
}

/// Solves all steps of a scene and hands each to `see`.
pub fn solve(scene: Scene, settings: Settings, mut see: impl FnMut(&StepResult)) -> Result<RunFacts, Failure> {
    let started = Instant::now();
    let mut facts = RunFacts {
        tets: scene.mesh().tets().len(),
        ..RunFacts::default()
    };
    let mut simulation = Simulation::new(scene, settings)?;
    facts.subdomains = simulation.tfeti().subdomains();
    while !simulation.is_finished() {
        let result = simulation.step()?;
        let report = result.report();
        if !report.status.converged() {
            return Err(format!("a step did not converge: {}", report.status).into());
        }
        facts.products = facts.products.max(report.counters.products);
        facts.certificate = facts.certificate.max(result.certificate().largest());
        see(&result);
    }
    facts.seconds = started.elapsed().as_secs_f64();
    Ok(facts)
}

/// The image of a mesh below the plane z = 0, as the second body.
pub fn below(mesh: &TetMesh) -> Result<TetMesh, Failure> {
    let points = mesh.points().iter().map(|[x, y, z]| [*x, *y, -z]).collect();
    let tets = mesh.tets().iter().map(|[a, b, c, d]| [*b, *a, *c, *d]).collect();
    Ok(TetMesh::new(points, tets, mesh.facets().to_vec())?.map_tags(second))
}

/// Tags of the second body.
pub fn second(tag: FacetTag) -> FacetTag {
    FacetTag(tag.0 + 10)
}

#[allow(dead_code)]
fn main() -> ExitCode {
    exit(execute(&CasesOptions::parse(), &mut std::io::stdout()))
}

type Case = fn(bool) -> Result<Vec<Finding>, Failure>;
const CASES: [(&str, Case); 12] = [
    ("blocks", blocks::findings),
    ("curved", curved::findings),
    ("plate", plate::findings),
    ("press-fit", press_fit::findings),
    ("wedge", wedge::findings),
    ("dovetail", dovetail::findings),
    ("orthotropic", orthotropic::findings),
    ("crack", crack::findings),
    ("punch", punch::findings),
    ("spheres", spheres::findings),
    ("mindlin", mindlin::findings),
    ("rigid-sphere", rigid_sphere::findings),
];

/// Runs the cases and prints their table.
pub fn execute(options: &CasesOptions, out: &mut impl Write) -> Result<Vec<Finding>, Failure> {
    let chosen = |name: &str| options.case.is_empty() || options.case.iter().any(|c| c == name);
    if let Some(unknown) = options.case.iter().find(|c| CASES.iter().all(|(name, _)| name != c)) {
        let known = CASES.map(|(name, _)| name).join(", ");
        return Err(format!("there is no case {unknown:?}; there are {known}").into());
    }
    let mut all = Vec::new();
    for (name, case) in CASES.iter().filter(|(name, _)| chosen(name)) {
        let findings = case(options.short).map_err(|e| format!("{name}: {e}"))?;
        writeln!(
            out,
            "{name}\n{}",
            aligned(&HEADS, &findings.iter().map(row).collect::<Vec<_>>())
        )?;
        all.extend(findings);
    }
    if let Some(path) = &options.out {
        save(path, &page(&all, options))?;
    }
    // coarse meshes are not what the limits are for
    if !options.short {
        within_limits(&all)?;
    }
    Ok(all)
}

/// Refuses errors above what is asked for.
pub fn within_limits(findings: &[Finding]) -> Result<(), Failure> {
    let above = |f: &&Finding| f.asked > 0.0 && (f.error() > f.asked || f.error().is_nan());
    let list: Vec<String> = findings.iter().filter(above).map(|f| row(f).join(" | ")).collect();
    if list.is_empty() {
        Ok(())
    } else {
        Err(format!("errors above their limits:\n{}", list.join("\n")).into())
    }
}

const HEADS: [[&str; 2]; 10] = [
    ["", "case"],
    ["", "quantity"],
    ["", "found"],
    ["", "target"],
    ["", "error"],
    ["", "limit"],
    ["tetra-", "hedra"],
    ["products,", "worst step"],
    ["", "seconds"],
    ["certi-", "ficate"],
];

fn row(f: &Finding) -> Vec<String> {
    vec![
        f.case.clone(),
        f.quantity.to_owned(),
        format!("{:.6e}", f.value),
        if f.target == 0.0 { "0".to_owned() } else { format!("{:.6e}", f.target) },
        format!("{:.1e}", f.error()),
        if f.asked == 0.0 { "-".to_owned() } else { format!("{:e}", f.asked) },
        f.run.tets.to_string(),
        f.run.products.to_string(),
        format!("{:.2}", f.run.seconds),
        format!("{:.0e}", f.run.certificate),
    ]
}

fn page(findings: &[Finding], options: &CasesOptions) -> String {
    let command = format!(
        "cargo run --release --example cases -- --out docs/reports/cases.md{}",
        if options.short { " --short" } else { "" }
    );
    let mut text = format!(
        "# Cases with known answers\n\nBodies in contact or tied, mostly with non-matching meshes, compared with closed-form solutions and \
         published numbers. The sources, with formulas, are in [cases](../../studies/examples/cases). This command wrote the page:\n\n```sh\n{command}\n```\n\n\
         The error is relative to the target, or absolute if the target is 0; *limit* is the largest error that passes.\n\n"
    );
    let heads = HEADS.map(|[a, b]| format!("{a} {b}").trim().replace("- ", ""));
    text += "In the rows *pulled* the library partitions the cubes. *Pairs over matching meshes* compares their products with \
             those of matching meshes of the finer side.\n\n";
    text += &format!("| {} |\n|{}\n", heads.join(" | "), "---|".repeat(heads.len()));
    for finding in findings {
        text += &format!("| {} |\n", row(finding).join(" | "));
    }
    text += &others(findings);
    text
}

/// What the best other code is known to get, by the first words of a case.
const OTHERS: [(&str, &str); 11] = [
    (
        "plate",
        "Code_Aster, three-dimensional models: 2.846 to 2.964e-5 m at 0 mm, -0.5 to 3.6 %; 5 % allowed",
    ),
    (
        "patch test",
        "Code_Aster: exact to the printed digits; Tribol: 1e-10 in pressure, 1e-7 in displacement",
    ),
    (
        "pulled",
        "no T-FETI code has friction on such meshes; ESPRESO, without friction, one contact pair: 230 to 360 iterations \
         on a small Hertz problem",
    ),
    (
        "press fit",
        "a published CalculiX model is wrong by a factor of 2.3, without a warning",
    ),
    ("wedge", "FrontISTR: 5e-4"),
    ("orthotropic", "no published result known"),
    ("crack", "GEOS: only curves in its documentation"),
    (
        "punch",
        "Code_Aster, linear elements: 1.7 %; its quadratic elements give the target",
    ),
    (
        "two spheres",
        "CalculiX: mortar contact with quadratic elements did not converge on the brick; no figure for spheres",
    ),
    ("Cattaneo", "only plots"),
    ("rigid sphere", "MoFEM: 2e-3 at Poisson's ratio 0.3"),
];

/// The largest error here beside what others get.
fn others(findings: &[Finding]) -> String {
    let mut text =
        "\n## Results of other codes\n\nAs published, or as asserted in their tests; CalculiX 2.20 was run for this project.\n\n\
         | case | largest error here | best other code |\n|---|---|---|\n"
            .to_owned();
    for (start, other) in OTHERS {
        let errors = |f: &&Finding| f.asked > 0.0 && !f.quantity.starts_with("products");
        let own = findings.iter().filter(|f| f.case.starts_with(start)).filter(errors);
        if let Some(worst) = own.map(Finding::error).reduce(f64::max) {
            text += &format!("| {start} | {worst:.1e} | {other} |\n");
        }
    }
    text
}
