//! Decks for tests.

use std::fmt::Write as _;
use std::path::PathBuf;

use signorini_deck::{Deck, DeckError};
use signorini_fem_mesh::TetMesh;
use tempfile::TempDir;

/// Nodes of the faces 1 to 4 of C3D4, after the manuals.
const FACES: [[usize; 3]; 4] = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];

/// Reads a text as the deck `part.inp`.
pub(crate) fn read(text: &str) -> Result<Deck, DeckError> {
    let (_folder, path) = folder(&[("part.inp", text)]);
    Deck::read(path)
}

/// Files in a folder of their own; the first one is given back.
pub(crate) fn folder(files: &[(&str, &str)]) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).expect("written");
    }
    let path = folder.path().join(files[0].0);
    (folder, path)
}

/// Nodes, elements and sets of a mesh: numbers from 1, elements in `ALL`, for each tag the surface `S` and the node set
/// `N` with its number.
pub(crate) fn mesh(mesh: &TetMesh) -> String {
    let mut deck = String::from("*NODE\n");
    for (n, [x, y, z]) in mesh.points().iter().enumerate() {
        writeln!(deck, "{}, {x:?}, {y:?}, {z:?}", n + 1).expect("text");
    }
    let kind = if mesh.order() == 2 { "C3D10" } else { "C3D4" };
    writeln!(deck, "*ELEMENT, TYPE={kind}, ELSET=ALL").expect("text");
    for (t, corners) in mesh.tets().iter().enumerate() {
        let mids = mesh.mids().get(t).into_iter().flatten();
        let nodes: Vec<String> = corners.iter().chain(mids).map(|n| (n + 1).to_string()).collect();
        writeln!(deck, "{}, {}", t + 1, nodes.join(", ")).expect("text");
    }
    for tag in mesh.tags() {
        writeln!(deck, "*SURFACE, NAME=S{}", tag.0).expect("text");
        for (f, facet) in mesh.facets().iter().enumerate() {
            if facet.tag == tag {
                let (element, number) = face(mesh, f);
                writeln!(deck, "{element}, S{number}").expect("text");
            }
        }
        writeln!(deck, "*NSET, NSET=N{}", tag.0).expect("text");
        for node in mesh.nodes_on(tag) {
            writeln!(deck, "{},", node + 1).expect("text");
        }
    }
    deck
}

/// Element, from 1, and number of a tagged facet.
pub(crate) fn face(mesh: &TetMesh, facet: usize) -> (usize, usize) {
    let element = mesh.facet_owner(facet);
    let sorted = |mut nodes: [u32; 3]| {
        nodes.sort_unstable();
        nodes
    };
    let wanted = sorted(mesh.facets()[facet].nodes);
    let tet = mesh.tets()[element];
    let is = |face: &[usize; 3]| sorted(face.map(|i| tet[i])) == wanted;
    let number = FACES.iter().position(is).expect("a face of its owner");
    (element + 1, number + 1)
}

/// A cube of 1 m with one material, and what follows.
pub(crate) fn cube(rest: &str) -> String {
    let brick = signorini_fem_mesh::Brick::new([1.0; 3], [2, 2, 2]);
    let deck = mesh(&brick.build().expect("a brick"));
    format!("{deck}{STEEL}{rest}")
}

/// Material and section of all elements.
pub(crate) const STEEL: &str =
    "*MATERIAL, NAME=STEEL\n*ELASTIC\n2.1e5, 0.3\n*DENSITY\n7.8e-9\n*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n";
