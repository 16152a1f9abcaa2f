//! Decompositions of the brick: counts, copies, translates.

use approx::assert_abs_diff_eq;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use signorini_fem_mesh::decomposition::split_disconnected;
use signorini_fem_mesh::{Brick, Decomposition, TetMesh};

fn brick(n: usize) -> (TetMesh, Decomposition) {
    let mesh = Brick::new([3.0, 1.0, 1.0], [15 * n, 5 * n, 5 * n]).build().unwrap();
    let parts = Decomposition::boxes(&mesh, [3 * n, n, n]).unwrap();
    (mesh, parts)
}

#[test]
fn torn_unknowns_are_those_of_table_6_1() {
    for (n, expected) in [(1, 1944), (2, 15552), (3, 52488)] {
        let (mesh, parts) = brick(n);
        assert_eq!(parts.subdomains().len(), 3 * n * n * n);
        assert_eq!(parts.torn_dofs(), expected);
        let copies: usize = (0..mesh.points().len()).map(|i| parts.copies(i).len()).sum();
        assert_eq!(3 * copies, expected);
    }
}

#[test]
fn copies_lead_back_to_their_node() {
    let (mesh, parts) = brick(1);
    for node in 0..mesh.points().len() {
        let copies = parts.copies(node);
        assert!(copies.windows(2).all(|c| c[0].subdomain < c[1].subdomain));
        for copy in copies {
            let subdomain = &parts.subdomains()[copy.subdomain as usize];
            assert_eq!(subdomain.nodes[copy.local as usize] as usize, node);
            assert_eq!(subdomain.local(node as u32), Some(copy.local as usize));
        }
    }
    for (number, subdomain) in parts.subdomains().iter().enumerate() {
        for (local, &element) in subdomain.tets.iter().zip(&subdomain.elements) {
            assert_eq!(parts.parts()[element as usize] as usize, number);
            assert_eq!(
                local.map(|n| subdomain.nodes[n as usize]),
                mesh.tets()[element as usize]
            );
        }
    }
}

#[test]
fn translates_of_equal_parity_have_equal_tables() {
    let (mesh, parts) = brick(2);
    let parity = |s: usize| (s % 2 + s / 2 % 2 + s / 4) % 2;
    let subdomains = parts.subdomains();
    for s in 0..subdomains.len() {
        let reference = &subdomains[parity(s)];
        assert_eq!(subdomains[s].tets, reference.tets);
        let (p, q) = (subdomains[s].points(&mesh), reference.points(&mesh));
        for n in 0..p.len() {
            for d in 0..3 {
                assert_abs_diff_eq!((p[n][d] - p[0][d]), (q[n][d] - q[0][d]), epsilon = 1e-14);
            }
        }
    }
    assert_ne!(subdomains[0].tets, subdomains[1].tets);
}

#[test]
fn whole_is_one_subdomain_a_body() {
    let (mesh, _) = brick(1);
    let whole = Decomposition::whole(&mesh);
    assert_eq!(whole.subdomains().len(), 1);
    assert_eq!(whole.torn_dofs(), 3 * mesh.points().len());
    assert_eq!(whole.subdomains()[0].tets, mesh.tets());
    let two = mesh
        .append(&mesh.map_points(|[x, y, z]| [x, y, z + 2.0]).unwrap())
        .unwrap();
    assert_eq!(Decomposition::whole(&two).subdomains().len(), 2);
}

#[test]
fn parts_by_number_agree_with_boxes() {
    let (mesh, boxes) = brick(1);
    assert_eq!(Decomposition::from_parts(&mesh, boxes.parts()).unwrap(), boxes);
}

/// Two towers of the same boxes, apart in y, beside a gap in x: towers[0] at x in (0, 1),
/// towers[1] at x in (3, 4).
fn towers() -> TetMesh {
    let tower = Brick::new([1.0, 1.0, 2.0], [2, 2, 4]).build().unwrap();
    let at = |x, y| tower.map_points(|p| [p[0] + x, p[1] + y, p[2]]).unwrap();
    at(0.0, 0.0)
        .append(&at(0.0, 2.0))
        .and_then(|m| m.append(&at(3.0, 0.0)))
        .unwrap()
}

#[test]
fn empty_boxes_are_dropped_and_disconnected_ones_split() {
    let mesh = towers();
    let tower = mesh.tets().len() / 3;
    // along x, the slowest: towers 0 and 1, nothing, nothing, tower 2; along z: two storeys
    let parts = Decomposition::boxes(&mesh, [4, 1, 2]).unwrap();
    let expected = (0..3 * tower).map(|tet| {
        let storey = u32::from(mesh.tet_points(tet).iter().map(|p| p[2]).sum::<f64>() > 4.0);
        match (tet / tower) as u32 {
            2 => 4 + storey,
            first => first + 2 * storey,
        }
    });
    assert_eq!(parts.parts(), expected.collect::<Vec<_>>());
    assert_eq!(parts.subdomains().len(), 6);
    assert_eq!(Decomposition::from_parts(&mesh, parts.parts()).unwrap(), parts);
}

/// Boxes that cut cells apart, more boxes than tetrahedra, and products that overflow.
#[test]
fn any_counts_give_connected_subdomains() {
    let mesh = Brick::new([3.0, 1.0, 1.0], [6, 2, 2]).build().unwrap();
    for counts in [[4, 1, 1], [9, 1, 1], [5, 3, 7], [100; 3], [usize::MAX; 3]] {
        let parts = Decomposition::boxes(&mesh, counts).unwrap();
        assert_eq!(
            Decomposition::from_parts(&mesh, parts.parts()).unwrap(),
            parts,
            "{counts:?}"
        );
        // the pieces of any numbers are the same sets
        let split = split_disconnected(&mesh, parts.parts()).unwrap();
        assert_eq!(split.iter().max(), Some(&(parts.subdomains().len() as u32 - 1)));
    }
    let all = Decomposition::boxes(&mesh, [usize::MAX; 3]).unwrap();
    assert_eq!(all.subdomains().len(), mesh.tets().len());
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 32,
        rng_seed: RngSeed::Fixed(6),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    /// However the tetrahedra are thrown together, the split parts are a valid decomposition that
    /// loses nothing and refines the parts given.
    #[test]
    fn any_parts_can_be_split(numbers in prop::collection::vec(0u32..4, 135)) {
        let mesh = Brick::new([1.0; 3], [3; 3]).build().unwrap();
        let split = split_disconnected(&mesh, &numbers).unwrap();
        let parts = Decomposition::from_parts(&mesh, &split).unwrap();
        let mut elements = 0;
        for subdomain in parts.subdomains() {
            elements += subdomain.elements.len();
            let first = numbers[subdomain.elements[0] as usize];
            prop_assert!(subdomain.elements.iter().all(|&e| numbers[e as usize] == first));
            prop_assert!(subdomain.nodes.windows(2).all(|n| n[0] < n[1]));
        }
        prop_assert_eq!(elements, mesh.tets().len());
        prop_assert!((0..mesh.points().len()).all(|n| !parts.copies(n).is_empty()));
    }
}
