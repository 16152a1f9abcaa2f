//! Normals, frames and areas on flat and curved surfaces.

use approx::assert_abs_diff_eq;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use signorini_fem_mesh::brick::{Brick, X_MIN, Z_MAX, Z_MIN};
use signorini_fem_mesh::vec3::{dot, norm, sub};
use signorini_fem_mesh::{Surface, SurfaceFrame, TetMesh};

#[test]
fn paper_frame_on_the_brick() {
    let mesh = Brick::new([3.0, 1.0, 1.0], [15, 5, 5]).build().unwrap();
    let surface = Surface::new(&mesh, &[Z_MIN]).unwrap();
    assert_eq!(surface.nodes(), mesh.nodes_on(Z_MIN));
    for frame in surface.frames() {
        assert_eq!(frame.normal, [0.0, 0.0, -1.0]);
        assert_eq!(frame.tangents, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        let components = frame.normal.iter().chain(frame.tangents.iter().flatten());
        assert!(components.into_iter().all(|c| *c != 0.0 || c.is_sign_positive()));
    }
    assert_abs_diff_eq!(surface.total_area(), 3.0, epsilon = 1e-13);
    for (place, &node) in surface.nodes().iter().enumerate() {
        assert_eq!(surface.local(node), Some(place));
        let [x, y, _] = mesh.points()[node as usize];
        // Around an inner node lie four or eight halves of a cell.
        let inner = x > 0.1 && x < 2.9 && y > 0.1 && y < 0.9;
        if inner {
            let cells = 3.0 * surface.areas()[place] / (0.2 * 0.2);
            assert!((cells - 2.0).abs() < 1e-12 || (cells - 4.0).abs() < 1e-12);
        }
    }
    assert_eq!(surface.local(u32::MAX), None);
}

#[test]
fn several_tags_make_one_surface() {
    let mesh = Brick::new([3.0, 1.0, 1.0], [6, 2, 2]).build().unwrap();
    let both = Surface::new(&mesh, &[X_MIN, Z_MIN]).unwrap();
    assert_abs_diff_eq!(both.total_area(), 4.0, epsilon = 1e-13);
    assert_eq!(both.triangles().len(), both.facets().len());
    // On the common edge the normal lies between those of the sides.
    let edge = both.local(mesh.nodes_on(X_MIN)[1]).unwrap();
    let normal = both.frames()[edge].normal;
    assert!(normal[0] < -0.3 && normal[2] < -0.3 && normal[1].abs() < 1e-15);
}

/// A block whose lower side is bent to a part of a sphere of the given radius.
fn cap(radius: f64, cells: usize) -> TetMesh {
    let brick = Brick::new([1.0; 3], [cells; 3])
        .with_origin([-0.5, -0.5, 0.0])
        .build()
        .unwrap();
    let bend = |[x, y, z]: [f64; 3]| {
        let rise = radius - (radius * radius - x * x - y * y).sqrt();
        [x, y, z + (1.0 - z) * rise]
    };
    brick.map_points(bend).unwrap()
}

/// However uneven the facets are.
#[test]
fn normals_of_a_sphere_are_exact() {
    let mesh = cap(1.0, 8);
    let surface = Surface::new(&mesh, &[Z_MIN]).unwrap();
    for (&node, frame) in surface.nodes().iter().zip(surface.frames()) {
        let [x, y, z] = mesh.points()[node as usize];
        if x.abs() < 0.45 && y.abs() < 0.45 {
            let error = norm(sub(frame.normal, [x, y, z - 1.0]));
            assert!(error < 1e-14, "{error:e} at {x}, {y}");
        }
    }
}

#[test]
fn top_frame_points_up() {
    let mesh = Brick::new([1.0; 3], [1; 3]).build().unwrap();
    let frame = Surface::new(&mesh, &[Z_MAX]).unwrap().frames()[0];
    assert_eq!(frame.normal, [0.0, 0.0, 1.0]);
    assert_eq!(frame.tangents[0], [1.0, 0.0, 0.0]);
    let side = SurfaceFrame::from_normal([2.0, 0.0, 0.0]).unwrap();
    assert_eq!(side.tangents[0], [0.0, 1.0, 0.0]);
    assert!(SurfaceFrame::from_normal([0.0; 3]).is_none());
    assert!(SurfaceFrame::from_normal([f64::NAN, 0.0, 1.0]).is_none());
    assert!(SurfaceFrame::from_normal([1e-200, 0.0, 1e-200]).is_some());
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 256,
        rng_seed: RngSeed::Fixed(3),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn frames_are_orthonormal_and_invertible(
        normal in prop::array::uniform3(-1.0f64..1.0),
        v in prop::array::uniform3(-10.0f64..10.0),
    ) {
        prop_assume!(dot(normal, normal) > 1e-6);
        let frame = SurfaceFrame::from_normal(normal).unwrap();
        let [t1, t2] = frame.tangents;
        for (a, b, expected) in [
            (frame.normal, frame.normal, 1.0), (t1, t1, 1.0), (t2, t2, 1.0),
            (frame.normal, t1, 0.0), (frame.normal, t2, 0.0), (t1, t2, 0.0),
        ] {
            assert_abs_diff_eq!(dot(a, b), expected, epsilon = 1e-14);
        }
        let back = frame.vector(frame.normal_part(v), frame.tangential_part(v));
        for i in 0..3 {
            assert_abs_diff_eq!(back[i], v[i], epsilon = 1e-13);
        }
    }

    #[test]
    fn tangents_turn_continuously(
        normal in prop::array::uniform3(-1.0f64..1.0),
        step in prop::array::uniform3(-1e-6f64..1e-6),
    ) {
        prop_assume!(normal[1].hypot(normal[2]) > 0.1);
        let near = [0, 1, 2].map(|i| normal[i] + step[i]);
        let (a, b) = (SurfaceFrame::from_normal(normal).unwrap(), SurfaceFrame::from_normal(near).unwrap());
        for i in 0..3 {
            assert_abs_diff_eq!(a.tangents[0][i], b.tangents[0][i], epsilon = 1e-3);
        }
    }
}
