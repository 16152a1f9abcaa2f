//! Rigid bodies: nodes of elastic elements that they carry, and surfaces that are no planes.

use std::fmt::Write as _;

use signorini_contact::{
    Analysis, Contact, DifferenceFormula, Friction, Obstacle, Scene, Settings, Simulation, Support,
};
use signorini_fem_mesh::vec3::{cross, norm, sub};
use signorini_fem_mesh::{Brick, FacetTag, History, brick};

use crate::same_bits::{compare, steel};
use crate::write::{STEEL, cube, mesh, read};

/// Nodes that a rigid body shares with elastic elements are displaced and turned with it, as those of a kinematic
/// coupling are.
#[test]
fn elastic_nodes_move_with_what_is_rigid() {
    let node = "*NODE\n900, 0.3, 0.2, 2.\n901\n*BOUNDARY\nN5, 1, 3\n";
    let by_set = "*RIGID BODY, NSET=N6, REF NODE=900, ROT NODE=901\n";
    let by_surface = "*COUPLING, REF NODE=900, SURFACE=S6, CONSTRAINT NAME=C\n*KINEMATIC\n";
    let step = |moves: &str| format!("*STEP\n*STATIC\n*BOUNDARY\n{moves}*END STEP\n");
    let turned = step("900, 1, 1, 0.1\n900, 2, 3\n901, 1, 2\n901, 3, 3, 0.02\n");
    let coupled = step("900, 1, 1, 0.1\n900, 2, 5\n900, 6, 6, 0.02\n");
    for deck in [by_set.to_owned() + &turned, by_surface.to_owned() + &coupled] {
        let deck = read(&cube(&(node.to_owned() + &deck))).expect("deck");
        let mut simulation = Simulation::new(deck.scene().expect("scene"), Settings::default()).expect("simulation");
        let result = simulation.step().expect("solved");
        assert!(result.report().status.converged());
        for n in deck.mesh().nodes_on(brick::Z_MAX) {
            let turn = cross([0.0, 0.0, 0.02], sub(deck.mesh().points()[n as usize], [0.3, 0.2, 2.0]));
            let exact = [0.1 + turn[0], turn[1], turn[2]];
            let found = result.displacement()[n as usize];
            assert!(norm(sub(found, exact)) < 1e-9, "{found:?} {exact:?}");
        }
    }
}

/// Pressed in one step and turned in the next.
#[test]
fn what_is_rigid_turns_after_it_was_displaced() {
    let node = "*NODE\n900, 0.3, 0.2, 2.\n901\n*BOUNDARY\nN5, 1, 3\n901, 1, 2\n";
    let step = |moves: &str| format!("*STEP\n*STATIC\n*BOUNDARY\n{moves}*END STEP\n");
    let steps = step("900, 1, 2\n900, 3, 3, -0.05\n901, 3, 3, 0.\n") + &step("900, 1, 1, 0.1\n901, 3, 3, 0.02\n");
    let deck = node.to_owned() + "*RIGID BODY, NSET=N6, REF NODE=900, ROT NODE=901\n" + &steps;
    let deck = read(&cube(&deck)).expect("deck");
    let mut simulation = Simulation::new(deck.scene().expect("scene"), Settings::default()).expect("simulation");
    for (shift, angle) in [([0.0, 0.0, -0.05], 0.0), ([0.1, 0.0, -0.05], 0.02)] {
        let result = simulation.step().expect("solved");
        for n in deck.mesh().nodes_on(brick::Z_MAX) {
            let turn = cross(
                [0.0, 0.0, angle],
                sub(deck.mesh().points()[n as usize], [0.3, 0.2, 2.0]),
            );
            let exact = [0, 1, 2].map(|c| shift[c] + turn[c]);
            let found = result.displacement()[n as usize];
            assert!(norm(sub(found, exact)) < 1e-9, "{found:?} {exact:?}");
        }
    }
}

/// A plane that presses from below in one step and drags in the next has two motions, which add up.
#[test]
fn a_rigid_surface_presses_and_then_drags() {
    let block = Brick::new([1.0; 3], [3, 3, 2]).build().expect("brick");
    let deck = mesh(&block)
        + STEEL
        + "*NODE\n101, -1., -1., 0.\n102, 2., -1., 0.\n103, 2., 2., 0.\n104, -1., 2., 0.\n109\n\
        *ELEMENT, TYPE=R3D4, ELSET=FLOOR\n900, 101, 102, 103, 104\n*RIGID BODY, REF NODE=109, ELSET=FLOOR\n\
        *SURFACE, NAME=PLANE\nFLOOR, SPOS\n*SURFACE INTERACTION, NAME=ROUGH\n*FRICTION\n0.25\n\
        *CONTACT PAIR, INTERACTION=ROUGH\nS5, PLANE\n*BOUNDARY\nN6, PINNED\n109, 4, 6\n\
        *STEP\n*STATIC\n1., 1.\n*BOUNDARY\n109, 1, 2\n109, 3, 3, 0.001\n*END STEP\n\
        *STEP\n*STATIC\n1., 1.\n*BOUNDARY\n109, 1, 1, 0.002\n*END STEP\n";
    let table = |points: &[(f64, f64)]| History::table(points.to_vec()).expect("table");
    let program = Scene::new(block, steel())
        .with_support(Support::fixed(brick::Z_MAX))
        .with_contact(
            Contact::half_space(brick::Z_MIN, [-1.0, -1.0, 0.0], [0.0, 0.0, 1.0])
                .with_motion([0.002, 0.0, 0.0], table(&[(1.0, 0.0), (2.0, 1.0)]))
                .with_motion([0.0, 0.0, 0.001], table(&[(0.0, 0.0), (1.0, 1.0)]))
                .with_friction(Friction::coulomb(0.25)),
        )
        .with_analysis(Analysis::quasistatic(2.0, 2).with_formula(DifferenceFormula::BACKWARD_EULER));
    compare(&deck, program);
}

/// Without a rotation each component has a history of its own.
#[test]
fn what_does_not_turn_moves_along_each_axis_by_itself() {
    let node = "*NODE\n900, 0.3, 0.2, 2.\n*AMPLITUDE, NAME=A\n0., 0., 0.5, 1., 1., 0.5\n*AMPLITUDE, NAME=B\n0., 0., \
        0.5, 0.25, 1., 1.\n*BOUNDARY\nN5, 1, 3\n";
    let step = "*STEP\n*STATIC\n0.5, 1.\n*BOUNDARY\n900, 3, 6\n*BOUNDARY, AMPLITUDE=A\n900, 1, 1, 0.1\n\
        *BOUNDARY, AMPLITUDE=B\n900, 2, 2, 0.2\n*END STEP\n";
    for what in [
        "*RIGID BODY, NSET=N6, REF NODE=900\n",
        "*COUPLING, REF NODE=900, SURFACE=S6, CONSTRAINT NAME=C\n*KINEMATIC\n",
    ] {
        let deck = read(&cube(&format!("{node}{what}{step}"))).expect("deck");
        let mut simulation = Simulation::new(deck.scene().expect("scene"), Settings::default()).expect("simulation");
        for exact in [[0.1, 0.05, 0.0], [0.05, 0.2, 0.0]] {
            let result = simulation.step().expect("solved");
            for n in deck.mesh().nodes_on(brick::Z_MAX) {
                let found = result.displacement()[n as usize];
                assert!(norm(sub(found, exact)) < 1e-9, "{found:?} {exact:?}");
            }
        }
    }
}

/// A block on a roller of flat facets that presses it from below and turns.
#[test]
fn a_curved_rigid_surface_is_a_triangulated_obstacle() {
    let block = Brick::new([1.0; 3], [4, 2, 2]).build().expect("brick");
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    let (mut nodes, mut facets) = (String::from("*NODE\n999, 0.5, 0., -5.\n"), String::new());
    for k in 0..9_u32 {
        // straight up in the middle
        let angle = 0.1 * (f64::from(k) - 4.0);
        for (i, y) in [-1.0, 2.0].into_iter().enumerate() {
            let [x, z] = [0.5 + 5.0 * angle.sin(), 5.0 * angle.cos() - 5.0];
            points.push([x, y, z]);
            writeln!(nodes, "{}, {x:?}, {y:?}, {z:?}", 500 + 2 * k + i as u32).expect("text");
        }
        if k > 0 {
            let [a, b, c, d] = [2 * k - 2, 2 * k, 2 * k + 1, 2 * k - 1];
            let labels = [a, b, c, d].map(|n| n + 500);
            writeln!(
                facets,
                "{}, {}, {}, {}, {}",
                600 + k,
                labels[0],
                labels[1],
                labels[2],
                labels[3]
            )
            .expect("text");
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    // corner by corner, as the deck gives them
    let corners: Vec<_> = triangles.iter().flatten().map(|n: &u32| points[*n as usize]).collect();
    let apart: Vec<_> = (0..triangles.len() as u32)
        .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
        .collect();
    let deck = mesh(&block)
        + STEEL
        + &nodes
        + "*ELEMENT, TYPE=R3D4, ELSET=ROLLER\n"
        + &facets
        + "*RIGID BODY, REF NODE=999, ELSET=ROLLER\n*SURFACE, NAME=ROUND\nROLLER, SPOS\n\
        *SURFACE INTERACTION, NAME=ROUGH\n*FRICTION\n0.25\n*CONTACT PAIR, INTERACTION=ROUGH\nS5, ROUND\n\
        *BOUNDARY\nN6, PINNED\n*STEP\n*STATIC\n1., 1.\n*BOUNDARY\n999, 1, 2\n999, 3, 3, 0.001\n999, 4, 6\n*END STEP\n\
        *STEP\n*STATIC\n1., 1.\n*BOUNDARY\n999, 5, 5, 0.0004\n*END STEP\n";
    let table = |points: &[(f64, f64)]| History::table(points.to_vec()).expect("table");
    let obstacle = Obstacle::surface(&corners, &apart).expect("obstacle");
    let program = Scene::new(block, steel())
        .with_support(Support::fixed(brick::Z_MAX))
        .with_contact(
            Contact::obstacle(brick::Z_MIN, obstacle)
                .with_motion([0.0, 0.0, 0.001], table(&[(0.0, 0.0), (1.0, 1.0)]))
                .with_rotation(
                    [0.5, 0.0, -5.0],
                    [0.0, 0.0004, 0.0],
                    table(&[(1.0, 0.0), (2.0, 0.0004)]),
                )
                .with_friction(Friction::coulomb(0.25)),
        )
        .with_analysis(Analysis::quasistatic(2.0, 2).with_formula(DifferenceFormula::BACKWARD_EULER));
    compare(&deck, program);
}

/// A plane that not all nodes lie over holds those that do.
#[test]
fn beside_a_rigid_plane_nothing_is_held() {
    let plane = "*NODE\n101, -1., -1., 0.\n102, 0.7, -1., 0.\n103, 0.7, 2., 0.\n104, -1., 2., 0.\n109\n\
        *ELEMENT, TYPE=R3D4, ELSET=FLOOR\n900, 101, 102, 103, 104\n*RIGID BODY, REF NODE=109, ELSET=FLOOR\n\
        *SURFACE, NAME=PLANE\nFLOOR, SPOS\n*SURFACE INTERACTION, NAME=I\n*CONTACT PAIR, INTERACTION=I\nS5, PLANE\n\
        *BOUNDARY\n109, 1, 6\nN6, 1, 3\n*STEP\n*STATIC\n*BOUNDARY\nN6, 3, 3, -0.01\n*END STEP\n";
    let deck = read(&cube(plane)).expect("deck");
    let mut simulation = Simulation::new(deck.scene().expect("scene"), Settings::default()).expect("simulation");
    let result = simulation.step().expect("solved");
    assert!(result.report().status.converged());
    for n in deck.mesh().nodes_on(brick::Z_MIN) {
        let (over, down) = (
            deck.mesh().points()[n as usize][0] < 0.7,
            result.displacement()[n as usize][2],
        );
        assert!(if over { down > -1e-9 } else { down < -1e-3 }, "{over} {down}");
    }
}

/// A rigid punch of solid elements that is pressed by a force on an elastic block: its elements are in the mesh, and
/// its nodes coupled, as those of a set are. It sinks in and tilts as one, and the block takes the force.
#[test]
fn a_rigid_punch_is_pressed_by_a_force() {
    let brick = |n| Brick::new([1.0; 3], [n; 3]).build().expect("brick");
    let above = brick(2)
        .map_points(|[x, y, z]| [0.5 * x + 0.3, 0.5 * y + 0.2, 0.5 * z + 1.0])
        .expect("lifted");
    let (below, first) = (brick(4), brick(4).tets().len());
    let both = below.append(&above.map_tags(|t| FacetTag(t.0 + 10))).expect("two");
    let sets = format!(
        "*ELSET, ELSET=PUNCH, GENERATE\n{}, {}\n*NSET, NSET=PUNCH, GENERATE\n{}, {}\n*NODE\n900, 0.6, 0.4, 1.5\n901\n",
        first + 1,
        both.tets().len(),
        below.points().len() + 1,
        both.points().len()
    );
    let pair = "*SURFACE INTERACTION, NAME=I\n*FRICTION\n0.3\n*CONTACT PAIR, INTERACTION=I\nS6, S15\n";
    let rest = "*BOUNDARY\nN5, 1, 3\n900, 1, 2\n901, 3, 3\n*STEP\n*STATIC\n*CLOAD\n900, 3, -1e8\n*END STEP\n";
    let solve = |body: &str, rest: &str| {
        let deck = read(&format!("{}{STEEL}{sets}{body}{pair}{rest}", mesh(&both))).expect("deck");
        let settings = Settings::default().with_tolerance(1e-8);
        let mut simulation = Simulation::new(deck.scene().expect("scene"), settings).expect("simulation");
        let result = simulation.step().expect("solved");
        assert!(result.report().status.converged());
        result
    };
    let run = |body: &str| solve(body, rest);
    let result = run("*RIGID BODY, ELSET=PUNCH, REF NODE=900, ROT NODE=901\n");
    let by_set = run("*RIGID BODY, NSET=PUNCH, REF NODE=900, ROT NODE=901\n");
    assert_eq!(result.displacement(), by_set.displacement());
    let motion = result.couplings()[0];
    assert!(
        motion.displacement[2] < 0.0 && norm(motion.rotation) > 0.0,
        "{motion:?}"
    );
    for (point, found) in both
        .points()
        .iter()
        .zip(result.displacement())
        .skip(below.points().len())
    {
        let turn = cross(motion.rotation, sub(*point, [0.6, 0.4, 1.5]));
        let exact: Vec<f64> = (0..3).map(|c| motion.displacement[c] + turn[c]).collect();
        let off = norm(sub(found, [exact[0], exact[1], exact[2]]));
        assert!(off < 1e-6 * norm(motion.displacement), "{found:?} {exact:?}");
    }
    let support = result.reactions().supports[0].resultant.force[2];
    assert!((support - 1e8).abs() < 1e2, "{support}");
    // what the first step clears does not hold it
    let moved = "*BOUNDARY, OP=NEW\nN5, 1, 3\n900, 1, 2\n901, 3, 3\n900, 3, 3, -0.001\n*END STEP\n";
    let [held, free] = ["*BOUNDARY\n900, 1, 6\n", ""].map(|before| {
        let steps = format!("{before}*STEP\n*STATIC\n{moved}");
        solve(
            "*RIGID BODY, ELSET=PUNCH, REF NODE=900\n",
            &steps.replace("901, 3, 3", "900, 6"),
        )
    });
    assert_eq!(held.displacement(), free.displacement());
}

/// PIN NSET is NSET.
#[test]
fn pinned_nodes_are_nodes_of_a_rigid_body() {
    let deck = |key: &str| {
        let body = format!("*NODE\n900, 0.5, 0.5, 1.\n*RIGID BODY, {key}=N6, REF NODE=900\n");
        let step = "*BOUNDARY\nN5, 1, 3\n*STEP\n*STATIC\n*CLOAD\n900, 1, 1.\n*END STEP\n";
        crate::write::read(&crate::write::cube(&(body + step))).and_then(|deck| deck.scene())
    };
    let [plain, pinned] = ["NSET", "PIN NSET"].map(|key| format!("{:?}", deck(key).expect("scene").couplings()));
    assert_eq!(plain, pinned);
    let error = deck("PIN NSET=N5, TIE NSET").expect_err("two").to_string();
    assert!(error.contains("into one set"), "{error}");
}
