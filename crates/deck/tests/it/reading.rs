//! How decks are written: cases, blanks, line ends, continuation, comments, included files, sets of sets.

use signorini_contact::Directions;
use signorini_deck::Deck;
use signorini_fem_mesh::FacetTag;

use crate::write::{STEEL, cube, folder, mesh, read};

const TWO: &str = "*NODE
 10, 0., 0., 0.
 20, 1., 0., 0.
 30, 0., 1., 0.
 40, 0., 0., 1.
 50, 1., 1., 1.
 70, 9., 9., 9.
*ELEMENT, TYPE=C3D4, ELSET=ALL
 5, 10, 20, 30, 40
 7, 20, 30, 40, 50
";

fn same(text: &str) {
    let (wanted, found) = (read(TWO).expect("deck"), read(text).expect("deck"));
    assert_eq!(wanted.mesh(), found.mesh());
    assert_eq!(wanted.node_numbers(), found.node_numbers());
}

#[test]
fn the_way_of_writing_does_not_matter() {
    same(&TWO.replace('\n', "\r\n"));
    same(&TWO.to_lowercase());
    same(&TWO.replace("*NODE", "** a comment\n\n *Node \n** another\n"));
    same(&TWO.replace(
        "*ELEMENT, TYPE=C3D4, ELSET=ALL",
        "*element ,\n elset = all ,\n** no\ntype=c3d4",
    ));
    same(&TWO.replace(" 5, 10, 20, 30, 40", "5,10,20,\n30,40"));
    same(&TWO.replace(" 5, 10, 20, 30, 40", "5,10,20\n30,40"));
    same(&TWO.replace("*NODE", "*NODE,").replace("=ALL", "=ALL,"));
    same(&TWO.replace("0., 0., 0.", ",").replace("1., 0., 0.", "1.D0,"));
    same(&format!("\u{feff}*HEADING\nany text, with = signs\nand more\n{TWO}"));
    let latin = TWO.replace("*NODE", "** caf\u{e9}\n*NODE").into_bytes();
    let latin: Vec<u8> = latin.into_iter().filter(|b| *b != 0xc3).collect();
    let (_folder, path) = folder(&[("part.inp", "")]);
    std::fs::write(&path, latin).expect("written");
    assert_eq!(Deck::read(path).expect("deck").mesh(), read(TWO).expect("deck").mesh());
}

#[test]
fn numbers_are_arbitrary_and_unused_nodes_go() {
    let deck = read(TWO).expect("deck");
    assert_eq!(deck.node_numbers(), [10, 20, 30, 40, 50]);
    assert_eq!(deck.element_numbers(), [5, 7]);
    assert_eq!((deck.node(50), deck.node(70), deck.node(1)), (Some(4), None, None));
    assert_eq!(deck.mesh().points()[1], [1.0, 0.0, 0.0]);
}

#[test]
fn sets() {
    let sets = "*NSET, NSET=A, GENERATE
10, 30, 10
*NSET, NSET=B
70, A,
50
*Nset, nset=\"c d\", internal
b, 40
*NSET, NSET=EVEN, GENERATE
1, 100, 20
*NSET, NSET=A
50
*ELSET, ELSET=E
7
*ELSET, ELSET=F, GENERATE
5, 7
";
    // 1, 21, 41, ... are no nodes: refused; 10, 30, 50 are
    assert!(read(&format!("{TWO}{sets}")).is_err());
    let deck = read(&format!("{TWO}{}", sets.replace("1, 100, 20", "10, 60, 20"))).expect("deck");
    assert_eq!(deck.node_set("A").expect("A"), [0, 1, 2, 4]);
    assert_eq!(deck.node_set("b").expect("B"), [0, 1, 2, 4]);
    assert_eq!(deck.node_set("\"C d\"").expect("c d"), [0, 1, 2, 3, 4]);
    assert_eq!(deck.node_set("Even").expect("EVEN"), [0, 2, 4]);
    assert_eq!(deck.element_set("E").expect("E"), [1]);
    assert_eq!(deck.element_set("F").expect("F"), [0, 1]);
    assert_eq!(deck.element_set("ALL").expect("ALL"), [0, 1]);
    let names: Vec<&str> = deck.node_sets().collect();
    assert_eq!(names, ["A", "B", "C D", "EVEN"]);
    assert_eq!(deck.element_sets().count(), 3);
}

#[test]
fn surfaces_that_overlap_share_tags() {
    let surfaces = "*SURFACE, NAME=ONE, TYPE=ELEMENT\n5, S1\n5, S2\n*SURFACE, NAME=TWO\n5, S2\nE, S4\n*ELSET, ELSET=E\n7\n*SURFACE, NAME=SAME\n5, S2\n5, S1\n";
    let deck = read(&format!("{TWO}{surfaces}")).expect("deck");
    let [first, both, second] = [1, 2, 3].map(FacetTag);
    assert_eq!(deck.surface("one").expect("ONE"), [first, both]);
    assert_eq!(deck.surface("Two").expect("TWO"), [both, second]);
    assert_eq!(deck.surface("SAME").expect("SAME"), [first, both]);
    assert_eq!(deck.mesh().facets().len(), 3);
    assert_eq!(deck.surfaces().collect::<Vec<_>>(), ["ONE", "TWO", "SAME"]);
}

#[test]
fn files_are_included_where_they_stand() {
    let (nodes, elements) = TWO.split_at(TWO.find("*ELEMENT").expect("elements"));
    let (head, data) = nodes.split_at(6);
    let main = format!("{head}*INCLUDE, INPUT=Sub/nodes.txt\n{elements}");
    let (folder, path) = folder(&[("part.inp", &main)]);
    std::fs::create_dir(folder.path().join("Sub")).expect("folder");
    let write = |name: &str, text: &str| {
        std::fs::write(folder.path().join(name), text).expect("written");
    };
    // relative to the file that includes
    write("Sub/nodes.txt", "** data only\n*Include, Input=\"more.txt\"\n");
    write("Sub/more.txt", data);
    let deck = Deck::read(path).expect("deck");
    assert_eq!(deck.mesh(), read(TWO).expect("deck").mesh());
    write("Sub/more.txt", &data.replace("40, 0.", "40, zero"));
    let error = Deck::read(folder.path().join("part.inp")).expect_err("a word");
    let location = error.location().expect("a place");
    assert!(location.file.ends_with("Sub/more.txt") && location.line == 4, "{error}");
}

#[test]
fn what_is_ignored_is_reported() {
    let rest = "*SURFACE INTERACTION, NAME=I\n1.,\n*FRICTION, SLIP TOLERANCE=0.005\n0.3, 1e5\n\
        *SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n*PREPRINT, ECHO=NO\n*STEP, UNSYMM=YES, NAME=a\n\
        *STATIC, SOLVER=PARDISO\n*NODE FILE, FREQUENCY=1\nU, RF\n*EL FILE\nS\n*NODE PRINT, NSET=N1\nU\n\
        *EL PRINT, ELSET=ALL\nS\n*CONTACT FILE\nCSTR\n*CONTROLS, PARAMETERS=CONTACT\n1,\n\
        *OUTPUT, FIELD\n*RESTART, WRITE\n*END STEP\n";
    let deck = read(&cube(rest)).expect("deck");
    let words: Vec<&str> = deck.ignored().iter().map(|i| i.word.as_str()).collect();
    let wanted = [
        "1.,",
        "SLIP TOLERANCE=0.005",
        "1e5",
        "*PREPRINT",
        "UNSYMM=YES",
        "SOLVER=PARDISO",
        "*NODE FILE",
        "*EL FILE",
        "*NODE PRINT",
        "*EL PRINT",
        "*CONTACT FILE",
        "*CONTROLS",
        "*OUTPUT",
        "*RESTART",
    ];
    assert_eq!(words, wanted);
    let first = deck.ignored()[0].to_string();
    assert!(first.contains("part.inp:") && first.contains("ignored"), "{first}");
}

/// What asks nothing of a static solution: settings of other solvers, constants of other analyses, variants of
/// elements.
#[test]
fn what_asks_nothing_is_reported() {
    let rest = "*NSET, NSET=Q, UNSORTED\n3, 2\n*PHYSICAL CONSTANTS, ABSOLUTE ZERO=-273.15\n*SECTION CONTROLS, NAME=EC\n1.\n\
        *MATERIAL, NAME=M\n*CONDUCTIVITY\n50.\n*SPECIFIC HEAT\n4e8\n*DAMPING, ALPHA=1.\n*SURFACE INTERACTION, NAME=I\n\
        *SURFACE BEHAVIOR, AUGMENTED LAGRANGE, PENALTY\n*FRICTION, LAGRANGE\n0.3\n\
        *CONTACT PAIR, INTERACTION=I, MECHANICAL CONSTRAINT=PENALTY, NO THICKNESS\nS1, S2\n\
        *STEP, EXTRAPOLATION=PARABOLIC, CONVERT SDI=NO\n*STATIC, STABILIZE, FACTOR=0.1, ALLSDTOL=0.05\n\
        *CONTACT CONTROLS, STABILIZE=1\n*FILTER, NAME=F\n*END STEP\n";
    let text = cube(rest).replace("TYPE=C3D4", "TYPE=C3D4H");
    let text = text.replace("ELSET=ALL, MATERIAL", "ELSET=ALL, CONTROLS=EC, MATERIAL");
    let deck = read(&text).expect("deck");
    assert_eq!(deck.node_set("Q").expect("a set"), [1, 2]);
    let mut words: Vec<&str> = deck.ignored().iter().map(|i| i.word.as_str()).collect();
    words.sort_unstable();
    let wanted = [
        "*CONDUCTIVITY",
        "*CONTACT CONTROLS",
        "*DAMPING",
        "*FILTER",
        "*PHYSICAL CONSTANTS",
        "*SECTION CONTROLS",
        "*SPECIFIC HEAT",
        "ALLSDTOL=0.05",
        "AUGMENTED LAGRANGE",
        "CONTROLS=EC",
        "CONVERT SDI=NO",
        "EXTRAPOLATION=PARABOLIC",
        "FACTOR=0.1",
        "LAGRANGE",
        "MECHANICAL CONSTRAINT=PENALTY",
        "NO THICKNESS",
        "PENALTY",
        "STABILIZE",
        "TYPE=C3D4H",
        "UNSORTED",
    ];
    assert_eq!(words, wanted);
}

/// Symmetry and its contrary by name.
#[test]
fn conditions_by_name() {
    for (name, on) in [
        ("XSYMM", [true, false, false]),
        ("XASYMM", [false, true, true]),
        ("YASYMM", [true, false, true]),
        ("ZASYMM", [true, true, false]),
    ] {
        let deck = read(&cube(&format!("*BOUNDARY\nN5, {name}\n"))).expect("deck");
        let scene = deck.scene().expect("scene");
        assert_eq!(scene.supports()[0].directions(), &Directions::Components(on), "{name}");
    }
}

#[test]
fn a_deck_without_steps_is_a_scene_to_add_to() {
    let deck = read(&cube("*BOUNDARY\nN5, 1, 3\n")).expect("deck");
    let scene = deck.scene().expect("scene");
    assert_eq!((scene.supports().len(), scene.loads().len()), (1, 0));
    assert_eq!(deck.support_names(), ["N5"]);
    // blanks in the data of a section, as Abaqus/CAE writes it
    let text = cube("").replace(STEEL, &STEEL.replace("MATERIAL=STEEL\n", "MATERIAL=STEEL\n,\n"));
    assert!(read(&text).expect("deck").scene().is_ok());
}

/// As PrePoMax writes it: cards that only remove, all six components of solids, one face number a set.
#[test]
fn a_deck_of_a_user_interface() {
    let steps = |pressure: &str| {
        format!(
            "** Steps\n*Step, Inc=100\n*Static, Solver=Pardiso\n1, 1, 1E-05, 1E+30\n*Output, Frequency=1\n\
            *Boundary, op=New\n** Name: Fixed-1\n*Boundary\nN5, 1, 6, 0\n*Cload, op=New\n*Dload, op=New\n\
            ** Name: Pressure-1\n*Dsload\nS6, P, {pressure}\n*Node file\nRF, U\n*El file\nS, E, NOE\n*End step\n"
        )
    };
    let deck = read(&cube(&(steps("2") + &steps("3")))).expect("deck");
    let scene = deck.scene().expect("scene");
    assert_eq!((scene.supports().len(), scene.loads().len()), (1, 1));
    assert_eq!(scene.supports()[0].directions(), &Directions::All);
    let history = scene.loads()[0].history();
    assert_eq!(
        [0.5, 1.0, 1.5, 2.0].map(|t| 2.0 * history.value(t)),
        [1.0, 2.0, 2.5, 3.0]
    );
    let rotations = deck.ignored().iter().filter(|i| i.word == "6");
    assert_eq!(rotations.count(), 2);
}

/// Ten nodes an element, in the order of the manuals, on one line or two; their loads at nodes.
#[test]
fn elements_of_second_order_are_read_with_their_nodes() {
    use signorini_fem_mesh::{Brick, LoadDensity};
    let straight = Brick::new([1.0; 3], [2, 2, 2])
        .build()
        .expect("brick")
        .raise_order()
        .expect("quadratic");
    let bent = straight.map_points(|[x, y, z]| [x, y, z + 0.1 * x * y]).expect("bent");
    for own in [&straight, &bent] {
        let text = mesh(own);
        let found = read(&text).expect("deck");
        assert_eq!(found.mesh().points(), own.points());
        assert_eq!(found.mesh().quadratic_tets(), own.quadratic_tets());
        let first = text
            .lines()
            .find(|l| l.starts_with("1, ") && l.split(',').count() == 11)
            .expect("an element");
        let fields: Vec<&str> = first.split(", ").collect();
        let broken = format!("{},\n{}", fields[..6].join(", "), fields[6..].join(", "));
        let again = read(&text.replacen(first, &broken, 1)).expect("deck");
        assert_eq!(again.mesh(), found.mesh());
        let few = read(&text.replacen(first, &fields[..5].join(", "), 1)).expect_err("too few");
        assert!(few.to_string().contains("ten node numbers"), "{few}");
    }
    // gravity in a part of the elements and many pressures are forces at nodes, which do the work of linear fields
    let text = mesh(&straight) + STEEL;
    let some = "*ELSET, ELSET=SOME\n1, 2, 3, 4, 5\n*BOUNDARY\nN5, 1, 3\n*STEP\n*STATIC\n*DLOAD\nSOME, GRAV, 10., 0., 0., -1.\n*END STEP\n";
    let scene = read(&(text + some)).expect("deck").scene().expect("scene");
    let [load] = scene.loads() else { panic!("one load") };
    let Some(LoadDensity::NodalForces(forces)) = load.density() else {
        panic!("forces at nodes")
    };
    let points = straight.points();
    for (weight, power) in [([1.0, 0.0], 0), ([0.0, 1.0], 1)] {
        let of = |x: f64| weight[0] + weight[1] * x;
        let work: f64 = forces.iter().map(|(n, f)| f[2] * of(points[*n as usize][0])).sum();
        let exact: f64 = (0..5)
            .map(|t| {
                let centre = straight.tet_points(t).iter().map(|p| p[0]).sum::<f64>() / 4.0;
                -7.8e-8 * straight.volume(t) * of(centre)
            })
            .sum();
        assert!((work / exact - 1.0).abs() < 1e-12, "{power}: {work:e} {exact:e}");
    }
    // one of first order beside them gets nodes on its edges
    let apart = "*NODE\n901, 5.\n902, 6.\n903, 5., 1.\n904, 5., 0., 1.\n*ELEMENT, TYPE=C3D4\n999, 901, 902, 903, 904\n";
    let mixed = read(&(mesh(&straight) + apart)).expect("deck");
    assert_eq!(mixed.mesh().points().len(), straight.points().len() + 10);
    assert!(
        mixed.ignored()[0].why.contains("6 nodes are added"),
        "{}",
        mixed.ignored()[0]
    );
}

/// Cards of one name add up, in the order of the deck.
#[test]
fn sets_take_what_stands_before() {
    let sets = "*NSET, NSET=A\n1\n*NSET, NSET=B\n2\n*NSET, NSET=A\nB\n*NSET, NSET=B\n3\n*NSET, NSET=C\nA, B\n\
        *NSET, NSET=A\nC\n";
    let deck = read(&cube(sets)).expect("deck");
    let of = |name: &str| deck.node_set(name).expect("set").to_vec();
    assert_eq!((of("A"), of("B"), of("C")), (vec![0, 1, 2], vec![1, 2], vec![0, 1, 2]));
}

/// A last number that the increment does not reach belongs to a set, too, as in CalculiX; in an instance only if it is
/// there.
#[test]
fn both_ends_of_a_range_are_members() {
    let deck = read(&format!(
        "{TWO}*NSET, NSET=A, GENERATE\n10, 50, 30\n*NSET, NSET=B, GENERATE\n10, 45, 30\n"
    ))
    .expect("deck");
    assert_eq!(deck.node_set("A").expect("A"), [0, 3, 4]);
    assert_eq!(deck.node_set("B").expect("B"), [0, 3]);
    let part = format!(
        "*PART, NAME=P\n{TWO}*NSET, NSET=A, GENERATE\n10, 99, 20\n*NSET, NSET=B, GENERATE\n10, 50, 30\n*END PART\n"
    );
    let deck = read(&format!(
        "{part}*ASSEMBLY\n*INSTANCE, NAME=I, PART=P\n*END INSTANCE\n*END ASSEMBLY\n"
    ))
    .expect("deck");
    assert_eq!(deck.node_set("I.A").expect("A"), [0, 2, 4]);
    assert_eq!(deck.node_set("I.B").expect("B"), [0, 3, 4]);
}

/// *NODE and *ELEMENT come before all sets, wherever they stand.
#[test]
fn sets_take_all_that_nodes_and_elements_say() {
    let (nodes, elements) = TWO.split_at(TWO.find("*ELEMENT").expect("elements"));
    let nodes = nodes.replace("*NODE", "*NODE, NSET=N");
    let sets = "*NSET, NSET=B\nN\n*ELSET, ELSET=E\nALL\n";
    let deck = read(&format!(
        "{nodes}{sets}{elements}*NODE, NSET=N\n60, 0., 0., 2.\n*ELEMENT, TYPE=C3D4, ELSET=ALL\n9, 30, 40, 50, 60\n"
    ));
    let deck = deck.expect("deck");
    assert_eq!(deck.node_set("B").expect("B"), [0, 1, 2, 3, 4, 5]);
    assert_eq!(deck.element_set("E").expect("E"), [0, 1, 2]);
}

#[test]
fn a_comma_too_many_takes_no_data() {
    let names = "*NSET, NSET=A,\n10\n*NSET, NSET=B,\nA\n*NSET, NSET=C, \ngenerate\n10, 30, 10\n*ELSET, ELSET=E,\n*NSET, NSET=D\n20\n";
    let deck = read(&format!("{TWO}{names}")).expect("deck");
    let of = |name: &str| deck.node_set(name).expect("set").to_vec();
    assert_eq!((of("B"), of("C"), of("D")), (vec![0], vec![0, 1, 2], vec![1]));
}

#[test]
fn names_of_sets_may_begin_with_digits() {
    let deck = read(&format!("{TWO}*NSET, NSET=1ST\n10\n*NSET, NSET=B\n1st, 20\n")).expect("deck");
    assert_eq!(deck.node_set("B").expect("B"), [0, 1]);
    let error = read(&format!("{TWO}*NSET, NSET=B\n1.5\n")).expect_err("a number");
    assert!(error.to_string().contains("a number from 1"), "{error}");
}

/// As CalculiX opens files: beside the deck. Those beside the file that includes come first.
#[test]
fn files_are_included_from_beside_the_deck_too() {
    let (folder, path) = folder(&[("part.inp", "*INCLUDE, INPUT=sub/one.inp\n"), ("two.inp", TWO)]);
    std::fs::create_dir(folder.path().join("sub")).expect("folder");
    std::fs::write(folder.path().join("sub/one.inp"), "*INCLUDE, INPUT=two.inp\n").expect("written");
    assert_eq!(Deck::read(&path).expect("deck").mesh(), read(TWO).expect("deck").mesh());
    std::fs::write(folder.path().join("sub/two.inp"), "*NODE\n1\n").expect("written");
    assert!(Deck::read(&path).is_err());
}

/// Zeros that mean the default; data that CalculiX reads over.
#[test]
fn zeros_are_defaults() {
    let rest = |friction: &str, time: &str| {
        format!(
            "*SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n0.\n*FRICTION\n{friction}\n\
        *CONTACT PAIR, INTERACTION=I\nS1, S2\n*GAP CONDUCTANCE\n1.\n*INTEGRATED OUTPUT\n*BOUNDARY\nN5, 1, 3\n*STEP\n*STATIC\n{time}\n*END STEP\n"
        )
    };
    let scene = |friction, time| {
        let deck = read(&cube(&rest(friction, time))).expect("deck");
        (
            deck.scene().expect("scene"),
            deck.ignored().iter().map(|i| i.word.clone()).collect::<Vec<_>>(),
        )
    };
    let (plain, told) = scene("0.3", "1., 1.");
    assert_eq!(told, ["0.", "*GAP CONDUCTANCE", "*INTEGRATED OUTPUT"]);
    for (friction, time) in [
        ("0.3, 0.", "0., 1."),
        ("0.3", "1., 0."),
        ("0.3", "0., 0., 0., 0."),
        ("0.3", "1., 1., , , 2."),
    ] {
        let (scene, _) = scene(friction, time);
        assert_eq!(
            format!("{:?}", scene.analysis()),
            format!("{:?}", plain.analysis()),
            "{time}"
        );
        assert_eq!(
            format!("{:?}", scene.contacts()),
            format!("{:?}", plain.contacts()),
            "{friction}"
        );
    }
    let (_, told) = scene("0.3, 1e6", "1., 1.");
    assert!(told.contains(&"1e6".to_owned()), "{told:?}");
}
