//! The brick and the operations on meshes.

use approx::assert_abs_diff_eq;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use signorini_fem_mesh::brick::{Brick, SIDES, X_MAX, Z_MIN};
use signorini_fem_mesh::{FacetTag, Surface, TetMesh};

fn area_vectors(mesh: &TetMesh, nodes: impl Iterator<Item = [u32; 3]>) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for nodes in nodes {
        let [p, q, r] = nodes.map(|n| mesh.points()[n as usize]);
        let (a, b) = ([0, 1, 2].map(|i| q[i] - p[i]), [0, 1, 2].map(|i| r[i] - p[i]));
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            sum[i] += 0.5 * (a[j] * b[k] - a[k] * b[j]);
        }
    }
    sum
}

#[test]
fn central_tetrahedra_join_even_vertices() {
    let brick = Brick::new([3.0, 2.0, 2.0], [3, 2, 2]);
    let mesh = brick.build().unwrap();
    // Unit cells: the coordinates are the indices.
    let central: Vec<_> = (0..mesh.tets().len()).filter(|&t| mesh.volume(t) > 0.3).collect();
    assert_eq!(central.len(), 3 * 2 * 2);
    for t in central {
        for p in mesh.tet_points(t) {
            assert_eq!((p[0] + p[1] + p[2]).round() as i64 % 2, 0);
        }
    }
    let node = brick.node([2, 1, 2]).expect("a node");
    assert_eq!(mesh.points()[node as usize], [2.0, 1.0, 2.0]);
    assert_eq!(mesh.nearest_node([2.1, 0.8, 9.0]), Some(node));
    assert_eq!(mesh.nearest_node([f64::NAN; 3]), None);
    let beyond = |axis| brick.node([0, 1, 2].map(|k| if k == axis { 100 } else { 0 }));
    assert!((0..3).all(|axis| beyond(axis).is_none()));
}

#[test]
fn sides_are_tagged_outward_and_complete() {
    let mesh = Brick::new([3.0, 1.0, 2.0], [6, 3, 4]).build().unwrap();
    assert_abs_diff_eq!(mesh.total_volume(), 6.0, epsilon = 1e-13);
    assert_eq!(mesh.extent(), ([0.0; 3], [3.0, 1.0, 2.0]));
    assert_eq!(mesh.facets().len(), mesh.boundary_facets().len());
    assert_eq!(mesh.tags().len(), 6);
    let areas = [2.0, 6.0, 3.0];
    for d in 0..3 {
        for (end, tag) in SIDES[d].into_iter().enumerate() {
            let of_tag = mesh.facets().iter().filter(|f| f.tag == tag).map(|f| f.nodes);
            let sum = area_vectors(&mesh, of_tag);
            let sign = if end == 0 { -1.0 } else { 1.0 };
            for i in 0..3 {
                let expected = if i == d { sign * areas[d] } else { 0.0 };
                assert!((sum[i] - expected).abs() < 1e-13, "{tag}");
            }
        }
    }
    for (number, facet) in mesh.facets().iter().enumerate() {
        let owner = mesh.tets()[mesh.facet_owner(number)];
        assert!(facet.nodes.iter().all(|n| owner.contains(n)));
    }
    assert!(mesh.nodes_on(FacetTag(1234)).is_empty());
}

#[test]
fn neighbours_are_mutual() {
    let mesh = Brick::new([1.0; 3], [3, 2, 2]).build().unwrap();
    let mut faces = 0;
    for tet in 0..mesh.tets().len() {
        for other in mesh.neighbours(tet).into_iter().flatten() {
            assert!(mesh.neighbours(other).contains(&Some(tet)));
            faces += 1;
        }
    }
    assert_eq!(faces + mesh.boundary_facets().len(), 4 * mesh.tets().len());
}

#[test]
fn grading_and_perturbation() {
    let brick = Brick::new([1.0, 1.0, 2.0], [4; 3]).graded([1.0, 8.0, 0.125]);
    let mesh = brick.build().unwrap();
    let y = |j| mesh.points()[brick.node([0, j, 0]).expect("a node") as usize][1];
    assert_abs_diff_eq!((y(4) - y(3)) / (y(1) - y(0)), 8.0, epsilon = 1e-12);
    assert_eq!(y(4), 1.0);
    let perturbed = brick.clone().perturbed(0.15, 7).build().unwrap();
    assert_abs_diff_eq!(perturbed.total_volume(), 2.0, epsilon = 1e-13);
    assert_eq!(perturbed, brick.clone().perturbed(0.15, 7).build().unwrap());
    assert_ne!(perturbed, brick.perturbed(0.15, 8).build().unwrap());
    let one_cell = Brick::new([1.0; 3], [1; 3]).graded([3.0; 3]).build().unwrap();
    assert_eq!(one_cell.extent().1, [1.0; 3]);
}

#[test]
fn several_bodies() {
    let below = Brick::new([1.0; 3], [2; 3]).build().unwrap();
    let above = Brick::new([1.0; 3], [2; 3])
        .with_origin([0.0, 0.0, 1.0])
        .build()
        .unwrap();
    let above = above
        .map_tags(|tag| FacetTag(tag.0 + 10))
        .with_regions(vec![5; 40])
        .unwrap();
    let both = below.append(&above).unwrap();
    assert_eq!(both.components().iter().filter(|&&c| c == 1).count(), 40);
    assert_eq!(both.nodes_on(FacetTag(Z_MIN.0 + 10))[0] as usize, below.points().len());
    assert_eq!(both.regions()[40], 5);
    // The joined tables are those that the checks would have made.
    let checked = TetMesh::new(both.points().to_vec(), both.tets().to_vec(), both.facets().to_vec());
    assert_eq!(checked.unwrap().with_regions(both.regions().to_vec()).unwrap(), both);
}

#[test]
fn tagging_by_place_and_normal() {
    let mesh = Brick::new([2.0, 1.0, 1.0], [4, 2, 2]).build().unwrap();
    let half = mesh
        .clone()
        .tag_boundary(|c, n| (n[2] < -0.5 && c[0] < 1.0).then_some(FacetTag(9)));
    assert_eq!(half.tags(), [FacetTag(9)]);
    let area = Surface::new(&half, &[FacetTag(9)]).unwrap().total_area();
    assert_abs_diff_eq!(area, 1.0, epsilon = 1e-14);
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 48,
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn any_brick_is_closed_and_fills_its_box(
        cells in prop::array::uniform3(1usize..5),
        lengths in prop::array::uniform3(1e-3..1e3),
        grading in prop::array::uniform3(0.2..5.0),
        origin in prop::array::uniform3(-10.0..10.0),
        seed in any::<u64>(),
    ) {
        let brick = Brick::new(lengths, cells).with_origin(origin);
        let mesh = brick.graded(grading).perturbed(0.15, seed).build().unwrap();
        let volume: f64 = lengths.iter().product();
        assert_abs_diff_eq!(mesh.total_volume() / volume, 1.0, epsilon = 1e-9);
        let closed = area_vectors(&mesh, mesh.boundary_facets().iter().map(|f| f.nodes));
        let scale: f64 = lengths.iter().map(|l| l * l).sum();
        prop_assert!(closed.iter().all(|c| c.abs() < 1e-10 * scale));
        let side = Surface::new(&mesh, &[X_MAX]).unwrap();
        assert_abs_diff_eq!(side.total_area() / (lengths[1] * lengths[2]), 1.0, epsilon = 1e-9);
    }

    #[test]
    fn units_change_nothing_but_numbers(exponent in -9i32..9) {
        let unit = 10f64.powi(exponent);
        let mesh = Brick::new([3.0, 1.0, 1.0], [3, 2, 2]).perturbed(0.1, 3).build().unwrap();
        let scaled = mesh.map_points(|p| p.map(|x| unit * x)).unwrap();
        prop_assert_eq!(scaled.tets(), mesh.tets());
        let ratio = scaled.total_volume() / mesh.total_volume() / unit.powi(3);
        assert_abs_diff_eq!(ratio, 1.0, epsilon = 1e-12);
    }
}
