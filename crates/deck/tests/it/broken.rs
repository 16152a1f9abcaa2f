//! Broken decks: cut at every line and byte, bytes flipped, lines repeated and swapped. Nothing panics, and all end
//! quickly.

use std::time::{Duration, Instant};

use allocation_counter::measure;
use signorini_deck::Deck;
use signorini_fem_mesh::{Brick, FacetTag};

use crate::grid::Grid;
use crate::pretension::section;
use crate::write::{STEEL, cube, face, folder, mesh};

/// A small deck with sets, rigid bodies, couplings, contact and loads.
fn valid() -> String {
    let brick = Brick::new([1.0; 3], [2, 2, 2]).build().expect("brick");
    let (element, number) = face(&brick, 40);
    let deck = cube(
        "*NSET, NSET=FEW, GENERATE\n1, 9, 2\n*NSET, NSET=MORE\nFEW, 10\n*AMPLITUDE, NAME=UP, TIME=TOTAL TIME\n0., 0., 1., 1.\n\
        *SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n*FRICTION\n0.3, 1e4\n\
        *NODE\n91, -9., -9.\n92, 9., -9.\n93, 0., 9.\n94\n95, 2.\n96\n*ELEMENT, TYPE=R3D3, ELSET=FLOOR\n91, 91, 92, 93\n\
        *RIGID BODY, REF NODE=94, ELSET=FLOOR\n*SURFACE, NAME=PLANE\nFLOOR, SPOS\n\
        *COUPLING, REF NODE=95, SURFACE=S4\n*DISTRIBUTING\n1, 6\n*COUPLING, REF NODE=96, SURFACE=S6\n*KINEMATIC\n1, 3\n\
        *CONTACT PAIR, INTERACTION=I, TYPE=NODE TO SURFACE\nS1, S2\nS5, PLANE\n*BOUNDARY\n94, ENCASTRE\n96, 1, 6\nN5, 1, 3\n\
        *STEP, INC=20, NLGEOM=NO\n*STATIC, DIRECT\n0.25, 1., 1e-5, 0.5\n*BOUNDARY\nMORE, 3, 3, 0.\n*CLOAD, AMPLITUDE=UP\nN6, 1, 2.5\n95, 4, 1.\n\
        *DLOAD\nHERE, 1.\nALL, GRAV, 9.81, 0., 0., -1.\n*NODE FILE\nU\n*END STEP\n\
        *STEP\n*STATIC\n*DSLOAD, OP=NEW\nS6, P, 2.\n*BOUNDARY, OP=MOD\nN5, PINNED\n\
        *MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE\nS1, S2\n*END STEP\n",
    );
    deck.replace("HERE", &format!("{element}, P{number}"))
}

/// A small deck with parts.
fn assembled() -> String {
    let deck = cube("");
    let (mesh, material) = deck.split_once("*MATERIAL").expect("a material");
    format!(
        "*PART, NAME=P\n{mesh}*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n*SURFACE, NAME=NODES, TYPE=NODE\nN6\n*END PART\n\
        *ASSEMBLY, NAME=A\n*INSTANCE, NAME=I, PART=P\n*END INSTANCE\n*INSTANCE, NAME=J, PART=P\n0., 0., 1.\n\
        0., 0., 0., 0., 0., 1., 90.\n*END INSTANCE\n*NODE\n1\n2\n*NSET, NSET=R\n1\n*NSET, NSET=S, INSTANCE=J\nN6, 1\n\
        *SURFACE, NAME=SKIN\nJ.ALL\n*END ASSEMBLY\n*MATERIAL{}*RIGID BODY, NSET=S, REF NODE=R, ROT NODE=202\n\
        *SURFACE INTERACTION, NAME=I\n*CONTACT PAIR, INTERACTION=I\nI.NODES, J.S5\n*BOUNDARY\nI.N5, 1, 3\nR, 1, 3\n\
        202, 1, 3\n*STEP\n*STATIC\n*BOUNDARY\n202, 2, 2, 0.01\n*DLOAD\n, CENTRIF, 100., 0., 0., 0., 0., 0., 1.\n*END STEP\n",
        material.split("*SOLID").next().expect("a material")
    )
}

/// A small deck with what ties nodes to one another, axes and temperatures.
fn joined() -> String {
    let bar = Brick::new([2.0, 1.0, 1.0], [2, 1, 1]).build().expect("brick");
    let cube = Brick::new([1.0; 3], [1; 3]).build().expect("brick");
    let cube = |z: f64, tags: u32| {
        let cube = cube.clone().map_points(|x| [x[0], x[1], x[2] + z]).expect("lifted");
        cube.map_tags(|tag| FacetTag(tag.0 + tags))
    };
    let two = bar.append(&cube(1.0, 10)).expect("two");
    let all = two.append(&cube(2.05, 20)).expect("three");
    let steel = STEEL.trim_end().to_owned() + ", ORIENTATION=GRAIN\n";
    format!(
        "{}{steel}*EXPANSION, TYPE=ORTHO\n1e-5, 2e-5, 3e-5\n*ORIENTATION, NAME=GRAIN\n\
        1., 0.5, 0.2, -0.4, 1., 0.3\n3, 25.\n\
        {}*PRE-TENSION SECTION, SURFACE=CUT, NODE=9000\n1., 0., 0.\n*TIE, NAME=T, POSITION TOLERANCE=0.1\nS15, S6\n\
        *SURFACE INTERACTION, NAME=I\n*FRICTION\n0.2\n*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\nS25, S16\n\
        *CLEARANCE, SLAVE=S25, MASTER=S16, VALUE=0.01\n*NSET, NSET=EVERY, GENERATE\n1, {}\n\
        *INITIAL CONDITIONS, TYPE=TEMPERATURE\nEVERY, 20.\n*TRANSFORM, NSET=N2, TYPE=C\n-1., -1., 0., -1., -1., 5.\n\
        *NODE\n9001\n*EQUATION\n3\nN2, 1, 1., 9001, 1, -2.\n9001, 2, 0.5\n*MPC\nPLANE, N26\n\
        *BOUNDARY\nN1, 1, 3\nN26, 1\nN26, 2\n9001, 2\n*STEP\n*STATIC\n0.5, 1.\n*TEMPERATURE\nEVERY, 100.\n\
        *CLOAD\n9000, 1, 5.\n9001, 1, 3.\nN26, 3, -1.\n*END STEP\n\
        *STEP\n*STATIC\n*BOUNDARY, FIXED\n9000, 1\n*TEMPERATURE, OP=NEW\n*END STEP\n",
        mesh(&all),
        section(&bar, 1.0),
        all.points().len()
    )
}

/// Reads what may be broken, within five seconds on a busy machine.
fn survive(path: &std::path::Path, bytes: &[u8]) -> bool {
    std::fs::write(path, bytes).expect("written");
    let start = Instant::now();
    let mut read = None;
    let used = measure(|| read = Some(Deck::read(path)));
    assert!(start.elapsed() < Duration::from_secs(5));
    assert!(used.bytes_max < MEMORY, "{} bytes", used.bytes_max);
    match read {
        Some(Ok(deck)) => {
            // scenes from broken decks may be refused, not more
            let _ = deck.scene();
            true
        }
        Some(Err(error)) => {
            assert!(!error.to_string().is_empty());
            false
        }
        None => false,
    }
}

/// Most bytes that reading may hold at once: for files of at most two million bytes, a keyword of many parameters being
/// the dearest.
const MEMORY: u64 = 100_000_000;

/// The same of files whose instances copy most.
const COPIED: u64 = 1_000_000_000;

/// SplitMix64.
struct Dice(u64);

impl Dice {
    fn roll(&mut self, sides: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % sides as u64) as usize
    }
}

#[test]
fn cut_anywhere() {
    for text in [valid(), assembled(), joined()] {
        let (_folder, path) = folder(&[("part.inp", &text)]);
        let deck = Deck::read(&path).expect("the deck before it is broken");
        let _ = deck.scene().expect("its scene");
        for (at, _) in text.match_indices('\n') {
            survive(&path, &text.as_bytes()[..at]);
        }
        for at in (text.len() - 700)..text.len() {
            survive(&path, &text.as_bytes()[..at]);
        }
    }
}

#[test]
fn bytes_are_flipped() {
    let texts = [valid(), joined()];
    let (_folder, path) = folder(&[("part.inp", "")]);
    let mut dice = Dice(15);
    for round in 0..8000 {
        let text = &texts[round % 2];
        let mut bytes = text.clone().into_bytes();
        for _ in 0..=(round % 3) {
            let at = dice.roll(bytes.len());
            bytes[at] = match dice.roll(4) {
                0 => dice.roll(256) as u8,
                1 => b"*,=\n 0123456789.-ENSP"[dice.roll(21)],
                2 => bytes[dice.roll(text.len())],
                _ => bytes[at] ^ (1 << dice.roll(8)),
            };
        }
        survive(&path, &bytes);
    }
}

#[test]
fn lines_are_repeated_lost_and_swapped() {
    let texts = [valid(), assembled(), joined()];
    let (_folder, path) = folder(&[("part.inp", "")]);
    let mut dice = Dice(16);
    for round in 0..3750 {
        let text = &texts[round % 3];
        let mut lines: Vec<&str> = text.lines().collect();
        let (a, b) = (dice.roll(lines.len()), dice.roll(lines.len()));
        match dice.roll(3) {
            0 => lines.swap(a, b),
            1 => drop(lines.remove(a)),
            _ => lines.insert(a, lines[b]),
        }
        survive(&path, lines.join("\n").as_bytes());
    }
}

/// Reads what instances make too large.
fn too_much(path: &std::path::Path, text: &str) {
    std::fs::write(path, text).expect("written");
    let start = Instant::now();
    let mut error = String::new();
    let used = measure(|| error = Deck::read(path).expect_err("too many").to_string());
    assert!(used.bytes_max < COPIED, "{} bytes", used.bytes_max);
    assert!(error.contains("in all instances"), "{}", &error[..error.len().min(500)]);
    assert!(start.elapsed() < Duration::from_secs(10));
}

/// Small files that ask for much.
#[test]
fn bombs() {
    let (folder, path) = folder(&[("part.inp", "")]);
    // each file includes the next one twice
    for i in 0..40 {
        let text = format!("*INCLUDE, INPUT={0}.inp\n*INCLUDE, INPUT={0}.inp\n", i + 1);
        std::fs::write(folder.path().join(format!("{i}.inp")), text).expect("written");
    }
    assert!(!survive(&path, b"*INCLUDE, INPUT=0.inp\n"));
    for i in (10..40).rev() {
        std::fs::write(folder.path().join(format!("{i}.inp")), "** end\n").expect("written");
    }
    assert!(!survive(&path, b"*INCLUDE, INPUT=0.inp\n"));
    // ranges over all numbers, many times, and a ladder of sets
    let mut many = cube("") + "*NSET, NSET=R, GENERATE\n";
    many += &"1, 99999999\n".repeat(5000);
    for i in 0..3000 {
        many += &format!("*NSET, NSET=L{i}\nR, R, R");
        if i > 0 {
            many += &format!(", L{}", i - 1);
        }
        many += "\n";
    }
    assert!(survive(&path, many.as_bytes()));
    let long = "9".repeat(2_000_000);
    for start in ["*NODE\n", "*", "*NODE, NSET=", "*STEP\n*STATIC\n"] {
        survive(&path, format!("{start}{long}").as_bytes());
    }
    survive(
        &path,
        cube(&"*STEP\n*STATIC\n1e-6, 1.\n*END STEP\n".repeat(50)).as_bytes(),
    );
    // a part, many times
    let nodes: String = (1..50_000).map(|n| format!("{n}\n")).collect();
    let nodes = format!("*NODE\n{nodes}");
    let faces = format!(
        "*ELEMENT, TYPE=T3D2\n1, 1, 1\n*NODE\n1\n*SURFACE, NAME=S\n{}",
        "1, S1\n".repeat(50_000)
    );
    let sets: String = (0..50_000).map(|n| format!("*NSET, NSET={n}\n")).collect();
    let sections = "*SOLID SECTION, ELSET=E, MATERIAL=M\n".repeat(50_000);
    let long = format!("*NSET, NSET={}\n", "N".repeat(1_000_000));
    for part in [nodes, faces, sets, sections, long] {
        let instances: String = (0..20_000)
            .map(|n| format!("*INSTANCE, NAME={n}, PART=P\n*END INSTANCE\n"))
            .collect();
        let many = format!("*PART, NAME=P\n{part}*END PART\n*ASSEMBLY\n{instances}");
        too_much(&path, &many);
    }
    // a long name before many
    let long = "A".repeat(500_000);
    let many = format!(
        "*PART, NAME=P\n*END PART\n*ASSEMBLY\n*INSTANCE, NAME={long}, PART=P\n*END INSTANCE\n\
        *NSET, NSET=S, INSTANCE={long}\n{}",
        "B\n".repeat(100_000)
    );
    too_much(&path, &many);
    // many parts and instances
    let parts: String = (0..20_000)
        .map(|n| format!("*PART, NAME={n}\n*NODE\n1\n*END PART\n"))
        .collect();
    let instances: String = (0..20_000)
        .map(|n| format!("*INSTANCE, NAME={n}, PART={n}\n*END INSTANCE\n"))
        .collect();
    survive(
        &path,
        format!("{parts}*ASSEMBLY\n{instances}*END ASSEMBLY\n").as_bytes(),
    );
    survive(&path, ",".repeat(1_000_000).as_bytes());
    survive(&path, format!("*NODE{}", ",\n".repeat(200_000)).as_bytes());
    survive(&path, &[0; 100_000]);
}

/// Many sets of many nodes or elements of a grid, all that there may be, and more.
#[test]
fn sets_of_everything() {
    let (_folder, path) = folder(&[("part.inp", "")]);
    let grid = Grid::new("C3D8", [24, 24, 24], [1.0; 3]).text();
    for (what, name, many) in [("node", "NSET", 15_625), ("element", "ELSET", 13_824)] {
        let deck = |sets: usize| {
            let set = |k: usize| format!("*{name}, {name}=S{k}, GENERATE\n1, {many}\n");
            grid.clone() + &(0..sets).map(set).collect::<String>()
        };
        assert!(survive(&path, deck(1_560_000 / many).as_bytes()));
        let text = deck(8_500);
        assert!(text.len() <= 2_000_000, "{}", text.len());
        assert!(!survive(&path, text.as_bytes()));
        let error = Deck::read(&path).expect_err("too many").to_string();
        assert!(error.contains("members of sets"), "{what}: {error}");
    }
    let more = "ALL, S1\nALL, S2\nMORE, S2\n".repeat(10_000);
    assert!(survive(
        &path,
        format!("{grid}*ELSET, ELSET=MORE\nALL\n*SURFACE, NAME=A\n{more}").as_bytes()
    ));
}

/// Any number of a deck set to what no model has.
#[test]
fn huge_numbers() {
    let (_folder, path) = folder(&[("part.inp", "")]);
    let huge = ["99999999999999999999", "4294967295", "-1", "1e308", "nan", "inf", ""];
    let is_number = |word: &str| word.trim().starts_with(|c: char| c.is_ascii_digit() || c == '-');
    for text in [valid(), joined()] {
        let words: Vec<&str> = text.split_inclusive([',', '\n', '=']).collect();
        let numbers = (0..words.len()).filter(|&k| is_number(words[k]));
        for (count, at) in numbers.enumerate() {
            let new = huge[count % huge.len()];
            let end = &words[at][words[at].len() - 1..];
            let broken = [&words[..at].concat(), new, end, &words[at + 1..].concat()].concat();
            survive(&path, broken.as_bytes());
        }
    }
}
