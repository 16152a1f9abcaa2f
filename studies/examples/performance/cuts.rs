//! Ragged cuts: what subdomains of every shape cost, as they are given and made compact, beside boxes.

use std::collections::VecDeque;
use std::io::Write;
use std::path::Path;

use signorini::fem_mesh::decomposition::{PartCount, even_parts, split_disconnected};
use signorini::fem_mesh::{Facet, gmsh};
use signorini::prelude::*;
use signorini_studies::Failure;
use signorini_studies::brick::{Block, CELLS, END, LENGTHS, Loading, TOP, by_nearest, steel};
use signorini_studies::run::{pool, solve};

use super::PerformanceOptions;

/// What is solved on each cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Case {
    /// Loads and floor of the program in the README: ten steps, Coulomb friction 0.3; the paper's formula.
    Program,
    /// Half of its load in one step, Coulomb friction 0.2.
    Static,
    /// The same without friction.
    Frictionless,
    /// The same without floor.
    Linear,
}

impl Case {
    const ALL: [(Self, &str); 4] = [
        (Self::Program, "program"),
        (Self::Static, "static"),
        (Self::Frictionless, "frictionless"),
        (Self::Linear, "linear"),
    ];

    /// The scene on a mesh of the brick, in `3n x n x n` boxes.
    fn scene(self, mesh: TetMesh, n: usize) -> Result<Scene, Failure> {
        let (part, steps) = if self == Self::Program { (1.0, 10) } else { (0.5, 0) };
        let block = Block {
            top: TOP.map(|t| part * t),
            end: END.map(|t| part * t),
            floor: match self {
                Self::Program => Some(Friction::coulomb(0.3)),
                Self::Static => Some(Friction::coulomb(0.2)),
                Self::Frictionless => Some(Friction::None),
                Self::Linear => None,
            },
            steps,
            ..Block::benchmark(n, Loading::B)
        };
        block.scene_on(mesh, steel()?)
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
pub(crate) fn voronoi(mesh: &TetMesh, count: usize, seed: u64) -> Vec<u32> {
    let (low, high) = mesh.extent();
    let mut random = random(seed);
    let points: Vec<[f64; 3]> = (0..count)
        .map(|_| std::array::from_fn(|d| low[d] + (high[d] - low[d]) * random()))
        .collect();
    by_nearest(mesh, &points)
}

/// Parts grown on the graph of the tetrahedra, which knows no coordinates: from `count` random tetrahedra the
/// smallest part takes the neighbour that waits longest, as long as one is free. Of equal sizes as far as there is
/// room, and as ragged as can be.
pub(crate) fn grown(mesh: &TetMesh, count: usize, seed: u64) -> Vec<u32> {
    let tets = mesh.tets().len();
    let mut random = random(seed);
    let mut parts = vec![u32::MAX; tets];
    let mut waiting = vec![VecDeque::new(); count.min(tets)];
    for queue in &mut waiting {
        queue.push_back((random() * tets as f64) as usize);
    }
    let mut sizes = vec![0; waiting.len()];
    let open = |waiting: &[VecDeque<usize>], sizes: &[usize]| {
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
pub(crate) fn read(path: &Path) -> Result<TetMesh, Failure> {
    let mesh = gmsh::read_gmsh(path)?.0;
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
        let found = sides.iter().find(|(axis, place, _)| side(*axis, *place, &nodes));
        found.map(|&(_, _, tag)| Facet { nodes, tag })
    };
    let boundary = mesh.boundary_facets();
    let facets = boundary.iter().filter_map(|f| tagged(f.nodes)).collect();
    let (points, tets) = (mesh.points().to_vec(), mesh.tets().to_vec());
    Ok(TetMesh::new(points, tets, facets)?)
}

/// What a cut costs.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CutLine {
    /// What is solved.
    pub(crate) case: Case,
    /// The cut.
    pub(crate) cut: String,
    /// Number of subdomains, and of tetrahedra in the smallest and the largest.
    pub(crate) subdomains: [usize; 3],
    /// Rows of `B`.
    pub(crate) rows: usize,
    /// Products with F of each step.
    pub(crate) products: Vec<usize>,
    /// Largest certificate.
    pub(crate) certificate: f64,
    /// Steps that did not converge, or only by the fall-back.
    pub(crate) failed: usize,
}

impl CutLine {
    /// Products of all steps.
    pub(crate) fn total(&self) -> usize {
        self.products.iter().sum()
    }
}

/// Solves a case on a mesh with these parts, or with `3n x n x n` boxes.
pub(crate) fn measure(case: Case, mesh: &TetMesh, n: usize, (cut, parts): &Cut) -> Result<CutLine, Failure> {
    let scene = case.scene(mesh.clone(), n)?;
    let scene = match parts.clone() {
        Partition::AsGiven(parts) => scene.with_parts_as_given(parts),
        Partition::Parts(parts) => scene.with_parts(parts),
        _ => scene,
    };
    let (simulation, steps, _) = solve(scene, Settings::default(), &mut |_, _| Ok(()))?;
    let sizes = || simulation.decomposition().subdomains().iter().map(|s| s.tets.len());
    let [least, most] = [sizes().min(), sizes().max()].map(Option::unwrap_or_default);
    Ok(CutLine {
        case,
        cut: cut.clone(),
        subdomains: [sizes().count(), least, most],
        rows: simulation.tfeti().dual_dim(),
        products: steps.iter().map(|s| s.n_m).collect(),
        certificate: steps.iter().map(|s| s.certificate).fold(0.0, f64::max),
        failed: steps.iter().filter(|s| s.fallback || !s.converged()).count(),
    })
}

/// A name and the partition: given parts, or else the boxes that a case has.
pub(crate) type Cut = (String, Partition);

/// The cuts of a mesh into about `3n³` parts: boxes, the library's, random Voronoi cells and those of a file, as
/// they are and made compact, and grown parts made compact.
pub(crate) fn cuts(mesh: &TetMesh, n: usize, file: Option<&Path>) -> Result<Vec<Cut>, Failure> {
    let count = 3 * n * n * n;
    let mut given = vec![
        ("Voronoi 1", voronoi(mesh, count, 1)),
        ("Voronoi 2", voronoi(mesh, count, 2)),
        ("grown", grown(mesh, count, 1)),
    ];
    if let Some(path) = file {
        let text = std::fs::read_to_string(path);
        let text = text.map_err(|e| format!("cannot read {}: {e}", path.display()))?;
        let numbers = text.split_whitespace().map(str::parse);
        // what is no number is no part: the decomposition tells how many are missing
        given.push(("file", numbers.map_while(Result::ok).collect()));
    }
    let mut out = vec![("boxes".to_owned(), Partition::Boxes([3 * n, n, n]))];
    let one = vec![0; mesh.tets().len()];
    // the library's own, into as many parts and into a number that no grid of boxes has
    for (name, count) in [("library", count), ("library, less", count * 4 / 5 + 1)] {
        let parts = even_parts(mesh, &one, PartCount::Exactly(count))?;
        out.push((name.to_owned(), Partition::AsGiven(parts)));
    }
    for (name, parts) in given {
        let connected = split_disconnected(mesh, &parts)?;
        // what is grown tetrahedron by tetrahedron hangs together by single faces, and is no body to speak of
        if name != "grown" {
            out.push((format!("{name}, as given"), Partition::AsGiven(connected)));
        }
        out.push((name.to_owned(), Partition::Parts(parts)));
    }
    Ok(out)
}

/// Measures all cuts and prints a table in Markdown.
pub(crate) fn execute(options: &PerformanceOptions, out: &mut impl Write) -> Result<Vec<CutLine>, Failure> {
    let pool = pool(options.threads)?;
    let mut lines = Vec::new();
    writeln!(
        out,
        "| n | case | cut | subdomains (tetrahedra) | rows | products | of boxes | dearest step | certificate |"
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
        for (case, name) in Case::ALL {
            let mut boxes = 0;
            for cut in &cuts {
                let line = pool.install(|| measure(case, &mesh, n, cut))?;
                if boxes == 0 {
                    boxes = line.total();
                }
                let [count, least, most] = line.subdomains;
                writeln!(
                    out,
                    "| {n} | {name} | {} | {count} ({least} to {most}) | {} | {} | {:.2} | {} | {:.1e}{} |",
                    line.cut,
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
