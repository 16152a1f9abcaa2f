//! The same scene by a program and by a deck gives the same bits.

use signorini_contact::{Analysis, Contact, DifferenceFormula, Friction, Load, Scene, Settings, Simulation, Support};
use signorini_fem_mesh::{Brick, FacetTag, History, Hooke, LoadDensity, Materials, TetMesh, brick};

use crate::write;

/// Compares all steps: displacements of all copies and the states of contact points.
pub(crate) fn compare(deck: &str, program: Scene) {
    let deck = write::read(deck).expect("deck");
    assert_eq!(deck.mesh().points(), program.mesh().points());
    assert_eq!(deck.mesh().tets(), program.mesh().tets());
    let scene = deck.scene().expect("a scene");
    assert_eq!(scene.materials(), program.materials());
    assert_eq!(scene.analysis(), program.analysis());
    let [mut by_deck, mut by_program] =
        [scene, program].map(|s| Simulation::new(s, Settings::default()).expect("simulation"));
    while !by_program.is_finished() {
        let (a, b) = (by_deck.step().expect("a"), by_program.step().expect("b"));
        assert!(a.report().status.converged());
        assert_eq!(a.time(), b.time());
        assert_eq!(a.torn_displacement(), b.torn_displacement());
        assert_eq!(a.points(), b.points());
    }
    assert!(by_deck.is_finished());
}

pub(crate) fn steel() -> Materials {
    Materials::uniform(Hooke::isotropic(2.1e5, 0.3).expect("steel"))
}

fn upper(tag: FacetTag) -> FacetTag {
    FacetTag(tag.0 + 10)
}

/// A block on a longer one, tags of the upper one 10 larger.
fn two() -> TetMesh {
    let lower = Brick::new([3.0, 1.0, 1.0], [6, 2, 2]).build().expect("brick");
    let block = Brick::new([1.0; 3], [2, 2, 2]).with_origin([1.0, 0.0, 1.0]);
    let block = block.build().expect("brick").map_tags(upper);
    lower.append(&block).expect("two bodies")
}

#[test]
fn a_brick_under_pressure_and_gravity() {
    let mesh = Brick::new([3.0, 1.0, 1.0], [6, 2, 2]).build().expect("brick");
    let deck = write::mesh(&mesh)
        + write::STEEL
        + "*BOUNDARY\nN1, 1, 3\n*STEP\n*STATIC\n*DSLOAD\nS6, P, 2.5\n*DLOAD\nALL, GRAV, 9810., 0., 0., -1.\n*END STEP\n";
    let ramp = History::ramp(1.0, 1.0).expect("ramp");
    let program = Scene::new(mesh, steel())
        .with_support(Support::fixed(brick::X_MIN))
        .with_load(Load::pressure(brick::Z_MAX, 2.5).with_history(ramp.clone()))
        .with_load(Load::body([0.0, 0.0, -9810.0 * 7.8e-9]).with_history(ramp))
        .with_analysis(Analysis::statics());
    assert_eq!((brick::X_MIN.0, brick::Z_MAX.0), (1, 6));
    compare(&deck, program);
}

#[test]
fn two_bodies_with_friction_and_an_amplitude() {
    let mesh = two();
    let deck = write::mesh(&mesh)
        + write::STEEL
        + "*SURFACE INTERACTION, NAME=ROUGH\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n*FRICTION\n0.3\n"
        + "*CONTACT PAIR, INTERACTION=ROUGH\nS15, S6\n"
        + "*AMPLITUDE, NAME=BACK\n0., 0., 0.5, 1., 1., -0.25\n"
        + "*BOUNDARY\nN5, 1, 3\n*STEP\n*STATIC\n0.25, 1.\n*DSLOAD\nS16, P, 3.\n*CLOAD, AMPLITUDE=BACK\nN12, 1, 0.02\n*END STEP\n";
    let back = vec![(0.0, 0.0), (0.5, 1.0), (1.0, -0.25)];
    let forces = mesh.nodes_on(upper(brick::X_MAX)).into_iter();
    let pull = LoadDensity::NodalForces(forces.map(|n| (n, [0.02, 0.0, 0.0])).collect());
    let program = Scene::new(mesh, steel())
        .with_support(Support::fixed(brick::Z_MIN))
        .with_load(Load::pressure(upper(brick::Z_MAX), 3.0).with_history(History::ramp(1.0, 1.0).expect("ramp")))
        .with_load(Load::new(pull).with_history(History::table(back).expect("table")))
        .with_contact(Contact::between(upper(brick::Z_MIN), brick::Z_MAX).with_friction(Friction::coulomb(0.3)))
        .with_analysis(Analysis::quasistatic(1.0, 4).with_formula(DifferenceFormula::BACKWARD_EULER));
    compare(&deck, program);
}

/// Pressed in the first step, dragged in the second.
#[test]
fn two_steps() {
    let mesh = two();
    let deck = write::mesh(&mesh)
        + write::STEEL
        + "*SURFACE INTERACTION, NAME=ROUGH\n*FRICTION\n0.2\n*CONTACT PAIR, INTERACTION=ROUGH\nS15, S6\n"
        + "*BOUNDARY\nN5, 1, 3\n"
        + "*STEP\n*STATIC\n0.5, 1.\n*BOUNDARY\nN16, 1\nN16, 2\nN16, 3, 3, -1e-4\n*END STEP\n"
        + "*STEP\n*STATIC\n0.25, 1.\n*BOUNDARY\nN16, 1, 1, 2e-4\n*END STEP\n";
    let drag = vec![(0.0, 0.0), (1.0, 0.0), (2.0, 1.0)];
    let times = vec![0.5, 1.0, 1.25, 1.5, 1.75, 2.0];
    let top = upper(brick::Z_MAX);
    let program = Scene::new(mesh, steel())
        .with_support(Support::fixed(brick::Z_MIN))
        .with_support(
            Support::components(top, [true, false, false])
                .with_motion([2e-4, 0.0, 0.0], History::table(drag).expect("table")),
        )
        .with_support(
            Support::components(top, [false, true, true])
                .with_motion([0.0, 0.0, -1e-4], History::ramp(1.0, 1.0).expect("ramp")),
        )
        .with_contact(Contact::between(upper(brick::Z_MIN), brick::Z_MAX).with_friction(Friction::coulomb(0.2)))
        .with_analysis(Analysis::Quasistatic {
            times,
            formula: DifferenceFormula::BACKWARD_EULER,
        });
    compare(&deck, program);
}

/// A block of 1 m on a rigid plane that presses it from below and is dragged.
fn on_a_plane(floor: &str) {
    let mesh = Brick::new([1.0; 3], [3, 3, 3])
        .with_origin([0.0, 0.0, 0.5])
        .build()
        .expect("brick");
    let deck = write::mesh(&mesh)
        + write::STEEL
        + floor
        + "*SURFACE INTERACTION, NAME=ROUGH\n*FRICTION\n0.25\n*CONTACT PAIR, INTERACTION=ROUGH\nS5, PLANE\n"
        + "*BOUNDARY\nN6, PINNED\n999, ENCASTRE\n"
        + "*STEP\n*STATIC\n1., 1.\n*BOUNDARY\n999, 3, 3, 0.51\n999, 1, 1, 0.02\n*END STEP\n"
        + "*STEP\n*STATIC\n1., 1.\n*END STEP\n";
    let ramp = History::ramp(1.0, 1.0).expect("ramp");
    let program = Scene::new(mesh, steel())
        .with_support(Support::fixed(brick::Z_MAX))
        .with_contact(
            Contact::half_space(brick::Z_MIN, [0.0; 3], [0.0, 0.0, 1.0])
                .with_motion([0.02, 0.0, 0.51], ramp)
                .with_friction(Friction::coulomb(0.25)),
        )
        .with_analysis(Analysis::quasistatic(2.0, 2).with_formula(DifferenceFormula::BACKWARD_EULER));
    compare(&deck, program);
}

#[test]
fn a_rigid_plane_of_facets() {
    on_a_plane(
        "*NODE\n991, -1., -1.\n992, 2., -1.\n993, 2., 2.\n994, -1., 2.\n999\n\
        *ELEMENT, TYPE=R3D4, ELSET=FLOOR\n991, 994, 993, 992, 991\n*NSET, NSET=REF\n999\n\
        *RIGID BODY, REF NODE=REF, ELSET=FLOOR\n*SURFACE, NAME=PLANE\nFLOOR, SNEG\n",
    );
    on_a_plane(
        "*NODE\n991, -1., -1.\n992, 2., -1.\n993, 2., 2.\n994, -1., 2.\n999\n\
        *ELEMENT, TYPE=R3D3, ELSET=FLOOR\n991, 991, 992, 993\n992, 991, 993, 994\n\
        *RIGID BODY, REF NODE=999, ELSET=FLOOR\n*SURFACE, NAME=PLANE\nFLOOR, SPOS\n",
    );
}

/// A rigid body of solid elements, whose rotation is that of another node, as CalculiX has it.
#[test]
fn a_rigid_body_of_solids() {
    let floor = "*NODE\n991, -2., -2.\n992, 4., -2.\n993, -2., 4.\n994, 0., 0., -1.\n998\n999\n\
        *ELEMENT, TYPE=C3D4, ELSET=FLOOR\n991, 991, 993, 992, 994\n*BOUNDARY\n998, 1, 3\n\
        *RIGID BODY, REF NODE=999, ROT NODE=998, ELSET=FLOOR\n*SURFACE, NAME=PLANE\nFLOOR, S1\n";
    on_a_plane(floor);
}

/// The deck that the documents and the example use.
#[test]
fn the_pad_on_a_rail() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/decks/pad.inp");
    let deck = signorini_deck::Deck::read(path).expect("deck");
    assert_eq!(
        (deck.ignored().len(), deck.support_names()),
        (2, &["RAIL_BOTTOM", "PAD_SIDE"].map(String::from)[..])
    );
    let scene = deck.scene().expect("scene");
    let mut simulation = Simulation::new(scene, Settings::default()).expect("simulation");
    assert_eq!(simulation.scene().analysis().steps(), 5);
    while !simulation.is_finished() {
        let step = simulation.step().expect("step");
        assert!(step.report().status.converged());
        assert!((step.summary().normal_force - 1e4).abs() < 0.1);
        // 1800 N of 2000 N that friction can hold
        let push = step.summary().resultant[0];
        assert!((push + 1800.0 * (step.time() - 1.0)).abs() < 0.1, "{push}");
    }
}

/// A block that is tied on a coarser one.
#[test]
fn tied_blocks_of_unequal_meshes() {
    let below = signorini_fem_mesh::Brick::new([1.0; 3], [2, 2, 2])
        .build()
        .expect("brick");
    let above = signorini_fem_mesh::Brick::new([1.0; 3], [3, 3, 3])
        .build()
        .expect("brick");
    let above = above.map_points(|[x, y, z]| [x, y, z + 1.0]).expect("lifted");
    let mesh = below.append(&above.map_tags(upper)).expect("two");
    let deck = write::mesh(&mesh)
        + write::STEEL
        + "*TIE, NAME=GLUE, ADJUST=NO\nS15, S6\n*BOUNDARY\nN5, 1, 3\n*STEP\n*STATIC\n*DSLOAD\nS16, P, -3.\n*END STEP\n";
    let program = Scene::new(mesh, steel())
        .with_support(Support::fixed(brick::Z_MIN))
        .with_load(Load::pressure(upper(brick::Z_MAX), -3.0).with_history(History::ramp(1.0, 1.0).expect("ramp")))
        .with_contact(Contact::tied(upper(brick::Z_MIN), brick::Z_MAX))
        .with_analysis(Analysis::statics());
    compare(&deck, program);
}
