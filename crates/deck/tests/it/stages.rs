//! Supports that a step releases or adds, and contact pairs that come and go.

use signorini_contact::{ContactError, Scene, Settings, Simulation};
use signorini_fem_mesh::{Brick, FacetTag, TetMesh, brick};

use crate::refusals::{inside, refused};
use crate::write::{STEEL, cube, mesh, read};

fn bar(order: usize) -> TetMesh {
    let linear = Brick::new([2.0, 1.0, 1.0], [2, 1, 1]).build().expect("a brick");
    if order == 2 { linear.raise_order().expect("mid-nodes") } else { linear }
}

/// A bar with steps of some increments each.
fn in_steps(order: usize, (increments, step): (&str, &str), steps: &[&str]) -> String {
    let step = |lines: &&str| format!("*STEP{step}\n*STATIC\n{increments}\n{lines}*END STEP\n");
    let steps: Vec<String> = steps.iter().map(step).collect();
    format!("{}{STEEL}{}", mesh(&bar(order)), steps.concat())
}

const STRETCHED: &str = "*BOUNDARY\nN1, 1, 3\nN2, 1, 1, 0.002\nN2, 3, 3, 0.001\n";
const RELEASED: &str = "*BOUNDARY, OP=NEW\nN1, 1, 3\n*DSLOAD\nS6, P, 300.\n";

fn scene(deck: &str) -> Scene {
    read(deck).expect("deck").scene().expect("scene")
}

fn displacements(scene: Scene) -> Vec<Vec<[f64; 3]>> {
    displacements_to(1e-9, scene)
}

fn displacements_to(tolerance: f64, scene: Scene) -> Vec<Vec<[f64; 3]>> {
    let mut simulation = Simulation::new(scene, Settings::default().with_tolerance(tolerance)).expect("set-up");
    let mut out = Vec::new();
    while !simulation.is_finished() {
        let result = simulation.step().expect("step");
        let report = result.report();
        assert!(report.status.converged(), "{report:?} {:?}", result.certificate());
        out.push(result.displacement());
    }
    out
}

fn assert_close(found: &[[f64; 3]], wanted: impl IntoIterator<Item = [f64; 3]>, what: &str) {
    let size = found.iter().flatten().fold(0.0, |m: f64, v| m.max(v.abs()));
    for (found, wanted) in found.iter().zip(wanted) {
        let off = (0..3).map(|c| (found[c] - wanted[c]).abs()).fold(0.0, f64::max);
        assert!(off <= 1e-7 * size, "{what}: {found:?} {wanted:?}");
    }
}

/// What CalculiX prints at the nodes 3, 9 and 26, with seven digits.
fn assert_printed(found: &[[f64; 3]], printed: [[f64; 3]; 3], what: &str) {
    for (label, wanted) in [3, 9, 26].into_iter().zip(printed) {
        for c in 0..3 {
            let off = (found[label - 1][c] - wanted[c]).abs();
            assert!(
                off <= 0.6e-6 * wanted[c].abs(),
                "{what}, node {label}: {:?}",
                found[label - 1]
            );
        }
    }
}

/// A bar is stretched and bent by one end, released and pressed, held elsewhere, and released there again: what
/// CalculiX 2.20 prints of the same deck, with seven digits.
#[test]
fn steps_release_and_add_supports_as_in_calculix() {
    let deck = in_steps(
        2,
        ("1., 1.", ""),
        &[
            STRETCHED,
            RELEASED,
            "*BOUNDARY\nN4, 2, 2\nN2, 1, 1, 0.001\n",
            "*BOUNDARY, OP=NEW\nN1, 1, 3\nN4, 2, 2\n",
        ],
    );
    // at nodes 3, 9 and 26
    let printed = [
        [
            [2.000000e-3, 1.752345e-4, 1.000000e-3],
            [2.000000e-3, 2.631285e-4, 1.000000e-3],
            [2.000000e-3, 9.108893e-6, 1.000000e-3],
        ],
        [
            [-1.044670e-2, -2.524072e-4, -3.784299e-2],
            [1.122048e-2, -2.684596e-4, -3.832892e-2],
            [3.844785e-4, -6.771820e-5, -3.800899e-2],
        ],
        [
            [1.000000e-3, 1.232571e-3, -1.694108e-2],
            [1.000000e-3, -1.495039e-3, -1.756717e-2],
            [1.000000e-3, 2.433606e-6, -1.667769e-2],
        ],
        [
            [-1.029769e-2, -4.201395e-4, -3.722740e-2],
            [1.111864e-2, 2.185575e-5, -3.774002e-2],
            [4.003668e-4, -1.459059e-5, -3.768051e-2],
        ],
    ];
    let scene = scene(&deck);
    let spans: Vec<_> = scene.supports().iter().map(|s| [s.start(), s.end()]).collect();
    assert_eq!(
        spans.iter().filter(|span| **span == [None, None]).count(),
        1,
        "{spans:?}"
    );
    for span in [[None, Some(1.0)], [Some(2.0), None], [Some(2.0), Some(3.0)]] {
        assert!(spans.contains(&span), "{spans:?}");
    }
    for (k, (u, printed)) in displacements_to(1e-10, scene).iter().zip(printed).enumerate() {
        assert_printed(u, printed, &format!("step {k}"));
    }
}

/// What is released is gone in the first increment; what is added goes from where it is along a straight line, or
/// jumps.
#[test]
fn increments_release_at_once_and_hold_along_a_line() {
    let back = "*BOUNDARY\nN2, 1, 1, 0.001\n";
    let steps = [STRETCHED, RELEASED, back];
    let found = displacements(scene(&in_steps(1, ("0.5, 1.", ""), &steps)));
    let alone = "*BOUNDARY\nN1, 1, 3\n*DSLOAD\nS6, P, 300.\n";
    let pressed = displacements(scene(&in_steps(1, ("0.5, 1.", ""), &[alone])));
    for k in 0..2 {
        assert_close(&found[2 + k], pressed[k].iter().copied(), "released");
    }
    let ends = |u: &[[f64; 3]]| -> Vec<[f64; 3]> {
        let nodes = bar(1).nodes_on(brick::X_MAX);
        nodes.into_iter().map(|n| [u[n as usize][0], 0.0, 0.0]).collect()
    };
    let half = ends(&found[3]).into_iter().map(|u| [0.5 * (u[0] + 0.001), 0.0, 0.0]);
    assert_close(&ends(&found[4]), half, "half way");
    assert_close(&ends(&found[5]), vec![[0.001, 0.0, 0.0]; 4], "there");
    let found = displacements(scene(&in_steps(1, ("0.5, 1.", ", AMPLITUDE=STEP"), &steps)));
    for k in [4, 5] {
        assert_close(&ends(&found[k]), vec![[0.001, 0.0, 0.0]; 4], "at once");
    }
}

/// A body that a step leaves without supports is refused with the increment.
#[test]
fn what_nothing_holds_is_refused_beforehand() {
    let free = "*BOUNDARY, OP=NEW\nN1, 2, 3\n*DSLOAD\nS2, P, 300.\n";
    let scene = scene(&in_steps(1, ("0.5, 1.", ""), &[STRETCHED, free]));
    let error = Simulation::new(scene, Settings::default()).map(drop).expect_err("free");
    let text = error.to_string();
    assert!(
        text.contains("increment 1 of *STEP") && text.contains("part.inp:"),
        "{text}"
    );
    let ContactError::Named { source, .. } = error else {
        panic!("{text}");
    };
    assert!(matches!(*source, ContactError::NotHeld { step: 2, .. }), "{text}");
}

/// A pair of blocks one of which is pressed on the other.
fn pair(changes: [&str; 4]) -> String {
    let lower = Brick::new([1.0; 3], [2; 3]).build().expect("a brick");
    let upper = lower.map_points(|[x, y, z]| [x, y, z + 1.0]).expect("lifted");
    let mesh_of_both = lower.append(&upper.map_tags(|tag| FacetTag(tag.0 + 10))).expect("both");
    let steps = changes.map(|change| format!("*STEP\n*STATIC\n{change}*DSLOAD\nS16, P, 300.\n*END STEP\n"));
    format!(
        "{}{STEEL}*SURFACE INTERACTION, NAME=I\n*CONTACT PAIR, INTERACTION=I\nS15, S6\n*BOUNDARY\nN5, 1, 3\nN11, 1, 3\n{}",
        mesh(&mesh_of_both),
        steps.concat()
    )
}

const REMOVE: &str = "*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE\nS15, S6\n";
const ADD: &str = "*MODEL CHANGE, TYPE=CONTACT PAIR, ADD\nS15, S6\n";

#[test]
fn pairs_come_and_go() {
    let spans = |scene: &Scene| {
        let contacts = scene.contacts().iter();
        contacts.map(|c| [c.start(), c.end()]).collect::<Vec<_>>()
    };
    let always = scene(&pair([""; 4]));
    let gone = scene(&pair([REMOVE, "", "", ""]));
    assert_eq!(spans(&always), [[None, None]]);
    assert_eq!(spans(&gone), [[Some(4.0), None]]);
    let [with, without] = [&always, &gone].map(|scene| displacements(scene.clone()));
    for (changes, there, wanted) in [
        (
            ["", REMOVE, ADD, ""],
            [true, false, true, true],
            vec![[None, Some(1.0)], [Some(2.0), None]],
        ),
        (
            [REMOVE, ADD, "", REMOVE],
            [false, true, true, false],
            vec![[Some(1.0), Some(3.0)]],
        ),
        (
            [REMOVE, "", ADD, ""],
            [false, false, true, true],
            vec![[Some(2.0), None]],
        ),
    ] {
        let scene = scene(&pair(changes));
        assert_eq!(spans(&scene), wanted);
        let found = displacements(scene);
        for k in 0..4 {
            let beside = if there[k] { &with } else { &without };
            assert_close(&found[k], beside[k].iter().copied(), &format!("{changes:?}, step {k}"));
        }
    }
    let deck = read(&pair(["", ADD, REMOVE, REMOVE])).expect("deck");
    let ignored: Vec<String> = deck.ignored().iter().map(ToString::to_string).collect();
    assert!(ignored.iter().any(|i| i.contains("there already")), "{ignored:?}");
    assert!(ignored.iter().any(|i| i.contains("gone already")), "{ignored:?}");
}

#[test]
fn other_changes_are_refused() {
    let deck = pair(["", "*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE\nS6, S15\n", "", ""]);
    refused(&deck, "S6, S15", "S6", "in this order");
    for (line, word, part) in [
        (
            "*MODEL CHANGE, TYPE=ELEMENT, REMOVE",
            "*MODEL CHANGE",
            "bodies are there at all steps",
        ),
        (
            "*MODEL CHANGE, MECHSTRAINTORESIDUAL",
            "*MODEL CHANGE",
            "bodies are there at all steps",
        ),
        ("*MODEL CHANGE, TYPE=CONTACT PAIR", "*MODEL CHANGE", "ADD or REMOVE"),
        (
            "*MODEL CHANGE, TYPE=CONTACT PAIR, ADD, REMOVE",
            "*MODEL CHANGE",
            "ADD or REMOVE",
        ),
        (
            "*MODEL CHANGE, TYPE=CONTACT PAIR, ADD=STRAIN FREE",
            "ADD=STRAIN FREE",
            "without a value",
        ),
    ] {
        inside(&format!("{line}\nS15, S6\n"), line, word, part);
    }
    let add = "*MODEL CHANGE, TYPE=CONTACT PAIR, ADD";
    inside(&format!("{add}\n"), add, "*MODEL CHANGE", "name two in a line");
    refused(
        &cube(&format!("{add}\nS1, S2\n")),
        add,
        "*MODEL CHANGE",
        "between *STEP and *END STEP",
    );
    // what is rigid is held to the end
    let node = "*NODE\n900, 3., 0.25, 2.\n*COUPLING, CONSTRAINT NAME=C, REF NODE=900, SURFACE=S6\n*KINEMATIC\n1, 3\n";
    let steps = |first: &str, second: &str| {
        let step = |lines: &str| format!("*STEP\n*STATIC\n{lines}*END STEP\n");
        cube(&[node, &step(&format!("*BOUNDARY\nN5, 1, 3\n{first}")), &step(second)].concat())
    };
    let new = "*BOUNDARY, OP=NEW";
    refused(
        &steps("900, 1, 2\n", &format!("{new}\nN5, 1, 3\n900, 1\n")),
        new,
        "OP=NEW",
        "releases component 2 of node 900; what is held of a rigid body",
    );
    refused(
        &steps("900, 1, 2\n", "*BOUNDARY\n900, 3\n"),
        "900, 3",
        "900",
        "component 3 of node 900 is free in the steps before",
    );
}

const PULLED: &str = "*BOUNDARY\nN1, 1, 3\n*DSLOAD\nS6, P, 300.\n";

/// Nodes of the body stay where a step found them, loads or not, until a step releases them: what CalculiX 2.20 prints
/// of the same deck.
#[test]
fn fixed_nodes_stay_as_in_calculix() {
    let steps = [
        PULLED,
        "*BOUNDARY, FIXED\nN2, 1, 3\n*DSLOAD, OP=NEW\nS4, P, 200.\n",
        "*DSLOAD, OP=NEW\nS6, P, 100.\n",
        "*BOUNDARY, OP=NEW\nN1, 1, 3\n",
    ];
    let deck = in_steps(2, ("1., 1.", ""), &steps);
    let printed = [
        [
            [-1.044670e-2, -2.524072e-4, -3.784299e-2],
            [1.122048e-2, -2.684596e-4, -3.832892e-2],
            [3.844785e-4, -6.771820e-5, -3.800899e-2],
        ],
        [
            [-3.482233e-3, -8.413573e-5, -1.261433e-2],
            [3.740160e-3, -8.948652e-5, -1.277631e-2],
            [1.281595e-4, -2.257273e-5, -1.266966e-2],
        ],
    ];
    for (step, u) in displacements_to(1e-10, scene(&deck)).iter().enumerate() {
        assert_printed(u, printed[step / 3], &format!("step {step}"));
    }
    // what is given again, or given a value
    for (lines, why) in [
        (
            "*BOUNDARY, FIXED\nN2, 1, 3\n*BOUNDARY\nN2, 1, 1, 0.1\n",
            "is FIXED, and stays so",
        ),
        ("*BOUNDARY, FIXED\nN2, 1, 1, 0.1\n", "remove the value"),
    ] {
        let deck = in_steps(2, ("1., 1.", ""), &[PULLED, lines]);
        let error = read(&deck)
            .and_then(|deck| deck.scene())
            .expect_err("refused")
            .to_string();
        assert!(error.contains(why), "{error}");
    }
}

/// What was held before goes on being held; a displacement before the first step is reached in it.
#[test]
fn what_is_held_stays_and_what_is_given_early_is_reached() {
    let at_end = |deck: &str| displacements(scene(deck)).pop().expect("a step");
    let moved = "*BOUNDARY\nN1, 1, 3\nN2, 1, 1, 0.002\n";
    let plain = || at_end(&in_steps(2, ("1., 1.", ""), &[moved, "*DSLOAD\nS6, P, 300.\n"]));
    let again = "*BOUNDARY, OP=NEW, FIXED\nN1, 1, 3\nN2, 1, 1\n*DSLOAD\nS6, P, 300.\n";
    assert_close(&at_end(&in_steps(2, ("1., 1.", ""), &[moved, again])), plain(), "fixed");
    // FIXED counts, whatever the step says before it, or what is given before the first
    let both = "*BOUNDARY\nN2, 1, 1, 0.1\n*BOUNDARY, FIXED\nN2, 1, 1\n*DSLOAD\nS6, P, 300.\n";
    assert_close(&at_end(&in_steps(2, ("1., 1.", ""), &[moved, both])), plain(), "both");
    let held = "*BOUNDARY, FIXED\nN2, 1, 1\n*DSLOAD\nS6, P, 300.\n";
    let [early, plainly] = [moved, "*BOUNDARY\nN1, 1, 3\nN2, 1\n"]
        .map(|given| in_steps(2, ("1., 1.", ""), &[held]).replace("*STEP", &format!("{given}*STEP")));
    assert_close(&at_end(&early), at_end(&plainly), "before the first step");
    // and is released as what is held otherwise
    let released = |deck: &str| at_end(&(deck.to_owned() + "*STEP\n*STATIC\n1., 1.\n" + RELEASED + "*END STEP\n"));
    assert_close(&released(&early), released(&plainly), "released");
    let whole = in_steps(2, ("0.5, 1.", ""), &[moved]);
    let early = in_steps(2, ("0.5, 1.", ""), &[""]).replace("*STEP", &format!("{moved}*STEP"));
    let [wanted, found] = [&whole, &early].map(|deck| displacements(scene(deck)));
    assert_eq!(wanted.len(), 2);
    for (found, wanted) in found.iter().zip(wanted) {
        assert_close(found, wanted, "early");
    }
}
