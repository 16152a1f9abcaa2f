//! Nodes that the division of elements adds: they are held, moved and named as what is around them.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use signorini_deck::Deck;

use crate::grid::{E, Grid, KINDS, NU, at, is_exact, pinned, run, step};
use crate::refusals::refused;

/// Faces are held as a whole, from the step on from which all of their nodes are.
#[test]
fn what_is_between_held_nodes_is_held() {
    for kind in KINDS {
        let grid = Grid::new(kind, [2, 2, 2], [1.0; 3]);
        let sets = grid.nset("NALL", |_| true) + &grid.nset("TOP", at(1.0, 2)) + &grid.nset("BOTTOM", at(0.0, 2));
        let warm = "*EXPANSION\n1e-5\n*INITIAL CONDITIONS, TYPE=TEMPERATURE\nNALL, 0.\n";
        let text = grid.text().replace("*SOLID SECTION", &format!("{warm}*SOLID SECTION"));
        let (before, after) = text.split_once("*INITIAL").expect("a part");
        let (initial, section) = after.split_once("*SOLID").expect("a part");
        let text = format!("{before}*SOLID{section}{sets}*INITIAL{initial}");
        let text = text
            + &pinned(&grid, [1.0; 3])
            + &step("*TEMPERATURE\nNALL, 100.\n")
            + &step("*BOUNDARY\nTOP, 3\nBOTTOM, 3\n");
        let mut steps = 0;
        run(&text, |deck, result| {
            let along = if steps == 0 { [1e-3; 3] } else { [1.3e-3, 1.3e-3, 0.0] };
            is_exact(deck, result, |x| [0, 1, 2].map(|i| along[i] * x[i]), kind);
            assert_eq!(deck.node_set("TOP").expect("a set"), top_nodes(deck), "{kind}");
            steps += 1;
        });
        assert_eq!(steps, 2);
    }
}

fn top_nodes(deck: &Deck) -> Vec<u32> {
    let points = (0..).zip(deck.mesh().points());
    points
        .filter(|(_, x)| (x[2] - 1.0).abs() < 1e-9)
        .map(|(n, _)| n)
        .collect()
}

/// Displacements given node by node, and faces that follow one another.
#[test]
fn what_is_between_moved_nodes_moves_along() {
    let affine = |[x, y, z]: [f64; 3]| [1e-3 * x + 2e-3 * y, 5e-4 * z - 1e-3 * y, 3e-3 * x - 2e-3 * z];
    for kind in KINDS {
        let grid = Grid::new(kind, [2, 2, 2], [1.0; 3]);
        let mut moves = String::from("*BOUNDARY\n");
        for (number, x) in grid
            .points
            .iter()
            .filter(|p| p.1.iter().any(|x| *x == 0.0 || *x == 1.0))
        {
            for (component, value) in (1..).zip(affine(*x)) {
                writeln!(moves, "{number}, {component}, {component}, {value:?}").expect("text");
            }
        }
        let text = grid.text() + &step(&moves);
        run(&text, |deck, result| is_exact(deck, result, affine, kind));

        let mut text = grid.text() + "*NODE\n9001, 5.\n";
        let (left, right) = (grid.nodes(at(0.0, 0)), grid.nodes(at(1.0, 0)));
        for (a, b) in left.iter().zip(&right) {
            for c in 1..=3 {
                writeln!(text, "*EQUATION\n3\n{b}, {c}, 1., {a}, {c}, -1., 9001, {c}, -1.").expect("text");
            }
        }
        // the corner, and what turns about x
        let middle = grid.nodes(|x| x == [0.0, 0.0, 1.0])[0];
        text += &format!("*BOUNDARY\n{}, 1, 3\n{middle}, 2\n", left[0]);
        text += &step("*BOUNDARY\n9001, 1, 1, 1e-3\n9001, 2, 2, 4e-4\n9001, 3, 3, -6e-4\n");
        // without shear
        let exact = |[x, y, z]: [f64; 3]| {
            [
                1e-3 * x - 4e-4 * y + 6e-4 * z,
                4e-4 * x - NU * 1e-3 * y,
                -6e-4 * x - NU * 1e-3 * z,
            ]
        };
        run(&text, |deck, result| is_exact(deck, result, exact, kind));
    }
}

/// Added nodes are held in each step in which all nodes around them are, and in no other one, however these come and
/// go.
#[test]
fn added_nodes_are_held_as_long_as_their_neighbours() {
    let grid = Grid::new("C3D8", [1, 1, 2], [1.0, 1.0, 2.0]);
    let bottom = grid.nodes(at(0.0, 2));
    let side = grid.nodes(|x| x == [1.0, 1.0, 1.0])[0];
    let mut random = 7_u64;
    let mut draw = || {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        !(random >> 33).is_multiple_of(4)
    };
    let mut checked = [0; 2];
    for _ in 0..12 {
        let held: Vec<Vec<bool>> = (0..4).map(|_| bottom.iter().map(|_| draw()).collect()).collect();
        let mut text = grid.text() + &grid.nset("TOP", at(2.0, 2));
        for held in &held {
            let lines = bottom.iter().zip(held).filter(|(_, held)| **held);
            let lines: String = lines.map(|(node, _)| format!("{node}, 3\n")).collect();
            let boundary = format!("*BOUNDARY, OP=NEW\nTOP, 1, 3\n{lines}");
            text += &step(&format!(
                "{boundary}*CLOAD, OP=NEW\n{side}, 3, -300.\n{side}, 1, 170.\n"
            ));
        }
        let mut steps = held.iter();
        run(&text, |deck, result| {
            let held = steps.next().expect("a step");
            for (x, u) in deck.mesh().points().iter().zip(result.displacement()) {
                let corners = bottom.iter().zip(held).filter(|(node, _)| {
                    let place = grid.points.iter().find(|p| p.0 == **node).expect("a node").1;
                    (0..2).all(|i| x[i] == 0.5 || x[i] == place[i])
                });
                if x[2] == 0.0 && (x[0] == 0.5 || x[1] == 0.5) {
                    let wanted = corners.into_iter().all(|(_, held)| *held);
                    assert_eq!(u[2].abs() < 1e-7, wanted, "{x:?} moves by {u:?}");
                    checked[usize::from(wanted)] += 1;
                }
            }
        });
    }
    assert!(checked[0] > 20 && checked[1] > 20, "{checked:?}");
}

/// Nodes of a face with axes of their own, some or all, and tilted in a later step.
#[test]
fn directions_are_those_of_all_neighbours() {
    for kind in ["C3D8", "C3D20", "C3D15"] {
        let grid = Grid::new(kind, [2, 2, 1], [1.0; 3]);
        let sets = grid.nset("BOTTOM", at(0.0, 2)) + &grid.nset("TOP", at(1.0, 2));
        let half = grid.nset("HALF", |x| x[2] == 0.0 && x[0] > 0.3) + &grid.nset("REST", |x| x[2] == 0.0 && x[0] < 0.3);
        let turned = "*TRANSFORM, NSET=HALF\n0.6, 0.8, 0., -0.8, 0.6, 0.\n";
        let again = "*TRANSFORM, NSET=REST\n0.6, 0.8, 0., -0.8, 0.6, 0.\n";
        let flat = step("*BOUNDARY\nBOTTOM, 1, 3\nTOP, 3, 3, 1e-3\n");
        for axes in ["", turned, &format!("{turned}{again}")] {
            run(&(grid.text() + &sets + &half + axes + &flat), |deck, result| {
                for (x, u) in deck.mesh().points().iter().zip(result.displacement()) {
                    let on = [0.0, 1.0].iter().position(|z| *z == x[2]);
                    let off = on.map_or(0.0, |on| (u[2] - 1e-3 * on as f64).abs());
                    assert!(off < 1e-8, "{kind}: {x:?} moves by {u:?}");
                }
            });
        }
        // a plane that tilts node by node in the second step, along z for all
        let mut tilt = String::from("*BOUNDARY\n");
        for node in grid.nodes(at(0.0, 2)) {
            let x = grid.points.iter().find(|p| p.0 == node).expect("a node").1;
            writeln!(tilt, "{node}, 3, 3, {:?}", 1e-3 * (x[0] - 2.0 * x[1])).expect("text");
        }
        let text = grid.text() + &sets + &half + turned + "*BOUNDARY\nTOP, 1, 3\n" + &step("") + &step(&tilt);
        let mut tilts = false;
        run(&text, |deck, result| {
            for (x, u) in deck.mesh().points().iter().zip(result.displacement()) {
                let exact = 1e-3 * (x[0] - 2.0 * x[1]);
                assert!(
                    !tilts || x[2] != 0.0 || (u[2] - exact).abs() < 1e-8,
                    "{kind}: {x:?} moves by {u:?}"
                );
            }
            tilts = true;
        });
    }
}

/// A sector of a ring under pressure from within, both cuts of which move alike along cylindrical axes.
#[test]
fn cuts_of_a_ring_follow_one_another() {
    let angle = std::f64::consts::FRAC_PI_4;
    let turned = |[r, a, z]: [f64; 3]| [(1.0 + r) * (angle * a).cos(), (1.0 + r) * (angle * a).sin(), z];
    for kind in ["C3D20", "C3D8"] {
        let mut grid = Grid::new(kind, [4, 4, 1], [1.0; 3]);
        let cuts = [0.0, 1.0].map(|a| grid.nodes(at(a, 1)));
        let inner = grid.surface("INNER", at(0.0, 0));
        let (flat, pin) = (
            grid.nset("FLAT", |x| x[2] == 0.0 || x[2] == 1.0),
            grid.nodes(|x| x == [0.0; 3])[0],
        );
        grid.points.iter_mut().for_each(|p| p.1 = turned(p.1));
        let mut text = grid.text() + &inner + &flat + "*NSET, NSET=CUTS\n";
        cuts.iter().flatten().for_each(|n| text += &format!("{n},\n"));
        text += "*TRANSFORM, NSET=CUTS, TYPE=C\n0., 0., 0., 0., 0., 1.\n";
        for (a, b) in cuts[0].iter().zip(&cuts[1]) {
            for c in 1..=2 {
                text += &format!("*EQUATION\n2\n{a}, {c}, 1., {b}, {c}, -1.\n");
            }
        }
        text += &format!("*BOUNDARY\nFLAT, 3\n{pin}, 2\n{}", step("*DSLOAD\nINNER, P, 100.\n"));
        run(&text, |deck, result| {
            // Lame, plane strain
            let (a, b) = (1.0, 2.0);
            let radial = |r: f64| (1.0 + NU) / E * 100.0 * a * a / (b * b - a * a) * ((1.0 - 2.0 * NU) * r + b * b / r);
            for (x, u) in deck.mesh().points().iter().zip(result.displacement()) {
                let r = x[0].hypot(x[1]);
                let [out, along] = [(x[0] * u[0] + x[1] * u[1]) / r, (x[0] * u[1] - x[1] * u[0]) / r];
                // added nodes of straight cells lie within the circle
                assert!(
                    (out / radial(r) - 1.0).abs() < 0.02,
                    "{kind}: {x:?} moves by {out}, not {}",
                    radial(r)
                );
                assert!(along.abs() < 0.01 * radial(r), "{kind}: {x:?} turns by {along}");
            }
        });
    }
}

/// Reactions of what lies between two sets have a name of their own; a surface of nodes has whole faces.
#[test]
fn what_is_between_sets_is_in_none() {
    let grid = Grid::new("C3D8", [1, 1, 1], [1.0; 3]);
    let sets = grid.nset("L", |x| x[2] == 0.0 && x[0] == 0.0) + &grid.nset("R", |x| x[2] == 0.0 && x[0] == 1.0);
    let nodes = grid.nset("THREE", |x| x[2] == 1.0 && x[0] + x[1] < 1.5);
    let lid = grid.surface("TOP", at(1.0, 2));
    let text = grid.text() + &sets + &nodes + &lid + "*BOUNDARY\nL, 1, 3\nR, 1, 3\n" + &step("*DSLOAD\nTOP, P, 10.\n");
    run(&text, |deck, result| {
        let names: BTreeSet<&str> = deck.support_names().iter().map(String::as_str).collect();
        assert_eq!(names, BTreeSet::from(["L", "R", "between L and R"]));
        let sum: f64 = result.reactions().supports.iter().map(|r| r.resultant.force[2]).sum();
        assert!((sum - 10.0).abs() < 1e-6);
    });
    let surface = "*SURFACE, NAME=PART, TYPE=NODE\nTHREE\n";
    refused(
        &(text.replace("*BOUNDARY", &format!("{surface}*BOUNDARY"))),
        "THREE",
        "THREE",
        "is on no face",
    );
}

/// Where equations and supports that begin later say the same of an added node, one of them does.
#[test]
fn equations_stand_beside_supports() {
    for kind in ["C3D8", "C3D20"] {
        let grid = Grid::new(kind, [1, 1, 1], [1.0; 3]);
        let corner = |p: [f64; 3]| grid.nodes(|x| x == p)[0];
        let [a, b] = [corner([0.0; 3]), corner([1.0, 0.0, 0.0])];
        let mut text =
            grid.text() + &grid.nset("TOP", at(1.0, 2)) + &format!("*EQUATION\n2\n{a}, 3, 1., {b}, 3, -1.\n");
        text += &("*BOUNDARY\nTOP, 1, 3\n".to_owned() + &step(&format!("*CLOAD\n{b}, 3, -100.\n")));
        text += &step(&format!("*BOUNDARY\n{a}, 3, 3, 1e-3\n"));
        let mut last = 0.0;
        run(&text, |deck, result| {
            let ends = [a, b].map(|n| deck.node(n as u32).expect("a node") as usize);
            let [first, second] = ends.map(|n| result.displacement()[n][2]);
            assert!((first - second).abs() < 1e-9, "{first} {second}");
            if kind == "C3D8" {
                let is_mid = |x: &[f64; 3]| *x == [0.5, 0.0, 0.0];
                let mid = deck.mesh().points().iter().position(is_mid).expect("a node");
                assert!((result.displacement()[mid][2] - first).abs() < 1e-9);
            }
            last = first;
        });
        assert!((last - 1e-3).abs() < 1e-9);
    }
}

/// A support that begins along a line takes added nodes from where they are, also beside what is held before.
#[test]
fn lines_begin_where_added_nodes_are() {
    let grid = Grid::new("C3D8", [1, 1, 1], [1.0; 3]);
    let sets = grid.nset("A", |x| x[2] == 0.0 && x[0] == 0.0) + &grid.nset("B", |x| x[2] == 0.0 && x[0] == 1.0);
    let text = grid.text() + &sets + &grid.nset("TOP", at(1.0, 2)) + "*BOUNDARY\nTOP, 1, 3\n";
    let second = "*STEP\n*STATIC\n0.25, 1.\n*BOUNDARY\nB, 3, 3, 0.03\n*END STEP\n";
    let text = text + &step("*BOUNDARY\nA, 3, 3, 0.01\n") + second;
    let mut start = None;
    run(&text, |deck, result| {
        let at = |x: [f64; 3]| {
            let node = deck.mesh().points().iter().position(|p| *p == x).expect("a node");
            result.displacement()[node][2]
        };
        let found = at([0.5, 0.0, 0.0]);
        let part = result.time() - 1.0;
        let left = *start.get_or_insert(found);
        let wanted = left + part * (0.02 - left);
        assert!((found - wanted).abs() < 1e-8, "{part}: {found} {wanted}");
        assert!((at([0.0, 0.5, 0.0]) - 0.01).abs() < 1e-8);
    });
    assert!(start.is_some_and(|left| (left - 0.02).abs() > 1e-3));
}
