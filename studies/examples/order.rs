//! Linear and quadratic elements on the static brick: what a per mille in the normal force and a per cent in the
//! friction force cost, and how fast the error of the strains falls; `--help` lists the options.

use std::io::Write;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

use clap::Parser;
use signorini::contact::StepResult;
use signorini::fem_mesh::fields::{energy_of_difference, strain_energy};
use signorini::prelude::*;
use signorini_studies::brick::{GAP, LENGTHS, LIMITS, by_centre, steel};
use signorini_studies::options::positive;
use signorini_studies::run::pool;
use signorini_studies::{Failure, aligned, exit};

/// Options of `order`.
#[derive(Debug, Clone, PartialEq, Parser)]
#[command(
    name = "order",
    about = "Linear and quadratic elements on the static brick: error against unknowns and time"
)]
pub struct OrderOptions {
    /// Meshes: order, cells a metre, and how much they are graded towards edges (1 is not at all, the default); or
    /// cells along x, y and z as 18x4x6, and grading along each as 1x1x1.5.
    #[arg(
        long,
        value_delimiter = ',',
        value_name = "ORDER/CELLS[/GRADING]",
        default_value = "1/10,1/20,1/30,2/4,2/6,2/8,1/20/1.3,2/6/1.3,2/6/1.5",
        value_parser = mesh
    )]
    pub mesh: Vec<MeshChoice>,
    /// A fine mesh beside which the error of the strains is measured, as well.
    #[arg(long, value_name = "ORDER/CELLS[/GRADING]", value_parser = mesh)]
    pub reference: Option<MeshChoice>,
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
    /// Cells along each edge.
    pub cells: [usize; 3],
    /// Exponent of the grading along each edge: cells of size `s^(grading - 1)` at the distance `s^grading` from an
    /// end.
    pub grading: [f64; 3],
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
    /// Error beside the reference in the energy norm, if there is one.
    pub energy: Option<f64>,
    /// Shortest time of set-up and step, s.
    pub seconds: f64,
}

fn mesh(text: &str) -> Result<MeshChoice, String> {
    let wrong =
        || format!("{text:?} is no mesh; give order (1 or 2), cells and grading, as 2/6/1.5 or 2/18x4x6/1x1x1.5");
    let mut fields = text.split('/');
    let order = fields.next().and_then(|t| t.parse().ok()).ok_or_else(wrong)?;
    let mut three = |default: Option<&str>| {
        let text = fields.next().or(default)?;
        let numbers: Vec<f64> = text.split('x').map(|t| t.parse().ok()).collect::<Option<_>>()?;
        Some((numbers.len(), [0, 1, 2].map(|d| *numbers.get(d).unwrap_or(&numbers[0]))))
    };
    let (given, mut cells) = three(None).ok_or_else(wrong)?;
    let (along, grading) = three(Some("1")).ok_or_else(wrong)?;
    if given == 1 {
        // a metre
        cells[0] *= 3.0;
    }
    let good = matches!(order, 1 | 2)
        && [given, along].iter().all(|n| matches!(n, 1 | 3))
        && cells.iter().all(|c| *c >= 1.0 && *c < 1e4 && c.fract() == 0.0)
        && grading.iter().all(|g| (1.0..=3.0).contains(g))
        && fields.next().is_none();
    let found = MeshChoice {
        order,
        cells: cells.map(|c| c as usize),
        grading,
    };
    if good { Ok(found) } else { Err(wrong()) }
}

impl MeshChoice {
    fn mesh(&self) -> Result<TetMesh, Failure> {
        let mut mesh = Brick::new(LENGTHS, self.cells).build()?;
        if self.grading != [1.0; 3] {
            let towards = |place: f64, d: usize| {
                let half = |s: f64| 0.5 * (2.0 * s).powf(self.grading[d]);
                let s = place / LENGTHS[d];
                LENGTHS[d] * if s < 0.5 { half(s) } else { 1.0 - half(1.0 - s) }
            };
            mesh = mesh.map_points(|p| [0, 1, 2].map(|d| towards(p[d], d)))?;
        }
        Ok(if self.order == 2 { mesh.raise_order()? } else { mesh })
    }

    /// Subdomains of whole cells, about 5 along an edge, of quadratic elements 2. `None` leaves the cut to the library:
    /// where x is graded no subdomains share matrices.
    fn parts(&self) -> Result<Option<Vec<u32>>, Failure> {
        if self.grading[0] != 1.0 {
            return Ok(None);
        }
        let wanted = if self.order == 2 { 2.0 } else { 5.0 };
        let boxes = self.cells.map(|n| (n as f64 / wanted).round().max(1.0) as usize);
        let even = Brick::new(LENGTHS, self.cells).build()?;
        Ok(Some(by_centre(&even, |centre| {
            let [x, y, z] = [0, 1, 2].map(|d| {
                let cell = (centre[d] / LENGTHS[d] * self.cells[d] as f64) as usize;
                cell * boxes[d] / self.cells[d]
            });
            (x + boxes[0] * (y + boxes[1] * z)) as u32
        })))
    }

    /// The brick at half load.
    fn scene(&self) -> Result<Scene, Failure> {
        let floor = Contact::rigid(brick::Z_MIN).with_friction(Friction::coulomb(0.2));
        let scene = Scene::new(self.mesh()?, steel()?)
            .with_support(Support::fixed(brick::X_MIN))
            .with_load(Load::traction(brick::Z_MAX, [0.0, 0.0, -1.5e9]))
            .with_load(Load::traction(brick::X_MAX, [4.5e8, 0.0, -7.5e8]))
            .with_contact(floor.with_gap(GAP));
        Ok(match self.parts()? {
            Some(parts) => scene.with_parts_as_given(parts),
            None => scene,
        })
    }
}

/// Three numbers, or one where they are the same.
fn three<T: PartialEq + ToString>(numbers: &[T; 3]) -> String {
    let [x, y, z] = numbers;
    if x == y && y == z {
        x.to_string()
    } else {
        numbers.each_ref().map(T::to_string).join(" x ")
    }
}

#[allow(dead_code)]
fn main() -> ExitCode {
    exit(execute(&OrderOptions::parse(), &mut std::io::stdout()).map(drop))
}

/// Solves on all meshes in turn, some rounds, and prints the table.
pub fn execute(options: &OrderOptions, out: &mut impl Write) -> Result<Vec<Row>, Failure> {
    let pool = pool(options.threads)?;
    let settings = Settings::default().with_tolerance(options.tolerance);
    let fine = options.reference.map(|mesh| pool.install(|| solve(mesh, &settings)));
    let fine = fine.transpose()?.map(|(_, result)| result);
    let mut rows: Vec<Row> = Vec::new();
    for round in 0..options.rounds {
        for (k, &choice) in options.mesh.iter().enumerate() {
            let (mut found, result) = pool.install(|| solve(choice, &settings))?;
            if round > 0 {
                rows[k].seconds = rows[k].seconds.min(found.seconds);
                continue;
            }
            found.energy = fine.as_ref().map(|fine| distance(fine, &result)).transpose()?;
            rows.push(found);
        }
    }
    let heads = [
        ["", "order"],
        ["", "cells"],
        ["", "grading"],
        ["", "unknowns"],
        ["products", "with F"],
        ["normal force", "%"],
        ["friction force", "%"],
        ["estimate", "%"],
        ["error of", "strains, %"],
        ["set-up and", "step, s"],
    ];
    let line = |row: &Row| {
        let percent = |x: f64| format!("{:.3}", 100.0 * x);
        vec![
            row.mesh.order.to_string(),
            three(&row.mesh.cells),
            three(&row.mesh.grading),
            row.unknowns.to_string(),
            row.products.to_string(),
            percent(row.errors[0]),
            percent(row.errors[1]),
            percent(row.estimate),
            row.energy.map_or_else(|| "-".to_owned(), percent),
            format!("{:.3}", row.seconds),
        ]
    };
    let lines: Vec<Vec<String>> = rows.iter().map(line).collect();
    write!(out, "{}", aligned(&heads, &lines))?;
    writeln!(out, "errors beside the limits {:e} and {:e} N", LIMITS[0], LIMITS[1])?;
    let alike = |a: &Row, b: &Row| (a.mesh.order, a.mesh.grading) == (b.mesh.order, b.mesh.grading);
    for group in rows.chunk_by(alike).filter(|group| group.len() > 1) {
        let slope = |error: fn(&Row) -> Option<f64>| slope(group, error).map_or("-".to_owned(), |p| format!("{p:.2}"));
        let (order, grading) = (group[0].mesh.order, three(&group[0].mesh.grading));
        let (truth, estimate) = (slope(|row| row.energy), slope(|row| Some(row.estimate)));
        writeln!(
            out,
            "order {order}, grading {grading}: strains fall with cell size to the power {truth}, the estimate {estimate}"
        )?;
    }
    Ok(rows)
}

/// Slope of an error over the cell size, by least squares of logarithms; the cell size is unknowns^(-1/3).
pub fn slope(rows: &[Row], error: fn(&Row) -> Option<f64>) -> Option<f64> {
    let point = |row: &Row| Some([(row.unknowns as f64).ln() / -3.0, error(row)?.ln()]);
    let points: Vec<[f64; 2]> = rows.iter().map(point).collect::<Option<_>>()?;
    let mean = |k: usize| points.iter().map(|p| p[k]).sum::<f64>() / points.len() as f64;
    let off = [mean(0), mean(1)];
    let sum = |k: usize| points.iter().map(|p| (p[0] - off[0]) * (p[k] - off[k])).sum::<f64>();
    Some(sum(1) / sum(0))
}

/// Distance of a result to that of a fine mesh, relative, in the energy norm.
fn distance(fine: &StepResult, result: &StepResult) -> Result<f64, Failure> {
    let [own, other] = [fine.scene(), result.scene()];
    let [u, v] = [fine.displacement(), result.displacement()];
    let u = u.as_flattened();
    let energy = energy_of_difference(own.mesh(), own.materials(), u, other.mesh(), v.as_flattened())?;
    Ok((energy / strain_energy(own.mesh(), own.materials(), u)?).sqrt())
}

fn solve(mesh: MeshChoice, settings: &Settings) -> Result<(Row, Arc<StepResult>), Failure> {
    let scene = mesh.scene()?;
    let unknowns = 3 * scene.mesh().points().len();
    let start = Instant::now();
    let mut simulation = Simulation::new(scene, settings.clone())?;
    let result = simulation.step()?;
    let seconds = start.elapsed().as_secs_f64();
    result.require_converged()?;
    let force = |c: usize| -> f64 { result.points().iter().map(|p| p.force()[c]).sum() };
    let row = Row {
        mesh,
        unknowns,
        products: result.report().counters.products,
        errors: [force(2) / LIMITS[0] - 1.0, force(0) / LIMITS[1] - 1.0],
        estimate: result.discretisation_error()?.relative(),
        energy: None,
        seconds,
    };
    Ok((row, result))
}
