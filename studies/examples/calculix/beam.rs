//! A beam of cells of all kinds under a pressure: what elements are worth in CalculiX, and what this library makes of
//! them.

#[path = "../../../crates/fem-mesh/tests/it/grid.rs"]
mod grid;

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::Path;

use signorini::deck::Deck;
use signorini::fem_mesh::mesh::CellShape;
use signorini::prelude::*;
use signorini_studies::{Failure, aligned};

/// Lengths of the beam, mm; it is clamped at x = 0.
const LENGTHS: [f64; 3] = [10.0, 1.0, 1.0];
/// Mean displacement of the corners of the end along z, mm, on fine meshes.
pub const LIMIT: f64 = -0.035_752;

/// Names of the elements, and what they are.
pub const KINDS: [(&str, CellShape, usize); 7] = [
    ("C3D8", CellShape::Hexahedron, 1),
    ("C3D8I", CellShape::Hexahedron, 1),
    ("C3D8R", CellShape::Hexahedron, 1),
    ("C3D20", CellShape::Hexahedron, 2),
    ("C3D20R", CellShape::Hexahedron, 2),
    ("C3D6", CellShape::Prism, 1),
    ("C3D15", CellShape::Prism, 2),
];

/// What both codes find.
#[derive(Debug, Clone, PartialEq)]
pub struct Beam {
    /// The element.
    pub kind: &'static str,
    /// Cells across.
    pub cells: usize,
    /// Displacement of the end here, mm.
    pub own: f64,
    /// The same in CalculiX, if it is there and converges.
    pub calculix: Option<f64>,
}

/// The nodes with their places, the elements by their nodes, and the nodes of the deck whose displacement is looked at.
pub struct Cells {
    points: Vec<(usize, [f64; 3])>,
    cells: Vec<Vec<usize>>,
    shape: CellShape,
    /// Corners of the end.
    pub tip: Vec<usize>,
}

impl Cells {
    /// `cells` across, ten times as many along.
    pub fn new((shape, order): (CellShape, usize), cells: usize) -> Self {
        let n = [10 * cells, cells, cells];
        let from_one = |nodes: Vec<usize>| nodes.into_iter().map(|n| n + 1).collect();
        let cells: Vec<Vec<usize>> = grid::cells(shape, order, n).into_iter().map(from_one).collect();
        let used: BTreeSet<usize> = cells.iter().flatten().copied().collect();
        let place = |&number: &usize| {
            let x = grid::place(n, number - 1);
            (number, [0, 1, 2].map(|i| LENGTHS[i] * x[i]))
        };
        let points: Vec<_> = used.iter().map(place).collect();
        let is_corner = |x: [f64; 3]| x[0] == LENGTHS[0] && (1..3).all(|i| x[i] == 0.0 || x[i] == LENGTHS[i]);
        let tip = points.iter().filter(|p| is_corner(p.1)).map(|p| p.0).collect();
        Self {
            points,
            cells,
            shape,
            tip,
        }
    }

    /// The deck: mm, N, MPa.
    pub fn deck(&self, kind: &str) -> Result<String, Failure> {
        let mut text = String::from("*HEADING\nclamped beam under a pressure; mm, N, MPa\n*NODE\n");
        for (number, [x, y, z]) in &self.points {
            writeln!(text, "{number}, {x:?}, {y:?}, {z:?}")?;
        }
        writeln!(text, "*ELEMENT, TYPE={kind}, ELSET=BEAM")?;
        for (element, nodes) in (1..).zip(&self.cells) {
            let nodes: Vec<String> = nodes.iter().map(usize::to_string).collect();
            let lines: Vec<String> = nodes.chunks(10).map(|line| line.join(", ")).collect();
            writeln!(text, "{element}, {}", lines.join(",\n"))?;
        }
        writeln!(text, "*NSET, NSET=CLAMP")?;
        let clamped = self.points.iter().filter(|p| p.1[0] == 0.0);
        clamped.into_iter().try_for_each(|p| writeln!(text, "{},", p.0))?;
        writeln!(text, "*NSET, NSET=TIP")?;
        self.tip.iter().try_for_each(|n| writeln!(text, "{n},"))?;
        text.push_str("*MATERIAL, NAME=STEEL\n*ELASTIC\n210000., 0.3\n*SOLID SECTION, ELSET=BEAM, MATERIAL=STEEL\n");
        text.push_str("*BOUNDARY\nCLAMP, 1, 3\n*STEP\n*STATIC\n1., 1.\n*DLOAD\n");
        let on_top: BTreeSet<usize> = self
            .points
            .iter()
            .filter(|p| p.1[2] == LENGTHS[2])
            .map(|p| p.0)
            .collect();
        for (element, nodes) in (1..).zip(&self.cells) {
            for (number, face) in (1..).zip(self.shape.faces()) {
                if face.iter().all(|&k| on_top.contains(&nodes[k])) {
                    writeln!(text, "{element}, P{number}, 0.5")?;
                }
            }
        }
        text.push_str("*NODE PRINT, NSET=TIP\nU\n*END STEP\n");
        Ok(text)
    }

    /// The displacement by this library.
    pub fn solve(&self, path: &Path) -> Result<f64, Failure> {
        let deck = Deck::read(path)?;
        let mut simulation = Simulation::new(deck.scene()?, Settings::default())?;
        let result = simulation.step()?;
        result.require_converged()?;
        let u = result.displacement();
        let at = |number: &usize| deck.node(*number as u32).map_or(f64::NAN, |node| u[node as usize][2]);
        Ok(self.tip.iter().map(at).sum::<f64>() / self.tip.len() as f64)
    }

    /// The displacement that CalculiX has printed.
    pub fn printed(&self, text: &str) -> Option<f64> {
        let lines = text.lines().skip_while(|line| !line.contains("displacements")).skip(1);
        let numbers = |line: &str| {
            line.split_whitespace()
                .map(|w| w.parse::<f64>().ok())
                .collect::<Option<Vec<_>>>()
        };
        let all: Vec<_> = lines.filter_map(numbers).filter(|line| line.len() == 4).collect();
        (all.len() == self.tip.len()).then(|| all.iter().map(|line| line[3]).sum::<f64>() / all.len() as f64)
    }
}

/// Errors of the end, in per cent.
pub fn table(rows: &[Beam]) -> String {
    let heads = [
        ["cells", "across"],
        ["", "element"],
        ["CalculiX,", "%"],
        ["signorini,", "%"],
    ];
    let error = |value: f64| format!("{:+.2}", 100.0 * (value / LIMIT - 1.0));
    let line = |row: &Beam| {
        vec![
            row.cells.to_string(),
            row.kind.to_owned(),
            row.calculix.map_or("-".to_owned(), error),
            error(row.own),
        ]
    };
    aligned(&heads, &rows.iter().map(line).collect::<Vec<_>>())
}
