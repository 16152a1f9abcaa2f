//! Meshes that are cut open.

use std::cell::Cell;
use std::collections::BTreeMap;

use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use signorini_fem_mesh::brick::{X_MAX, X_MIN, Z_MIN};
use signorini_fem_mesh::decomposition::{PartCount, compact_parts, even_parts};
use signorini_fem_mesh::mesh::{drop_unused_nodes, orient_tets};
use signorini_fem_mesh::vec3::{add, area_vector, centroid, norm};
use signorini_fem_mesh::{Brick, Decomposition, Facet, FacetTag, MeshError, TetMesh};

const TAGS: [FacetTag; 2] = [FacetTag(31), FacetTag(32)];

/// The mesh, or that of order 2 with the same tetrahedra.
fn of_order(order: usize, mesh: TetMesh) -> TetMesh {
    match order {
        1 => mesh,
        _ => mesh.raise_order().expect("order 2"),
    }
}

fn bar(order: usize) -> TetMesh {
    let mesh = Brick::new([2.0, 1.0, 1.0], [6, 3, 3])
        .perturbed(0.1, 5)
        .build()
        .expect("brick");
    of_order(order, mesh)
}

fn middle(mesh: &TetMesh, tet: usize) -> [f64; 3] {
    centroid(&mesh.tet_points(tet))
}

/// The boundary is closed, and what is known of the mesh is as of one that is made anew.
fn assert_sound(cut: &TetMesh) {
    let sum = cut.boundary_facets().iter().fold([0.0; 3], |sum, facet| {
        add(sum, area_vector(&facet.nodes.map(|n| cut.points()[n as usize])))
    });
    assert!(norm(sum) < 1e-12);
    let again = match cut.order() {
        1 => TetMesh::new(cut.points().to_vec(), cut.tets().to_vec(), cut.facets().to_vec()),
        _ => TetMesh::quadratic(cut.points().to_vec(), cut.quadratic_tets(), cut.facets().to_vec()),
    };
    assert_eq!(again.expect("a mesh"), *cut);
}

/// Facets of both sides lie on each other, the mesh falls into two bodies, and everything else stays.
#[test]
fn both_sides_match() {
    for order in [1, 2] {
        let whole = bar(order);
        let (cut, copied) = whole.cut(|tet| Some(middle(&whole, tet)[0] < 0.9), TAGS).expect("cut");
        assert_eq!(cut.points().len(), whole.points().len() + copied.len());
        for (k, &node) in copied.iter().enumerate() {
            assert_eq!(cut.points()[whole.points().len() + k], cut.points()[node as usize]);
        }
        let [first, second] = TAGS.map(|tag| cut.nodes_on(tag));
        assert_eq!(first, copied);
        assert_eq!(second.len(), copied.len());
        assert!(second.iter().all(|n| *n as usize >= whole.points().len()));
        let bodies = cut.components();
        assert!(
            bodies
                .iter()
                .enumerate()
                .all(|(t, b)| (*b == 0) == (middle(&whole, t)[0] < 0.9) || *b == 1)
        );
        assert_eq!(bodies.iter().max(), Some(&1));
        for tag in [X_MAX, Z_MIN] {
            assert_eq!(
                cut.facets().iter().filter(|f| f.tag == tag).count(),
                whole.facets().iter().filter(|f| f.tag == tag).count()
            );
        }
        assert_eq!(
            (cut.total_volume(), cut.tets().len()),
            (whole.total_volume(), whole.tets().len())
        );
        assert_sound(&cut);
        assert_eq!(Decomposition::whole(&cut).subdomains().len(), 2);
    }
}

/// A ring that is cut once stays one body, and nodes on both sides differ.
#[test]
fn a_ring_opens() {
    let (mut points, mut tets) = {
        let plate = Brick::new([3.0, 3.0, 1.0], [3, 3, 1]).build().expect("brick");
        (plate.points().to_vec(), plate.tets().to_vec())
    };
    let outer = |t: &[u32; 4]| {
        let [x, y, _] = centroid(&t.map(|n| points[n as usize]));
        (x - 1.5).abs() > 0.5 || (y - 1.5).abs() > 0.5
    };
    tets.retain(outer);
    drop_unused_nodes(&mut points, &mut tets, &mut []);
    let ring = TetMesh::new(points, tets, Vec::new()).expect("ring");
    let side = |tet: usize| {
        let [x, y, _] = middle(&ring, tet);
        (y < 1.0).then_some(x < 1.0)
    };
    let (open, copied) = ring.cut(side, TAGS).expect("cut");
    assert_eq!(copied.len(), 4);
    assert_eq!(open.components().iter().max(), Some(&0));
    let facets = |tag| open.facets().iter().filter(move |f| f.tag == tag).count();
    assert_eq!((facets(TAGS[0]), facets(TAGS[1])), (2, 2));
}

/// Cuts may cross one another.
#[test]
fn cuts_cross() {
    let whole = bar(1);
    let (once, first) = whole.cut(|tet| Some(middle(&whole, tet)[0] < 0.9), TAGS).expect("cut");
    let others = [FacetTag(33), FacetTag(34)];
    let (twice, second) = once.cut(|tet| Some(middle(&once, tet)[1] < 0.5), others).expect("cut");
    assert_eq!(twice.components().iter().max(), Some(&3));
    assert!(!first.is_empty() && !second.is_empty());
    assert!((twice.total_volume() - 2.0).abs() < 1e-12);
}

#[test]
fn cuts_that_are_none_are_refused() {
    let whole = bar(1);
    assert_eq!(whole.cut(|_| Some(true), TAGS), Err(MeshError::NoCut));
    assert_eq!(whole.cut(|_| None, TAGS), Err(MeshError::NoCut));
    // through a half only
    let half = |tet: usize| {
        let [x, y, _] = middle(&whole, tet);
        (y < 0.5).then_some(x < 0.9)
    };
    let error = whole.cut(half, TAGS).expect_err("ends inside");
    assert!(matches!(error, MeshError::CutEnds { .. }), "{error}");
}

fn in_plane(face: [[f64; 3]; 3]) -> bool {
    face.iter().all(|p| (p[2] - 0.5).abs() < 1e-9)
}

/// A block with layers that are plane.
fn layers(order: usize) -> TetMesh {
    let mesh = Brick::new([2.0, 2.0, 1.0], [6, 6, 2]).build().expect("brick");
    of_order(order, mesh)
}

/// A crack inside a block: its tip is on both sides, all other nodes on one, and the block stays one body. One that
/// leads through is a cut.
#[test]
fn a_crack_keeps_its_tip() {
    for order in [1, 2] {
        let whole = layers(order);
        let is_lower = |tet: usize| middle(&whole, tet)[2] < 0.5;
        let radius = |p: [f64; 3]| (p[0] - 1.0).hypot(p[1] - 1.0);
        let is_on = |face: [[f64; 3]; 3]| in_plane(face) && face.iter().all(|p| radius(*p) < 0.8);
        let (cracked, copied) = whole.crack(is_on, is_lower, TAGS).expect("crack");
        assert_sound(&cracked);
        assert_eq!(cracked.components(), whole.components());
        let [low, up] = TAGS.map(|tag| cracked.nodes_on(tag));
        let tip: Vec<u32> = low.iter().copied().filter(|n| up.contains(n)).collect();
        assert_eq!(low.len(), tip.len() + copied.len());
        assert!(copied.iter().all(|n| low.contains(n) && !tip.contains(n)));
        let smallest = tip
            .iter()
            .map(|n| radius(whole.points()[*n as usize]))
            .fold(f64::INFINITY, f64::min);
        assert!(smallest > 0.5, "{smallest}");
        let facets = |tag| cracked.facets().iter().filter(move |f| f.tag == tag).count();
        let inside = whole.tets().iter().enumerate().filter(|(t, _)| is_lower(*t));
        let faces = inside.flat_map(|(_, t)| [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]].map(|f| f.map(|k| t[k])));
        let faces = faces.filter(|f| is_on(f.map(|n| whole.points()[n as usize])));
        // all of them but those with all corners at the tip
        let open = faces.filter(|f| f.iter().any(|n| copied.contains(n))).count();
        assert_eq!((facets(TAGS[0]), facets(TAGS[1])), (open, open));
        let through = whole.crack(in_plane, is_lower, TAGS).expect("through");
        assert_eq!(through, whole.cut(|tet| Some(is_lower(tet)), TAGS).expect("cut"));
    }
}

#[test]
fn cracks_that_are_none_are_refused() {
    let whole = layers(2);
    let is_lower = |tet: usize| middle(&whole, tet)[2] < 0.5;
    assert_eq!(whole.crack(|_| false, is_lower, TAGS), Err(MeshError::NoCut));
    // a face alone inside is all tip
    let one = whole.tets().iter().find_map(|t| {
        let faces = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]].map(|f| f.map(|k| whole.points()[t[k] as usize]));
        let inner = |face: &[[f64; 3]; 3]| {
            in_plane(*face)
                && face
                    .iter()
                    .all(|p| (0.1..1.9).contains(&p[0]) && (0.1..1.9).contains(&p[1]))
        };
        faces.into_iter().find(inner)
    });
    let one = one.expect("a face");
    let is_one = |face: [[f64; 3]; 3]| face.iter().all(|p| one.contains(p));
    assert_eq!(whole.crack(is_one, is_lower, TAGS), Err(MeshError::NoCut));
    let error = whole.crack(in_plane, |_| true, TAGS).expect_err("one side");
    assert!(matches!(error, MeshError::CrackSides { .. }), "{error}");
}

/// Whatever is said of a face holds for both sides.
#[test]
fn a_face_is_asked_for_once() {
    for order in [1, 2] {
        let whole = layers(order);
        let is_lower = |tet: usize| middle(&whole, tet)[2] < 0.5;
        let upward = |face: [[f64; 3]; 3]| in_plane(face) && area_vector(&face)[2] > 0.0;
        let turn = Cell::new(0_usize);
        let at_times = |face| {
            turn.set(turn.get() + 1);
            in_plane(face) && !turn.get().is_multiple_of(3)
        };
        let found = [
            whole.crack(upward, is_lower, TAGS),
            whole.crack(at_times, is_lower, TAGS),
        ];
        for (cracked, _) in found.into_iter().flatten() {
            assert_sound(&cracked);
        }
        let faces = whole.tets().len() * 4 - whole.boundary_facets().len();
        assert_eq!(turn.get(), faces / 2);
    }
}

/// A crack without tags moves with its body; what else meets in a map is a fault.
#[test]
fn cracks_without_tags_are_moved() {
    for order in [1, 2] {
        let whole = layers(order);
        let is_lower = |tet: usize| middle(&whole, tet)[2] < 0.5;
        let is_on = |face: [[f64; 3]; 3]| in_plane(face) && face.iter().all(|p| p[0] < 1.5);
        let cracked = whole.crack(is_on, is_lower, TAGS).expect("crack").0;
        let moved = |mesh: &TetMesh| mesh.map_points(|[x, y, z]| [x + 1.0, 2.0 * y, z]);
        let tagged = moved(&cracked).expect("tags");
        for bare in [
            cracked.clone().without_tags(&TAGS),
            cracked.clone().tag_boundary(|_, _| None),
        ] {
            let bare = moved(&bare).expect("no tags");
            assert_eq!(bare.points(), tagged.points());
            assert_eq!(bare.boundary_facets(), tagged.boundary_facets());
        }
        assert_sound(&tagged);
    }
    // a slot that a map closes
    let whole = Brick::new([1.0, 1.0, 1.0], [4, 2, 4]).build().expect("brick");
    let (mut points, mut tets) = (whole.points().to_vec(), whole.tets().to_vec());
    tets.retain(|tet| {
        let [x, _, z] = centroid(&tet.map(|n| whole.points()[n as usize]));
        x > 0.5 || (z - 0.375).abs() > 0.125
    });
    drop_unused_nodes(&mut points, &mut tets, &mut []);
    let open = TetMesh::new(points, tets, Vec::new()).expect("a slot");
    let close = |[x, y, z]: [f64; 3]| [x, y, if x < 0.5 && z > 0.3 { z - 0.25 } else { z }];
    let error = open.map_points(close).expect_err("closed");
    assert!(matches!(error, MeshError::CoincidentNodes { .. }), "{error}");
}

/// No subdomain hangs together by what is left around a crack; a crack that is small against its part stays in it.
#[test]
fn parts_do_not_straddle_a_crack() {
    let whole = Brick::new([2.0, 2.0, 2.0], [8, 8, 8]).build().expect("brick");
    let is_lower = |tet: usize| middle(&whole, tet)[2] < 1.0;
    let is_on = |face: [[f64; 3]; 3]| face.iter().all(|p| p[2] == 1.0 && p[0] < 1.6);
    let cracked = whole.crack(is_on, is_lower, TAGS).expect("crack").0;
    // the largest area of the crack that one part has on both sides
    let on_both_sides = |parts: &[u32]| {
        let mut areas: BTreeMap<u32, [f64; 2]> = BTreeMap::new();
        for (k, facet) in cracked.facets().iter().enumerate() {
            if let Some(side) = TAGS.iter().position(|tag| *tag == facet.tag) {
                let area = norm(area_vector(&cracked.facet_points(k)));
                areas.entry(parts[cracked.facet_owner(k)]).or_default()[side] += area;
            }
        }
        areas.values().map(|[low, up]| low.min(*up)).fold(0.0, f64::max)
    };
    let groups = vec![0; cracked.tets().len()];
    for count in [1, 3, 5, 12, 27] {
        let parts = even_parts(&cracked, &groups, PartCount::Exactly(count)).expect("parts");
        let subdomains = Decomposition::from_parts(&cracked, &parts).expect("connected");
        assert!((count..=2 * count).contains(&subdomains.subdomains().len()));
        assert!(on_both_sides(&parts) < 0.1, "{count} parts");
        let whole_parts = even_parts(&whole, &groups, PartCount::Exactly(count)).expect("parts");
        let again = compact_parts(&cracked, &groups, &whole_parts).expect("parts");
        assert!(on_both_sides(&again) < 0.1, "{count} compact parts");
    }
    let is_on = |face: [[f64; 3]; 3]| face.iter().all(|p| p[2] == 1.0 && p[0].max(p[1]) < 0.3);
    let cracked = whole.crack(is_on, is_lower, TAGS).expect("crack").0;
    let parts = even_parts(&cracked, &groups, PartCount::Exactly(3)).expect("parts");
    assert_eq!(parts.iter().max(), Some(&2));
}

/// Ragged cracks that cross others and end at their tips: meshes as those that are made anew, and the same nodes
/// whether the order is raised before or after.
#[test]
fn ragged_cracks_leave_sound_meshes() {
    let mut dice = Pcg64Mcg::new(0x9e37_79b9_7f4a_7c15);
    let mut cracks = 0;
    for _ in 0..150 {
        let cells = [0; 3].map(|_| 2 * dice.random_range(1..3_usize));
        let whole = Brick::new([1.0; 3], cells).build().expect("brick");
        let [mut early, mut late] = [whole.raise_order().expect("order 2"), whole];
        for k in 0..3 {
            let axis = dice.random_range(0..3);
            let at = dice.random_range(1..cells[axis]) as f64 / cells[axis] as f64;
            let share = [0.4, 0.7, 1.0][dice.random_range(0..3)];
            let chosen: Vec<bool> = (0..4096).map(|_| dice.random::<f64>() < share).collect();
            let is_on = |face: [[f64; 3]; 3]| {
                let [x, y, z] = centroid(&face).map(|c| (16.0 * c) as usize % 16);
                face.iter().all(|p| (p[axis] - at).abs() < 1e-9) && chosen[256 * x + 16 * y + z]
            };
            let tags = [100 + 2 * k, 101 + 2 * k].map(FacetTag);
            let crack = |mesh: &TetMesh| mesh.crack(is_on, |tet| middle(mesh, tet)[axis] < at, tags);
            match [&early, &late].map(crack) {
                [Ok(one), Ok(other)] => [early, late] = [one.0, other.0],
                [one, other] => assert_eq!(one.err(), other.err()),
            }
        }
        if early.facets().is_empty() {
            continue;
        }
        cracks += 1;
        assert_sound(&early);
        assert_sound(&late);
        assert_eq!(
            early.points().len(),
            late.raise_order().expect("order 2").points().len()
        );
        let groups = vec![0; late.tets().len()];
        for count in [2, 5, 11] {
            let parts = even_parts(&late, &groups, PartCount::Exactly(count)).expect("parts");
            Decomposition::from_parts(&late, &parts).expect("connected");
        }
    }
    assert!(cracks > 100);
}

/// Layers between cracks stay whole: both skins of one are no two sides of a crack.
#[test]
fn layers_between_cracks_stay_whole() {
    for thick in [1, 2] {
        let layers = 6;
        let lengths = [2.0, 1.0, f64::from(layers * thick) / 12.0];
        let mut mesh = Brick::new(lengths, [24, 12, (layers * thick) as usize])
            .build()
            .expect("brick");
        for k in 1..layers {
            let at = f64::from(k * thick) / 12.0;
            let is_on = |face: [[f64; 3]; 3]| face.iter().all(|p| (p[2] - at).abs() < 1e-9 && p[0] < 1.5);
            let tags = [100 + 2 * k, 101 + 2 * k].map(|tag| FacetTag(tag as u32));
            mesh = mesh
                .crack(is_on, |tet| middle(&mesh, tet)[2] < at, tags)
                .expect("crack")
                .0;
        }
        let groups = vec![0; mesh.tets().len()];
        for (count, most) in [(1, 6), (4, 20), (16, 40)] {
            let parts = even_parts(&mesh, &groups, PartCount::Exactly(count)).expect("parts");
            let found = parts.iter().max().map_or(0, |part| part + 1);
            assert!(found <= most, "{thick} cells thick, {count} parts: {found}");
        }
    }
}

/// A ring whose ends were not merged has nodes on tagged facets, but none of these face each other.
#[test]
fn what_nobody_merged_is_no_crack() {
    let bar = Brick::new([1.0; 3], [12, 1, 1]).build().expect("brick");
    let (turn, radius) = (std::f64::consts::TAU, |y: f64| 1.0 + y);
    let points: Vec<[f64; 3]> = bar
        .points()
        .iter()
        .map(|[x, y, z]| {
            [
                radius(*y) * (turn * (x % 1.0)).cos(),
                radius(*y) * (turn * (x % 1.0)).sin(),
                *z,
            ]
        })
        .collect();
    let mut tets = bar.tets().to_vec();
    orient_tets(&points, &mut tets);
    let on_ends = |f: &&Facet| f.tag != X_MIN && f.tag != X_MAX;
    let facets: Vec<Facet> = bar.facets().iter().filter(on_ends).copied().collect();
    let error = TetMesh::new(points, tets, facets).expect_err("open");
    assert!(matches!(error, MeshError::CoincidentNodes { .. }), "{error}");
}
