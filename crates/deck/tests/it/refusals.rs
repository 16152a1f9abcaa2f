//! What is refused, each once: file, line and word are named, and a remedy.

use signorini_deck::Deck;

use crate::write::{cube, folder, read};

/// A support and a step around what is tried.
fn in_step(lines: &str) -> String {
    format!("*BOUNDARY\nN5, 1, 3\n*STEP\n*STATIC\n{lines}*END STEP\n")
}

/// The deck is refused at the last line that equals `line`, for `word`, and the sentence says `part`.
#[track_caller]
fn refused(deck: &str, line: &str, word: &str, part: &str) {
    let error = read(deck).expect_err(line);
    let text = error.to_string();
    assert_eq!(error.word(), Some(word), "{text}");
    assert!(text.contains(part), "{text}");
    let place = error.place().expect("a place");
    let at = deck.lines().collect::<Vec<_>>();
    let wanted = at.iter().rposition(|l| *l == line).expect("the line") + 1;
    assert_eq!(place.line, wanted, "{text}");
    assert!(place.file.ends_with("part.inp"), "{text}");
    assert!(text.contains("part.inp:"), "{text}");
    assert_eq!(format!("{error:?}"), text);
}

/// Refused behind a cube with material.
#[track_caller]
fn behind(rest: &str, line: &str, word: &str, part: &str) {
    refused(&cube(rest), line, word, part);
}

/// Refused inside a step.
#[track_caller]
fn inside(lines: &str, line: &str, word: &str, part: &str) {
    refused(&cube(&in_step(lines)), line, word, part);
}

#[test]
fn keywords() {
    behind(
        "*NODDE\n",
        "*NODDE",
        "*NODDE",
        "not known; those that are read: *HEADING",
    );
    behind("*Tie, name=T\n", "*Tie, name=T", "*Tie", "merge the nodes");
    behind("*PART, NAME=A\n", "*PART, NAME=A", "*PART", "flat one");
    behind(
        "*RIGID BODY\n",
        "*RIGID BODY",
        "*RIGID BODY",
        "ELSET is missing",
    );
    behind(
        "*RIGID BODY, ANALYTICAL SURFACE=A\n",
        "*RIGID BODY, ANALYTICAL SURFACE=A",
        "ANALYTICAL SURFACE=A",
        "ELSET, REF NODE, ROT NODE",
    );
    behind("*RESTART, READ\n", "*RESTART, READ", "*RESTART", "resumed");
    inside("*DYNAMIC\n", "*DYNAMIC", "*DYNAMIC", "only *STATIC");
    inside("*NODE\n1\n", "*NODE", "*NODE", "before the first *STEP");
    behind(
        "*CLOAD\n1, 1, 1.\n",
        "*CLOAD",
        "*CLOAD",
        "between *STEP and *END STEP",
    );
    behind("*STEP\n*STATIC\n", "*STEP", "*STEP", "*END STEP");
    behind("*STEP\n*END STEP\n", "*STEP", "*STEP", "*STATIC");
    inside("*STEP, INC=5\n", "*STEP, INC=5", "*STEP", "not ended");
    inside(
        "*STATIC, DIRECT\n",
        "*STATIC, DIRECT",
        "*STATIC",
        "one procedure",
    );
    behind(
        "*NSET, NSET=A,\n",
        "*NSET, NSET=A,",
        "*NSET, NSET=A,",
        "no line continues it",
    );
    refused(
        "1, 2, 3\n*NODE\n",
        "1, 2, 3",
        "1, 2, 3",
        "begin with a keyword",
    );
}

#[test]
fn parameters() {
    behind(
        "*NSET, NSET=A, UNSORTED\n1\n",
        "*NSET, NSET=A, UNSORTED",
        "UNSORTED",
        "GENERATE",
    );
    behind(
        "*NSET, GENERATE\n1, 2\n",
        "*NSET, GENERATE",
        "*NSET",
        "NSET is missing",
    );
    behind("*NSET, NSET=\n1\n", "*NSET, NSET=", "NSET=", "a value");
    behind(
        "*NSET, NSET=A, NSET=B\n1\n",
        "*NSET, NSET=A, NSET=B",
        "NSET=B",
        "twice",
    );
    behind(
        "*NSET, NSET=A, GENERATE=YES\n1, 2\n",
        "*NSET, NSET=A, GENERATE=YES",
        "GENERATE=YES",
        "without a value",
    );
    behind("*STEP, NLGEOM\n", "*STEP, NLGEOM", "NLGEOM", "small");
    behind(
        "*STEP, PERTURBATION\n",
        "*STEP, PERTURBATION",
        "PERTURBATION",
        "linear",
    );
    behind(
        "*STEP, INC=many\n",
        "*STEP, INC=many",
        "INC=many",
        "a number",
    );
    behind(
        "*ELASTIC, TYPE=ORTHO\n1.\n",
        "*ELASTIC, TYPE=ORTHO",
        "TYPE=ORTHO",
        "isotropic",
    );
    behind(
        "*ELASTIC, TYPE=ENGINEERING CONSTANTS\n1.\n",
        "*ELASTIC, TYPE=ENGINEERING CONSTANTS",
        "TYPE=ENGINEERING CONSTANTS",
        "isotropic",
    );
    inside(
        "*CLOAD, OP=OLD\n1, 1, 1.\n",
        "*CLOAD, OP=OLD",
        "OP=OLD",
        "OP=MOD or OP=NEW",
    );
    inside(
        "*CLOAD\n1, 1, 1.\n*CLOAD, OP=NEW\n",
        "*CLOAD, OP=NEW",
        "*CLOAD",
        "only the first card",
    );
    inside(
        "*CLOAD, AMPLITUDE=A\n",
        "*CLOAD, AMPLITUDE=A",
        "AMPLITUDE=A",
        "there is none",
    );
    inside(
        "*BOUNDARY, FIXED\n",
        "*BOUNDARY, FIXED",
        "FIXED",
        "OP, AMPLITUDE, TYPE",
    );
    behind(
        "*AMPLITUDE, NAME=A, VALUE=ABSOLUTE\n",
        "*AMPLITUDE, NAME=A, VALUE=ABSOLUTE",
        "VALUE=ABSOLUTE",
        "RELATIVE",
    );
}

#[test]
fn mesh() {
    for kind in ["C3D10", "C3D8", "S3", "R2D2"] {
        let line = format!("*ELEMENT, TYPE={kind}");
        behind(&format!("{line}\n"), &line, &format!("TYPE={kind}"), "C3D4");
    }
    behind(
        "*NODE\n1, 0., 0., 0.\n",
        "1, 0., 0., 0.",
        "1",
        "first in line 2",
    );
    behind(
        "*NODE\n0, 0., 0., 0.\n",
        "0, 0., 0., 0.",
        "0",
        "from 1 to 2147483647",
    );
    behind(
        "*NODE\n9999999999, 0.\n",
        "9999999999, 0.",
        "9999999999",
        "from 1 to 2147483647",
    );
    behind(
        "*NODE\n99, nan, 0.\n",
        "99, nan, 0.",
        "nan",
        "a finite number",
    );
    behind(
        "*NODE\n99, 1e999, 0.\n",
        "99, 1e999, 0.",
        "1e999",
        "a finite number",
    );
    behind(
        "*NODE\n99, 0., 0., 0., 1.\n",
        "99, 0., 0., 0., 1.",
        "1.",
        "three coordinates",
    );
    let element = "*ELEMENT, TYPE=C3D4\n";
    behind(
        &format!("{element}1, 1, 2, 3, 4\n"),
        "1, 1, 2, 3, 4",
        "1",
        "a second time",
    );
    behind(
        &format!("{element}99, 1, 2, 3, 98\n"),
        "99, 1, 2, 3, 98",
        "98",
        "no node",
    );
    behind(
        &format!("{element}99, 1, 2, 3\n"),
        "99, 1, 2, 3",
        "99, 1, 2, 3",
        "four node numbers",
    );
    behind(
        &format!("{element}99, 1, 2, 4, 10\n"),
        "99, 1, 2, 4, 10",
        "99",
        "no *SOLID SECTION",
    );
    behind(
        &format!("{element}99, 1, 4, 2, 10\n"),
        "99, 1, 4, 2, 10",
        "99",
        "inside out",
    );
    let error = read("*NODE\n1, 0., 0., 0.\n").expect_err("no elements");
    assert!(error.to_string().contains("TYPE=C3D4"), "{error}");
    let twice = "*NODE\n1\n2, 1.\n3, 0., 1.\n4, 0., 0., 1.\n*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n2, 1, 2, 3, 4\n";
    let error = read(twice).expect_err("overlap").to_string();
    assert!(
        error.contains("part.inp") && error.contains("make no mesh"),
        "{error}"
    );
}

#[test]
fn sets_and_surfaces() {
    behind(
        "*NSET, NSET=A\n1, 999\n",
        "1, 999",
        "999",
        "no node with this number",
    );
    behind(
        "*NSET, NSET=A\n1, MISSING\n",
        "1, MISSING",
        "MISSING",
        "there are: N1, N2",
    );
    behind("*NSET, NSET=A\nA\n", "A", "A", "defined before it");
    behind(
        "*NSET, NSET=A, GENERATE\n5, 2\n",
        "5, 2",
        "5, 2",
        "not below the first",
    );
    behind(
        "*NSET, NSET=A, GENERATE\n800, 900\n",
        "800, 900",
        "800, 900, 1",
        "no node",
    );
    behind(
        "*NSET, NSET=A, GENERATE\n1, 2000000000\n",
        "1, 2000000000",
        "1, 2000000000",
        "more than 100000000",
    );
    behind(
        "*SURFACE, NAME=A, TYPE=NODE\n",
        "*SURFACE, NAME=A, TYPE=NODE",
        "TYPE=NODE",
        "no areas",
    );
    behind(
        "*SURFACE, NAME=S1\n1, S1\n",
        "*SURFACE, NAME=S1",
        "*SURFACE",
        "there already",
    );
    behind("*SURFACE, NAME=A\nALL\n", "ALL", "ALL", "S1, S2, S3 or S4");
    behind(
        "*SURFACE, NAME=A\nALL, S5\n",
        "ALL, S5",
        "S5",
        "S1, S2, S3 or S4",
    );
    behind(
        "*SURFACE, NAME=A\nPART, S1\n",
        "PART, S1",
        "PART",
        "there are: ALL",
    );
    behind(
        "*SURFACE, NAME=A\nALL, S1\n",
        "ALL, S1",
        "ALL",
        "inside the body",
    );
    behind(
        "*SURFACE, NAME=A\n",
        "*SURFACE, NAME=A",
        "*SURFACE",
        "no faces",
    );
}

#[test]
fn materials() {
    let mesh = "*NODE\n1\n2, 1.\n3, 0., 1.\n4, 0., 0., 1.\n*ELEMENT, TYPE=C3D4, ELSET=ALL\n1, 1, 2, 3, 4\n";
    let try_one = |rest: &str, line: &str, word: &str, part: &str| {
        refused(&format!("{mesh}{rest}"), line, word, part);
    };
    let section = "*SOLID SECTION, ELSET=ALL, MATERIAL=M";
    try_one(
        &format!("{section}\n"),
        section,
        "MATERIAL=M",
        "there is none",
    );
    try_one(
        &format!("*MATERIAL, NAME=M\n{section}\n"),
        "*MATERIAL, NAME=M",
        "M",
        "*ELASTIC",
    );
    try_one(
        "*ELASTIC\n1., 0.3\n",
        "*ELASTIC",
        "*ELASTIC",
        "*MATERIAL before",
    );
    try_one(
        "*MATERIAL, NAME=M\n*MATERIAL, NAME=M\n",
        "*MATERIAL, NAME=M",
        "*MATERIAL",
        "second",
    );
    let young = format!("*MATERIAL, NAME=M\n*ELASTIC\n-1., 0.3\n{section}\n");
    try_one(&young, "-1., 0.3", "-1, 0.3", "Young's modulus is -1");
    try_one(
        "*MATERIAL, NAME=M\n*ELASTIC\n1.\n",
        "1.",
        "1.",
        "Poisson's ratio",
    );
    try_one(
        "*MATERIAL, NAME=M\n*ELASTIC\n1., 0.3, 0.\n2., 0.3, 100.\n",
        "2., 0.3, 100.",
        "2., 0.3, 100.",
        "temperature",
    );
    try_one(
        "*MATERIAL, NAME=M\n*EXPANSION\n",
        "*EXPANSION",
        "*EXPANSION",
        "temperature",
    );
    try_one(
        "*MATERIAL, NAME=M\n*PLASTIC\n",
        "*PLASTIC",
        "*PLASTIC",
        "elastic",
    );
    let both = "*MATERIAL, NAME=M\n*ELASTIC\n1., 0.3\n*SOLID SECTION, ELSET=ALL, MATERIAL=M\n*SOLID SECTION, MATERIAL=M, ELSET=ALL\n";
    try_one(
        both,
        "*SOLID SECTION, MATERIAL=M, ELSET=ALL",
        "ELSET=ALL",
        "one section",
    );
    let other = "*SOLID SECTION, ELSET=BODY, MATERIAL=M";
    try_one(&format!("{other}\n"), other, "ELSET=BODY", "there are: ALL");
}

#[test]
fn contact() {
    let law = "*SURFACE INTERACTION, NAME=I\n";
    let linear = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR";
    behind(
        &format!("{law}{linear}\n1e6\n"),
        linear,
        "PRESSURE-OVERCLOSURE=LINEAR",
        "HARD",
    );
    behind(
        &format!("{law}*FRICTION\n-0.3\n"),
        "-0.3",
        "-0.3",
        "at least zero",
    );
    behind(
        &format!("{law}*FRICTION, ROUGH\n"),
        "*FRICTION, ROUGH",
        "ROUGH",
        "SLIP TOLERANCE",
    );
    behind(
        "*FRICTION\n0.3\n",
        "*FRICTION",
        "*FRICTION",
        "*SURFACE INTERACTION before",
    );
    let pair = "*CONTACT PAIR, INTERACTION=I";
    behind(
        &format!("{pair}\nS1, S2\n"),
        "S1, S2",
        "INTERACTION=I",
        "there is none",
    );
    behind(
        &format!("{law}{pair}\nS1, S9\n"),
        "S1, S9",
        "S9",
        "there are: S1, S2",
    );
    behind(
        &format!("{law}{pair}\nS1, S1\n"),
        "S1, S1",
        "S1",
        "does not touch itself",
    );
    behind(&format!("{law}{pair}\nS1\n"), "S1", "S1", "slave");
    behind(
        &format!("{law}{pair}\n"),
        pair,
        "*CONTACT PAIR",
        "no surfaces",
    );
    let adjust = "*CONTACT PAIR, INTERACTION=I, ADJUST=0.1";
    behind(
        &format!("{law}{adjust}\nS1, S2\n"),
        adjust,
        "ADJUST=0.1",
        "SMALL SLIDING",
    );
    let odd = "*CONTACT PAIR, INTERACTION=I, TYPE=SIDEWAYS";
    behind(
        &format!("{law}{odd}\nS1, S2\n"),
        odd,
        "TYPE=SIDEWAYS",
        "MORTAR",
    );
}

#[test]
fn supports() {
    behind("*BOUNDARY\nTOP, 1\n", "TOP, 1", "TOP", "there are: N1");
    behind("*BOUNDARY\nN5, 1, 6\n", "N5, 1, 6", "6", "no rotations");
    behind(
        "*BOUNDARY\nN5, 3, 1\n",
        "N5, 3, 1",
        "1",
        "not below the first",
    );
    behind("*BOUNDARY\nN5\n", "N5", "N5", "a component");
    behind("*BOUNDARY\nN5, XASYMM\n", "N5, XASYMM", "XASYMM", "XSYMM");
    behind(
        "*BOUNDARY\nN5, PINNED, 1\n",
        "N5, PINNED, 1",
        "1",
        "nothing after",
    );
    behind(
        "*BOUNDARY\nN5, 1, 1, 0.1\n",
        "N5, 1, 1, 0.1",
        "N5, 1, 1, 0.1",
        "before the first *STEP",
    );
    behind("*BOUNDARY\n99, 1\n", "99, 1", "99", "no node");
    inside(
        "*BOUNDARY\nN6, 1, 1, 0.1\nN6, 1, 1, 0.2\n",
        "N6, 1, 1, 0.2",
        "N6",
        "0.1 and 0.2",
    );
    let next = "*STEP\n*STATIC\n*BOUNDARY, OP=NEW\nN5, 1, 2\n*END STEP\n";
    let line = "*BOUNDARY, OP=NEW";
    refused(
        &cube(&(in_step("") + next)),
        line,
        "OP=NEW",
        "releases component 3 of node",
    );
    let next = "*STEP\n*STATIC\n*BOUNDARY\nN6, 2\n*END STEP\n";
    refused(
        &cube(&(in_step("") + next)),
        "N6, 2",
        "N6",
        "free in the steps before",
    );
}

#[test]
fn loads() {
    inside(
        "*CLOAD\nN6, 4, 1.\n",
        "N6, 4, 1.",
        "4",
        "a component 1, 2 or 3",
    );
    inside("*CLOAD\nN6, 1\n", "N6, 1", "N6, 1", "and a force");
    inside("*CLOAD\nN7, 1, 1.\n", "N7, 1, 1.", "N7", "there are: N1");
    inside("*DLOAD\nALL, P5, 1.\n", "ALL, P5, 1.", "P5", "P1 to P4");
    inside(
        "*DLOAD\nALL, CENTRIF, 1.\n",
        "ALL, CENTRIF, 1.",
        "CENTRIF",
        "GRAV",
    );
    inside(
        "*DLOAD\nALL, P1, 1.\n",
        "ALL, P1, 1.",
        "ALL",
        "inside the body",
    );
    inside(
        "*DLOAD\nALL, P1, 1., 2.\n",
        "ALL, P1, 1., 2.",
        "2.",
        "a value",
    );
    let nowhere = "ALL, GRAV, 9.8, 0., 0., 0.";
    inside(
        &format!("*DLOAD\n{nowhere}\n"),
        nowhere,
        nowhere,
        "not zero",
    );
    inside(
        "*DSLOAD\nS6, TRVEC, 1.\n",
        "S6, TRVEC, 1.",
        "TRVEC",
        "P, and a pressure",
    );
    inside(
        "*DSLOAD\nTOP, P, 1.\n",
        "TOP, P, 1.",
        "TOP",
        "there are: S1",
    );
    inside(
        "*DSLOAD\nS6, P, 1.\nS6, P, 2.\n",
        "S6, P, 2.",
        "S6",
        "give their sum once",
    );
    let alone = "*NODE\n99, 5., 5., 5.\n*NSET, NSET=ALONE\n99\n";
    let deck = cube(&format!("{alone}{}", in_step("*CLOAD\nALONE, 1, 1.\n")));
    refused(
        &deck,
        "ALONE, 1, 1.",
        "ALONE",
        "no elastic element uses node 99",
    );
    let deck =
        cube(&in_step("*DLOAD\nALL, GRAV, 9.8, 0., 0., -1.\n")).replace("*DENSITY\n7.8e-9\n", "");
    refused(&deck, "ALL, GRAV, 9.8, 0., 0., -1.", "ALL", "*DENSITY");
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
    behind(&step("0., 1."), "0., 1.", "0.", "positive");
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
    behind(
        "*AMPLITUDE, NAME=A\n",
        "*AMPLITUDE, NAME=A",
        "*AMPLITUDE",
        "no points",
    );
    let far = step("1e17, 1e17") + "*STEP\n*STATIC\n1., 2.\n*END STEP\n";
    behind(&far, "*STATIC", "*STATIC", "by rounding");
}

#[test]
fn included_files() {
    let error = read("*INCLUDE, INPUT=missing.inp\n").expect_err("missing");
    assert!(error.to_string().contains("missing.inp"), "{error}");
    assert_eq!(error.word(), Some("INPUT=missing.inp"));
    let (_folder, path) = folder(&[
        ("part.inp", "*HEADING\n*INCLUDE, INPUT=other.inp\n"),
        ("other.inp", "** a comment\n*INCLUDE, INPUT=./part.inp\n"),
    ]);
    let error = Deck::read(path).expect_err("a loop");
    let place = error.place().expect("place");
    assert!(
        place.file.ends_with("other.inp") && place.line == 2,
        "{error}"
    );
    assert!(error.to_string().contains("includes itself"), "{error}");
    let error = Deck::read("no/such/deck.inp").expect_err("no file");
    assert!(
        error.to_string().contains("cannot read no/such/deck.inp"),
        "{error}"
    );
}

/// What a program asks for.
#[test]
fn names_and_scenes() {
    let deck = read(&cube("")).expect("deck");
    let error = deck.surface("top").expect_err("no surface").to_string();
    assert!(
        error.contains("no surface named \"top\"; there are: S1, S2"),
        "{error}"
    );
    assert!(deck.node_set("top").is_err() && deck.element_set("top").is_err());
    let mesh = "*NODE\n1\n2, 1.\n3, 0., 1.\n4, 0., 0., 1.\n*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n";
    let deck = read(mesh).expect("a mesh");
    let error = deck.scene().expect_err("no scene").to_string();
    assert!(error.contains("no *SOLID SECTION"), "{error}");
}

/// A cube on a rigid plane; `floor` are the corners of the plane and what else changes.
fn on_a_floor(nodes: &str, rest: &str) -> String {
    let floor = "*ELEMENT, TYPE=R3D4, ELSET=FLOOR\n900, 101, 102, 103, 104\n*RIGID BODY, REF NODE=109, ELSET=FLOOR\n*SURFACE, NAME=PLANE\nFLOOR, SPOS\n*SURFACE INTERACTION, NAME=I\n";
    cube(&format!("*NODE\n{nodes}109, 0., 0., 0.\n{floor}{rest}"))
}

#[test]
fn rigid_bodies() {
    let plane = "101, -1., -1.\n102, 2., -1.\n103, 2., 2.\n104, -1., 2.\n";
    let pair = "*CONTACT PAIR, INTERACTION=I\nS5, PLANE\n";
    let held = format!("{pair}*BOUNDARY\n109, ENCASTRE\n");
    assert!(read(&on_a_floor(plane, &held)).is_ok());
    let try_one = |nodes: &str, rest: &str, line: &str, word: &str, part: &str| {
        refused(&on_a_floor(nodes, rest), line, word, part);
    };
    let body = "*RIGID BODY, REF NODE=109, ELSET=FLOOR";
    try_one(
        plane,
        pair,
        body,
        "REF NODE=109",
        "not held along component 1",
    );
    let free = format!("{pair}*BOUNDARY\n109, PINNED\n");
    try_one(plane, &free, body, "REF NODE=109", "component 4");
    let step = |lines: &str| format!("{held}*STEP\n*STATIC\n{lines}*END STEP\n");
    try_one(
        plane,
        &step("*BOUNDARY\n109, 5, 5, 0.1\n"),
        body,
        "REF NODE=109",
        "turns",
    );
    let two = "*AMPLITUDE, NAME=A\n0., 0., 1., 1., 2., 0.\n".to_owned()
        + &step("*BOUNDARY\n109, 1, 1, 0.1\n*BOUNDARY, AMPLITUDE=A\n109, 2, 2, 0.1\n");
    try_one(plane, &two, body, "REF NODE=109", "different histories");
    try_one(
        plane,
        &step("*DSLOAD\nPLANE, P, 1.\n"),
        "PLANE, P, 1.",
        "PLANE",
        "acts on nothing",
    );
    try_one(
        plane,
        &step("*CLOAD\n109, 1, 1.\n"),
        "109, 1, 1.",
        "109",
        "no elastic element",
    );
    try_one(
        plane,
        &step("*DLOAD\n900, P1, 1.\n"),
        "900, P1, 1.",
        "900",
        "acts on nothing",
    );
    let bent = plane.replace("103, 2., 2.", "103, 2., 2., 0.1");
    try_one(&bent, &held, "S5, PLANE", "PLANE", "not flat");
    let small = plane.replace("103, 2., 2.", "103, 0.5, 0.5");
    try_one(
        &small,
        &held,
        "S5, PLANE",
        "PLANE",
        "lies beside the rigid surface",
    );
    let swapped = held.replace("S5, PLANE", "PLANE, S5");
    try_one(plane, &swapped, "PLANE, S5", "PLANE", "swap them");
    let side = "*SURFACE, NAME=B\n900, S1\n";
    try_one(
        plane,
        &format!("{held}{side}"),
        "900, S1",
        "900",
        "SPOS or SNEG",
    );
    let mixed = "*SURFACE, NAME=B\n900, SPOS\n1, S1\n";
    try_one(
        plane,
        &format!("{mixed}{held}"),
        "1, S1",
        "1",
        "rigid and elastic faces",
    );
    behind("*SURFACE, NAME=B\n1, SPOS\n", "1, SPOS", "1", "S1 to S4");
    let other = "*ELSET, ELSET=MORE\n900\n*RIGID BODY, ELSET=MORE, REF NODE=1\n";
    let line = "*RIGID BODY, ELSET=MORE, REF NODE=1";
    try_one(
        plane,
        &format!("{other}{held}"),
        line,
        "ELSET=MORE",
        "another rigid body",
    );
    let many = "*ELSET, ELSET=MORE\n1\n*RIGID BODY, ELSET=MORE, REF NODE=N5\n";
    let line = "*RIGID BODY, ELSET=MORE, REF NODE=N5";
    try_one(
        plane,
        &format!("{many}{held}"),
        line,
        "REF NODE=N5",
        "one node",
    );
    let bonded = "*ELEMENT, TYPE=R3D3, ELSET=FLOOR\n901, 101, 1, 103\n";
    try_one(
        plane,
        &format!("{bonded}{held}"),
        "901, 101, 1, 103",
        "901",
        "node 1 is of a rigid body and of elastic elements",
    );
    let corner = "*ELSET, ELSET=MORE\n901\n*ELEMENT, TYPE=R3D3\n901, 101, 102, 103\n*RIGID BODY, ELSET=MORE, REF NODE=2\n";
    let line = "*RIGID BODY, ELSET=MORE, REF NODE=2";
    try_one(
        plane,
        &format!("{corner}{held}"),
        line,
        "REF NODE=2",
        "node 2 is of a rigid body",
    );
    let loose = "*ELEMENT, TYPE=R3D3\n901, 101, 102, 103\n";
    try_one(
        plane,
        &format!("{loose}{held}"),
        "901, 101, 102, 103",
        "901",
        "no rigid body",
    );
}
