//! Parts, instances and the assembly.

use signorini_contact::{Settings, Simulation};
use signorini_fem_mesh::{Brick, FacetTag};

use crate::refusals::refused;
use crate::write::{STEEL, cube, mesh, read};

const END: &str = "*SURFACE INTERACTION, NAME=I\n*FRICTION\n0.3\n";

fn part() -> String {
    let brick = Brick::new([1.0; 3], [2, 2, 2]).build().expect("a brick");
    format!(
        "*PART, NAME=Cube\n{}*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n*END PART\n",
        mesh(&brick)
    )
}

fn material() -> &'static str {
    STEEL.split("*SOLID").next().expect("a material")
}

/// Two instances of a cube, the second one turned and put on the first, are what a flat deck says of the two.
#[test]
fn instances_are_copies_that_are_moved() {
    let rest = "*CONTACT PAIR, INTERACTION=I\nLOWER.S6, UPPER.S5\n*BOUNDARY\nLOWER.N5, 1, 3\nTOP, 1, 2\n*STEP\n*STATIC\n\
        *BOUNDARY\nTOP, 3, 3, -0.01\n*CLOAD\nCORNER, 1, 5.\n*DLOAD\n, GRAV, 9.81, 0., 0., -1.\n*END STEP\n";
    let deck = format!(
        "*HEADING\n{}*ASSEMBLY, NAME=A\n*INSTANCE, NAME=Lower, PART=Cube\n*END INSTANCE\n\
        *INSTANCE, NAME=Upper, PART=Cube\n0., 0., 1.\n0.5, 0.5, 0., 0.5, 0.5, 1., 180.\n*END INSTANCE\n\
        *NODE\n1, 9., 9., 9.\n*NSET, NSET=MARK\n1\n*NSET, NSET=CORNER, INSTANCE=Upper, INTERNAL\n14,\n\
        *NSET, NSET=TOP, INSTANCE=Upper\nN6\n*ELSET, ELSET=FEW, INSTANCE=Upper, GENERATE\n1, 3\n\
        *SURFACE, NAME=SKIN\nUPPER.ALL\n*END ASSEMBLY\n{}{END}{rest}",
        part(),
        material()
    );
    let deck = read(&deck).expect("deck");
    let lower = Brick::new([1.0; 3], [2, 2, 2]).build().expect("a brick");
    let turned = lower
        .map_points(|[x, y, z]| [1.0 - x, 1.0 - y, z + 1.0])
        .expect("turned");
    for (found, exact) in deck
        .mesh()
        .points()
        .iter()
        .zip(lower.points().iter().chain(turned.points()))
    {
        assert!(
            (0..3).all(|c| (found[c] - exact[c]).abs() < 1e-15),
            "{found:?} {exact:?}"
        );
    }
    assert_eq!(deck.mesh().tets().len(), 80);
    // 27 nodes and 40 elements: the second instance adds 100
    assert_eq!(deck.node(114), Some(27 + 13));
    assert_eq!(deck.node_set("corner").expect("a set"), [27 + 13]);
    assert_eq!(
        deck.node_set("Upper.N6").expect("a set"),
        deck.node_set("TOP").expect("a set")
    );
    assert_eq!(deck.element_set("FEW").expect("a set"), [40, 41, 42]);
    assert_eq!(deck.element_numbers()[40], 101);

    let flat = lower.append(&turned.map_tags(|tag| FacetTag(tag.0 + 10))).expect("two");
    let flat = format!("{}{STEEL}{END}{rest}", mesh(&flat))
        .replace("LOWER.", "")
        .replace("UPPER.S5", "S15");
    let flat = flat
        .replace("TOP", "N16")
        .replace("CORNER", "41")
        .replace("\n, GRAV", "\nALL, GRAV");
    let [a, b] = [&deck, &read(&flat).expect("flat")].map(|deck| {
        let mut simulation = Simulation::new(deck.scene().expect("scene"), Settings::default()).expect("simulation");
        let step = simulation.step().expect("solved");
        assert!(step.report().status.converged());
        step.displacement()
    });
    for (u, v) in a.iter().zip(&b) {
        assert!((0..3).all(|c| (u[c] - v[c]).abs() < 1e-9), "{u:?} {v:?}");
    }
}

/// A tetrahedron as a part whose numbers are below 1000, with more cards.
fn tet(more: &str) -> String {
    format!(
        "*PART, NAME=T\n*NODE\n1, 0., 0., 0.\n2, 1., 0., 0.\n3, 0., 2., 0.\n999, 0., 0., 0.5\n\
        *ELEMENT, TYPE=C3D4, ELSET=E\n7, 1, 2, 3, 999\n{more}*END PART\n"
    )
}

const TWO: &str = "*INSTANCE, NAME=A, PART=T\n*END INSTANCE\n*INSTANCE, NAME=B, PART=T\n0., 0., 9.\n*END INSTANCE\n";

/// An assembly of two tetrahedra.
fn pair(more: &str, lines: &str) -> String {
    format!("{}*ASSEMBLY\n{TWO}{lines}*END ASSEMBLY\n", tet(more))
}

/// The translation comes first, then the turn, to the right about the axis from its first point to the second. By hand:
/// z + 3, and then (y - 1, z) becomes (-z, y - 1).
#[test]
fn instances_move_and_then_turn() {
    let moved = "*INSTANCE, NAME=A, PART=T\n0., 0., 3.\n0., 1., 0., 2., 1., 0., 90.\n*END INSTANCE\n";
    let deck = read(&format!("{}*ASSEMBLY\n{moved}*END ASSEMBLY\n", tet(""))).expect("deck");
    let exact = [
        (1, [0.0, -2.0, -1.0]),
        (2, [1.0, -2.0, -1.0]),
        (3, [0.0, -2.0, 1.0]),
        (999, [0.0, -2.5, -1.0]),
    ];
    for (number, place) in exact {
        let found = deck.mesh().points()[deck.node(number).expect("a node") as usize];
        assert!(
            (0..3).all(|c| (found[c] - place[c]).abs() < 1e-15),
            "{number}: {found:?}"
        );
    }
}

/// Numbers of an instance do not reach into another one, whose node 5 would be 1005.
#[test]
fn numbers_stay_in_their_instance() {
    let unknown = |deck: &str, line: &str, word: &str, what: &str| {
        refused(deck, line, word, &format!("there is no {what} with this number"));
    };
    unknown(&pair("*NSET, NSET=N\n1, 1001\n", ""), "1, 1001", "1001", "node");
    unknown(&pair("*ELSET, ELSET=F\n1007\n", ""), "1007", "1007", "element");
    unknown(
        &pair("*NSET, NSET=N, GENERATE\n1001, 1003\n", ""),
        "1001, 1003",
        "1001",
        "node",
    );
    let element = "8, 1, 2, 3, 1999";
    let more = format!("*ELEMENT, TYPE=C3D4\n{element}\n");
    unknown(&pair(&more, ""), element, "1999", "node");
    unknown(&pair("*SURFACE, NAME=S\n1007, S1\n", ""), "1007, S1", "1007", "element");
    let nodes = "*SURFACE, NAME=S, TYPE=NODE\n1001\n";
    unknown(&pair(nodes, ""), "1001", "1001", "node");
    let of = "*NSET, NSET=N, INSTANCE=A\n1002\n";
    unknown(&pair("", of), "1002", "1002", "node");
    // the assembly has its own
    unknown(&pair("", "*NSET, NSET=N\n2\n"), "2", "2002", "node");

    let ranges =
        "*NSET, NSET=OF, INSTANCE=A, GENERATE\n1, 100000\n*NODE\n5000\n*NSET, NSET=ALL, GENERATE\n1, 50000000\n";
    let deck = read(&pair("*NSET, NSET=N, GENERATE\n1, 100000\n", ranges)).expect("deck");
    assert_eq!(deck.node_set("A.N").expect("a set"), [0, 1, 2, 3]);
    assert_eq!(deck.node_set("B.N").expect("a set"), [4, 5, 6, 7]);
    assert_eq!(deck.node_set("OF").expect("a set"), [0, 1, 2, 3]);
    assert!(deck.node_set("ALL").expect("a set").is_empty());
    assert_eq!(deck.node(1999), Some(7));
}

/// Cards of the assembly between instances change no numbers.
#[test]
fn the_assembly_comes_last() {
    let between = |lines: &str| {
        let two = TWO.replacen("*END INSTANCE\n", &format!("*END INSTANCE\n{lines}"), 1);
        read(&format!("{}*ASSEMBLY\n{two}*END ASSEMBLY\n", tet(""))).expect("deck")
    };
    for lines in [
        "",
        "*SURFACE, NAME=S\nA.E\n",
        "*ELSET, ELSET=S\nA.E\n",
        "*NODE\n1\n*NSET, NSET=S\n1\n",
    ] {
        assert_eq!(between(lines).element_numbers(), [7, 1007], "{lines}");
    }
    let own = "*NODE\n1, 5.\n2, 6.\n3, 5., 1.\n4, 5., 0., 1.\n*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n";
    let deck = between(own);
    let mut numbers = deck.element_numbers().to_vec();
    numbers.sort_unstable();
    assert_eq!(numbers, [7, 1007, 2001]);
    let first = deck.node(2001).expect("a node") as usize;
    assert_eq!(deck.mesh().points()[first], [5.0, 0.0, 0.0]);
}

/// Nothing that cards of the assembly say is lost.
#[test]
fn nothing_is_dropped() {
    let own = "*NODE\n1\n2, 1.\n*ELEMENT, TYPE=T3D2\n1, 1, 2\n";
    let deck = read(&pair("", own)).expect("deck");
    let ignored = deck.ignored();
    assert!(ignored.iter().any(|i| i.word == "TYPE=T3D2"), "{ignored:?}");

    for line in [
        "*NODE, INSTANCE=A",
        "*ELEMENT, TYPE=C3D4, INSTANCE=A",
        "*SURFACE, NAME=S, INSTANCE=A",
    ] {
        refused(&pair("", &format!("{line}\n")), line, "INSTANCE=A", "no such parameter");
    }
    let twice = "*NSET, NSET=N, INSTANCE=A, INSTANCE=B";
    refused(&pair("", &format!("{twice}\n1\n")), twice, "INSTANCE=B", "given twice");
    let deck = pair("", "");
    for line in [
        "*PART, NAME=T",
        "*END PART",
        "*ASSEMBLY",
        "*END INSTANCE",
        "*END ASSEMBLY",
    ] {
        let with = |more: &str| deck.replacen(&format!("{line}\n"), &format!("{line}{more}\n"), 1);
        refused(&with("\n8., 8."), "8., 8.", "8., 8.", "no data");
        let wrong = format!("{line}, X=1");
        refused(&with(", X=1"), &wrong, "X=1", "no such parameter");
    }
    let second = format!("{deck}*ASSEMBLY, NAME=SECOND\n*END ASSEMBLY\n");
    refused(&second, "*ASSEMBLY, NAME=SECOND", "*ASSEMBLY", "one assembly");
    for line in [
        "*PART, NAME=P",
        "*ASSEMBLY",
        "*INSTANCE, NAME=I, PART=T",
        "*END ASSEMBLY",
    ] {
        let word = line.split(',').next().expect("a word");
        for step in ["*STEP\n*STATIC\n", "*STEP\n*STATIC\n*END STEP\n"] {
            let late = format!("{}{step}{line}\n", tet(""));
            refused(&late, line, word, "before the first *STEP");
        }
    }
}

/// A number inside the assembly would be of the whole deck.
#[test]
fn reference_nodes_of_the_assembly_are_named() {
    let own = "*NODE\n1, 5., 5., 5.\n*NSET, NSET=R\n1\n*SURFACE, NAME=S\nB.E\n";
    for line in [
        "*RIGID BODY, NSET=A.N, REF NODE=1",
        "*RIGID BODY, NSET=A.N, REF NODE=R, ROT NODE=1",
        "*COUPLING, REF NODE=1, SURFACE=S",
    ] {
        let lines = format!("{own}{line}\n*KINEMATIC\n");
        let word = if line.contains("ROT") { "ROT NODE=1" } else { "REF NODE=1" };
        refused(&pair("", &lines), line, word, "name it by a set");
    }
    let lines = format!("{own}*COUPLING, REF NODE=R, SURFACE=S\n*KINEMATIC\n");
    let held = pair("", &lines) + "*BOUNDARY\nR, 1, 6\n";
    read(&held).expect("a set names the node");
    for line in ["*BOUNDARY", "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "*STEP"] {
        let word = line.split(',').next().expect("a word");
        refused(&pair("", &format!("{line}\n")), line, word, "behind *END ASSEMBLY");
    }
}

#[test]
fn what_is_refused() {
    let part = part();
    let tail = format!("{}{END}", material());
    let assembly = |lines: &str| format!("{part}*ASSEMBLY, NAME=A\n{lines}*END ASSEMBLY\n{tail}");
    let one = "*INSTANCE, NAME=B, PART=CUBE\n*END INSTANCE\n";
    assert!(read(&assembly(one)).is_ok());
    let wrong = |lines: &str, line: &str, word: &str, part: &str| refused(&assembly(lines), line, word, part);
    wrong(
        "*INSTANCE, NAME=B, PART=X\n",
        "*INSTANCE, NAME=B, PART=X",
        "PART=X",
        "there are: CUBE",
    );
    let again = "*INSTANCE, NAME=b, PART=CUBE";
    wrong(&format!("{one}{again}\n"), again, "NAME=b", "there already");
    wrong(&format!("{again}\n"), "*END ASSEMBLY", "*END ASSEMBLY", "has not ended");
    wrong(
        &format!("{again}\n*NODE\n1\n"),
        "*NODE",
        "*NODE",
        "put it into the part",
    );
    wrong(
        &format!("{again}\n1., 2., 3., 4.\n"),
        "1., 2., 3., 4.",
        "4.",
        "a translation",
    );
    let axis = "1., 2., 3., 1., 2., 3., 90.";
    wrong(&format!("{again}\n0.\n{axis}\n"), axis, axis, "must differ");
    let set = "*NSET, NSET=N, INSTANCE=C";
    wrong(&format!("{one}{set}\n1\n"), set, "INSTANCE=C", "there are: B");
    wrong("*PART, NAME=D\n", "*PART, NAME=D", "*PART", "has not ended");
    wrong("*END INSTANCE\n", "*END INSTANCE", "*END INSTANCE", "remove it");
    for line in ["*END PART", "*END ASSEMBLY", "*INSTANCE, NAME=B, PART=CUBE"] {
        let part = if line.starts_with("*I") { "put *ASSEMBLY before it" } else { "remove it" };
        refused(
            &format!("{line}\n"),
            line,
            line.split(',').next().expect("a word"),
            part,
        );
    }
    refused("*PART, NAME=A\n", "*PART, NAME=A", "NAME=A", "put *END PART");
    refused("*ASSEMBLY\n", "*ASSEMBLY", "*ASSEMBLY", "put *END ASSEMBLY");
    let inside = "*PART, NAME=A\n*MATERIAL, NAME=M\n";
    refused(inside, "*MATERIAL, NAME=M", "*MATERIAL", "behind *END PART");
    let twice = format!("{part}*PART, NAME=CUBE\n");
    refused(&twice, "*PART, NAME=CUBE", "NAME=CUBE", "another one");
    let large = "*PART, NAME=A\n*NODE\n2147483647\n*END PART\n*ASSEMBLY\n*INSTANCE, NAME=B, PART=A\n*END INSTANCE\n";
    let line = "*INSTANCE, NAME=C, PART=A";
    refused(
        &format!("{large}{line}\n"),
        line,
        "*INSTANCE",
        "number the parts from 1",
    );
}

/// A set of the assembly has what those that it names had there, as other sets do, also where these go on behind it.
#[test]
fn sets_that_name_one_another_have_what_was_there_before() {
    let deck = |what: &str, [one, two, three]: [u32; 3]| {
        let card = |name: &str, members: &str| format!("*{what}, {what}={name}\n{members}\n");
        cube("*ASSEMBLY\n")
            + &card("X", &one.to_string())
            + &card("Y", "X")
            + &card("X", "X, Y")
            + "*END ASSEMBLY\n"
            + &card("X", &format!("Y, {two}"))
            + &card("Y", "X")
            + &card("X", &three.to_string())
    };
    // nothing waits for itself
    let circle = "*ASSEMBLY\n*NSET, NSET=X\n1\n*NSET, NSET=Y\nX\n*END ASSEMBLY\n*NSET, NSET=X\nY\n";
    assert_eq!(read(&cube(circle)).expect("deck").node_set("Y").expect("a set"), [0]);
    let nodes = read(&deck("NSET", [1, 2, 3])).expect("deck");
    let found = ["X", "Y"].map(|name| nodes.node_set(name).expect("a set"));
    assert_eq!(found, [&[0, 1, 2][..], &[0, 1]]);
    let elements = read(&deck("ELSET", [1, 2, 3])).expect("deck");
    let found = ["X", "Y"].map(|name| elements.element_set(name).expect("a set"));
    assert_eq!(found, [&[0, 1, 2][..], &[0, 1]]);
}
