//! Linear and quadratic elements on the static brick: what a per mille in the normal force and a per cent in the
//! friction force cost; `--help` lists the options.

use std::io::Write;
use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use signorini::fem_mesh::Decomposition;
use signorini::prelude::*;
use signorini_studies::brick::Block;
use signorini_studies::options::positive;
use signorini_studies::run::pool;
use signorini_studies::{Failure, aligned, exit};

/// Normal and friction force at half load with a coefficient of 0.2 that meshes tend to, N: by Richardson's
/// extrapolation of linear elements with 15, 30, 60 cells a metre, good to 2e-5 and 1e-3.
pub const LIMITS: [f64; 2] = [2.6228e9, -8.38e7];

/// Options of `order`.
#[derive(Debug, Clone, PartialEq, Parser)]
#[command(
    name = "order",
    about = "Linear and quadratic elements on the static brick: error against unknowns and time"
)]
pub struct OrderOptions {
    /// Meshes: order, cells a metre, and how much they are graded towards edges (1 is not at all, the default).
    #[arg(
        long,
        value_delimiter = ',',
        value_name = "ORDER/CELLS[/GRADING]",
        default_value = "1/10,1/20,1/30,2/4,2/6,2/8,1/20/1.3,2/6/1.3,2/6/1.5",
        value_parser = mesh
    )]
    pub mesh: Vec<MeshChoice>,
    /// Rounds over all meshes; the shortest time of each counts.
    #[arg(long, default_value_t = 3, value_parser = positive)]
    pub rounds: usize,
    /// Tolerance of the solver.
    #[arg(long, default_value_t = 1e-6)]
    pub tolerance: f64,
    /// Threads; 0 takes all cores.
    #[arg(long, default_value_t = 1)]
    pub threads: usize,
}

/// A mesh of the brick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshChoice {
    /// Order of the elements.
    pub order: usize,
    /// Cells a metre.
    pub cells: usize,
    /// Exponent of the grading.
    pub grading: f64,
}

/// A mesh with what it gave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// The mesh.
    pub mesh: MeshChoice,
    /// Unknown displacements, each node once.
    pub unknowns: usize,
    /// Products with F.
    pub products: usize,
    /// Relative errors of normal and friction force.
    pub errors: [f64; 2],
    /// Estimated error of the mesh, in the energy norm.
    pub estimate: f64,
    /// Shortest time of set-up and step, s.
    pub seconds: f64,
}

fn mesh(text: &str) -> Result<MeshChoice, String> {
    let wrong = || format!("{text:?} is no mesh; give order (1 or 2), cells a metre and the grading, as 2/6/1.5");
    let fields: Vec<&str> = text.split('/').collect();
    let (order, cells, grading) = match fields[..] {
        [order, cells] => (order, cells, "1"),
        [order, cells, grading] => (order, cells, grading),
        _ => return Err(wrong()),
    };
    let found = MeshChoice {
        order: order.parse().map_err(|_| wrong())?,
        cells: cells.parse().map_err(|_| wrong())?,
        grading: grading.parse().map_err(|_| wrong())?,
    };
    let good = matches!(found.order, 1 | 2) && found.cells > 0 && (1.0..=3.0).contains(&found.grading);
    if good { Ok(found) } else { Err(wrong()) }
}

#[allow(dead_code)]
fn main() -> ExitCode {
    exit(execute(&OrderOptions::parse(), &mut std::io::stdout()).map(drop))
}

/// The brick at half load.
fn scene(choice: MeshChoice) -> Result<Scene, Failure> {
    let block = Block {
        boxes: [3, 1, 1],
        cells: [choice.cells; 3],
        steps: 0,
        floor: Some(Friction::coulomb(0.2)),
        top: [0.0, 0.0, -1.5e9],
        top_history: vec![(0.0, 1.0)],
        end: [4.5e8, 0.0, -7.5e8],
        end_history: vec![(0.0, 1.0)],
        ..Block::default()
    };
    let towards = |s: f64| {
        let half = |s: f64| 0.5 * (2.0 * s).powf(choice.grading);
        if s < 0.5 { half(s) } else { 1.0 - half(1.0 - s) }
    };
    let mut mesh = block.mesh()?;
    // subdomains of whole cells, about 5 an edge, of quadratic elements 3
    let wanted = choice.cells as f64 / if choice.order == 2 { 3.0 } else { 5.0 };
    let divisors = (1..=choice.cells).filter(|b| choice.cells.is_multiple_of(*b));
    let off = |b: &usize| (*b as f64 / wanted).ln().abs();
    let edge = divisors.min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(1);
    // where cells divide badly the library cuts
    let parts = match off(&edge) < 0.5 {
        true => Some(Decomposition::boxes(&mesh, [3 * edge, edge, edge])?.parts().to_vec()),
        false => None,
    };
    if choice.grading > 1.0 {
        mesh = mesh.map_points(|[x, y, z]| [3.0 * towards(x / 3.0), towards(y), towards(z)])?;
    }
    if choice.order == 2 {
        mesh = mesh.raise_order()?;
    }
    let scene = block.scene_on(mesh, Materials::uniform(block.material()?))?;
    Ok(match parts {
        Some(parts) => scene.with_parts(parts),
        None => scene,
    })
}

/// Solves on all meshes in turn, some rounds, and prints the table.
pub fn execute(options: &OrderOptions, out: &mut impl Write) -> Result<Vec<Row>, Failure> {
    let pool = pool(options.threads)?;
    let settings = Settings::default().with_tolerance(options.tolerance);
    let mut rows: Vec<Row> = Vec::new();
    for round in 0..options.rounds {
        for (k, &choice) in options.mesh.iter().enumerate() {
            let scene = scene(choice)?;
            let found = pool.install(|| solve(choice, scene, &settings))?;
            match round {
                0 => rows.push(found),
                _ => rows[k].seconds = rows[k].seconds.min(found.seconds),
            }
        }
    }
    let heads = [
        ["", "order"],
        ["cells", "a metre"],
        ["", "grading"],
        ["", "unknowns"],
        ["products", "with F"],
        ["normal force", "%"],
        ["friction force", "%"],
        ["estimate", "%"],
        ["set-up and", "step, s"],
    ];
    let line = |row: &Row| {
        let percent = |x: f64| format!("{:.3}", 100.0 * x);
        vec![
            row.mesh.order.to_string(),
            row.mesh.cells.to_string(),
            row.mesh.grading.to_string(),
            row.unknowns.to_string(),
            row.products.to_string(),
            percent(row.errors[0]),
            percent(row.errors[1]),
            percent(row.estimate),
            format!("{:.3}", row.seconds),
        ]
    };
    let lines: Vec<Vec<String>> = rows.iter().map(line).collect();
    write!(out, "{}", aligned(&heads, &lines))?;
    writeln!(out, "errors beside the limits {:e} and {:e} N", LIMITS[0], LIMITS[1])?;
    Ok(rows)
}

fn solve(mesh: MeshChoice, scene: Scene, settings: &Settings) -> Result<Row, Failure> {
    let unknowns = 3 * scene.mesh().points().len();
    let start = Instant::now();
    let mut simulation = Simulation::new(scene, settings.clone())?;
    let result = simulation.step()?;
    let seconds = start.elapsed().as_secs_f64();
    result.require_converged()?;
    let force = |c: usize| -> f64 { result.points().iter().map(|p| p.force()[c]).sum() };
    Ok(Row {
        mesh,
        unknowns,
        products: result.report().counters.products,
        errors: [force(2) / LIMITS[0] - 1.0, force(0) / LIMITS[1] - 1.0],
        estimate: result.discretisation_error()?.relative(),
        seconds,
    })
}
