//! Hexahedra, prisms and pyramids: their faces, and what they are worth.

use std::fmt::Write as _;

use crate::grid::{E, Grid, KINDS, NU, at, is_exact, pinned, run, step};
use crate::refusals::refused;
use crate::write::read;

#[test]
fn pressure_acts_on_each_face_by_its_number() {
    let size = [2.0, 1.0, 1.5];
    for kind in KINDS {
        let grid = Grid::new(kind, [2, 1, 2], size);
        let outside = (0..3).flat_map(|i| [(0.0, i), (size[i], i)]);
        let faces: Vec<_> = outside.flat_map(|(value, axis)| grid.faces(at(value, axis))).collect();
        let (mut surface, mut pressures) = (String::from("*SURFACE, NAME=SKIN\n"), String::from("*DLOAD\n"));
        for (element, number) in faces {
            writeln!(surface, "{element}, S{number}").expect("text");
            writeln!(pressures, "{element}, P{number}, 40.").expect("text");
        }
        let by_surface = step("*DSLOAD\nSKIN, P, 40.\n");
        for load in [by_surface, step(&pressures)] {
            let text = grid.text() + &surface + &pinned(&grid, size) + &load;
            let factor = -40.0 * (1.0 - 2.0 * NU) / E;
            run(&text, |deck, result| {
                is_exact(deck, result, |x| x.map(|x| factor * x), kind)
            });
        }
    }
}

/// The tip of a beam under a force: cells of second order are what CalculiX has, those of first order are worth as
/// much.
#[test]
fn cells_bend_as_those_of_second_order() {
    // CalculiX with these elements; with fine ones -0.190475
    for (kind, reference, error) in [
        ("C3D20", -0.188_063, 6e-3),
        ("C3D15", -0.188_050, 8e-3),
        ("C3D8", -0.190_475, 0.02),
        ("C3D6", -0.190_475, 0.02),
        ("C3D5", -0.190_475, 0.02),
    ] {
        let grid = Grid::new(kind, [10, 1, 1], [10.0, 1.0, 1.0]);
        let text = grid.text() + &grid.nset("FIX", at(0.0, 0)) + &grid.surface("TIP", at(10.0, 0));
        let text = text + "*BOUNDARY\nFIX, 1, 3\n" + &step("*DSLOAD\nTIP, TRVEC, 10., 0., 0., -1.\n");
        run(&text, |deck, result| {
            let tip = grid
                .nodes(at(10.0, 0))
                .into_iter()
                .map(|n| deck.node(n as u32).expect("a node") as usize);
            let found: Vec<f64> = tip.map(|n| result.displacement()[n][2]).collect();
            let found = found.iter().sum::<f64>() / found.len() as f64;
            assert!((found / reference - 1.0).abs() < error, "{kind}: {found}");
            assert_eq!(deck.mesh().order(), 2);
        });
    }
}

/// A bolt is cut at faces of cells, and the nodes between these too.
#[test]
fn sections_cut_between_cells() {
    for kind in ["C3D8", "C3D20", "C3D6", "C3D15"] {
        let grid = Grid::new(kind, [1, 1, 4], [1.0, 1.0, 4.0]);
        let below = grid
            .faces(at(2.0, 2))
            .into_iter()
            .filter(|f| f.0 <= grid.cells.len() / 2);
        let cut: String = below.map(|(e, n)| format!("{e}, S{n}\n")).collect();
        let text = grid.text()
            + "*NODE\n9001, 5.\n"
            + &grid.nset("ENDS", |x| x[2] == 0.0 || x[2] == 4.0)
            + &grid.nset("X0", at(0.0, 0))
            + &grid.nset("Y0", at(0.0, 1))
            + &format!("*SURFACE, NAME=CUT\n{cut}*PRE-TENSION SECTION, SURFACE=CUT, NODE=9001\n")
            + "*BOUNDARY\nENDS, 3\nX0, 1\nY0, 2\n"
            + &step("*CLOAD\n9001, 1, 1000.\n");
        run(&text, |deck, result| {
            let moved = result.couplings()[0].displacement[2].abs();
            assert!((moved / (1000.0 * 4.0 / E) - 1.0).abs() < 1e-6, "{kind}: {moved}");
            let half = |x: [f64; 3], u: &[f64; 3]| {
                let strain = 1000.0 / E;
                let is_below = x[2] < 2.0 || x[2] == 2.0 && u[2] > 0.0;
                let side = if is_below { x[2] } else { x[2] - 4.0 };
                (u[0] + NU * strain * x[0]).abs() + (u[2] - strain * side).abs()
            };
            let off = deck
                .mesh()
                .points()
                .iter()
                .zip(result.displacement())
                .map(|(x, u)| half(*x, &u));
            let off = off.fold(0.0, f64::max);
            assert!(off < 1e-7, "{kind}: {off:e}");
        });
    }
}

/// A rigid plate of cells: its side presses back as an elastic one would that is stiff.
#[test]
fn rigid_cells_are_obstacles() {
    for (kind, plate) in [("C3D20", "C3D8"), ("C3D8", "C3D20"), ("C3D15", "C3D6")] {
        let grid = Grid::new(kind, [2, 2, 1], [1.0; 3]);
        let below = Grid::new(plate, [1, 1, 1], [3.0, 3.0, 1.0]);
        let mut text = grid.text() + &grid.surface("FOOT", at(0.0, 2)) + &grid.surface("HEAD", at(1.0, 2)) + "*NODE\n";
        for (number, [x, y, z]) in &below.points {
            writeln!(text, "{}, {:?}, {:?}, {:?}", number + 1000, x - 1.0, y - 1.0, z - 1.0).expect("text");
        }
        writeln!(text, "*ELEMENT, TYPE={plate}, ELSET=PLATE").expect("text");
        for (element, nodes) in (1001..).zip(&below.cells) {
            let nodes: Vec<String> = nodes.iter().map(|n| (n + 1000).to_string()).collect();
            let lines: Vec<String> = nodes.chunks(12).map(|line| line.join(", ")).collect();
            writeln!(text, "{element}, {}", lines.join(",\n")).expect("text");
        }
        let top = below
            .faces(at(1.0, 2))
            .into_iter()
            .map(|(e, n)| format!("{}, S{n}\n", e + 1000));
        text += &format!(
            "*SURFACE, NAME=TABLE\n{}*NODE\n9001, 0., 0., -9.\n",
            top.collect::<String>()
        );
        text += "*RIGID BODY, ELSET=PLATE, REF NODE=9001\n*BOUNDARY\n9001, 1, 6\n";
        text += "*SURFACE INTERACTION, NAME=I\n*FRICTION\n0.5,\n*CONTACT PAIR, INTERACTION=I\nFOOT, TABLE\n";
        text += &step("*DSLOAD\nHEAD, P, 50.\n");
        run(&text, |_, result| {
            let force = result.reactions().contacts[0].force;
            assert!((force[2] - 50.0).abs() < 1e-5, "{kind} on {plate}: {force:?}");
        });
    }
}

/// Sets, numbers and marks are those of the deck.
#[test]
fn names_and_numbers_stay() {
    let grid = Grid::new("C3D20", [2, 1, 1], [2.0, 1.0, 1.0]);
    let corners = |nodes: &[usize]| {
        grid.shape.faces()[1]
            .iter()
            .map(|&k| nodes[k].to_string())
            .collect::<Vec<_>>()
    };
    let mark = corners(&grid.cells[0]).join(", ");
    let text = grid.text()
        + &format!("*ELEMENT, TYPE=CPS4, ELSET=LID\n501, {mark}\n*SURFACE, NAME=BY_MARK\nLID\n")
        + "*SURFACE, NAME=BY_NUMBER\n1, S2\n*ELSET, ELSET=SECOND\n2\n*SURFACE, NAME=WHOLE\nSECOND\n"
        + &grid.nset("ABOVE", |x| x[2] == 1.0 && x[0] <= 1.0)
        + "*SURFACE, NAME=BY_NODES, TYPE=NODE\nABOVE\n";
    let deck = read(&text).expect("deck");
    let facets = |name: &str| {
        let tags = deck.surface(name).expect("a surface");
        deck.mesh().facets().iter().filter(|f| tags.contains(&f.tag)).count()
    };
    assert_eq!(["BY_MARK", "BY_NUMBER", "BY_NODES", "WHOLE"].map(facets), [2, 2, 2, 10]);
    assert_eq!(
        deck.surface("BY_MARK").expect("a surface"),
        deck.surface("BY_NODES").expect("a surface")
    );
    assert_eq!(deck.element_set("SECOND").expect("a set"), [6, 7, 8, 9, 10, 11]);
    assert_eq!(deck.element_numbers(), [[1; 6], [2; 6]].concat());
    assert_eq!(deck.mesh().points().len(), 45);
    // the middle of the face above is in its set, and has the number of a neighbour
    let above = deck.node_set("ABOVE").expect("a set");
    assert_eq!(above.len(), 9);
    let added = above[8] as usize;
    assert_eq!(deck.mesh().points()[added], [0.5, 0.5, 1.0]);
    assert_ne!(deck.node(deck.node_numbers()[added]), Some(added as u32));
    assert!(deck.ignored().iter().all(|ignored| !ignored.why.contains("too stiff")));

    let coarse = read(&Grid::new("C3D8", [1; 3], [1.0; 3]).text()).expect("deck");
    assert!(
        coarse.ignored()[0].why.contains("19 nodes are added"),
        "{}",
        coarse.ignored()[0]
    );
    assert!(coarse.ignored()[0].why.contains("not by *CLOAD"));
}

#[test]
fn wrong_cells_are_refused() {
    let hexahedron = Grid::new("C3D8", [1; 3], [1.0; 3]).text();
    let prism = Grid::new("C3D6", [1; 3], [1.0; 3]).text();
    let try_one = |text: String, line: &str, word: &str, part: &str| refused(&text, line, word, part);
    let element = "1, 1, 3, 9, 7, 19, 21, 27, 25";
    let turned = hexahedron.replace(element, "1, 19, 21, 27, 25, 1, 3, 9, 7");
    try_one(turned, "1, 19, 21, 27, 25, 1, 3, 9, 7", "1", "turned inside out");
    let flat = "1, 1, 3, 9, 9, 1, 3, 9, 9";
    try_one(hexahedron.replace(element, flat), flat, "1", "no volume");
    // a triangle across the diagonal from the smallest number
    let crossing = "*NODE\n901, 0.5, 0.5, 2.\n*ELEMENT, TYPE=C3D4, ELSET=ALL\n7, 21, 27, 25, 901\n8, 21, 25, 19, 901\n";
    let crossing = hexahedron.replace("*MATERIAL", &format!("{crossing}*MATERIAL"));
    try_one(
        crossing.clone(),
        "7, 21, 27, 25, 901",
        "7",
        "element 1 has a face of four corners",
    );
    let along = crossing.replace(
        "7, 21, 27, 25, 901\n8, 21, 25, 19, 901",
        "7, 19, 21, 27, 901\n8, 19, 27, 25, 901",
    );
    assert!(read(&along).is_ok());
    let short = hexahedron.replace(element, "1, 1, 3, 9, 7, 19, 21, 27");
    try_one(
        short,
        "1, 1, 3, 9, 7, 19, 21, 27",
        "1, 1, 3, 9, 7, 19, 21, 27",
        "eight node numbers",
    );
    let face = "*SURFACE, NAME=A\nALL, S6\n";
    try_one(prism + face, "ALL, S6", "ALL", "element 1 has no face 6");
    assert!(read(&(hexahedron.clone() + face)).is_ok());
}

/// Elements of first order beside those of second order, which have nodes on the edges that they share.
#[test]
fn orders_are_mixed() {
    let size = [2.0, 1.0, 1.0];
    let mut grid = Grid::new("C3D20", [2, 1, 1], size);
    let second = grid.cells.pop().expect("an element");
    let corners: Vec<String> = second[..8].iter().map(usize::to_string).collect();
    let more = format!("*ELEMENT, TYPE=C3D8, ELSET=ALL\n2, {}\n", corners.join(", "));
    let text = grid.text().replace("*MATERIAL", &format!("{more}*MATERIAL"));
    let left = grid.nset("LEFT", at(0.0, 0));
    let text = text + &left + &pinned(&grid, size) + "*BOUNDARY\nLEFT, 1\n" + &step("*DLOAD\n2, P4, -210.\n");
    run(&text, |deck, result| {
        is_exact(
            deck,
            result,
            |[x, y, z]| [1e-3 * x, -NU * 1e-3 * y, -NU * 1e-3 * z],
            "mixed",
        );
        // the corners and mid-nodes of two hexahedra, their faces and their middles
        assert_eq!(deck.mesh().points().len(), 12 + 20 + 11 + 2);
    });
}
