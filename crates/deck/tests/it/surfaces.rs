//! Surfaces that are given by nodes, or by elements without their faces.

use crate::refusals::{behind, in_step};
use crate::write::{cube, read};

/// They are the faces of the boundary: those whose corners are in the set, and all of the elements.
#[test]
fn surfaces_of_nodes_and_of_elements() {
    let deck = cube("*SURFACE, NAME=BY_NODES, TYPE=NODE\nN5, 1.\nN6,\n*SURFACE, NAME=SKIN, TYPE=ELEMENT\nALL\n");
    let deck = read(&deck).expect("deck");
    let facets = |name: &str| {
        let tags = deck.surface(name).expect("a surface");
        let with = deck.mesh().facets().iter().filter(|f| tags.contains(&f.tag));
        with.count()
    };
    assert_eq!(facets("BY_NODES"), facets("S5") + facets("S6"));
    assert_eq!(facets("SKIN"), (1..=6).map(|n| facets(&format!("S{n}"))).sum::<usize>());
    let [area, ignored] = deck.ignored() else {
        panic!("{:?}", deck.ignored());
    };
    assert_eq!(area.word, "1.");
    behind(
        "*SURFACE, NAME=A, TYPE=NODE\nN5, S1\n",
        "N5, S1",
        "S1",
        "none or an area",
    );
    assert_eq!((ignored.word.as_str(), ignored.location.line > 1), ("TYPE=NODE", true));
    assert!(ignored.why.contains("the 16 faces"), "{ignored}");
}

/// Elements line by line are what their set is: those inside add nothing.
#[test]
fn surfaces_of_elements_line_by_line() {
    let deck = cube("*ELSET, ELSET=SOME\n1, 5, 40\n*SURFACE, NAME=A\nSOME\n*SURFACE, NAME=B\n1\n5\n40\n");
    let deck = read(&deck).expect("deck");
    assert_eq!(
        deck.surface("A").expect("a surface"),
        deck.surface("B").expect("a surface")
    );
}

/// Triangles and lines as Gmsh writes them: triangles name faces of the boundary.
#[test]
fn surfaces_of_triangles() {
    let marks = "*ELEMENT, TYPE=CPS3, ELSET=LID\n501, 19, 20, 23\n502, 19, 23, 22\n*ELEMENT, TYPE=T3D2, ELSET=EDGE\n503, 1, 2\n";
    let deck = read(&cube(&format!("{marks}*SURFACE, NAME=A\nLID\n"))).expect("deck");
    let [tag] = deck.surface("A").expect("a surface") else {
        panic!("{:?}", deck.surface("A"));
    };
    assert_eq!(deck.mesh().facets().iter().filter(|f| f.tag == *tag).count(), 2);
    assert_eq!((deck.mesh().tets().len(), deck.ignored().len()), (40, 2));
    assert!(deck.element_set("LID").expect("a set").is_empty());
    let refused = |more: &str, line: &str, word: &str, part: &str| behind(&format!("{marks}{more}"), line, word, part);
    refused("*SURFACE, NAME=A\nEDGE\n", "EDGE", "EDGE", "triangles");
    refused("*SURFACE, NAME=A\nLID, S1\n", "LID, S1", "LID", "without a number");
    let inside = "*ELEMENT, TYPE=CPS6\n504, 1, 2, 14, 1, 1, 1\n*SURFACE, NAME=A\n504\n";
    refused(inside, "504", "504", "flat element 504");
    let section = "*SOLID SECTION, ELSET=LID, MATERIAL=STEEL";
    refused(&format!("{section}\n"), section, "ELSET=LID", "solid elements only");
    let loaded = in_step("*DLOAD\nLID, P1, 1.\n");
    refused(&loaded, "LID, P1, 1.", "LID", "not elastic");
}

/// Cuts through a body, of which forces are printed elsewhere, are left out where no card uses them.
#[test]
fn surfaces_that_nothing_uses_may_be_inside() {
    let inside = "*SURFACE, NAME=CUT\n1, S2\n*SURFACE, NAME=SKIN\nALL\n";
    let numbers = (1..=4).map(|number| inside.replace("S2", &format!("S{number}")));
    let cut = numbers.filter(|text| read(&cube(text)).expect("deck").surface("CUT").expect("one").is_empty());
    let cut: Vec<String> = cut.collect();
    assert!(!cut.is_empty());
    for text in cut {
        let deck = read(&cube(&text)).expect("deck");
        assert!(!deck.surface("SKIN").expect("a surface").is_empty());
        let [ignored] = deck.ignored() else {
            panic!("{:?}", deck.ignored());
        };
        assert!(ignored.why.contains("no card that is read uses it"), "{ignored}");
        let used = format!("{text}{}", in_step("*DSLOAD\nCUT, P, 1.\n"));
        let error = read(&cube(&used)).expect_err("inside").to_string();
        assert!(error.contains("inside the body"), "{error}");
    }
}
