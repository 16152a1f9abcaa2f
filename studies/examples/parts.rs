//! Real parts on meshes of Gmsh, cut by the library: products, seconds, memory and certificates; `--help` lists the
//! options.
//!
//! `studies/meshes/parts.py` makes the meshes; small ones of each part stand beside it. Lengths in mm, forces in N.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

use clap::Parser;
use signorini::fem_mesh::gmsh::{GroupNames, read_gmsh, write_sizes};
use signorini::fem_mesh::{Surface, TetMesh};
use signorini::prelude::*;
use signorini_studies::chart::{Chart, Curve, page};
use signorini_studies::draw::{self, Shown};
use signorini_studies::record::StepRecord;
use signorini_studies::run::{pool, solve};
use signorini_studies::{Failure, exit, save};

/// Young's modulus and Poisson's ratio of steel.
const STEEL: [f64; 2] = [210e3, 0.3];
/// Radius of the ball of the part `sphere`.
const RADIUS: f64 = 10.0;
/// Radius of the contact that the force on the ball is chosen for.
const CONTACT_RADIUS: f64 = 0.8;

/// From where parts are drawn.
const EYE: [f64; 3] = [1.0, -1.6, 0.9];

/// Options of `parts`.
#[derive(Debug, Clone, PartialEq, Parser)]
#[command(name = "parts", about = "Real parts on meshes of Gmsh, cut by the library")]
pub struct PartsOptions {
    /// Meshes `PART-SIZE.msh`, or folders of such; PART is one of bracket, flange, sphere, punch, plates, tooth,
    /// hub, lug, dovetail, bearing.
    #[arg(value_name = "MESH", default_value = concat!(env!("CARGO_MANIFEST_DIR"), "/meshes"))]
    pub meshes: Vec<PathBuf>,
    /// Numbers of subdomains; 0 leaves it to the library.
    #[arg(long, value_delimiter = ',', default_value = "0")]
    pub subdomains: Vec<usize>,
    /// Order of the elements, 1 or 2; 2 puts nodes on the middles of the edges of linear ones.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=2))]
    pub order: u8,
    /// Threads; 0 takes all cores.
    #[arg(long, default_value_t = 0)]
    pub threads: usize,
    /// Draws the pressure under the balls beside the formula into this SVG.
    #[arg(long)]
    pub plot: Option<PathBuf>,
    /// Writes the edge lengths that an error of `target` asks for into this folder, as `PART-SIZE.pos` for Gmsh, and
    /// prints the estimated error; studies/meshes/refine.py goes round with them.
    #[arg(long)]
    pub sizes: Option<PathBuf>,
    /// Error that `sizes` asks for, relative, in the energy norm.
    #[arg(long, default_value_t = 0.1)]
    pub target: f64,
    /// Draws each part at its end, by von Mises stress, into this folder.
    #[arg(long)]
    pub pictures: Option<PathBuf>,
}

#[allow(dead_code)]
fn main() -> ExitCode {
    exit(execute(&PartsOptions::parse(), &mut std::io::stdout()))
}

/// A run of one part.
#[derive(Debug, Clone)]
pub struct PartRun {
    /// Name of the part.
    pub part: String,
    /// Fewest and most tetrahedra of a subdomain.
    pub tets: [usize; 2],
    /// The steps.
    pub steps: Vec<StepRecord>,
    /// The part `sphere` beside Hertz's formula.
    pub hertz: Option<Hertz>,
}

/// Solves all parts in all partitions and prints a row for each.
pub fn execute(options: &PartsOptions, out: &mut (impl Write + Send)) -> Result<Vec<PartRun>, Failure> {
    let pool = pool(options.threads)?;
    writeln!(
        out,
        "| part | tetrahedra | subdomains (tetrahedra) | rows | products a step (dearest) | set-up s | solve s | matrices MB | certificate | moves mm |"
    )?;
    writeln!(out, "|---|---|---|---|---|---|---|---|---|---|")?;
    let mut runs = Vec::new();
    for path in files(&options.meshes)? {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let part = stem.split('-').next().unwrap_or_default().to_owned();
        let (mut mesh, names) = read_gmsh(&path)?;
        if options.order > mesh.order() as u8 {
            mesh = mesh.raise_order()?;
        }
        for &count in &options.subdomains {
            let (run, last) = pool.install(|| run(&part, &mesh, &names, count, out))?;
            if let (Some(folder), Some(last)) = (&options.sizes, &last) {
                let error = last.discretisation_error()?;
                std::fs::create_dir_all(folder)?;
                write_sizes(
                    folder.join(format!("{stem}.pos")),
                    &mesh,
                    &error.wanted_sizes(&mesh, options.target)?,
                )?;
                let (tets, relative) = (mesh.tets().len(), 100.0 * error.relative());
                let planned = 100.0
                    * Plan::new(last.scene(), &Settings::default())?
                        .mesh_error
                        .unwrap_or(f64::NAN);
                writeln!(
                    out,
                    "{stem}: {tets} tetrahedra, estimated error {relative:.2} %, the plan's {planned:.1} %"
                )?;
            }
            if let (Some(folder), Some(last)) = (&options.pictures, last) {
                let text = draw::result(&last, Shown::VonMises, EYE);
                save(&folder.join(format!("{stem}.svg")), &text)?;
            }
            runs.push(run);
        }
    }
    let mut balls: Vec<&Hertz> = runs.iter().filter_map(|run| run.hertz.as_ref()).collect();
    // the same for all partitions of a mesh, but for the last digits
    balls.dedup_by_key(|ball| ball.nodes);
    for ball in &balls {
        writeln!(out, "\nsphere, {} pressed nodes: {ball}", ball.nodes)?;
    }
    if let Some(path) = &options.plot {
        save(path, &chart(&balls)?)?;
    }
    Ok(runs)
}

/// The meshes that these paths name, those of a folder by name.
fn files(paths: &[PathBuf]) -> Result<Vec<PathBuf>, Failure> {
    let mut found = Vec::new();
    for path in paths {
        if !path.is_dir() {
            found.push(path.clone());
            continue;
        }
        let entries = path.read_dir()?.collect::<Result<Vec<_>, _>>()?;
        let mut meshes: Vec<PathBuf> = entries.iter().map(|entry| entry.path()).collect();
        meshes.retain(|path| path.extension() == Some("msh".as_ref()));
        meshes.sort();
        found.extend(meshes);
    }
    if found.is_empty() {
        return Err(format!("no .msh in {paths:?}; studies/meshes/parts.py makes some").into());
    }
    Ok(found)
}

fn run(
    part: &str,
    mesh: &TetMesh,
    names: &GroupNames,
    count: usize,
    out: &mut (impl Write + Send),
) -> Result<(PartRun, Option<Arc<StepResult>>), Failure> {
    let mut scene = scene(part, mesh, names)?;
    if count > 0 {
        scene = scene.with_subdomains(count);
    }
    let (simulation, steps, seconds) = solve(scene, Settings::default(), &mut |_, _| Ok(()))?;
    let subdomains = simulation.decomposition().subdomains();
    let sizes = subdomains.iter().map(|s| s.tets.len());
    let tets = [sizes.clone().min().unwrap_or(0), sizes.max().unwrap_or(0)];
    let products: Vec<usize> = steps.iter().map(|s| s.n_m).collect();
    let report = simulation.tfeti().report();
    let bytes = report.inverse_bytes + report.coarse_bytes + report.table_bytes;
    let certificate = steps.iter().map(|s| s.certificate).fold(0.0, f64::max);
    let unconverged = steps.iter().filter(|s| !s.converged()).count();
    let displacement = simulation.result().map(|result| result.displacement());
    let lengths = displacement.iter().flatten().map(|[x, y, z]| x.hypot(*y).hypot(*z));
    let farthest = lengths.fold(0.0, f64::max);
    writeln!(
        out,
        "| {part} | {} | {}{} ({} to {}) | {} | {:.1} ({}) | {:.2} | {:.2} | {:.0} | {certificate:.1e}{} | {farthest:.5} |",
        mesh.tets().len(),
        subdomains.len(),
        if count == 0 { ", automatic" } else { "" },
        tets[0],
        tets[1],
        simulation.plan().dual(),
        products.iter().sum::<usize>() as f64 / products.len() as f64,
        products.iter().max().unwrap_or(&0),
        simulation.setup_time().as_secs_f64(),
        seconds,
        bytes as f64 * 1e-6,
        match unconverged {
            0 => String::new(),
            count => format!(", {count} NOT CONVERGED"),
        },
    )?;
    let hertz = (part == "sphere").then(|| Hertz::new(&simulation));
    let run = PartRun {
        part: part.to_owned(),
        tets,
        steps,
        hertz: hertz.flatten(),
    };
    Ok((run, simulation.result().cloned()))
}

/// What is done to a part.
fn scene(part: &str, mesh: &TetMesh, names: &GroupNames) -> Result<Scene, Failure> {
    let surface = |name: &str| names.surface(name);
    let push = |name: &str, force: [f64; 3]| -> Result<Load, Failure> {
        let tag = surface(name)?;
        let area = Surface::new(mesh, &[tag])?.total_area();
        Ok(Load::traction(tag, force.map(|f| f / area)))
    };
    let steps = Analysis::quasistatic(1.0, 10).with_formula(DifferenceFormula::BACKWARD_EULER);
    let ramp = History::ramp(1.0, 1.0)?;
    let floor = |name: &str, coefficient: f64| -> Result<Contact, Failure> {
        Ok(Contact::rigid(surface(name)?).with_friction(Friction::coulomb(coefficient)))
    };
    let between = |a: &str, b: &str, coefficient: f64| -> Result<Contact, Failure> {
        Ok(Contact::between(surface(a)?, surface(b)?).with_friction(Friction::coulomb(coefficient)))
    };
    let later = History::table(vec![(0.0, 0.0), (1.0, 0.0), (2.0, 1.0)])?;
    let steel = Hooke::isotropic(STEEL[0], STEEL[1])?;
    let made_of = |materials| Scene::new(mesh.clone(), materials);
    let bare = || made_of(Materials::uniform(steel));
    Ok(match part {
        // held by the friction of its feet alone; 2000 N would pull it away
        "bracket" => bare()
            .with_contact(floor("floor", 0.2)?)
            .with_load(push("bolt", [0.0, 0.0, -10e3])?)
            .with_load(push("end", [1500.0, 0.0, 0.0])?.with_history(ramp))
            .with_analysis(steps),
        // pressed on by 0.02 mm, then pulled along the shaft with 30 kN
        "hub" => bare()
            .with_support(Support::fixed(surface("end")?))
            .with_contact(between("seat", "bore", 0.2)?.with_gap(-0.02).with_gap_history(ramp))
            .with_load(push("rim", [0.0, 0.0, 30e3])?.with_history(later))
            .with_analysis(Analysis::quasistatic(2.0, 10)),
        "lug" => bare()
            .with_support(Support::fixed(surface("ends")?))
            .with_contact(between("skin", "bore", 0.2)?)
            .with_load(push("pull", [20e3, 0.0, 0.0])?.with_history(ramp))
            .with_analysis(Analysis::quasistatic(1.0, 5)),
        // pulled, then bent while the pull falls to a half and rises again
        "dovetail" => {
            let pull = History::table(vec![(0.0, 0.0), (1.0, 1.0), (2.0, 0.5), (3.0, 1.0)])?;
            bare()
                .with_support(Support::fixed(surface("foot")?))
                .with_contact(between("root", "slot", 0.2)?)
                .with_load(push("tip", [0.0, 0.0, 20e3])?.with_history(pull))
                .with_load(push("tip", [2e3, 0.0, 0.0])?.with_history(later))
                .with_analysis(Analysis::quasistatic(3.0, 9))
        }
        // nothing but contact holds the balls and the inner ring
        "bearing" => {
            let push = push("bore", [1000.0, 0.0, 0.0])?.with_history(ramp);
            let mut scene = bare().with_support(Support::fixed(surface("seat")?)).with_load(push);
            for skin in (0..8).map(|k| format!("skin {k}")) {
                for groove in ["inside", "outside"] {
                    scene = scene.with_contact(between(&skin, groove, 0.2)?);
                }
            }
            scene.with_analysis(Analysis::quasistatic(1.0, 3))
        }
        // the heads of its bolts come down by 0.03 mm, then 1 MPa lifts the cover; all bodies slide on the gasket
        "flange" => {
            let soft = Hooke::isotropic(500.0, 0.4)?;
            let volume = |name: &str| names.volume(name);
            let table = vec![
                (volume("base")?, steel),
                (volume("cover")?, steel),
                (volume("gasket")?, soft),
            ];
            let heads = between("heads", "outside", 0.3)?.with_gap(-0.03).with_gap_history(ramp);
            made_of(Materials::new(table)?)
                .with_support(Support::fixed(surface("foot")?))
                .with_contact(between("below", "seat", 0.3)?)
                .with_contact(between("above", "inside", 0.3)?)
                .with_contact(heads)
                .with_load(Load::pressure(surface("inside")?, 1.0).with_history(later))
                .with_analysis(Analysis::quasistatic(2.0, 4))
        }
        "sphere" => bare()
            .with_support(Support::partial(surface("x")?, component(0)))
            .with_support(Support::partial(surface("y")?, component(1)))
            .with_load(push("top", [0.0, 0.0, -Hertz::load() / 4.0])?)
            .with_contact(Contact::half_space(surface("ball")?, [0.0; 3], [0.0, 0.0, 1.0])),
        // pressed, then pushed with half of what friction holds
        "punch" => bare()
            .with_contact(
                Contact::half_space(surface("floor")?, [0.0; 3], [0.0, 0.0, 1.0]).with_friction(Friction::coulomb(0.3)),
            )
            .with_load(push("top", [0.0, 0.0, -20e3])?)
            .with_load(push("top", [3e3, 0.0, 0.0])?.with_history(ramp))
            .with_analysis(steps),
        // between a plate that stands and one that presses and then drags
        "plates" => {
            let below = Contact::rigid(surface("below")?).with_friction(Friction::coulomb(0.4));
            let above = Contact::rigid(surface("above")?)
                .with_friction(Friction::coulomb(0.2))
                .with_motion([0.02, 0.0, -0.005], ramp);
            bare().with_contact(below).with_contact(above).with_analysis(steps)
        }
        // a rack presses the flank, 20 degrees from the vertical, and rubs upwards along it
        "tooth" => {
            let (sin, cos) = 20f64.to_radians().sin_cos();
            let normal = [-cos, 0.0, -sin];
            let slide = [-0.03 * cos - 0.03 * sin, 0.0, -0.03 * sin + 0.03 * cos];
            bare()
                .with_support(Support::fixed(surface("rim")?))
                .with_contact(
                    Contact::half_space(surface("flank")?, [8.0, 0.0, 0.0], normal)
                        .with_friction(Friction::coulomb(0.1))
                        .with_motion(slide, ramp),
                )
                .with_analysis(steps)
        }
        other => return Err(format!("no scene for the part {other}").into()),
    })
}

fn component(axis: usize) -> Directions {
    Directions::Components(std::array::from_fn(|k| k == axis))
}

/// Hertz's contact of a ball with a rigid plane, beside what was computed for a quarter of it.
///
/// K. L. Johnson, *Contact Mechanics*, 1985, section 4.2.
#[derive(Debug, Clone, PartialEq)]
pub struct Hertz {
    /// Nodes pressed.
    pub nodes: usize,
    /// Contact force over the load, less 1.
    pub force: f64,
    /// Largest pressure by the formula for the force that acts.
    pub peak: f64,
    /// Radius of the contact by the formula, and that of a disc with the pressed nodes' area, over it, less 1.
    pub radius: f64,
    /// Force over area at the pressed nodes within 0.8 of the radius, off the profile: root of the mean square, over
    /// the peak.
    pub rough: f64,
    /// The same of the library's contact pressure.
    pub smooth: f64,
    /// The largest of these distances.
    pub worst: f64,
    /// The library's contact pressure within a third of the radius, the mean over the nodes, off that of the profile,
    /// over the peak.
    pub middle: f64,
    /// Distance from the axis over the radius, and the library's contact pressure over the peak, of each node.
    pub pressures: Vec<(f64, f64)>,
}

impl Hertz {
    /// Force on the whole ball for [`CONTACT_RADIUS`].
    fn load() -> f64 {
        4.0 * Self::modulus() * CONTACT_RADIUS.powi(3) / (3.0 * RADIUS)
    }

    fn modulus() -> f64 {
        STEEL[0] / (1.0 - STEEL[1] * STEEL[1])
    }

    fn new(simulation: &Simulation) -> Option<Self> {
        let result = simulation.result()?;
        let pressed: Vec<_> = result.points().iter().filter(|p| p.force()[2] > 0.0).collect();
        let force: f64 = 4.0 * pressed.iter().map(|p| p.force()[2]).sum::<f64>();
        let radius = (3.0 * force * RADIUS / (4.0 * Self::modulus())).cbrt();
        let area = std::f64::consts::PI * radius * radius;
        let peak = 1.5 * force / area;
        let covered: f64 = 4.0 * pressed.iter().map(|p| p.area).sum::<f64>();
        let points = result.scene().mesh().points();
        let place = |node: u32| points[node as usize][0].hypot(points[node as usize][1]) / radius;
        let over_area = pressed.iter().map(|p| (place(p.node), p.force()[2] / p.area / peak));
        let nodes = result.surfaces()[0].nodes();
        let pressure = result.contact_pressure(0)?;
        let pressures: Vec<_> = nodes
            .iter()
            .zip(&pressure)
            .map(|(n, p)| (place(*n), p / peak))
            .collect();
        let off = |&(r, p): &(f64, f64)| p - profile(r);
        let within = |r: f64| pressures.iter().filter(move |p| p.0 < r);
        let squares = |p: &(f64, f64)| off(p).powi(2);
        Some(Self {
            nodes: pressed.len(),
            force: force / Self::load() - 1.0,
            peak,
            radius: (covered / area).sqrt() - 1.0,
            rough: mean(over_area.filter(|p| p.0 < 0.8).map(|p| squares(&p))).sqrt(),
            smooth: mean(within(0.8).map(squares)).sqrt(),
            worst: within(0.8).map(|p| off(p).abs()).fold(0.0, f64::max),
            middle: mean(within(1.0 / 3.0).map(off)),
            pressures,
        })
    }
}

/// Hertz's pressure over its peak, at a distance over the radius.
fn profile(r: f64) -> f64 {
    (1.0 - r * r).max(0.0).sqrt()
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), v| (sum + v, count + 1));
    sum / f64::from(count)
}

impl std::fmt::Display for Hertz {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "force {:+.0e}, p0 {:.0} N/mm2 (Hertz), radius {:+.1} %; off the profile by, of p0: force over area {:.1} %, \
             contact pressure {:.2} %, at worst {:.1} %, in the middle {:+.2} %",
            self.force,
            self.peak,
            100.0 * self.radius,
            100.0 * self.rough,
            100.0 * self.smooth,
            100.0 * self.worst,
            100.0 * self.middle
        )
    }
}

/// The contact pressure under the balls over the distance from the axis.
fn chart(balls: &[&Hertz]) -> Result<String, Failure> {
    let formula = (0..=150).map(|k| f64::from(k) / 100.0).map(|r| (r, profile(r)));
    let mut curves = vec![Curve::new("Hertz", 5, formula)];
    for (k, ball) in balls.iter().enumerate() {
        let mut points: Vec<_> = ball.pressures.iter().copied().filter(|p| p.0 < 1.5).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        curves.push(Curve::new(format!("{} pressed nodes", ball.nodes), k, points));
    }
    let chart = Chart {
        title: "Contact pressure under a ball".into(),
        axes: [
            "distance from the axis / radius".into(),
            "pressure / largest by Hertz".into(),
        ],
        log: [false; 2],
        marks: false,
        legend: true,
        curves,
    };
    page((720, 420), [1, 1], "", &[chart])
}
