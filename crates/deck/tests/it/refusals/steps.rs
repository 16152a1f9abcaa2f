//! Supports, loads and times.

use super::{behind, in_step, inside, refused};
use crate::write::{cube, read};

#[test]
fn supports() {
    behind("*BOUNDARY\nTOP, 1\n", "TOP, 1", "TOP", "there are: N1");
    behind("*BOUNDARY\nN5, 1, 7\n", "N5, 1, 7", "7", "no rotations");
    behind("*BOUNDARY\nN5, 3, 1\n", "N5, 3, 1", "1", "not below the first");
    behind("*BOUNDARY\nN5\n", "N5", "N5", "a component");
    behind("*BOUNDARY\nN5, SYMM\n", "N5, SYMM", "SYMM", "XSYMM");
    behind("*BOUNDARY\nN5, PINNED, 1\n", "N5, PINNED, 1", "1", "nothing after");
    behind("*BOUNDARY\n99, 1\n", "99, 1", "99", "no node");
    behind("*BOUNDARY\nN5, 3, 3, 0.1\n", "N5, 3, 3, 0.1", "N5", "behind a *STEP");
    inside("*BOUNDARY\nN6, 1, 6, 0.1\n", "N6, 1, 6, 0.1", "6", "no rotations");
    inside(
        "*BOUNDARY\nN6, 1, 1, 0.1\nN6, 1, 1, 0.2\n",
        "N6, 1, 1, 0.2",
        "N6",
        "0.1 and 0.2",
    );
}

#[test]
fn loads() {
    inside("*CLOAD\nN6, 4, 1.\n", "N6, 4, 1.", "4", "a component 1, 2 or 3");
    inside("*CLOAD\nN6, 1\n", "N6, 1", "N6, 1", "and a force");
    inside("*CLOAD\nN7, 1, 1.\n", "N7, 1, 1.", "N7", "there are: N1");
    inside("*DLOAD\nALL, P7, 1.\n", "ALL, P7, 1.", "P7", "P1 to P6");
    inside("*DLOAD\nALL, P5, 1.\n", "ALL, P5, 1.", "ALL", "element 1 has no face 5");
    let turning = "ALL, CORIO, 1., 0., 0., 0., 0., 0., 1.";
    inside(&format!("*DLOAD\n{turning}\n"), turning, "CORIO", "GRAV");
    for (turning, word, part) in [
        ("ALL, CENTRIF, 1., 0., 0., 0., 0., 0., 0.", "", "a direction"),
        ("ALL, CENTRIF, -1., 0., 0., 0., 0., 0., 1.", "-1.", "not negative"),
        ("ALL, CENTRIF, 1., 0., 0., 0., 0., 0., 1., 2.", "2.", "CENTRIF"),
        ("ALL, CENTRIF, 1., 0., 0.", "", "a point of the axis"),
    ] {
        let word = if word.is_empty() { turning } else { word };
        inside(&format!("*DLOAD\n{turning}\n"), turning, word, part);
    }
    let back = "*AMPLITUDE, NAME=BACK\n0., 0., 1., -1.\n";
    let turning = "ALL, CENTRIF, 1., 0., 0., 0., 0., 0., 1.";
    let steps = in_step(&format!("*DLOAD, AMPLITUDE=BACK\n{turning}\n"));
    behind(&format!("{back}{steps}"), turning, "ALL", "its amplitude makes it so");
    let other = "ALL, CENTRIF, 1., 1., 0., 0., 0., 0., 1.";
    let both = format!("*DLOAD\nALL, CENTRIF, 1., 0., 0., 0., 0., 0., 1.\n{other}\n");
    inside(&both, other, "ALL", "about another axis");
    let held = "*BOUNDARY, FIXED";
    inside(&format!("{held}\nN6, 1, 1, 2.\n"), held, "FIXED", "remove the value");
    inside("*DLOAD\nALL, P1, 1.\n", "ALL, P1, 1.", "ALL", "inside the body");
    let some = "1, BY, 2.";
    let next = format!("*DLOAD\nALL, BY, 1.\n*END STEP\n*STEP\n*STATIC\n*DLOAD\n{some}\n");
    inside(&next, some, "1", "the same set");
    inside("*DLOAD\nALL, P1, 1., 2.\n", "ALL, P1, 1., 2.", "2.", "a value");
    let nowhere = "ALL, GRAV, 9.8, 0., 0., 0.";
    inside(&format!("*DLOAD\n{nowhere}\n"), nowhere, nowhere, "not zero");
    inside(
        "*DSLOAD\nS6, TRSHR, 1.\n",
        "S6, TRSHR, 1.",
        "TRSHR",
        "P, and a pressure",
    );
    inside("*DSLOAD\nTOP, P, 1.\n", "TOP, P, 1.", "TOP", "there are: S1");
    inside(
        "*DSLOAD\nS6, P, 1.\nS6, P, 2.\n",
        "S6, P, 2.",
        "S6",
        "give their sum once",
    );
    let alone = "*NODE\n99, 5., 5., 5.\n*NSET, NSET=ALONE\n99\n";
    let deck = cube(&format!("{alone}{}", in_step("*CLOAD\nALONE, 1, 1.\n")));
    refused(&deck, "ALONE, 1, 1.", "ALONE", "no elastic element uses node 99");
    let deck = cube(&in_step("*DLOAD\nALL, GRAV, 9.8, 0., 0., -1.\n")).replace("*DENSITY\n7.8e-9\n", "");
    refused(&deck, "ALL, GRAV, 9.8, 0., 0., -1.", "ALL", "*DENSITY");
    let (down, side) = ("ALL, GRAV, 9.8, 0., 0., -1.", "ALL, GRAV, 9.8, 1., 0., 0.");
    let next = |op: &str, line: &str| format!("*STEP\n*STATIC\n*DLOAD{op}\n{line}\n*END STEP\n");
    for second in [side, "ALL, GRAV, 9.8, 0., 0., 1."] {
        let deck = cube(&(in_step(&format!("*DLOAD\n{down}\n")) + &next("", second)));
        refused(&deck, second, "ALL", "OP=NEW");
    }
    for (op, second) in [(", OP=NEW", side), ("", "ALL, GRAV, 4.9, 0., 0., -2.")] {
        read(&cube(&(in_step(&format!("*DLOAD\n{down}\n")) + &next(op, second)))).expect("deck");
    }
    let two = "*AMPLITUDE, NAME=A\n0., 0., 1., 1.\n";
    let deck = cube(&format!(
        "{two}{}",
        in_step("*CLOAD\n1, 1, 1.\n*CLOAD, AMPLITUDE=A\n1, 1, 2.\n")
    ));
    refused(&deck, "1, 1, 2.", "1", "another amplitude");
}

#[test]
fn times() {
    inside("*STATIC\n", "*STATIC", "*STATIC", "one procedure");
    let step = |line: &str| format!("*STEP\n*STATIC\n{line}\n*END STEP\n");
    behind(&step("-0.1, 1."), "-0.1, 1.", "-0.1", "positive");
    behind(&step("0.1, -1."), "0.1, -1.", "-1.", "positive");
    behind(
        &step("1e-9, 1."),
        "1e-9, 1.",
        "1e-9, 1.",
        "more than 1000000 increments",
    );
    let deck = "*STEP, INC=5\n*STATIC\n0.1, 1.\n*END STEP\n";
    behind(deck, "*STEP, INC=5", "INC=5", "needs 10 increments");
    let tiny = step("1., 1e20") + &step("1., 1.");
    behind(&tiny, "1., 1e20", "1., 1e20", "more than 1000000");
    behind(
        "*AMPLITUDE, NAME=A\n0., 0., 1.\n",
        "*AMPLITUDE, NAME=A",
        "*AMPLITUDE",
        "one value is missing",
    );
    behind(
        "*AMPLITUDE, NAME=A\n0., 0., 0., 1.\n",
        "*AMPLITUDE, NAME=A",
        "*AMPLITUDE",
        "not later",
    );
    behind("*AMPLITUDE, NAME=A\n", "*AMPLITUDE, NAME=A", "*AMPLITUDE", "no points");
    let far = step("1e17, 1e17") + "*STEP\n*STATIC\n1., 2.\n*END STEP\n";
    behind(&far, "*STATIC", "*STATIC", "by rounding");
}
