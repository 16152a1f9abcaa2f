//! Gmsh files: good ones in text and binary, and many damaged ones.

use allocation_counter::measure;
use approx::assert_abs_diff_eq;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use signorini_fem_mesh::gmsh::{GmshError, parse_gmsh, read_gmsh, write_sizes};
use signorini_fem_mesh::{FacetTag, MeshError};

/// Two tetrahedra in two volumes (groups 7 and 8) with a tagged face (group 3) of surface 1 and an
/// untagged one of surface 2. Node numbers have no gaps but are not in order; node 6 is unused.
const TEXT: &str = "$MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
1
2 3 \"foundation\"
$EndPhysicalNames
$Entities
1 0 2 2
1 0 0 0 0
1 0 0 0 1 1 0 1 3 0
2 0 0 0 1 1 1 0 0
1 0 0 0 1 1 1 1 7 1 -1
2 0 0 0 2 2 2 1 8 0
$EndEntities
$Nodes
2 6 1 6
2 1 0 3
3
1
2
0 0 0
1 0 0
0 1 0
3 1 0 3
5
4
6
0 0 1
1 1 1
9 9 9
$EndNodes
$Elements
5 6 1 6
0 1 15 1
1 6
2 1 2 1
2 3 1 2
2 2 2 1
3 3 1 5
3 1 4 1
4 3 1 2 5
3 2 4 1
6 4 1 2 5
$EndElements
";

fn damaged(from: &str, to: &str) -> GmshError {
    assert!(TEXT.contains(from), "{from}");
    parse_gmsh(TEXT.replacen(from, to, 1).as_bytes()).unwrap_err()
}

/// The same file in binary, in either byte order.
fn binary(big: bool) -> Vec<u8> {
    let int = |n: i32| {
        if big { n.to_be_bytes() } else { n.to_le_bytes() }
    };
    let size = |n: u64| {
        if big { n.to_be_bytes() } else { n.to_le_bytes() }
    };
    let real = |x: f64| {
        if big { x.to_be_bytes() } else { x.to_le_bytes() }
    };
    let mut out = b"$MeshFormat\n4.1 1 8\n".to_vec();
    out.extend(int(1));
    out.extend(b"\n$EndMeshFormat\n");
    let mut section = "";
    for line in TEXT.lines().skip(3) {
        if let Some(name) = line.strip_prefix('$') {
            if name.starts_with("End") {
                out.push(b'\n');
            }
            section = name;
            out.extend(line.bytes());
            out.push(b'\n');
            continue;
        }
        let words: Vec<&str> = line.split(' ').collect();
        // i: int, s: size_t, d: double, for each line of the section.
        let kinds = match (section, words.len()) {
            ("PhysicalNames", _) => {
                out.extend(line.bytes());
                out.push(b'\n');
                continue;
            }
            ("Entities", 4) => "ssss",
            ("Entities", 5) => "iddds",
            ("Entities", 9) => "iddddddss",
            ("Entities", 10) => "iddddddsis",
            ("Entities", 11) => "iddddddsisi",
            ("Nodes" | "Elements", 4) if section == "Nodes" && words[2] == "0" => "iiis",
            ("Nodes", 4) => "ssss",
            ("Nodes", 3) => "ddd",
            ("Nodes", 1) => "s",
            ("Elements", 4) if line == "5 6 1 6" => "ssss",
            ("Elements", 4) if words[3] == "1" && ["15", "2", "4"].contains(&words[2]) => "iiis",
            _ => "sssss",
        };
        for (kind, word) in kinds.chars().zip(words) {
            match kind {
                'i' => out.extend(int(word.parse().unwrap())),
                's' => out.extend(size(word.parse().unwrap())),
                _ => out.extend(real(word.parse().unwrap())),
            }
        }
    }
    out
}

#[test]
fn text_and_binary() {
    let mesh = parse_gmsh(TEXT.as_bytes()).unwrap().0;
    assert_eq!(mesh.points()[..2], [[0.0; 3], [1.0, 0.0, 0.0]]);
    assert_eq!(mesh.points().len(), 5);
    assert_eq!(mesh.regions(), [7, 8]);
    assert_abs_diff_eq!(mesh.total_volume(), 0.5, epsilon = 1e-15);
    // Only the triangle in a group is tagged.
    assert_eq!(mesh.facets().len(), 1);
    assert_eq!(mesh.nodes_on(FacetTag(3)), [0, 1, 2]);
    assert_eq!(parse_gmsh(&binary(false)).unwrap().0, mesh);
    assert_eq!(parse_gmsh(&binary(true)).unwrap().0, mesh);
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), TEXT).unwrap();
    assert_eq!(read_gmsh(file.path()).unwrap().0, mesh);
    let windows = TEXT.replace('\n', "\r\n");
    assert_eq!(parse_gmsh(windows.as_bytes()).unwrap().0, mesh);
}

#[test]
fn names_of_groups() {
    let more = TEXT.replace(
        "1\n2 3 \"foundation\"\n",
        "4\n1 3 \"an edge\"\n2 3 \"the foundation\"\n3 8 \"upper\"\n3 7 \"lower \\u{e9}\"\n",
    );
    let (mesh, names) = parse_gmsh(more.as_bytes()).unwrap();
    assert_eq!(mesh, parse_gmsh(TEXT.as_bytes()).unwrap().0);
    assert_eq!(names.surface("the foundation").unwrap(), FacetTag(3));
    assert_eq!(names.volume("upper").unwrap(), 8);
    for name in ["upper", "an edge", "Side"] {
        let error = names.surface(name).unwrap_err();
        let text = error.to_string();
        assert!(text.contains(name) && text.contains("surfaces in it are \"the foundation\""));
        assert!(matches!(error, GmshError::UnknownName { what: "surface", .. }));
    }
    let text = names.volume("middle").unwrap_err().to_string();
    assert!(text.contains("volumes in it are \"lower ") && text.contains(", \"upper\""));
    assert_eq!(names.surfaces().count(), 1);
    let volumes: Vec<_> = names.volumes().collect();
    assert_eq!(volumes, [("lower \\u{e9}", 7), ("upper", 8)]);
    // the section is text in binary files, too
    for file in [TEXT.as_bytes(), &binary(false), &binary(true)] {
        let (_, names) = parse_gmsh(file).unwrap();
        let surfaces: Vec<_> = names.surfaces().collect();
        assert_eq!(surfaces, [("foundation", FacetTag(3))]);
        assert_eq!(names.volumes().count(), 0);
        let text = names.volume("body").unwrap_err().to_string();
        assert!(text.contains("no volume in it has a name"), "{text}");
    }
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), TEXT).unwrap();
    assert_eq!(read_gmsh(file.path()).unwrap().0, mesh);
    let twice = TEXT.replace("1\n2 3 \"foundation\"\n", "2\n2 3 \"a\"\n2 4 \"a\"\n");
    let error = parse_gmsh(twice.as_bytes()).unwrap().1.surface("a").unwrap_err();
    assert!(matches!(error, GmshError::RepeatedName { groups: [3, 4], .. }));
    for (from, to) in [
        ("\"foundation\"", "foundation"),
        ("2 3 \"f", "2 x \"f"),
        ("1\n2 3", "9\n2 3"),
    ] {
        assert!(matches!(
            damaged(from, to),
            GmshError::Damaged {
                section: "$PhysicalNames",
                ..
            }
        ));
    }
}

/// Gmsh saves no tetrahedra where surfaces are physical groups and volumes are not.
#[test]
fn a_file_without_tetrahedra_says_what_to_add() {
    let surfaces = TEXT
        .replace("5 6 1 6\n", "3 4 1 4\n")
        .replace("3 1 4 1\n4 3 1 2 5\n3 2 4 1\n6 4 1 2 5\n", "");
    let error = parse_gmsh(surfaces.as_bytes()).unwrap_err();
    assert!(matches!(error, GmshError::NoTetrahedra), "{error}");
    let text = error.to_string();
    assert!(text.contains("physical volume") && text.contains("Mesh.SaveAll"));
}

/// Groups of a partitioned file stand in a section of their own.
#[test]
fn partitioned_files_are_refused_by_their_section() {
    let section = "$PartitionedEntities
2
0
0 0 0 1
1 3 1 1 1 0 0 0 1 1 1 1 7 0
$EndPartitionedEntities
$Nodes";
    let error = damaged("$Nodes", section);
    assert!(matches!(error, GmshError::Partitioned { .. }), "{error}");
    let text = error.to_string();
    assert!(text.contains("$PartitionedEntities") && text.contains("unpartition"));
}

#[test]
fn without_groups_the_entities_count() {
    let text = TEXT
        .replace("1 0 0 0 1 1 0 1 3 0\n", "1 0 0 0 1 1 0 0 0\n")
        .replace("1 0 0 0 1 1 1 1 7 1 -1\n", "1 0 0 0 1 1 1 0 0\n")
        .replace("2 0 0 0 2 2 2 1 8 0\n", "2 0 0 0 2 2 2 0 0\n");
    let (mesh, names) = parse_gmsh(text.as_bytes()).unwrap();
    assert_eq!(mesh.regions(), [1, 2]);
    // the number of a group is none of them
    let error = names.surface("foundation").unwrap_err();
    assert!(matches!(&error, GmshError::UnknownName { known, .. } if known.is_empty()));
    assert_eq!(mesh.tags(), [FacetTag(1), FacetTag(2)]);
    // The same with the second surface between the two volumes.
    let inside = text.replace("3 3 1 5\n", "3 1 2 5\n");
    assert_eq!(parse_gmsh(inside.as_bytes()).unwrap().0.tags(), [FacetTag(1)]);
}

#[test]
fn sections_may_be_repeated() {
    let entities = "$EndEntities\n$Entities\n0 0 0 2\n1 0 0 0 1 1 1 1 7";
    let mut text = TEXT.to_owned();
    for (from, to) in [
        ("1\n2 3", "1\n3 7 \"lower\"\n$EndPhysicalNames\n$PhysicalNames\n1\n2 3"),
        ("1 0 2 2\n", "1 0 2 0\n"),
        ("1 0 0 0 1 1 1 1 7", entities),
        ("2 6 1 6\n", "1 3 1 3\n"),
        ("3 1 0 3\n5\n", "$EndNodes\n$Nodes\n1 3 4 6\n3 1 0 3\n5\n"),
        ("5 6 1 6\n", "3 4 1 4\n"),
        ("3 1 4 1\n4", "$EndElements\n$Elements\n2 2 4 6\n3 1 4 1\n4"),
    ] {
        assert!(text.contains(from), "{from}");
        text = text.replacen(from, to, 1);
    }
    let (mesh, names) = parse_gmsh(text.as_bytes()).unwrap();
    assert_eq!(mesh, parse_gmsh(TEXT.as_bytes()).unwrap().0);
    assert_eq!(names.surface("foundation").unwrap(), FacetTag(3));
    assert_eq!(names.volume("lower").unwrap(), 7);
    let other = text.replacen("0 0 0 2\n", "0 0 0 3\n2 0 0 0 2 2 2 1 9 0\n", 1);
    let error = parse_gmsh(other.as_bytes()).unwrap_err();
    assert!(matches!(error, GmshError::SeveralGroups { entity: 2, .. }));
}

#[test]
fn damaged_files() {
    assert!(matches!(parse_gmsh(b""), Err(GmshError::NotGmsh)));
    assert!(matches!(parse_gmsh(b"solid cube"), Err(GmshError::NotGmsh)));
    assert!(matches!(read_gmsh("/nowhere/at.msh"), Err(GmshError::Io { .. })));
    assert!(matches!(damaged("4.1 0", "2.2 0"), GmshError::Version { found } if found == "2.2"));
    assert!(matches!(damaged("4.1 0", "4.1 7"), GmshError::Damaged { .. }));
    assert!(matches!(
        damaged("0 8\n", "0 99999999999999999999\n"),
        GmshError::Damaged { .. }
    ));
    let huge = damaged("2 1 0 3\n", "2 1 0 18446744073709551615\n");
    assert!(matches!(huge, GmshError::Damaged { section: "$Nodes", .. }));
    let huge = damaged("3 2 4 1\n", "3 2 4 4611686018427387904\n");
    assert!(matches!(
        huge,
        GmshError::Damaged {
            section: "$Elements",
            ..
        }
    ));
    assert!(matches!(
        damaged("1 0 2 2\n", "1 0 2 2000000000\n"),
        GmshError::Damaged { .. }
    ));
    let empty = damaged("2 6 1 6", "2 0 1 6");
    assert!(matches!(empty, GmshError::Damaged { section: "$Nodes", .. }));
    assert!(matches!(damaged("2 1 0 3\n", "2 1 1 3\n"), GmshError::Damaged { .. }));
    assert!(matches!(damaged("$EndNodes", "$EndNods"), GmshError::Damaged { .. }));
    let third_order = damaged("3 1 4 1\n", "3 1 29 1\n");
    assert!(matches!(third_order, GmshError::Unsupported { kind: 29 }));
    assert!(matches!(
        damaged("3 1 4 1\n", "3 1 999 1\n"),
        GmshError::Unsupported { kind: 999 }
    ));
    let unknown = damaged("6 4 1 2 5", "6 4 1 2 77");
    assert!(matches!(unknown, GmshError::UnknownNode { element: 6, node: 77 }));
    assert!(matches!(
        damaged("5\n4\n6\n", "5\n4\n1\n"),
        GmshError::RepeatedNode { tag: 1 }
    ));
    let groups = damaged("1 0 0 0 1 1 1 1 7 1 -1\n", "1 0 0 0 1 1 1 2 7 9 1 -1\n");
    assert!(matches!(
        groups,
        GmshError::SeveralGroups {
            what: "volume",
            entity: 1,
            ..
        }
    ));
    let flat = damaged("6 4 1 2 5", "6 3 1 2 2");
    assert!(matches!(flat, GmshError::Mesh(MeshError::RepeatedNode { tet: 1, .. })));
    let nan = damaged("1 1 1\n9", "nan 1 1\n9");
    assert!(matches!(nan, GmshError::Mesh(MeshError::NotFinite { .. })));
    assert!(matches!(
        damaged("1 1 1\n9", "one 1 1\n9"),
        GmshError::Damaged { section: "$Nodes", .. }
    ));
    let inside = damaged("2 3 1 2\n", "2 1 2 5\n");
    assert!(matches!(inside, GmshError::Mesh(MeshError::FacetInside { .. })));
    let nodes = TEXT.split("$Elements").next().unwrap();
    assert!(matches!(
        parse_gmsh(nodes.as_bytes()),
        Err(GmshError::MissingSection { section: "$Elements" })
    ));
}

#[test]
fn no_truncation_panics() {
    for whole in [TEXT.as_bytes().to_vec(), binary(false), binary(true)] {
        let end = whole.len() - "\n$EndElements\n".len();
        for length in 0..end {
            assert!(parse_gmsh(&whole[..length]).is_err(), "{length}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 2000,
        rng_seed: RngSeed::Fixed(5),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    /// Whatever a few changed bytes do, the answer is a mesh or an error.
    #[test]
    fn no_change_of_bytes_panics(
        kind in 0..3,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
    ) {
        let mut bytes = match kind {
            0 => TEXT.as_bytes().to_vec(),
            other => binary(other == 2),
        };
        for (place, byte) in changes {
            let length = bytes.len();
            // In text, mostly digits.
            let byte = if kind == 0 && byte < 200 { b'0' + byte % 10 } else { byte };
            bytes[place.index(length)] = byte;
        }
        if let Err(error) = parse_gmsh(&bytes) {
            prop_assert!(!error.to_string().is_empty());
        }
    }
}

/// Most memory that reading may take at once: a node of a mesh takes many times its two characters in a file.
fn modest(bytes: &[u8], what: &str) {
    let mut text = String::new();
    let used = measure(|| {
        if let Err(error) = parse_gmsh(bytes) {
            text = error.to_string();
        }
    });
    let most = 64 * 1024 + 200 * bytes.len() as u64;
    assert!(
        used.bytes_max < most,
        "{what}: {} bytes of {}",
        used.bytes_max,
        bytes.len()
    );
}

/// Any word of a text file, and any bytes of a binary one, in which a count may be, set to what no file holds: an
/// answer, and no memory for what is not there.
#[test]
fn huge_counts_take_no_memory() {
    let words: Vec<&str> = TEXT.split_inclusive(char::is_whitespace).collect();
    let huge = [
        "18446744073709551615",
        "9223372036854775807",
        "4294967296",
        "2147483647",
        "-1",
        "1e308",
        "nan",
        "0",
        "",
    ];
    for at in 0..words.len() {
        for new in huge {
            let end = &words[at][words[at].trim_end().len()..];
            let text = [&words[..at].concat(), new, end, &words[at + 1..].concat()].concat();
            modest(text.as_bytes(), &format!("word {at} is {new:?}"));
        }
        // lost, and said twice
        modest([&words[..at], &words[at + 1..]].concat().concat().as_bytes(), "lost");
        modest([&words[..=at], &words[at..]].concat().concat().as_bytes(), "twice");
    }
    for whole in [binary(false), binary(true)] {
        for at in 0..whole.len() - 8 {
            for new in [u64::MAX, 1 << 62, 1 << 40, 1 << 31, 0xffff_ffff, 0] {
                for value in [new.to_le_bytes(), new.to_be_bytes()] {
                    let mut bytes = whole.clone();
                    bytes[at..at + 8].copy_from_slice(&value);
                    modest(&bytes, &format!("bytes {at} are {new:x}"));
                }
            }
        }
    }
}

/// Files that are made to be slow: many sections, names and blanks.
#[test]
fn long_files_of_nothing_end() {
    let head = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
    for body in [
        "\n".repeat(200_000),
        "$A\n$EndA\n".repeat(20_000),
        "$A\n".repeat(50_000),
        format!("$PhysicalNames\n1\n2 1 \"{}\"\n", "x".repeat(200_000)),
        format!("$Nodes\n{}", "1 ".repeat(100_000)),
        "9".repeat(200_000),
    ] {
        let start = std::time::Instant::now();
        assert!(parse_gmsh(format!("{head}{body}").as_bytes()).is_err());
        assert!(start.elapsed().as_secs() < 5);
    }
}

/// One scalar tetrahedron a line: twelve coordinates, four lengths.
#[test]
fn sizes_are_a_view_of_scalar_tetrahedra() {
    let mesh = parse_gmsh(TEXT.as_bytes()).expect("mesh").0;
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("sizes.pos");
    let sizes: Vec<f64> = (1..=mesh.points().len()).map(|k| k as f64 / 3.0).collect();
    write_sizes(&path, &mesh, &sizes).expect("file");
    let text = std::fs::read_to_string(&path).expect("text");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(
        (lines[0], lines[lines.len() - 1]),
        ("View \"wanted edge length\" {", "};")
    );
    assert_eq!(lines.len(), mesh.tets().len() + 2);
    for (line, tet) in lines[1..].iter().zip(mesh.tets()) {
        let numbers = line.replace("SS(", "").replace("){", ",").replace("};", "");
        let numbers: Vec<f64> = numbers.split(',').map(|n| n.parse().expect(n)).collect();
        let places: Vec<f64> = tet.iter().flat_map(|n| mesh.points()[*n as usize]).collect();
        assert_eq!(numbers[..12], places);
        for (found, n) in numbers[12..].iter().zip(tet) {
            assert_abs_diff_eq!(*found, sizes[*n as usize], epsilon = 1e-5);
        }
    }
    for bad in [&sizes[1..], &[0.0; 5], &[f64::NAN; 5]] {
        let message = write_sizes(&path, &mesh, bad).expect_err("sizes").to_string();
        assert!(message.contains("one positive length a node"), "{message}");
    }
    let nowhere = folder.path().join("no/such/folder.pos");
    let message = write_sizes(&nowhere, &mesh, &sizes).expect_err("folder").to_string();
    assert!(message.contains("folder.pos"), "{message}");
}

/// What Gmsh's plugin Crack makes of a surface inside a block: facets on both sides with tags of their own.
#[test]
fn a_crack_of_gmsh_is_read() {
    let path = format!("{}/tests/data/crack.msh", env!("CARGO_MANIFEST_DIR"));
    let (mesh, names) = read_gmsh(path).expect("a mesh");
    let [lower, upper] = ["lower", "upper"].map(|name| mesh.nodes_on(names.surface(name).expect("a name")));
    let tip = lower.iter().filter(|node| upper.contains(node)).count();
    assert_eq!((lower.len(), tip), (upper.len(), 3));
    assert_eq!(mesh.components().iter().max(), Some(&0));
    assert!((mesh.total_volume() - 2.0).abs() < 1e-9);
}

/// A group of faces beside the volumes was told as a node number of 4294967295.
#[test]
fn a_group_of_faces_without_a_volume_is_named() {
    let loose = TEXT.replace("2 1 2 1\n2 3 1 2\n", "2 1 2 1\n2 3 1 6\n");
    let error = parse_gmsh(loose.as_bytes()).unwrap_err();
    assert!(matches!(error, GmshError::LooseSurface { surface: 3 }), "{error}");
    // without groups nobody asked for them
    let entities = TEXT.find("$PhysicalNames").zip(TEXT.find("$Nodes"));
    let (from, to) = entities.expect("sections");
    let plain = format!("{}{}", &loose[..from], &loose[to..]);
    let (mesh, _) = parse_gmsh(plain.as_bytes()).expect("a mesh");
    assert_eq!(mesh.tets().len(), 2);
}
