//! Parts, instances and the assembly.

use signorini_contact::{Settings, Simulation};
use signorini_fem_mesh::{Brick, FacetTag};

use crate::refusals::refused;
use crate::write::{STEEL, mesh, read};

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
        let part = if line.starts_with("*I") {
            "put *ASSEMBLY before it"
        } else {
            "remove it"
        };
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
