//! Equations between nodes: what they mean, beside CalculiX, and what is refused.

use std::fmt::Write as _;

use signorini_contact::{Scene, Settings, Simulation};
use signorini_fem_mesh::{Brick, TetMesh, brick};

use crate::couplings::step;
use crate::refusals::{behind, inside};
use crate::write::{STEEL, cube, mesh, read};

const HELD: &str = "*BOUNDARY\nN5, 1, 3\n";

fn scene(deck: &str) -> Scene {
    read(deck).expect("deck").scene().expect("scene")
}

/// Terms over several lines, several equations behind one keyword, axes of nodes, and points in the order of the deck.
#[test]
fn terms_are_those_of_the_scene() {
    let text = "*NODE\n900, 3.\n901, 4.\n*NSET, NSET=OWN\n27\n*TRANSFORM, NSET=OWN\n0., 1., 0., 0., 0., 1.\n\
        *EQUATION\n3\n27, 1, 2., 26, 3, -1.5\n901, 2, 4.\n1\n9,2,1.\n*EQUATION\n2\n900, 3, 1.\n901, 3, -1.\n";
    let loads = "*BOUNDARY\n901, 3, 3, 0.1\n*CLOAD\n901, 2, 7.\n";
    let scene = scene(&cube(&format!("{text}{HELD}{}", step(loads))));
    let [first, second, third] = scene.equations() else {
        panic!("{:?}", scene.equations());
    };
    assert_eq!(first.terms(), [(26, [0.0, 2.0, 0.0]), (25, [0.0, 0.0, -1.5])]);
    assert_eq!(first.points(), [(0, [0.0, 4.0, 0.0])]);
    assert_eq!(
        (second.terms(), second.points()),
        (&[(8, [0.0, 1.0, 0.0])][..], &[][..])
    );
    assert_eq!(third.points(), [(1, [0.0, 0.0, 1.0]), (0, [0.0, 0.0, -1.0])]);
    let [a, b] = scene.couplings() else {
        panic!("{:?}", scene.couplings());
    };
    assert_eq!((a.reference(), b.reference()), ([4.0, 0.0, 0.0], [3.0, 0.0, 0.0]));
    assert_eq!(
        (a.held()[..3].to_vec(), b.held()),
        (vec![false, false, true], [false; 6])
    );
    assert_eq!(a.motions()[0].0[2], 0.1);
    assert_eq!(scene.loads().len(), 1);
}

/// Of sets there is an equation for each node, by ascending numbers; a single node takes part in all.
#[test]
fn sets_stand_for_their_nodes() {
    let text =
        "*NODE\n900\n*NSET, NSET=A\n9, 3, 6\n*NSET, NSET=B\n5, 2, 8\n*EQUATION\n3\nA, 1, 1., B, 1, -1., 900, 1, -1.\n";
    let scene = scene(&cube(&format!("{text}{HELD}{}", step(""))));
    let along = |v: f64| [v, 0.0, 0.0];
    for (equation, (a, b)) in scene.equations().iter().zip([(2, 1), (5, 4), (8, 7)]) {
        assert_eq!(equation.terms(), [(a, along(1.0)), (b, along(-1.0))]);
        assert_eq!(equation.points(), [(0, along(-1.0))]);
    }
    assert_eq!(scene.equations().len(), 3);
}

/// A bar with a plane end, by a node that is loaded, and a lever to a node of another bar, which CalculiX solves as
/// well.
fn bars(mesh_: &TetMesh) -> String {
    let mut text = format!("{}*NODE\n900, 9.\n901, 9.\n", mesh(mesh_));
    text += STEEL;
    let ends = mesh_.nodes_on(brick::X_MAX);
    let (low, high): (Vec<u32>, Vec<u32>) = ends.iter().partition(|n| mesh_.points()[**n as usize][2] < 2.0);
    text += "*EQUATION\n";
    for (nodes, point) in [(low, 900), (high, 901)] {
        for node in nodes {
            writeln!(text, "2\n{}, 1, 1., {point}, 1, -1.", node + 1).expect("text");
        }
    }
    text += "2\n900, 1, 1.\n901, 1, 2.5\n";
    text + "*BOUNDARY\nN1, 1, 3\n"
}

fn two_bars(order: usize) -> TetMesh {
    let bar = Brick::new([4.0, 1.0, 1.0], [4, 2, 2]).build().expect("a bar");
    let above = bar.clone().map_points(|[x, y, z]| [x, y, z + 3.0]).expect("lifted");
    let both = bar.append(&above).expect("two bars");
    match order {
        1 => both,
        _ => both.raise_order().expect("quadratic"),
    }
}

/// Displacements of nodes in the deck, of points by their couplings.
fn solved(text: &str, nodes: &[u32]) -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
    let mut simulation = Simulation::new(scene(text), Settings::default().with_tolerance(1e-10)).expect("set-up");
    let result = simulation.step().expect("a step");
    let u = result.displacement();
    let rest = result.reactions().imbalance().force;
    assert!(rest.iter().all(|f| f.abs() < 1e-6), "{rest:?}");
    (
        nodes.iter().map(|n| u[*n as usize - 1]).collect(),
        result.couplings().iter().map(|c| c.displacement).collect(),
    )
}

/// Nodes 5, 20 and 60 of the bars, and 12 and 20 of the cell with its points, as CalculiX 2.20 prints them.
#[test]
fn displacements_are_those_of_calculix() {
    let close = |found: &[[f64; 3]], printed: &[[f64; 3]]| {
        for (found, printed) in found.iter().flatten().zip(printed.iter().flatten()) {
            assert!(
                (found - printed).abs() < 6e-7 * printed.abs() + 1e-12,
                "{found:e}, not {printed:e}"
            );
        }
    };
    let pulled = step("*CLOAD\n900, 1, 1000.\n");
    for (order, end, across, middle) in [
        (1, 1.586253e-2, 6.154957e-4, 6.156813e-4),
        (2, 1.620401e-2, 6.15753e-4, 6.15753e-4),
    ] {
        let (nodes, points) = solved(&(bars(&two_bars(order)) + &pulled), &[5, 20, 60]);
        close(&nodes[..2], &[[end, across, across], [end, middle, 0.0]]);
        close(&points, &[[end, 0.0, 0.0], [-end / 2.5, 0.0, 0.0]]);
        assert!((nodes[2][0] / -end * 2.5 - 1.0).abs() < 6e-7 && (nodes[2][1] / across * 2.5 - 1.0).abs() < 1e-6);
    }
    let (nodes, points) = solved(&cell(1), &[12, 20]);
    close(
        &nodes,
        &[
            [1.212597e-3, -1.10438e-4, -1.510062e-5],
            [1.009815e-3, 2.558631e-5, -7.058228e-5],
        ],
    );
    close(
        &points,
        &[[1e-3, 0.0, 0.0], [5e-4, -2.032489e-4, 0.0], [0.0, 0.0, -2.550036e-4]],
    );
    let (_, points) = solved(&cell(2), &[]);
    close(
        &points,
        &[[1e-3, 0.0, 0.0], [5e-4, -2.185676e-4, 0.0], [0.0, 0.0, -2.756578e-4]],
    );
}

/// A periodic cell with a stiff part: sheared by one point, loaded by another.
fn cell(order: usize) -> String {
    let cube = Brick::new([1.0; 3], [3; 3]).build().expect("a cube");
    let cube = match order {
        1 => cube,
        _ => cube.raise_order().expect("quadratic"),
    };
    let mut text = mesh(&cube);
    text += "*NODE\n1001, 5.\n1002, 5.\n1003, 5.\n";
    text += STEEL;
    text = text.replace("*SOLID SECTION, ELSET=ALL", "*SOLID SECTION, ELSET=SOFT");
    text += "*MATERIAL, NAME=HARD\n*ELASTIC\n2.1e6, 0.2\n*SOLID SECTION, ELSET=CORE, MATERIAL=HARD\n";
    let (mut core, mut soft) = (String::new(), String::new());
    for t in 0..cube.tets().len() {
        let points = cube.tet_points(t);
        let is_core = (0..3).all(|c| points.iter().map(|p| p[c]).sum::<f64>() / 4.0 < 0.66);
        writeln!(if is_core { &mut core } else { &mut soft }, "{},", t + 1).expect("text");
    }
    let sets = format!("*ELSET, ELSET=CORE\n{core}*ELSET, ELSET=SOFT\n{soft}");
    text = text.replacen("*MATERIAL, NAME=STEEL", &format!("{sets}*MATERIAL, NAME=STEEL"), 1);
    let at = |p: [f64; 3]| {
        let near = |q: &[f64; 3]| (0..3).all(|c| (p[c] - q[c]).abs() < 1e-9);
        cube.points().iter().position(near).expect("a node") + 1
    };
    // the first way takes all nodes, the next ones those that are not yet on a side taken
    text += "*EQUATION\n";
    for way in 0..3 {
        for (n, p) in cube.points().iter().enumerate() {
            if p[way] > 1.0 - 1e-9 && (0..way).all(|w| p[w] < 1.0 - 1e-9) {
                let mut q = *p;
                q[way] = 0.0;
                for c in 1..=3 {
                    writeln!(
                        text,
                        "3\n{}, {c}, 1., {}, {c}, -1., {}, {c}, -1.",
                        n + 1,
                        at(q),
                        1001 + way
                    )
                    .expect("text");
                }
            }
        }
    }
    text + "*BOUNDARY\n1, 1, 3\n1001, 2, 3\n1002, 3, 3\n1003, 1, 2\n"
        + &step("*BOUNDARY\n1001, 1, 1, 1e-3\n1002, 1, 1, 5e-4\n*CLOAD\n1003, 3, -20.\n")
}

#[test]
fn what_is_refused() {
    let refused = |lines: &str, line: &str, word: &str, part: &str| {
        behind(
            &format!("*NODE\n900\n*NSET, NSET=PAIR\n1, 2\n{lines}{HELD}{}", step("")),
            line,
            word,
            part,
        );
    };
    refused("*EQUATION\n", "*EQUATION", "*EQUATION", "number of terms");
    refused("*EQUATION\n1, 2\n", "1, 2", "2", "alone in its line");
    refused("*EQUATION\n2\n1, 1, 1.\n", "2", "2", "fewer terms");
    refused("*EQUATION\n1\n1, 1, 1., 2, 1, 1.\n", "1", "1", "more terms");
    refused("*EQUATION\n1\n1, 4, 1.\n", "1, 4, 1.", "4", "1, 2 or 3");
    refused("*EQUATION\n1\n1, 1\n", "1, 1", "1, 1", "a coefficient");
    refused(
        "*EQUATION\n1\n77777, 1, 1.\n",
        "77777, 1, 1.",
        "77777",
        "no node with this number",
    );
    refused("*EQUATION\n1\nNIX, 1, 1.\n", "NIX, 1, 1.", "NIX", "there are: ");
    refused(
        "*EQUATION\n2\nPAIR, 1, 1., N6, 1, 1.\n",
        "PAIR, 1, 1., N6, 1, 1.",
        "N6",
        "another number of nodes",
    );
    refused(
        "*EQUATION\n2\n1, 1, 1., PAIR, 1, 1.\n",
        "1, 1, 1., PAIR, 1, 1.",
        "PAIR",
        "another number of nodes",
    );
    for word in ["REMOVE", "INPUT=rows.inp"] {
        let card = format!("*EQUATION, {word}");
        refused(&format!("{card}\n1\n1, 1, 1.\n"), &card, word, "equations");
    }
    let unsorted = "*NSET, NSET=U, UNSORTED\n2, 1\n*EQUATION\n1\nU, 1, 1.\n";
    refused(unsorted, "U, 1, 1.", "U", "ascending numbers");
    refused(&unsorted.replace("UNS", "Un s"), "U, 1, 1.", "U", "ascending numbers");
    let card = "*NSET, NSET=U, UNSORTED=YES";
    refused(&format!("{card}\n2, 1\n"), card, "UNSORTED=YES", "without a value");
    // the order of other sets has no meaning
    let elsewhere = "*ELSET, ELSET=U, UNSORTED\n2, 1\n*NSET, NSET=V, UNSORTED\n2, 1\n*NSET, NSET=U\n2, 1\n";
    let made = |sets: &str| read(&cube(&format!("{sets}*EQUATION\n1\nU, 1, 1.\n"))).map(|deck| deck.scene().is_ok());
    assert!(made(elsewhere).expect("deck"));
    let assembled = format!(
        "*ASSEMBLY\n{}*END ASSEMBLY\n",
        unsorted.split("*EQ").next().expect("a set")
    );
    assert!(
        made(&assembled)
            .expect_err("unsorted")
            .to_string()
            .contains("ascending numbers")
    );
    let flat = "PLANE or STRAIGHT, and nodes";
    refused("*MPC\nBEAM, 1, 2\n", "BEAM, 1, 2", "BEAM", flat);
    refused("*MPC\n0, 1, 2\n", "0, 1, 2", "0", flat);
    refused("*MPC\n", "*MPC", "*MPC", flat);
    refused("*MPC\nPLANE, 1, 2, 3\n", "PLANE, 1, 2, 3", "*MPC", "take STRAIGHT");
    refused(
        "*MPC\nSTRAIGHT, 1, 2, 3, 14\n",
        "STRAIGHT, 1, 2, 3, 14",
        "*MPC",
        "node 14 is",
    );
    refused("*MPC\nSTRAIGHT, 1, 2\n", "STRAIGHT, 1, 2", "*MPC", "name more");
    refused("*MPC\nPLANE, NOWHERE\n", "PLANE, NOWHERE", "NOWHERE", "there are: ");
    inside(
        "*EQUATION\n1\n1, 1, 1.\n",
        "*EQUATION",
        "*EQUATION",
        "before the first *STEP",
    );
    let rigid = "*RIGID BODY, NSET=N6, REF NODE=900\n*EQUATION\n1\n900, 1, 1.\n";
    refused(rigid, "900, 1, 1.", "900", "stands for a rigid body");
    let turned = "*NSET, NSET=P\n900\n*TRANSFORM, NSET=P\n0., 1., 0., -1., 0., 0.\n*EQUATION\n1\n900, 1, 1.\n";
    refused(turned, "*TRANSFORM, NSET=P", "NSET=P", "or alone");
    let moment = format!(
        "*NODE\n900\n*EQUATION\n2\n900, 1, 1., 27, 1, 1.\n{HELD}{}",
        step("*CLOAD\n900, 4, 1.\n")
    );
    behind(&moment, "900, 4, 1.", "4", "a component 1, 2 or 3");
    let many: String = (0..501).map(|n| format!("{}\n", 10_000 + n)).collect();
    let many = format!("*NODE, NSET=MANY\n{many}*EQUATION\n1\nMANY, 1, 1.\n{HELD}{}", step(""));
    behind(&many, "MANY, 1, 1.", "MANY", "more than 500 nodes in equations");
    // what the scene refuses names the line
    let twice = format!(
        "*EQUATION\n1\n27, 1, 1.\n2\n27, 1, 1., 26, 1, 1.\n{HELD}{}",
        step("*BOUNDARY\n26, 1, 1, 0.5\n")
    );
    let scene = scene(&cube(&twice));
    let error = Simulation::new(scene, Settings::default())
        .expect_err("refused")
        .to_string();
    assert!(
        error.contains("equation 1 is *EQUATION (") && error.contains("contradicts"),
        "{error}"
    );
}

/// Nodes of the end of a bar stay in a plane, those of an edge on a line, as in CalculiX 2.20 under small forces (these
/// over 10,000; there planes turn by large angles). Both at once, of which it refuses what they have in common.
#[test]
fn planes_stay_planes_and_lines_stay_lines() {
    let bar = Brick::new([4.0, 1.0, 1.0], [4, 2, 2]).build().expect("a bar");
    let deck = |bar: &TetMesh, lines: &str| {
        let pulled = step("*CLOAD\n45, 1, 3.\n45, 2, 1.\n45, 3, 2.\n");
        format!("{}{STEEL}*MPC\n{lines}*BOUNDARY\nN1, 1, 3\n{pulled}", mesh(bar))
    };
    let (plane, line) = ("PLANE, N2\n", "straight, 32\n0, 33, 34, 35\n");
    for (lines, printed) in [
        (
            plane,
            [
                [-8.839635e-9, 2.351461e-8, 8.254997e-8],
                [-2.594821e-9, 2.746172e-9, 8.030778e-9],
                [7.694313e-9, 2.531976e-8, 7.619242e-8],
            ],
        ),
        (
            line,
            [
                [-4.322498e-9, 2.379196e-8, 7.526151e-8],
                [-2.497185e-9, 2.425647e-9, 6.953883e-9],
                [8.297621e-9, 2.590394e-8, 6.916063e-8],
            ],
        ),
    ] {
        let (u, _) = solved(&deck(&bar, lines), &[45, 32, 20]);
        for (found, printed) in u.iter().flatten().zip(printed.iter().flatten()) {
            assert!(
                (1e-4 * found - printed).abs() < 1e-6 * printed.abs(),
                "{found:e} {printed:e}"
            );
        }
    }
    // lines after the first have nodes alone; zeros are none
    let equations = |lines: &str| format!("{:?}", scene(&deck(&bar, lines)).equations());
    for lines in ["straight, 32, 33\n34, 0, 35\n", "straight,\n32, 33, 34\n0, 35, 0\n"] {
        assert_eq!(equations(lines), equations(line), "{lines}");
    }
    // mid-nodes of the edge, too
    let fine = bar.raise_order().expect("quadratic");
    let (u, _) = solved(
        &deck(&fine, &format!("{plane}STRAIGHT, 32, 33, 34, 35\n")),
        &[5, 15, 45, 25, 35, 32, 33, 34],
    );
    let middle = |a: [f64; 3], b: [f64; 3], c: usize| 0.5 * (a[c] + b[c]);
    assert!((middle(u[0], u[2], 0) - u[3][0]).abs() < 1e-6 * u[3][0].abs());
    for c in [1, 2] {
        assert!((middle(u[4], u[6], c) - u[7][c]).abs() < 1e-6 * u[7][c].abs());
        assert!((middle(u[5], u[7], c) - u[6][c]).abs() < 1e-6 * u[7][c].abs());
    }
}
