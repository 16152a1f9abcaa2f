//! Boxes of hexahedra, prisms and pyramids as decks.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use signorini_contact::{Settings, Simulation, StepResult};
use signorini_deck::Deck;
use signorini_fem_mesh::mesh::CellShape;

use crate::boxes;
use crate::write::{STEEL, read};

/// Young's modulus and Poisson's ratio of [`STEEL`].
pub(crate) const E: f64 = 2.1e5;
pub(crate) const NU: f64 = 0.3;

/// A box cut into cells of one kind.
pub(crate) struct Grid {
    pub(crate) kind: &'static str,
    pub(crate) shape: CellShape,
    /// Numbers of the deck and places.
    pub(crate) points: Vec<(usize, [f64; 3])>,
    /// Numbers of the nodes.
    pub(crate) cells: Vec<Vec<usize>>,
}

pub(crate) const KINDS: [&str; 5] = ["C3D8", "C3D20", "C3D6", "C3D15", "C3D5"];

impl Grid {
    pub(crate) fn new(kind: &'static str, n: [usize; 3], size: [f64; 3]) -> Self {
        let (shape, order) = match kind {
            "C3D6" => (CellShape::Prism, 1),
            "C3D15" => (CellShape::Prism, 2),
            "C3D20" => (CellShape::Hexahedron, 2),
            "C3D5" => (CellShape::Pyramid, 1),
            _ => (CellShape::Hexahedron, 1),
        };
        let cells = boxes::cells(shape, order, n);
        let used: BTreeSet<usize> = cells.iter().flatten().copied().collect();
        let place = |&number: &usize| {
            let x = boxes::place(n, number);
            (number + 1, [0, 1, 2].map(|i| x[i] * size[i]))
        };
        let points = used.iter().map(place).collect();
        let from_one = |nodes: Vec<usize>| nodes.into_iter().map(|n| n + 1).collect();
        let cells = cells.into_iter().map(from_one).collect();
        Self {
            kind,
            shape,
            points,
            cells,
        }
    }

    /// Nodes, elements in `ALL`, material and section.
    pub(crate) fn text(&self) -> String {
        let mut text = String::from("*NODE\n");
        for (number, [x, y, z]) in &self.points {
            writeln!(text, "{number}, {x:?}, {y:?}, {z:?}").expect("text");
        }
        writeln!(text, "*ELEMENT, TYPE={}, ELSET=ALL", self.kind).expect("text");
        for (element, nodes) in (1..).zip(&self.cells) {
            let nodes: Vec<String> = nodes.iter().map(usize::to_string).collect();
            let lines: Vec<String> = nodes.chunks(12).map(|line| line.join(", ")).collect();
            writeln!(text, "{element}, {}", lines.join(",\n")).expect("text");
        }
        text + STEEL
    }

    pub(crate) fn nodes(&self, on: impl Fn([f64; 3]) -> bool) -> Vec<usize> {
        self.points.iter().filter(|p| on(p.1)).map(|p| p.0).collect()
    }

    /// A set of nodes.
    pub(crate) fn nset(&self, name: &str, on: impl Fn([f64; 3]) -> bool) -> String {
        let nodes: Vec<String> = self.nodes(on).iter().map(|n| format!("{n},\n")).collect();
        format!("*NSET, NSET={name}\n{}", nodes.concat())
    }

    /// Elements and numbers of the faces whose corners are all at places.
    pub(crate) fn faces(&self, on: impl Fn([f64; 3]) -> bool) -> Vec<(usize, usize)> {
        let at = self.nodes(on);
        let mut out = Vec::new();
        for (element, nodes) in (1..).zip(&self.cells) {
            for (number, face) in (1..).zip(self.shape.faces()) {
                if face.iter().all(|&k| at.contains(&nodes[k])) {
                    out.push((element, number));
                }
            }
        }
        out
    }

    pub(crate) fn surface(&self, name: &str, on: impl Fn([f64; 3]) -> bool) -> String {
        let faces = self.faces(on).into_iter().map(|(e, n)| format!("{e}, S{n}\n"));
        format!("*SURFACE, NAME={name}\n{}", faces.collect::<String>())
    }
}

pub(crate) fn step(lines: &str) -> String {
    format!("*STEP\n*STATIC\n1., 1.\n{lines}*END STEP\n")
}

pub(crate) fn at(value: f64, axis: usize) -> impl Fn([f64; 3]) -> bool + Copy {
    move |x| (x[axis] - value).abs() < 1e-9
}

/// Runs a deck and looks at each step.
pub(crate) fn run(text: &str, mut look: impl FnMut(&Deck, &StepResult)) {
    let deck = read(text).expect("deck");
    let mut simulation = Simulation::new(deck.scene().expect("scene"), Settings::default()).expect("simulation");
    while !simulation.is_finished() {
        let result = simulation.step().expect("solved");
        result.require_converged().expect("converged");
        look(&deck, &result);
    }
}

/// All nodes, those between the nodes of the deck too, have the displacement that is exact.
pub(crate) fn is_exact(deck: &Deck, result: &StepResult, exact: impl Fn([f64; 3]) -> [f64; 3], what: &str) {
    let pairs = deck.mesh().points().iter().zip(result.displacement());
    let largest = pairs
        .clone()
        .flat_map(|(x, _)| exact(*x))
        .fold(0.0, |m: f64, u| m.max(u.abs()));
    for (x, u) in pairs {
        let off = exact(*x).iter().zip(u).fold(0.0, |m: f64, (e, u)| m.max((e - u).abs()));
        assert!(
            off < 2e-6 * largest,
            "{what}: {x:?} moves by {u:?}, not {:?}",
            exact(*x)
        );
    }
}

/// No rigid motion, for what needs no more.
pub(crate) fn pinned(grid: &Grid, size: [f64; 3]) -> String {
    let corner = |p: [f64; 3]| grid.nodes(move |x| (0..3).all(|i| (x[i] - p[i]).abs() < 1e-9))[0];
    let [o, x, y] = [[0.0; 3], [size[0], 0.0, 0.0], [0.0, size[1], 0.0]].map(corner);
    format!("*BOUNDARY\n{o}, 1, 3\n{x}, 2, 3\n{y}, 3, 3\n")
}
