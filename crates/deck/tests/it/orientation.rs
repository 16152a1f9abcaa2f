//! Axes of materials.

use signorini_contact::{Settings, Simulation};
use signorini_fem_mesh::Brick;
use signorini_fem_mesh::vec3::{norm, sub};

use crate::refusals;
use crate::write::{mesh, read};

const WOOD: &str = "*MATERIAL, NAME=WOOD\n*ELASTIC, TYPE=ENGINEERING CONSTANTS\n11000., 900., 450., 0.37, 0.42, 0.47, \
    690., 620.\n60.\n*EXPANSION, TYPE=ORTHO\n4e-6, 3e-5, 5e-5\n";

const SECTION: &str = "*SOLID SECTION, ELSET=ALL, MATERIAL=WOOD, ORIENTATION=GRAIN\n";

/// A bar of wood whose grain runs obliquely, pulled, warmed, and both; with axes by points, and turned about one of
/// them: displacements as CalculiX 2.20 prints them.
#[test]
fn a_bar_of_wood_strains_as_in_calculix() {
    let bar = Brick::new([4.0, 1.0, 1.0], [8, 2, 2]).build().expect("a bar");
    let bar = bar.raise_order().expect("quadratic");
    let points = "*ORIENTATION, NAME=GRAIN\n1., 0.5, 0.2, -0.4, 1., 0.3\n";
    let turned = "*ORIENTATION, NAME=GRAIN, SYSTEM=RECTANGULAR\n1., 0.5, 0.2, -0.4, 1., 0.3\n3, 25.\n";
    let pull = "*CLOAD\nN2, 1, 10.\n";
    let warm = "*TEMPERATURE\nALLN, 40.\n";
    let cases = [
        (
            points,
            pull,
            [
                [4.943872e-1, -3.838954e-1, -2.244059e-1],
                [4.803564e-1, -6.010758e-1, -2.650243e-1],
                [4.818712e-1, -4.517354e-1, -3.986453e-1],
            ],
        ),
        (
            turned,
            pull,
            [
                [9.779717e-1, -3.442038e-1, -3.974833e-1],
                [1.066131, -5.782019e-1, -3.912223e-1],
                [1.047424, -3.936375e-1, -6.461362e-1],
            ],
        ),
        (
            turned,
            warm,
            [
                [3.505590e-3, -3.260290e-3, -1.921176e-3],
                [3.378195e-3, -2.582439e-3, -2.403484e-3],
                [3.432476e-3, -3.654006e-3, -6.767806e-5],
            ],
        ),
    ];
    for (axes, loads, printed) in cases {
        let deck = format!(
            "{}*NSET, NSET=ALLN, GENERATE\n1, {}\n{WOOD}{axes}{SECTION}\
             *INITIAL CONDITIONS, TYPE=TEMPERATURE\nALLN, 0.\n*BOUNDARY\nN1, 1, 3\n*STEP\n*STATIC\n{loads}*END STEP\n",
            mesh(&bar),
            bar.points().len()
        );
        let settings = Settings::default().with_tolerance(1e-9);
        let scene = read(&deck).expect("deck").scene().expect("scene");
        let mut simulation = Simulation::new(scene, settings).expect("simulation");
        let result = simulation.step().expect("solved");
        let places = [[4.0, 0.0, 0.0], [4.0, 1.0, 0.0], [4.0, 0.0, 1.0]];
        for (place, expected) in places.into_iter().zip(printed) {
            let node = bar.points().iter().position(|x| *x == place).expect("a node");
            let found = result.displacement()[node];
            assert!(
                norm(sub(found, expected)) < 1e-6 * norm(expected),
                "{loads}: {place:?} {found:?} {expected:?}"
            );
        }
    }
}

/// Axes mean nothing to an isotropic material, also cylindrical ones.
#[test]
fn isotropic_materials_have_no_axes() {
    let steel = "*MATERIAL, NAME=WOOD\n*ELASTIC\n2.1e5, 0.3\n*EXPANSION\n1e-5\n";
    for axes in ["", ", SYSTEM=CYLINDRICAL"] {
        let axes = format!("*ORIENTATION, NAME=GRAIN{axes}\n0., 0., 1., 0., 1., 0.\n");
        let bar = Brick::new([1.0; 3], [1; 3]).build().expect("a bar");
        let deck = read(&(mesh(&bar) + steel + &axes + SECTION)).expect("deck");
        let scene = deck.scene().expect("scene");
        let law = scene.materials().get(0).expect("a law");
        assert!(law.poisson().is_some_and(|p| (p - 0.3).abs() < 1e-12));
    }
}

#[test]
fn what_is_refused() {
    let refused = |axes: &str, line: &str, word: &str, part: &str| {
        let bar = Brick::new([1.0; 3], [1; 3]).build().expect("a bar");
        refusals::refused(&(mesh(&bar) + WOOD + axes + SECTION), line, word, part);
    };
    let card = "*ORIENTATION, NAME=GRAIN";
    let of = |lines: &str| format!("{card}\n{lines}\n");
    refused("", SECTION.trim(), "ORIENTATION=GRAIN", "orientation");
    refused(
        &of("1., 0., 0., 2., 0., 0."),
        "1., 0., 0., 2., 0., 0.",
        "1., 0., 0., 2., 0., 0.",
        "in line",
    );
    let rounded = "1., 3., 7., 1.1, 3.3, 7.7";
    refused(&of(rounded), rounded, rounded, "in line");
    let bar = Brick::new([1.0; 3], [1; 3]).build().expect("a bar");
    let steel = "*MATERIAL, NAME=WOOD\n*ELASTIC\n2.1e5, 0.3\n";
    let unknown = mesh(&bar) + steel + SECTION;
    refusals::refused(&unknown, SECTION.trim(), "ORIENTATION=GRAIN", "orientation");
    refused(&of("1., 0., 0., 0., 1., 0.\n4, 30."), "4, 30.", "4", "1, 2 or 3");
    refused(&of("1., 0., 0., 0., x, 0."), "1., 0., 0., 0., x, 0.", "x", "two points");
    refused(&format!("{card}\n"), card, "*ORIENTATION", "two points");
    let round = "*ORIENTATION, NAME=GRAIN, SYSTEM=CYLINDRICAL";
    refused(
        &format!("{round}\n0., 0., 0., 0., 0., 1.\n"),
        round,
        "*ORIENTATION",
        "isotropic materials only",
    );
    let ball = "*ORIENTATION, NAME=GRAIN, SYSTEM=SPHERICAL";
    refused(
        &format!("{ball}\n0., 0., 0., 0., 0., 1.\n"),
        ball,
        "SYSTEM=SPHERICAL",
        "SYSTEM=CYLINDRICAL",
    );
    let both = format!("{card}\n1., 0., 0., 0., 1., 0.\n{card}\n0., 1., 0., 0., 0., 1.\n");
    refused(&both, card, "*ORIENTATION", "there already");
}

/// Axes of a material that is not isotropic would turn with an instance.
#[test]
fn parts_have_materials_along_x_y_and_z() {
    let bar = Brick::new([1.0; 3], [1; 3]).build().expect("a bar");
    let deck = |section: &str, place: &str| {
        format!(
            "*PART, NAME=P\n{}*SOLID SECTION, ELSET=ALL, MATERIAL=WOOD{section}\n*END PART\n*ASSEMBLY, NAME=A\n\
             *INSTANCE, NAME=I, PART=P\n{place}*END INSTANCE\n*END ASSEMBLY\n{WOOD}",
            mesh(&bar)
        )
    };
    let turn = "0., 0., 0.\n0., 0., 0., 0., 0., 1., 90.\n";
    assert!(read(&deck("", "1., 0., 0.\n")).is_ok() && read(&deck("", &turn.replace("90.", "0."))).is_ok());
    let error = read(&deck("", turn)).expect_err("turned").to_string();
    assert!(
        error.contains("*INSTANCE") && error.contains("behind the assembly"),
        "{error}"
    );
    let named = deck(", ORIENTATION=GRAIN", "");
    let line = "*SOLID SECTION, ELSET=ALL, MATERIAL=WOOD, ORIENTATION=GRAIN";
    refusals::refused(&named, line, "ORIENTATION=GRAIN", "not read in parts");
    let steel = deck("", turn).replace(WOOD, "*MATERIAL, NAME=WOOD\n*ELASTIC\n2.1e5, 0.3\n");
    assert!(read(&steel).is_ok());
}

/// A tetrahedron of a material whose 21 constants all differ: the forces that CalculiX 2.20 prints.
#[test]
fn any_law_has_the_forces_of_calculix() {
    let deck = "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n*NSET, NSET=A\n2\n*NSET, NSET=B\n3\n*NSET, NSET=C\n4\n\
        *NSET, NSET=D\n1\n*ELEMENT, TYPE=C3D4, ELSET=ALL\n1, 1, 2, 3, 4\n*MATERIAL, NAME=M\n*ELASTIC, TYPE=ANISO\n\
        300000., 110000., 320000., 130000., 140000., 350000., 160000., 170000.\n\
        180000., 390000., 200000., 210000., 220000., 230000., 440000., 250000.\n\
        260000., 270000., 280000., 290000., 500000.\n\
        *ORIENTATION, NAME=AXES, DEFINITION=COORDINATES\n1, 0, 0, 0, 1, 0\n\
        *SOLID SECTION, ELSET=ALL, MATERIAL=M, ORIENTATION=AXES\n*BOUNDARY\nD, 1, 3\n*STEP\n*STATIC\n*BOUNDARY\n\
        A, 1, 1, 1e-3\nA, 2, 2, 2e-3\nA, 3, 3, -1e-3\nB, 1, 1, 3e-3\nB, 2, 2, -2e-3\nB, 3, 3, 1.5e-3\n\
        C, 1, 1, -1e-3\nC, 2, 2, 2.5e-3\nC, 3, 3, 0.7e-3\n*END STEP\n";
    let read = read(deck).expect("deck");
    let mut simulation = Simulation::new(read.scene().expect("scene"), Settings::default()).expect("set-up");
    let reactions = simulation.step().expect("a step").reactions().supports;
    let printed = [
        ("D", [-9.151667e2, -1.055500e3, -9.563333e2]),
        ("A", [2.618333e2, 4.260000e2, 2.273333e2]),
        ("B", [4.260000e2, 1.730000e2, 4.565000e2]),
        ("C", [2.273333e2, 4.565000e2, 2.725000e2]),
    ];
    assert_eq!(read.support_names().len(), printed.len());
    for (name, force) in printed {
        let at = read
            .support_names()
            .iter()
            .position(|own| own == name)
            .expect("a support");
        let off = norm(sub(reactions[at].resultant.force, force));
        assert!(off < 1e-6 * norm(force), "{name}: {:?}", reactions[at].resultant.force);
    }
}
