//! Parts that were meshed apart.

use approx::assert_abs_diff_eq;
use signorini_fem_mesh::brick::{Brick, Z_MAX};
use signorini_fem_mesh::mesh::{drop_unused_nodes, merge_nodes};
use signorini_fem_mesh::{Facet, MeshError, TetMesh};

/// A body whose parts were meshed apart, with rounding: cut open, or two bodies, until nodes are merged.
#[test]
fn parts_meshed_apart_become_one_body() {
    let lower = Brick::new([1.0; 3], [2, 2, 2]).build().unwrap();
    let upper = lower.map_points(|[x, y, z]| [x + 1e-7, y, z + 1.0]).unwrap();
    let both = lower.append(&upper).unwrap();
    let top = |facets: &[Facet]| facets.iter().copied().find(|f| f.tag == Z_MAX);
    let merged = |distance: f64| {
        let (mut points, mut tets) = (both.points().to_vec(), both.tets().to_vec());
        let mut facets = vec![top(upper.facets()).unwrap()];
        let shift = lower.points().len() as u32;
        facets[0].nodes = facets[0].nodes.map(|n| n + shift);
        let count = merge_nodes(&points, &mut tets, &mut facets, distance);
        drop_unused_nodes(&mut points, &mut tets, &mut facets);
        let mesh = TetMesh::new(points, tets, facets).unwrap();
        (count, mesh.components().iter().max().copied(), mesh.total_volume())
    };
    for (distance, count, last) in [(0.0, 0, 1), (1e-9, 0, 1), (1e-6, 9, 0), (f64::NAN, 0, 1)] {
        let (gone, body, volume) = merged(distance);
        assert_eq!((gone, body), (count, Some(last)), "{distance}");
        assert_abs_diff_eq!(volume, 2.0, epsilon = 1e-6);
    }
    // no distance merges nothing, not even what is in one place
    let both = lower.append(&lower.map_points(|[x, y, z]| [x, y, z + 1.0]).unwrap());
    let (points, tets) = both.map(|b| (b.points().to_vec(), b.tets().to_vec())).unwrap();
    for (distance, count) in [(f64::NAN, 0), (-1.0, 0), (0.0, 9)] {
        assert_eq!(
            merge_nodes(&points, &mut tets.clone(), &mut [], distance),
            count,
            "{distance}"
        );
    }
    // too far: tetrahedra lose nodes, which the mesh reports; wrong numbers are left to it, too
    let (points, mut tets) = (lower.points().to_vec(), lower.tets().to_vec());
    assert_eq!(merge_nodes(&points, &mut tets, &mut [], 0.6), 26);
    let error = TetMesh::new(points.clone(), tets, vec![]).unwrap_err();
    assert!(matches!(error, MeshError::RepeatedNode { tet: 0, .. }), "{error}");
    let mut wrong = [[0, 1, 2, 99]];
    assert_eq!(merge_nodes(&points, &mut wrong, &mut [], 0.0), 0);
    assert_eq!(wrong[0][3], 99);
}

/// Far from the origin the same place has other last digits: one or two of them make no other node.
#[test]
fn nodes_far_from_the_origin_coincide() {
    for offset in [0.0, 1e4, 1e6] {
        let brick = Brick::new([0.3; 3], [3, 3, 3]).build().unwrap();
        let lower = brick.map_points(|p| p.map(|x| x + offset)).unwrap();
        let beside = brick.map_points(|[x, y, z]| [x + 0.1 + offset + 0.2, y + offset, z + offset]);
        let both = lower.append(&beside.unwrap()).unwrap();
        let merged = merge_nodes(both.points(), &mut both.tets().to_vec(), &mut [], 0.0);
        assert_eq!(merged, 16, "{offset}");
    }
}

/// A distance in another unit makes one node of all, in little memory.
#[test]
fn a_distance_in_another_unit_takes_no_memory() {
    let mesh = Brick::new([1.0; 3], [15; 3]).build().unwrap();
    for distance in [1e3, f64::MAX, f64::INFINITY] {
        let mut tets = mesh.tets().to_vec();
        let mut merged = 0;
        let used = allocation_counter::measure(|| merged = merge_nodes(mesh.points(), &mut tets, &mut [], distance));
        assert_eq!(merged + 1, mesh.points().len(), "{distance}");
        assert!(used.bytes_max < 1000 * mesh.points().len() as u64, "{used:?}");
    }
    // what is nowhere is not merged, but left for the mesh to report
    let mut points = mesh.points().to_vec();
    for nowhere in [f64::NAN, f64::INFINITY] {
        points[7][1] = nowhere;
        let mut tets = mesh.tets().to_vec();
        merge_nodes(&points, &mut tets, &mut [], f64::INFINITY);
        assert!(tets.as_flattened().contains(&7), "{nowhere}");
    }
}
