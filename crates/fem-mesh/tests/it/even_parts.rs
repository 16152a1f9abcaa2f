//! The cut of a mesh that comes without one: connected parts of similar size, boxes where boxes are best.

use signorini_fem_mesh::decomposition::{PartCount, even_parts};
use signorini_fem_mesh::mesh::drop_unused_nodes;
use signorini_fem_mesh::{Brick, Decomposition, DecompositionError, TetMesh};

fn brick(cells: [usize; 3]) -> TetMesh {
    Brick::new([3.0, 1.0, 1.0], cells).build().expect("a brick")
}

fn sizes(parts: &[u32]) -> Vec<usize> {
    let mut sizes = vec![0; parts.iter().max().map_or(0, |&p| p as usize + 1)];
    parts.iter().for_each(|&part| sizes[part as usize] += 1);
    sizes
}

/// One cut for the whole mesh, whatever its tetrahedra are made of.
fn even(mesh: &TetMesh, count: usize) -> Vec<u32> {
    even_parts(mesh, &vec![0; mesh.tets().len()], PartCount::Exactly(count)).expect("parts")
}

#[test]
fn a_brick_falls_into_its_boxes() {
    for (cells, boxes) in [
        ([15, 5, 5], [3, 1, 1]),
        ([24, 8, 8], [6, 2, 2]),
        ([45, 15, 15], [9, 3, 3]),
    ] {
        let mesh = brick(cells);
        let parts = even(&mesh, boxes.iter().product());
        let grid = Decomposition::boxes(&mesh, boxes).expect("boxes");
        let same = (0..parts.len()).all(|a| {
            let b = (a + 1) % parts.len();
            (parts[a] == parts[b]) == (grid.part_of(a) == grid.part_of(b))
        });
        assert!(same, "{boxes:?}: {:?}", sizes(&parts));
    }
}

#[test]
fn about_so_many_is_the_grid_nearest_by() {
    let labels = |mesh: &TetMesh| vec![0; mesh.tets().len()];
    for (cells, about, boxes) in [
        ([15, 5, 5], 3, 3),
        ([30, 10, 10], 21, 24),
        ([30, 10, 10], 27, 24),
        ([45, 15, 15], 72, 81),
        ([45, 15, 15], 90, 81),
    ] {
        let mesh = brick(cells);
        let parts = even_parts(&mesh, &labels(&mesh), PartCount::About(about)).expect("parts");
        assert_eq!(
            sizes(&parts),
            vec![parts.len() / boxes; boxes],
            "{cells:?} about {about}"
        );
    }
}

#[test]
fn any_count_gives_connected_parts_of_similar_size() {
    let mesh = brick([18, 6, 6]);
    for count in [1, 2, 5, 7, 13, 20, 31, 50] {
        let parts = even(&mesh, count);
        let sizes = sizes(&parts);
        let (least, most) = (*sizes.iter().min().unwrap(), *sizes.iter().max().unwrap());
        assert_eq!(sizes.len(), count);
        assert!(most <= 3 * least, "{count} parts: {least} to {most} tetrahedra");
        Decomposition::from_parts(&mesh, &parts).expect("connected parts");
    }
}

#[test]
fn no_part_reaches_into_another_body_or_group() {
    let one = brick([6, 2, 2]);
    let far = one.map_points(|p| [p[0] + 10.0, p[1], p[2]]).expect("moved");
    let mesh = one.append(&far).expect("two bodies");
    let half: Vec<u32> = (0..mesh.tets().len())
        .map(|tet| u32::from(mesh.tet_points(tet).iter().map(|p| p[2]).sum::<f64>() > 2.0))
        .collect();
    for count in [1, 4, 9, 30] {
        let parts = even_parts(&mesh, &half, PartCount::Exactly(count)).expect("parts");
        let bodies = mesh.components();
        let mut seen = vec![None; sizes(&parts).len()];
        for (tet, &part) in parts.iter().enumerate() {
            let own = (bodies[tet], half[tet]);
            assert_eq!(*seen[part as usize].get_or_insert(own), own);
        }
        assert!(
            seen.len() >= 4 && seen.len().abs_diff(count.max(4)) <= 2,
            "{} for {count}",
            seen.len()
        );
        Decomposition::from_parts(&mesh, &parts).expect("connected parts");
    }
}

/// A bolt: two of its three parts would be slices of head and shank together, were they cut along the box.
#[test]
fn cuts_go_through_necks() {
    let mesh = Brick::new([8.0, 8.0, 5.0], [8, 8, 5]).build().expect("brick");
    let height = |tet: usize| mesh.tet_points(tet).iter().map(|p| p[2]).sum::<f64>() / 4.0;
    let inside = |tet: &usize| {
        let off = |d: usize| (mesh.tet_points(*tet).iter().map(|p| p[d]).sum::<f64>() / 4.0 - 4.0).abs();
        height(*tet) > 3.0 || off(0).max(off(1)) < 2.0
    };
    let mut tets: Vec<[u32; 4]> = (0..mesh.tets().len())
        .filter(inside)
        .map(|tet| mesh.tets()[tet])
        .collect();
    let mut points = mesh.points().to_vec();
    drop_unused_nodes(&mut points, &mut tets, &mut []);
    let bolt = TetMesh::new(points, tets, Vec::new()).expect("a bolt");
    for count in [3, 4] {
        let parts = even(&bolt, count);
        let shank = |tet: &usize| bolt.tet_points(*tet).iter().map(|p| p[2]).sum::<f64>() < 12.0;
        let mut in_shank: Vec<u32> = (0..parts.len()).filter(shank).map(|tet| parts[tet]).collect();
        in_shank.sort_unstable();
        in_shank.dedup();
        assert_eq!(in_shank.len(), 1, "{count} parts: {:?}", sizes(&parts));
    }
}

#[test]
fn more_parts_than_tetrahedra_are_as_many_as_there_are() {
    let mesh = brick([1, 1, 1]);
    let tets = mesh.tets().len();
    assert_eq!(sizes(&even(&mesh, 1000)), vec![1; tets]);
}

#[test]
fn bad_input_is_refused() {
    let mesh = brick([2, 1, 1]);
    let labels = vec![0; mesh.tets().len()];
    assert_eq!(
        even_parts(&mesh, &labels, PartCount::About(0)),
        Err(DecompositionError::NoParts)
    );
    let short = even_parts(&mesh, &labels[1..], PartCount::Exactly(2));
    assert!(matches!(short, Err(DecompositionError::PartCount { .. })));
}
