//! Surfaces that are given by nodes, or by elements without their faces.

use crate::write::{cube, read};

/// They are the faces of the boundary: those whose corners are in the set, and all of the elements.
#[test]
fn surfaces_of_nodes_and_of_elements() {
    let deck = cube("*SURFACE, NAME=BY_NODES, TYPE=NODE\nN5\nN6,\n*SURFACE, NAME=SKIN, TYPE=ELEMENT\nALL\n");
    let deck = read(&deck).expect("deck");
    let facets = |name: &str| {
        let tags = deck.surface(name).expect("a surface");
        let with = deck.mesh().facets().iter().filter(|f| tags.contains(&f.tag));
        with.count()
    };
    assert_eq!(facets("BY_NODES"), facets("S5") + facets("S6"));
    assert_eq!(facets("SKIN"), (1..=6).map(|n| facets(&format!("S{n}"))).sum::<usize>());
    let [ignored] = deck.ignored() else {
        panic!("{:?}", deck.ignored());
    };
    assert_eq!((ignored.word.as_str(), ignored.location.line > 1), ("TYPE=NODE", true));
    assert!(ignored.why.contains("the 16 faces"), "{ignored}");
}
