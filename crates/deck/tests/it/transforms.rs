//! Supports and forces along axes of nodes.

use signorini_contact::{Directions, Scene};
use signorini_fem_mesh::LoadDensity;

use crate::refusals::behind;
use crate::write::{cube, read};

/// A cube with the floor held, of whose top the axes, supports and forces are given.
fn scene(transform: &str, boundary: &str, force: &str) -> Scene {
    let step = format!("*STEP\n*STATIC\n*BOUNDARY\n{boundary}*CLOAD\n{force}*END STEP\n");
    let deck = read(&cube(&format!("{transform}*BOUNDARY\nN5, 1, 3\nN6, 2\n{step}"))).expect("deck");
    deck.scene().expect("scene")
}

fn force_at_27(scene: &Scene) -> [f64; 3] {
    let Some(LoadDensity::NodalForces(forces)) = scene.loads()[0].density() else {
        panic!("{:?}", scene.loads());
    };
    forces.iter().find(|f| f.0 == 26).expect("node 27").1
}

fn near(a: [f64; 3], b: [f64; 3]) {
    assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-14), "{a:?} {b:?}");
}

#[test]
fn cylindrical() {
    let axis = "*TRANSFORM, NSET=N6, TYPE=C\n-1., -1., 0., -1., -1., 5.\n";
    let held = "N6, 2, 2, 0.1\n";
    let scene = scene(axis, held, "27, 1, 6.\n27, 2, 8.\n27, 3, 2.\n");
    let top = &scene.supports()[1];
    assert_eq!(top.directions(), &Directions::Components([false, true, false]));
    assert_eq!(top.axis(), Some(([-1.0, -1.0, 0.0], [0.0, 0.0, 5.0])));
    assert_eq!(top.motion().expect("moves").0, [[0.0, 0.1, 0.0]]);
    assert_eq!(scene.supports()[0].axis(), None);
    // node 27 is the corner at (1, 1, 1)
    let s = 0.5_f64.sqrt();
    near(force_at_27(&scene), [-2.0 * s, 14.0 * s, 2.0]);
}

#[test]
fn rectangular() {
    // the first axis is y, the second -x
    let turned = "*TRANSFORM, NSET=N6\n0., 3., 0., -1., 7., 0.\n";
    let scene = scene(turned, "N6, 2, 2, 0.1\n", "27, 1, 6.\n27, 2, 8.\n");
    let top = &scene.supports()[1];
    assert_eq!(top.directions(), &Directions::Vectors(vec![[-1.0, 0.0, 0.0]]));
    assert_eq!(
        (top.axis(), top.motion().expect("moves").0),
        (None, &[[-0.1, 0.0, 0.0]][..])
    );
    near(force_at_27(&scene), [-8.0, 6.0, 0.0]);
}

#[test]
fn axes_that_cannot_be_had() {
    let c = "*TRANSFORM, NSET=N6, TYPE=C\n";
    for (head, line) in [
        (c, "0., 1., 0., 0., 1., 0."),
        ("*TRANSFORM, NSET=N6\n", "0., 1., 0., 0., 2., 0."),
        ("*TRANSFORM, NSET=N6\n", "0.1, 0.2, 0.3, 0.7, 1.4, 2.1"),
    ] {
        behind(&format!("{head}{line}\n"), line, line, "give no axes");
    }
    let good = "0., 0., 0., 0., 0., 1.\n";
    behind(
        "*TRANSFORM, TYPE=C\n",
        "*TRANSFORM, TYPE=C",
        "*TRANSFORM",
        "both on the axis",
    );
    let s = "*TRANSFORM, NSET=N6, TYPE=S";
    behind(&format!("{s}\n{good}"), s, "TYPE=S", "TYPE=C");
    let missing = "*TRANSFORM, TYPE=C";
    behind(&format!("{missing}\n{good}"), missing, "*TRANSFORM", "NSET is missing");
    let unknown = "*TRANSFORM, NSET=NIX, TYPE=C";
    behind(
        &format!("{unknown}\n{good}*STEP\n*STATIC\n*END STEP\n"),
        unknown,
        "NSET=NIX",
        "N6",
    );
    let again = "*TRANSFORM, NSET=N2, TYPE=C";
    behind(
        &format!("{c}{good}{again}\n{good}*STEP\n*STATIC\n*END STEP\n"),
        again,
        "NSET=N2",
        "one *TRANSFORM",
    );
    // node 19 is on the axis
    let force = "19, 1, 1.";
    let step = format!("*STEP\n*STATIC\n*CLOAD\n{force}\n*END STEP\n");
    behind(
        &format!("{c}{good}*BOUNDARY\nN5, 1, 3\n{step}"),
        force,
        "19",
        "lies on its axis",
    );
}
