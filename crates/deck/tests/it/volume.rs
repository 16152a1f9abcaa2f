//! Loads of the volume.

use signorini_contact::Scene;
use signorini_fem_mesh::mesh::BoundaryFacet;
use signorini_fem_mesh::{Brick, Decomposition, TetMesh, assemble_load};

use crate::write::{STEEL, mesh, read};

const SPIN: &str = "CENTRIF, 4.E6, 0.25, -0.5, 9., 0., 0., -2.";

fn bar(order: usize) -> TetMesh {
    let bar = Brick::new([3.0, 1.0, 0.5], [6, 2, 1]).build().expect("a bar");
    match order {
        2 => bar.raise_order().expect("quadratic"),
        _ => bar,
    }
}

/// A quadratic one with a curved top.
fn curved(cells: [usize; 3]) -> TetMesh {
    let bar = Brick::new([3.0, 1.0, 0.5], cells).build().expect("a bar");
    let bulge = |[x, y, z]: [f64; 3]| [x, y, z * (1.0 + 0.4 * (1.0 - (2.0 * y - 1.0).powi(2)))];
    bar.raise_order().expect("quadratic").map_points(bulge).expect("curved")
}

/// The nodal forces of all loads.
fn forces(bar: &TetMesh, scene: &Scene) -> Vec<f64> {
    let one = Decomposition::boxes(bar, [1, 1, 1]).expect("one subdomain");
    let mut sum = vec![0.0; 3 * bar.points().len()];
    for load in scene.loads() {
        let density = load.density().expect("a density");
        let vectors = assemble_load(scene.mesh(), &one, density).expect("load");
        sum.iter_mut().zip(&vectors[0]).for_each(|(s, v)| *s += v);
    }
    sum
}

fn assert_same(a: &[f64], b: &[f64]) {
    let scale = a.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    assert!(scale > 0.0 && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12 * scale));
}

fn scene(bar: &TetMesh, sets: &str, loads: &str) -> Scene {
    let step = format!("*BOUNDARY\nN1, 1, 3\n*STEP\n*STATIC\n*DLOAD\n{loads}*END STEP\n");
    let deck = format!("{}{STEEL}{sets}{step}", mesh(bar));
    read(&deck).expect("deck").scene().expect("scene")
}

/// On a part of the elements the forces at nodes are those of the field that the whole mesh has, element by element.
#[test]
fn loads_of_parts_add_up_to_those_of_the_whole() {
    for bar in [bar(1), bar(2), curved([6, 2, 1])] {
        let (half, all) = (bar.tets().len() / 2, bar.tets().len());
        let sets = format!(
            "*ELSET, ELSET=A, GENERATE\n1, {half}\n*ELSET, ELSET=B, GENERATE\n{}, {all}\n",
            half + 1,
        );
        for load in [SPIN, "GRAV, 9.81, 0.6, 0., -0.8", "BY, 3."] {
            let whole = forces(&bar, &scene(&bar, "", &format!("ALL, {load}\n")));
            let parts = forces(&bar, &scene(&bar, &sets, &format!("A, {load}\nB, {load}\n")));
            assert_same(&whole, &parts);
            if load == SPIN && bar == self::bar(bar.order()) {
                // density, square of the angular velocity, volume, and the distance of the centre from the axis
                let along: f64 = parts.iter().step_by(3).sum();
                let exact = 7.8e-9 * 4e6 * 1.5 * (1.5 - 0.25);
                assert!((along - exact).abs() < 1e-12 * exact, "{along} {exact}");
            }
        }
    }
}

/// Pressures that are too many for tags of their own are the same on curved faces.
#[test]
fn many_pressures_are_those_of_few() {
    let bar = curved([7, 3, 1]);
    let faces = bar.boundary_facets();
    let load = |pressure: &dyn Fn(usize) -> f64| {
        let line = |(k, face): (usize, &BoundaryFacet)| {
            let corners = bar.tets()[face.tet as usize];
            let opposite = corners.iter().position(|n| !face.nodes.contains(n)).expect("a corner");
            let number = [3, 4, 2, 1][opposite];
            format!("{}, P{number}, {:e}\n", face.tet + 1, pressure(k))
        };
        forces(
            &bar,
            &scene(&bar, "", &faces.iter().enumerate().map(line).collect::<String>()),
        )
    };
    assert!(faces.len() > 100);
    let few = load(&|_| 2.0);
    let many = load(&|k| 2.0 * (1.0 + 1e-15 * k as f64));
    assert_same(&few, &many);
}

/// The same point and direction of the axis in another step are the same load; the same line otherwise is none that
/// CalculiX would know again.
#[test]
fn an_axis_has_a_point_and_a_sense() {
    let bar = bar(1);
    let steps = |op: &str, spin: &str| {
        let more = format!("ALL, {SPIN}\n*END STEP\n*STEP\n*STATIC\n*DLOAD{op}\nALL, {spin}\n");
        let step = format!("*BOUNDARY\nN1, 1, 3\n*STEP\n*STATIC\n*DLOAD\n{more}*END STEP\n");
        read(&format!("{}{STEEL}{step}", mesh(&bar))).and_then(|deck| deck.scene())
    };
    let scene = steps("", "CENTRIF, 1.E6, 0.25, -0.5, 9., 0., 0., -1.").expect("scene");
    let [load] = scene.loads() else { panic!("one load") };
    let [one, two] = [1.0, 2.0].map(|t| load.history().value(t));
    assert!((two / one - 0.25).abs() < 1e-15, "{one} {two}");
    for other in [
        "CENTRIF, 1.E6, 0.25, -0.5, 9., 0., 0., 2.",
        "CENTRIF, 1.E6, 0.25, -0.5, -3., 0., 0., -2.",
    ] {
        let error = steps("", other).expect_err("another axis").to_string();
        assert!(error.contains("another axis"), "{error}");
        assert_eq!(steps(", OP=NEW", other).expect("scene").loads().len(), 2);
    }
}

/// Gravity of another direction takes the place of the first, which goes along a straight line.
#[test]
fn gravity_that_is_replaced_goes_along_a_line() {
    let bar = bar(1);
    let table = "*AMPLITUDE, NAME=A\n0., 0., 1., 1.\n";
    let other = "*END STEP\n*STEP\n*STATIC\n0.25, 1.\n*DLOAD, OP=NEW, AMPLITUDE=A\nALL, GRAV, 10., 1., 0., 0.\n";
    let scene = scene(&bar, table, &format!("ALL, GRAV, 10., 0., 0., -1.\n{other}"));
    let [down, along] = scene.loads() else {
        panic!("{}", scene.loads().len())
    };
    for (time, left, new) in [(1.0, 1.0, 0.0), (1.25, 0.75, 0.25), (1.5, 0.5, 0.5), (2.0, 0.0, 1.0)] {
        let found = [down, along].map(|load| load.history().value(time));
        assert!(
            (found[0] - left).abs() < 1e-12 && (found[1] - new).abs() < 1e-12,
            "{time}: {found:?}"
        );
    }
}

/// `OP=NEW` of one keyword for distributed loads removes those of the other, which Abaqus keeps: it is told.
#[test]
fn removed_loads_of_another_keyword_are_told() {
    let told = |second: &str| {
        let first = "*DLOAD\nALL, GRAV, 10., 0., 0., -1.\n*DSLOAD\nS6, P, 1.\n";
        let steps =
            format!("*BOUNDARY\nN5, 1, 3\n*STEP\n*STATIC\n{first}*END STEP\n*STEP\n*STATIC\n{second}*END STEP\n");
        let deck = read(&crate::write::cube(&steps)).expect("deck");
        deck.ignored().iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    let found = told("*DSLOAD, OP=NEW\nS6, P, 2.\n");
    assert!(
        matches!(&found[..], [one] if one.contains("OP=NEW") && one.contains("*DLOAD")),
        "{found:?}"
    );
    let found = told("*DLOAD, OP=NEW\nALL, GRAV, 9., 0., 0., -1.\n");
    assert!(matches!(&found[..], [one] if one.contains("*DSLOAD")), "{found:?}");
    for second in ["*DSLOAD\nS6, P, 2.\n", "*DLOAD, OP=NEW\n*DSLOAD\nS6, P, 2.\n"] {
        assert_eq!(told(second), [""; 0], "{second}");
    }
}
