//! Errors and warnings of a scene speak of the deck: its lines, sets, surfaces and numbers.

use std::collections::HashSet;
use std::mem::discriminant;

use signorini_contact::{Scene, Settings, Silent, Simulation};
use signorini_fem_mesh::{Brick, FacetTag, TetMesh};

use crate::write::{self, read};

fn two(gap: f64) -> TetMesh {
    let brick = || Brick::new([1.0; 3], [2; 3]).build().expect("brick");
    let above = brick().map_points(|[x, y, z]| [x, y, z + 1.0 + gap]).expect("lifted");
    brick().append(&above.map_tags(|t| FacetTag(t.0 + 10))).expect("two")
}

/// A scene of two cubes, and how many nodes they have.
fn scene(gap: f64, rest: &str) -> (Scene, usize) {
    let mesh = two(gap);
    let nodes = mesh.points().len();
    let rest = format!(
        "*SURFACE INTERACTION, NAME=I\n*FRICTION\n0.2\n*CONTACT PAIR, INTERACTION=I\nS15, S6\n*BOUNDARY\nN5, 1, 3\n{rest}"
    );
    let deck = write::mesh(&mesh) + write::STEEL + &rest;
    let deck = read(&deck).expect("a deck");
    (deck.scene().expect("a scene"), nodes)
}

/// What the simulation of a deck says against it, up to its last step.
fn against(gap: f64, rest: &str) -> (String, usize) {
    let (scene, nodes) = scene(gap, rest);
    let said = match Simulation::new(scene, Settings::default()) {
        Err(error) => error.to_string(),
        Ok(mut simulation) => loop {
            match simulation.step() {
                Err(error) => break error.to_string(),
                Ok(_) => assert!(!simulation.is_finished(), "nothing is wrong"),
            }
        },
    };
    (said, nodes)
}

const STEP: &str = "*STEP\n*STATIC\n";

#[test]
fn contacts_loads_supports_nodes_and_steps_have_names() {
    let (said, _) = against(-0.9, &format!("{STEP}*END STEP\n"));
    assert!(
        said.starts_with("contact 0 is *CONTACT PAIR S15, S6 (") && said.contains("part.inp:"),
        "{said}"
    );
    let (said, nodes) = against(
        0.0,
        &format!("{STEP}0.5, 1.\n*END STEP\n{STEP}0.25, 1.\n*CLOAD\nN16, 3, 1.\n*END STEP\n"),
    );
    let first = nodes / 2;
    let label = format!("node {first} is {} in ELSET=ALL (", first + 1);
    assert!(said.starts_with(&label), "{said}");
    assert!(said.contains("step 2 is increment 1 of *STEP ("), "{said}");
    let (said, _) = against(0.0, &format!("{STEP}*CLOAD\nN16, 3, -1e200\n*END STEP\n"));
    assert!(said.starts_with("load 0 is N16 ("), "{said}");
    let (said, _) = against(0.0, &format!("{STEP}*BOUNDARY\nN16, 3, 3, 1e200\n*END STEP\n"));
    assert!(said.starts_with("support 1 is N16 ("), "{said}");
}

#[test]
fn warnings_have_names() {
    let step = "*STEP\n*STATIC\n0.5, 1.\n*CLOAD\nN16, 3, -1e10\n*END STEP\n";
    let (scene, _) = scene(2.5, &format!("{step}{step}"));
    let mut simulation = Simulation::new(scene, Settings::default()).expect("held");
    let warnings = simulation.plan().warnings();
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    let said = warnings[0].to_string();
    assert!(said.starts_with("contact 0 is *CONTACT PAIR S15, S6 ("), "{said}");
    assert_eq!(warnings[0].plain().parts(), warnings[0].parts());
    let report = simulation.run(&mut Silent).expect("a run");
    let said: Vec<String> = report.warnings().iter().map(ToString::to_string).collect();
    let kinds: HashSet<_> = report.warnings().iter().map(|w| discriminant(w.plain())).collect();
    assert!(said.len() > 3 && kinds.len() == said.len(), "each kind once: {said:#?}");
    for said in &said[1..] {
        assert!(said.starts_with("step ") && said.contains(" of *STEP ("), "{said}");
        assert!(said.contains(" in ELSET=ALL ("), "{said}");
    }
}

/// What is no mesh is told by its numbers in the deck, with the line.
#[test]
fn elements_and_nodes_have_their_numbers() {
    let deck = write::cube("");
    let copied = deck.replace(
        "*NSET, NSET=N1\n",
        "*ELEMENT, TYPE=C3D4, ELSET=ALL\n900, HERE\n*NSET, NSET=N1\n",
    );
    let first = deck
        .lines()
        .find(|l| l.starts_with("5, ") && l.matches(',').count() == 4);
    let nodes = first
        .and_then(|l| l.split_once(", "))
        .expect("element 5, whose faces are all inside")
        .1;
    let error = read(&copied.replace("HERE", nodes)).expect_err("twice");
    assert_eq!(error.word(), Some("1"), "{error}");
    assert!(error.location().is_some(), "{error}");
    assert!(
        error.to_string().contains("tetrahedron 0 is 1 in ELSET=ALL ("),
        "{error}"
    );
}
