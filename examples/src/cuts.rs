//! Ragged cuts: what subdomains of every shape cost, as they are given and made compact, beside boxes.

use std::io::Write;
use std::path::Path;

use signorini::fem_mesh::{Facet, compact_parts, gmsh, split_disconnected};
use signorini::prelude::*;

use crate::brick::{CELLS, GAP, LENGTHS, POISSON, YOUNG};
use crate::error::ExampleError;
use crate::performance::PerformanceOptions;
use crate::run::pool;

/// What is solved on each cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Case {
    /// Loads and floor of the program in the README: ten levels, Coulomb friction 0.3.
    Program,
    /// Half of its load in one level, Coulomb friction 0.2.
    Static,
    /// The same without friction.
    Frictionless,
    /// The same without floor.
    Linear,
}

impl Case {
    /// All of them.
    pub const ALL: [Self; 4] = [
        Self::Program,
        Self::Static,
        Self::Frictionless,
        Self::Linear,
    ];

    /// A short name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Program => "program",
            Self::Static => "static",
            Self::Frictionless => "frictionless",
            Self::Linear => "linear",
        }
    }

    /// The scene on a mesh of the brick, not cut.
    ///
    /// # Errors
    /// None for these numbers.
    pub fn scene(self, mesh: TetMesh) -> Result<Scene, Error> {
        let steel = Hooke::isotropic(YOUNG, POISSON)?;
        let (part, levels) = match self {
            Self::Program => (1.0, 10),
            _ => (0.5, 0),
        };
        let ramp = History::ramp(1.0, 1.0)?;
        let load = |tag, traction: [f64; 3]| {
            let load = Load::traction(tag, traction.map(|t| part * t));
            match levels {
                0 => load,
                _ => load.with_history(ramp.clone()),
            }
        };
        let mut scene = Scene::new(mesh, Materials::uniform(steel))
            .with_support(Support::fixed(brick::X_MIN))
            .with_load(load(brick::Z_MAX, [0.0, 0.0, -3e9]))
            .with_load(load(brick::X_MAX, [9e8, 0.0, -15e8]));
        let floor = Contact::rigid(brick::Z_MIN).with_gap(GAP);
        scene = match self {
            Self::Program => scene.with_contact(floor.with_friction(Friction::coulomb(0.3))),
            Self::Static => scene.with_contact(floor.with_friction(Friction::coulomb(0.2))),
            Self::Frictionless => scene.with_contact(floor),
            Self::Linear => scene,
        };
        Ok(match levels {
            0 => scene,
            _ => scene.with_analysis(
                Analysis::quasistatic(1.0, levels).with_formula(DifferenceFormula::PAPER),
            ),
        })
    }
}

/// Numbers in [0, 1) from a seed (splitmix64).
fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Each tetrahedron to the nearest of `count` random points: cells of all sizes, plane but for the tetrahedra.
#[must_use]
pub fn voronoi(mesh: &TetMesh, count: usize, seed: u64) -> Vec<u32> {
    let (low, high) = mesh.extent();
    let mut random = random(seed);
    let points: Vec<[f64; 3]> = (0..count)
        .map(|_| std::array::from_fn(|d| low[d] + (high[d] - low[d]) * random()))
        .collect();
    let nearest = |tet: usize| {
        let corners = mesh.tet_points(tet);
        let centre: [f64; 3] =
            std::array::from_fn(|d| corners.iter().map(|p| p[d]).sum::<f64>() / 4.0);
        let distance = |p: &[f64; 3]| (0..3).map(|d| (p[d] - centre[d]).powi(2)).sum::<f64>();
        let by_distance =
            |&a: &usize, &b: &usize| distance(&points[a]).total_cmp(&distance(&points[b]));
        (0..count).min_by(by_distance).map_or(0, |k| k as u32)
    };
    (0..mesh.tets().len()).map(nearest).collect()
}

/// Parts grown on the graph of the tetrahedra, which knows no coordinates: from `count` random tetrahedra the smallest part takes the
/// neighbour that waits longest, as long as one is free. Of equal sizes as far as there is room, and as ragged as can be.
#[must_use]
pub fn grown(mesh: &TetMesh, count: usize, seed: u64) -> Vec<u32> {
    let tets = mesh.tets().len();
    let mut random = random(seed);
    let mut parts = vec![u32::MAX; tets];
    let mut waiting = vec![std::collections::VecDeque::new(); count.min(tets)];
    for queue in &mut waiting {
        queue.push_back((random() * tets as f64) as usize);
    }
    let mut sizes = vec![0; waiting.len()];
    let open = |waiting: &[std::collections::VecDeque<usize>], sizes: &[usize]| {
        let parts = (0..waiting.len()).filter(|&k| !waiting[k].is_empty());
        parts.min_by_key(|&k| (sizes[k], k))
    };
    while let Some(part) = open(&waiting, &sizes) {
        while let Some(tet) = waiting[part].pop_front() {
            if parts[tet] == u32::MAX {
                parts[tet] = part as u32;
                sizes[part] += 1;
                waiting[part].extend(mesh.neighbours(tet).into_iter().flatten());
                break;
            }
        }
    }
    parts
}

/// A tetrahedral mesh of the brick from a Gmsh file; its sides get the tags of [`Brick`].
///
/// # Errors
/// [`ExampleError`] of the file or the mesh.
pub fn read(path: &Path) -> Result<TetMesh, ExampleError> {
    let mesh = gmsh::read_gmsh(path)?;
    let side = |axis: usize, place: f64, nodes: &[u32; 3]| {
        let at = |&n: &u32| (mesh.points()[n as usize][axis] - place).abs() < 1e-6 * LENGTHS[axis];
        nodes.iter().all(at)
    };
    let sides = [
        (0, 0.0, brick::X_MIN),
        (0, LENGTHS[0], brick::X_MAX),
        (2, 0.0, brick::Z_MIN),
        (2, LENGTHS[2], brick::Z_MAX),
    ];
    let tagged = |nodes: [u32; 3]| {
        let found = sides
            .iter()
            .find(|(axis, place, _)| side(*axis, *place, &nodes));
        found.map(|&(_, _, tag)| Facet { nodes, tag })
    };
    let boundary = mesh.boundary_facets();
    let facets = boundary.iter().filter_map(|f| tagged(f.nodes)).collect();
    let (points, tets) = (mesh.points().to_vec(), mesh.tets().to_vec());
    Ok(TetMesh::new(points, tets, facets)?)
}

/// What a cut costs.
#[derive(Debug, Clone, PartialEq)]
pub struct CutLine {
    /// What is solved.
    pub case: Case,
    /// The cut.
    pub cut: String,
    /// Number of subdomains, and of tetrahedra in the smallest and the largest.
    pub subdomains: [usize; 3],
    /// Rows of `B`.
    pub rows: usize,
    /// Products with F of each level.
    pub products: Vec<usize>,
    /// Largest certificate.
    pub certificate: f64,
    /// Levels that did not converge, or only by the fall-back.
    pub failed: usize,
}

impl CutLine {
    /// Products of all levels.
    #[must_use]
    pub fn total(&self) -> usize {
        self.products.iter().sum()
    }
}

/// Solves a case on a mesh with these parts, or with `3n x n x n` boxes.
///
/// # Errors
/// [`Error`] for parts that cannot be used.
pub fn measure(
    case: Case,
    mesh: &TetMesh,
    n: usize,
    (cut, parts): (&str, Option<Vec<u32>>),
) -> Result<CutLine, Error> {
    let scene = case.scene(mesh.clone())?;
    let scene = match parts {
        Some(parts) => scene.with_parts(parts),
        None => scene.with_boxes([3 * n, n, n]),
    };
    let mut simulation = Simulation::new(scene, Settings::default())?;
    let sizes = simulation.decomposition().subdomains().iter();
    let sizes: Vec<usize> = sizes.map(|s| s.tets.len()).collect();
    let mut line = CutLine {
        case,
        cut: cut.to_owned(),
        subdomains: [
            sizes.len(),
            sizes.iter().copied().min().unwrap_or(0),
            sizes.iter().copied().max().unwrap_or(0),
        ],
        rows: simulation.tfeti().dual_dim(),
        products: Vec::new(),
        certificate: 0.0,
        failed: 0,
    };
    while !simulation.is_finished() {
        let frame = simulation.step()?;
        let report = frame.report();
        line.products.push(report.counters.products);
        line.failed += usize::from(report.fallback || !report.status.converged());
        line.certificate = line.certificate.max(frame.certificate().largest());
    }
    Ok(line)
}

/// A name and the part numbers of the tetrahedra; `None` for boxes.
pub type Partition = (String, Option<Vec<u32>>);

/// The cuts of a mesh into about `3n³` parts: boxes, random Voronoi cells and those of a file, as they are and made compact, and grown parts
/// made compact.
///
/// # Errors
/// [`ExampleError`] of the file.
pub fn cuts(mesh: &TetMesh, n: usize, file: Option<&Path>) -> Result<Vec<Partition>, ExampleError> {
    let count = 3 * n * n * n;
    let mut given = vec![
        ("Voronoi 1", voronoi(mesh, count, 1)),
        ("Voronoi 2", voronoi(mesh, count, 2)),
        ("grown", grown(mesh, count, 1)),
    ];
    if let Some(path) = file {
        let text = std::fs::read_to_string(path).map_err(|source| {
            let path = path.to_path_buf();
            ExampleError::Read { path, source }
        })?;
        let numbers = text.split_whitespace().map(str::parse);
        // what is no number is no part: the decomposition tells how many are missing
        given.push(("file", numbers.map_while(Result::ok).collect()));
    }
    let mut out = vec![("boxes".to_owned(), None)];
    for (name, parts) in given {
        let connected = split_disconnected(mesh, &parts)?;
        let compact = compact_parts(mesh, &parts)?;
        // what is grown tetrahedron by tetrahedron hangs together by single faces, and is no body to speak of
        if name != "grown" {
            out.push((name.to_owned(), Some(connected)));
        }
        out.push((format!("{name}, compact"), Some(compact)));
    }
    Ok(out)
}

/// Measures all cuts and prints a table in Markdown.
///
/// # Errors
/// [`ExampleError`] of the library, the files or the output.
pub fn execute(
    options: &PerformanceOptions,
    out: &mut impl Write,
) -> Result<Vec<CutLine>, ExampleError> {
    let pool = pool(options.threads)?;
    let mut lines = Vec::new();
    writeln!(
        out,
        "| n | case | cut | subdomains (tetrahedra) | rows | products | of boxes | dearest level | certificate |"
    )?;
    writeln!(out, "|---|---|---|---|---|---|---|---|---|")?;
    for &n in &options.n {
        let mesh = match &options.mesh {
            Some(path) => read(path)?,
            None => {
                let cells = [3 * CELLS * n, CELLS * n, CELLS * n];
                Brick::new(LENGTHS, cells).build()?
            }
        };
        let cuts = cuts(&mesh, n, options.parts.as_deref())?;
        for case in Case::ALL {
            let mut boxes = 0;
            for (cut, parts) in &cuts {
                let parts = (cut.as_str(), parts.clone());
                let line = pool.install(|| measure(case, &mesh, n, parts))?;
                if boxes == 0 {
                    boxes = line.total();
                }
                let [count, least, most] = line.subdomains;
                writeln!(
                    out,
                    "| {n} | {} | {cut} | {count} ({least} to {most}) | {} | {} | {:.2} | {} | {:.1e}{} |",
                    case.name(),
                    line.rows,
                    line.total(),
                    line.total() as f64 / boxes as f64,
                    line.products.iter().max().unwrap_or(&0),
                    line.certificate,
                    if line.failed > 0 { " (failed)" } else { "" }
                )?;
                lines.push(line);
            }
        }
    }
    Ok(lines)
}
