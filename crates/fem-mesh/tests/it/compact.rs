//! Parts made compact.

use signorini_fem_mesh::decomposition::compact_parts;
use signorini_fem_mesh::decomposition::split_disconnected;
use signorini_fem_mesh::mesh::drop_unused_nodes;
use signorini_fem_mesh::{Brick, Decomposition, DecompositionError, TetMesh};

fn brick() -> TetMesh {
    Brick::new([3.0, 1.0, 1.0], [18, 6, 6]).build().unwrap()
}

/// Numbers in [0, 1) from a seed.
fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

fn centre(mesh: &TetMesh, tet: usize) -> [f64; 3] {
    let p = mesh.tet_points(tet);
    std::array::from_fn(|d| p.iter().map(|x| x[d]).sum::<f64>() / 4.0)
}

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    (0..3).map(|d| (a[d] - b[d]).powi(2)).sum()
}

/// Each tetrahedron to the nearest of some random points.
fn voronoi(mesh: &TetMesh, count: usize, seed: u64) -> Vec<u32> {
    let (low, high) = mesh.extent();
    let mut random = random(seed);
    let points: Vec<[f64; 3]> = (0..count)
        .map(|_| std::array::from_fn(|d| low[d] + (high[d] - low[d]) * random()))
        .collect();
    let nearest = |tet| {
        let c = centre(mesh, tet);
        let nearer = |a: &usize, b: &usize| distance(&points[*a], &c).total_cmp(&distance(&points[*b], &c));
        (0..count).min_by(nearer).unwrap() as u32
    };
    (0..mesh.tets().len()).map(nearest).collect()
}

/// Mean squared distance of a tetrahedron from the centre of its part.
fn spread(mesh: &TetMesh, parts: &[u32]) -> f64 {
    let count = *parts.iter().max().unwrap() as usize + 1;
    let mut sums = vec![([0.0; 3], 0.0); count];
    for (tet, &part) in parts.iter().enumerate() {
        let c = centre(mesh, tet);
        (0..3).for_each(|d| sums[part as usize].0[d] += c[d]);
        sums[part as usize].1 += 1.0;
    }
    let means: Vec<[f64; 3]> = sums.iter().map(|(s, n)| s.map(|v| v / n)).collect();
    let off = parts.iter().enumerate();
    off.map(|(tet, &part)| distance(&centre(mesh, tet), &means[part as usize]))
        .sum::<f64>()
        / parts.len() as f64
}

/// One label for all tetrahedra: any part may have any of them.
fn one(mesh: &TetMesh) -> Vec<u32> {
    vec![0; mesh.tets().len()]
}

#[test]
fn random_cells_become_round_ones_of_similar_size() {
    let mesh = brick();
    let mean = mesh.tets().len() / 24;
    for seed in 1..4 {
        let cells = voronoi(&mesh, 24, seed);
        let parts = compact_parts(&mesh, &one(&mesh), &cells).unwrap();
        let cut = Decomposition::from_parts(&mesh, &parts).expect("connected, without gaps");
        assert_eq!(cut.subdomains().len(), 24);
        let sizes = |p: &[u32]| {
            let mut sizes = [0; 24];
            p.iter().for_each(|&part| sizes[part as usize] += 1);
            (*sizes.iter().min().unwrap(), *sizes.iter().max().unwrap())
        };
        let (before, after) = (sizes(&cells), sizes(&parts));
        assert!(
            2 * before.0 < mean && 3 * after.0 >= 2 * mean,
            "{before:?} {after:?} {mean}"
        );
        assert!(after.1 <= 3 * mean / 2, "{after:?}");
        assert!(spread(&mesh, &parts) < 0.8 * spread(&mesh, &cells));
        // a second time moves little
        let again = compact_parts(&mesh, &one(&mesh), &parts).unwrap();
        let moved = again.iter().zip(&parts).filter(|(a, b)| a != b).count();
        assert!(20 * moved <= parts.len(), "{moved}");
    }
}

#[test]
fn cubes_stay_as_they_are() {
    let mesh = brick();
    let boxes = Decomposition::boxes(&mesh, [3, 1, 1]).unwrap();
    assert_eq!(compact_parts(&mesh, &one(&mesh), boxes.parts()).unwrap(), boxes.parts());
}

#[test]
fn parts_stay_within_their_body_and_hang_together() {
    // a brick with a slot from above that nearly cuts it in two, and another body behind the slot
    let whole = brick();
    let kept: Vec<[u32; 4]> = (0..whole.tets().len())
        .filter(|&t| {
            let c = centre(&whole, t);
            !(c[0] > 1.3 && c[0] < 1.7 && c[2] > 0.2)
        })
        .map(|t| whole.tets()[t])
        .collect();
    let (mut points, mut tets) = (whole.points().to_vec(), kept);
    let all = points.clone();
    let shift = points.len() as u32;
    points.extend(all.iter().map(|p| [p[0], p[1] + 1.0, p[2]]));
    tets.extend(whole.tets().iter().map(|t| t.map(|n| n + shift)));
    drop_unused_nodes(&mut points, &mut tets, &mut []);
    let mesh = TetMesh::new(points, tets, Vec::new()).unwrap();
    let bodies = mesh.components();
    assert_eq!(bodies.iter().max(), Some(&1));
    for seed in 1..6 {
        let parts = compact_parts(&mesh, &one(&mesh), &voronoi(&mesh, 12, seed)).unwrap();
        assert_eq!(split_disconnected(&mesh, &parts).unwrap(), parts, "connected, in order");
        let mut of = vec![None; 64];
        for (&part, &body) in parts.iter().zip(&bodies) {
            assert_eq!(*of[part as usize].get_or_insert(body), body);
        }
    }
    // a checkerboard is in pieces all over
    let crumbs: Vec<u32> = (0..mesh.tets().len() as u32).map(|t| t % 7).collect();
    let parts = compact_parts(&mesh, &one(&mesh), &crumbs).unwrap();
    assert_eq!(split_disconnected(&mesh, &parts).unwrap(), parts);
}

#[test]
fn parts_stay_within_their_group() {
    let mesh = brick();
    let groups: Vec<u32> = (0..mesh.tets().len())
        .map(|t| u32::from(centre(&mesh, t)[0] > 1.2))
        .collect();
    let parts = compact_parts(&mesh, &groups, &voronoi(&mesh, 12, 1)).unwrap();
    assert_eq!(split_disconnected(&mesh, &parts).unwrap(), parts, "connected, in order");
    let mut of = vec![None; mesh.tets().len()];
    for (&part, &group) in parts.iter().zip(&groups) {
        assert_eq!(*of[part as usize].get_or_insert(group), group);
    }
}

#[test]
fn a_number_for_each_tetrahedron() {
    let mesh = brick();
    let all = one(&mesh);
    for (groups, parts) in [(&all[..], &[0][..]), (&[0], &all)] {
        let error = compact_parts(&mesh, groups, parts).unwrap_err();
        assert!(matches!(error, DecompositionError::PartCount { given: 1, .. }));
    }
}
