//! What steps, amplitudes and loads mean.

use signorini_contact::{Analysis, Load, Place, Scene, Settings, Simulation};
use signorini_fem_mesh::LoadDensity;

use crate::write::{cube, face, read};

/// The scene of a cube with the floor held.
fn scene(rest: &str) -> Scene {
    let deck = read(&cube(&format!("*BOUNDARY\nN5, 1, 3\n{rest}"))).expect("deck");
    deck.scene().expect("scene")
}

fn times(scene: &Scene) -> Vec<f64> {
    let analysis = scene.analysis();
    (0..analysis.steps()).filter_map(|i| analysis.time(i)).collect()
}

/// The force at node 27 along z at times, which is the only one.
fn force_at(scene: &Scene, times: &[f64]) -> Vec<f64> {
    let [load] = scene.loads() else {
        panic!("{:?}", scene.loads());
    };
    let Some(LoadDensity::NodalForces(forces)) = load.density() else {
        panic!("{load:?}");
    };
    assert_eq!(forces[0].0, 26);
    times
        .iter()
        .map(|&t| forces[0].1[2] * load.history().value(t))
        .collect()
}

fn step(lines: &str) -> String {
    format!("*STEP\n*STATIC\n0.5, 1.\n{lines}*END STEP\n")
}

#[test]
fn increments_are_times() {
    assert_eq!(scene("*STEP\n*STATIC\n*END STEP\n").analysis(), &Analysis::statics());
    assert_eq!(
        times(&scene("*STEP\n*STATIC\n0.25, 1.\n*END STEP\n")),
        [0.25, 0.5, 0.75, 1.0]
    );
    // the last one is shorter, none is larger than the largest
    assert_eq!(times(&scene("*STEP\n*STATIC\n0.4, 1.\n*END STEP\n")), [0.4, 0.8, 1.0]);
    assert_eq!(
        times(&scene("*STEP\n*STATIC, DIRECT\n1., 1., 1e-5, 0.5\n*END STEP\n")),
        [0.5, 1.0]
    );
    assert_eq!(times(&scene(&(step("") + &step("")))), [0.5, 1.0, 1.5, 2.0]);
    let tenths = scene("*STEP, INC=10\n*STATIC\n0.1, 1.\n*END STEP\n");
    assert_eq!(
        times(&tenths),
        (1..=10).map(|i| f64::from(i) / 10.0).collect::<Vec<_>>()
    );
}

#[test]
fn least_increments_limit_halvings() {
    let halvings = |steps: &[(&str, &str)]| {
        let step = |(card, line): &(&str, &str)| format!("*STEP\n*STATIC{card}\n{line}\n*END STEP\n");
        let deck = steps.iter().map(step).collect::<String>();
        read(&cube(&deck)).expect("deck").step_halving()
    };
    for (line, expected) in [
        ("0.4, 1., 0.05", 3),
        ("0.25, 1., 0.05", 2),
        // no more than CalculiX cuts back; its least one is 1e-5 of the period
        ("0.4, 1., 1e-9", 5),
        ("0.4, 1., 0.", 5),
        ("0.4, 1.", 5),
        ("4e-5, 1.", 2),
        // the increment is the largest one
        ("0.4, 1., 0.1, 0.2", 1),
        ("0.4, 1., 0.4", 0),
        ("0.4, 1., 0.7", 0),
    ] {
        assert_eq!(halvings(&[("", line)]), expected, "{line}");
    }
    assert_eq!(halvings(&[(", DIRECT", "0.4, 1., 0.05")]), 0);
    // each step keeps its own least one
    assert_eq!(halvings(&[("", "0.4, 1., 0.05"), ("", "0.5, 1., 0.2")]), 1);
    assert_eq!(halvings(&[]), 0);
}

/// Slopes of a linear law and of stick are the inverse of compliances; a hard one without a stick slope is exact.
#[test]
fn slopes_of_contact_are_compliances() {
    let compliance = |law: &str| {
        let pair = "*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\nS6, S5\n";
        let scene = scene(&format!("*SURFACE INTERACTION, NAME=I\n{law}{pair}{}", step("")));
        scene.contacts()[0].compliance()
    };
    let linear = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n";
    assert_eq!(
        compliance(&format!("{linear}4e6\n*FRICTION\n0.3, 5e5\n")),
        [0.25e-6, 2e-6]
    );
    // what CalculiX has for springs that pull
    assert_eq!(compliance(&format!("{linear}4e6, 10., 0.1\n")), [0.25e-6, 0.0]);
    let hard = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n*FRICTION\n0.3\n";
    assert_eq!(compliance(hard), [0.0; 2]);
}

/// A force grows to its value over the step, stays in the next, changes along a line, and goes where the deck removes
/// it.
#[test]
fn forces_accumulate_over_steps() {
    let four =
        step("*CLOAD\n27, 3, -8.\n") + &step("") + &step("*CLOAD, OP=MOD\n27, 3, 4.\n") + &step("*CLOAD, OP=NEW\n");
    let found = force_at(&scene(&four), &[0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 9.0]);
    assert_eq!(found, [0.0, -4.0, -8.0, -8.0, -8.0, -2.0, 4.0, 2.0, 0.0, 0.0]);
    // in a step of AMPLITUDE=STEP, too
    let jump = |lines: &str| step(lines).replace("*STEP", "*STEP, AMPLITUDE=STEP");
    let gone = jump("*CLOAD\n27, 3, -8.\n") + &jump("*CLOAD, OP=NEW\n");
    let found = force_at(&scene(&gone), &[0.25, 1.0, 1.5, 2.0]);
    assert_eq!(found, [-8.0, -8.0, -4.0, 0.0]);
    // forces on one node in one step are added
    let twice = step("*CLOAD\n27, 3, -8.\n*CLOAD\nN6, 3, 1.\n");
    let scene = scene(&twice);
    let Some(LoadDensity::NodalForces(forces)) = scene.loads()[0].density() else {
        panic!();
    };
    let sum: f64 = forces.iter().map(|f| f.1[2]).sum();
    assert_eq!((forces.len(), sum), (9, 1.0));
}

/// Times of an amplitude are those of its step, or of all.
#[test]
fn amplitudes() {
    let table = "*AMPLITUDE, NAME=A\n0., 0., 0.5, 1., 1., 0.5\n";
    let step_time = table.to_owned() + &step("") + &step("*CLOAD, AMPLITUDE=A\n27, 3, 2.\n") + &step("");
    let at = [0.5, 1.0, 1.25, 1.5, 2.0, 2.5, 3.0];
    // after its step the force stays as it was at its end
    assert_eq!(force_at(&scene(&step_time), &at), [0.0, 0.0, 1.0, 2.0, 1.0, 1.0, 1.0]);
    let table = "*AMPLITUDE, NAME=A, TIME=TOTAL TIME\n0., 0., 2., 4., 4., 0.\n";
    let total = table.to_owned() + &step("*CLOAD, AMPLITUDE=A\n27, 3, 2.\n") + &step("") + &step("");
    assert_eq!(force_at(&scene(&total), &[0.5, 1.0, 2.0, 3.0]), [2.0, 4.0, 8.0, 4.0]);
    // and is gone with it
    let gone = table.to_owned() + &step("*CLOAD, AMPLITUDE=A\n27, 3, 2.\n") + &step("*CLOAD, OP=NEW\n");
    assert_eq!(force_at(&scene(&gone), &[0.5, 1.0, 1.5, 2.0]), [2.0, 4.0, 0.0, 0.0]);
    // a jump takes the first increment of its step
    let late = table.to_owned() + &step("") + &step("*CLOAD, AMPLITUDE=A\n27, 3, 2.\n");
    assert_eq!(force_at(&scene(&late), &[1.0, 1.25, 1.5, 2.0]), [0.0, 3.0, 6.0, 8.0]);
    // *STEP, AMPLITUDE=STEP: at once
    let at_once = step("*CLOAD\n27, 3, 2.\n").replace("*STEP\n", "*STEP, AMPLITUDE=STEP\n");
    assert_eq!(force_at(&scene(&at_once), &[0.1, 0.5, 1.0]), [2.0; 3]);
}

#[test]
fn supports_move_and_are_grouped_by_set() {
    let two = step("*BOUNDARY\nN6, 3, 3, -0.1\n27, 1\n") + &step("*BOUNDARY\nN6, 3, 3, -0.3\n");
    let scene = scene(&two);
    let (supports, deck) = (scene.supports(), &scene);
    assert_eq!(supports.len(), 3, "{:?}", deck.supports());
    assert!(supports[0].motion().is_none());
    let (values, history) = supports[1].motion().expect("moved");
    assert_eq!(values, [[0.0, 0.0, -0.1]]);
    let at = |t: f64| values[0][2] * history.value(t);
    assert_eq!([at(0.0), at(0.5), at(1.0)], [0.0, -0.05, -0.1]);
    assert!((at(1.5) + 0.2).abs() < 1e-15 && (at(2.0) + 0.3).abs() < 1e-15);
    assert_eq!(supports[2].place(), &Place::Nodes(vec![26]));
    let names = read(&cube(&format!("*BOUNDARY\nN5, 1, 3\n{two}"))).expect("deck");
    assert_eq!(names.support_names(), ["N5", "N6", "nodes"]);
}

/// A support given before the first step may move in it, and go.
#[test]
fn the_first_step_may_change_supports() {
    let moved = step("*BOUNDARY\nN5, 3, 3, 0.5\n");
    let (values, _) = scene(&moved).supports()[0]
        .motion()
        .map(|m| (m.0.to_vec(), ()))
        .expect("moved");
    assert_eq!(values, [[0.0, 0.0, 0.5]]);
    let gone = step("*BOUNDARY, OP=NEW\nN6, ENCASTRE\n");
    let scene = scene(&gone);
    assert_eq!(scene.supports().len(), 1);
    assert!(scene.supports()[0].place() != &Place::Nodes((0..9).collect()));
}

/// Pressure on faces of elements by number, by set, and on a surface is the same load.
#[test]
fn pressures() {
    let mesh = signorini_fem_mesh::Brick::new([1.0; 3], [2, 2, 2])
        .build()
        .expect("brick");
    let top = (0..mesh.facets().len()).filter(|&f| mesh.facets()[f].tag.0 == 6);
    let lines: String = top
        .map(|f| face(&mesh, f))
        .map(|(element, number)| format!("{element}, P{number}, 2.\n"))
        .collect();
    let by_faces = scene(&step(&format!("*DLOAD\n{lines}")));
    let by_surface = scene(&step("*DSLOAD\nS6, P, 2.\n"));
    assert_eq!(by_faces.mesh(), by_surface.mesh());
    let one = |scene: &Scene| match scene.loads() {
        [load] => format!("{load:?}"),
        loads => panic!("{loads:?}"),
    };
    assert_eq!(one(&by_faces), one(&by_surface));
    assert!(one(&by_surface).contains("Pressure(FacetTag(6), 2.0)"));
}

/// A traction in a direction of any length, beside a pressure; the next step gives another direction.
#[test]
fn tractions() {
    for order in [1, 2] {
        let mut mesh = signorini_fem_mesh::Brick::new([1.0; 3], [2, 2, 2])
            .build()
            .expect("brick");
        if order == 2 {
            mesh = mesh.raise_order().expect("order 2");
        }
        let deck = crate::write::mesh(&mesh)
            + crate::write::STEEL
            + "*BOUNDARY\nN5, 1, 3\n"
            + &step("*DSLOAD\nS6, TRVEC, 10., 0., 3., 4.\nS6, P, 1.\n")
            + &step("*DSLOAD\nS6, TRVEC, 5., 2., 0., 0.\n");
        let scene = read(&deck).expect("deck").scene().expect("scene");
        let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
        // two increments a step
        for expected in [[0.0, 6.0, 7.0], [5.0, 0.0, -1.0]] {
            simulation.step().expect("half");
            let reactions = simulation.step().expect("a step").reactions();
            let found = reactions.loads.force;
            assert!((0..3).all(|c| (found[c] - expected[c]).abs() < 1e-12), "{found:?}");
        }
    }
}

/// A plane surface whose edges are curved has the same area in a traction as in a pressure.
#[test]
fn tractions_on_curved_facets() {
    let bent = |[x, y, z]: [f64; 3]| [x, y * (1.0 + x * (1.0 - x)), z];
    let mesh = signorini_fem_mesh::Brick::new([1.0; 3], [2, 2, 2])
        .build()
        .expect("brick");
    let mesh = mesh.raise_order().expect("order 2").map_points(bent).expect("bent");
    let deck = crate::write::mesh(&mesh)
        + crate::write::STEEL
        + "*BOUNDARY\nN5, 1, 3\n"
        + &step("*DSLOAD\nS6, TRVEC, 10., 1., 0., 0.\nS6, P, 10.\n");
    let scene = read(&deck).expect("deck").scene().expect("scene");
    let mut simulation = Simulation::new(scene, Settings::default()).expect("set-up");
    simulation.step().expect("half");
    let force = simulation.step().expect("a step").reactions().loads.force;
    assert!(force[0] > 11.5 && (force[0] + force[2]).abs() < 1e-12, "{force:?}");
}

/// Many different pressures become forces at nodes with the same resultant.
#[test]
fn many_pressures() {
    let mesh = signorini_fem_mesh::Brick::new([1.0; 3], [8, 8, 8])
        .build()
        .expect("brick");
    let top = (0..mesh.facets().len()).filter(|&f| mesh.facets()[f].tag.0 == 6);
    let mut deck = crate::write::mesh(&mesh) + crate::write::STEEL + "*BOUNDARY\nN5, 1, 3\n";
    let (mut lines, mut sum) = (String::from("*DLOAD\n"), 0.0);
    for (i, facet) in top.enumerate() {
        let (element, number) = face(&mesh, facet);
        let pressure = i as f64 + 1.0;
        lines += &format!("{element}, P{number}, {pressure}\n");
        sum += pressure / 128.0;
    }
    deck += &step(&lines);
    let scene = read(&deck).expect("deck").scene().expect("scene");
    let total: f64 = scene
        .loads()
        .iter()
        .map(|load| match load.density() {
            Some(LoadDensity::NodalForces(forces)) => forces.iter().map(|f| f.1[2]).sum::<f64>(),
            _ => panic!("{load:?}"),
        })
        .sum();
    assert!((total + sum).abs() < 1e-12 * sum, "{total} {sum}");
    assert_eq!(scene.mesh().tags().len(), 6 + 1 - 1);
}

/// Gravity is density times acceleration, on a part of the body at its nodes.
#[test]
fn gravity_and_body_forces() {
    let whole = scene(&step("*DLOAD\nALL, GRAV, 1e9, 0., 0., -2.\nALL, BX, 3.\n"));
    let text: Vec<String> = whole
        .loads()
        .iter()
        .flat_map(|l| l.density())
        .map(|d| format!("{d:?}"))
        .collect();
    let weight = 7.8e-9 * 1e9;
    assert_eq!(
        text,
        [
            format!("Body([0.0, 0.0, {:?}])", -weight),
            "Body([3.0, 0.0, 0.0])".into()
        ]
    );
    let part = format!(
        "*ELSET, ELSET=HALF, GENERATE\n1, 20\n{}",
        step("*DLOAD\nHALF, BZ, -6.\n")
    );
    let half = read(&cube(&part)).expect("deck").scene().expect("scene");
    let volume: f64 = (0..20).map(|t| half.mesh().volume(t)).sum();
    let total = |load: &Load| match load.density() {
        Some(LoadDensity::NodalForces(forces)) => forces.iter().map(|f| f.1[2]).sum::<f64>(),
        _ => panic!("{load:?}"),
    };
    assert!((total(&half.loads()[0]) + 6.0 * volume).abs() < 1e-12);
}

#[test]
fn two_materials_are_two_regions() {
    let text = cube("*ELSET, ELSET=A, GENERATE\n1, 20\n*ELSET, ELSET=B, GENERATE\n21, 40\n*MATERIAL, NAME=SOFT\n*ELASTIC, TYPE=ISOTROPIC\n1e3, 0.4\n*SOLID SECTION, MATERIAL=Soft, ELSET=B\n")
        .replace("ELSET=ALL, MATERIAL", "ELSET=A, MATERIAL");
    let deck = read(&text).expect("deck");
    assert_eq!(deck.mesh().regions(), [[0; 20], [1; 20]].concat());
    let scene = deck.scene().expect("scene");
    let soft = signorini_fem_mesh::Hooke::isotropic(1e3, 0.4).expect("soft");
    assert_eq!(scene.materials().get(1).expect("region 1"), &soft);
}

/// Isotropic steel as orthotropic, and engineering constants as their compliance says.
#[test]
fn orthotropic_laws() {
    let law = |card: &str| {
        let text = cube("").replace("*ELASTIC\n2.1e5, 0.3\n", card);
        let scene = read(&text).expect("deck").scene().expect("scene");
        *scene.materials().get(0).expect("region 0")
    };
    let steel = signorini_fem_mesh::Hooke::isotropic(2.1e5, 0.3).expect("steel");
    let near = |a: &signorini_fem_mesh::Hooke, b: &signorini_fem_mesh::Hooke| {
        let pairs = a.voigt().iter().flatten().zip(b.voigt().iter().flatten());
        pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-9 * 2.1e5)
    };
    let c = steel.voigt();
    let ortho = format!(
        "*ELASTIC, TYPE=ORTHO\n{:?}, {:?}, {:?}, {:?}, {:?}, {:?}, {:?}, {:?},\n{:?}, 20.\n",
        c[0][0], c[0][1], c[1][1], c[0][2], c[1][2], c[2][2], c[5][5], c[4][4], c[3][3]
    );
    assert!(near(&law(&ortho), &steel));
    let shear = 2.1e5 / 2.6;
    let constants = format!(
        "*ELASTIC, TYPE=ENGINEERING CONSTANTS\n2.1e5, 2.1e5, 2.1e5, 0.3, 0.3, 0.3, {shear}, {shear}\n{shear}\n"
    );
    assert!(near(&law(&constants), &steel));
    // a stress along each axis strains as the constants say
    let wood = law("*ELASTIC, TYPE=ENGINEERING CONSTANTS\n10., 2., 1., 0.4, 0.3, 0.2, 0.7, 0.6\n0.5\n");
    for (strain, stress) in [
        ([0.1, -0.04, -0.03, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        ([-0.04, 0.5, -0.1, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0, 0.0, 0.0]),
        ([-0.03, -0.1, 1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0, 0.0, 0.0]),
        ([0.0, 0.0, 0.0, 2.0, 1.0, 1.0], [0.0, 0.0, 0.0, 1.0, 0.6, 0.7]),
    ] {
        let found = wood.stress(&strain);
        assert!((0..6).all(|i| (found[i] - stress[i]).abs() < 1e-12), "{found:?}");
    }
}

/// A pressure on a part of a contact surface: its faces have tags of their own, and the contact has both.
#[test]
fn pressure_on_a_part_of_a_contact_surface() {
    let mesh = signorini_fem_mesh::Brick::new([1.0; 3], [2, 2, 2]);
    let mesh = mesh.build().expect("brick");
    let on_side = (0..mesh.facets().len()).find(|&f| mesh.facets()[f].tag.0 == 2);
    let (element, number) = face(&mesh, on_side.expect("a facet"));
    let contact = "*SURFACE INTERACTION, NAME=I\n*CONTACT PAIR, INTERACTION=I\nS2, S1\n";
    let text = contact.to_owned() + &step(&format!("*DLOAD\n{element}, P{number}, 2.\n"));
    let scene = scene(&text);
    assert_eq!(scene.contacts()[0].tags().len(), 2);
    assert_eq!(scene.mesh().tags().len(), 7);
    let Some(LoadDensity::Pressure(tag, value)) = scene.loads()[0].density() else {
        panic!("{:?}", scene.loads());
    };
    assert_eq!((scene.mesh().nodes_on(*tag).len(), *value), (3, 2.0));
    assert!(scene.contacts()[0].tags().contains(tag));
}
