//! The static brick on its floor, and a beam of all kinds of elements, beside CalculiX: the same decks for both codes;
//! `--help` lists the options.
//!
//! Needs `ccx` (Debian: `apt-get install calculix-ccx`); without it only this library runs.

pub mod beam;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

use beam::Beam;
use clap::Parser;
use signorini::deck::Deck;
use signorini::fem_mesh::vec3::{area_vector, norm};
use signorini::prelude::*;
use signorini_studies::brick::{END, GAP, LENGTHS, LIMITS, POISSON, TOP, YOUNG};
use signorini_studies::options::positive;
use signorini_studies::run::pool;
use signorini_studies::{Failure, aligned, exit, save};

/// Coefficient of friction.
const COEFFICIENT: f64 = 0.2;
/// Part of the benchmark's tractions.
const LOAD: f64 = 0.5;
/// Units of the decks: CalculiX's mortar contact stops too soon in metres.
const MILLIMETRES: f64 = 1e3;
const MEGAPASCALS: f64 = 1e-6;

/// Options of `calculix`.
#[derive(Debug, Clone, PartialEq, Parser)]
#[command(
    name = "calculix",
    about = "The static brick and a beam beside CalculiX: the same decks, forces and times"
)]
pub struct CalculixOptions {
    /// Meshes of linear tetrahedra, cells a metre.
    #[arg(long, value_delimiter = ',', default_value = "5,10", value_parser = positive)]
    pub linear: Vec<usize>,
    /// Meshes of quadratic tetrahedra, cells a metre.
    #[arg(long, value_delimiter = ',', default_value = "2,4", value_parser = positive)]
    pub quadratic: Vec<usize>,
    /// Beams of hexahedra and prisms, cells across.
    #[arg(long, value_delimiter = ',', default_value = "1,2,4", value_parser = positive)]
    pub beam: Vec<usize>,
    /// Program of CalculiX.
    #[arg(long, default_value = "ccx")]
    pub ccx: PathBuf,
    /// Seconds after which a run of CalculiX is ended.
    #[arg(long, default_value_t = 120.0)]
    pub limit: f64,
    /// Threads of this library; CalculiX takes those of `OMP_NUM_THREADS`.
    #[arg(long, default_value_t = 1)]
    pub threads: usize,
    /// Folder of the decks.
    #[arg(long, value_name = "FOLDER", default_value = "out/calculix")]
    pub out: PathBuf,
}

/// How a deck says contact and friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Law {
    /// As in the table.
    pub name: &'static str,
    /// Parameter of `*CONTACT PAIR`.
    pub kind: &'static str,
    /// Pressure over penetration, and friction stress over slip below the limit, in Young's moduli a metre; `None` is
    /// exact.
    pub slopes: [Option<f64>; 2],
    /// Who runs it: this library (soft contact with linear elements only), CalculiX with linear, with quadratic
    /// elements.
    runs: [bool; 3],
}

const fn law(name: &'static str, kind: &'static str, slopes: [Option<f64>; 2], runs: [bool; 3]) -> Law {
    Law {
        name,
        kind,
        slopes,
        runs,
    }
}

/// Exact contact; what CalculiX's manual recommends (50 times Young's modulus, a hundredth of it for sticking), which
/// this library follows as well; the stiffest slopes at which CalculiX still converges on these meshes; its mortar
/// contact.
pub const LAWS: [Law; 5] = [
    law("exact", "NODE TO SURFACE", [None; 2], [true, false, false]),
    law(
        "node to surface, recommended",
        "NODE TO SURFACE",
        [Some(50.0), Some(0.5)],
        [true, true, false],
    ),
    law(
        "surface to surface, recommended",
        "SURFACE TO SURFACE",
        [Some(50.0), Some(0.5)],
        [false, true, true],
    ),
    law(
        "surface to surface, stiff",
        "SURFACE TO SURFACE",
        [Some(1000.0), Some(20.0)],
        [false, true, true],
    ),
    law("mortar", "MORTAR", [None, Some(1000.0)], [false, true, true]),
];

/// Force of the floor on the brick, N; `None` if the code did not converge.
pub type Force = Option<[f64; 3]>;

/// What a code finds.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Order of the elements.
    pub order: usize,
    /// Cells a metre.
    pub cells: usize,
    /// Nodes of the brick.
    pub nodes: usize,
    /// Whether it is this library.
    pub own: bool,
    /// The contact.
    pub law: Law,
    /// What it finds.
    pub force: Force,
    /// Reading, solving and writing, s.
    pub seconds: f64,
}

#[allow(dead_code)]
fn main() -> ExitCode {
    exit(execute(&CalculixOptions::parse(), &mut std::io::stdout()).map(drop))
}

/// Writes the decks, runs both codes and prints the table.
pub fn execute(options: &CalculixOptions, out: &mut impl Write) -> Result<(Vec<Row>, Vec<Beam>), Failure> {
    let pool = pool(options.threads)?;
    let found = Command::new(&options.ccx)
        .arg("-v")
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok();
    if !found {
        writeln!(
            out,
            "{} is not found: CalculiX is left out (Debian: apt-get install calculix-ccx; or --ccx PROGRAM)",
            options.ccx.display()
        )?;
    }
    let mut rows = Vec::new();
    let orders = [(1, &options.linear), (2, &options.quadratic)];
    for (order, cells) in orders
        .into_iter()
        .flat_map(|(order, all)| all.iter().map(move |cells| (order, *cells)))
    {
        let mesh = Brick::new(LENGTHS, LENGTHS.map(|length| length as usize * cells)).build()?;
        let mesh = if order == 2 { mesh.raise_order()? } else { mesh };
        let forces = forces(&mesh);
        for law in LAWS {
            let job = |code: &str| {
                let name = format!("{code}-order{order}-{cells}-{}", law.name.replace([' ', ','], ""));
                options.out.join(name).with_extension("inp")
            };
            let mut run = |own: bool, solve: &dyn Fn(&Path) -> Result<Force, Failure>| {
                let path = job(code(own));
                save(&path, &deck(&mesh, &forces, law, own)?)?;
                let start = Instant::now();
                let force = solve(&path)?;
                let row = Row {
                    order,
                    cells,
                    nodes: mesh.points().len(),
                    own,
                    law,
                    force,
                    seconds: start.elapsed().as_secs_f64(),
                };
                eprintln!("{}: {:.2} s", path.display(), row.seconds);
                rows.push(row);
                Ok::<_, Failure>(())
            };
            let [own, linear, quadratic] = law.runs;
            if own && (order == 1 || law.slopes == [None; 2]) {
                run(true, &|path| pool.install(|| solve(path)))?;
            }
            if found && if order == 1 { linear } else { quadratic } {
                run(false, &|path| calculix(options, path, &forces))?;
            }
        }
    }
    let beams = beams(options, found)?;
    write!(out, "{}", table(&rows))?;
    let [normal, friction] = LIMITS;
    writeln!(
        out,
        "errors beside the limits {normal:e} and {friction:e} N of fine meshes; decks: {}",
        options.out.display()
    )?;
    write!(out, "\n{}", beam::table(&beams))?;
    writeln!(
        out,
        "errors of the end of a beam beside {} mm of fine meshes",
        beam::LIMIT
    )?;
    Ok((rows, beams))
}

fn beams(options: &CalculixOptions, found: bool) -> Result<Vec<Beam>, Failure> {
    let mut rows = Vec::new();
    for &cells in &options.beam {
        for (kind, shape, order) in beam::KINDS {
            let beam = beam::Cells::new((shape, order), cells);
            let path = options.out.join(format!("beam-{cells}-{kind}.inp"));
            save(&path, &beam.deck(kind)?)?;
            let printed = if found { run(options, &path)? } else { None };
            rows.push(Beam {
                kind,
                cells,
                own: beam.solve(&path)?,
                calculix: printed.and_then(|text| beam.printed(&text)),
            });
        }
    }
    Ok(rows)
}

fn code(own: bool) -> &'static str {
    if own { "signorini" } else { "calculix" }
}

fn table(rows: &[Row]) -> String {
    let heads = [
        ["", "order"],
        ["cells", "a metre"],
        ["", "nodes"],
        ["", "code"],
        ["", "contact"],
        ["normal", "force, %"],
        ["friction", "force, %"],
        ["", "seconds"],
    ];
    let line = |row: &Row| {
        let error = |k: usize, limit: f64| {
            let relative = row.force.map(|force| 100.0 * (force[k] / limit - 1.0));
            relative.map_or("not converged".to_owned(), |percent| format!("{percent:+.2}"))
        };
        let [normal, friction] = LIMITS;
        vec![
            row.order.to_string(),
            row.cells.to_string(),
            row.nodes.to_string(),
            code(row.own).to_owned(),
            row.law.name.to_owned(),
            error(2, normal),
            error(0, friction),
            format!("{:.2}", row.seconds),
        ]
    };
    aligned(&heads, &rows.iter().map(line).collect::<Vec<_>>())
}

/// Force of the floor by this library.
fn solve(path: &Path) -> Result<Force, Failure> {
    let mut simulation = Simulation::new(Deck::read(path)?.scene()?, Settings::default())?;
    let result = simulation.step()?;
    result.require_converged()?;
    let sum = result.summary();
    let [x, y, _] = sum.friction_force;
    Ok(Some([x, y, sum.normal_force]))
}

/// What CalculiX prints for a deck; `None` if it does not converge in time.
fn run(options: &CalculixOptions, path: &Path) -> Result<Option<String>, Failure> {
    let job = path.with_extension("");
    let name = job.file_name().ok_or("a deck has no name")?;
    let log = std::fs::File::create(job.with_extension("log"))?;
    let _ = std::fs::remove_file(job.with_extension("dat"));
    let mut command = Command::new(&options.ccx);
    command
        .arg(name)
        .current_dir(&options.out)
        .stdout(log)
        .stderr(Stdio::null());
    let (mut child, start) = (command.spawn()?, Instant::now());
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        if start.elapsed().as_secs_f64() > options.limit {
            child.kill()?;
            break child.wait()?;
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    let printed = std::fs::read_to_string(job.with_extension("dat")).unwrap_or_default();
    Ok(status.success().then_some(printed))
}

/// Force of the floor by CalculiX, in balance with loads and reactions; `None` if it does not converge in time.
fn calculix(options: &CalculixOptions, path: &Path, loads: &[(u32, [f64; 3])]) -> Result<Force, Failure> {
    let Some(printed) = run(options, path)? else {
        return Ok(None);
    };
    let mut lines = printed.lines().skip_while(|line| !line.contains("total force"));
    let total = lines.find(|line| !line.trim().is_empty() && !line.contains("total"));
    let total: Option<Vec<f64>> = total
        .map(|line| line.split_whitespace().map(str::parse).collect::<Result<_, _>>())
        .transpose()?;
    let balance = |reaction: Vec<f64>| [0, 1, 2].map(|d| -reaction[d] - loads.iter().map(|(_, f)| f[d]).sum::<f64>());
    Ok(total.filter(|total| total.len() == 3).map(balance))
}

/// The brick above a rigid floor, clamped at x = 0, with half of the benchmark's tractions in one static increment.
/// Rigid bodies are what this library reads; CalculiX diverges with one, and holds all nodes of the floor.
fn deck(mesh: &TetMesh, loads: &[(u32, [f64; 3])], law: Law, own: bool) -> Result<String, Failure> {
    let floor = Brick::new([4.0, 2.0, 1.0], [1; 3]).build()?;
    let floor = floor.map_points(|[x, y, z]| [x - 0.5, y - 0.5, z - 1.0 - GAP])?;
    let mut text = String::from("*HEADING\nstatic brick on a rigid floor; mm, N, MPa\n");
    body(&mut text, mesh, "BRICK", [0; 2])?;
    body(&mut text, &floor, "FLOOR", [mesh.points().len(), mesh.tets().len()])?;
    surface(&mut text, mesh, ("BOTTOM", brick::Z_MIN), 0)?;
    surface(&mut text, &floor, ("GROUND", brick::Z_MAX), mesh.tets().len())?;
    writeln!(text, "*NSET, NSET=CLAMP")?;
    let clamp = mesh.nodes_on(brick::X_MIN);
    clamp.iter().try_for_each(|node| writeln!(text, "{},", node + 1))?;
    writeln!(
        text,
        "*MATERIAL, NAME=STEEL\n*ELASTIC\n{:?}, {POISSON:?}",
        YOUNG * MEGAPASCALS
    )?;
    for body in ["BRICK", "FLOOR"] {
        writeln!(text, "*SOLID SECTION, ELSET={body}, MATERIAL=STEEL")?;
    }
    let first = mesh.points().len() + 1;
    let reference = first + floor.points().len();
    if own {
        writeln!(text, "*NODE\n{reference}, 0., 0., {:?}", -GAP * MILLIMETRES)?;
        writeln!(text, "*RIGID BODY, ELSET=FLOOR, REF NODE={reference}")?;
    }
    let [normal, stick] = law
        .slopes
        .map(|slope| slope.map(|slope| slope * YOUNG * MEGAPASCALS / MILLIMETRES));
    let normal = normal.map_or("HARD".to_owned(), |slope| format!("LINEAR\n{slope:e}"));
    let stick = stick.map_or_else(String::new, |slope| format!(", {slope:e}"));
    writeln!(text, "*SURFACE INTERACTION, NAME=ROUGH")?;
    writeln!(text, "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE={normal}")?;
    writeln!(text, "*FRICTION\n{COEFFICIENT:?}{stick}")?;
    writeln!(
        text,
        "*CONTACT PAIR, INTERACTION=ROUGH, TYPE={}\nBOTTOM, GROUND",
        law.kind
    )?;
    writeln!(text, "*BOUNDARY\nCLAMP, 1, 3")?;
    if own {
        writeln!(text, "{reference}, 1, 6")?
    } else {
        (first..reference).try_for_each(|node| writeln!(text, "{node}, 1, 3"))?
    }
    writeln!(text, "*STEP\n*STATIC, DIRECT\n1., 1.\n*CLOAD")?;
    for (node, force) in loads {
        for (d, force) in force.iter().enumerate().filter(|(_, force)| **force != 0.0) {
            writeln!(text, "{}, {}, {force:?}", node + 1, d + 1)?;
        }
    }
    text.push_str("*NODE PRINT, NSET=CLAMP, TOTALS=ONLY\nRF\n*END STEP\n");
    Ok(text)
}

/// Nodes and elements, numbered behind those `before`.
fn body(text: &mut String, mesh: &TetMesh, name: &str, before: [usize; 2]) -> Result<(), Failure> {
    writeln!(text, "*NODE")?;
    for (k, point) in mesh.points().iter().enumerate() {
        let [x, y, z] = point.map(|x| MILLIMETRES * x);
        writeln!(text, "{}, {x:?}, {y:?}, {z:?}", before[0] + k + 1)?;
    }
    let kind = if mesh.order() == 2 { "C3D10" } else { "C3D4" };
    writeln!(text, "*ELEMENT, TYPE={kind}, ELSET={name}")?;
    for (k, tet) in mesh.tets().iter().enumerate() {
        write!(text, "{}", before[1] + k + 1)?;
        let mids = mesh.mids().get(k).into_iter().flatten();
        tet.iter()
            .chain(mids)
            .try_for_each(|&node| write!(text, ", {}", before[0] + node as usize + 1))?;
        writeln!(text)?;
    }
    Ok(())
}

/// The facets with a tag, as faces of elements numbered behind those `before`.
fn surface(text: &mut String, mesh: &TetMesh, (name, tag): (&str, FacetTag), before: usize) -> Result<(), Failure> {
    writeln!(text, "*SURFACE, NAME={name}")?;
    for (k, facet) in mesh.facets().iter().enumerate().filter(|(_, facet)| facet.tag == tag) {
        let owner = mesh.facet_owner(k);
        let opposite = mesh.tets()[owner].iter().position(|node| !facet.nodes.contains(node));
        // the faces opposite the corners 1 to 4
        let face = [3, 4, 2, 1][opposite.ok_or("a facet is no face")?];
        writeln!(text, "{}, S{face}", before + owner + 1)?;
    }
    Ok(())
}

/// The tractions on top and end as forces at nodes that are not clamped: a third of a facet to each corner, of a
/// quadratic one to each node on its edges.
fn forces(mesh: &TetMesh) -> Vec<(u32, [f64; 3])> {
    let mut forces = BTreeMap::new();
    for (k, facet) in mesh.facets().iter().enumerate() {
        let traction = match facet.tag {
            brick::Z_MAX => TOP,
            brick::X_MAX => END,
            _ => continue,
        };
        let area = norm(area_vector(&mesh.facet_points(k)));
        for node in mesh.facet_mids(k).unwrap_or(facet.nodes) {
            let force = forces.entry(node).or_insert([0.0; 3]);
            traction
                .iter()
                .zip(force)
                .for_each(|(t, force)| *force += LOAD * t * area / 3.0);
        }
    }
    for node in mesh.nodes_on(brick::X_MIN) {
        forces.remove(&node);
    }
    forces.into_iter().collect()
}
