//! Counts, independence and redundancy of the rows of `B`.

mod common;

use common::{Brick, dot};
use signorini_fem_mesh::{Decomposition, Frame, Hooke, Materials, brick};
use signorini_tfeti::{
    ContactNodes, ContactPoint, CopyStiffness, Directions, Gluing, Motion, RemovalReason, RowKind,
    RowRule, Support, TangentialRows, TfetiBuilder, TfetiError,
};

fn gluing(
    b: &Brick,
    supports: &[Support],
    contact: Option<&ContactNodes>,
    rule: RowRule,
) -> Result<Gluing, TfetiError> {
    Gluing::new(
        &b.decomposition,
        b.mesh.points().len(),
        supports,
        contact,
        rule,
        &CopyStiffness::default(),
    )
}

#[test]
fn counts_of_the_papers_table() {
    for (n, rows) in [(1, 612), (2, 5685), (3, 20136), (4, 48879), (5, 96828)] {
        let b = Brick::new(n, 5);
        assert_eq!(
            b.decomposition.torn_dofs(),
            [1944, 15552, 52488, 124416, 243000][n - 1]
        );
        for rule in [RowRule::Orthonormal, RowRule::Chained] {
            let g = gluing(&b, &b.supports(), Some(&b.contact(true)), rule).unwrap();
            assert_eq!(g.rows_as_paper(), rows);
            assert_eq!(g.rows_full_rank(), rows - 3 * (5 * n + 1));
            assert_eq!(g.removed().len(), 3 * (5 * n + 1));
            assert!(
                g.removed()
                    .iter()
                    .all(|r| b.fixed.binary_search(&r.node).is_ok())
            );
        }
    }
}

/// Dense `B B^T` of all rows.
fn gram(g: &Gluing) -> Vec<Vec<f64>> {
    let rows: Vec<std::collections::BTreeMap<(usize, usize), f64>> = (0..g.rows_full_rank())
        .map(|r| {
            let mut map = std::collections::BTreeMap::new();
            g.row(r)
                .into_iter()
                .for_each(|(s, d, v)| *map.entry((s, d)).or_insert(0.0) += v);
            map
        })
        .collect();
    rows.iter()
        .map(|a| {
            rows.iter()
                .map(|b| a.iter().filter_map(|(k, v)| b.get(k).map(|w| v * w)).sum())
                .collect()
        })
        .collect()
}

fn smallest_eigenvalue(gram: &[Vec<f64>]) -> f64 {
    let n = gram.len();
    let matrix = nalgebra::DMatrix::from_fn(n, n, |i, j| gram[i][j]);
    nalgebra::SymmetricEigen::new(matrix).eigenvalues.min()
}

#[test]
fn orthonormal_rows_are_orthonormal_and_chained_ones_independent() {
    let b = Brick::new(1, 2);
    let supports = [
        Support::fixed(b.fixed.clone()),
        Support::partial(
            b.mesh.nodes_on(brick::Y_MIN),
            Directions::Components([false, true, false]),
        ),
        Support::partial(
            vec![b.mesh.nodes_on(brick::X_MAX)[0]],
            Directions::Vectors(vec![[1.0, 2.0, 0.0]]),
        ),
    ];
    let g = gluing(&b, &supports, Some(&b.contact(true)), RowRule::Orthonormal).unwrap();
    assert!(g.is_orthonormal());
    for (i, row) in gram(&g).iter().enumerate() {
        for (j, v) in row.iter().enumerate() {
            assert!(
                (v - f64::from(u8::from(i == j))).abs() < 1e-13,
                "rows {i} {j}: {v}"
            );
        }
    }
    let g = gluing(&b, &supports, Some(&b.contact(true)), RowRule::Chained).unwrap();
    assert!(!g.is_orthonormal());
    assert!(smallest_eigenvalue(&gram(&g)) > 1e-3);
}

#[test]
fn without_friction_there_are_no_tangential_rows() {
    let b = Brick::new(1, 2);
    let g = gluing(
        &b,
        &b.supports(),
        Some(&b.contact(false)),
        RowRule::Orthonormal,
    )
    .unwrap();
    assert!(g.ranges().tangential().is_empty());
    assert_eq!(g.ranges().normal.len(), b.bottom.len() - 3);
    assert!(
        g.contact()
            .iter()
            .all(|c| c.tangential == TangentialRows::None)
    );
}

#[test]
fn partial_supports_reduce_the_tangential_space() {
    let b = Brick::new(1, 2);
    // y = 0 is a symmetry plane: its contact nodes keep the normal and one tangential direction.
    let side = b.mesh.nodes_on(brick::Y_MIN);
    let supports = [Support::partial(
        side.clone(),
        Directions::Components([false, true, false]),
    )];
    let g = gluing(&b, &supports, Some(&b.contact(true)), RowRule::Orthonormal).unwrap();
    let edge: Vec<u32> = b
        .bottom
        .iter()
        .copied()
        .filter(|n| side.contains(n))
        .collect();
    assert_eq!(g.ranges().intervals.len(), edge.len());
    for info in g.contact() {
        match info.tangential {
            TangentialRows::Interval { direction, row, .. } => {
                assert!(edge.contains(&info.node) && g.ranges().intervals.contains(&row));
                assert!(direction[0].abs() > 1.0 - 1e-14);
            }
            TangentialRows::Disc { row, scale } => {
                assert!(!edge.contains(&info.node) && g.ranges().discs.contains(&row));
                let copies = b.decomposition.copies(info.node as usize).len() as f64;
                assert!(
                    (scale - copies.sqrt()).abs() < 1e-14 && (info.scale - scale).abs() < 1e-14
                );
            }
            _ => panic!("friction everywhere"),
        }
    }
    // A support in the normal direction takes the whole contact point away.
    let supports = [Support::partial(
        b.bottom.clone(),
        Directions::Components([false, false, true]),
    )];
    let g = gluing(&b, &supports, Some(&b.contact(true)), RowRule::Orthonormal).unwrap();
    assert!(g.contact().is_empty() && g.ranges().contact().is_empty());
    let normal = g.removed().iter().filter(|r| r.kind == RowKind::Normal);
    assert!(
        normal
            .clone()
            .all(|r| r.reason == RemovalReason::NormalFixed)
            && normal.count() == b.bottom.len()
    );
    // An inclined support leaves an inclined row of larger scale.
    let s = 0.5_f64.sqrt();
    let node = b.bottom[b.bottom.len() - 1];
    let supports = [Support::partial(
        vec![node],
        Directions::Vectors(vec![[s, 0.0, s]]),
    )];
    let g = gluing(&b, &supports, Some(&b.contact(false)), RowRule::Orthonormal).unwrap();
    let info = g.contact().iter().find(|c| c.node == node).unwrap();
    assert!((info.scale - 2.0_f64.sqrt()).abs() < 1e-12);
    let unit = |g: &Gluing| {
        let gram = gram(g);
        (0..gram.len()).all(|i| (gram[i][i] - 1.0).abs() < 1e-13)
    };
    assert!(unit(&g) && g.is_orthonormal() && g.dependent_nodes().is_empty());
    // With friction all rows of the node are wanted, though one of them depends on those of the support.
    let g = gluing(&b, &supports, Some(&b.contact(true)), RowRule::Orthonormal).unwrap();
    let info = g.contact().iter().find(|c| c.node == node).unwrap();
    assert!((info.scale - 1.0).abs() < 1e-12);
    assert!(matches!(info.tangential, TangentialRows::Disc { .. }));
    assert_eq!(g.dependent_nodes(), [node]);
    assert!(unit(&g) && !g.is_orthonormal());
    assert!(smallest_eigenvalue(&gram(&g)).abs() < 1e-12);
}

/// What a support drags along the surface keeps its tangential rows; what it only holds does not.
#[test]
fn dragged_nodes_keep_their_tangential_rows() {
    let b = Brick::new(1, 2);
    let node = b.bottom[b.bottom.len() - 1];
    let support = |along: [f64; 3]| {
        let directions = Directions::Components([true, false, false]);
        let values = vec![along];
        [Support::partial(vec![node], directions).with_motion(Motion { case: 0, values })]
    };
    let rows = |along: [f64; 3], friction: bool| {
        let contact = b.contact(friction);
        gluing(&b, &support(along), Some(&contact), RowRule::Orthonormal).unwrap()
    };
    let discs = |g: &Gluing| g.ranges().discs.len() / 2;
    let all = b.bottom.len();
    let held = rows([0.0, 1.0, 1.0], true);
    assert_eq!((discs(&held), held.ranges().intervals.len()), (all - 1, 1));
    let dragged = rows([1e-3, 0.0, 0.0], true);
    assert_eq!(
        (discs(&dragged), dragged.ranges().intervals.len()),
        (all, 0)
    );
    assert_eq!(dragged.dependent_nodes(), [node]);
    assert!(rows([1e-3, 0.0, 0.0], false).dependent_nodes().is_empty());
}

/// A node in a corner of three walls has three normal rows; two points of one normal are one too many.
#[test]
fn a_node_may_have_several_normals() {
    let b = Brick::new(1, 2);
    let node = b.bottom[0];
    let points = |normals: &[[f64; 3]], friction| ContactNodes {
        points: normals
            .iter()
            .map(|&normal| ContactPoint {
                node,
                opponent: None,
                frame: Frame::from_normal(normal).unwrap(),
                friction,
                moving: false,
            })
            .collect(),
    };
    let corner = [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]];
    let make = |normals: &[[f64; 3]], friction| {
        gluing(
            &b,
            &[],
            Some(&points(normals, friction)),
            RowRule::Orthonormal,
        )
    };
    let smooth = make(&corner, false).unwrap();
    assert_eq!(smooth.ranges().contact().len(), 3);
    assert!(smooth.is_orthonormal());
    assert_eq!(smooth.dependent_nodes(), [node]);
    let rough = make(&corner, true).unwrap();
    assert_eq!(rough.ranges().contact().len(), 9);
    assert!(!rough.is_orthonormal());
    assert_eq!(rough.rows_as_paper() - smooth.rows_as_paper(), 6);
    let blunt = make(&[[0.0, 0.6, -0.8], [0.0, 0.0, -1.0]], false).unwrap();
    assert!(!blunt.is_orthonormal());
    assert!(matches!(
        make(&[[0.0, 0.0, -1.0], [0.0, 0.0, -1.0]], true),
        Err(TfetiError::ContactNodeTwice { .. })
    ));
}

#[test]
fn doubled_supports_are_removed_and_contradictions_refused() {
    let b = Brick::new(1, 2);
    let node = b.fixed[0];
    let moved = |case, values: [f64; 3]| {
        Some(Motion {
            case,
            values: vec![values],
        })
    };
    let supports = [
        Support::fixed(b.fixed.clone()),
        Support {
            nodes: vec![node],
            directions: Directions::Vectors(vec![[0.3, 0.4, 0.0]]),
            motion: None,
        },
    ];
    let g = gluing(&b, &supports, None, RowRule::Orthonormal).unwrap();
    assert_eq!(g.removed().len(), 1);
    assert_eq!(
        g.removed()[0].reason,
        RemovalReason::DoubledSupport { support: 1 }
    );
    assert_eq!(g.ranges().dirichlet.len(), 3 * b.fixed.len());

    let mut contradicting = supports.clone();
    contradicting[1].motion = moved(0, [1e-3, 0.0, 0.0]);
    let error = gluing(&b, &contradicting, None, RowRule::Orthonormal).unwrap_err();
    assert!(
        matches!(
            error,
            TfetiError::ContradictorySupports {
                second: 1,
                case: 0,
                ..
            }
        ),
        "{error}"
    );

    // Equal motions of skew directions agree.
    let w = [1e-3, -2e-3, 5e-4];
    let agreeing = [
        Support {
            nodes: vec![node],
            directions: Directions::Vectors(vec![[1.0, 1.0, 0.0], [0.0, 1.0, 1.0]]),
            motion: moved(1, w),
        },
        Support {
            nodes: vec![node],
            directions: Directions::Vectors(vec![[1.0, 2.0, 1.0]]),
            motion: moved(1, w),
        },
    ];
    let g = gluing(&b, &agreeing, None, RowRule::Orthonormal).unwrap();
    assert_eq!(
        (
            g.prescribed_cases(),
            g.removed().len(),
            g.ranges().dirichlet.len()
        ),
        (2, 1, 2)
    );
    // B w = offset for the rigid translation w.
    for &(row, value) in g.prescribed(1) {
        let action: f64 = g
            .row(row as usize)
            .iter()
            .map(|(_, dof, v)| v * w[dof % 3])
            .sum();
        assert!((action - value).abs() < 1e-15);
    }
}

#[test]
fn prescribed_motion_of_a_support_appears_in_the_contact_offset() {
    let b = Brick::new(1, 2);
    let node = b.bottom[b.bottom.len() - 1];
    let w = [2e-3, 1e-3, -3e-3];
    let directions = Directions::Vectors(vec![[1.0, 0.0, 1.0]]);
    let supports = [Support {
        nodes: vec![node],
        directions,
        motion: Some(Motion {
            case: 0,
            values: vec![w],
        }),
    }];
    for rule in [RowRule::Orthonormal, RowRule::Chained] {
        let g = gluing(&b, &supports, Some(&b.contact(true)), rule).unwrap();
        let info = g.contact().iter().find(|c| c.node == node).unwrap();
        // For a displacement that obeys the support, (B u - offset) / scale is the physical normal displacement.
        let d = [0.5_f64.sqrt(), 0.0, 0.5_f64.sqrt()];
        let free = [7e-3, 4e-3, -7e-3];
        let fixed = dot(&d, &w);
        let u: Vec<f64> = (0..3).map(|c| free[c] + fixed * d[c]).collect();
        let action: f64 = g
            .row(info.row)
            .iter()
            .map(|(_, dof, v)| v * u[dof % 3])
            .sum();
        let offset = g
            .prescribed(0)
            .iter()
            .find(|v| v.0 as usize == info.row)
            .map_or(0.0, |v| v.1);
        assert!(
            ((action - offset) / info.scale - dot(&info.frame.normal, &u)).abs() < 1e-15,
            "{rule:?}"
        );
    }
}

#[test]
fn pairs_of_nodes_act_on_the_relative_displacement() {
    let b = Brick::new(1, 2);
    // Take two nodes of one body as the pair; the rows do not know the difference.
    let (a, o) = (
        b.bottom[b.bottom.len() - 1],
        b.mesh.nodes_on(brick::Z_MAX)[4],
    );
    let point = ContactPoint {
        node: a,
        opponent: Some(o),
        frame: b.frames[0],
        friction: true,
        moving: false,
    };
    let contact = ContactNodes {
        points: vec![point],
    };
    let g = gluing(&b, &[], Some(&contact), RowRule::Orthonormal).unwrap();
    assert!(g.is_orthonormal());
    let (ka, ko) = (
        b.decomposition.copies(a as usize).len() as f64,
        b.decomposition.copies(o as usize).len() as f64,
    );
    let info = &g.contact()[0];
    assert!((info.scale - (1.0 / ka + 1.0 / ko).sqrt().recip()).abs() < 1e-14);
    let displacement = |s: usize, dof: usize| {
        let node = b.decomposition.subdomains()[s].nodes[dof / 3];
        if node == a {
            [1.0, 2.0, 3.0][dof % 3]
        } else {
            [-4.0, 0.5, 1.0][dof % 3]
        }
    };
    let action: f64 = g
        .row(info.row)
        .iter()
        .map(|&(s, dof, v)| v * displacement(s, dof))
        .sum();
    assert!((action / info.scale - -(3.0 - 1.0)).abs() < 1e-13);
    // With the opponent fixed the pair is a point against an obstacle.
    let supports = [Support::fixed(vec![o])];
    let g = gluing(&b, &supports, Some(&contact), RowRule::Orthonormal).unwrap();
    assert!(smallest_eigenvalue(&gram(&g)) > 1e-3);
    let info = &g.contact()[0];
    assert!(matches!(info.tangential, TangentialRows::Disc { .. }));
    let action: f64 = g
        .row(info.row)
        .iter()
        .map(|&(_, dof, v)| v * [1.0, 2.0, 3.0][dof % 3])
        .sum();
    assert!((action / info.scale + 3.0).abs() < 1e-13);
}

#[test]
fn bad_input_is_named() {
    let b = Brick::new(1, 2);
    let many = b.mesh.points().len() as u32;
    let err = |supports: &[Support], contact: Option<&ContactNodes>| {
        gluing(&b, supports, contact, RowRule::Orthonormal).unwrap_err()
    };
    assert!(
        matches!(err(&[Support::fixed(vec![many])], None), TfetiError::UnknownNode { node, .. } if node == many)
    );
    assert!(matches!(
        err(&[Support::fixed(vec![])], None),
        TfetiError::EmptySupport { what: "nodes", .. }
    ));
    let none = Support::partial(vec![0], Directions::Components([false; 3]));
    assert!(matches!(
        err(&[none], None),
        TfetiError::EmptySupport {
            what: "directions",
            ..
        }
    ));
    for direction in [[0.0; 3], [f64::NAN, 0.0, 1.0], [f64::INFINITY, 0.0, 0.0]] {
        let support = Support::partial(vec![0], Directions::Vectors(vec![direction]));
        assert!(matches!(
            err(&[support], None),
            TfetiError::BadDirection {
                support: 0,
                direction: 0
            }
        ));
    }
    let motion = |values| Motion { case: 0, values };
    let support = Support::fixed(vec![0, 1]).with_motion(motion(vec![[0.0; 3]; 3]));
    assert!(matches!(
        err(&[support], None),
        TfetiError::MotionLength {
            found: 3,
            nodes: 2,
            ..
        }
    ));
    let support = Support::fixed(vec![0, 1]).with_motion(motion(vec![[0.0; 3], [f64::NAN; 3]]));
    assert!(matches!(
        err(&[support], None),
        TfetiError::BadMotion { node: 1, .. }
    ));
    let mut contact = b.contact(true);
    contact.points[3].node = contact.points[2].node;
    assert!(matches!(
        err(&[], Some(&contact)),
        TfetiError::ContactNodeTwice { .. }
    ));
    let mut contact = b.contact(true);
    contact.points[1].opponent = Some(many + 5);
    assert!(matches!(
        err(&[], Some(&contact)),
        TfetiError::UnknownNode { .. }
    ));
    let mut contact = b.contact(true);
    contact.points[1].frame.normal = [0.0, 0.1, -1.0];
    assert!(matches!(
        err(&[], Some(&contact)),
        TfetiError::BadFrame { point: 1, .. }
    ));
}

#[test]
fn a_whole_body_has_no_interface_rows() {
    let b = Brick::new(1, 2);
    let whole = Decomposition::whole(&b.mesh);
    let frame: Frame = b.frames[0];
    let contact = ContactNodes::rigid(&b.bottom, &vec![frame; b.bottom.len()], true);
    let g = Gluing::new(
        &whole,
        b.mesh.points().len(),
        &b.supports(),
        Some(&contact),
        RowRule::Orthonormal,
        &CopyStiffness::default(),
    )
    .unwrap();
    assert!(g.ranges().interface.is_empty());
    assert!(g.contact().iter().all(|c| (c.scale - 1.0).abs() < 1e-15));
    let down =
        |row: &[(usize, usize, f64)]| matches!(row, [(0, dof, v)] if dof % 3 == 2 && *v == -1.0);
    assert!(g.contact().iter().all(|c| down(&g.row(c.row))));
}

/// Between a stiff and a soft subdomain a contact row follows the stiff one, and gluing errors of the soft one stay out of
/// it. Physical forces and gaps go with the sum of the coefficients.
#[test]
fn contact_rows_follow_the_stiff_copy() {
    let mut b = Brick::new(1, 2);
    let ratio = 1e4;
    let regions = (0..b.mesh.tets().len())
        .map(|t| {
            u32::from(
                b.mesh
                    .tet_points(t)
                    .iter()
                    .all(|p| p[0] >= 1.0 && p[0] <= 2.0),
            )
        })
        .collect();
    b.mesh = b.mesh.with_regions(regions).unwrap();
    let hooke = |young| Hooke::isotropic(young, 0.3).unwrap();
    let materials = Materials::new(vec![(0, hooke(1.0)), (1, hooke(1.0 / ratio))]).unwrap();
    let (supports, contact) = (b.supports(), b.contact(true));
    let system = TfetiBuilder::new(&b.mesh, &b.decomposition, &materials)
        .supports(&supports)
        .contact(&contact)
        .build()
        .unwrap();
    let g = system.gluing();
    assert!(!g.is_orthonormal());
    for (i, row) in gram(g).iter().enumerate() {
        assert!((row[i] - 1.0).abs() < 1e-13);
    }
    let mut shared = 0;
    for info in g.contact() {
        let row = g.row(info.row);
        let sum: f64 = row.iter().map(|e| -e.2).sum();
        assert!((sum - info.scale).abs() < 1e-13);
        if row.len() == 2 {
            shared += 1;
            let soft = row.iter().position(|e| e.0 == 1).unwrap();
            let found = row[1 - soft].2 / row[soft].2;
            assert!(found > 0.1 * ratio && found < 10.0 * ratio, "{found}");
        }
    }
    assert_eq!(shared, 6);
    let mut torn = vec![0.0; system.torn_dim()];
    torn[system.torn_range(0)].fill(1.0);
    let mean = system.nodal_mean(&torn);
    for node in b.mesh.nodes_on(brick::Z_MIN) {
        let x = b.mesh.points()[node as usize][0];
        if x == 1.0 {
            assert!((mean[3 * node as usize] - 1.0).abs() < 10.0 / ratio);
        }
    }
}
