//! Rows of `B` at supports: contact nodes that are supported too, doubled supports, prescribed motions.

use crate::common::{Brick, dot, gluing, gram, is_orthonormal, smallest_eigenvalue};
use signorini_fem_mesh::{SurfaceFrame, brick, vec3};
use signorini_tfeti::internal::{MergedSupports, prescribed_points};
use signorini_tfeti::{ContactConstraint, Directions, Gluing, Motion, NodeSupport, TangentialRows, TfetiError};
use std::collections::BTreeMap;

#[test]
fn partial_supports_reduce_the_tangential_space() {
    let b = Brick::new(1, 2);
    // y = 0 is a symmetry plane: its contact nodes keep the normal and one tangential direction.
    let side = b.mesh.nodes_on(brick::Y_MIN);
    let supports = [NodeSupport::partial(
        side.clone(),
        Directions::Components([false, true, false]),
    )];
    let g = gluing(&b, &supports, &b.contact(true)).unwrap();
    let edge: Vec<u32> = b.bottom.iter().copied().filter(|n| side.contains(n)).collect();
    assert_eq!(g.ranges().intervals.len(), edge.len());
    for info in g.contact() {
        let node = g.node(info.row).unwrap();
        match info.tangential {
            TangentialRows::Interval { direction, row, .. } => {
                assert!(edge.contains(&node) && g.ranges().intervals.contains(&row));
                assert!(direction[0].abs() > 1.0 - 1e-14);
            }
            TangentialRows::Disc { row, scale } => {
                assert!(!edge.contains(&node) && g.ranges().discs.contains(&row));
                let copies = b.decomposition.copies(node as usize).len() as f64;
                assert!((scale - copies.sqrt()).abs() < 1e-14 && (info.scale - scale).abs() < 1e-14);
            }
            _ => panic!("friction everywhere"),
        }
    }
    // A support in the normal direction takes the whole contact point away.
    let supports = [NodeSupport::partial(
        b.bottom.clone(),
        Directions::Components([false, false, true]),
    )];
    let g = gluing(&b, &supports, &b.contact(true)).unwrap();
    assert!(g.contact().is_empty() && g.ranges().contact().is_empty());
    assert_eq!(g.ranges().dirichlet.len(), b.bottom.len());
    // An inclined support leaves an inclined row of larger scale.
    let s = 0.5_f64.sqrt();
    let node = b.bottom[b.bottom.len() - 1];
    let supports = [NodeSupport::partial(vec![node], Directions::Vectors(vec![[s, 0.0, s]]))];
    let g = gluing(&b, &supports, &b.contact(false)).unwrap();
    let info = g.contact().iter().find(|c| g.node(c.row) == Some(node)).unwrap();
    assert!((info.scale - 2.0_f64.sqrt()).abs() < 1e-12);
    let unit = |g: &Gluing| {
        let gram = gram(g);
        (0..gram.len()).all(|i| (gram[i][i] - 1.0).abs() < 1e-13)
    };
    assert!(unit(&g) && is_orthonormal(&g) && g.dependent_nodes().is_empty());
    // With friction all rows of the node are wanted, though one of them depends on those of the support.
    let g = gluing(&b, &supports, &b.contact(true)).unwrap();
    let info = g.contact().iter().find(|c| g.node(c.row) == Some(node)).unwrap();
    assert!((info.scale - 1.0).abs() < 1e-12);
    assert!(matches!(info.tangential, TangentialRows::Disc { .. }));
    assert_eq!(g.dependent_nodes(), [node]);
    assert!(unit(&g) && !is_orthonormal(&g));
    assert!(smallest_eigenvalue(&gram(&g)).abs() < 1e-12);
}

#[test]
fn doubled_supports_are_removed_and_contradictions_refused() {
    let b = Brick::new(1, 2);
    let node = b.fixed[0];
    let moved = |case, values: [f64; 3]| vec![Motion::new(case, vec![values])];
    let supports = [
        NodeSupport::fixed(b.fixed.clone()),
        NodeSupport {
            nodes: vec![node],
            directions: Directions::Vectors(vec![[0.3, 0.4, 0.0]]),
            motions: Vec::new(),
        },
    ];
    let g = gluing(&b, &supports, &[]).unwrap();
    assert_eq!(g.ranges().dirichlet.len(), 3 * b.fixed.len());

    let mut contradicting = supports.clone();
    contradicting[1].motions = moved(0, [1e-3, 0.0, 0.0]);
    let error = gluing(&b, &contradicting, &[]).unwrap_err();
    assert!(
        matches!(error, TfetiError::ContradictorySupports { second: 1, case: 0, .. }),
        "{error}"
    );
    // the first case may be the only one
    assert!(error.to_string().contains("direction (difference "), "{error}");
    contradicting[1].motions = moved(1, [1e-3, 0.0, 0.0]);
    let error = gluing(&b, &contradicting, &[]).unwrap_err();
    assert!(error.to_string().contains("direction (case 1, difference "), "{error}");

    // Equal motions of skew directions agree.
    let w = [1e-3, -2e-3, 5e-4];
    let agreeing = [
        NodeSupport {
            nodes: vec![node],
            directions: Directions::Vectors(vec![[1.0, 1.0, 0.0], [0.0, 1.0, 1.0]]),
            motions: moved(1, w),
        },
        NodeSupport {
            nodes: vec![node],
            directions: Directions::Vectors(vec![[1.0, 2.0, 1.0]]),
            motions: moved(1, w),
        },
    ];
    let g = gluing(&b, &agreeing, &[]).unwrap();
    assert_eq!((g.prescribed(0).len(), g.ranges().dirichlet.len()), (0, 2));
    // B w = offset for the rigid translation w.
    for &(row, value) in g.prescribed(1) {
        let action: f64 = g.row(row as usize).iter().map(|(_, dof, v)| v * w[dof % 3]).sum();
        assert!((action - value).abs() < 1e-15);
    }
}

#[test]
fn prescribed_motion_of_a_support_appears_in_the_contact_offset() {
    let b = Brick::new(1, 2);
    let node = b.bottom[b.bottom.len() - 1];
    let w = [2e-3, 1e-3, -3e-3];
    let directions = Directions::Vectors(vec![[1.0, 0.0, 1.0]]);
    let supports = [NodeSupport {
        nodes: vec![node],
        directions,
        motions: vec![Motion::new(0, vec![w])],
    }];
    {
        let g = gluing(&b, &supports, &b.contact(true)).unwrap();
        let info = g.contact().iter().find(|c| g.node(c.row) == Some(node)).unwrap();
        // For a displacement that obeys the support, (B u - offset) / scale is the physical normal displacement.
        let d = [0.5_f64.sqrt(), 0.0, 0.5_f64.sqrt()];
        let free = [7e-3, 4e-3, -7e-3];
        let fixed = dot(&d, &w);
        let u: Vec<f64> = (0..3).map(|c| free[c] + fixed * d[c]).collect();
        let action: f64 = g.row(info.row).iter().map(|(_, dof, v)| v * u[dof % 3]).sum();
        let offset = g
            .prescribed(0)
            .iter()
            .find(|v| v.0 as usize == info.row)
            .map_or(0.0, |v| v.1);
        assert!(((action - offset) / info.scale - dot(&b.frames[0].normal, &u)).abs() < 1e-15);
    }
}

/// What a support drags along the surface keeps its tangential rows; what it only holds does not.
#[test]
fn dragged_nodes_keep_their_tangential_rows() {
    let b = Brick::new(1, 2);
    let node = b.bottom[b.bottom.len() - 1];
    let support = |along: [f64; 3]| {
        let directions = Directions::Components([true, false, false]);
        let values = vec![along];
        [NodeSupport::partial(vec![node], directions).with_motion(Motion::new(0, values))]
    };
    let rows = |along: [f64; 3], friction: bool| {
        let contact = b.contact(friction);
        gluing(&b, &support(along), &contact).unwrap()
    };
    let discs = |g: &Gluing| g.ranges().discs.len() / 2;
    let all = b.bottom.len();
    let held = rows([0.0, 1.0, 1.0], true);
    assert_eq!((discs(&held), held.ranges().intervals.len()), (all - 1, 1));
    let dragged = rows([1e-3, 0.0, 0.0], true);
    assert_eq!((discs(&dragged), dragged.ranges().intervals.len()), (all, 0));
    assert_eq!(dragged.dependent_nodes(), [node]);
    assert!(rows([1e-3, 0.0, 0.0], false).dependent_nodes().is_empty());
}

/// A node in a corner of three walls has three normal rows; two points of one normal are one too many.
#[test]
fn a_node_may_have_several_normals() {
    let b = Brick::new(1, 2);
    let node = b.bottom[0];
    let points = |normals: &[[f64; 3]], friction| -> Vec<ContactConstraint> {
        normals
            .iter()
            .map(|&normal| {
                let frame = SurfaceFrame::from_normal(normal).unwrap();
                ContactConstraint::new(node, frame).with_friction(friction)
            })
            .collect()
    };
    let corner = [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]];
    let make = |normals: &[[f64; 3]], friction| gluing(&b, &[], &points(normals, friction));
    let smooth = make(&corner, false).unwrap();
    assert_eq!(smooth.ranges().contact().len(), 3);
    assert!(is_orthonormal(&smooth));
    assert_eq!(smooth.dependent_nodes(), [node]);
    let rough = make(&corner, true).unwrap();
    assert_eq!(rough.ranges().contact().len(), 9);
    assert!(!is_orthonormal(&rough));
    assert_eq!(rough.rows_as_paper() - smooth.rows_as_paper(), 6);
    let blunt = make(&[[0.0, 0.6, -0.8], [0.0, 0.0, -1.0]], false).unwrap();
    assert!(!is_orthonormal(&blunt));
    assert!(matches!(
        make(&[[0.0, 0.0, -1.0], [0.0, 0.0, -1.0]], true),
        Err(TfetiError::ContactNodeTwice { .. })
    ));
}

/// A contact point whose node and partner are both moved along the normal moves by the difference, whether with one
/// history or with two.
#[test]
fn the_motion_of_a_partner_counts_against_that_of_the_node() {
    let frame = SurfaceFrame::from_normal([0.0, 0.0, -1.0]).unwrap();
    let contact = [ContactConstraint::new(0, frame).with_partner(Some(5))];
    let (own, other) = (2e-3, 5e-4);
    let moved = |node: u32, case: u32, by: f64| {
        let values = vec![[0.0, 0.0, -by]];
        NodeSupport::fixed(vec![node]).with_motion(Motion::new(case, values))
    };
    for (second, expected) in [(0, vec![(0, own - other)]), (1, vec![(0, own), (1, -other)])] {
        let supports = MergedSupports::new(&[moved(0, 0, own), moved(5, second, other)], 8).unwrap();
        let held = prescribed_points(&contact, &supports).unwrap();
        let [point] = &held[..] else {
            panic!("one point, not {held:?}");
        };
        assert_eq!((point.point, point.node), (0, 0));
        assert_eq!(point.normal.len(), expected.len(), "{held:?}");
        for ((case, value), (own, expected)) in point.normal.iter().zip(&expected) {
            assert!(case == own && (value - expected).abs() < 1e-16, "{held:?}");
        }
    }
}

#[test]
fn what_an_oblique_support_and_a_rough_obstacle_may_exchange() {
    let b = Brick::new(2, 2);
    let direction = [1.0, 0.3, -0.4];
    let ends = b.mesh.nodes_on(brick::X_MIN);
    let supports = [NodeSupport::partial(ends.clone(), Directions::Vectors(vec![direction]))];
    let g = gluing(&b, &supports, &b.contact(true)).unwrap();
    let dependencies = g.dependencies();
    let both = b.bottom.iter().filter(|n| ends.contains(n)).count();
    assert!(both > 0 && dependencies.len() == both && g.dependent_nodes().len() == both);
    for dependency in &dependencies {
        // normal, two tangents and the support for three displacements
        assert_eq!((dependency.rows.len(), dependency.vectors.len()), (4, 1));
        let mut force = std::collections::BTreeMap::new();
        let mut largest = 0.0_f64;
        for (row, v) in dependency.rows.iter().zip(&dependency.vectors[0]) {
            largest = largest.max(v.abs());
            for (subdomain, dof, coefficient) in g.row(*row) {
                *force.entry((subdomain, dof)).or_insert(0.0) += coefficient * v;
            }
        }
        assert!(largest > 0.5 && force.values().all(|f| f.abs() < 1e-14));
    }
    let plain = gluing(&b, &[], &b.contact(true)).unwrap();
    assert!(plain.dependencies().is_empty());
}

/// Seven digits of coordinates tell the normals of two supports on one inclined plane apart, but mean one.
#[test]
fn supports_on_one_inclined_plane_hold_no_more_than_one() {
    let flat = brick::Brick::new([2.0, 1.0, 0.2], [16, 8, 2]).build().unwrap();
    let (sin, cos) = 0.5_f64.sin_cos();
    let seven = |v: f64| (v * 1e6).round() / 1e6;
    let points = flat.points().iter().map(|[x, y, z]| {
        let [x, y, z] = [1.0 + cos * x - sin * z, y + 0.1 * x, sin * x + cos * z];
        [x, y, z].map(seven)
    });
    let points: Vec<[f64; 3]> = points.collect();
    // normals at the nodes of each half of the bottom, which share an edge
    let mut normals = [BTreeMap::new(), BTreeMap::new()];
    for facet in flat.facets().iter().filter(|facet| facet.tag == brick::Z_MIN) {
        let half = usize::from(facet.nodes.iter().any(|n| flat.points()[*n as usize][0] > 1.0));
        let area = vec3::area_vector(&facet.nodes.map(|n| points[n as usize]));
        for node in facet.nodes {
            let sum = normals[half].entry(node).or_insert([0.0; 3]);
            *sum = vec3::add(*sum, area);
        }
    }
    let moved = |half: usize, by: [f64; 3]| {
        let lists = normals[half].values().map(|n| vec![*n]).collect();
        let nodes = normals[half].keys().copied().collect();
        NodeSupport::partial(nodes, Directions::EachNode(lists)).with_motion(Motion::new(0, vec![by]))
    };
    let merged = |by: [[f64; 3]; 2]| MergedSupports::new(&[moved(0, by[0]), moved(1, by[1])], points.len());
    let w = [1e-3, 2e-3, -4e-3];
    let supports = merged([w; 2]).unwrap();
    let seam: Vec<u32> = normals[0]
        .keys()
        .filter(|n| normals[1].contains_key(n))
        .copied()
        .collect();
    let angle = |n: &u32| {
        let [a, b] = [0, 1].map(|half| vec3::unit(normals[half][n]));
        vec3::norm(vec3::cross(a, b))
    };
    let largest = seam.iter().map(angle).fold(0.0, f64::max);
    assert!(seam.len() == 9 && (1e-7..1e-5).contains(&largest), "{largest:e}");
    for node in &seam {
        let directions = supports.directions(*node);
        assert_eq!(directions.len(), 1, "node {node}: the edge is free along the plane");
    }
    // a plane that moves away from the other one is refused
    let off = merged([w, [1e-3, 2e-3, -3.9e-3]]).unwrap_err();
    assert!(
        matches!(
            off,
            TfetiError::ContradictorySupports {
                first: 0,
                second: 1,
                ..
            }
        ),
        "{off}"
    );
    // contact on the plane has no force of its own
    let frame = SurfaceFrame::from_normal(vec3::unit(normals[1][&seam[4]])).unwrap();
    let contact = [ContactConstraint::new(seam[4], frame)];
    assert_eq!(prescribed_points(&contact, &supports).unwrap().len(), 1);
    // facets of a cylinder of a degree each meet at an angle that is meant
    let one = |tilt: f64| NodeSupport::partial(vec![0], Directions::Vectors(vec![[tilt.sin(), 0.0, tilt.cos()]]));
    let seam = MergedSupports::new(&[one(0.0), one(0.0087)], 8).unwrap();
    assert_eq!(seam.directions(0).len(), 2);
}
