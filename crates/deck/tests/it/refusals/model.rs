//! Mesh, sets, materials, contact and rigid bodies.

use super::{behind, in_step, refused};
use crate::write::{cube, read};

#[test]
fn parameters_of_contact_that_cannot_be_had() {
    for (line, word, remedy) in [
        ("*FRICTION, ROUGH", "ROUGH", "a large coefficient"),
        ("*FRICTION, TAUMAX=2.", "TAUMAX=2.", "remove it"),
    ] {
        let rest = format!("*SURFACE INTERACTION, NAME=I\n{line}\n");
        behind(&rest, line, word, remedy);
    }
}

#[test]
fn mesh() {
    for kind in ["C3D27", "C3D8V", "S3", "R2D2"] {
        let line = format!("*ELEMENT, TYPE={kind}");
        behind(&format!("{line}\n"), &line, &format!("TYPE={kind}"), "C3D4");
    }
    behind("*NODE\n1, 0., 0., 0.\n", "1, 0., 0., 0.", "1", "part.inp:2; give");
    behind("*NODE\n0, 0., 0., 0.\n", "0, 0., 0., 0.", "0", "from 1 to 2147483647");
    behind(
        "*NODE\n9999999999, 0.\n",
        "9999999999, 0.",
        "9999999999",
        "from 1 to 2147483647",
    );
    behind("*NODE\n99, nan, 0.\n", "99, nan, 0.", "nan", "a finite number");
    behind("*NODE\n99, 1e999, 0.\n", "99, 1e999, 0.", "1e999", "a finite number");
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
    assert!(error.contains("part.inp") && error.contains("make no mesh"), "{error}");
}

#[test]
fn sets_and_surfaces() {
    behind("*NSET, NSET=A\n1, 999\n", "1, 999", "999", "no node with this number");
    behind(
        "*NSET, NSET=A\n1, MISSING\n",
        "1, MISSING",
        "MISSING",
        "there are: N1, N2",
    );
    behind("*NSET, NSET=A\nA\n", "A", "A", "defined before it");
    behind("*NSET, NSET=A, GENERATE\n5, 2\n", "5, 2", "5, 2", "not below the first");
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
    let of_nodes = "*SURFACE, NAME=A, TYPE=NODE\n";
    behind(&format!("{of_nodes}1, S1\n"), "1, S1", "S1", "a node or node set");
    behind(&format!("{of_nodes}N5, 27\n"), "N5, 27", "27", "a node or node set");
    behind(
        &format!("{of_nodes}N5\n27\n"),
        "27",
        "27",
        "node 27 is on no face of the boundary",
    );
    let unused = format!("*NODE\n900\n{of_nodes}N5\n900\n");
    behind(&unused, "900", "900", "no elastic element uses node 900");
    let kind = "*SURFACE, NAME=A, TYPE=CYLINDER";
    behind(&format!("{kind}\n"), kind, "TYPE=CYLINDER", "TYPE=NODE");
    behind(
        "*SURFACE, NAME=S1\n1, S1\n",
        "*SURFACE, NAME=S1",
        "*SURFACE",
        "there already",
    );
    behind(
        "*ELSET, ELSET=IN\n5\n*SURFACE, NAME=A\nIN\n",
        "IN",
        "IN",
        "at the boundary",
    );
    behind("*SURFACE, NAME=A\nALL, S7\n", "ALL, S7", "S7", "S1 to S6");
    behind(
        "*SURFACE, NAME=A\nALL, S5\n",
        "ALL, S5",
        "ALL",
        "element 1 has no face 5",
    );
    behind("*SURFACE, NAME=A\nPART, S1\n", "PART, S1", "PART", "there are: ALL");
    let loaded = in_step("*DSLOAD\nA, P, 1.\n");
    behind(
        &format!("*SURFACE, NAME=A\nALL, S1\n{loaded}"),
        "ALL, S1",
        "ALL",
        "inside the body",
    );
    behind("*SURFACE, NAME=A\n", "*SURFACE, NAME=A", "*SURFACE", "no faces");
}

#[test]
fn materials() {
    let mesh = "*NODE\n1\n2, 1.\n3, 0., 1.\n4, 0., 0., 1.\n*ELEMENT, TYPE=C3D4, ELSET=ALL\n1, 1, 2, 3, 4\n";
    let try_one = |rest: &str, line: &str, word: &str, part: &str| {
        refused(&format!("{mesh}{rest}"), line, word, part);
    };
    let section = "*SOLID SECTION, ELSET=ALL, MATERIAL=M";
    try_one(&format!("{section}\n"), section, "MATERIAL=M", "there is none");
    try_one(
        &format!("*MATERIAL, NAME=M\n{section}\n"),
        "*MATERIAL, NAME=M",
        "M",
        "*ELASTIC",
    );
    try_one("*ELASTIC\n1., 0.3\n", "*ELASTIC", "*ELASTIC", "*MATERIAL before");
    try_one(
        "*MATERIAL, NAME=M\n*MATERIAL, NAME=M\n",
        "*MATERIAL, NAME=M",
        "*MATERIAL",
        "second",
    );
    let young = format!("*MATERIAL, NAME=M\n*ELASTIC\n-1., 0.3\n{section}\n");
    try_one(&young, "-1., 0.3", "-1., 0.3", "Young's modulus is -1");
    try_one("*MATERIAL, NAME=M\n*ELASTIC\n1.\n", "1.", "1.", "Poisson's ratio");
    try_one(
        "*MATERIAL, NAME=M\n*ELASTIC\n1., 0.3, 0.\n2., 0.3, 100.\n",
        "2., 0.3, 100.",
        "2., 0.3, 100.",
        "temperature",
    );
    try_one("*MATERIAL, NAME=M\n*CREEP\n", "*CREEP", "*CREEP", "elastic");
    try_one("*MATERIAL, NAME=M\n*PLASTIC\n", "*PLASTIC", "*PLASTIC", "elastic");
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
    let soft = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=EXPONENTIAL";
    behind(
        &format!("{law}{soft}\n1e6\n"),
        soft,
        "PRESSURE-OVERCLOSURE=EXPONENTIAL",
        "LINEAR with the slope",
    );
    let linear = format!("{law}*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n");
    let hard = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD";
    behind(
        &format!("{linear}100.\n{hard}\n"),
        hard,
        "*SURFACE BEHAVIOR",
        "a second time",
    );
    behind(&format!("{linear}0., 1.\n"), "0., 1.", "0.", "positive");
    behind(&format!("{law}*FRICTION\n0.3, -1e6\n"), "0.3, -1e6", "-1e6", "positive");
    behind(&format!("{law}*FRICTION\n-0.3\n"), "-0.3", "-0.3", "at least zero");
    behind(
        &format!("{law}*FRICTION, LOST\n"),
        "*FRICTION, LOST",
        "LOST",
        "SLIP TOLERANCE",
    );
    behind(
        "*FRICTION\n0.3\n",
        "*FRICTION",
        "*FRICTION",
        "*SURFACE INTERACTION before",
    );
    let pair = "*CONTACT PAIR, INTERACTION=I";
    behind(&format!("{pair}\nS1, S2\n"), pair, "INTERACTION=I", "there is none");
    behind(&format!("{law}{pair}\nS1, S9\n"), "S1, S9", "S9", "there are: S1, S2");
    behind(
        &format!("{law}{pair}\nS1, S1\n"),
        "S1, S1",
        "S1",
        "does not touch itself",
    );
    behind(&format!("{law}{pair}\nS1\n"), "S1", "S1", "slave");
    behind(&format!("{law}{pair}\n"), pair, "*CONTACT PAIR", "no surfaces");
    let adjust = "*CONTACT PAIR, INTERACTION=I, ADJUST=N1";
    behind(
        &format!("{law}{adjust}\nS1, S2\n"),
        adjust,
        "ADJUST=N1",
        "are not adjusted",
    );
    let clearance = "*CLEARANCE, SLAVE=S2, MASTER=S1, VALUE=0.1";
    behind(
        &format!("{law}{pair}\nS1, S2\n{clearance}\n"),
        clearance,
        "*CLEARANCE",
        "in this order",
    );
    let again = "*CLEARANCE, MASTER=S2, SLAVE=S1, VALUE=0.1";
    behind(
        &format!("{law}{pair}\nS1, S2\n*CLEARANCE, SLAVE=S1, MASTER=S2, VALUE=0.1\n{again}\n"),
        again,
        "*CLEARANCE",
        "keep one of them",
    );
    let tied = "*CLEARANCE, SLAVE=S1, MASTER=S2, VALUE=0.1";
    behind(
        &format!("*TIE\nS1, S2\n{tied}\n"),
        tied,
        "*CLEARANCE",
        "no *CONTACT PAIR",
    );
    let wide = "*CLEARANCE, SLAVE=S1, MASTER=S2, VALUE=wide";
    behind(&format!("{wide}\n"), wide, "VALUE=wide", "negative for an interference");
    let odd = "*CONTACT PAIR, INTERACTION=I, TYPE=SIDEWAYS";
    behind(&format!("{law}{odd}\nS1, S2\n"), odd, "TYPE=SIDEWAYS", "MORTAR");
    for kind in ["MORTAR", "PG MORTAR", "LINMORTAR", "PGLINMORTAR"] {
        let pair = format!("*CONTACT PAIR, INTERACTION=I, TYPE={kind}\nS1, S2\n");
        assert!(read(&cube(&format!("{law}{pair}"))).is_ok(), "{kind}");
    }
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
    try_one(plane, pair, body, "REF NODE=109", "not held along component 1");
    let free = format!("{pair}*BOUNDARY\n109, PINNED\n");
    try_one(plane, &free, body, "REF NODE=109", "component 4");
    let step = |lines: &str| format!("{held}*STEP\n*STATIC\n{lines}*END STEP\n");
    let two = "*AMPLITUDE, NAME=A\n0., 0., 1., 1., 2., 0.\n".to_owned()
        + &step("*BOUNDARY\n109, 4, 4, 0.1\n*BOUNDARY, AMPLITUDE=A\n109, 5, 5, 0.1\n");
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
        "whose reaction is the force",
    );
    try_one(
        plane,
        &step("*DLOAD\n900, P1, 1.\n"),
        "900, P1, 1.",
        "900",
        "acts on nothing",
    );
    let adjusted = held.replace("INTERACTION=I", "INTERACTION=I, ADJUST=0.");
    let line = "*CONTACT PAIR, INTERACTION=I, ADJUST=0.";
    try_one(plane, &adjusted, line, "ADJUST=0.", "to a rigid surface");
    let line = "*CLEARANCE, SLAVE=S5, MASTER=PLANE, VALUE=0.1";
    let clear = format!("{held}{line}\n");
    assert!(read(&on_a_floor(plane, &clear)).is_ok());
    let small = plane.replace("2., ", "0.7, ");
    assert!(read(&on_a_floor(&small, &held)).is_ok());
    try_one(&small, &clear, line, "*CLEARANCE", "half-space");
    let swapped = held.replace("S5, PLANE", "PLANE, S5");
    try_one(plane, &swapped, "PLANE, S5", "PLANE", "swap them");
    let side = "*SURFACE, NAME=B\n900, S1\n";
    try_one(plane, &format!("{held}{side}"), "900, S1", "900", "SPOS or SNEG");
    let mixed = "*SURFACE, NAME=B\n900, SPOS\n1, S1\n";
    try_one(
        plane,
        &format!("{mixed}{held}"),
        "1, S1",
        "1",
        "rigid and elastic faces",
    );
    behind("*SURFACE, NAME=B\n1, SPOS\n", "1, SPOS", "1", "S1 to S6");
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
    try_one(plane, &format!("{many}{held}"), line, "REF NODE=N5", "one node");
    let corner =
        "*ELSET, ELSET=MORE\n901\n*ELEMENT, TYPE=R3D3\n901, 101, 102, 103\n*RIGID BODY, ELSET=MORE, REF NODE=2\n";
    let line = "*RIGID BODY, ELSET=MORE, REF NODE=2";
    try_one(
        plane,
        &format!("{corner}{held}"),
        line,
        "REF NODE=2",
        "node 2 belongs to an elastic element",
    );
    let folded = "*ELEMENT, TYPE=R3D3, ELSET=FLOOR\n901, 102, 103, 27\n";
    try_one(
        &plane.replace("103, 2., 2.", "103, 2., 2., 0.1"),
        &format!("{folded}{held}"),
        "S5, PLANE",
        "PLANE",
        "is no obstacle: facet",
    );
    let loaded = "*BOUNDARY\nN5, 1, 3\n*STEP\n*STATIC\n*CLOAD\n109, 1, 1.\n*END STEP\n";
    let other = "*RIGID BODY, NSET=N2, REF NODE=109";
    let shared = format!("*NODE\n109\n*RIGID BODY, NSET=N6, REF NODE=109\n{other}\n{loaded}");
    behind(
        &shared,
        "*RIGID BODY, NSET=N6, REF NODE=109",
        "REF NODE=109",
        "another rigid body moves, too",
    );
    let moment = "*NODE\n109\n*NODE\n110\n*RIGID BODY, NSET=N6, REF NODE=109, ROT NODE=110\n\
        *STEP\n*STATIC\n*CLOAD\n110, 4, 1.\n*END STEP\n";
    behind(moment, "110, 4, 1.", "4", "1 to 3 of a ROT NODE are the moments");
    let line = "*RIGID BODY, NSET=N6, REF NODE=109, ROT NODE=109";
    let one = format!("*NODE\n109\n*BOUNDARY\n109, 1, 6\n{line}\n");
    behind(&one, line, "ROT NODE=109", "node 109 is a REF NODE, too");
    let line = "*RIGID BODY, NSET=N6, REF NODE=109, ROT NODE=110";
    let both = format!(
        "*NODE\n109\n110\n*BOUNDARY\n109, 1, 6\n110, 1, 3\n{line}\n*STEP\n*STATIC\n*BOUNDARY\n110, 2, 2, 0.1\n*END STEP\n"
    );
    let part = "component 2 of this node and component 5 of REF NODE";
    behind(&both, line, "ROT NODE=110", part);
    let step = "*STEP\n*STATIC\n*BOUNDARY\n110, 5, 5, 0.1\n*END STEP\n";
    let moved = format!("*NODE\n109\n110\n*BOUNDARY\n109, 1, 3\n110, 1, 3\n{line}\n{step}");
    behind(
        &moved,
        "110, 5, 5, 0.1",
        "110",
        "component 5 of a ROT NODE means nothing",
    );
    let line = "*RIGID BODY, NSET=N6, REF NODE=109, TIE NSET=N5";
    behind(&format!("{line}\n"), line, "TIE NSET=N5", "into one set");
    let loose = "*ELEMENT, TYPE=R3D3\n901, 101, 102, 103\n";
    try_one(
        plane,
        &format!("{loose}{held}"),
        "901, 101, 102, 103",
        "901",
        "no rigid body",
    );
}
