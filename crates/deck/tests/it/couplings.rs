//! Nodes that stand for surfaces.

use signorini_contact::{Scene, Settings, Simulation};
use signorini_fem_mesh::vec3::{add, area_vector, cross, dot, norm, scale, sub};
use signorini_fem_mesh::{Brick, FacetTag, LoadDensity};

use crate::refusals::behind;
use crate::write::{STEEL, cube, mesh, read};

const NODE: &str = "*NODE\n900, 3., 0.25, 2.\n";
const HELD: &str = "*BOUNDARY\nN5, 1, 3\n";

fn coupled(law: &str) -> String {
    format!("{NODE}*COUPLING, CONSTRAINT NAME=C, REF NODE=900, SURFACE=S6\n{law}\n")
}

pub(crate) fn step(lines: &str) -> String {
    format!("*STEP\n*STATIC\n{lines}*END STEP\n")
}

fn scene(deck: &str) -> Scene {
    read(deck).expect("deck").scene().expect("scene")
}

/// Forces at nodes have the force and, about the node, the moment that is given there; each is its share of the area
/// times a field that grows linearly.
#[test]
fn loads_are_spread() {
    let linear = Brick::new([1.0; 3], [3, 2, 2]).build().expect("a brick");
    for brick in [linear.raise_order().expect("quadratic"), linear] {
        let loads = step("*CLOAD\n900, 1, 6.\n900, 3, -2.\n900, 4, 5.\n900, 6, 7.\n");
        let law = coupled("*DISTRIBUTING, COUPLING=CONTINUUM, WEIGHTING METHOD=UNIFORM\n1, 3\n4, 6");
        let scene = scene(&format!("{}{STEEL}{law}{HELD}{loads}", mesh(&brick)));
        let [load] = scene.loads() else {
            panic!("{:?}", scene.loads());
        };
        let Some(LoadDensity::NodalForces(forces)) = load.density() else {
            panic!("{load:?}");
        };
        let (mut force, mut moment) = ([0.0; 3], [0.0; 3]);
        for &(node, f) in forces {
            let x = brick.points()[node as usize];
            assert_eq!(x[2], 1.0);
            force = add(force, f);
            moment = add(moment, cross(sub(x, [3.0, 0.25, 2.0]), f));
        }
        for (found, given) in [(force, [6.0, 0.0, -2.0]), (moment, [5.0, 0.0, 7.0])] {
            assert!(
                (0..3).all(|c| (found[c] - given[c]).abs() < 1e-13 * 20.0),
                "{found:?} {given:?}"
            );
        }
        if brick.order() == 1 {
            let share = |node: u32| {
                let on = brick.facets().iter().enumerate();
                let on = on.filter(|(_, f)| f.tag == FacetTag(6) && f.nodes.contains(&node));
                on.map(|(f, _)| norm(area_vector(&brick.facet_points(f)))).sum::<f64>() / 3.0
            };
            let field = |&(node, f): &(u32, [f64; 3])| (brick.points()[node as usize], scale(1.0 / share(node), f));
            let field: Vec<_> = forces.iter().map(field).collect();
            // as displacements it would strain nothing
            for (x, f) in &field {
                let (y, g) = field[0];
                assert!(dot(sub(*x, y), sub(*f, g)).abs() < 1e-10, "{field:?}");
            }
        }
    }
}

/// A surface that has the displacement of a node is a support of its nodes.
#[test]
fn displacements_are_those_of_the_node() {
    let moves = "900, 3, 3, -0.1\n900, 1, 2\n900, 4, 6\n";
    let coupled = scene(&cube(&format!(
        "{}{HELD}{}",
        coupled("*KINEMATIC\n1, 3"),
        step(&format!("*BOUNDARY\n{moves}"))
    )));
    let direct = scene(&cube(&format!(
        "{HELD}{}",
        step("*BOUNDARY\nN6, 3, 3, -0.1\nN6, 1, 2\n")
    )));
    assert_eq!(coupled.supports().len(), direct.supports().len());
    for (a, b) in coupled.supports().iter().zip(direct.supports()) {
        let moves = a.motion().map(|m| (m.0, m.1.value(1.0)));
        assert_eq!(moves, b.motion().map(|m| (m.0, m.1.value(1.0))));
        assert_eq!((a.place(), a.directions()), (b.place(), b.directions()));
    }
}

#[test]
fn what_is_refused() {
    let refused = |law: &str, rest: &str, line: &str, word: &str, part: &str| {
        behind(&format!("{}{rest}", coupled(law)), line, word, part);
    };
    let card = "*COUPLING, CONSTRAINT NAME=C, REF NODE=900, SURFACE=S6";
    let idle = step("");
    refused("**", &format!("{HELD}{idle}"), card, "*COUPLING", "put *DISTRIBUTING");
    behind("*KINEMATIC\n", "*KINEMATIC", "*KINEMATIC", "put *COUPLING before");
    let other = "*DISTRIBUTING, WEIGHTING METHOD=LINEAR";
    refused(other, &idle, other, "WEIGHTING METHOD=LINEAR", "by area");
    refused("*KINEMATIC\n1, 2", &idle, "1, 2", "1, 2", "give 1 to 3");
    refused("*DISTRIBUTING\n4, 7", &idle, "4, 7", "4, 7", "1 to 6");
    let held = format!("{HELD}*BOUNDARY\n900, 1, 6\n{idle}");
    refused("*DISTRIBUTING", &held, "900, 1, 6", "900", "takes loads");
    let moment = format!("{HELD}{}", step("*CLOAD\n900, 5, 1.\n"));
    refused("*DISTRIBUTING\n4, 4", &moment, "900, 5, 1.", "5", "does not name");
    let axes = format!("*NSET, NSET=R\n900\n*TRANSFORM, NSET=R\n0., 1., 0., -1., 0., 0.\n{HELD}{idle}");
    refused("*DISTRIBUTING", &axes, "*TRANSFORM, NSET=R", "NSET=R", "along x, y, z");
    let fixed = format!("{HELD}{}", step("*BOUNDARY, FIXED\n900, 1, 6\n"));
    refused("*KINEMATIC", &fixed, "*BOUNDARY, FIXED", "FIXED", "of a rigid body");
    let own = "*COUPLING, REF NODE=27, SURFACE=S6";
    behind(
        &format!("{own}\n*DISTRIBUTING\n{HELD}{idle}"),
        own,
        "REF NODE=27",
        "a node of its own",
    );
    let unknown = "*COUPLING, REF NODE=900, SURFACE=NIX";
    behind(
        &format!("{NODE}{unknown}\n*DISTRIBUTING\n{HELD}{idle}"),
        unknown,
        "SURFACE=NIX",
        "there are: S1",
    );
    let oriented = "*COUPLING, REF NODE=900, SURFACE=S6, ORIENTATION=O";
    behind(
        &format!("{NODE}{oriented}\n"),
        oriented,
        "ORIENTATION=O",
        "along x, y, z",
    );
}

/// Displacements of the end of a bar that is pushed, bent and turned at a node beside it, as CalculiX 2.20 prints them.
#[test]
fn a_bar_is_bent_as_by_calculix() {
    let bar = Brick::new([4.0, 1.0, 1.0], [8, 2, 2]).build().expect("a bar");
    let bar = bar.raise_order().expect("quadratic");
    let law = coupled("*DISTRIBUTING\n1, 6")
        .replace("S6", "S2")
        .replace("3., 0.25, 2.", "5., 0.7, 0.2");
    let loads = step("*CLOAD\n900, 2, 10.\n900, 4, 500.\n900, 6, 30.\n*NODE PRINT, NSET=N2\nU\n");
    let deck = format!("{}{STEEL}{law}*BOUNDARY\nN1, 1, 3\n{loads}", mesh(&bar));
    let mut simulation = Simulation::new(scene(&deck), Settings::default()).expect("simulation");
    let result = simulation.step().expect("solved");
    let displacement = result.displacement();
    let printed = [
        ([4.0, 0.0, 0.0], [6.716358e-3, 1.156115e-1, -8.505917e-2]),
        ([4.0, 1.0, 0.0], [-6.716358e-3, 1.156115e-1, 8.505917e-2]),
        ([4.0, 0.0, 1.0], [6.716358e-3, -5.483547e-2, -8.538779e-2]),
        ([4.0, 0.5, 0.5], [0.0, 3.039348e-2, 0.0]),
    ];
    for (place, expected) in printed {
        let node = bar.points().iter().position(|x| *x == place).expect("a node");
        let found = displacement[node];
        assert!(
            (0..3).all(|c| (found[c] - expected[c]).abs() < 1e-7),
            "{place:?} {found:?} {expected:?}"
        );
    }
}

/// A rigid end under a force and a moment beside it, by *COUPLING and by *RIGID BODY, and guided against some motions:
/// displacements as CalculiX 2.20 prints them.
#[test]
fn a_rigid_end_is_loaded_as_in_calculix() {
    let bar = Brick::new([4.0, 1.0, 1.0], [8, 2, 2]).build().expect("a bar");
    let bar = bar.raise_order().expect("quadratic");
    let nodes = "*NODE\n900, 5., 0.7, 0.2\n901, 5., 0.7, 0.2\n";
    let coupling = "*COUPLING, CONSTRAINT NAME=C, REF NODE=900, SURFACE=S2\n*KINEMATIC\n1, 3\n";
    let body = "*RIGID BODY, NSET=N2, REF NODE=900, ROT NODE=901\n";
    let loaded = [
        [6.730666e-3, 1.146496e-1, -8.427700e-2],
        [-6.730666e-3, 1.146496e-1, 8.427700e-2],
        [6.730666e-3, -5.390438e-2, -8.427700e-2],
        [0.0, 3.037261e-2, 0.0],
    ];
    let guided = [6.730666e-3, -6.730666e-3, 6.730666e-3, 0.0].map(|x| [x, 3.037261e-2, 0.0]);
    let drawn = [7.077161e-2, 7.077161e-2, 4.130643e-2, 5.603902e-2].map(|x| [x, 3.449953e-3, -2.946518e-2]);
    let cases = [
        (coupling, "*CLOAD\n900, 2, 10.\n900, 4, 500.\n900, 6, 30.\n", loaded),
        (body, "*CLOAD\n900, 2, 10.\n901, 1, 500.\n901, 3, 30.\n", loaded),
        (body, "*BOUNDARY\n901, 1, 1\n*CLOAD\n900, 2, 10.\n901, 3, 30.\n", guided),
        (
            coupling,
            "*BOUNDARY\n900, 3, 4\n900, 6, 6\n*CLOAD\n900, 2, 10.\n900, 1, 3000.\n",
            drawn,
        ),
    ];
    for (law, loads, expected) in cases {
        let deck = format!("{}{STEEL}{nodes}{law}*BOUNDARY\nN1, 1, 3\n{}", mesh(&bar), step(loads));
        let settings = Settings::default().with_tolerance(1e-9);
        let mut simulation = Simulation::new(scene(&deck), settings).expect("simulation");
        let result = simulation.step().expect("solved");
        let places = [[4.0, 0.0, 0.0], [4.0, 1.0, 0.0], [4.0, 0.0, 1.0], [4.0, 0.5, 0.5]];
        for (place, expected) in places.into_iter().zip(expected) {
            let node = bar.points().iter().position(|x| *x == place).expect("a node");
            let found = result.displacement()[node];
            assert!(
                norm(sub(found, expected)) < 2e-7,
                "{loads}: {place:?} {found:?} {expected:?}"
            );
        }
    }
}

/// A quarter of a block under a plate that is moved: what its planes of symmetry hold of the plate the plate holds,
/// too.
#[test]
fn planes_of_symmetry_stand_beside_a_plate() {
    let symmetry = "*BOUNDARY\nN1, 1\nN3, 2\n";
    let run = |moves: &str| {
        let deck = format!(
            "{}{HELD}{symmetry}{}",
            coupled("*KINEMATIC\n1, 3"),
            step(&format!("*BOUNDARY\n{moves}"))
        );
        let mut simulation = Simulation::new(scene(&cube(&deck)), Settings::default())?;
        simulation.step()
    };
    let result = run("900, 3, 3, -0.1\n900, 1, 2\n900, 4, 6\n").expect("solved");
    assert!((result.couplings()[0].displacement[2] + 0.1).abs() < 1e-6);
    let error = run("900, 3, 3, -0.1\n900, 1, 1, 0.01\n900, 2, 2\n900, 4, 6\n").expect_err("contradictory");
    let text = error.to_string();
    assert!(
        text.contains("SURFACE=S6") && text.contains("a support holds it"),
        "{text}"
    );
}

/// What is held in all components and loaded, too, is a coupling, whose reaction has the load in it; a moved one
/// follows its amplitude.
#[test]
fn a_load_on_what_is_held_is_in_its_reaction() {
    let moves = "*BOUNDARY\n900, 3, 3, -0.1\n900, 1, 2\n900, 4, 6\n";
    let run = |loads: &str| {
        let steps = step(&format!("{moves}{loads}"));
        let deck = cube(&format!("{}{HELD}{steps}", coupled("*KINEMATIC\n1, 3")));
        let mut simulation = Simulation::new(scene(&deck), Settings::default()).expect("simulation");
        simulation.step().expect("solved")
    };
    let (plain, loaded) = (run(""), run("*CLOAD\n900, 3, 700.\n900, 4, 90.\n"));
    assert!(plain.couplings().is_empty() && (loaded.couplings()[0].displacement[2] + 0.1).abs() < 1e-6);
    let about = [3.0, 0.25, 2.0];
    let held = plain.reactions_about(about).of_supports();
    let others = loaded.reactions_about(about);
    let sum = others.of_supports();
    let [force, moment] = [
        add(sum.force, others.couplings[0].force),
        add(sum.moment, others.couplings[0].moment),
    ];
    let size = norm(plain.reactions().supports[0].resultant.force);
    assert!(
        norm(sub(add(force, [0.0, 0.0, 700.0]), held.force)) < 1e-6 * size,
        "{force:?}"
    );
    assert!(
        norm(sub(add(moment, [90.0, 0.0, 0.0]), held.moment)) < 1e-5 * size,
        "{moment:?}"
    );
}
