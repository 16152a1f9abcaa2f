//! What is refused, each once: file, line and word are named, and a remedy.

mod model;
mod steps;

use signorini_deck::Deck;

use crate::write::{cube, folder, read};

/// A support and a step around what is tried.
pub(crate) fn in_step(lines: &str) -> String {
    format!("*BOUNDARY\nN5, 1, 3\n*STEP\n*STATIC\n{lines}*END STEP\n")
}

/// The deck is refused at the last line that equals `line`, for `word`, and the sentence says `part`.
#[track_caller]
pub(crate) fn refused(deck: &str, line: &str, word: &str, part: &str) {
    let error = read(deck).expect_err(line);
    let text = error.to_string();
    assert_eq!(error.word(), Some(word), "{text}");
    assert!(text.contains(part), "{text}");
    let location = error.location().expect("a place");
    let at = deck.lines().collect::<Vec<_>>();
    let wanted = at.iter().rposition(|l| *l == line).expect("the line") + 1;
    assert_eq!(location.line, wanted, "{text}");
    assert!(location.file.ends_with("part.inp"), "{text}");
    assert!(text.contains("part.inp:"), "{text}");
    assert_eq!(format!("{error:?}"), text);
}

/// Refused behind a cube with material.
#[track_caller]
pub(crate) fn behind(rest: &str, line: &str, word: &str, part: &str) {
    refused(&cube(rest), line, word, part);
}

/// Refused inside a step.
#[track_caller]
pub(crate) fn inside(lines: &str, line: &str, word: &str, part: &str) {
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
    behind("*Tie, name=T\n", "*Tie, name=T", "*Tie", "no surfaces");
    let tie = "*TIE, NAME=T, POSITION TOLERANCE=-1.";
    behind(
        &format!("{tie}\nS1, S2\n"),
        tie,
        "POSITION TOLERANCE=-1.",
        "not negative",
    );
    behind(
        "*RIGID BODY\n",
        "*RIGID BODY",
        "*RIGID BODY",
        "ELSET or NSET is missing",
    );
    behind(
        "*RIGID BODY, ANALYTICAL SURFACE=A\n",
        "*RIGID BODY, ANALYTICAL SURFACE=A",
        "ANALYTICAL SURFACE=A",
        "ELSET, NSET, TIE NSET, REF NODE, ROT NODE",
    );
    behind("*RESTART, READ\n", "*RESTART, READ", "*RESTART", "resumed");
    inside("*DYNAMIC\n", "*DYNAMIC", "*DYNAMIC", "only *STATIC");
    for line in ["*PART, NAME=P", "*INSTANCE, NAME=I, PART=P"] {
        let (word, _) = line.split_once(',').expect("a parameter");
        inside(&format!("{line}\n"), line, word, "before the first *STEP");
    }
    inside("*NODE\n1\n", "*NODE", "*NODE", "before the first *STEP");
    behind("*CLOAD\n1, 1, 1.\n", "*CLOAD", "*CLOAD", "between *STEP and *END STEP");
    behind("*STEP\n*STATIC\n", "*STEP", "*STEP", "*END STEP");
    behind("*STEP\n*END STEP\n", "*STEP", "*STEP", "*STATIC");
    inside("*STEP, INC=5\n", "*STEP, INC=5", "*STEP", "not ended");
    inside("*STATIC, DIRECT\n", "*STATIC, DIRECT", "*STATIC", "one procedure");
    behind(
        "*NSET, NSET=A,\n",
        "*NSET, NSET=A,",
        "*NSET, NSET=A,",
        "no line continues it",
    );
    refused("1, 2, 3\n*NODE\n", "1, 2, 3", "1, 2, 3", "begin with a keyword");
}

#[test]
fn parameters() {
    behind(
        "*NSET, NSET=A, SORTED\n1\n",
        "*NSET, NSET=A, SORTED",
        "SORTED",
        "GENERATE",
    );
    behind("*NSET, GENERATE\n1, 2\n", "*NSET, GENERATE", "*NSET", "NSET is missing");
    behind("*NSET, NSET=\n1\n", "*NSET, NSET=", "NSET=", "a value");
    behind("*NSET, NSET=A, NSET=B\n1\n", "*NSET, NSET=A, NSET=B", "NSET=B", "twice");
    behind(
        "*NSET, NSET=A, GENERATE=YES\n1, 2\n",
        "*NSET, NSET=A, GENERATE=YES",
        "GENERATE=YES",
        "without a value",
    );
    behind("*STEP, NLGEOM\n", "*STEP, NLGEOM", "NLGEOM", "small");
    behind("*STEP, PERTURBATION\n", "*STEP, PERTURBATION", "PERTURBATION", "linear");
    behind("*STEP, INC=many\n", "*STEP, INC=many", "INC=many", "a number");
    behind(
        "*ELASTIC, TYPE=LAMINA\n1.\n",
        "*ELASTIC, TYPE=LAMINA",
        "TYPE=LAMINA",
        "ENGINEERING CONSTANTS",
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
    inside("*BOUNDARY, LOST\n", "*BOUNDARY, LOST", "LOST", "OP, AMPLITUDE, TYPE");
    behind(
        "*AMPLITUDE, NAME=A, VALUE=ABSOLUTE\n",
        "*AMPLITUDE, NAME=A, VALUE=ABSOLUTE",
        "VALUE=ABSOLUTE",
        "RELATIVE",
    );
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
    let location = error.location().expect("place");
    assert!(location.file.ends_with("other.inp") && location.line == 2, "{error}");
    assert!(error.to_string().contains("includes itself"), "{error}");
    let error = Deck::read("no/such/deck.inp").expect_err("no file");
    assert!(error.to_string().contains("cannot read no/such/deck.inp"), "{error}");
}

/// What a program asks for.
#[test]
fn names_and_scenes() {
    let deck = read(&cube("")).expect("deck");
    let error = deck.surface("top").expect_err("no surface").to_string();
    assert!(error.contains("no surface named \"top\"; there are: S1, S2"), "{error}");
    assert!(deck.node_set("top").is_err() && deck.element_set("top").is_err());
    let mesh = "*NODE\n1\n2, 1.\n3, 0., 1.\n4, 0., 0., 1.\n*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n";
    let deck = read(mesh).expect("a mesh");
    let error = deck.scene().expect_err("no scene").to_string();
    assert!(error.contains("no *SOLID SECTION"), "{error}");
}
