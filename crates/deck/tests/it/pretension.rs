//! Bolts that are tightened.

use signorini_contact::{Place, Settings, Simulation};
use signorini_fem_mesh::vec3::centroid;
use signorini_fem_mesh::{Brick, LoadDensity, TetMesh, brick};
use std::fmt::Write as _;

use crate::couplings::step;
use crate::write::{STEEL, face, mesh, read};

/// Where bars are cut, mm.
const MIDDLE: f64 = 20.0;

/// A bar of 40 mm, held at both ends and cut in the middle.
fn bar(order: usize) -> TetMesh {
    let brick = Brick::new([40.0, 10.0, 10.0], [8, 2, 2]).build().expect("a brick");
    if order == 2 { brick.raise_order().expect("quadratic") } else { brick }
}

/// The section at this x of the elements on its left, whose node has no place in the mesh.
pub(crate) fn section(mesh: &TetMesh, at: f64) -> String {
    let mut deck = String::from("*NODE\n9000, 0., 0., 0.\n*SURFACE, NAME=CUT\n");
    const FACES: [[usize; 3]; 4] = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];
    for tet in 0..mesh.tets().len() {
        let points = mesh.tet_points(tet);
        for (number, face) in (1..).zip(FACES) {
            if centroid(&points)[0] < at && face.iter().all(|i| (points[*i][0] - at).abs() < 1e-9) {
                writeln!(deck, "{}, S{number}", tet + 1).expect("text");
            }
        }
    }
    deck
}

const HELD: &str = "*BOUNDARY\nN1, 1, 3\n";

fn deck(mesh_: &TetMesh, steps: &str) -> String {
    let node = "*PRE-TENSION SECTION, SURFACE=CUT, NODE=9000\n";
    format!("{}{STEEL}{}{node}{HELD}{steps}", mesh(mesh_), section(mesh_, MIDDLE))
}

const FORCE: &str = "*STEP\n*STATIC\n1., 1.\n*BOUNDARY\nN2, 1, 3\n*CLOAD\n9000, 1, 1000.\n*END STEP\n";
const LENGTH: &str = "*STEP\n*STATIC\n1., 1.\n*BOUNDARY\nN2, 1, 3\n9000, 1, 1, 0.01\n*END STEP\n";
const FIXED: &str =
    "*STEP\n*STATIC\n1., 1.\n*BOUNDARY\nN2, 1, 1, 0.02\nN2, 3, 3, 0.05\n*BOUNDARY, FIXED\n9000, 1\n*END STEP\n";
const PULLED: &str = "*STEP\n*STATIC\n1., 1.\n*BOUNDARY\nN2, 1, 1, 0.02\nN2, 3, 3, 0.05\n*END STEP\n";

/// Forces that the section transfers after each step.
fn forces(text: &str) -> Vec<[f64; 3]> {
    let scene = read(text).expect("deck").scene().expect("scene");
    let settings = Settings::default().with_tolerance(1e-9);
    let mut simulation = Simulation::new(scene, settings).expect("set-up");
    let mut out = Vec::new();
    while !simulation.is_finished() {
        let step = simulation.step().expect("step");
        let reactions = step.reactions();
        let rest = reactions.imbalance().force;
        assert!(rest.iter().all(|f| f.abs() < 1e-3), "{rest:?}");
        out.push(reactions.contacts[0].force);
    }
    out
}

/// What CalculiX 2.20 makes of the same bars with doubled nodes and an *EQUATION for each component. (Its own keyword
/// is wrong for tetrahedra, of which some meet a section with an edge or a corner only: 218 N for 1000 N.)
#[test]
fn a_tightened_bar_has_the_forces_of_calculix() {
    let cases = [
        (1, [FORCE, FIXED], [1000.0, 11905.79, 2128.667]),
        (1, [LENGTH, PULLED], [5452.896, 16358.69, 2128.667]),
        (2, [FORCE, FIXED], [1000.0, 11706.82, 1449.295]),
        (2, [LENGTH, PULLED], [5353.412, 16060.24, 1449.295]),
    ];
    for (order, steps, [first, second, across]) in cases {
        let found = forces(&deck(&bar(order), &steps.concat()));
        assert!((found[0][0] / first - 1.0).abs() < 1e-6, "{found:?}");
        assert!((found[1][0] / second - 1.0).abs() < 1e-6, "{found:?}");
        assert!((found[1][2] / across - 1.0).abs() < 1e-6, "{found:?}");
    }
}

/// On a plane of symmetry copies of nodes are held as these, also along axes of their own; a normal may be given.
#[test]
fn copies_of_nodes_are_held_as_they_are() {
    let mesh_ = bar(1);
    let text = deck(&mesh_, &[FORCE, FIXED].concat());
    let held = |plane: &str| forces(&text.replace(HELD, &format!("*BOUNDARY\nN1, 1, 3\n{plane}")));
    let expected = held("N3, 2, 2\n");
    assert!((expected[0][0] - 1000.0).abs() < 1e-3, "{expected:?}");
    // y is the first of these axes; the ends are held in all directions
    let inner: Vec<String> = (mesh_.nodes_on(brick::Y_MIN).into_iter())
        .filter(|n| (1e-9..40.0 - 1e-9).contains(&mesh_.points()[*n as usize][0]))
        .map(|n| format!("{}", n + 1))
        .collect();
    let set = format!("*NSET, NSET=INNER\n{}\n", inner.join(",\n"));
    let found = held(&format!(
        "{set}*TRANSFORM, NSET=INNER\n0., 1., 0., 0., 0., 1.\n*BOUNDARY\nINNER, 1, 1\n"
    ));
    for (a, b) in found.iter().flatten().zip(expected.iter().flatten()) {
        assert!((a - b).abs() < 1e-3, "{found:?} {expected:?}");
    }
    let along = text.replace("NODE=9000\n", "NODE=9000\n2., 0., 0.\n");
    assert_eq!(forces(&along), forces(&text));
    // the deck has each node once, the mesh the copies, too
    let read = read(&text).expect("deck");
    let copies = read.mesh().points().len() - mesh_.points().len();
    assert_eq!(copies, 9);
    assert_eq!(read.node_numbers().len(), read.mesh().points().len());
    assert_eq!(read.coupling_names(), ["SURFACE=CUT"]);
    // and so have sets of the program
    let on = |n: &u32| read.mesh().points()[*n as usize][1] == 0.0;
    let all: Vec<u32> = (0..read.mesh().points().len() as u32).filter(on).collect();
    assert_eq!(read.node_set("N3").expect("a set"), all);
    assert_eq!(all.len() - mesh_.nodes_on(brick::Y_MIN).len(), 3);
}

/// The elements behind the section, and element and number of each of their faces, those on one side first.
fn behind(mesh: &TetMesh) -> (String, Vec<(usize, usize)>, usize) {
    let right = |tet: usize| centroid(&mesh.tet_points(tet))[0] > 20.0;
    let elements = (0..mesh.tets().len()).filter(|tet| right(*tet));
    let set = elements.map(|tet| format!("{},\n", tet + 1)).collect::<String>();
    let facets = (0..mesh.facets().len()).filter(|f| right(mesh.facet_owner(*f)));
    let (side, rest): (Vec<_>, Vec<_>) = facets.partition(|f| mesh.facets()[*f].tag == brick::Y_MIN);
    let faces = side.iter().chain(&rest).map(|f| face(mesh, *f)).collect();
    (format!("*ELSET, ELSET=RIGHT\n{set}"), faces, side.len())
}

/// What acts behind a section acts on the nodes there, also on those of the section: the other side has none of it.
#[test]
fn forces_stay_on_their_side_of_a_section() {
    for order in [1, 2] {
        let brick = Brick::new([40.0, 10.0, 10.0], [8, 3, 3]).build().expect("a brick");
        let mesh_ = if order == 2 { brick.raise_order().expect("quadratic") } else { brick };
        let (mut sets, faces, side) = behind(&mesh_);
        sets += "*SURFACE, NAME=SIDE\n";
        sets.extend(
            faces[..side]
                .iter()
                .map(|(element, number)| format!("{element}, S{number}\n")),
        );
        let node = "*NODE\n9100, 30., -5., 5.\n*COUPLING, CONSTRAINT NAME=C, REF NODE=9100, SURFACE=SIDE\n*DISTRIBUTING\n1, 6\n";
        // more than get tags of their own
        let line = |(k, (element, number)): (usize, &(usize, usize))| format!("{element}, P{number}, {}.\n", k + 1);
        let pressures: String = faces.iter().enumerate().map(line).collect();
        assert!(faces.len() > 100);
        for (model, loads) in [
            ("", "*DLOAD\nRIGHT, BX, 2.\n"),
            ("", "*DLOAD\nRIGHT, CENTRIF, 4.E6, 0., 0., 0., 0., 0., 1.\n"),
            ("", "*DSLOAD\nSIDE, TRVEC, 3., 1., 0.5, 0.\n"),
            ("", &format!("*DLOAD\n{pressures}")),
            (node, "*CLOAD\n9100, 1, 7.\n9100, 4, 3.\n"),
            (&node.replace("DISTRIBUTING", "KINEMATIC"), "*CLOAD\n9100, 1, 7.\n"),
        ] {
            let text = deck(&mesh_, &step(loads)).replace(HELD, &format!("{sets}{model}{HELD}"));
            let read = read(&text).expect("deck");
            let (scene, mesh) = (read.scene().expect("scene"), read.mesh());
            let mut left = vec![false; mesh.points().len()];
            for (tet, corners) in mesh.tets().iter().enumerate() {
                let nodes = corners.iter().chain(mesh.mids().get(tet).into_iter().flatten());
                if centroid(&mesh.tet_points(tet))[0] < 20.0 {
                    nodes.for_each(|n| left[*n as usize] = true);
                }
            }
            let nodal = scene.loads().iter().filter_map(|load| match load.density() {
                Some(LoadDensity::NodalForces(forces)) => Some(forces),
                _ => None,
            });
            let coupled = scene.couplings().iter().filter_map(|coupling| match coupling.place() {
                Some(Place::Nodes(nodes)) => Some(nodes),
                _ => None,
            });
            let forces = nodal.flatten().map(|force| force.0);
            let nodes: Vec<u32> = forces.chain(coupled.flatten().copied()).collect();
            let wrong = nodes.iter().filter(|n| left[**n as usize]).count();
            assert_eq!((nodes.is_empty(), wrong), (false, 0), "order {order}, {loads}");
        }
        // nothing holds the sides together along the bar: its left end feels nothing
        let text = deck(&mesh_, &step("*BOUNDARY\nN2, 1, 3\n*DLOAD\nRIGHT, BX, 2.\n"));
        let deck = read(&text.replace(HELD, &format!("{sets}{HELD}"))).expect("deck");
        let scene = deck.scene().expect("scene");
        let mut simulation = Simulation::new(scene, Settings::default().with_tolerance(1e-9)).expect("set-up");
        let reactions = simulation.step().expect("step").reactions();
        let along: Vec<f64> = reactions.supports.iter().map(|s| s.resultant.force[0]).collect();
        assert!(along[0].abs() < 1e-4 && (along[1] + 4000.0).abs() < 1e-3, "{along:?}");
    }
}

#[track_caller]
fn refused(text: String, part: &str) {
    let error = read(&text).map(|_| ()).expect_err("refused").to_string();
    assert!(error.contains(part), "{error}");
}

#[test]
fn what_is_no_section_is_refused() {
    let mesh_ = bar(1);
    let text = |steps: &str| deck(&mesh_, steps);
    refused(text(&step("*CLOAD\n9000, 2, 1.\n")), "component 1 only");
    refused(text(&step("*BOUNDARY\n9000, 1, 3\n")), "component 1 only");
    let at = mesh_.points().iter().position(|x| x[0] == 20.0).expect("a node") + 1;
    refused(text(&step(&format!("*CLOAD\n{at}, 2, 1.\n"))), "two displacements");
    let whole = text(FORCE);
    let first = section(&mesh_, MIDDLE);
    let one = first.lines().take(4).collect::<Vec<_>>().join("\n") + "\n";
    refused(whole.replace(&first, &one), "ends inside the body");
    let outside = whole.replace("SURFACE=CUT, NODE", "SURFACE=S2, NODE");
    refused(outside, "on the boundary");
    refused(whole.replace("NODE=9000", "NODE=1"), "belongs to an elastic element");
    refused(whole.replace("NODE=9000\n", "NODE=9000\n0., 0., 0.\n"), "no normal");
    refused(
        whole.replace("*SURFACE, NAME=CUT\n", "*SURFACE, NAME=CUT\nALL\n"),
        "faces S1 to S6",
    );
    let twice = "*PRE-TENSION SECTION, SURFACE=CUT, NODE=9000\n";
    refused(
        whole.replace(twice, &format!("{twice}{twice}")),
        "stands for another surface",
    );
    let other = "*NODE\n9001, 0., 0., 0.\n*PRE-TENSION SECTION, SURFACE=CUT, NODE=9001\n";
    refused(
        whole.replace(twice, &format!("{twice}{other}")),
        "another section is at this surface",
    );
    refused(
        whole.replace("NODE=9000\n", "NODE=9000\n0., 1., 0.\n"),
        "lies in the section",
    );
    let tie = "*TIE, NAME=T\nCUT, S2\n";
    refused(
        whole.replace(HELD, &format!("{tie}{HELD}")),
        "inside the body; name a surface",
    );
    refused(text(&step("*DSLOAD\nCUT, P, 1.\n")), "inside the body; name a surface");
}

/// With a section that stays closed nothing is else than without, also where copies of nodes matter.
#[test]
fn a_closed_section_changes_nothing() {
    let warm = STEEL.replace("*DENSITY", "*EXPANSION\n1.2e-5\n*DENSITY");
    let mesh_ = bar(1);
    let rotation = "*NODE\n9100, 20., 0., 5.\n";
    let side = "*COUPLING, CONSTRAINT NAME=C, REF NODE=9100, SURFACE=S3\n*KINEMATIC\n1, 6\n";
    let ends = "*BOUNDARY\nN1, 1, 3\n";
    let step = |more: &str| format!("*STEP\n*STATIC\n1., 1.\n*BOUNDARY\nN2, 1, 3\n{more}*END STEP\n");
    let free = |more: &str| format!("*STEP\n*STATIC\n1., 1.\n{more}*END STEP\n");
    for (model, steps) in [
        (
            String::new(),
            step("9000, 1\n*TEMPERATURE\nN1, 100.\nN2, 100.\nINNER, 100.\n"),
        ),
        (
            format!("{rotation}{side}"),
            free("*BOUNDARY\n9000, 1\n9100, 1, 6\n*DLOAD\nALL, BX, 1.\n"),
        ),
    ] {
        let inner: Vec<String> = (1..=mesh_.points().len()).map(|n| n.to_string()).collect();
        let set = format!("*NSET, NSET=INNER\n{}\n", inner.join(",\n"));
        let ends = if model.is_empty() { ends } else { "*BOUNDARY\n" };
        let node = "*PRE-TENSION SECTION, SURFACE=CUT, NODE=9000\n";
        let cut = format!(
            "{}{warm}{}{set}{node}{model}{ends}{steps}",
            mesh(&mesh_),
            section(&mesh_, MIDDLE)
        );
        let plain = cut
            .replace(node, "")
            .replace(&section(&mesh_, MIDDLE), "")
            .replace("9000, 1\n", "");
        let solved = |text: &str| {
            let scene = read(text).expect("deck").scene().expect("scene");
            let mut simulation = Simulation::new(scene, Settings::default().with_tolerance(1e-10)).expect("set-up");
            simulation.step().expect("step").displacement()
        };
        let (found, expected) = (solved(&cut), solved(&plain));
        let size = expected.as_flattened().iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        for (a, b) in found.iter().flatten().zip(expected.iter().flatten()) {
            assert!((a - b).abs() < 1e-6 * size, "{a:e} for {b:e} of {size:e}");
        }
    }
}

/// What is locked stays so, and no other condition of it is lost in silence.
#[test]
fn what_is_fixed_stays() {
    let refused = |steps: String, part: &str| refused(deck(&bar(1), &steps), part);
    refused([LENGTH, FIXED].concat(), "its displacement is prescribed");
    let both = "*BOUNDARY\nN2, 1, 3\n*BOUNDARY, FIXED\n9000, 1\n*BOUNDARY\n9000, 1, 1, 0.01\n";
    refused(step(both), "the node is FIXED, and stays so");
    let new = step("*BOUNDARY, OP=NEW\nN1, 1, 3\nN2, 1, 3\n");
    refused([FORCE, FIXED, &new].concat(), "this releases component 1 of node 9000");
    let again = step("*BOUNDARY, OP=NEW\nN1, 1, 3\nN2, 1, 3\n*BOUNDARY, FIXED\n9000, 1\n");
    assert!(read(&deck(&bar(1), &[FORCE, FIXED, &again].concat())).is_ok());
    let loaded = read(&deck(
        &bar(1),
        &[FORCE, FIXED, &step("*CLOAD\n9000, 1, 3000.\n")].concat(),
    ))
    .expect("a deck");
    assert!(
        loaded
            .ignored()
            .iter()
            .any(|ignored| ignored.why.contains("acts on nothing"))
    );
    let fixed = step("*BOUNDARY\nN2, 1, 3\n*BOUNDARY, FIXED\n9000, 1\n*CLOAD\n9000, 1, 500.\n");
    let forces = forces(&deck(&bar(1), &fixed));
    assert!(forces[0][0].abs() < 1e-6, "{forces:?}");
}
